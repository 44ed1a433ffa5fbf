"""Damping by the environment, proportional to mass and velocity: the only damping of the thesis's model."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from .signatures import ENERGY, FORCE, TANGENT


@dataclass(frozen=True)
class ViscousDamping:
    """Drag on every moving node, f = -rate m v.

    Parameters
    ----------
    rate : float
        Decay rate of the velocity of a free mass [1/s].
    """

    rate: float

    linear: ClassVar[bool] = True

    def __post_init__(self):
        if not (math.isfinite(self.rate) and self.rate >= 0):
            raise ValueError(f"Argument `rate` of ViscousDamping must be finite and not negative [1/s], but it is {self.rate}.")

    def table(self, model):
        """Index and parameters for the kernels below."""
        return np.empty(0, np.int64), self.rate * model.mass[: model.n_free]

    def kernels(self):
        """Compiled functions, by their slot in `signatures`."""
        return {"force": force, "tangent": tangent, "energy": energy}


@njit(FORCE, cache=True)
def force(t, q, v, index, params, f):
    """f_i -= rate m_i v_i; returns sum rate m_i v_i^2 [W]."""
    power = 0.0
    for i in range(len(params)):
        for x in range(3):
            f[i, x] -= params[i] * v[i, x]
            power += params[i] * v[i, x] * v[i, x]
    return power


@njit(TANGENT, cache=True)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """df/dv = -rate m."""
    for i in range(len(params)):
        for x in range(3):
            D[i, x, x] += c_v * params[i]


@njit(ENERGY, cache=True)
def energy(t, q, index, params):
    """Drag has no energy."""
    return 0.0
