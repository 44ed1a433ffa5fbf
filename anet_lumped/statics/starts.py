"""Shapes to start from: given by a user, straight between the points, or above obstacles."""

from collections import Counter
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from anet_lumped.checks import InputError, nearest, number, quoted, shown
from anet_lumped.model.model import Model
from anet_lumped.model.reach import shortfall
from anet_lumped.results.events import broken_at
from anet_lumped.results.run import Run
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Driven, Fixed, Free, OnBody, SceneError

from .forces_at_rest import force_of_effects
from .soft_contacts import solids

WORDS = ("equilibrium", "calm", "straight")
Start = str | State | Mapping[str, ArrayLike]
GOLDEN_ANGLE = 2.399963229728653  # [rad]: multiples of it are never near each other on the circle
CONVEX = 1e-9  # of the largest curvature of an effect's energy: a smaller negative one is rounding
OBSTACLE = 10.0  # an obstacle exerts so many times the force on cables that go through it than on cables above it


def start_state(model: Model, start: Start, straight_between: bool = False) -> State:
    """State to start from, with arrays of its own.

    Parameters
    ----------
    model : Model
    start : "straight", State or dict
        "straight" has the nodes evenly spaced between the places of the points, at rest; a dict holds the places of each cable's
        nodes by the cable's name, (segments + 1, 3) [m], at rest.
    straight_between : bool
        Whether cables that do not stretch may be straight between points that do not move freely.

    Raises
    ------
    InputError
        Another word; a State or a dict of other cables; a number that is not finite; cables that do not stretch and do not reach.
    """
    state = _adopt(model, start) if isinstance(start, State) else _at_rest(model, start)
    scene = model.scene
    free = {point.name: state.position(point.name) for point in scene.all_points if isinstance(point, Free)}
    gone = broken_at(scene, state.events, state.t)
    short = shortfall(scene, state.t, straight=straight_between, without=gone) or shortfall(scene, state.t, free, without=gone)
    if short is not None:
        raise InputError(short.words)
    return state


def check_start_kind(start: Any) -> None:
    """Refuse what is no start of any scene.

    Raises
    ------
    InputError
    """
    if not (isinstance(start, State | Mapping) or (isinstance(start, str) and start in WORDS)):
        raise _no_start(start)


def _no_start(start):
    other = (
        "a Run has States, run.final and run.state(k)"
        if isinstance(start, Run)
        else "the shape of each cable by its name will do, too"
    )
    return InputError(f'Argument `start` must be "equilibrium", "calm", "straight" or a State, but it is {shown(start)}; {other}.')


def _at_rest(model, start):
    """State of a word or of shapes."""
    if isinstance(start, Mapping):
        q = _of_shapes(model, start)
    elif isinstance(start, str) and start == "straight":
        q = straight(model)
    else:
        raise _no_start(start)
    still = np.zeros_like(q)
    return State(model, 0.0, q, still, np.zeros(model.n_segments))


def straight(model: Model) -> np.ndarray:
    """(n, 3) places with every cable's nodes evenly spaced between its points' places [m]."""
    at = {}
    for point in model.scene.all_points:
        at[point.name] = _prescribed(point) if not isinstance(point, Free) else point.at
        if at[point.name] is None:
            raise SceneError(f'start="straight" needs the place of every point, but free point {quoted(point.name)} has no `at`.')
    return spread(model, {name: np.asarray(place, float) for name, place in at.items()})


def spread(model: Model, at: Mapping[str, np.ndarray]) -> np.ndarray:
    """(n, 3) places with every cable's nodes evenly spaced between given places (3,) of the points [m]."""
    q = np.empty((model.n, 3))
    for cable in model.scene.cables:
        if cable.segments == 1:
            continue
        a, b = at[cable.start], at[cable.end]
        q[model.nodes(cable.name)] = a + np.linspace(0.0, 1.0, cable.segments + 1)[:, None] * (b - a)
    for point in model.scene.all_points:
        q[model.node(point.name)] = at[point.name]
    return q


