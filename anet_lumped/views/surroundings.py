"""What a scene has around its cables that can be drawn: a ground, obstacles, water, winds that are the same everywhere."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.effects import REGISTRY
from anet_lumped.effects.flow.waves.airy import Airy
from anet_lumped.effects.flow.wind.base import as_winds
from anet_lumped.effects.flow.wind.profiles import Uniform


@dataclass(frozen=True)
class Plane:
    """A plane: a unit vector (3,) out of it, and its distance from the origin along this vector [m]."""

    normal: np.ndarray
    height: float


@dataclass(frozen=True)
class Wave:
    """A wave on a surface of water: eta = S(t/ramp) amplitude cos(k direction.x - frequency t + phase).

    Parameters
    ----------
    amplitude : float [m]
    k : float [rad/m]
    frequency : float [rad/s]
    phase : float [rad]
    direction : (2,) float64
    ramp : float [s]
    """

    amplitude: float
    k: float
    frequency: float
    phase: float
    direction: np.ndarray
    ramp: float


@dataclass(frozen=True)
class Solid:
    """An obstacle, with sharp edges.

    Parameters
    ----------
    kind : str, "sphere", "cylinder" or "box"
    at : (3,) float64, its centre [m]
    axes : (3, 3) float64, its axes, each a row; a cylinder's is the last one
    widths : (3,) float64, widths along these axes [m]; infinite along the axis of a cylinder without ends
    """

    kind: str
    at: np.ndarray
    axes: np.ndarray
    widths: np.ndarray


@dataclass(frozen=True)
class Surroundings:
    """Ground, obstacles, surface of water, wave, and velocities (3,) [m/s] of wind and current; each is None if a scene lacks it.

    A wind or a current that differs from place to place or in time is none of these, and neither are irregular or several waves.
    """

    ground: Plane | None
    obstacles: tuple[Solid, ...]
    water: Plane | None
    wave: Wave | None
    wind: np.ndarray | None
    current: np.ndarray | None


def surroundings(scene: Any, origin: np.ndarray) -> Surroundings:
    """Return what a scene has around its cables, about an origin (3,) [m]."""
    given = {REGISTRY.name_of(effect): effect for effect in scene.effects}
    ground, water, air = (given.get(name) for name in ("ground", "water", "air"))
    obstacles = given.get("obstacles")
    return Surroundings(
        None if ground is None else _plane(ground.normal, ground.height, origin),
        () if obstacles is None else tuple(_solid(shape, origin) for shape in obstacles.all_shapes),
        None if water is None else _plane((0.0, 0.0, 1.0), water.level, origin),
        None if water is None else _regular(water.all_waves, water.gravity(scene), origin),
        None if air is None else _uniform(air.wind),
        None if water is None else _uniform(water.current),
    )


def _plane(normal: Any, height: float, origin: np.ndarray) -> Plane:
    unit = np.array(normal, float) / np.linalg.norm(normal)
    return Plane(unit, height - float(unit @ origin))


def _solid(shape: Any, origin: np.ndarray) -> Solid:
    axes, merged, core, rounding = shape.solid()
    kind, coordinates = {3: ("sphere", [0, 0, 0]), 2: ("cylinder", [0, 0, 1]), 1: ("box", [0, 1, 2])}[merged]
    return Solid(kind, np.array(shape.at) - origin, axes, 2.0 * (np.array(core)[coordinates] + rounding))


def _regular(waves: Any, g: float, origin: np.ndarray) -> Wave | None:
    if len(waves) != 1 or not isinstance(waves[0], Airy):
        return None
    seen = waves[0].seen_from(tuple(origin), g)
    phase = math.remainder(seen.phase, 2.0 * math.pi)
    return Wave(0.5 * seen.height, seen.wave_number(g), seen.frequency, phase, np.array(seen.direction[:2]), seen.ramp)


def _uniform(given: Any) -> np.ndarray | None:
    winds = as_winds(given)
    uniform = [wind.velocity for wind in winds if isinstance(wind, Uniform)]
    if len(uniform) < max(len(winds), 1):
        return None
    velocity = np.sum(uniform, axis=0)
    return velocity if velocity.any() else None
