"""A ground that is not flat: a height map, bilinear in the cells of a grid, with the contact and friction of `ground`.

A node at the depth s = H(x, y) - z below the map is pressed back with N of `laws.contact` against the gradient of s,

    f = -N grad s = N (-dH/dx, -dH/dy, 1) ,     energy k s^2/2 .

The depth is measured along z. So a slope of the angle theta presses along its normal with N/cos(theta), as a plane of the stiffness
k/cos(theta)^2 does. Friction is mu N/cos(theta), against the velocity along the ground.

Over a whole step from a to b, N is that of `normal_force_between` for the depths s_a and s_b, and acts along the slopes of
`height_map.mean_slope`, for which H_b - H_a = slope . (q_b - q_a) exactly, whatever cells the step crosses. So the work of the
force is -N (s_b - s_a), and no step can raise the energy, as with a plane.
Source: as `ground`; Gonzalez, J. Nonlinear Sci. 6 (1996) 449, for steps across edges.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import Vector
from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.effects.laws.axial import spring_energy
from anet_lumped.effects.laws.contact import (
    EACH,
    frequencies_of_contact,
    normal_force,
    normal_force_between,
    numbers_of_nodes,
    of_node,
)
from anet_lumped.effects.laws.contact_area import OF_GROUND, SLIP_SPEED
from anet_lumped.effects.laws.height_map import checked_map, in_one_cell, mean_slope, spot
from anet_lumped.effects.laws.unresolved_contact import numerical_share, settled_rate

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, SETTLE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER = 3  # numbers in ``params`` before those of the nodes: mu, slip speed, where the map begins


@dataclass(frozen=True)
class GroundMap(Effect):
    """A height map that holds up every moving node; a node sinks in until it carries its load. Statics leave friction out.

    Parameters
    ----------
    x, y : sequences of float
        Places of the grid [m], each growing, two or more.
    heights : sequence of sequences of float
        Height at each place [m], a row for each of ``x`` with a number for each of ``y``. Beyond the grid they are
        those of its edge.
    stiffness : float
        Pressure per depth [Pa/m] on the area d L0 of a segment: MoorDyn's kBot. 0 for a ground that only damps.
    damping : float
        Pressure per speed of sinking in [Pa s/m]: MoorDyn's cBot.
    friction : float
        Coefficient mu, of sliding and of sticking.
    slip_speed : float
        Speed at which friction reaches 71 % of mu N [m/s].
    """

    x: Sequence[float]
    y: Sequence[float]
    heights: Sequence[Sequence[float]]
    stiffness: float = 3e6
    damping: float = 3e5
    friction: float = 0.0
    slip_speed: float = 1e-3

    is_ground: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._check_numbers(**OF_GROUND, slip_speed=SLIP_SPEED)
        self._set(**checked_map(self.x, self.y, self.heights, self._called))

    @property
    def steepest(self) -> float:
        """Largest slope of the map."""
        H, x, y = np.array(self.heights), np.array(self.x), np.array(self.y)
        along_x, along_y = np.abs(np.diff(H, axis=0) / np.diff(x)[:, None]), np.abs(np.diff(H, axis=1) / np.diff(y))
        return float(np.hypot(along_x.max(), along_y.max()))

    def highest_frequency(self, scene: Any) -> float:
        """That of `Ground`, on the steepest slope."""
        return max(frequencies_of_contact(scene, self.stiffness)) * math.hypot(1.0, self.steepest)

    def highest_damping_rate(self, scene: Any) -> float:
        return max(frequencies_of_contact(scene, self.damping)) ** 2 * (1.0 + self.steepest**2)

    def at_rest(self) -> Effect:
        return replace(self, friction=0.0)

    def seen_from(self, origin: Vector, scene: Any) -> Effect:
        x, y, z = map(float, origin)
        heights = [[height - z for height in row] for row in self.heights]
        return replace(self, x=[at - x for at in self.x], y=[at - y for at in self.y], heights=heights)

    @classmethod
    def example(cls, scene: Any) -> Self:
        height = height_under(scene)
        return cls((-1.0, 0.0, 1.0), (-1.0, 1.0), ((height,) * 2, (height, height + 0.1), (height,) * 2))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : empty
        params : float64
            mu, slip speed [m/s], where the map begins; of each moving node what `laws.contact.numbers_of_nodes` says; the map.

        Raises
        ------
        SceneError : a cable without a diameter
        """
        numbers = numbers_of_nodes(model, "GroundMap", self.stiffness, self.damping)
        first = HEADER + len(numbers)
        grid = (len(self.x), len(self.y), *self.x, *self.y, *np.ravel(self.heights))
        return np.empty(0, np.int64), np.array([self.friction, self.slip_speed, first, *numbers, *grid])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "settle": settle}

    def height_at(self, x: float, y: float) -> float:
        """Height of the map at a place [m]."""
        grid = (len(self.x), len(self.y), *self.x, *self.y, *np.ravel(self.heights))
        return float(spot(float(x), float(y), np.array(grid, float), 0).height)


