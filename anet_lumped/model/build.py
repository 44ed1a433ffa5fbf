"""Scene → Model: nodes, segments and the elimination order."""

from dataclasses import replace
from functools import lru_cache
from itertools import accumulate

import numpy as np

from anet_lumped.checks import LARGEST, SceneError, quoted
from anet_lumped.compiled.lanes import WIDTH
from anet_lumped.effects.kernel_checks import check_kernels
from anet_lumped.effects.laws.axial import SWITCHES
from anet_lumped.effects.signatures import SLOTS, addresses
from anet_lumped.limits import BYTES, check_most
from anet_lumped.model import rest_lengths
from anet_lumped.model.body_order import order_of_points
from anet_lumped.model.claims import check_claims
from anet_lumped.model.model import Model
from anet_lumped.model.net import Effects
from anet_lumped.model.tables import (
    AXIAL_COLUMNS,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_BLOCK_END_START,
    CABLE_BLOCK_START_END,
    CABLE_COLUMNS,
    CABLE_CURVE,
    CABLE_CURVE_END,
    CABLE_END,
    CABLE_JOINS_FREE_POINTS,
    CABLE_SEGMENTS,
)
from anet_lumped.scene.scene import Driven, Free

BYTES_OF_NODE = 1e3  # of a model and of what a computation needs, about
# Of a Model, made when they are asked for: what names and ends decide, and what numbers do.
OF_TOPOLOGY = ("n_segments", "ends", "node_segments", "cable_of", "kinds_of_library", "unheld", "nodes_found")
OF_NUMBERS = ("forces", "creep", "breaking_tension", "links", "springs_of_cables", "path_table", "shedding_nodes")
TOPOLOGIES = 8  # that are kept
_KNOWN = {}  # what scenes share, `_topology`: the model of one of them


@lru_cache(maxsize=8)
def build(scene):
    """Cut a scene into nodes and segments and choose the elimination order.

    Returns
    -------
    Model
    """
    return build_anew(scene)


def build_anew(scene):
    """`build` of a scene that has not been built: to look for it among those that have would take a tenth of the time.

    What only names and ends of the parts of a scene decide is kept for the next scene that has the same, see `refilled`.

    Returns
    -------
    Model
    """
    key = _topology(scene)
    known = None if key is None else _KNOWN.get(key)
    if known is not None:
        return refilled(known, scene)
    model = _cut(scene)
    if key is not None:
        while len(_KNOWN) >= TOPOLOGIES:
            _KNOWN.pop(next(iter(_KNOWN), None), None)
        _KNOWN[key] = model
    return model


def _topology(scene):
    """What two scenes share of which one is `refilled` from the model of the other; None for what is left of a scene."""
    if not scene.whole:
        return None
    points = tuple((type(point), point.name) for point in scene.points)
    cables = tuple(
        (
            one.start,
            one.end,
            one.name,
            one.segments,
            one.compression,
            one.inextensible,
            one.creeps,
            one.tension_strain,
            one.working_curve,
        )
        for one in scene.cables
    )
    return points, cables, scene.bodies, tuple(map(type, scene.effects))


def refilled(known, scene):
    """Model of a scene from that of another one with the same names, ends, segments and kinds of parts: the numbers alone are new.

    What the effects of the library say of themselves holds whatever their numbers are, see `claims`; a user's own are checked anew.

    Returns
    -------
    Model
        The same as of `build`, to the last bit.
    """
    model = object.__new__(Model)
    same_paths = scene.points is known.scene.points
    if not same_paths:
        paths, known_paths = ([point.path for point in one.points if isinstance(point, Driven)] for one in (scene, known.scene))
        same_paths = paths == known_paths
    shared = ("path_table",) if same_paths else ()
    for name in (*OF_TOPOLOGY, *shared):
        getattr(known, name)
    vars(model).update(vars(known))
    for name in OF_NUMBERS:
        if name not in shared:
            vars(model).pop(name, None)
    mass, axial = _numbers(scene, known.node_of, known.cable, known.n_free)
    vars(model).update(scene=scene, mass=mass, axial=axial)
    if (axial[:, AXIAL_PUSH_SHARE] != known.axial[:, AXIAL_PUSH_SHARE]).any():  # the rest of what `_groups` looks at is shared
        groups, single, kinds = _groups(known.cable, axial, np.array([one.creeps for one in scene.cables]))
        vars(model).update(cable_groups=groups, single_cables=single, single_kinds=kinds)
        vars(model).pop("trails", None)
    vars(model).update(effects=_effect_tables(model.forces, model, known))
    if rest_lengths.changes(scene) or len(known.lengths.cable):
        vars(model).pop("trails", None)
        vars(model).update(lengths=rest_lengths.table(scene, model, _params_of))
    return model


