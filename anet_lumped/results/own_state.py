"""A state from shapes and velocities of a user's own, by the names of cables and points."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, check_number, check_vector, nearest, quoted, shown
from anet_lumped.model.build import build
from anet_lumped.model.model import Model
from anet_lumped.scene.scene import Cable, Driven, Fixed, OnBody, Scene, check_scene

CLOSE = 1e-6  # of a cable's length: by how much the end of its shape may miss the point where it ends


def places_and_velocities(scene: Scene, shapes: Any, velocities: Any, points: Any, t: Any) -> tuple[Model, np.ndarray, np.ndarray]:
    """Model of a scene, and places and velocities of its nodes (n, 3) [m], [m/s], for `State.of`.

    Raises
    ------
    InputError : a name that the scene lacks, no array of places, a shape that misses its points, velocities that disagree
    """
    check_scene(scene)
    t = check_number("t", t, "s", "a State")
    model = build(scene)
    cables = {cable.name for cable in scene.cables}
    shapes, velocities, points = _named("shapes", shapes), _named("velocities", velocities), _named("points", points)
    free = {point.name for point in scene.free_points}
    for argument, given, known in (("shapes", shapes, cables), ("points", points, free), ("velocities", velocities, cables | free)):
        for name in given:
            if name not in known:
                what = {"shapes": "a cable", "points": "a free point"}.get(argument, "a cable or a free point")
                raise InputError(
                    f"Argument `{argument}` must name {what}, but {quoted(name)} is none" + (nearest(name, known) or ".")
                )
    curves = {name: _rows(f"The shape of cable {quoted(name)}", shape) for name, shape in shapes.items()}
    held = {point.name: _held(point, t) for point in scene.all_points if isinstance(point, Fixed | Driven | OnBody)}
    at = {name: place for name, (place, _) in held.items()}
    at |= {name: np.array(check_vector("points", place, "m", quoted(name))) for name, place in points.items()}
    turned = {name: _runs_backwards(scene.cable(name), curve, at, scene) for name, curve in curves.items()}
    curves = {name: curve[::-1] if turned[name] else curve for name, curve in curves.items()}
    for name, curve in curves.items():
        for end, place in ((scene.cable(name).start, curve[0]), (scene.cable(name).end, curve[-1])):
            _check_meets(scene.cable(name), end, place, at.setdefault(end, place))
    for point in scene.free_points:
        if point.name not in at and point.at is not None:
            at[point.name] = np.array(point.at)
    q, v = np.zeros((2, model.n, 3))
    for name, place in at.items():
        q[model.node_of[name]] = place
    for cable in scene.cables:
        q[model.nodes(cable.name)] = _shape(cable, curves.get(cable.name), at)
    _write_velocities(model, v, velocities, curves, turned)
    for name, (_, velocity) in held.items():
        v[model.node_of[name]] = velocity
    return model, q, v


def _named(argument: str, value: Any) -> Mapping[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise InputError(f"Argument `{argument}` must be a dict by names, but it is {shown(value)}.")
    return value


def _rows(what: str, value: Any) -> np.ndarray:
    """(k, 3) finite numbers, k at least 2."""
    try:
        rows = np.array(value, float)
    except (TypeError, ValueError, OverflowError):
        rows = np.zeros(0)
    if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) < 2:
        raise InputError(f"{what} must be an array (k, 3) with k at least 2, but it is {shown(value)}.")
    if not np.isfinite(rows).all():
        row = int(np.argmin(np.isfinite(rows).all(axis=1)))
        raise InputError(f"{what} must be finite, but row {row} is {tuple(rows[row].tolist())}.")
    return rows


def _held(point: Any, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Place and velocity of a point that its scene places."""
    if isinstance(point, Driven):
        return point.path.at(t)[:2]
    return np.array(point.at, float), np.zeros(3)


