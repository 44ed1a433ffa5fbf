"""Waves as a user describes them; `wave_kernel` evaluates them in compiled code."""

import math
from dataclasses import dataclass, replace

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_direction, check_number, number

BREAKING = 0.142  # height over length of the steepest wave is BREAKING tanh(k depth)


@dataclass(frozen=True)
class Airy:
    """A regular wave of small height: eta = height/2 cos(k s - omega t + phase), s along `direction`, omega^2 = g k tanh(k depth).

    Parameters
    ----------
    height : float [m], from trough to crest
    period : float [s]
    direction : (3,) array_like, level; where the wave goes; any length but zero
    depth : float [m], of the water below the still surface; inf for deep water
    phase : float [rad]; 0: a crest at the origin at t = 0
    ramp : float [s], over which the wave grows from nothing by the quintic smoothstep 6s⁵−15s⁴+10s³; 0: it is there at t = 0

    Source
    ------
    DNV-RP-C205 (2010), 3.3.2; Airy, Tides and Waves (1845); Miche, Ann. Ponts Chauss. 114 (1944), for the limit of the height.
    """

    height: float
    period: float
    direction: Vector = (1.0, 0.0, 0.0)
    depth: float = math.inf
    phase: float = 0.0
    ramp: float = 0.0

    def __post_init__(self) -> None:
        owner = "wave Airy"
        for key, unit, sign in (
            ("height", "m", "non-negative"), ("period", "s", "positive"), ("phase", "rad", ""), ("ramp", "s", "non-negative")
        ):  # fmt: skip
            object.__setattr__(self, key, check_number(key, getattr(self, key), unit, owner, sign=sign))
        if number(self.depth) != math.inf:
            object.__setattr__(self, "depth", check_number("depth", self.depth, "m", owner, sign="positive"))
        direction = check_direction("direction", self.direction, owner)
        size = math.hypot(*direction)
        if direction[2] != 0.0:
            raise SceneError(f"Argument `direction` must be level, but {owner} has direction={direction}.")
        object.__setattr__(self, "direction", (direction[0] / size, direction[1] / size, 0.0))

    @property
    def frequency(self) -> float:
        """Circular frequency omega = 2 pi/period [rad/s]."""
        return 2.0 * math.pi / self.period

    def wave_number(self, g: float) -> float:
        """Wave number k [rad/m] for gravity g [m/s2], of omega^2 = g k tanh(k depth)."""
        from scipy.optimize import brentq

        deep = self.frequency**2 / g
        if self.depth == math.inf:
            return deep
        # k tanh(k depth) = deep lies between deep and the sum of its limits for deep and for shallow water
        high = deep + math.sqrt(deep / self.depth)
        return brentq(lambda k: k * math.tanh(k * self.depth) - deep, deep, high, xtol=1e-15 * high, rtol=1e-14)

    def seen_from(self, origin: Vector, g: float) -> "Airy":
        """The same wave in coordinates whose origin lies at ``origin`` (3,) [m] of today's, for gravity g [m/s2]."""
        along = sum(x * d for x, d in zip(origin, self.direction, strict=True))
        return replace(self, phase=math.remainder(self.wave_number(g) * along + self.phase, 2.0 * math.pi))

    def numbers(self, g: float, level: float) -> np.ndarray:
        """Numbers that `wave_kernel.wave_at` reads, (9,) float64, for gravity g [m/s2] and a still surface at z = level [m]."""
        if not g > 0.0:
            raise SceneError(f"A wave needs gravity, but wave Airy has g={g} m/s2.")
        k, (x, y, _) = self.wave_number(g), self.direction
        highest = BREAKING * 2.0 * math.pi / k * math.tanh(k * self.depth)
        if self.height > highest:
            raise SceneError(
                f"Argument `height` must be below {highest:.4g} m, where a wave of this period breaks, but wave Airy has "
                f"height={self.height}."
            )
        return np.array([0.5 * self.height, k, self.frequency, self.phase, x, y, self.depth, self.ramp, level])


KINDS = {"airy": Airy}
