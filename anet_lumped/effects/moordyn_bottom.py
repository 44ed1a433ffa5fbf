"""The bottom of the sea as MoorDyn has it: a damper that pulls as it presses, and friction that grows with the speed.

A node at a depth s below the level plane feels the force along z

    N = k s + c ds/dt ,     k = `stiffness` A ,   c = `damping` A ,   A = sum of d L0/2 over its segments ,

which holds a node back that rises faster than k s/c, and jumps where a node touches down; `ground` has neither. Friction is

    -mu min(D |v_t|, |N|) v_t/|v_t| ,     D = `friction_damping` ,

with the velocity v_t along the plane; with a `static_ratio` r it is -mu D v_t up to r mu |N|, and mu |N| beyond. At MoorDyn's
D = 200 N s/m and for the loads of large moorings it is next to nothing: a node that carries 1 kN has all of its friction at 5 m/s.

Over a whole step from a to b, N is the secant of the spring energy k s^2/2 plus c/h (max(s_b, 0) - max(s_a, 0)), plus the numerical
damper of `laws.unresolved_contact`, and friction takes the mean velocity. Each takes energy at any step, or none.
Source: MoorDyn's Line.cpp (getStateDeriv, "bottom contact"); Hall & Goupee, Ocean Eng. 104 (2015) 590, eq. 16.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import SceneError, Vector, quoted
from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.effects.laws.axial import secant_tension, spring_energy
from anet_lumped.effects.laws.contact_area import OF_GROUND, frequencies, sums_over_halves
from anet_lumped.effects.laws.unresolved_contact import numerical_share, settled_rate

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, SETTLE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER, EACH = 4, 3  # numbers in ``params`` before those of the nodes, and of each node


@dataclass(frozen=True)
class MoordynBottom(Effect):
    """A level bottom with MoorDyn's damper and friction. Statics leave friction out.

    Parameters
    ----------
    height : float
        Height of the plane [m].
    stiffness : float
        Pressure per depth [Pa/m] on the area d L0 of a segment: MoorDyn's kBot. 0 for a ground that only damps.
    damping : float
        Pressure per speed of sinking in [Pa s/m]: MoorDyn's cBot.
    friction : float
        Coefficient mu: MoorDyn's FrictionCoefficient.
    friction_damping : float
        D, force per speed on a node over mu [N s/m]: MoorDyn's FricDamp.
    static_ratio : float
        r, the friction at which a node slips over that of one that slides: MoorDyn's StatDynFricScale.
    """

    height: float = 0.0
    stiffness: float = 3e6
    damping: float = 3e5
    friction: float = 0.0
    friction_damping: float = 200.0
    static_ratio: float = 1.0

    is_ground: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._check_numbers(
            height=("m", ""), **OF_GROUND, friction_damping=("N·s/m", "non-negative"), static_ratio=("", "non-negative")
        )

    def highest_frequency(self, scene: Any) -> float:
        """Of the mass of a segment on the springs under it."""
        return max(frequencies(scene.cables, self.stiffness))

    def highest_damping_rate(self, scene: Any) -> float:
        return max(frequencies(scene.cables, self.damping)) ** 2

    def at_rest(self) -> Effect:
        return replace(self, friction=0.0)

    def seen_from(self, origin: Vector, scene: Any) -> Effect:
        return replace(self, height=self.height - float(origin[2]))

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(height=height_under(scene))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : empty
        params : float64
            Height [m], mu, D [N s/m], r; k [N/m], c [N s/m] and mass [kg] of each moving node.

        Raises
        ------
        SceneError : a cable without a diameter, or a body that moves by itself
        """
        if model.has_bodies:
            free = next(body.name for body in model.scene.bodies if not body.is_driven)
            raise SceneError(
                f"The effect MoordynBottom acts on cables alone, so that no body may move by itself, but {quoted(free)} does; "
                "Ground holds up bodies and rods."
            )
        area = sums_over_halves(model, "MoordynBottom", 1, lambda cable, half: (half,))[:, 0]
        area, mass = area[: model.n_free], model.mass[: model.n_free]
        numbers = np.column_stack([self.stiffness * area, self.damping * area, mass]).ravel()
        return np.empty(0, np.int64), np.array([self.height, self.friction, self.friction_damping, self.static_ratio, *numbers])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "settle": settle}


@inlined_law
def _of_node(params, i):
    """k, c and mass of a node."""
    first = HEADER + EACH * i
    return params[first], params[first + 1], params[first + 2]


@inlined_law
def _friction(vx, vy, N, params):
    """Force over the velocity, F/|v_t| [N s/m], and 1 where it is limited by the load, else 0."""
    speed = math.sqrt(vx * vx + vy * vy)
    if params[2] * speed <= params[3] * abs(N):
        return params[1] * params[2], 0.0
    return params[1] * abs(N) / speed, 1.0


