"""A measured wind, read from a file."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import SceneError, shown
from anet_lumped.compiled.jit import on_demand
from anet_lumped.effects.flow.recording import read_recording

from .base import UNIFORM_IN_PLACE, Wind

INTERPOLATION = ("linear", "cubic")


@dataclass(frozen=True)
class Recorded(Wind):
    """Velocity sampled in time, the same everywhere; held at the first sample before it and at the last after it.

    Parameters
    ----------
    file : str, path of a CSV file with the columns t [s], u, v, w [m/s] under a line with these names; a relative one starts
        where the program does
    interpolation : "linear", or "cubic": the spline of De Boor's not-a-knot ends, twice continuously differentiable

    Source
    ------
    De Boor, A Practical Guide to Splines (1978), ch. IV (not-a-knot).
    """

    file: str
    interpolation: str = "linear"
    t: np.ndarray = field(init=False, repr=False, compare=False)
    velocity: np.ndarray = field(init=False, repr=False, compare=False)

    same_at_each_height: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not isinstance(self.file, str):
            raise SceneError(
                f"Argument `file` must be the path of a file, a string, but wind Recorded has file={shown(self.file)}."
            )
        if not isinstance(self.interpolation, str) or self.interpolation not in INTERPOLATION:
            raise SceneError(
                f'Argument `interpolation` must be "linear" or "cubic", but wind Recorded has {shown(self.interpolation)}.'
            )
        table = read_recording(self.file, ("t", "u", "v", "w"), "A recorded wind")
        object.__setattr__(self, "t", table[:, 0].copy())
        object.__setattr__(self, "velocity", table[:, 1:].copy())

    @property
    def sudden(self) -> tuple[tuple[float, float, float], ...]:
        return ((float(self.t[0]), float(self.t[-1]), 2.0 * float(np.diff(self.t).min())),)

    def numbers(self) -> np.ndarray:
        """Number of samples k, times (k,) [s], and the polynomials of the pieces that begin at them, (k, 4, 3) [m/s^(i+1)]."""
        t, velocity = self.t, self.velocity
        pieces = np.zeros((len(t), 4, 3))
        pieces[:, 0] = velocity
        if self.interpolation == "cubic":
            from scipy.interpolate import CubicSpline

            pieces[:-1] = np.moveaxis(CubicSpline(t, velocity).c[::-1], 0, 1)
        else:
            pieces[:-1, 1] = np.diff(velocity, axis=0) / np.diff(t)[:, None]
        return np.concatenate([[len(t)], t, pieces.ravel()])

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _velocity


@on_demand
def _velocity(t, x, y, z, numbers):
    count = int(numbers[0])
    low, high = 1, 1 + count
    while high - low > 1:
        middle = (low + high) // 2
        if numbers[middle] <= t:
            low = middle
        else:
            high = middle
    tau, c = max(t - numbers[low], 0.0), 1 + count + 12 * (low - 1)  # time since the sample, position of the piece's polynomial
    if low == count:  # after the last sample
        tau = 0.0
    velocity = (
        numbers[c] + tau * (numbers[c + 3] + tau * (numbers[c + 6] + tau * numbers[c + 9])),
        numbers[c + 1] + tau * (numbers[c + 4] + tau * (numbers[c + 7] + tau * numbers[c + 10])),
        numbers[c + 2] + tau * (numbers[c + 5] + tau * (numbers[c + 8] + tau * numbers[c + 11])),
    )
    return velocity, UNIFORM_IN_PLACE
