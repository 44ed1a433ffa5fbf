"""Damping by the surroundings, proportional to mass and velocity: the only damping of the thesis's model."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import check_number
from anet_lumped.compiled.jit import njit

from .effect import Effect
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE


@dataclass(frozen=True)
class ViscousDamping(Effect):
    """A force -rate m v on every moving node.

    Parameters
    ----------
    rate : float
        Decay rate of the velocity of a free mass [1/s].
    """

    rate: float

    no_force_at_rest: ClassVar[bool] = True
    same_everywhere: ClassVar[bool] = True
    linear_in_node_state: ClassVar[bool] = True
    passive: ClassVar[bool] = True
    jax_traceable: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._set(rate=check_number("rate", self.rate, "1/s", self._called, sign="non-negative"))

    @property
    def mass_damping_rate(self) -> float:
        return self.rate

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(0.5)

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """No index; rate times the mass of each moving node [N s/m]."""
        return np.empty(0, np.int64), self.rate * model.mass[: model.n_free]

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy}


@njit(FORCE_SIGNATURE, cache=True)
def force(t, q, v, index, params, f):
    """f_i -= rate m_i v_i; returns sum rate m_i v_i^2 [W]."""
    power = 0.0
    for i in range(len(params)):
        for x in range(3):
            f[i, x] -= params[i] * v[i, x]
            power += params[i] * v[i, x] * v[i, x]
    return power


@njit(TANGENT_SIGNATURE, cache=True)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """df/dv = -rate m."""
    for i in range(len(params)):
        for x in range(3):
            D[i, x, x] += c_v * params[i]


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Damping has no energy."""
    return 0.0
