"""Scene → Model: nodes, segments and the elimination order."""

from dataclasses import replace
from functools import lru_cache

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
from anet_lumped.model.model import Model, ends_of_segments
from anet_lumped.model.net import Effects
from anet_lumped.model.tables import (
    AXIAL_COLUMNS,
    AXIAL_INEXTENSIBLE,
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
    CABLE_FIRST_SEGMENT,
    CABLE_JOINS_FREE_POINTS,
    CABLE_SEGMENTS,
)

BYTES_OF_NODE = 1e3  # of a model and of what a computation needs, about


@lru_cache(maxsize=8)
def build(scene):
    """Cut a scene into nodes and segments and choose the elimination order.

    Returns
    -------
    Model
    """
    n_interior = sum(cable.segments - 1 for cable in scene.cables)
    check_most(BYTES, BYTES_OF_NODE * n_interior, f"A scene of {n_interior + len(scene.cables)} segments")
    points = order_of_points(scene)
    free = set(points.free)
    node_of = {name: n_interior + i for i, name in enumerate([*points.free, *points.fixed, *points.driven])}
    n, n_free = n_interior + len(node_of), n_interior + len(free)
    mass = np.zeros(n)
    for name in points.free:
        mass[node_of[name]] = scene.point(name).mass
    cable = np.full((len(scene.cables), CABLE_COLUMNS), -1, np.int64)
    axial = np.zeros((len(scene.cables), AXIAL_COLUMNS))
    flipped = np.zeros(len(scene.cables), bool)
    segment = node = 0
    for c, one in enumerate(scene.cables):
        flipped[c] = one.start in free and one.end not in free
        start, end = (one.end, one.start) if flipped[c] else (one.start, one.end)
        bordered = start in free and end in free
        cable[c, : CABLE_JOINS_FREE_POINTS + 1] = segment, one.segments, node, node_of[start], node_of[end], bordered
        if bordered:
            cable[c, CABLE_BLOCK_START_END : CABLE_BLOCK_END_START + 1] = points.blocks_of_pair[start, end]
        spring = (0.0, 0.0) if one.inextensible else (one.stiffness, one.dashpot)
        without_damper = one.inextensible and one.compression == "damped"  # then nothing acts where it is slack
        axial[c, :AXIAL_OMEGA_SQUARED] = one.L0, *spring, *SWITCHES["none" if without_damper else one.compression]
        axial[c, AXIAL_PUSH_SHARE] = max(axial[c, AXIAL_PUSH_SHARE], one.EA_compression / one.EA_first)
        axial[c, AXIAL_INEXTENSIBLE] = one.inextensible
        axial[c, AXIAL_L0_BEFORE] = one.L0
        half = 0.5 * one.mass_per_length * one.L0
        mass[node : node + one.segments - 1] = 2.0 * half
        mass[[node_of[start], node_of[end]]] += half
        segment += one.segments
        node += one.segments - 1
    mobility = np.append(1.0 / mass[:n_free], np.zeros(n - n_free))
    of_ends = mobility[ends_of_segments(cable)]
    if len(cable):
        with np.errstate(over="ignore"):
            largest = np.maximum.reduceat(of_ends.sum(axis=1), cable[:, CABLE_FIRST_SEGMENT])
            axial[:, AXIAL_OMEGA_SQUARED] = axial[:, AXIAL_STIFFNESS] * largest
    for c in np.flatnonzero(~(axial[:, AXIAL_OMEGA_SQUARED] <= LARGEST**2)):
        one, first = scene.cables[c], cable[c, CABLE_FIRST_SEGMENT]
        raise SceneError(
            f"The frequencies of a cable must be up to {LARGEST:g} rad/s, but cable {quoted(one.name)} has segments of "
            f"{one.stiffness:g} N/m on nodes of {1.0 / of_ends[first : first + one.segments].max():g} kg."
        )
    springs = _curves(scene.cables, cable)
    groups, single, kinds = _groups(cable, axial, np.array([one.creeps for one in scene.cables]))
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
        bodies=points.bodies(node_of, n_interior, cable),
        effects=None,
        lengths=None,
    )
    model = replace(model, effects=_effect_tables(model.forces, model))
    return replace(model, lengths=rest_lengths.table(scene, model, build.__wrapped__))


def _curves(cables, table):
    """Rows of ``springs`` of all tension-strain curves, each one once; writes where those of a cable are into the table."""
    first, rows = {(): (0, 0)}, []
    for row, one in zip(table, cables, strict=True):
        if one.springs not in first:
            first[one.springs] = len(rows), len(rows) + len(one.springs)
            rows.extend(one.springs)
        row[CABLE_CURVE:] = first[one.springs]
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


def _effect_tables(effects, model):
    """Tables and addresses of the compiled functions of the effects present; ``model`` is complete but for them."""
    index, params = [], []
    for effect in effects:
        check_kernels(effect)
        own = [np.asarray(numbers, kind) for numbers, kind in zip(effect.table(model), (np.int64, float), strict=True)]
        if any(numbers.ndim != 1 for numbers in own):
            raise SceneError(
                "The `table` of an effect must return two flat arrays, index and params, but of effect "
                f"{type(effect).__name__} they have shapes {own[0].shape} and {own[1].shape}."
            )
        check_claims(effect, model, *own)
        index.append(own[0])
        params.append(own[1])
    return Effects(
        address=np.array([addresses(effect) for effect in effects], np.int64).reshape(-1, len(SLOTS)),
        index=np.concatenate([*index, np.empty(0, np.int64)]),
        index_at=np.cumsum([0, *map(len, index)]).astype(np.int64),
        params=np.concatenate([*params, np.empty(0)]),
        params_at=np.cumsum([0, *map(len, params)]).astype(np.int64),
        linear_in_node_state=int(all(effect.linear_in_node_state for effect in effects)),
    )