def _cut(scene):
    """`build` of a scene of which nothing is known."""
    n_interior = sum(cable.segments - 1 for cable in scene.cables)
    check_most(BYTES, BYTES_OF_NODE * n_interior, f"A scene of {n_interior + len(scene.cables)} segments")
    points = order_of_points(scene)
    free = set(points.free)
    node_of = {name: n_interior + i for i, name in enumerate([*points.free, *points.fixed, *points.driven])}
    n, n_free = n_interior + len(node_of), n_interior + len(free)
    cable = np.full((len(scene.cables), CABLE_COLUMNS), -1, np.int64)
    flipped = np.zeros(len(scene.cables), bool)
    segment = node = 0
    for c, one in enumerate(scene.cables):
        flipped[c] = one.start in free and one.end not in free
        start, end = (one.end, one.start) if flipped[c] else (one.start, one.end)
        bordered = start in free and end in free
        cable[c, : CABLE_JOINS_FREE_POINTS + 1] = segment, one.segments, node, node_of[start], node_of[end], bordered
        if bordered:
            cable[c, CABLE_BLOCK_START_END : CABLE_BLOCK_END_START + 1] = points.blocks_of_pair[start, end]
        segment += one.segments
        node += one.segments - 1
    mass, axial = _numbers(scene, node_of, cable, n_free)
    springs = _curves(scene.cables, cable)
    groups, single, kinds = _groups(cable, axial, np.array([one.creeps for one in scene.cables]))
    bodies, joints = points.bodies(node_of, n_interior)
    model = Model(
        scene=scene,
        n=n,
        n_free=n_free,
        n_interior=n_interior,
        n_driven=n - len(points.driven),
        mass=mass,
        cable=cable,
        axial=axial,
        springs=springs,
        cable_groups=groups,
        single_cables=single,
        single_kinds=kinds,
        flipped=flipped,
        node_of=node_of,
        symbolic=points.symbolic,
        bodies=bodies,
        joints=joints,
        effects=None,
        lengths=None,
    )
    model = replace(model, effects=_effect_tables(model.forces, model))
    return replace(model, lengths=rest_lengths.table(scene, model, _params_of))


def _numbers(scene, node_of, cable, n_free):
    """Masses of the nodes (n,) [kg] and the table ``axial`` (n_cables, 10) of a `Net`, for the table and the nodes of the cables.

    Raises
    ------
    SceneError : a frequency that is beyond what numbers hold
    """
    rows, axial, runs, inside = {}, [], cable[:, : CABLE_END + 1].tolist(), []
    first = sum(one.segments - 1 for one in scene.cables)
    ends = [0.0] * len(node_of)  # masses of points, whose nodes are behind those inside of cables
    for point in scene.all_points:
        if isinstance(point, Free):
            ends[node_of[point.name] - first] = point.mass
    for one, (_, _, _, start, end) in zip(scene.cables, runs, strict=True):
        numbers = (one.length, one.segments, one.mass_per_length, one.EA, one.zeta, one.BA, one.EA_dynamic, one.EA_compression)
        alike = (*numbers, one.compression, one.tension_strain, one.working_curve)
        if alike not in rows:
            rows[alike] = _axial_row(one), one.half_segment_mass
        row, half = rows[alike]
        axial.append(row.copy())
        inside.append(2.0 * half)
        ends[start - first] += half
        ends[end - first] += half
    for c, (row, own, (_, count, _, start, end)) in enumerate(zip(axial, inside, runs, strict=True)):
        at_start, at_end = (1.0 / ends[i - first] if i < n_free else 0.0 for i in (start, end))
        of_inside = 1.0 / own if count > 1 else 0.0
        largest = (
            max(at_start + of_inside, of_inside + at_end, 2.0 * of_inside if count > 2 else 0.0) if count > 1 else at_start + at_end
        )
        row[AXIAL_OMEGA_SQUARED] = row[AXIAL_STIFFNESS] * largest
        if not row[AXIAL_OMEGA_SQUARED] <= LARGEST**2:
            one = scene.cables[c]
            raise SceneError(
                f"The frequencies of a cable must be up to {LARGEST:g} rad/s, but cable {quoted(one.name)} has segments of "
                f"{one.stiffness:g} N/m on nodes of {1.0 / max(at_start, of_inside, at_end):g} kg."
            )
    mass = np.empty(first + len(ends))
    for own, (_, count, node, _, _) in zip(inside, runs, strict=True):
        mass[node : node + count - 1] = own
    mass[first:] = ends
    table = np.array(axial).reshape(-1, AXIAL_COLUMNS)
    return mass, table


def _params_of(model, scene):
    """Numbers of the effects of a scene that differs from that of a model in lengths of cables alone."""
    mass, axial = _numbers(scene, model.node_of, model.cable, model.n_free)
    other = replace(model, scene=scene, mass=mass, axial=axial)
    return _effect_tables(model.forces, other, model).params