@inlined_law
def _add_force(f, i, N, vx, vy, per_speed):
    f[i, 0] -= per_speed * vx
    f[i, 1] -= per_speed * vy
    f[i, 2] += N


@inlined_law
def _add_tangent(D, i, N, slope, c_v, vx, vy, friction, mu):
    """Add the block of a node: ``slope`` of N against z, friction's force over the velocity times ``c_v``, and what limits it."""
    per_speed, limited = friction
    D[i, 2, 2] += slope
    square = max(vx * vx + vy * vy, 1e-300)
    D[i, 0, 0] += c_v * per_speed * (1.0 - limited * vx * vx / square)
    D[i, 1, 1] += c_v * per_speed * (1.0 - limited * vy * vy / square)
    D[i, 0, 1] -= c_v * per_speed * limited * vx * vy / square
    D[i, 1, 0] -= c_v * per_speed * limited * vx * vy / square
    toward = limited * mu * math.copysign(1.0, N) * slope / math.sqrt(square)
    D[i, 0, 2] -= toward * vx
    D[i, 1, 2] -= toward * vy


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add N and friction; see the module. Returns the power that damper and friction take [W]."""
    power = 0.0
    for i in range((params.shape[0] - HEADER) // EACH):
        s = params[0] - q[i, 2]
        if s > 0.0:
            k, c, _ = _of_node(params, i)
            vx, vy, rate = v[i, 0], v[i, 1], -v[i, 2]
            N = k * s + c * rate
            per_speed, _ = _friction(vx, vy, N, params)
            _add_force(f, i, N, vx, vy, per_speed)
            power += c * rate * rate + per_speed * (vx * vx + vy * vy)
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Exact derivatives of `force`."""
    for i in range((params.shape[0] - HEADER) // EACH):
        s = params[0] - q[i, 2]
        if s > 0.0:
            k, c, _ = _of_node(params, i)
            N = k * s - c * v[i, 2]
            friction = _friction(v[i, 0], v[i, 1], N, params)
            _add_tangent(D, i, N, c_q * k + c_v * c, c_v, v[i, 0], v[i, 1], friction, params[1])


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """Sum of k s^2/2 of the nodes below the plane [J]."""
    total = 0.0
    for i in range((params.shape[0] - HEADER) // EACH):
        total += spring_energy(params[0] - q[i, 2], params[HEADER + EACH * i], 0.0)
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step, and its exact derivative; see the module."""
    dissipated, by_method, per_h = 0.0, 0.0, 1.0 / h
    for i in range((params.shape[0] - HEADER) // EACH):
        s_a, s_b = params[0] - base[i, 2], params[0] - q[i, 2]
        if s_a > 0.0 or s_b > 0.0:
            k, c, mass = _of_node(params, i)
            secant, slope = secant_tension(s_a, s_b, k, 0.0)
            numerical = k * numerical_share(damper, 0.25 * h * h * k / mass) if s_a > 0.0 else 0.0
            sunk = max(s_b, 0.0) - max(s_a, 0.0)
            N = secant + (per_h * c + numerical) * sunk
            slope += per_h * c + numerical if s_b > 0.0 else 0.0
            vx, vy = per_h * (q[i, 0] - base[i, 0]), per_h * (q[i, 1] - base[i, 1])
            friction = _friction(vx, vy, N, params)
            _add_force(f, i, N, vx, vy, friction[0])
            _add_tangent(D, i, N, slope, per_h, vx, vy, friction, params[1])
            dissipated += per_h * c * sunk * (s_b - s_a) + h * friction[0] * (vx * vx + vy * vy)
            by_method += numerical * sunk * (s_b - s_a)
    return dissipated, by_method


@njit(SETTLE_SIGNATURE, cache=True, error_model="numpy")
def settle(t, h, damper, base, q, v, index, params):
    """Speed of sinking in of the nodes that stay below the plane, without what rings, see `laws.unresolved_contact`."""
    taken = 0.0
    for i in range((params.shape[0] - HEADER) // EACH):
        s_a, s_b = params[0] - base[i, 2], params[0] - q[i, 2]
        if s_a > 0.0 and s_b > 0.0:
            k, c, mass = _of_node(params, i)
            viscous, rate = 0.5 * h * c / mass, -v[i, 2]
            after = settled_rate(damper, 0.25 * h * h * k / mass + viscous * viscous, rate, (s_b - s_a) / h)
            v[i, 2] = -after
            taken += 0.5 * mass * (rate * rate - after * after)
    return taken