def _prescribed(point: Any, t: float = 0.0) -> Any:
    """(3,) place of a point that is fixed or driven [m]."""
    return point.path.at(t)[0] if isinstance(point, Driven) else point.at


def _of_shapes(model, shapes):
    """(n, 3) places from the shapes of the cables; points that are fixed or driven are where the scene has them."""
    names = [cable.name for cable in model.scene.cables]
    for name in shapes:
        if name not in model.scene.cable_numbers:
            raise InputError(
                f"A shape to start from must be of a cable of the scene, but {quoted(name)} is none" + (nearest(name, names) or ".")
            )
    q = np.full((model.n, 3), np.nan)
    for cable in model.scene.cables:
        if cable.name not in shapes:
            raise InputError(f"Shapes to start from must be given for every cable, but cable {quoted(cable.name)} has none.")
        shape = _numbers(shapes[cable.name], f"The shape of cable {quoted(cable.name)}")
        if shape.shape != (cable.segments + 1, 3):
            raise InputError(
                f"The shape of cable {quoted(cable.name)} must have the places of its {cable.segments + 1} nodes, "
                f"({cable.segments + 1}, 3), but it is {shape.shape}."
            )
        _check_finite("position", shape, lambda i, name=cable.name: f"node {i} of cable {quoted(name)}")
        q[model.nodes(cable.name)] = shape
    for point in model.scene.all_points:
        if isinstance(point, OnBody) or not isinstance(point, Free):
            q[model.node(point.name)] = _prescribed(point)
    return q


def _numbers(value, what):
    """An array of a user's as float64."""
    try:
        array = np.asarray(value)
        if array.dtype.kind != "c":
            return array.astype(float)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{what} must be an array of numbers, but it is {shown(value)}.")


def _checked_arrays(state):
    """Places, velocities and tensions of a State that a user may have made or changed."""
    if not isinstance(state.model, Model):
        raise InputError(f"`model` of a State must be that of a scene, but it is {shown(state.model)}.")
    n, n_segments, found = state.model.n, state.model.n_segments, []
    of_nodes = {"q": (n, 3), "v": (n, 3), "shedding": (n, 4)}
    expected_shapes = of_nodes | {"segment_tension": (n_segments,), "crept": (n_segments,), "T_max": (n_segments,)}
    for name, expected in expected_shapes.items():
        what = "nodes" if name in of_nodes else "segments"
        if name in ("crept", "T_max", "shedding") and getattr(state, name) is None:
            found.append(None)
            continue
        array = _numbers(getattr(state, name), f"`{name}` of a State")
        if array.shape != expected:
            raise InputError(
                f"`{name}` of a State must have the shape {expected}, because its scene has {expected[0]} {what}, "
                f"but it has {array.shape}."
            )
        found.append(array)
    return found