def _axial_row(one):
    """Row of ``axial`` of a cable, a list, but for the frequency, which its nodes decide."""
    row = [0.0] * AXIAL_COLUMNS
    spring = (0.0, 0.0) if one.inextensible else (one.stiffness, one.dashpot)
    without_damper = one.inextensible and one.compression == "damped"  # then nothing acts where it is slack
    row[:AXIAL_OMEGA_SQUARED] = (
        one.L0 * (1.0 + one.permanent_strain),
        *spring,
        *SWITCHES["none" if without_damper else one.compression],
    )
    row[AXIAL_PUSH_SHARE] = max(row[AXIAL_PUSH_SHARE], one.EA_compression / one.EA_first)
    row[AXIAL_INEXTENSIBLE] = one.inextensible
    row[AXIAL_L0_BEFORE] = row[AXIAL_L0]
    return row


def _curves(cables, table):
    """Rows of ``springs`` of all tension-strain curves, each one once, and behind those of a polyester rope its working curves.

    Writes where the former of a cable are into the table.
    """
    first, rows = {((), ()): (0, 0)}, []
    for row, one in zip(table, cables, strict=True):
        curve = one.springs, one.working_rows
        if curve not in first:
            first[curve] = len(rows), len(rows) + len(one.springs)
            rows.extend((*one.springs, *one.working_rows))
        row[CABLE_CURVE:] = first[curve]
    return np.array(rows, float).reshape(-1, 2)


def _groups(cable, axial, creeps):
    """Cables that hang on a prescribed point and are alike but for their numbers, by fours, and all others; the tables of `Net`.

    Those that creep, of which ``creeps`` (n_cables,) tells, are never taken at once.

    Returns
    -------
    cable_groups, single_cables, single_kinds : int64
    """
    short, bordered = cable[:, CABLE_SEGMENTS] == 1, cable[:, CABLE_JOINS_FREE_POINTS] == 1
    alike = {}
    for c in np.flatnonzero(~(short | bordered)):
        row, of = cable[c], axial[c]
        alone = c if creeps[c] else -1
        same = (
            row[CABLE_SEGMENTS],
            row[CABLE_CURVE_END],
            of[AXIAL_PUSH_SHARE],
            of[AXIAL_TWO_WAY_DAMPER],
            of[AXIAL_INEXTENSIBLE],
            alone,
        )
        alike.setdefault(same, []).append(c)
    fours = [cables[i : i + WIDTH] for cables in alike.values() for i in range(0, len(cables), WIDTH)]
    groups = [[*four, *[four[-1]] * (WIDTH - len(four)), len(four)] for four in fours if len(four) > 1]
    kinds = np.flatnonzero(short), np.flatnonzero(bordered & ~short), sorted(four[0] for four in fours if len(four) == 1)
    single = np.concatenate(kinds).astype(np.int64)
    return np.array(groups, np.int64).reshape(-1, WIDTH + 1), single, np.cumsum([len(kind) for kind in kinds[:2]]).astype(np.int64)


def _effect_tables(effects, model, known=None):
    """Tables and addresses of the compiled functions of the effects present; ``model`` is complete but for them.

    What effects say of themselves is compared with what they do, but for those of the model ``known`` and those of the kinds of
    the library that it has.
    """
    checked, checked_kinds = ((), ()) if known is None else (known.forces, known.kinds_of_library)
    index, params, inner, begin = [], [], [], 0
    for effect in effects:
        of_known = type(effect) in checked_kinds or effect in checked
        if not of_known:
            check_kernels(effect)
        own_index, own_params = effect.table(model)
        own_index, own_params = np.asarray(own_index, np.int64), np.asarray(own_params, float)
        if own_index.ndim != 1 or own_params.ndim != 1:
            raise SceneError(
                "The `table` of an effect must return two flat arrays, index and params, but of effect "
                f"{type(effect).__name__} they have shapes {own_index.shape} and {own_params.shape}."
            )
        if not of_known:
            check_claims(effect, model, own_index, own_params)
        index.append(own_index)
        params.append(own_params)
        inner.append(begin + effect.inner_states(own_index, own_params))
        begin += len(own_params)
    alike = known is not None and effects == checked  # then the functions are the same, too
    return Effects(
        address=known.effects.address
        if alike
        else np.array([addresses(effect) for effect in effects], np.int64).reshape(-1, len(SLOTS)),
        index=_joined(index, np.int64),
        index_at=np.array([0, *accumulate(map(len, index))], np.int64),
        params=_joined(params, float),
        params_at=np.array([0, *accumulate(map(len, params))], np.int64),
        linear_in_node_state=int(all(effect.linear_in_node_state for effect in effects)),
        inner=_joined(inner, np.int64),
    )


def _joined(parts, kind):
    """A new flat array of flat ones, one behind the other, which may be none."""
    return parts[0].copy() if len(parts) == 1 else np.concatenate([*parts, np.empty(0, kind)])
