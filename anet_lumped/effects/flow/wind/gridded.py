"""A velocity given on a grid of places and times."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, as_entries, check_number, check_vector, shown
from anet_lumped.compiled.jit import inlined, on_demand

from .base import Wind

AXES = ("x", "y", "z", "t")


@dataclass(frozen=True)
class Gridded(Wind):
    """A velocity on a grid of x, y, z and t, linear in each of them in between; held at the nearest of its ends outside.

    An axis of one number is one along which nothing changes: with x and y of one number it is a profile that changes in time.

    Parameters
    ----------
    velocity : rows (u, v, w) [m/s], one for each place and time: those of the first time, in it those of the first z, in it
        those of the first y, in it one for each x; that is, row ((i_t n_z + i_z) n_y + i_y) n_x + i_x
    z : numbers that increase [m]
    t : numbers that increase [s]
    x, y : numbers that increase [m]
    """

    velocity: Sequence[Vector]
    z: Sequence[float] = (0.0,)
    t: Sequence[float] = (0.0,)
    x: Sequence[float] = (0.0,)
    y: Sequence[float] = (0.0,)

    def __post_init__(self) -> None:
        for name in AXES:
            object.__setattr__(self, name, _axis(name, getattr(self, name)))
        rows = as_entries(self.velocity)
        size = [len(getattr(self, name)) for name in reversed(AXES)]
        if rows is None or len(rows) != np.prod(size):
            raise SceneError(
                f"Argument `velocity` must be {np.prod(size)} rows (u, v, w), one for each t, z, y and x, of which there "
                f"are {', '.join(map(str, size))}, but wind "
                f"Gridded has {shown(self.velocity) if rows is None else f'{len(rows)} rows'}."
            )
        velocity = tuple(check_vector(f"velocity[{i}]", row, "m/s", "wind Gridded") for i, row in enumerate(rows))
        object.__setattr__(self, "velocity", velocity)

    @property
    def same_at_each_height(self) -> bool:  # type: ignore[override]  # of each grid its own
        """Whether the velocity is the same at all places of one height."""
        return len(self.x) == len(self.y) == 1

    def numbers(self) -> np.ndarray:
        """Lengths of the axes x, y, z and t, the axes, and the rows."""
        axes = [np.array(getattr(self, name)) for name in AXES]
        return np.concatenate([[len(axis) for axis in axes], *axes, np.array(self.velocity).ravel()])

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _velocity


def _axis(name: str, value: Any) -> tuple[float, ...]:
    entries = as_entries(value)
    unit = "s" if name == "t" else "m"
    if not entries:
        raise SceneError(f"Argument `{name}` must be at least one number [{unit}], but wind Gridded has {shown(value)}.")
    axis = tuple(check_number(f"{name}[{i}]", entry, unit, "wind Gridded") for i, entry in enumerate(entries))
    for before, after in pairwise(axis):
        if not before < after:
            raise SceneError(f"Numbers of `{name}` must increase [{unit}], but wind Gridded has {before} and then {after}.")
    return axis


@inlined
def _between(at, numbers, first, count):
    """Where a coordinate lies on an axis: the lower point, the share of the upper one, and the slope of this share."""
    low, high = first, first + count - 1
    if count == 1 or at <= numbers[low]:
        return 0, 0.0, 0.0
    if at >= numbers[high]:
        return count - 2, 1.0, 0.0
    while high - low > 1:
        middle = (low + high) // 2
        if numbers[middle] <= at:
            low = middle
        else:
            high = middle
    per_length = 1.0 / (numbers[high] - numbers[low])
    return low - first, (at - numbers[low]) * per_length, per_length


@on_demand
def _velocity(t, x, y, z, numbers):
    n_x, n_y, n_z, n_t = int(numbers[0]), int(numbers[1]), int(numbers[2]), int(numbers[3])
    i_x, f_x, s_x = _between(x, numbers, 4, n_x)
    i_y, f_y, s_y = _between(y, numbers, 4 + n_x, n_y)
    i_z, f_z, s_z = _between(z, numbers, 4 + n_x + n_y, n_z)
    i_t, f_t, _ = _between(t, numbers, 4 + n_x + n_y + n_z, n_t)
    first = 4 + n_x + n_y + n_z + n_t
    u, v, w = 0.0, 0.0, 0.0
    ux, uy, uz, vx, vy, vz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for corner in range(16):
        a, b, c, d = corner & 1, (corner >> 1) & 1, (corner >> 2) & 1, corner >> 3
        of_x, of_y, of_z, of_t = f_x if a else 1.0 - f_x, f_y if b else 1.0 - f_y, f_z if c else 1.0 - f_z, f_t if d else 1.0 - f_t
        if (a and n_x == 1) or (b and n_y == 1) or (c and n_z == 1) or (d and n_t == 1) or of_t == 0.0:
            continue
        row = first + 3 * ((((i_t + d) * n_z + i_z + c) * n_y + i_y + b) * n_x + i_x + a)
        share = of_x * of_y * of_z * of_t
        along_x = (s_x if a else -s_x) * of_y * of_z * of_t
        along_y = (s_y if b else -s_y) * of_x * of_z * of_t
        along_z = (s_z if c else -s_z) * of_x * of_y * of_t
        p, q, r = numbers[row], numbers[row + 1], numbers[row + 2]
        u, v, w = u + share * p, v + share * q, w + share * r
        ux, uy, uz = ux + along_x * p, uy + along_y * p, uz + along_z * p
        vx, vy, vz = vx + along_x * q, vy + along_y * q, vz + along_z * q
        wx, wy, wz = wx + along_x * r, wy + along_y * r, wz + along_z * r
    return (u, v, w), (ux, uy, uz, vx, vy, vz, wx, wy, wz)