@inlined_law
def _count(params):
    """Number of moving nodes."""
    return (int(params[2]) - HEADER) // EACH


@inlined_law
def _sliding(velocity, slope_x, slope_y, params):
    """v_t/sqrt(v_t^2 + u^2) with the velocity v_t along the ground; the root; 1/cos(theta); unit normal; speed of sinking in."""
    tilt = math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    nx, ny, nz = -slope_x / tilt, -slope_y / tilt, 1.0 / tilt
    along = nx * velocity[0] + ny * velocity[1] + nz * velocity[2]
    vx, vy, vz = velocity[0] - along * nx, velocity[1] - along * ny, velocity[2] - along * nz
    root = math.sqrt(vx * vx + vy * vy + vz * vz + params[1] * params[1])
    return (vx / root, vy / root, vz / root), root, tilt, (nx, ny, nz), -along * tilt


@inlined_law
def _add_force(f, i, N, slopes, tilt, slide, params):
    """Add N (-slopes, 1) and friction; ``tilt`` is 1/cos(theta)."""
    rubbing = params[0] * N * tilt
    f[i, 0] -= N * slopes[0] + rubbing * slide[0]
    f[i, 1] -= N * slopes[1] + rubbing * slide[1]
    f[i, 2] += N - rubbing * slide[2]


