"""What air or water does to rigid bodies, made by the effects `Air` and `Water`.

**A body** has drag areas along its axes; the drag acts at its origin, by the flow there, and turns are resisted, see
`laws.axes_drag`. Buoyancy, the force
of accelerated water and added mass act at its centre of buoyancy. A small body is under water by the share of a sphere of its
volume about that centre, see `laws.submergence`; drag and inertia go with this share. A body with a hull is lifted by the part of
the box that is under the surface, level at the height above its centre of buoyancy, see `laws.box`; the share is that part of its
volume.

**A rod** is, between its nodes, what a segment of a cable is, see `water`. Its end caps resist flow along it, by

    f = w (rho/2 Cd_end (pi d^2/4) |s| s + rho Ca_end (pi d^3/12) (a.t)) t ,    s = u.t ,

with the share w of a sphere of its diameter at the node. The pressure that accelerates the water itself acts on the volume of the
segments, with its part along the rod. A rod is thin: its lift acts on its axis, and its waterplane has no stiffness against turns.

In still water the lift over a whole step does the work that its energy says. The rate of the added mass is left out, as on cables,
and with it the moment that turns a body across a stream in an ideal fluid (Munk).

Four small slopes are left out of the tangent: by the turning of a rod's end caps, of the axes along which accelerated water pushes
with Ca, and of those about which turns are resisted; and by the height that changes the share with which drag acts elsewhere.
Newton's method looks at the forces after each step, so that what is left out costs iterations where it counts, and no accuracy.
Source: Hall, MoorDyn V2: new capabilities in mooring system components and load cases, ASME IOWTC (2020); Gonzalez, J. Nonlinear
Sci. 6 (1996) 449, for the step.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from anet_lumped.compiled.jit import inlined_law, law, njit
from anet_lumped.effects.flow.waves.base import Wave
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.wind.kernel import pack
from anet_lumped.effects.laws.axes_drag import (
    along_axes,
    axes_drag,
    axis_of,
    dot,
    subtract_axis_slopes,
    subtract_turning_slopes,
    turning_drag,
)
from anet_lumped.effects.laws.drag import segment_coefficients, subtract_segment_slopes, tangent_of
from anet_lumped.effects.laws.hull import NONE, add_lift_over_step, add_lift_slopes, hull_immersed, hull_share, weight_on_node
from anet_lumped.effects.laws.morison import add_mass, segment_force, subtract_inertia_slopes
from anet_lumped.effects.laws.over_a_step import middle_of, minus, velocity_of
from anet_lumped.effects.laws.submergence import (
    ALWAYS_UNDER,
    point_share,
    point_share_between,
    submerged_share,
    wetted,
    wetted_between,
)

from .effect import Effect
from .flow.surface import flow_at, height_at
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, INERTIA_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER, BODY_INDEX, ROD_INDEX, CAP_INDEX = 5, 6, 3, 2  # numbers before all others, and nodes of each body, segment and cap
BODY_NUMBERS, SEGMENT_NUMBERS, CAP_NUMBERS = 19, 8, 4
LIFTS = np.bool_(True)  # buoyancy acts; for a True that is written out Numba compiles anew what it is passed to
PAIRS = 6  # of the first four nodes of a body: (0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)


@dataclass(frozen=True)
class FluidOnBodies(Effect):
    """Air or water on the bodies of a scene that move; `Air` and `Water` make it of their own parameters."""

    density: float
    level: float
    flow: Any
    waves: tuple[Wave, ...] = ()
    g: float = 0.0
    dry: bool = False
    floats: bool = True  # whether small bodies go through the surface; else they are under water at any height

    coupled_neighbours: ClassVar[int] = 1
    from_outside: ClassVar[bool] = True

    @property
    def no_force_at_rest(self) -> bool:
        """In air without wind."""
        return self.dry and self.flow is None

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Numbers of bodies, of segments of rods and of end caps; of each body the nodes of its origin, of the points on its axes
            and of its centre of buoyancy, and the first row of its pairs among the blocks of neighbours; of each segment both nodes
            and the row of the pair; of each cap its node and the next one.
        params : float64
            Level [m]; how many numbers describe current and wave; 1 for air; buoyancy per volume [N/m3]; the numbers of
            current and wave. Of each body: drag coefficients along its axes [kg/m]; diameter of its sphere [m], buoyancy [N] and
            displaced mass [kg]; Ca along its axes; distance of the points on its axes [m]; edges of its hull, or zeros, and the
            centre of buoyancy [m]; drag coefficients of turns about its axes [kg m2]. Of each segment what `Water` has of one. Of
            each cap: length of the segment and diameter [m], drag coefficient [kg/m] and mass of accelerated fluid [kg].
        """
        bodies = [body for body in model.scene.bodies if not body.is_driven]
        first_row, rows, of_bodies, of_segments, of_caps = model.n_segments, [], [], [], []
        for body in bodies:
            nodes, row = [model.node_of[point.name] for point in body.points], first_row
            first_row += len(body.pairs)
            if body.has_drag or (body.displaced > 0.0 and not self.dry):
                at = model.node_of[f"{body.name}[b]"] if any(body.centre_of_buoyancy) else nodes[0]
                rows.append([*nodes[:4], at, row])
                of_bodies.append(self._of_body(body))
            row = first_row - sum(rod.segments for rod in body.rods)
            for rod in body.rods:
                along = [model.node_of[f"{body.name}[{rod.name}.{k}]"] for k in range(rod.segments + 1)]
                numbers = self._of_segment(rod)
                of_segments += [([i, j, row + k], numbers) for k, (i, j) in enumerate(pairwise(along))]
                of_caps += [(along[:2], self._of_cap(rod)), (along[:-3:-1], self._of_cap(rod))]
                row += rod.segments
        winds = pack(self.flow)
        wave = pack_waves(self.waves, self.g, self.level)
        header = [self.level, len(winds), len(wave), float(self.dry), 0.0 if self.dry else self.density * self.g]
        index = [[len(of_bodies), len(of_segments), len(of_caps)], *rows, *(own for own, _ in of_segments + of_caps)]
        params: list[Any] = [header, winds, wave, *of_bodies, *(own for _, own in of_segments + of_caps)]
        return np.concatenate(index).astype(np.int64), np.concatenate(params)

    def _of_body(self, body: Any) -> list[float]:
        drag = [0.5 * self.density * area for area in body.CdA]
        volume, mass = body.displaced, 0.0 if self.dry else self.density * body.displaced
        sphere = (
            (6.0 * volume / math.pi) ** (1.0 / 3.0) or math.sqrt(4.0 * max(body.CdA) / math.pi) or max(body.CdA_rotation) ** 0.2
        )
        sphere = sphere if self.floats or body.hull is not None else ALWAYS_UNDER
        hull, turning = body.hull or (0.0, 0.0, 0.0), [0.5 * self.density * C for C in body.CdA_rotation]
        return [*drag, sphere, self.g * mass, mass, *body.Ca, body.gyration, *hull, *body.centre_of_buoyancy, *turning]

    def _of_segment(self, rod: Any) -> list[float]:
        normal, along = segment_coefficients(self.density, rod)
        mass = 0.0 if self.dry else self.density * 0.25 * math.pi * rod.diameter**2 * rod.L0
        return [rod.L0, rod.diameter, 2.0 * normal, 2.0 * along, self.g * mass, mass, rod.Can, rod.Cat]

    def _of_cap(self, rod: Any) -> list[float]:
        drag = 0.5 * self.density * rod.Cd_end * 0.25 * math.pi * rod.diameter**2
        mass = 0.0 if self.dry else self.density * rod.Ca_end * math.pi * rod.diameter**3 / 12.0
        return [rod.L0, rod.diameter, drag, mass]

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        functions = {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step}
        return functions if self.dry else functions | {"inertia": inertia}