def _runs_backwards(cable: Cable, curve: np.ndarray, at: Mapping[str, np.ndarray], scene: Scene) -> bool:
    """Whether a shape is given from the cable's end to its start, by the places that are known of both."""
    known = dict(at)
    for name in (cable.start, cable.end):
        place = getattr(scene.point(name), "at", None)
        if name not in known and place is not None:
            known[name] = np.array(place)
    ahead = [(name, i) for name, i in ((cable.start, 0), (cable.end, -1)) if name in known]
    miss = sum(float(np.linalg.norm(curve[i] - known[name])) for name, i in ahead)
    return sum(float(np.linalg.norm(curve[-1 - i] - known[name])) for name, i in ahead) < miss


def _check_meets(cable: Cable, end: str, place: np.ndarray, at: np.ndarray) -> None:
    miss = float(np.linalg.norm(place - at))
    if miss > CLOSE * cable.length:
        raise InputError(
            f"A shape must end where its cable does, but that of cable {quoted(cable.name)} ends {miss:.3g} m from point "
            f"{quoted(end)}, which is at {tuple(np.round(at, 6).tolist())}."
        )


def _shape(cable: Cable, curve: np.ndarray | None, at: Mapping[str, np.ndarray]) -> np.ndarray:
    """(segments + 1, 3) places of a cable's nodes, by arc length along a curve; straight without one."""
    for end in (cable.start, cable.end):
        if end not in at:
            raise InputError(
                f"A State needs the place of every point, but point {quoted(end)} has no `at`, and neither `points` nor the "
                "shape of a cable gives one."
            )
    ends = np.array([at[cable.start], at[cable.end]])
    nodes = _along(ends if curve is None else curve, ends if curve is None else curve, cable.segments)
    nodes[0], nodes[-1] = ends
    return nodes


def _along(values: np.ndarray, curve: np.ndarray, segments: int) -> np.ndarray:
    """(segments + 1, 3) values at equal arc lengths along a curve; those given where they are one for each node."""
    if len(curve) == segments + 1:
        return values.copy()
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    where = np.linspace(0.0, s[-1], segments + 1)
    return np.column_stack([np.interp(where, s, column) for column in values.T])


def _write_velocities(model: Model, v: np.ndarray, velocities: Mapping, curves: Mapping, turned: Mapping) -> None:
    """Write the velocities of cables and free points to v (n, 3)."""
    scene, at_points, of_ends = model.scene, {}, dict[str, list[tuple[str, np.ndarray]]]()
    points = {point.name for point in scene.free_points}
    for name, given in velocities.items():
        if np.shape(given) == (3,) and name in points:
            at_points[name] = np.array(check_vector("velocities", given, "m/s", quoted(name)))
            continue
        if name not in scene.cable_numbers:
            raise InputError(f"The velocity of point {quoted(name)} must be three numbers [m/s], but it is {shown(given)}.")
        cable, what = scene.cable(name), f"The velocity of cable {quoted(name)}"
        rows = _rows(what, np.broadcast_to(given, (2, 3)) if np.shape(given) == (3,) else given)
        curve = curves.get(name)
        if np.shape(given) == (3,):
            along = np.broadcast_to(rows[0], (cable.segments + 1, 3))
        elif curve is None or len(rows) != len(curve):
            need = (
                f"{len(curve)} rows, one for each place of its shape" if curve is not None else "a shape with a place for each row"
            )
            raise InputError(f"{what} must have {need}, or be three numbers for all of it, but it has {len(rows)} rows.")
        else:
            along = _along(rows[::-1] if turned[name] else rows, curve, cable.segments)
        v[model.nodes(name)] = along
        for end, velocity in ((cable.start, along[0]), (cable.end, along[-1])):
            of_ends.setdefault(end, []).append((name, velocity))
    for end, found in of_ends.items():
        for name, velocity in found[1:]:
            if end in points and end not in at_points and not np.allclose(velocity, found[0][1], rtol=1e-9, atol=1e-12):
                raise InputError(
                    f"Cables that meet must have one velocity there, but at point {quoted(end)} cables {quoted(found[0][0])} and "
                    f"{quoted(name)} have {tuple(found[0][1].tolist())} and {tuple(velocity.tolist())} m/s; give the point its own."
                )
    for name, velocity in at_points.items():
        v[model.node_of[name]] = velocity
