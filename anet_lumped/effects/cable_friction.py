"""Friction of cables on a level ground that differs along and across them: a chain ploughs across, and slides along.

A node at a depth s below the level plane is pressed by N = k s by each half segment that ends there, k = stiffness d L0/2. With the
unit vector e along the segment in the plane, n across it, and the components v_a and v_n of the node's velocity along them,

    F = -N (mu_along v_a/sqrt(v_a^2 + u^2) e + mu_across v_n/sqrt(v_n^2 + u^2) n) ,

each limited by itself, as in MoorDyn's Fortran version. The ground itself is another effect, `Ground` or `MoordynBottom`, of the
same height and stiffness and without friction. Over a step N, e and n are those in its middle, and the velocity is its mean, so
that friction only takes. The slope by the turning of a segment is left out of the tangent, which costs iterations and no accuracy.
Source: MoorDyn_Line.f90 of OpenFAST (bottom contact, MU_KT and MU_KA); Coulomb, regularised as in `ground`.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import Vector
from anet_lumped.compiled.jit import inlined_law, law, njit
from anet_lumped.effects.laws.contact_area import CONTACT, SLIP_SPEED, half_stiffnesses
from anet_lumped.effects.laws.sliding import sliding_share

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER = 4  # numbers in ``params`` before those of the segments
SHORT = 1e-9  # [m], a segment that is shorter in the plane stands upright: no direction is along it


@dataclass(frozen=True)
class CableFriction(Effect):
    """Friction along and across cables on a level ground, beside a ground without friction. Statics leave it out.

    Parameters
    ----------
    along, across : float
        Coefficients mu, of the load that presses a node into the ground.
    height : float
        Height of the plane [m].
    stiffness : float
        Pressure per depth [Pa/m] on the area d L0 of a segment, as of the ground.
    slip_speed : float
        u, speed at which friction is 0.7 of mu N [m/s].
    """

    along: float
    across: float
    height: float = 0.0
    stiffness: float = 3e6
    slip_speed: float = 1e-3

    coupled_neighbours: ClassVar[int] = 1
    no_force_at_rest: ClassVar[bool] = True
    passive: ClassVar[bool] = True
    stiff: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._check_numbers(
            along=CONTACT["friction"], across=CONTACT["friction"], height=("m", ""), stiffness=CONTACT["stiffness"],
            slip_speed=SLIP_SPEED,
        )  # fmt: skip

    def seen_from(self, origin: Vector, scene: Any) -> Effect:
        return replace(self, height=self.height - float(origin[2]))

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(0.3, 0.6, height=height_under(scene))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64, both nodes of each segment
        params : float64, height [m], mu along and across, u [m/s]; k [N/m] of each segment

        Raises
        ------
        SceneError : a cable without a diameter
        """
        k = half_stiffnesses(model, "CableFriction", self.stiffness)
        return model.ends.ravel().astype(np.int64), np.array([self.height, self.along, self.across, self.slip_speed, *k])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step}


@inlined_law
def _along(x, y):
    """Unit vector along (x, y) and 1, or 0 for a segment that stands upright."""
    l = math.sqrt(x * x + y * y)
    if l > SHORT:
        return x / l, y / l, 1.0
    return 0.0, 0.0, 0.0


@law
def _on_node(node, e, N, slope, vx, vy, c_v, params, f, D, adds):
    """Add the friction of half a segment to a node, or subtract its derivative; returns F.v [W].

    Parameters
    ----------
    node : int
    e : (2,) unit vector along the segment, in the plane
    N : float [N], load on the node
    slope : float [N/m], derivative of N by the unknown place of the node along z
    vx, vy : float [m/s], velocity of the node in the plane
    c_v : float [1/s], derivative of the velocity by the unknown place
    params : as `CableFriction.table` has them
    f, D : (n, 3) [N], to which the force is added if ``adds``; (n, 3, 3) [N/m], from which its derivative is subtracted if not
    """
    a, a_slope = sliding_share(vx * e[0] + vy * e[1], params[3])
    n, n_slope = sliding_share(vy * e[0] - vx * e[1], params[3])
    along, across = params[1], params[2]
    Fx, Fy = -(along * a * e[0] - across * n * e[1]), -(along * a * e[1] + across * n * e[0])
    if adds:
        f[node, 0] += N * Fx
        f[node, 1] += N * Fy
    elif node < D.shape[0]:
        p, r = c_v * N * along * a_slope, c_v * N * across * n_slope
        D[node, 0, 0] += p * e[0] * e[0] + r * e[1] * e[1]
        D[node, 0, 1] += (p - r) * e[0] * e[1]
        D[node, 1, 0] += (p - r) * e[0] * e[1]
        D[node, 1, 1] += p * e[1] * e[1] + r * e[0] * e[0]
        D[node, 0, 2] -= slope * Fx
        D[node, 1, 2] -= slope * Fy
    return N * (Fx * vx + Fy * vy)


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add F; returns -sum F.v [W]."""
    power, none = 0.0, np.empty((0, 3, 3))
    for s in range(index.shape[0] // 2):
        i, j = index[2 * s], index[2 * s + 1]
        ex, ey, lies = _along(q[j, 0] - q[i, 0], q[j, 1] - q[i, 1])
        for node in (i, j):
            N = lies * params[HEADER + s] * (params[0] - q[node, 2])
            if N > 0.0:
                power -= _on_node(node, (ex, ey), N, 0.0, v[node, 0], v[node, 1], 0.0, params, f, none, True)
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes of `force`, but for those by the turning of a segment."""
    none = np.empty((0, 3))
    for s in range(index.shape[0] // 2):
        i, j = index[2 * s], index[2 * s + 1]
        ex, ey, lies = _along(q[j, 0] - q[i, 0], q[j, 1] - q[i, 1])
        for node in (i, j):
            k = lies * params[HEADER + s]
            N = k * (params[0] - q[node, 2])
            if N > 0.0:
                _on_node(node, (ex, ey), N, -c_q * k, v[node, 0], v[node, 1], c_v, params, none, D, False)


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Friction has no energy, 0 [J]."""
    return 0.0


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Friction over a whole step, see the module, and its derivative but for that by the turning of a segment."""
    taken, per_h = 0.0, 1.0 / h
    for s in range(index.shape[0] // 2):
        i, j = index[2 * s], index[2 * s + 1]
        ex, ey, lies = _along(q[j, 0] + base[j, 0] - q[i, 0] - base[i, 0], q[j, 1] + base[j, 1] - q[i, 1] - base[i, 1])
        for node in (i, j):
            k = lies * params[HEADER + s]
            N = k * (params[0] - 0.5 * (q[node, 2] + base[node, 2]))
            if N > 0.0:
                vx, vy = per_h * (q[node, 0] - base[node, 0]), per_h * (q[node, 1] - base[node, 1])
                taken -= h * _on_node(node, (ex, ey), N, 0.0, vx, vy, 0.0, params, f, D, True)
                _on_node(node, (ex, ey), N, -0.5 * k, vx, vy, per_h, params, f, D, False)
    return taken, 0.0