@inlined_law
def _fluid(params):
    """Level, numbers of current and waves, whether it is air, buoyancy per volume; where the numbers of bodies begin."""
    begin = HEADER + int(params[1])
    end = begin + int(params[2])
    return params[0], (params[HEADER:begin], params[begin:end]), params[3] > 0.0, params[4], end


@inlined_law
def _add(f, i, w, force):
    f[i, 0] += w * force[0]
    f[i, 1] += w * force[1]
    f[i, 2] += w * force[2]


@inlined_law
def _sphere(z, d, dry):
    """Share of a sphere in the fluid, and its slope [1/m]."""
    w, slope, _ = point_share(z, d)
    return (1.0 - w, -slope) if dry else (w, slope)


@inlined_law
def _along(z1, z2, d, dry):
    """Weights w1, w2 of `submergence` in the fluid, and their slopes k11, k12, k22 [1/m]."""
    _, w1, w2, k11, k12, k22 = wetted(z1, z2, d)
    return (0.5 - w1, 0.5 - w2, -k11, -k12, -k22) if dry else (w1, w2, k11, k12, k22)


@law
def _on_bodies(t, base, q, v, per_h, lifts, index, params, f):
    """Add the forces on bodies to f, in the middle of base and q; returns the power -f.v that is taken [W].

    ``lifts`` says whether buoyancy acts; its power counts in a wave.
    """
    level, motion, dry, per_volume, begin = _fluid(params)
    power, counts = 0.0, len(motion[1]) > 0
    for k in range(index[0]):
        at, numbers = 3 + BODY_INDEX * k, params[begin + BODY_NUMBERS * k : begin + BODY_NUMBERS * (k + 1)]
        o, b = index[at], index[at + 4]
        origin = middle_of(base, q, o)
        (e1, _), (e2, _), (e3, _) = (
            axis_of(origin, middle_of(base, q, index[at + 1])), axis_of(origin, middle_of(base, q, index[at + 2])),
            axis_of(origin, middle_of(base, q, index[at + 3])),
        )  # fmt: skip
        axes, centre = (e1, e2, e3), middle_of(base, q, b)
        flow, V = flow_at(t, centre, level, motion), velocity_of(base, q, v, per_h, b)
        share, _ = _sphere(flow[0], numbers[3], dry)
        if numbers[10] > 0.0:
            down = centre[2] - flow[0]
            wet = hull_immersed(base, q, down, index, at, numbers)
            share = hull_share(wet, numbers)
            share = 1.0 - share if dry else share
            if lifts:
                for i in range(4):
                    lift, node = -per_volume * weight_on_node(wet.g, numbers, i), index[at + i]
                    f[node, 2] += lift
                    power -= lift * velocity_of(base, q, v, per_h, node)[2] if counts else 0.0
        elif lifts:
            f[b, 2] += share * numbers[4]
            power -= share * numbers[4] * V[2] if counts else 0.0
        a = flow[4]
        more = along_axes(a, axes, numbers[6:9])
        inertia_force = (numbers[5] * (a[0] + more[0]), numbers[5] * (a[1] + more[1]), numbers[5] * (a[2] + more[2]))
        _add(f, b, share, inertia_force)
        power -= share * dot(inertia_force, V)
        V = velocity_of(base, q, v, per_h, o)
        for a in range(3):
            if numbers[16 + a] > 0.0:
                p = index[at + 1 + (a + 1) % 3]
                of_p = minus(velocity_of(base, q, v, per_h, p), V)
                turn = turning_drag(of_p, axes[(a + 2) % 3], share * numbers[16 + a], numbers[9])
                _add(f, p, 1.0, turn)
                _add(f, o, -1.0, turn)
                power -= dot(turn, of_p)
        drag = axes_drag(minus(flow_at(t, origin, level, motion)[2], V), axes, numbers[0:3])
        _add(f, o, share, drag)
        power -= share * dot(drag, V)
    at, begin = 3 + BODY_INDEX * index[0], begin + BODY_NUMBERS * index[0]
    for s in range(index[1]):
        i, j, numbers = index[at + ROD_INDEX * s], index[at + ROD_INDEX * s + 1], params[begin + SEGMENT_NUMBERS * s :]
        q1, q2 = middle_of(base, q, i), middle_of(base, q, j)
        flow_i, flow_j, d = flow_at(t, q1, level, motion), flow_at(t, q2, level, motion), minus(q2, q1)
        w1, w2, _, _, _ = _along(flow_i[0], flow_j[0], numbers[1], dry)
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        for side in range(2):
            node, w, flow = (i, w1, flow_i) if side == 0 else (j, w2, flow_j)
            V = velocity_of(base, q, v, per_h, node)
            F = segment_force(minus(flow[2], V), flow[4], (tx, ty, tz), numbers[2], numbers[3], numbers[5], numbers[6], numbers[7])
            _add(f, node, w, F)
            power -= w * dot(F, V)
            if lifts:
                f[node, 2] += w * numbers[4]
                power -= w * numbers[4] * V[2] if counts else 0.0
    at, begin = at + ROD_INDEX * index[1], begin + SEGMENT_NUMBERS * index[1]
    for s in range(index[2]):
        i, j, numbers = index[at + CAP_INDEX * s], index[at + CAP_INDEX * s + 1], params[begin + CAP_NUMBERS * s :]
        q1, q2, V = middle_of(base, q, i), middle_of(base, q, j), velocity_of(base, q, v, per_h, i)
        flow, d = flow_at(t, q1, level, motion), minus(q1, q2)
        w, _ = _sphere(flow[0], numbers[1], dry)
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        F = segment_force(minus(flow[2], V), flow[4], (tx, ty, tz), 0.0, numbers[2], numbers[3], -1.0, 0.0)
        _add(f, i, w, F)
        power -= w * dot(F, V)
    return power