def _adopt(model, state):
    """A State of the same or of a like scene as one of this model, matched by names."""
    q, v, tension = np.zeros((model.n, 3)), np.zeros((model.n, 3)), np.zeros(model.n_segments)
    if not np.isfinite(number(state.t)):
        raise InputError(f"A State to start from must have a finite time [s], but it has t={shown(state.t)}.")
    own_q, own_v, own_shedding, own_tension, *own_inner = _checked_arrays(state)
    shedding = None if own_shedding is None or not model.sheds else np.zeros((model.n, own_shedding.shape[1]))
    inner = [None if own is None or not model.creeps else np.zeros(model.n_segments) for own in own_inner]
    segments = {cable.name: cable.segments for cable in state.scene.cables}
    for cable in model.scene.cables:
        other = segments.get(cable.name)
        if other != cable.segments:
            raise InputError(
                f"A State to start from must have the scene's cables, but of cable {quoted(cable.name)} with {cable.segments} "
                f"segments it has {'none' if other is None else other}."
            )
        mine, theirs = model.nodes(cable.name), state.model.nodes(cable.name)
        q[mine], v[mine] = own_q[theirs], own_v[theirs]
        if shedding is not None and cable.Cl:
            shedding[mine[1:-1]] = own_shedding[theirs[1:-1]]
        tension[model.segments(cable.name)] = own_tension[state.model.segments(cable.name)]
        for array, own in zip(inner, own_inner, strict=True):
            if array is not None:
                array[model.segments(cable.name)] = own[state.model.segments(cable.name)]
    for body in model.scene.bodies:
        _adopt_body(model, state.model, body, (q, v), (own_q, own_v))
    for point in model.scene.all_points:
        if isinstance(point, Fixed):
            q[model.node(point.name)], v[model.node(point.name)] = point.at, 0.0
    _check_finite("position", q, model.where)
    _check_finite("velocity", v, model.where)
    if not np.isfinite(tension).all():
        s = int(np.flatnonzero(~np.isfinite(tension))[0])
        cable = model.scene.cables[model.cable_of[s]]
        raise InputError(f"A start must have finite tensions, but a segment of cable {quoted(cable.name)} has {tension[s]} N.")
    _check_inner(model, *inner)
    _check_shedding(model, shedding)
    return State(
        model, float(state.t), q, v, tension, events=state.events, crept=inner[0], T_max=inner[1], shedding=shedding
    )  # fmt: skip


def _check_shedding(model, shedding):
    """Phases are finite; frequencies and mean squares are not negative besides."""
    right = shedding is None or (np.isfinite(shedding).all(axis=1) & (shedding[:, 1:] >= 0.0).all(axis=1))
    if not np.all(right):
        i = int(np.flatnonzero(~right)[0])
        raise InputError(
            "A start must have finite phases of vortices, and frequencies and mean squares of no less than 0, but "
            f"{model.where(i)} has {shedding[i].tolist()}."
        )


def _check_inner(model, crept, T_max):
    """Slow stretches and largest tensions are finite and not negative, and polyester ropes have both or none."""
    for array, what, unit in (
        (crept, "have crept by no less than 0 m", "m"),
        (T_max, "have held a `T_max` of no less than 0 N", "N"),
    ):
        wrong = np.flatnonzero(~(np.isfinite(array) & (array >= 0.0))) if array is not None else ()
        if len(wrong):
            name = quoted(model.scene.cables[model.cable_of[wrong[0]]].name)
            has = "has by" if unit == "m" else "has"
            raise InputError(f"A start must {what}, but a segment of cable {name} {has} {array[wrong[0]]} {unit}.")
    polyester = next((cable.name for cable in model.scene.cables if cable.working_curve is not None), None)
    if polyester is not None and (crept is None) != (T_max is None):
        have, lack = ("crept", "T_max") if T_max is None else ("T_max", "crept")
        raise InputError(
            f"A start of a cable with a working curve must have both `crept` and `T_max` or none, but that of {quoted(polyester)} "
            f"has `{have}` and no `{lack}`."
        )


def _adopt_body(model, other, body, mine, theirs):
    """Take the places and velocities of a body's points from those of a State of another model."""
    for point in body.points:
        if point.name not in other.node_of:
            raise InputError(
                f"A State to start from must have the scene's bodies with their attachments, but {quoted(point.name)} it has none."
            )
        for own, given in zip(mine, theirs, strict=True):
            own[model.node_of[point.name]] = given[other.node_of[point.name]]


def _check_finite(what, rows, where):
    """Every row of positions or velocities must be finite."""
    wrong = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(wrong):
        i, row = int(wrong[0]), rows[wrong[0]]
        raise InputError(f"A start must be finite, but the {what} of {where(i)} is ({', '.join(f'{x:g}' for x in row)}).")


class Obstacles(NamedTuple):
    """Obstacles that the hanging cables would go through.

    Parameters
    ----------
    any_met : bool
        Whether an effect exerts a much larger force on the hanging cables than on cables that are laid above it.
    above : (n, 3) float64 [m] or None
        Shape from which cables are let down onto obstacles that may push a cable to either side, such as a ball, and onto solids if
        cables meet a ground; None if there is no such obstacle. A flat ground is none.
    """

    any_met: bool
    above: np.ndarray | None


