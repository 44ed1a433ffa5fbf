"""Friction that differs along and across cables, on a height map: that of `cable_friction` in the plane that touches it.

A node at a depth s = H(x, y) - z below the map, whose normal n is tilted by theta, is pressed by N = k s/cos(theta) by each half
segment that ends there, k = stiffness d L0/2: as by `GroundMap`. With the unit vector e along the part of the segment in the plane
across n, the one across it m = n x e, and the components v_a and v_m of the node's velocity along them,

    F = -N (mu_along v_a/sqrt(v_a^2 + u^2) e + mu_across v_m/sqrt(v_m^2 + u^2) m) .

Over a step N, n, e and m are those in its middle, and the velocity is its mean, so that friction only takes. The slopes by the
turning of a segment and of the normal are left out of the tangent, which costs iterations and no accuracy.
Source: as `cable_friction`; the plane is that of `ground_map`.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import Vector
from anet_lumped.compiled.jit import inlined_law, law, njit
from anet_lumped.effects.laws.contact_area import CONTACT, SLIP_SPEED, half_stiffnesses
from anet_lumped.effects.laws.height_map import checked_map, spot
from anet_lumped.effects.laws.sliding import sliding_share

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER = 4  # numbers in ``params`` before those of the segments: mu along and across, slip speed, where the map begins
SHORT = 1e-9  # of a segment's length: what lies in the plane of one that stands upright on it, along which no direction is


@dataclass(frozen=True)
class CableFrictionMap(Effect):
    """Friction along and across cables on a height map, beside a `GroundMap` without friction. Statics leave it out.

    Parameters
    ----------
    along, across : float
        Coefficients mu, of the load that presses a node into the ground.
    x, y : sequences of float
        Places of the grid [m], as of the ground.
    heights : sequence of sequences of float
        Height at each place [m], a row for each of ``x``, as of the ground.
    stiffness : float
        Pressure per depth [Pa/m] on the area d L0 of a segment, as of the ground.
    slip_speed : float
        u, speed at which friction is 0.7 of mu N [m/s].
    """

    along: float
    across: float
    x: Sequence[float]
    y: Sequence[float]
    heights: Sequence[Sequence[float]]
    stiffness: float = 3e6
    slip_speed: float = 1e-3

    coupled_neighbours: ClassVar[int] = 1
    no_force_at_rest: ClassVar[bool] = True
    passive: ClassVar[bool] = True
    stiff: ClassVar[bool] = True

    def check_parameters(self) -> None:
        mu = CONTACT["friction"]
        self._check_numbers(along=mu, across=mu, stiffness=CONTACT["stiffness"], slip_speed=SLIP_SPEED)
        self._set(**checked_map(self.x, self.y, self.heights, self._called))

    def seen_from(self, origin: Vector, scene: Any) -> Effect:
        x, y, z = map(float, origin)
        heights = [[height - z for height in row] for row in self.heights]
        return replace(self, x=[at - x for at in self.x], y=[at - y for at in self.y], heights=heights)

    @classmethod
    def example(cls, scene: Any) -> Self:
        height = height_under(scene)
        return cls(0.3, 0.6, (-1.0, 0.0, 1.0), (-1.0, 1.0), ((height,) * 2, (height, height + 0.1), (height,) * 2))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64, both nodes of each segment
        params : float64, mu along and across, u [m/s], where the map begins; k [N/m] of each segment; the map

        Raises
        ------
        SceneError : a cable without a diameter
        """
        k = half_stiffnesses(model, "CableFrictionMap", self.stiffness)
        grid = (len(self.x), len(self.y), *self.x, *self.y, *np.ravel(self.heights))
        header = self.along, self.across, self.slip_speed, HEADER + len(k)
        return model.ends.ravel().astype(np.int64), np.array([*header, *k, *grid])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step}


