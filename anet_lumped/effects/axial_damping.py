"""Damping of motion along the cables, proportional to mass: the part a M of Rayleigh's damping."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import check_number_by_name
from anet_lumped.compiled.jit import njit
from anet_lumped.effects.laws.drag import tangent_of

from .effect import Effect, names_left
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE


@dataclass(frozen=True)
class AxialDamping(Effect):
    """A force -rate m (v . t) t on each half of a segment, of mass m and unit tangent t; motion across a cable is not damped.

    With the viscosity BA of the cables it is Rayleigh's damping C = a M + b K of axial motion, a = rate and b = BA/EA: mode n of a
    straight taut cable, of frequency omega_n, has the damping ratio

        zeta_n = rate/(2 omega_n) + (BA/EA) omega_n/2 .

    v is the velocity relative to the ground, as for `ViscousDamping`. The velocity relative to the cable's ends would damp
    stretching alone, but would couple every node of a cable with every other one: C = a (B M^-1 B^T)^-1 for the rates of its
    segments.

    Parameters
    ----------
    rate : float or dict of str and float [1/s]
        Decay rate a of all cables, or of those named.

    Source
    ------
    Clough & Penzien, Dynamics of Structures (2003), 12-4, equation (12-41), for a diagonal M and motion along the cable.
    """

    rate: float | dict[str, float] | tuple[tuple[str, float], ...]

    coupled_neighbours: ClassVar[int] = 1
    no_force_at_rest: ClassVar[bool] = True
    same_everywhere: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._set(rate=check_number_by_name("rate", self.rate, "1/s", self._called, sign="non-negative"))

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(0.5)

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64, both nodes of each segment, and the segment
        params : float64, unstretched length [m] and half of rate m [N s/m] of each

        Raises
        ------
        SceneError : an unknown cable
        """
        cables = model.scene.cables
        rates = np.zeros(len(cables))
        if isinstance(self.rate, float):
            rates[:] = self.rate
        else:
            for name, rate in dict(self.rate).items():
                rates[model.scene.cable_numbers[model.scene.cable(name).name]] = rate
        damped_segments = np.flatnonzero(rates[model.cable_of])
        cable_of = model.cable_of[damped_segments]
        L0 = np.array([cable.L0 for cable in cables])[cable_of]
        half = 0.5 * rates[cable_of] * np.array([cable.mass_per_length for cable in cables])[cable_of] * L0
        return np.column_stack([model.ends[damped_segments], damped_segments]).ravel(), np.column_stack([L0, half]).ravel()

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        if not isinstance(self.rate, tuple):
            return self
        rates = [(piece, rate) for name, rate in self.rate for piece in names_left(name, pieces)]
        return AxialDamping(tuple(rates)) if rates else None

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy}


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i -= half (v_i . t) t of every segment that ends at node i; returns sum half (v_i . t)^2 [W]."""
    power = 0.0
    for s in range(len(params) // 2):
        i, j, L0, half = index[3 * s], index[3 * s + 1], params[2 * s], params[2 * s + 1]
        tx, ty, tz, _ = tangent_of(q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2], L0)
        for node in (i, j):
            along = v[node, 0] * tx + v[node, 1] * ty + v[node, 2] * tz
            f[node, 0] -= half * along * tx
            f[node, 1] -= half * along * ty
            f[node, 2] -= half * along * tz
            power += half * along * along
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes df/dv = -half t t^T and, with d of length l from start to end and w = v - (v . t) t,

    df/dd = -half ((v . t)(I - t t^T) + t w^T)/l.
    """
    for s in range(len(params) // 2):
        i, j, segment, L0, half = index[3 * s], index[3 * s + 1], index[3 * s + 2], params[2 * s], params[2 * s + 1]
        tx, ty, tz, per_l = tangent_of(q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2], L0)
        n = (tx, ty, tz)
        for side in range(2):
            node = i if side == 0 else j
            if node >= D.shape[0]:
                continue
            along = v[node, 0] * tx + v[node, 1] * ty + v[node, 2] * tz
            turning = (2.0 * side - 1.0) * c_q * half * per_l
            for x in range(3):
                for y in range(3):
                    across = (1.0 if x == y else 0.0) - n[x] * n[y]
                    df_dd = turning * (along * across + n[x] * (v[node, y] - along * n[y]))
                    D[node, x, y] += df_dd + c_v * half * n[x] * n[y]
                    near[segment, side, x, y] -= df_dd


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Damping has no energy."""
    return 0.0
