"""Steady winds and currents: uniform, and profiles over the height; z points up."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import SceneError, Vector, as_entries, check_number, check_vector, shown
from anet_lumped.compiled.jit import inlined, on_demand

from .base import UNIFORM_IN_PLACE, Wind, check_unit_direction

LOWEST = 1e-6  # of the height of a power law: its slope grows without bound towards the ground, and is constant below LOWEST


@dataclass(frozen=True)
class Uniform(Wind):
    """The same velocity everywhere.

    Parameters
    ----------
    velocity : (3,) array_like [m/s]
    """

    velocity: Vector

    same_at_each_height: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "velocity", check_vector("velocity", self.velocity, "m/s", "wind Uniform"))

    def numbers(self) -> np.ndarray:
        """Velocity [m/s]."""
        return np.array(self.velocity)

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _uniform


@dataclass(frozen=True)
class PowerLaw(Wind):
    """U(z) = speed ((z - ground)/height)^exponent along `direction`; no wind at the ground and below.

    Parameters
    ----------
    speed : float [m/s], at `height`
    height : float [m], above the ground
    exponent : float; 0.2 for normal winds, 0.11 for extreme ones, 0.14 for neutral air over open land
    direction : (3,) array_like, where the wind goes; any length but zero
    ground : float [m], z of the ground

    Source
    ------
    IEC 61400-1, 6.3 (normal wind profile).
    """

    speed: float
    height: float
    exponent: float
    direction: Vector = (1.0, 0.0, 0.0)
    ground: float = 0.0

    same_at_each_height: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _check_profile(self, "wind PowerLaw")
        exponent = check_number("exponent", self.exponent, "", "wind PowerLaw", sign="non-negative")
        object.__setattr__(self, "exponent", exponent)

    def numbers(self) -> np.ndarray:
        """Velocity at the height [m/s], ground and height [m], exponent."""
        return np.array([*(self.speed * np.array(self.direction)), self.ground, self.height, self.exponent])

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _power_law


@dataclass(frozen=True)
class Logarithmic(Wind):
    """U(z) = speed ln((z - ground)/roughness)/ln(height/roughness) along `direction`; no wind below the roughness length.

    Parameters
    ----------
    speed : float [m/s], at `height`
    height : float [m], above the ground
    roughness : float [m], roughness length z0: 0.0002 open sea, 0.03 open land, 1 town
    direction : (3,) array_like, where the wind goes; any length but zero
    ground : float [m], z of the ground

    Source
    ------
    EN 1991-1-4:2005, 4.3.2, eq. (4.3) and (4.4), with the friction velocity given by the speed at a height; neutral air.
    """

    speed: float
    height: float
    roughness: float
    direction: Vector = (1.0, 0.0, 0.0)
    ground: float = 0.0

    same_at_each_height: ClassVar[bool] = True

    def __post_init__(self) -> None:
        owner = "wind Logarithmic"
        _check_profile(self, owner)
        object.__setattr__(self, "roughness", check_number("roughness", self.roughness, "m", owner, sign="positive"))
        if self.roughness >= self.height:
            raise SceneError(
                f"Argument `roughness` must be smaller than `height` [m], but {owner} has roughness={self.roughness} and "
                f"height={self.height}."
            )

    def numbers(self) -> np.ndarray:
        """Velocity at e times the roughness length above the ground [m/s], ground and roughness [m]."""
        per_e = self.speed / math.log(self.height / self.roughness)
        return np.array([*(per_e * np.array(self.direction)), self.ground, self.roughness])

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _logarithmic


@dataclass(frozen=True)
class Sampled(Wind):
    """A level velocity sampled over the height, linear in between; held at the first sample below it and at the last above it.

    Parameters
    ----------
    samples : rows (z, u, v) with z [m] increasing and velocities along x and y [m/s]
    """

    samples: Sequence[Vector]

    same_at_each_height: ClassVar[bool] = True

    def __post_init__(self) -> None:
        samples = as_entries(self.samples)
        if not samples:
            raise SceneError(f"Argument `samples` must be at least one row (z, u, v), but wind Sampled has {shown(self.samples)}.")
        rows = tuple(check_vector(f"samples[{i}]", row, "m, m/s, m/s", "wind Sampled") for i, row in enumerate(samples))
        for i, (below, above) in enumerate(pairwise(rows)):
            if not below[0] < above[0]:
                raise SceneError(
                    f"Heights z of `samples` must increase [m], but wind Sampled has z={below[0]} in row {i} and then {above[0]}."
                )
        object.__setattr__(self, "samples", rows)

    def numbers(self) -> np.ndarray:
        """Rows of height [m] and velocity [m/s]."""
        return np.array(self.samples).ravel()

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _sampled


def _check_profile(profile: PowerLaw | Logarithmic, owner: str) -> None:
    for key, unit, sign in (("speed", "m/s", "non-negative"), ("height", "m", "positive"), ("ground", "m", "")):
        object.__setattr__(profile, key, check_number(key, getattr(profile, key), unit, owner, sign=sign))
    object.__setattr__(profile, "direction", check_unit_direction(profile.direction, owner))


@on_demand
def _uniform(t, x, y, z, numbers):
    return (numbers[0], numbers[1], numbers[2]), UNIFORM_IN_PLACE


@on_demand
def _power_law(t, x, y, z, numbers):
    ground, height, exponent = numbers[3], numbers[4], numbers[5]
    ratio = (z - ground) / height
    share, slope = 0.0, 0.0
    if ratio > 0.0:
        share, slope = ratio**exponent, exponent * max(ratio, LOWEST) ** (exponent - 1.0) / height
    return _along(share, slope, numbers)


@on_demand
def _logarithmic(t, x, y, z, numbers):
    ground, roughness = numbers[3], numbers[4]
    ratio = (z - ground) / roughness
    share, slope = 0.0, 0.0
    if ratio > 1.0:
        share, slope = math.log(ratio), 1.0 / (z - ground)
    return _along(share, slope, numbers)


@inlined
def _along(share, slope, numbers):
    """Velocity and gradient of a profile, the velocity ``numbers[:3]`` times ``share``; ``slope`` [1/m] is that of ``share``."""
    return (
        (share * numbers[0], share * numbers[1], share * numbers[2]),
        (0.0, 0.0, slope * numbers[0], 0.0, 0.0, slope * numbers[1], 0.0, 0.0, slope * numbers[2]),
    )


@on_demand
def _sampled(t, x, y, z, numbers):
    last = len(numbers) - 3  # position of the last row (z, u, v)
    u, v, uz, vz = numbers[1], numbers[2], 0.0, 0.0
    if z > numbers[0]:
        u, v = numbers[last + 1], numbers[last + 2]
        for i in range(0, last, 3):
            if z < numbers[i + 3]:
                per_height, above_row = 1.0 / (numbers[i + 3] - numbers[i]), z - numbers[i]
                uz, vz = per_height * (numbers[i + 4] - numbers[i + 1]), per_height * (numbers[i + 5] - numbers[i + 2])
                u, v = numbers[i + 1] + above_row * uz, numbers[i + 2] + above_row * vz
                break
    return (u, v, 0.0), (0.0, 0.0, uz, 0.0, 0.0, vz, 0.0, 0.0, 0.0)
