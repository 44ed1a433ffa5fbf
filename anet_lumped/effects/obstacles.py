"""Obstacles: solids with a stiff, damped surface and Coulomb friction, which hold up the nodes of cables.

A node at a depth s in a shape (`laws.solid`) is pressed back by N of `laws.contact`, with the outward normal n = -grad s, and
rubbed by friction against its velocity v_t along the surface,

    f = N n - mu N v_t/sqrt(v_t^2 + u^2) ,     energy k s^2/2 ,

with the same contact areas, damper and creep at the `slip_speed` u as `ground` has. Shapes that overlap press each on its own.

Over a whole step from a to b, N is that of `normal_force_between` for the depths s_a and s_b, and acts against the discrete
gradient G of the depth, for which s_b - s_a = G . (q_b - q_a) exactly. So its work is -N (s_b - s_a), and no step can raise the
energy, as with a plane. Friction takes the mean velocity (q_b - q_a)/h across G.

What is met are nodes, not the straight segments between them. A segment of the length L that spans a surface of the radius R cuts
it by L^2/(8 R), and an edge of a box by up to L/2.
Source: as `ground`; Gonzalez, J. Nonlinear Sci. 6 (1996) 449, for steps along what is not flat.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from anet_lumped.checks import SceneError, Vector, quoted
from anet_lumped.compiled.jit import law, njit
from anet_lumped.effects.laws.axial import spring_energy
from anet_lumped.effects.laws.contact import (
    EACH,
    frequencies_of_contact,
    normal_force,
    normal_force_between,
    numbers_of_nodes,
    of_node,
)
from anet_lumped.effects.laws.contact_area import CONTACT, SLIP_SPEED
from anet_lumped.effects.laws.solid import NUMBERS, between, depth, numbers_of
from anet_lumped.effects.laws.unresolved_contact import numerical_share, settled_rate
from anet_lumped.effects.shapes import Shape, Sphere
from anet_lumped.effects.shapes.base import check_shapes

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, SETTLE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER = 3  # numbers in ``params`` before those of the shapes: mu, slip speed, where the nodes begin


@dataclass(frozen=True)
class Obstacles(Effect):
    """Solids that hold up every moving node; a node sinks in until the solid carries its load. Statics leave friction out.

    Parameters
    ----------
    shapes : a shape of `anet_lumped.shapes`, or several
    stiffness : float
        Pressure per depth [Pa/m] on the area d L0 of a segment.
    damping : float
        Pressure per speed of sinking in [Pa s/m].
    friction : float
        Coefficient mu, of sliding and of sticking.
    slip_speed : float
        Speed at which friction reaches 71 % of mu N [m/s].
    """

    shapes: Shape | Sequence[Shape]
    stiffness: float = 1e9
    damping: float = 1e5
    friction: float = 0.0
    slip_speed: float = 1e-3

    def check_parameters(self) -> None:
        self._check_numbers(**CONTACT, slip_speed=SLIP_SPEED)
        self._set(shapes=check_shapes("shapes", self.shapes, self._called))

    @property
    def all_shapes(self) -> tuple[Shape, ...]:
        """Its shapes, one or several."""
        return check_shapes("shapes", self.shapes, self._called)

    def highest_frequency(self, scene: Any) -> float:
        """Of the mass of a segment on the springs under it, sqrt(k d/mu), or of a body on those at one of its points."""
        return max(frequencies_of_contact(scene, self.stiffness))

    def highest_damping_rate(self, scene: Any) -> float:
        return max(frequencies_of_contact(scene, self.damping)) ** 2

    @property
    def narrowest(self) -> float:
        return min(shape.half_width for shape in self.all_shapes)

    def at_rest(self) -> Effect:
        return replace(self, friction=0.0)

    def seen_from(self, origin: Vector, scene: Any) -> Effect:
        moved = tuple(replace(shape, at=tuple(np.subtract(shape.at, origin).tolist())) for shape in self.all_shapes)  # type: ignore[type-var]
        return replace(self, shapes=moved)

    @classmethod
    def example(cls, scene: Any) -> Self:
        x, y, _ = np.mean(scene.supports, axis=0).tolist()
        radius = scene.longest
        return cls((Sphere((x, y, height_under(scene) - radius), radius),))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : empty
        params : float64
            mu, slip speed [m/s], where the nodes begin; `laws.solid.NUMBERS` numbers of each shape; of each moving node what
            `laws.contact.numbers_of_nodes` says.

        Raises
        ------
        SceneError : a cable without a diameter, or with segments that are too long for a shape
        """
        for k, shape in enumerate(self.all_shapes):
            for cable in model.scene.cables:
                if cable.L0 > shape.half_width:
                    least = math.ceil(cable.length / shape.half_width)
                    raise SceneError(
                        f"Obstacles meet the nodes of cables, so that segments must not be longer than half the smallest width of "
                        f"a shape, but cable {quoted(cable.name)} has segments of {cable.L0:.3g} m, and shapes[{k}], a "
                        f"{type(shape).__name__}, a half width of {shape.half_width:.3g} m; it takes segments={least} or more."
                    )
        numbers = numbers_of_nodes(model, "Obstacles", self.stiffness, self.damping)
        solids = [numbers_of(shape.at, shape.solid()) for shape in self.all_shapes]
        first = HEADER + NUMBERS * len(solids)
        return np.empty(0, np.int64), np.array([self.friction, self.slip_speed, first, *np.ravel(solids), *numbers])

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "settle": settle}

    def force_on(self, state: Any) -> np.ndarray:
        """Force that each node exerts on the obstacles in a State, (n, 3) [N]."""
        f = np.zeros_like(state.q)
        force(state.t, state.q, state.v, *self.table(state.model), f)
        return -f