@inlined_law
def _add_tangent(D, i, slope, at_end, slopes, tilt, friction):
    """Add the block of a node: ``slope`` of N in its depth, whose gradient is (*at_end, -1), and of friction.

    ``friction`` is the slope of friction in the displacement of the node, the direction of sliding, the normal and mu. How the
    normal turns with the place changes friction by the order of the depth, and is left out.
    """
    viscous, slide, n, mu = friction
    gradient, push = (at_end[0], at_end[1], -1.0), (slopes[0], slopes[1], -1.0)
    for x in range(3):
        for y in range(3):
            D[i, x, y] += slope * (push[x] + mu * tilt * slide[x]) * gradient[y]
            D[i, x, y] -= viscous * (n[x] * n[y] + slide[x] * slide[y])
        D[i, x, x] += viscous


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i -= N grad s and friction; see the module. Returns the power that damper and friction take [W]."""
    power = 0.0
    for i in range(_count(params)):
        here = spot(q[i, 0], q[i, 1], params, int(params[2]))
        s = here.height - q[i, 2]
        if s > 0.0:
            k, c, depth, _ = of_node(params, HEADER, i)
            slide, root, tilt, _, rate = _sliding((v[i, 0], v[i, 1], v[i, 2]), here.slope_x, here.slope_y, params)
            N, _, _ = normal_force(s, rate, k, c, depth)
            _add_force(f, i, N, (here.slope_x, here.slope_y), tilt, slide, params)
            power += (N - k * s) * rate
            power += params[0] * N * tilt * root * (slide[0] * slide[0] + slide[1] * slide[1] + slide[2] * slide[2])
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Derivatives of `force`, exact but for what `_add_tangent` leaves out."""
    for i in range(_count(params)):
        here = spot(q[i, 0], q[i, 1], params, int(params[2]))
        s = here.height - q[i, 2]
        if s > 0.0:
            k, c, depth, _ = of_node(params, HEADER, i)
            slide, root, tilt, n, rate = _sliding((v[i, 0], v[i, 1], v[i, 2]), here.slope_x, here.slope_y, params)
            N, of_depth, of_rate = normal_force(s, rate, k, c, depth)
            slopes, friction = (here.slope_x, here.slope_y), (c_v * params[0] * N * tilt / root, slide, n, params[0])
            _add_tangent(D, i, c_q * of_depth + c_v * of_rate, slopes, slopes, tilt, friction)
            D[i, 0, 0] += c_q * N * here.xx
            D[i, 0, 1] += c_q * N * here.xy
            D[i, 1, 0] += c_q * N * here.xy
            D[i, 1, 1] += c_q * N * here.yy
            for x, push in ((0, here.slope_x), (1, here.slope_y), (2, -1.0)):  # how the slopes turn the speed of sinking in
                D[i, x, 0] += c_q * of_rate * push * (here.xx * v[i, 0] + here.xy * v[i, 1])
                D[i, x, 1] += c_q * of_rate * push * (here.xy * v[i, 0] + here.yy * v[i, 1])


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """Sum of k s^2/2 of the nodes below the map [J]."""
    total = 0.0
    for i in range(_count(params)):
        s = spot(q[i, 0], q[i, 1], params, int(params[2])).height - q[i, 2]
        total += spring_energy(s, params[HEADER + EACH * i], 0.0)
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step, and its derivative, exact but for what `_add_tangent` leaves out; see the module."""
    dissipated, by_method, per_h = 0.0, 0.0, 1.0 / h
    for i in range(_count(params)):
        before, after = spot(base[i, 0], base[i, 1], params, int(params[2])), spot(q[i, 0], q[i, 1], params, int(params[2]))
        s_a, s_b = before.height - base[i, 2], after.height - q[i, 2]
        if s_a > 0.0 or s_b > 0.0:
            k, c, depth, mass = of_node(params, HEADER, i)
            dx, dy, dz = q[i, 0] - base[i, 0], q[i, 1] - base[i, 1], q[i, 2] - base[i, 2]
            mean = mean_slope(before, after, dx, dy)
            # across an edge the mean normal turns as fast as the step is short: friction takes the one before it
            along_x, along_y = (mean.x, mean.y) if in_one_cell(before, after) else (before.slope_x, before.slope_y)
            slide, root, tilt, n, _ = _sliding((per_h * dx, per_h * dy, per_h * dz), along_x, along_y, params)
            numerical = k * numerical_share(damper, 0.25 * h * h * k * tilt * tilt / mass)
            N, slope, viscous, unresolved = normal_force_between(s_a, s_b, h, k, c, depth, numerical)
            _add_force(f, i, N, (mean.x, mean.y), tilt, slide, params)
            friction = per_h * params[0] * N * tilt / root, slide, n, params[0]
            _add_tangent(D, i, slope, (after.slope_x, after.slope_y), (mean.x, mean.y), tilt, friction)
            D[i, 0, 0] += N * mean.xx
            D[i, 0, 1] += N * mean.xy
            D[i, 1, 0] += N * mean.yx
            D[i, 1, 1] += N * mean.yy
            dissipated, by_method = dissipated + viscous, by_method + unresolved
            sliding = slide[0] * slide[0] + slide[1] * slide[1] + slide[2] * slide[2]
            dissipated += h * params[0] * N * tilt * root * sliding
    return dissipated, by_method


@njit(SETTLE_SIGNATURE, cache=True, error_model="numpy")
def settle(t, h, damper, base, q, v, index, params):
    """Speed of sinking in of the nodes that stay below the map, without what rings, see `laws.unresolved_contact`."""
    taken = 0.0
    for i in range(_count(params)):
        before, after = spot(base[i, 0], base[i, 1], params, int(params[2])), spot(q[i, 0], q[i, 1], params, int(params[2]))
        s_a, s_b = before.height - base[i, 2], after.height - q[i, 2]
        if s_a > 0.0 and s_b > 0.0:
            k, c, _, mass = of_node(params, HEADER, i)
            square = 1.0 + after.slope_x * after.slope_x + after.slope_y * after.slope_y  # 1/cos(theta)^2
            viscous, own_mass = 0.5 * h * c * square / mass, params[HEADER + EACH * i + 4]
            rate = after.slope_x * v[i, 0] + after.slope_y * v[i, 1] - v[i, 2]
            wanted = settled_rate(damper, 0.25 * h * h * k * square / mass + viscous * viscous, rate, (s_b - s_a) / h)
            change = mass / own_mass * (rate - wanted)  # by the impulse that all the mass needs, which a body shares
            for x, push in ((0, -after.slope_x), (1, -after.slope_y), (2, 1.0)):
                v[i, x] += change * push / square
            taken += 0.5 * own_mass * change * (2.0 * rate - change) / square
    return taken