def obstacles(model: Model, net: Any, hanging: np.ndarray) -> Obstacles:
    """The obstacles of a scene.

    Above them lie the straight cables; or, where these meet an obstacle too, the hanging shape turned upside down.

    Parameters
    ----------
    model : Model
    net : Net
    hanging : (n, 3) float64 [m], shape that the dead loads alone give
    """
    kinds = [
        (e, effect)
        for e, effect in enumerate(model.forces)
        if not (effect.dead_load or effect.no_force_at_rest) and effect.coupled_neighbours < 2
    ]
    if not kinds:
        return Obstacles(False, None)
    between, any_met, above = raised(model, hanging), False, None
    arch, of_solids = 2.0 * between - hanging, solids(model)
    above_solids = between
    for e, effect in kinds:
        on_hanging, on_straight, on_arch = (_largest_force(model, net, e, q) for q in (hanging, between, arch))
        if on_hanging > OBSTACLE * min(on_straight, on_arch):
            any_met = True
            if _may_push_either_way(model, net, e, effect, hanging):
                above = arch if above is arch or on_straight > on_arch else between
        if e in of_solids and on_straight > on_arch:
            above_solids = arch
    if above is None and any_met and of_solids:  # a ground would lift the hanging cables into solids from below
        above = above_solids
    return Obstacles(any_met, above)


def _may_push_either_way(model, net, e, effect, q):
    """Whether the energy of an effect is concave in the position of a node, so that its force drives the node to either side."""
    own, reach = np.zeros((model.n_free, 3, 3)), effect.coupled_neighbours
    near, far = np.zeros((model.n_segments if reach > 0 else 0, 2, 3, 3)), np.zeros((0, 2, 3, 3))
    effect.kernels()["tangent"](0.0, q, np.zeros_like(q), *net.effects.numbers(e), 1.0, 0.0, own, near, far)
    curvatures = np.linalg.eigvalsh(0.5 * (own + own.transpose(0, 2, 1)))
    return bool(curvatures.min(initial=0.0) < -CONVEX * np.abs(curvatures).max(initial=0.0))


def raised(model: Model, hanging: np.ndarray) -> np.ndarray:
    """Shape of straight cables, (n, 3) [m]; free points that several cables hold are in the middle of all supports.

    The loose end of a cable lies at the cable's length from its other end, across gravity, each in another direction.
    """
    scene = model.scene
    held = [point.name for point in scene.all_points if not isinstance(point, Free)]
    at = {name: hanging[model.node(name)] for name in held}
    amid = np.mean([at[name] for name in held], axis=0) if held else None  # without cables every free point has a place
    only = Counter(end for cable in scene.cables for end in (cable.start, cable.end))
    loose = []
    for point in scene.all_points:
        if isinstance(point, Free):
            if point.at is None and only[point.name] == 1:
                loose.append(point.name)
            at[point.name] = amid if point.at is None else np.asarray(point.at, float)
    g = np.asarray(scene.gravity, float)
    down = g / np.linalg.norm(g) if g.any() else np.array([0.0, 0.0, -1.0])
    along = np.linalg.svd(down[None])[2][1:]  # two directions across gravity
    cable_at = {end: cable for cable in scene.cables for end in (cable.start, cable.end)}
    for i, name in enumerate(loose):
        cable = cable_at[name]
        other = cable.end if name == cable.start else cable.start
        turn = GOLDEN_ANGLE * i
        at[name] = at[other] + cable.length * (np.cos(turn) * along[0] + np.sin(turn) * along[1])
    return spread(model, at)


def _largest_force(model, net, e, q):
    """Largest force of an effect on a moving node at rest in a shape [N]."""
    f = force_of_effects(model, net, q, [e])[: model.n_free]
    return float(np.linalg.norm(f, axis=1).max(initial=0.0))