@inlined_law
def _subtract_share_slope(block, force, slope, up):
    """Subtract force slope up^T: the share of the force changes with the height."""
    for x in range(3):
        for y in range(3):
            block[x, y] -= slope * force[x] * up[y]


@law
def _slopes(t, base, q, v, per_h, lifts, index, params, c_q, c_v, D, near):
    """Subtract c_q df/dq + c_v df/dv of `_on_bodies`, but for what the module says is left out."""
    level, motion, dry, per_volume, begin = _fluid(params)
    for k in range(index[0]):
        at, numbers = 3 + BODY_INDEX * k, params[begin + BODY_NUMBERS * k : begin + BODY_NUMBERS * (k + 1)]
        o, b, row = index[at], index[at + 4], index[at + 5]
        origin, centre = middle_of(base, q, o), middle_of(base, q, b)
        flow, M = flow_at(t, centre, level, motion), numbers[5]
        share, slope = _sphere(flow[0], numbers[3], dry)
        if numbers[10] > 0.0:
            down = centre[2] - flow[0]
            wet = hull_immersed(base, q, down, index, at, numbers)
            share, slope = hull_share(wet, numbers), 0.0
            share = 1.0 - share if dry else share
            if lifts:
                add_lift_slopes(index, at, numbers, c_q * per_volume, wet.H, NONE, NONE, D, near)
        elif lifts:
            _subtract_share_slope(D[b], (0.0, 0.0, numbers[4]), c_q * slope, flow[1])
        flow_o = flow_at(t, origin, level, motion)
        V = velocity_of(base, q, v, per_h, o)
        u = minus(flow_o[2], V)
        for a in range(3):
            e, per = axis_of(origin, middle_of(base, q, index[at + 1 + a]))
            if numbers[a] > 0.0:
                subtract_axis_slopes(u, flow_o[3], e, per, share * numbers[a], c_q, c_v, D[o], near[row + a, 0])
            if numbers[16 + a] > 0.0:
                b1, (e3, _) = (a + 1) % 3, axis_of(origin, middle_of(base, q, index[at + 1 + (a + 2) % 3]))
                p = index[at + 1 + b1]
                of_p = minus(velocity_of(base, q, v, per_h, p), V)
                subtract_turning_slopes(of_p, e3, share * numbers[16 + a], numbers[9], c_v, D[o], D[p], near[row + b1])
            if len(motion[1]) > 0:
                m, s = c_q * share * M, c_q * slope * M * (1.0 + numbers[6 + a]) * dot(flow[4], e)
                for x in range(3):
                    for y in range(3):
                        of_e = e[0] * flow[5][y] + e[1] * flow[5][3 + y] + e[2] * flow[5][6 + y]
                        D[b, x, y] -= m * (1.0 + numbers[6 + a]) * e[x] * of_e + s * e[x] * flow[1][y]
    at, begin = 3 + BODY_INDEX * index[0], begin + BODY_NUMBERS * index[0]
    for s in range(index[1]):
        i, j, row = index[at + ROD_INDEX * s], index[at + ROD_INDEX * s + 1], index[at + ROD_INDEX * s + 2]
        numbers, q1, q2 = params[begin + SEGMENT_NUMBERS * s :], middle_of(base, q, i), middle_of(base, q, j)
        flow_i, flow_j, d = flow_at(t, q1, level, motion), flow_at(t, q2, level, motion), minus(q2, q1)
        w1, w2, k11, k12, k22 = _along(flow_i[0], flow_j[0], numbers[1], dry)
        tx, ty, tz, per_l = tangent_of(d[0], d[1], d[2], numbers[0])
        for side in range(2):
            node, w, k, flow, up = (i, w1, k11, flow_i, flow_j[1]) if side == 0 else (j, w2, k22, flow_j, flow_i[1])
            u, own, other, sign = minus(flow[2], velocity_of(base, q, v, per_h, node)), D[node], near[row, side], 2.0 * side - 1.0
            subtract_segment_slopes(
                u, flow[3], (tx, ty, tz), per_l, w * numbers[2], w * numbers[3], sign, c_q, c_v, own, other
            )  # fmt: skip
            if len(motion[1]) > 0:
                subtract_inertia_slopes(
                    flow[4], flow[5], (tx, ty, tz), per_l, w * numbers[5], numbers[6], numbers[7], sign, c_q, own, other
                )  # fmt: skip
            if k != 0.0 or k12 != 0.0:
                F = segment_force(u, flow[4], (tx, ty, tz), numbers[2], numbers[3], numbers[5], numbers[6], numbers[7])
                F = (F[0], F[1], F[2] + (numbers[4] if lifts else 0.0))
                _subtract_share_slope(own, F, c_q * k, flow[1])
                _subtract_share_slope(other, F, c_q * k12, up)
    at, begin = at + ROD_INDEX * index[1], begin + SEGMENT_NUMBERS * index[1]
    for s in range(index[2]):
        i, j, numbers = index[at + CAP_INDEX * s], index[at + CAP_INDEX * s + 1], params[begin + CAP_NUMBERS * s :]
        q1, q2 = middle_of(base, q, i), middle_of(base, q, j)
        flow, d = flow_at(t, q1, level, motion), minus(q1, q2)
        (w, slope), u = _sphere(flow[0], numbers[1], dry), minus(flow[2], velocity_of(base, q, v, per_h, i))
        tx, ty, tz, per_l = tangent_of(d[0], d[1], d[2], numbers[0])
        subtract_segment_slopes(u, flow[3], (tx, ty, tz), 0.0, 0.0, w * numbers[2], 1.0, c_q, c_v, D[i], D[i])
        F = segment_force(u, flow[4], (tx, ty, tz), 0.0, numbers[2], numbers[3], -1.0, 0.0)
        _subtract_share_slope(D[i], F, c_q * slope, flow[1])


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add the forces of the module; returns the power that those without an energy take [W]."""
    return _on_bodies(t, q, q, v, 0.0, LIFTS, index, params, f)


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes of `force`, but for what the module says is left out."""
    _slopes(t, q, q, v, 0.0, LIFTS, index, params, c_q, c_v, D, near)


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """-sum rho g V H of spheres, -sum rho g V e of segments and sum rho g I of hulls [J]; none in a wave, nor in air."""
    level, motion, dry, per_volume, begin = _fluid(params)
    total = 0.0
    if len(motion[1]) > 0 or dry:
        return 0.0
    for k in range(index[0]):
        at, numbers = 3 + BODY_INDEX * k, params[begin + BODY_NUMBERS * k : begin + BODY_NUMBERS * (k + 1)]
        if numbers[10] > 0.0:
            total += per_volume * hull_immersed(q, q, level, index, at, numbers).I
        else:
            total -= numbers[4] * point_share(q[index[at + 4], 2] - level, numbers[3])[2]
    at, begin = 3 + BODY_INDEX * index[0], begin + BODY_NUMBERS * index[0]
    for s in range(index[1]):
        i, j, numbers = index[at + ROD_INDEX * s], index[at + ROD_INDEX * s + 1], params[begin + SEGMENT_NUMBERS * s :]
        total -= numbers[4] * wetted(q[i, 2] - level, q[j, 2] - level, numbers[1])[0]
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step: `force` in its middle, but for buoyancy in still water, whose work is the change of its energy."""
    level, motion, dry, per_volume, begin = _fluid(params)
    waves, per_h = len(motion[1]) > 0, 1.0 / h
    dissipated = h * _on_bodies(t, base, q, q, per_h, waves, index, params, f)
    _slopes(t, base, q, q, per_h, waves, index, params, 0.5, per_h, D, near)
    if waves or dry:
        return dissipated, 0.0
    for k in range(index[0]):
        at, numbers = 3 + BODY_INDEX * k, params[begin + BODY_NUMBERS * k : begin + BODY_NUMBERS * (k + 1)]
        if numbers[10] > 0.0:
            add_lift_over_step(base, q, level, per_volume, index, at, numbers, f, D, near)
        else:
            b = index[at + 4]
            g, slope = point_share_between(base[b, 2] - level, q[b, 2] - level, numbers[3])
            f[b, 2] += numbers[4] * g
            D[b, 2, 2] -= numbers[4] * slope
    at, begin = 3 + BODY_INDEX * index[0], begin + BODY_NUMBERS * index[0]
    for s in range(index[1]):
        i, j, row = index[at + ROD_INDEX * s], index[at + ROD_INDEX * s + 1], index[at + ROD_INDEX * s + 2]
        numbers = params[begin + SEGMENT_NUMBERS * s :]
        g1, g2, s11, s12, s21, s22 = wetted_between(
            base[i, 2] - level, base[j, 2] - level, q[i, 2] - level, q[j, 2] - level, numbers[1]
        )  # fmt: skip
        f[i, 2] += numbers[4] * g1
        f[j, 2] += numbers[4] * g2
        D[i, 2, 2] -= numbers[4] * s11
        D[j, 2, 2] -= numbers[4] * s22
        near[row, 0, 2, 2] -= numbers[4] * s12
        near[row, 1, 2, 2] -= numbers[4] * s21
    return dissipated, 0.0


@njit(INERTIA_SIGNATURE, cache=True, error_model="numpy")
def inertia(t, q, index, params, A):
    """Add the added masses, see the module."""
    level, motion, _, _, begin = _fluid(params)
    for k in range(index[0]):
        at, numbers = 3 + BODY_INDEX * k, params[begin + BODY_NUMBERS * k : begin + BODY_NUMBERS * (k + 1)]
        o, b, height = index[at], index[at + 4], height_at(t, q, index[at + 4], level, motion)
        share = point_share(height, numbers[3])[0]
        if numbers[10] > 0.0:
            share = hull_share(hull_immersed(q, q, q[b, 2] - height, index, at, numbers), numbers)
        for a in range(3):
            e, _ = axis_of(middle_of(q, q, o), middle_of(q, q, index[at + 1 + a]))
            add_mass(share * numbers[5] * numbers[6 + a], 0.0, 1.0, e, A[b])
    at, begin = 3 + BODY_INDEX * index[0], begin + BODY_NUMBERS * index[0]
    for s in range(index[1]):
        i, j, numbers = index[at + ROD_INDEX * s], index[at + ROD_INDEX * s + 1], params[begin + SEGMENT_NUMBERS * s :]
        d = minus(middle_of(q, q, j), middle_of(q, q, i))
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        _, w1, w2, _, _, _ = wetted(height_at(t, q, i, level, motion), height_at(t, q, j, level, motion), numbers[1])
        add_mass(w1 * numbers[5], numbers[6], numbers[7], (tx, ty, tz), A[i])
        add_mass(w2 * numbers[5], numbers[6], numbers[7], (tx, ty, tz), A[j])
    at, begin = at + ROD_INDEX * index[1], begin + SEGMENT_NUMBERS * index[1]
    for s in range(index[2]):
        i, j, numbers = index[at + CAP_INDEX * s], index[at + CAP_INDEX * s + 1], params[begin + CAP_NUMBERS * s :]
        d = minus(middle_of(q, q, i), middle_of(q, q, j))
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        w, _, _ = submerged_share(height_at(t, q, i, level, motion), numbers[1])
        add_mass(w * numbers[3], 0.0, 1.0, (tx, ty, tz), A[i])
