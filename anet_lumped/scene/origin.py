"""A scene far from its origin, seen from an origin near it: places there have the digits that forces need.

A place of 5e6 m is rounded to 1e-9 m. In a segment of 0.1 m with EA = 1e6 N that is a tension of 0.01 N.
"""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import Vector
from anet_lumped.effects.effect import Effect
from anet_lumped.prescribed import paths

from .scene import Driven, Point, Scene

FAR = 8.0  # times the size of a scene, from which on its distance from the origin costs more than three bits of its places
WITHOUT_SPRINGS = 100.0  # [m], size of a scene without cables, of which rounded places make no forces
DIVERGED = 1e6  # times the size of a scene, and no less in metres and metres a second
NONE_MOVED = (0.0, 0.0, 0.0)


class Near(NamedTuple):
    """A scene as it is computed: the scene itself, or the same about another origin.

    Parameters
    ----------
    scene : Scene
    origin : (3,) tuple of float [m]
        Where its origin lies in the user's coordinates.
    fixed_by : Effect or None
        An effect that depends on places in a way of its own, so that the origin stays although the scene is far from it.
    """

    scene: Scene
    origin: Vector
    fixed_by: object = None


def places_given(scene: Scene) -> list[Vector]:
    """Places of supports, and of the free points and bodies that have one [m]."""
    free = [point.at for point in scene.free_points if point.at is not None]
    return scene.supports + free + [body.at for body in scene.bodies if body.at is not None]


def near_origin(scene: Scene) -> Near:
    """The scene about an origin in its middle if it is far from its own: more than `FAR` times its size along an axis.

    The height stays where an effect depends on it, and the whole origin where one depends on places in a way of its own.
    """
    axes = list(zip(*(places_given(scene) or [NONE_MOVED]), strict=True))
    low, width = [min(x) for x in axes], [max(x) - min(x) for x in axes]
    size = float(max(*width, scene.longest if scene.cables else WITHOUT_SPRINGS))
    middle = [x + 0.5 * wide for x, wide in zip(low, width, strict=True)]
    if not max(map(abs, middle)) > FAR * size:
        return Near(scene, NONE_MOVED)
    near = FAR * size
    unit = 10.0 ** math.floor(math.log10(near)) if near >= 1.0 else 2.0 ** math.floor(math.log2(near))  # moved without rounding
    origin = np.where(np.abs(middle) > FAR * size, unit * np.round(np.array(middle) / unit), 0.0)
    refused = None
    for x, y, z in (origin.tolist(), (origin * (1.0, 1.0, 0.0)).tolist()):
        effects = [effect.seen_from((x, y, z), scene) for effect in scene.effects]
        seen = [effect for effect in effects if effect is not None]
        if len(seen) == len(effects) and (x or y or z):
            return Near(_moved(scene, (x, y, z), seen), (x, y, z))
        refused = scene.effects[effects.index(None)] if None in effects else refused
    return Near(scene, NONE_MOVED, refused)


def largest_distance(scene: Scene) -> float:
    """Distance of two nodes, plus the difference of their velocities, beyond which a motion has diverged [m], [m/s]."""
    return DIVERGED * scene.reach


def _moved(scene: Scene, origin: Vector, effects: list[Effect]) -> Scene:
    """The scene with its points about another origin, and with effects that are."""

    def about(at: Vector | None) -> Any:
        return None if at is None else tuple((np.array(at) - origin).tolist())

    points: list[Point] = []
    for point in scene.points:
        if isinstance(point, Driven):
            points.append(replace(point, path=paths.seen_from(point.path, origin)))
        else:
            points.append(replace(point, at=about(point.at)))
    bodies = [
        replace(
            body,
            at=None if body.is_jointed else about(body.at),
            path=None if body.path is None else paths.seen_from(body.path, origin),
        )
        for body in scene.bodies
    ]
    return replace(scene, points=points, effects=effects, bodies=bodies)
