"""A measured wind, read from a file."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import LARGEST, NAMED, SceneError, one_line, shown
from anet_lumped.compiled.jit import on_demand
from anet_lumped.regular_files import read_text

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
        t, velocity = _read(self.file)
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "velocity", velocity)

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


def _read(path: str) -> tuple[np.ndarray, np.ndarray]:
    """Times (k,) and velocities (k, 3) of a file."""
    file = one_line(path, NAMED)
    first, *lines = read_text(path, "A recorded wind", SceneError).split("\n")
    if [name.strip() for name in first.split(",")] != ["t", "u", "v", "w"]:
        raise SceneError(f'A recorded wind must begin with the line "t,u,v,w", but {file} begins with {shown(first)}.')
    try:
        table = np.array([[float(entry) for entry in line.split(",")] for line in lines if line.strip()])
    except ValueError as error:
        raise SceneError(f"A recorded wind must hold four numbers (t, u, v, w) a line, but {file}: {error}.") from None
    if table.ndim != 2 or table.shape[1] != 4 or len(table) < 2 or not (np.abs(table) <= LARGEST).all():
        what = "" if (np.abs(table) <= LARGEST).all() else f" with entries that are not finite, or larger than {LARGEST:g}"
        raise SceneError(
            "A recorded wind must hold at least two lines of four finite numbers (t, u, v, w), but "
            f"{file} has shape {table.shape}{what}."
        )
    steps = np.diff(table[:, 0])
    if not (steps > 0.0).all():
        row = int(np.argmin(steps > 0.0))
        raise SceneError(
            f"The times of a recorded wind must increase, but in {file} t={table[row, 0]} is followed by t={table[row + 1, 0]}."
        )
    return table[:, 0].copy(), table[:, 1:].copy()


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
