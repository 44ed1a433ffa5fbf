"""Forces at the ends of cables, and reactions of what holds a net, by the balance of forces on the nodes there.

The last node of a cable carries half a segment of it. With the tension T of that segment, its direction n from the node, the force
f of the effects on the half segment (weight, buoyancy, drag, contact, bending), its mass m and added mass A and the acceleration a
of the node, the cable pulls at its point by

    F = T n + f - (m I + A) a .

The end tension is the size of F. A support acts on the net by R = -sum F over the cables that end there, and on bodies that are
pinned to it. What drives a body acts against what else acts on that, too (`driven_loads`). Of a state at rest a = 0. A fixed point
has none, a driven point that of its path; a free point that of all forces on it, (M I + A) a = sum T n + f; and the points of a
body that of the body (`body_accelerations`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import InputError, quoted
from anet_lumped.model.build import build
from anet_lumped.model.model import Model
from anet_lumped.model.remainder import Pieces, Remainder, remainder
from anet_lumped.model.rest_lengths import numbers_at
from anet_lumped.model.tables import CABLE_END, CABLE_FIRST_SEGMENT, CABLE_SEGMENTS, CABLE_START
from anet_lumped.prescribed.paths import pack
from anet_lumped.scene.joints import joined_to
from anet_lumped.scene.payload_change import carried_from
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, OnBody, Scene

from .body_accelerations import Joined, of_joined
from .driven_loads import force_to_drive, has_loads, on_it
from .events import PAYLOAD, Event, broken, released

GROUND = "ground"
"""What `reaction` calls the ground of a scene, unless a point or body has that name."""


class UnknownForceError(InputError):
    """A force that the states do not tell, as what drives or pushes from outside is not part of the scene."""


class Rows(NamedTuple):
    """States of a net between two events.

    Parameters
    ----------
    left : Remainder, what is left of the scene then
    t : (k,) float64 [s]
    q, v : (k, n, 3) float64 [m], [m/s], of what is left
    places : (k, n, 3) float64 [m], about an origin near the net if ``q`` is rounded, else ``q``
    tension : (k, n_segments) float64 [N], of the whole scene's segments
    moves : bool, whether nodes may have an acceleration
    pushed : bool, whether forces act that the scene does not have
    """

    left: Remainder
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    places: np.ndarray
    tension: np.ndarray
    moves: bool
    pushed: bool


def rows_of_state(state: Any) -> Rows:
    """`Rows` of one State. One that is an equilibrium has no accelerations."""
    near = None if state.q_near is None else state.q_near[None]
    arrays = np.array([state.t], float), state.q[None], state.v[None], state.segment_tension[None], near
    return _rows(state.model, tuple(state.events), arrays, moves=state.residual is None, pushed=state.pushed)


def rows_of_run(run: Any) -> list[Rows]:
    """`Rows` of a Run, between one event and the next, in the order of its saved times."""
    happened = [tuple(run.events_before(k)) for k in range(len(run.t))] if run.events else [()] * len(run.t)
    found, begin = [], 0
    for k in range(1, len(run.t) + 1):
        if k == len(run.t) or happened[k] != happened[begin]:
            of = slice(begin, k)
            near = None if run.q_near is None else run.q_near[of]
            arrays = run.t[of], run.q[of], run.v[of], run.segment_tension[of], near
            found.append(_rows(run.model, happened[begin], arrays, moves=True, pushed=run.pushed))
            begin = k
    return found


def _rows(model: Model, events: tuple[Event, ...], arrays: tuple, moves: bool, pushed: bool) -> Rows:
    t, q, v, tension, near = arrays
    left = _left(model, events)
    whole = left.model is model  # then nodes are in their order
    q, v = (np.ascontiguousarray(x if whole else x[:, left.node], float) for x in (q, v))
    places = q if near is None else near[:, left.node]
    return Rows(left, t, q, v, places, tension, moves, pushed)


def _pulls(now: Rows, segments: np.ndarray) -> np.ndarray:
    """Tension of segments as vectors from their first to their second ends, (k, len(segments), 3) [N]."""
    own = now.left.model
    d = now.places[:, own.ends[segments, 1]] - now.places[:, own.ends[segments, 0]]
    length = np.maximum(np.linalg.norm(d, axis=2), 1e-300)
    return (now.tension[:, now.left.segment[segments]] / length)[:, :, None] * d


def end_force(now: Rows, whole: Scene, cable: str, point: str, inertia: bool = True) -> np.ndarray:
    """Force F of a cable on the point where it ends, (k, 3) [N]; zero where its last segment has broken.

    Parameters
    ----------
    now : Rows
    whole : Scene that was cut, of which a part may be left
    cable, point : names
    inertia : bool, whether to take off what accelerates the half segment

    Raises
    ------
    InputError : the cable does not end at that point
    UnknownForceError : see `_acceleration`
    """
    own, held = whole.cable(cable), now.left.held
    whole.point(point)
    if point not in (own.start, own.end):  # it may hold one of them, or have held it
        point = next((one.point for one in whole.releases if one.holder == point and one.point in (own.start, own.end)), point)
    if point not in (own.start, own.end):
        raise InputError(
            f"A cable has an end tension where it ends, at {quoted(own.start)} or {quoted(own.end)} for cable {quoted(cable)}, "
            f"but {quoted(point)} was given."
        )
    piece = _piece_at(now.left.model.scene, own, point == own.start)
    if piece is None:
        return np.zeros((len(now.t), 3))
    point = held.get(point, point)
    if not (inertia and now.moves) and _only_weighs(now.left.model):  # of a net with thousands of cables
        return _pull_at(now, piece, point) + piece.half_segment_mass * now.left.model.scene.gravity
    model, alone = _apart(now, [piece])
    node = model.nodes(piece.name)[0 if point == piece.start else -1]
    total = _pull_at(now, piece, point) + effect_forces(model, alone)[:, node]
    if inertia and now.moves:
        mass = masses(model, alone)[:, node, None, None] * np.eye(3) + added_masses(model, alone)[:, node]
        total = total - np.einsum("kxy,ky->kx", mass, _acceleration(now, point))
    return total


def end_forces_at_rest(now: Rows) -> np.ndarray:
    """`end_force` of every cable of a scene at its start and its end in a state at rest, (n_cables, 2, 3) [N], all at once."""
    model = now.left.model
    cables, (first, count) = model.scene.cables, model.cable[:, [CABLE_FIRST_SEGMENT, CABLE_SEGMENTS]].T
    if not cables:
        return np.zeros((0, 2, 3))
    total = np.stack([_pulls(now, first)[0], -_pulls(now, first + count - 1)[0]], axis=1)
    total[model.flipped] = total[model.flipped, ::-1]
    if _only_weighs(model):
        half = np.array([cable.half_segment_mass for cable in cables])
        return total + half[:, None, None] * model.scene.gravity
    apart, rows = _apart(now, cables)
    ends = apart.cable[:, [CABLE_START, CABLE_END]]
    ends[apart.flipped] = ends[apart.flipped, ::-1]
    return total + effect_forces(apart, rows)[0, ends]


@lru_cache(maxsize=16)
def _only_weighs(model: Model) -> bool:
    """Whether nothing but weight acts on the segments of a model."""
    of_cables = [part for effect in model.scene.effects if (part := effect.of_cables()) is not None and part.kernels()]
    return all(effect.dead_load and any(effect.uniform_acceleration) for effect in of_cables)


def reaction(now: Rows, whole: Scene, name: str) -> np.ndarray:
    """Force with which a fixed or driven point, a driven body, the pin of a body or the ground acts on the net, (k, 3) [N].

    Parameters
    ----------
    now : Rows
    whole : Scene that was cut, of which a part may be left
    name : of the point; of the body, which is driven, and then takes what acts on itself too, or pinned; or "ground"

    Raises
    ------
    InputError : what moves freely, no ground, or an acceleration that is not known
    """
    bodies = {body.name: body for body in whole.bodies}
    points = {point.name: point for point in whole.all_points}
    if name == GROUND and name not in points:
        return _reaction_of_ground(now, whole)
    body, names, total = bodies.get(name), [name], np.zeros((len(now.t), 3))
    if body is not None and body.is_driven:
        names = [point.name for point in body.points]
        if has_loads(body):
            _refuse_unknown(now, body.points[0])
            total = total + force_to_drive(now, name, effect_forces, added_masses)
    elif body is not None and body.pinned is not None:
        return np.array([one.joint[name] for one in _joined(now, name)])
    elif not isinstance(whole.point(name), Fixed | Driven):
        raise InputError(
            "A reaction is the force of a fixed or driven point, of a driven body, of the pin of a body or of the ground, but "
            f"{quoted(name)} moves freely."
        )
    for one in whole.bodies:
        if one.pinned_to in names:
            total = total + np.array([found.joint[one.name] for found in _joined(now, one.name)])
    names += [held for held, holder in now.left.held.items() if holder in names]
    ends = [(cable.name, end) for cable in whole.cables for end in (cable.start, cable.end) if end in names]
    return total - sum((end_force(now, whole, *one) for one in ends), np.zeros((len(now.t), 3)))


def effect_forces(model: Model, now: Rows, only_ground: bool = False) -> np.ndarray:
    """Force of the effects of a model, or of the ground alone, on each of its nodes, (k, n, 3) [N]."""
    total = np.zeros_like(now.q, order="C")
    for e, effect in enumerate(model.forces):
        if effect.is_ground or not only_ground:
            force = effect.kernels()["force"]
            for k, (t, index, params) in enumerate(_numbers(model, now.t, e)):
                force(t, now.q[k], now.v[k], index, params, total[k])
    return total


def added_masses(model: Model, now: Rows) -> np.ndarray:
    """Added mass of each moving node, (k, n_free, 3, 3) [kg]."""
    added = np.zeros((len(now.t), model.n_free, 3, 3))
    for e, effect in enumerate(model.forces):
        if "inertia" in effect.kernels():
            inertia = effect.kernels()["inertia"]
            for k, (t, index, params) in enumerate(_numbers(model, now.t, e)):
                inertia(t, now.q[k], index, params, added[k])
    return added


def masses(model: Model, now: Rows) -> np.ndarray:
    """Mass of each node, (k, n) [kg]."""
    if not len(model.lengths.cable):
        return np.broadcast_to(model.mass, (len(now.t), model.n))
    return np.array([numbers_at(model, t)[0] for t in now.t.tolist()])


def _numbers(model: Model, t: np.ndarray, e: int) -> Iterator[tuple[float, np.ndarray, np.ndarray]]:
    """Times, and the numbers of the e-th effect at each."""
    changing, (index, params) = len(model.lengths.cable) > 0, model.effects.numbers(e)
    for time in t.tolist():
        yield time, index, model.effects._replace(params=numbers_at(model, time)[1]).numbers(e)[1] if changing else params


@lru_cache(maxsize=16)
def _left(model: Model, events: tuple[Event, ...]) -> Remainder:
    """What is left of a scene after events."""
    payloads: dict[str, dict[str, float]] = {}
    lost = broken(events)
    for event in events:
        if event.kind == PAYLOAD:
            payloads[event.where] = payloads.get(event.where, {}) | carried_from(event)
    if not payloads and not lost and not model.scene.releases:
        return Remainder(model, np.arange(model.n), np.arange(model.n_segments))
    return remainder(model, payloads, lost, released(events))


@lru_cache(maxsize=256)
def _cut_apart(model: Model, names: tuple[str, ...]) -> Model:
    """Cables whose ends carry nothing and move freely, each alone, so that all that is spread over cables acts on them."""
    scene, others = model.scene, dict.fromkeys(model.scene.cable_numbers, ())
    own = [scene.cable(name) for name in names]
    for name in names:
        del others[name]
    if len(names) > 1:
        own = [replace(cable, start=f"{cable.name} start", end=f"{cable.name} end") for cable in own]
    effects = [part.after_break(others, own) for part in (effect.of_cables() for effect in scene.effects) if part is not None]
    ends = [Free(end) for cable in own for end in (cable.start, cable.end)]
    return build.__wrapped__(Pieces(ends, own, [one for one in effects if one is not None]))


def _piece_at(scene: Scene, whole: Cable, at_start: bool) -> Cable | None:
    """The cable of a scene that is, or that is left of, a whole one, and has its start, or its end."""
    if whole.name in scene.cable_numbers:
        return scene.cable(whole.name)
    pieces = [cable for cable in scene.cables if cable.name.startswith(f"{whole.name}[")] if isinstance(scene, Pieces) else []
    first, last = f"{whole.name}[0:", f":{whole.segments}]"
    return next((one for one in pieces if (one.name.startswith(first) if at_start else one.name.endswith(last))), None)


def _pull_at(now: Rows, cable: Cable, point: str) -> np.ndarray:
    """Pull of the segment that ends at a point, (k, 3) [N]."""
    model = now.left.model
    first, count = model.segment_run(model.scene.cable_numbers[cable.name])
    at_start = (point == cable.start) != model.flipped[model.scene.cable_numbers[cable.name]]
    segment = first if at_start else first + count - 1
    pull = _pulls(now, np.array([segment]))[:, 0]
    return pull if model.ends[segment, 0] == model.node_of[point] else -pull


def _apart(now: Rows, cables: Sequence[Cable]) -> tuple[Model, Rows]:
    """Cables each alone, and their places and velocities."""
    names = tuple(cable.name for cable in cables)
    whole, model = now.left.model, _cut_apart(now.left.model, names)
    nodes, places = (np.concatenate([one.nodes(name) for name in names]) for one in (model, whole))
    q, v = np.empty((2, len(now.t), model.n, 3))
    q[:, nodes], v[:, nodes] = now.q[:, places], now.v[:, places]
    return model, now._replace(q=q, v=v)


def _acceleration(now: Rows, name: str) -> np.ndarray:
    """Acceleration of a point, (k, 3) [m/s2].

    Raises
    ------
    UnknownForceError : a point that is driven or pushed from outside
    """
    model = now.left.model
    point, node = model.scene.point(name), model.node_of[name]
    if isinstance(point, Fixed):
        return np.zeros((len(now.t), 3))
    if isinstance(point, Driven):
        return _of_path(point.path, now.t) if _refuse_unknown(now, point) else np.zeros((len(now.t), 3))
    _refuse_pushed(now, name)
    if isinstance(point, OnBody):
        return np.array([one.point[name] for one in _joined(now, point.body)])
    total, mass, added = _forces(now, [node]), masses(model, now), added_masses(model, now)
    return np.linalg.solve(mass[:, node, None, None] * np.eye(3) + added[:, node], total[:, node, :, None])[..., 0]


def _refuse_pushed(now: Rows, name: str) -> None:
    """Refuse what moves freely under forces that the scene does not have."""
    if now.pushed:
        raise UnknownForceError(
            f"A force at an end needs all forces there, but {quoted(name)} moves freely, and forces from outside act that the "
            "scene does not have."
        )


def _refuse_unknown(now: Rows, point: Any) -> bool:
    """Refuse a driven point whose acceleration is not known; return whether it may have one."""
    if not now.moves:
        return False
    if "external" not in _kinds(point.path):
        return True
    node = now.left.model.node_of[point.name]
    if len(now.t) > 1 and not now.v[:, node].any() and not np.ptp(now.q[:, node], axis=0).any():
        return False  # nobody drove it
    raise UnknownForceError(
        f"A force at an end needs the acceleration there, but {quoted(point.name)} is driven from outside, by a Session."
    )


def _forces(now: Rows, nodes: list[int]) -> np.ndarray:
    """Forces of effects on all nodes, and of cables on some of them, (k, n, 3) [N]."""
    model = now.left.model
    total = effect_forces(model, now)
    ends = [
        (s, i, sign) for column, sign in ((0, 1.0), (1, -1.0)) for i in nodes for s in np.flatnonzero(model.ends[:, column] == i)
    ]
    pulls = _pulls(now, np.array([s for s, _, _ in ends], np.int64))
    for k, (_, i, sign) in enumerate(ends):
        total[:, i] += sign * pulls[:, k]
    return total


def _joined(now: Rows, body: str) -> list[Joined]:
    """`Joined` of a body at each time."""
    _refuse_pushed(now, body)
    model = now.left.model
    bodies = joined_to(model.scene.bodies, body)
    total = _forces(now, [model.node_of[point.name] for one in bodies for point in one.points])
    held = [one.pinned_to for one in bodies if one.pinned_to is not None]
    points = {name: _acceleration(now, name) for name in held if not isinstance(model.scene.point(name), OnBody)}
    found = []
    for k, (q, v, f, m, A) in enumerate(zip(now.q, now.v, total, masses(model, now), added_masses(model, now), strict=True)):
        driven = {name: a[k] for name, a in points.items()}
        found.append(of_joined(model, body, (q, v), f, (m, A), driven))
    return found


def _of_path(path: Any, t: np.ndarray) -> np.ndarray:
    """Accelerations along a path at times t (k,), (k, 3) [m/s2]."""
    if hasattr(path, "turning"):
        return np.array([path.at(time)[2] for time in t.tolist()])
    from anet_lumped.prescribed.path_kernel import evaluate

    table, (q, v), found = pack([path]), np.empty((2, 1, 3)), np.empty((len(t), 1, 3))
    for k, time in enumerate(t.tolist()):
        evaluate(time, table, q, v, found[k])
    return found[:, 0]


def _kinds(path: Any) -> set[str]:
    """Kinds of the paths that a motion is made of."""
    return {part.kind for part in (path, getattr(path, "origin", None), getattr(path, "turning", None)) if part is not None}


def _reaction_of_ground(now: Rows, whole: Scene) -> np.ndarray:
    """Force of the ground on all moving nodes, on the half segments at supports and on driven bodies, (k, 3) [N]."""
    if not any(effect.is_ground for effect in whole.effects):
        raise InputError(f"There is no ground that could have a reaction, and no point {quoted(GROUND)}, in this scene.")
    model = now.left.model
    total = effect_forces(model, now, only_ground=True)[:, : model.n_free].sum(axis=1)
    for cable in model.scene.cables:
        for end in (cable.start, cable.end):
            if model.node_of[end] >= model.n_free:
                alone, rows = _apart(now, [cable])
                total = total + effect_forces(alone, rows, only_ground=True)[:, alone.node_of[end]]
    for body in model.scene.bodies:
        if body.is_driven and has_loads(body):
            alone, rows = on_it(now, body.name)
            total = total + effect_forces(alone, rows, only_ground=True)[:, alone.bodies.node].sum(axis=1)
    return total