@law
def _on_node(node, d, k, at, v, c_q, c_v, params, f, D, adds):
    """Add the friction of half a segment to a node, or subtract its derivative; returns F.v [W].

    Parameters
    ----------
    node : int
    d : (3,) [m], along the segment
    k : float [N/m], of the half segment
    at, v : (3,) [m], [m/s], place and velocity of the node
    c_q, c_v : derivative of ``at`` [-] and of ``v`` [1/s] by the unknown
    f, D : where it is added if ``adds``, or subtracted
    """
    here = spot(at[0], at[1], params, int(params[3]))
    s = here.height - at[2]
    if s <= 0.0:
        return 0.0
    tilt = math.sqrt(1.0 + here.slope_x * here.slope_x + here.slope_y * here.slope_y)
    n = -here.slope_x / tilt, -here.slope_y / tilt, 1.0 / tilt
    up = d[0] * n[0] + d[1] * n[1] + d[2] * n[2]
    ex, ey, ez = d[0] - up * n[0], d[1] - up * n[1], d[2] - up * n[2]
    l = math.sqrt(ex * ex + ey * ey + ez * ez)
    if l <= SHORT * math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]):
        return 0.0
    e = ex / l, ey / l, ez / l
    m = n[1] * e[2] - n[2] * e[1], n[2] * e[0] - n[0] * e[2], n[0] * e[1] - n[1] * e[0]
    a, a_slope = sliding_share(v[0] * e[0] + v[1] * e[1] + v[2] * e[2], params[2])
    b, b_slope = sliding_share(v[0] * m[0] + v[1] * m[1] + v[2] * m[2], params[2])
    N, along, across = k * s * tilt, params[0], params[1]
    power = 0.0
    for x in range(3):
        F = -(along * a * e[x] + across * b * m[x])
        power += N * F * v[x]
        if adds:
            f[node, x] += N * F
        elif node < D.shape[0]:
            D[node, x, 0] -= c_q * k * tilt * F * here.slope_x
            D[node, x, 1] -= c_q * k * tilt * F * here.slope_y
            D[node, x, 2] += c_q * k * tilt * F
            for y in range(3):
                D[node, x, y] += c_v * N * (along * a_slope * e[x] * e[y] + across * b_slope * m[x] * m[y])
    return power


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add F; returns -sum F.v [W]."""
    power, none = 0.0, np.empty((0, 3, 3))
    for s in range(index.shape[0] // 2):
        i, j = index[2 * s], index[2 * s + 1]
        d = q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2]
        for node in (i, j):
            at, velocity = (q[node, 0], q[node, 1], q[node, 2]), (v[node, 0], v[node, 1], v[node, 2])
            power -= _on_node(node, d, params[HEADER + s], at, velocity, 0.0, 0.0, params, f, none, True)
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes of `force`, but for those by the turning of a segment and of the normal."""
    none = np.empty((0, 3))
    for s in range(index.shape[0] // 2):
        i, j = index[2 * s], index[2 * s + 1]
        d = q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2]
        for node in (i, j):
            at, velocity = (q[node, 0], q[node, 1], q[node, 2]), (v[node, 0], v[node, 1], v[node, 2])
            _on_node(node, d, params[HEADER + s], at, velocity, c_q, c_v, params, none, D, False)


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Friction has no energy, 0 [J]."""
    return 0.0


@inlined_law
def _middle(base, q, i):
    """Place of a node in the middle of a step (3,) [m]."""
    return 0.5 * (base[i, 0] + q[i, 0]), 0.5 * (base[i, 1] + q[i, 1]), 0.5 * (base[i, 2] + q[i, 2])


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Friction over a whole step, see the module, and its derivative but for those by turning."""
    taken, per_h = 0.0, 1.0 / h
    for s in range(index.shape[0] // 2):
        i, j = index[2 * s], index[2 * s + 1]
        first, second = _middle(base, q, i), _middle(base, q, j)
        d = second[0] - first[0], second[1] - first[1], second[2] - first[2]
        for node in (i, j):
            at = _middle(base, q, node)
            v = per_h * (q[node, 0] - base[node, 0]), per_h * (q[node, 1] - base[node, 1]), per_h * (q[node, 2] - base[node, 2])
            taken -= h * _on_node(node, d, params[HEADER + s], at, v, 0.0, 0.0, params, f, D, True)
            _on_node(node, d, params[HEADER + s], at, v, 0.5, per_h, params, f, D, False)
    return taken, 0.0
