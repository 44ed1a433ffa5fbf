"""Uniform gravity."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import Vector, check_direction, check_number
from anet_lumped.compiled.jit import njit

from .effect import Effect
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE


@dataclass(frozen=True)
class Gravity(Effect):
    """Weight of every moving node, f = m g.

    Parameters
    ----------
    g : float [m/s2]
        Size of the acceleration; zero is allowed.
    direction : tuple of 3 float
        Where it points; its length does not count, but must not be zero.
    """

    g: float = 9.81
    direction: Vector = (0.0, 0.0, -1.0)

    dead_load: ClassVar[bool] = True
    jax_traceable: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._set(
            g=check_number("g", self.g, "m/s2", self._called, sign="non-negative"),
            direction=check_direction("direction", self.direction, self._called),
        )

    @property
    def uniform_acceleration(self) -> Vector:
        size = math.hypot(*self.direction)
        x, y, z = self.direction
        return self.g * x / size, self.g * y / size, self.g * z / size

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """No index; the acceleration [m/s2] and the mass of each moving node [kg]."""
        return np.empty(0, np.int64), np.concatenate([self.uniform_acceleration, model.mass[: model.n_free]])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "energy": energy}


@njit(FORCE_SIGNATURE, cache=True)
def force(t, q, v, index, params, f):
    """f_i += m_i g. Source: Newton."""
    gx, gy, gz = params[0], params[1], params[2]  # read once: f might lie where they do, as far as the compiler knows
    for i in range(len(params) - 3):
        m = params[3 + i]
        f[i, 0] += m * gx
        f[i, 1] += m * gy
        f[i, 2] += m * gz
    return 0.0


@njit(ENERGY_SIGNATURE, cache=True, fastmath={"reassoc", "nsz", "contract"})
def energy(t, q, index, params):
    """-sum m_i g . q_i [J], in an order that lets several nodes be added at once."""
    total, gx, gy, gz = 0.0, params[0], params[1], params[2]
    for i in range(len(params) - 3):
        total -= params[3 + i] * (gx * q[i, 0] + gy * q[i, 1] + gz * q[i, 2])
    return total
