"""The base class of all waves, and the dispersion of a regular one."""

import math
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_direction, check_number, number, shown

BREAKING = 0.142  # height over length of the steepest wave is BREAKING tanh(k depth)
AMPLITUDE, FREQUENCY, PHASE, ALONG_X, ALONG_Y = range(5)  # columns of `Wave.rows`


class Wave(ABC):
    """A wave of small height, or a sum of such waves: eta = sum_m a_m cos(k_m s_m - omega_m t + phase_m).

    A wave is a frozen dataclass in a file of its own, with the method below, the fields `depth` [m] and `ramp` [s], and a line in
    `KINDS` of this package.
    """

    depth: float
    ramp: float

    @abstractmethod
    def rows(self, g: float) -> np.ndarray:
        """Regular waves that it is the sum of, for gravity g [m/s2].

        Returns
        -------
        (n, 5) float64
            Amplitude a [m], circular frequency omega [rad/s], phase [rad], and the level unit vector along which it goes. A row
            of frequency 0 is a constant elevation a cos(phase).
        """

    @property
    @abstractmethod
    def highest_frequency(self) -> float:
        """Highest circular frequency of those regular waves [rad/s]; 0 if there is none."""

    @property
    @abstractmethod
    def usual_period(self) -> float:
        """Period in which most of its energy swings [s]."""

    def wave_number(self, g: float) -> float:
        """Wave number [rad/m] at the usual period for gravity g [m/s2]."""
        return wave_number(2.0 * math.pi / self.usual_period, self.depth, g)

    @abstractmethod
    def seen_from(self, origin: Vector, g: float) -> "Wave":
        """The same wave in coordinates whose origin lies at ``origin`` (3,) [m] of today's, for gravity g [m/s2]."""


def wave_number(frequency: float, depth: float, g: float) -> float:
    """Wave number k [rad/m] of omega^2 = g k tanh(k depth), for a circular frequency [rad/s], a depth [m] and gravity [m/s2].

    Source
    ------
    DNV-RP-C205 (2010), 3.2.2.
    """
    from scipy.optimize import brentq

    deep = frequency**2 / g
    if depth == math.inf or deep == 0.0:
        return deep
    # k tanh(k depth) = deep lies between deep and the sum of its limits for deep and for shallow water
    high = deep + math.sqrt(deep / depth)
    return brentq(lambda k: k * math.tanh(k * depth) - deep, deep, high, xtol=1e-15 * high, rtol=1e-14)


def highest_wave(k: float, depth: float) -> float:
    """Height [m] at which a regular wave of the wave number k [rad/m] breaks, by Miche."""
    return BREAKING * 2.0 * math.pi / k * math.tanh(k * depth)


def check_depth_and_ramp(wave: Any, owner: str) -> None:
    """Check the fields `depth` and `ramp` of a wave."""
    object.__setattr__(wave, "ramp", check_number("ramp", wave.ramp, "s", owner, sign="non-negative"))
    if number(wave.depth) != math.inf:
        object.__setattr__(wave, "depth", check_number("depth", wave.depth, "m", owner, sign="positive"))


def check_level_direction(value: Vector, owner: str) -> Vector:
    """Return a level direction as a vector of length 1."""
    direction = check_direction("direction", value, owner)
    size = math.hypot(*direction)
    if direction[2] != 0.0:
        raise SceneError(f"Argument `direction` must be level, but {owner} has direction={direction}.")
    return direction[0] / size, direction[1] / size, 0.0


def check_waves(argument: str, value: Any, owner: str) -> "Wave | tuple[Wave, ...] | None":
    """Return None, one wave or a tuple of several, which must agree on depth and ramp."""
    waves = () if value is None else tuple(value) if isinstance(value, tuple | list) else (value,)
    if not all(isinstance(wave, Wave) for wave in waves):
        raise SceneError(
            f"Argument `{argument}` must be waves of anet_lumped.waves or None, but {owner} has {argument}={shown(value)}."
        )
    for name, unit in (("depth", "m"), ("ramp", "s")):
        given = sorted({getattr(wave, name) for wave in waves})
        if len(given) > 1:
            raise SceneError(
                f"Waves that add up must have one `{name}` [{unit}], but {owner} has waves of {name}={given[0]} and {given[1]}."
            )
    return waves[0] if len(waves) == 1 else waves or None
