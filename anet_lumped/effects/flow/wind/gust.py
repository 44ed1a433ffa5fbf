"""A single gust."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import Vector, check_flag, check_number, check_vector
from anet_lumped.compiled.jit import on_demand

from .base import UNIFORM_IN_PLACE, Wind


@dataclass(frozen=True)
class Gust(Wind):
    """A "1 - cos" gust, the same everywhere: u(t) = amplitude/2 (1 - cos(pi (t - start)/rise)) from start to start + rise.

    Then it falls as it rose, or stays.

    Parameters
    ----------
    amplitude : (3,) array_like [m/s], velocity at the top
    start : float [s]
    rise : float [s], from nothing to the top
    stays : bool; False: the symmetric gust of aircraft loads; True: it stays at the top, a coherent gust

    Source
    ------
    EASA CS-25.341(a) (symmetric); MIL-F-8785C (1980), 3.7.2.3, and the extreme coherent gust of IEC 61400-1, 6.3 (stays).
    """

    amplitude: Vector
    start: float
    rise: float
    stays: bool = False

    same_at_each_height: ClassVar[bool] = True

    def __post_init__(self) -> None:
        owner = "wind Gust"
        object.__setattr__(self, "amplitude", check_vector("amplitude", self.amplitude, "m/s", owner))
        object.__setattr__(self, "start", check_number("start", self.start, "s", owner))
        object.__setattr__(self, "rise", check_number("rise", self.rise, "s", owner, sign="positive"))
        check_flag("stays", self.stays, owner)

    @property
    def sudden(self) -> tuple[tuple[float, float, float], ...]:
        lasts = self.rise if self.stays else 2.0 * self.rise
        return ((self.start, self.start + lasts, lasts),)

    def numbers(self) -> np.ndarray:
        """Amplitude [m/s], start and rise [s], 1 if it stays."""
        return np.array([*self.amplitude, self.start, self.rise, float(self.stays)])

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _velocity


@on_demand
def _velocity(t, x, y, z, numbers):
    start, rise, stays = numbers[3], numbers[4], numbers[5] != 0.0
    s = (t - start) / rise
    share = 0.5 - 0.5 * math.cos(math.pi * s)
    if s <= 0.0 or (s >= 2.0 and not stays):
        share = 0.0
    elif s >= 1.0 and stays:
        share = 1.0
    return (share * numbers[0], share * numbers[1], share * numbers[2]), UNIFORM_IN_PLACE
