"""A flat ground, or the bottom of a tank: a stiff, damped plane with Coulomb friction.

The ground presses a node at a depth s below the plane back with the force

    N = k s + c r(s) ds/dt >= 0 ,     k = `stiffness` A ,   c = `damping` A ,   A = sum of d L0/2 over its segments ,

with r = min(s/depth, 1). The damper acts in full from a depth of `DEPTH` diameters on, so that N has no jump when a node touches
down (as Hunt & Crossley argue). The ground never pulls. Friction is -mu N v_t/sqrt(v_t^2 + u^2), with the velocity v_t along the
plane. A node that sticks creeps: slower than the `slip_speed` u while the force along the plane is below 0.7 mu N.

On a rigid body, `Body.contact_area` is shared by its attachments, and each segment of a rod has the area d L0. The depth at which
the damper acts in full is `DEPTH` diameters of a disc of the area of an attachment.

Over a whole step from a to b, N is the secant of the spring energy k s^2/2 plus c/h (R_b - R_a), R the integral of r, plus the
numerical damper alpha k (s_b - s_a) of `laws.unresolved_contact` where s_a > 0, and friction takes the mean velocity (q_b - q_a)/h
along the plane. Then no step can raise the energy.
Source: Hall & Goupee, Ocean Eng. 104 (2015) 590, eq. 16, for the contact area; Hunt & Crossley, J. Appl. Mech. 42 (1975) 440, for
a damper that grows with the depth; Armero & Petocz, Comput. Methods Appl. Mech. Engrg. 158 (1998) 269, for the step.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import Vector, check_direction
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
from anet_lumped.effects.laws.unresolved_contact import numerical_share, settled_rate

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, SETTLE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER = 6  # numbers in ``params`` before those of the nodes


@dataclass(frozen=True)
class Ground(Effect):
    """A plane that holds up every moving node; a node sinks in until the plane carries its load. Statics leave friction out.

    Parameters
    ----------
    height : float
        Height of the plane [m]: its distance from the origin along the normal, z of a level ground.
    stiffness : float
        Pressure per depth [Pa/m] on the area d L0 of a segment: MoorDyn's kBot. 0 for a ground that only damps.
    damping : float
        Pressure per speed of sinking in [Pa s/m]: MoorDyn's cBot.
    friction : float
        Coefficient mu, of sliding and of sticking.
    normal : tuple of 3 float
        Direction out of the ground; its length must not be zero.
    slip_speed : float
        Speed at which friction reaches 71 % of mu N [m/s].
    """

    height: float = 0.0
    stiffness: float = 3e6
    damping: float = 3e5
    friction: float = 0.0
    normal: Vector = (0.0, 0.0, 1.0)
    slip_speed: float = 1e-3

    is_ground: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._check_numbers(height=("m", ""), **OF_GROUND, slip_speed=SLIP_SPEED)
        self._set(normal=check_direction("normal", self.normal, self._called))

    def highest_frequency(self, scene: Any) -> float:
        """Of the mass of a segment on the springs under it, sqrt(k d/mu), or of a body on those at one of its points."""
        return max(frequencies_of_contact(scene, self.stiffness))

    def highest_damping_rate(self, scene: Any) -> float:
        return max(frequencies_of_contact(scene, self.damping)) ** 2

    def at_rest(self) -> Effect:
        return replace(self, friction=0.0)

    def seen_from(self, origin: Vector, scene: Any) -> Effect:
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        return replace(self, height=self.height - float(normal @ origin))

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(height=height_under(scene))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : empty
        params : float64
            Unit normal, height [m], mu, slip speed [m/s]; of each moving node k [N/m], c [N s/m], depth [m], the mass [kg] that
            resists it, and that of the node itself, which on a body is smaller.

        Raises
        ------
        SceneError : a cable without a diameter
        """
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        numbers = numbers_of_nodes(model, "Ground", self.stiffness, self.damping)
        return np.empty(0, np.int64), np.array([*normal, self.height, self.friction, self.slip_speed, *numbers])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "settle": settle}

    def force_on(self, state: Any) -> np.ndarray:
        """Force that each node exerts on the ground in a State, (n, 3) [N]."""
        f = np.zeros_like(state.q)
        force(state.t, state.q, state.v, *self.table(state.model), f)
        return -f


@inlined_law
def _depth_below(q, i, params):
    """Depth of a node below the plane [m]."""
    return params[3] - (params[0] * q[i, 0] + params[1] * q[i, 1] + params[2] * q[i, 2])