@law
def _counts(params):
    """Number of moving nodes, number of shapes, and what stands before the numbers of the nodes."""
    header = int(params[2])
    return (params.shape[0] - header) // EACH, (header - HEADER) // NUMBERS, header


@law
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@law
def _of_node(rows, i):
    return rows[i, 0], rows[i, 1], rows[i, 2]


@law
def _sliding(v, G, params):
    """w = v_t/sqrt(v_t^2 + u^2) with the velocity v_t across G; the root sqrt(v_t^2 + u^2); |G|, and the unit vector of G."""
    size = math.sqrt(_dot(G, G))
    per = 1.0 / size if size > 0.0 else 0.0
    n = per * G[0], per * G[1], per * G[2]
    along = _dot(n, v)
    v_t = v[0] - along * n[0], v[1] - along * n[1], v[2] - along * n[2]
    root = math.sqrt(_dot(v_t, v_t) + params[1] * params[1])
    return (v_t[0] / root, v_t[1] / root, v_t[2] / root), root, size, n


@law
def _add_force(f, i, N, G, size, w, params):
    """Add -N G and friction."""
    for x in range(3):
        f[i, x] -= N * (G[x] + params[0] * size * w[x])


@law
def _add_tangent(D, i, force, sliding, v, weights, params):
    """Subtract the derivative of what `_add_force` adds from the block of a node.

    ``force`` is N, its gradient (3,), G and dG/dq (3, 3); ``sliding`` what `_sliding` returns for the velocity ``v``; ``weights``
    how much of v changes with the unknown [1/s], and by how much dG/dq counts.
    """
    (N, of_N, G, turning), (w, root, size, n), (of_v, of_turning) = force, sliding, weights
    per, along, mu = (1.0 / size if size > 0.0 else 0.0), _dot(n, v), params[0]
    for y in range(3):
        J = of_turning * turning[0][y], of_turning * turning[1][y], of_turning * turning[2][y]
        of_size = _dot(n, J)
        turn = per * (J[0] - n[0] * of_size), per * (J[1] - n[1] * of_size), per * (J[2] - n[2] * of_size)  # of n
        of_along = of_v * n[y] + _dot(v, turn)
        d = (
            -along * turn[0] - of_along * n[0] + (of_v if y == 0 else 0.0),
            -along * turn[1] - of_along * n[1] + (of_v if y == 1 else 0.0),
            -along * turn[2] - of_along * n[2] + (of_v if y == 2 else 0.0),
        )  # of v_t
        slower = _dot(w, d)
        for x in range(3):
            rubbing = size * (of_N[y] * w[x] + N * (d[x] - w[x] * slower) / root) + N * of_size * w[x]
            D[i, x, y] += of_N[y] * G[x] + N * J[x] + mu * rubbing


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i += N n - mu N v_t/sqrt(v_t^2 + u^2); see the module. Returns the power that damper and friction take [W]."""
    power, (count, shapes, header) = 0.0, _counts(params)
    for i in range(count):
        k, c, full, _ = of_node(params, header, i)
        for o in range(shapes):
            first = HEADER + NUMBERS * o
            s = depth(q, i, params, first)
            if k > 0.0 and s > 0.0:
                here, velocity = between(q, q, i, params, first), _of_node(v, i)
                w, root, size, _ = _sliding(velocity, here.G, params)
                rate = _dot(here.at_end, velocity)
                N, _, _ = normal_force(s, rate, k, c, full)
                _add_force(f, i, N, here.G, size, w, params)
                power += (N - k * s) * rate + params[0] * N * size * root * _dot(w, w)
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Exact derivatives of `force`."""
    count, shapes, header = _counts(params)
    for i in range(count):
        k, c, full, _ = of_node(params, header, i)
        for o in range(shapes):
            first = HEADER + NUMBERS * o
            s = depth(q, i, params, first)
            if k > 0.0 and s > 0.0:
                here, velocity = between(q, q, i, params, first), _of_node(v, i)
                n, H = here.at_end, here.turning
                N, of_depth, of_rate = normal_force(s, _dot(n, velocity), k, c, full)
                both, turned = c_q * of_depth + c_v * of_rate, 2.0 * c_q * of_rate  # dG/db is half of the second derivatives
                of_N = (
                    both * n[0] + turned * _dot(H[0], velocity),
                    both * n[1] + turned * _dot(H[1], velocity),
                    both * n[2] + turned * _dot(H[2], velocity),
                )
                sliding = _sliding(velocity, here.G, params)
                _add_tangent(D, i, (N, of_N, here.G, H), sliding, velocity, (c_v, 2.0 * c_q), params)


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """Sum of k s^2/2 of the nodes in the shapes [J]."""
    total, (count, shapes, header) = 0.0, _counts(params)
    for i in range(count):
        for o in range(shapes):
            total += spring_energy(depth(q, i, params, HEADER + NUMBERS * o), params[header + EACH * i], 0.0)
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step, and its exact derivative; see the module."""
    dissipated, by_method, per_h, (count, shapes, header) = 0.0, 0.0, 1.0 / h, _counts(params)
    for i in range(count):
        k, c, full, mass = of_node(params, header, i)
        for o in range(shapes):
            first = HEADER + NUMBERS * o
            s_a, s_b = depth(base, i, params, first), depth(q, i, params, first)
            if k > 0.0 and (s_a > 0.0 or s_b > 0.0):
                step = between(base, q, i, params, first)
                v = per_h * (q[i, 0] - base[i, 0]), per_h * (q[i, 1] - base[i, 1]), per_h * (q[i, 2] - base[i, 2])
                sliding = _sliding(v, step.G, params)
                w, root, size, _ = sliding
                numerical = k * numerical_share(damper, 0.25 * h * h * k / mass)
                N, slope, viscous, unresolved = normal_force_between(s_a, s_b, h, k, c, full, numerical)
                _add_force(f, i, N, step.G, size, w, params)
                of_N = slope * step.at_end[0], slope * step.at_end[1], slope * step.at_end[2]
                _add_tangent(D, i, (N, of_N, step.G, step.turning), sliding, v, (per_h, 1.0), params)
                dissipated, by_method = dissipated + viscous, by_method + unresolved
                dissipated += h * params[0] * N * size * root * _dot(w, w)
    return dissipated, by_method


@njit(SETTLE_SIGNATURE, cache=True, error_model="numpy")
def settle(t, h, damper, base, q, v, index, params):
    """Speed of sinking in of the nodes that stay in a shape, without what rings, see `laws.unresolved_contact`."""
    taken, (count, shapes, header) = 0.0, _counts(params)
    for i in range(count):
        k, c, _, mass = of_node(params, header, i)
        for o in range(shapes):
            first = HEADER + NUMBERS * o
            s_a, s_b = depth(base, i, params, first), depth(q, i, params, first)
            if k > 0.0 and s_a > 0.0 and s_b > 0.0:
                n, own_mass = between(base, q, i, params, first).at_end, params[header + EACH * i + 4]
                viscous, rate = 0.5 * h * c / mass, _dot(n, _of_node(v, i))
                after = settled_rate(damper, 0.25 * h * h * k / mass + viscous * viscous, rate, (s_b - s_a) / h)
                change = mass / own_mass * (rate - after)  # by the impulse that all the mass needs, which a body shares
                for x in range(3):
                    v[i, x] -= change * n[x]
                taken += 0.5 * own_mass * change * (2.0 * rate - change)
    return taken
