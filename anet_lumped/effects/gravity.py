"""Uniform gravity."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from .signatures import ENERGY, FORCE


@dataclass(frozen=True)
class Gravity:
    """Weight of every moving node, f = m g.

    Parameters
    ----------
    g : float
        Size of the acceleration [m/s2]; zero is allowed.
    direction : tuple of 3 float
        Where it points; any length but zero.
    """

    g: float = 9.81
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)

    linear: ClassVar[bool] = True

    def __post_init__(self):
        if not (math.isfinite(self.g) and self.g >= 0):
            raise ValueError(f"Argument `g` of Gravity must be finite and not negative [m/s2], but it is {self.g}.")
        direction = tuple(float(x) for x in self.direction)
        if len(direction) != 3 or not all(map(math.isfinite, direction)) or math.hypot(*direction) == 0:
            raise ValueError(
                f"Argument `direction` of Gravity must be three finite numbers, not all zero, but it is {self.direction}."
            )
        object.__setattr__(self, "direction", direction)

    @property
    def acceleration(self):
        """(3,) float64 [m/s2]."""
        direction = np.array(self.direction)
        return self.g * direction / np.linalg.norm(direction)

    def table(self, model):
        """Index and parameters for the kernels below."""
        return np.empty(0, np.int64), np.concatenate([self.acceleration, model.mass[: model.n_free]])

    def kernels(self):
        """Compiled functions, by their slot in `signatures`."""
        return {"force": force, "energy": energy}


@njit(FORCE, cache=True)
def force(t, q, v, index, params, f):
    """f_i += m_i g. Source: Newton."""
    for i in range(len(params) - 3):
        for x in range(3):
            f[i, x] += params[3 + i] * params[x]
    return 0.0


@njit(ENERGY, cache=True)
def energy(t, q, index, params):
    """-sum m_i g . q_i [J]."""
    total = 0.0
    for i in range(len(params) - 3):
        total -= params[3 + i] * (params[0] * q[i, 0] + params[1] * q[i, 1] + params[2] * q[i, 2])
    return total
