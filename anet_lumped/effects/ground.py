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
from typing import Any, Self

import numpy as np

from anet_lumped.checks import Vector, check_direction, check_number
from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.effects.laws.axial import secant_tension, spring_energy
from anet_lumped.effects.laws.contact_area import frequencies, sums_over_halves
from anet_lumped.effects.laws.unresolved_contact import numerical_share, settled_rate

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, SETTLE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

DEPTH = 1e-2  # depth over the cable's diameter, at which the damper acts in full
HEADER, EACH = 6, 5  # numbers in ``params`` before those of the nodes, and of each node


@dataclass(frozen=True)
class Ground(Effect):
    """A plane that holds up every moving node; a node sinks in until the plane carries its load. Statics leave friction out.

    Parameters
    ----------
    height : float
        Height of the plane [m]: its distance from the origin along the normal, z of a level ground.
    stiffness : float
        Pressure per depth [Pa/m] on the area d L0 of a segment: MoorDyn's kBot.
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

    def check_parameters(self) -> None:
        signs = {"height": ("m", ""), "stiffness": ("Pa/m", "positive"), "damping": ("Pa·s/m", "non-negative")}
        signs |= {"friction": ("", "non-negative"), "slip_speed": ("m/s", "positive")}
        for key, (unit, sign) in signs.items():
            self._set(**{key: check_number(key, getattr(self, key), unit, self._called, sign=sign)})
        self._set(normal=check_direction("normal", self.normal, self._called))

    def highest_frequency(self, scene: Any) -> float:
        """Of the mass of a segment on the springs under it, sqrt(k d/mu), or of a body on those at one of its points."""
        found = frequencies(scene.cables, self.stiffness)
        for body in scene.bodies:
            areas = _contacts(body)
            found += [math.sqrt(self.stiffness * area * len(areas) / body.least_masses[name]) for name, (area, _) in areas.items()]
        return max(found)

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
        nodes = sums_over_halves(
            model, "Ground", lambda cable, half: (self.stiffness * half, self.damping * half, DEPTH * cable.diameter * half)
        )
        mass = model.mass.copy()
        for body in model.scene.bodies:
            areas = _contacts(body)
            for name, (area, width) in areas.items():
                nodes[model.node(name)] += self.stiffness * area, self.damping * area, DEPTH * width * area
                mass[model.node(name)] = body.least_masses[name] / len(areas)
        nodes, resisting = nodes[: model.n_free], np.column_stack([mass, model.mass])
        touching = nodes[:, 0] > 0.0  # of a body only some points do
        nodes[touching, 2] *= self.stiffness / nodes[touching, 0]  # the mean over the area
        nodes[~touching, 2] = 1.0
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        numbers = np.column_stack([nodes, resisting[: model.n_free]]).ravel()
        return np.empty(0, np.int64), np.array([*normal, self.height, self.friction, self.slip_speed, *numbers])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "settle": settle}

    def force_on(self, state: Any) -> np.ndarray:
        """Force that each node exerts on the ground in a State, (n, 3) [N]."""
        f = np.zeros_like(state.q)
        force(state.t, state.q, state.v, *self.table(state.model), f)
        return -f


def _contacts(body):
    """Area [m2] and width [m] with which points of a body that moves touch the ground, by their names."""
    found = {}
    if body.is_driven:
        return found
    if body.contact_area > 0.0:
        names = [f"{body.name}.{name}" for name, _ in body.attachments] or [body.name]
        area = body.contact_area / len(names)
        found = dict.fromkeys(names, (area, math.sqrt(4.0 * area / math.pi)))
    for rod in body.rods:
        half = 0.5 * rod.diameter * rod.L0
        for k in range(rod.segments + 1):
            found[f"{body.name}[{rod.name}.{k}]"] = (half if k in (0, rod.segments) else 2.0 * half), rod.diameter
    return found


@inlined_law
def _depth_below(q, i, params):
    """Depth of a node below the plane [m]."""
    return params[3] - (params[0] * q[i, 0] + params[1] * q[i, 1] + params[2] * q[i, 2])


@inlined_law
def _of_node(params, i):
    """k, c, depth and mass of a node."""
    first = HEADER + EACH * i
    return params[first], params[first + 1], params[first + 2], params[first + 3]


@inlined_law
def _normal_force(s, rate, k, c, depth):
    """N of the module's docstring [N], and its slopes in s [N/m] and in ds/dt [N s/m]."""
    if s <= 0.0:
        return 0.0, 0.0, 0.0
    damper_share = min(s / depth, 1.0)
    N = k * s + c * damper_share * rate
    if N <= 0.0:
        return 0.0, 0.0, 0.0
    return N, k + (c / depth * rate if s < depth else 0.0), c * damper_share


@inlined_law
def _damper_depth(s, depth):
    """R of the module's docstring [m], and its slope r."""
    if s <= 0.0:
        return 0.0, 0.0
    if s < depth:
        return 0.5 * s * s / depth, s / depth
    return s - 0.5 * depth, 1.0


@inlined_law
def _normal_force_between(s_a, s_b, h, k, c, depth, numerical):
    """N over a whole step [N], its slope in s_b [N/m], and what damper and numerical damper [N/m] take [J]."""
    secant, slope = secant_tension(s_a, s_b, k, 0.0)
    before, _ = _damper_depth(s_a, depth)
    after, r = _damper_depth(s_b, depth)
    viscous, numerical = c / h * (after - before), numerical if s_a > 0.0 else 0.0
    damped = numerical * (max(s_b, 0.0) - s_a)  # of the sign of `viscous`
    N = secant + viscous + damped
    share = viscous / (viscous + damped) if damped != 0.0 else 1.0
    if N <= 0.0:
        N, slope = 0.0, 0.0
    else:
        slope += c / h * r + (numerical if s_b > 0.0 else 0.0)
    taken = (N - secant) * (s_b - s_a)
    return N, slope, share * taken, (1.0 - share) * taken


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
        k, c, depth, _ = _of_node(params, i)
        s = _depth_below(q, i, params)
        if s > 0.0:
            slide, root, rate = _sliding(v[i, 0], v[i, 1], v[i, 2], params)
            N, _, _ = _normal_force(s, rate, k, c, depth)
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
            k, c, depth, _ = _of_node(params, i)
            slide, root, rate = _sliding(v[i, 0], v[i, 1], v[i, 2], params)
            N, of_depth, of_rate = _normal_force(s, rate, k, c, depth)
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
            k, c, depth, mass = _of_node(params, i)
            numerical = k * numerical_share(damper, 0.25 * h * h * k / mass)
            N, slope, viscous, unresolved = _normal_force_between(s_a, s_b, h, k, c, depth, numerical)
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
            k, c, _, mass = _of_node(params, i)
            viscous, of_node = 0.5 * h * c / mass, params[HEADER + EACH * i + 4]
            rate = -(params[0] * v[i, 0] + params[1] * v[i, 1] + params[2] * v[i, 2])
            after = settled_rate(damper, 0.25 * h * h * k / mass + viscous * viscous, rate, (s_b - s_a) / h)
            change = mass / of_node * (rate - after)  # by the impulse that all the mass needs, which a body shares among its nodes
            for x in range(3):
                v[i, x] += change * params[x]
            taken += 0.5 * of_node * change * (2.0 * rate - change)
    return taken