@inlined_law
def _sliding(vx, vy, vz, params):
    """v_t/sqrt(v_t^2 + u^2) with the velocity v_t along the plane; the root sqrt(v_t^2 + u^2); the speed of sinking in [m/s]."""
    along = params[0] * vx + params[1] * vy + params[2] * vz
    vx, vy, vz = vx - along * params[0], vy - along * params[1], vz - along * params[2]
    root = math.sqrt(vx * vx + vy * vy + vz * vz + params[5] * params[5])
    return (vx / root, vy / root, vz / root), root, -along


@inlined_law
def _add_force(f, i, N, slide, params):
    for x in range(3):
        f[i, x] += N * (params[x] - params[4] * slide[x])


@inlined_law
def _add_tangent(D, i, slope, viscous, slide, params):
    """Add the block of a node, with the slope of N in s, and ``viscous``, the slope of friction in the displacement of the node."""
    for x in range(3):
        for y in range(3):
            D[i, x, y] += slope * (params[x] - params[4] * slide[x]) * params[y]
            D[i, x, y] -= viscous * (params[x] * params[y] + slide[x] * slide[y])
        D[i, x, x] += viscous


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i += N n - mu N v_t/sqrt(v_t^2 + u^2); see the module. Returns the power that damper and friction take [W]."""
    power = 0.0
    for i in range((params.shape[0] - HEADER) // EACH):
        k, c, depth, _ = of_node(params, HEADER, i)
        s = _depth_below(q, i, params)
        if s > 0.0:
            slide, root, rate = _sliding(v[i, 0], v[i, 1], v[i, 2], params)
            N, _, _ = normal_force(s, rate, k, c, depth)
            _add_force(f, i, N, slide, params)
            power += (N - k * s) * rate
            power += params[4] * N * root * (slide[0] * slide[0] + slide[1] * slide[1] + slide[2] * slide[2])
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Exact derivatives of `force`."""
    for i in range((params.shape[0] - HEADER) // EACH):
        s = _depth_below(q, i, params)
        if s > 0.0:
            k, c, depth, _ = of_node(params, HEADER, i)
            slide, root, rate = _sliding(v[i, 0], v[i, 1], v[i, 2], params)
            N, of_depth, of_rate = normal_force(s, rate, k, c, depth)
            _add_tangent(D, i, c_q * of_depth + c_v * of_rate, c_v * params[4] * N / root, slide, params)


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """Sum of k s^2/2 of the nodes below the plane [J]."""
    total = 0.0
    for i in range((params.shape[0] - HEADER) // EACH):
        total += spring_energy(_depth_below(q, i, params), params[HEADER + EACH * i], 0.0)
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step, and its exact derivative; see the module."""
    dissipated, by_method, per_h = 0.0, 0.0, 1.0 / h
    for i in range((params.shape[0] - HEADER) // EACH):
        s_a, s_b = _depth_below(base, i, params), _depth_below(q, i, params)
        if s_a > 0.0 or s_b > 0.0:
            k, c, depth, mass = of_node(params, HEADER, i)
            numerical = k * numerical_share(damper, 0.25 * h * h * k / mass)
            N, slope, viscous, unresolved = normal_force_between(s_a, s_b, h, k, c, depth, numerical)
            vx, vy, vz = per_h * (q[i, 0] - base[i, 0]), per_h * (q[i, 1] - base[i, 1]), per_h * (q[i, 2] - base[i, 2])
            slide, root, _ = _sliding(vx, vy, vz, params)
            _add_force(f, i, N, slide, params)
            _add_tangent(D, i, slope, per_h * params[4] * N / root, slide, params)
            dissipated, by_method = dissipated + viscous, by_method + unresolved
            dissipated += h * params[4] * N * root * (slide[0] * slide[0] + slide[1] * slide[1] + slide[2] * slide[2])
    return dissipated, by_method


@njit(SETTLE_SIGNATURE, cache=True, error_model="numpy")
def settle(t, h, damper, base, q, v, index, params):
    """Speed of sinking in of the nodes that stay below the plane, without what rings, see `laws.unresolved_contact`."""
    taken = 0.0
    for i in range((params.shape[0] - HEADER) // EACH):
        s_a, s_b = _depth_below(base, i, params), _depth_below(q, i, params)
        if s_a > 0.0 and s_b > 0.0:
            k, c, _, mass = of_node(params, HEADER, i)
            viscous, own_mass = 0.5 * h * c / mass, params[HEADER + EACH * i + 4]
            rate = -(params[0] * v[i, 0] + params[1] * v[i, 1] + params[2] * v[i, 2])
            after = settled_rate(damper, 0.25 * h * h * k / mass + viscous * viscous, rate, (s_b - s_a) / h)
            change = mass / own_mass * (rate - after)  # by the impulse that all the mass needs, which a body shares among its nodes
            for x in range(3):
                v[i, x] += change * params[x]
            taken += 0.5 * own_mass * change * (2.0 * rate - change)
    return taken
