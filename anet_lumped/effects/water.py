"""Water with a free surface: buoyancy, drag, and the inertia of the water that cables and payloads push aside.

The force on each end of a segment, and its added mass, are

    f = w (rho g V e_z + drag(u) + rho V ((1 + Can) a_n + (1 + Cat) a_t)) ,    A = w rho V (Can (I - t t^T) + Cat t t^T) ,

with the velocity u of the water minus that of the node and the acceleration a of the water (Morison, see `laws.morison` and
`laws.drag`). w is the share of the segment's volume that is under water and belongs to this end: 1/2 for a segment under water,
with a smooth change at the surface, see `laws.submergence`. V is the unstretched volume. A point with a volume counts as a sphere;
where points do not float, w is 1 for them at any height.
The tension is the effective one of mooring codes, which includes the pressure on a cross-section of the cable.

The velocity of the water is the sum of that of a current, whose acceleration is left out, and that of waves, whose surface limits
the water. In still water buoyancy has an energy, -rho g V times the depth; its work over a whole step is the change of this energy,
so that no step can raise the energy. Where added mass turns with a cable or goes through the surface, the energy 1/2 v.(dA/dt) v is
taken or given, because Morison's equation has no force for dA/dq; it counts as dissipated, with either sign. In a wave the work of
all these forces counts as given by the water. There is no slamming force, no shelter behind other cables, and the current does not
change the length of the wave.

Source
------
DNV-RP-C205 (2010), 6.2; Hall & Goupee, Ocean Eng. 104 (2015) 590, 2; Faltinsen, Sea Loads on Ships and Offshore Structures (1990),
ch. 8 (effective tension).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_flag, check_number, quoted, shown
from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.effects.flow.surface import flow_at, height_at
from anet_lumped.effects.flow.waves.base import Wave, check_waves
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.wind import Wind
from anet_lumped.effects.flow.wind.base import check_winds, same_at_each_height, steady
from anet_lumped.effects.flow.wind.kernel import pack
from anet_lumped.effects.laws.drag import (
    point_coefficient,
    segment_coefficients,
    subtract_point_slopes,
    subtract_segment_slopes,
    tangent_of,
)
from anet_lumped.effects.laws.morison import add_mass, point_force, segment_force, subtract_inertia_slopes
from anet_lumped.effects.laws.submergence import (
    ALWAYS_UNDER,
    point_share,
    point_share_between,
    sphere_diameter,
    wetted,
    wetted_between,
)

from .effect import Effect, height_under
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, INERTIA_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER, SEGMENT_NUMBERS, POINT_NUMBERS = 3, 8, 5  # numbers in ``params`` before all others, of each segment and of each point


@dataclass(frozen=True)
class Water(Effect):
    """Hydrostatics and Morison's equation on every cable, which needs a `diameter`, and on free points with a volume or a CdA.

    On rigid bodies it acts by their volume or hull, their `CdA` and on their rods, see `fluid_on_bodies`.

    Statics take the water at t = 0, when a wave with a `ramp` has not risen yet. The step of an explicit method must be short
    against the time in which drag stops a thin cable, (mu + rho Can pi d^2/4)/(rho d Cdn |u|): 1.5 ms for twine of 2 mm at 2 m/s.

    Parameters
    ----------
    density : float [kg/m3]; 1025: sea water
    level : float [m], z of the still surface
    current : None, a wind of `anet_lumped.wind`, or several, whose velocities add up
    wave : None, or a wave of `anet_lumped.waves`, for one alone
    g : float [m/s2], gravity of buoyancy and wave; None: that of the scene, which must then point along -z
    points_float : bool
        Whether a point comes out of the water at its surface; False: points are under water at any height, as MoorDyn has them.
    waves : None, a wave of `anet_lumped.waves`, or several, which add up
    """

    density: float = 1025.0
    level: float = 0.0
    current: Wind | Sequence[Wind] | None = None
    wave: Wave | None = None
    g: float | None = None
    points_float: bool = True
    waves: Wave | Sequence[Wave] | None = None

    coupled_neighbours: ClassVar[int] = 1
    stiff: ClassVar[bool] = True

    def check_parameters(self) -> None:
        owner = self._called
        self._set(
            density=check_number("density", self.density, "kg/m3", owner, sign="positive"),
            level=check_number("level", self.level, "m", owner),
            current=check_winds("current", self.current, owner),
            g=None if self.g is None else check_number("g", self.g, "m/s2", owner, sign="non-negative"),
            points_float=check_flag("points_float", self.points_float, owner),
        )
        if not (self.wave is None or isinstance(self.wave, Wave)):
            raise SceneError(
                f"Argument `wave` must be a wave of anet_lumped.waves or None, but {owner} has wave={shown(self.wave)}."
            )
        self._set(waves=check_waves("waves", self.waves, owner))
        if self.wave is not None and self.waves is not None:
            raise SceneError(f"One of the arguments `wave` and `waves` must be None, but {owner} has both.")

    @property
    def all_waves(self) -> tuple[Wave, ...]:
        """Its wave, or its waves."""
        given = self.wave if self.waves is None else self.waves
        return () if given is None else (given,) if isinstance(given, Wave) else tuple(given)

    @property
    def time_scales(self) -> tuple[float, ...]:
        """2/omega of the shortest wave, as for a point that is shaken."""
        highest = max((wave.highest_frequency for wave in self.all_waves), default=0.0)
        return (2.0 / highest,) if highest > 0.0 else ()

    def steady(self) -> Effect:
        left = steady(self.current)
        still = left is self.current and not self.all_waves
        return self if still else replace(self, current=left, wave=None, waves=None)

    def seen_from(self, origin: Vector, scene: Any) -> Effect | None:
        if origin[2] != 0.0 or not same_at_each_height(self.current):
            return None
        waves = tuple(wave.seen_from(origin, self.gravity(scene)) for wave in self.all_waves)
        return self if not waves else replace(self, wave=None, waves=waves)

    def gravity(self, scene: Any) -> float:
        """Acceleration of gravity of buoyancy and wave [m/s2]."""
        if self.g is not None:
            return self.g
        x, y, z = scene.gravity.tolist()
        if x or y or z > 0.0:
            raise SceneError(f"The effect Water needs Gravity along -z, or a `g` of its own, but gravity is {(x, y, z)} m/s2.")
        return -z

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(level=height_under(scene))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Number of segments; both nodes of each; nodes of the points with a volume or a CdA.
        params : float64
            Level [m]; how many numbers describe current and wave, and those numbers; of each segment L0 and d [m], the coefficients
            of drag normal and along [kg/m], buoyancy under water [N], displaced mass [kg], Can, Cat; of each point the diameter of
            its sphere [m], its coefficient of drag [kg/m], buoyancy [N], displaced mass [kg], Ca.

        Raises
        ------
        SceneError : a cable without a diameter, gravity that is not along -z, a wave that would break
        """
        scene = model.scene
        for cable in scene.cables:
            if cable.diameter is None:
                raise SceneError(
                    f"The effect Water needs the `diameter` [m] of every cable, but cable {quoted(cable.name)} has none."
                )
        g = self.gravity(scene)
        current, wave = pack(self.current), pack_waves(self.all_waves, g, self.level)
        points = [point for point in scene.free_points if point.volume > 0.0 or point.CdA > 0.0]
        of_cable = np.array([self._of_cable(cable, g) for cable in scene.cables])
        of_point = np.array([self._of_point(point, g) for point in points])
        nodes = [model.node(point.name) for point in points]
        header = [self.level, len(current), len(wave)]
        return (
            np.concatenate([[model.n_segments], model.ends.ravel(), nodes]).astype(np.int64),
            np.concatenate([header, current, wave, of_cable[model.cable_of].ravel(), of_point.ravel()]),
        )

    def _of_cable(self, cable: Any, g: float) -> tuple[float, ...]:
        normal, along = segment_coefficients(self.density, cable)  # of half a segment
        mass = self.density * 0.25 * math.pi * cable.diameter**2 * cable.L0
        return cable.L0, cable.diameter, 2.0 * normal, 2.0 * along, g * mass, mass, cable.Can, cable.Cat

    def _of_point(self, point: Any, g: float) -> tuple[float, ...]:
        mass = self.density * point.volume
        diameter = sphere_diameter(point) if self.points_float else ALWAYS_UNDER
        return diameter, point_coefficient(self.density, point), g * mass, mass, point.Ca

    def on_bodies(self, scene: Any) -> Effect | None:
        if not any(body.displaced > 0.0 or body.has_drag or body.rods for body in scene.bodies if not body.is_driven):
            return None
        from .fluid_on_bodies import FluidOnBodies  # compiled for those scenes alone

        return FluidOnBodies(self.density, self.level, self.current, self.all_waves, self.gravity(scene), floats=self.points_float)

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "inertia": inertia}


@inlined_law
def _read_params(params):
    """Level, current, wave, and the position in ``params`` at which the numbers of the segments begin."""
    begin = HEADER + int(params[1])
    return params[0], params[HEADER:begin], params[begin : begin + int(params[2])], begin + int(params[2])


@inlined_law
def _row(q, i):
    return q[i, 0], q[i, 1], q[i, 2]


@inlined_law
def _difference(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined_law
def _add(f, i, w, force, lift):
    """Add w times a force, and a lift along z, to the force on a node."""
    f[i, 0] += w * force[0]
    f[i, 1] += w * force[1]
    f[i, 2] += w * force[2] + lift


@inlined_law
def _subtract_share_slope(block, force, lift, slope, up):
    """Subtract (force + lift e_z) slope up^T from a block, the part of a tangent that is due to the change of the submerged share.

    ``slope`` is that of the share in the height [1/m], ``up`` that of the height in the position.
    """
    for y in range(3):
        block[0, y] -= slope * force[0] * up[y]
        block[1, y] -= slope * force[1] * up[y]
        block[2, y] -= slope * (force[2] + lift) * up[y]


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add the force on both nodes of every segment and on points, see the module.

    Returns the power that the forces take which have no energy, -f.v [W].
    """
    level, current, wave, begin = _read_params(params)
    segments, still_water, power = index[0], 1.0 if len(wave) == 0 else 0.0, 0.0
    last, flow_i = -1, flow_at(t, (0.0, 0.0, 0.0), level, current, wave)
    flow_j = flow_i
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        flow_i = flow_j if i == last else flow_at(t, _row(q, i), level, current, wave)
        flow_j, last = flow_at(t, _row(q, j), level, current, wave), j
        _, w1, w2, _, _, _ = wetted(flow_i[0], flow_j[0], numbers[1])
        if w1 + w2 == 0.0:
            continue
        d = _difference(_row(q, j), _row(q, i))
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        for side in range(2):
            node, w, flow = (i, w1, flow_i) if side == 0 else (j, w2, flow_j)
            V = _row(v, node)
            F = segment_force(
                _difference(flow[2], V), flow[4], (tx, ty, tz), numbers[2], numbers[3], numbers[5], numbers[6], numbers[7]
            )
            _add(f, node, w, F, w * numbers[4])
            power -= w * (F[0] * V[0] + F[1] * V[1] + (F[2] + (1.0 - still_water) * numbers[4]) * V[2])
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        flow, V = flow_at(t, _row(q, node), level, current, wave), _row(v, node)
        w, _, _ = point_share(flow[0], numbers[0])
        F = point_force(_difference(flow[2], V), flow[4], numbers[1], numbers[3], numbers[4])
        _add(f, node, w, F, w * numbers[2])
        power -= w * (F[0] * V[0] + F[1] * V[1] + (F[2] + (1.0 - still_water) * numbers[2]) * V[2])
    return power


@inlined_law
def _segment_slopes(s, i, j, flow_i, flow_j, v1, v2, t, per_l, wet, lift, numbers, waves, c_q, c_v, D, near):
    """Subtract the slopes of the force on both nodes of a segment; ``lift`` [N] is the part of its buoyancy that w multiplies."""
    if i < D.shape[0]:
        shares = wet[1], wet[3], wet[4]
        _end_slopes(-1.0, flow_i, flow_j[1], v1, t, per_l, shares, lift, numbers, waves, c_q, c_v, D[i], near[s, 0])
    if j < D.shape[0]:
        shares = wet[2], wet[5], wet[4]
        _end_slopes(1.0, flow_j, flow_i[1], v2, t, per_l, shares, lift, numbers, waves, c_q, c_v, D[j], near[s, 1])


@inlined_law
def _end_slopes(side, flow, other_up, V, t, per_l, shares, lift, numbers, waves, c_q, c_v, own, other):
    """Subtract the slopes of the force on the node at one end of a segment; ``shares`` are its w and the slopes of that [1/m]."""
    u, (w, k, k_other) = _difference(flow[2], V), shares
    subtract_segment_slopes(u, flow[3], t, per_l, w * numbers[2], w * numbers[3], side, c_q, c_v, own, other)
    if waves:
        subtract_inertia_slopes(flow[4], flow[5], t, per_l, w * numbers[5], numbers[6], numbers[7], side, c_q, own, other)
    if k != 0.0 or k_other != 0.0:
        F = segment_force(u, flow[4], t, numbers[2], numbers[3], numbers[5], numbers[6], numbers[7])
        _subtract_share_slope(own, F, lift, c_q * k, flow[1])
        _subtract_share_slope(other, F, lift, c_q * k_other, other_up)


@inlined_law
def _point_slopes(node, flow, V, wet, lift, numbers, c_q, c_v, D):
    """Subtract the slopes of the force on a point; ``lift`` as for a segment."""
    w, slope, _ = wet
    u = _difference(flow[2], V)
    F = point_force(u, flow[4], numbers[1], numbers[3], numbers[4])
    subtract_point_slopes(u, flow[3], w * numbers[1], c_q, c_v, D[node])
    m = c_q * w * numbers[3] * (1.0 + numbers[4])
    for x in range(3):
        for y in range(3):
            D[node, x, y] -= m * flow[5][3 * x + y]
    _subtract_share_slope(D[node], F, lift, c_q * slope, flow[1])


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the exact slopes of `force`, including those of the water's velocity and acceleration with the position."""
    level, current, wave, begin = _read_params(params)
    segments, waves, last = index[0], len(wave) > 0, -1
    flow_i = flow_at(t, (0.0, 0.0, 0.0), level, current, wave)
    flow_j = flow_i
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        flow_i = flow_j if i == last else flow_at(t, _row(q, i), level, current, wave)
        flow_j, last = flow_at(t, _row(q, j), level, current, wave), j
        wet = wetted(flow_i[0], flow_j[0], numbers[1])
        if wet[1] + wet[2] == 0.0:
            continue
        d = _difference(_row(q, j), _row(q, i))
        tx, ty, tz, per_l = tangent_of(d[0], d[1], d[2], numbers[0])
        _segment_slopes(
            s, i, j, flow_i, flow_j, _row(v, i), _row(v, j), (tx, ty, tz), per_l, wet, numbers[4], numbers, waves, c_q, c_v, D, near
        )  # fmt: skip
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        flow = flow_at(t, _row(q, node), level, current, wave)
        _point_slopes(node, flow, _row(v, node), point_share(flow[0], numbers[0]), numbers[2], numbers, c_q, c_v, D)


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """-sum rho g V e of the segments and -sum rho g V H of the points, see `submergence` [J]; none in a wave."""
    level, _, wave, begin = _read_params(params)
    segments, total = index[0], 0.0
    if len(wave) > 0:
        return 0.0
    for s in range(segments):
        numbers = params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        total -= numbers[4] * wetted(q[index[1 + 2 * s], 2] - level, q[index[2 + 2 * s], 2] - level, numbers[1])[0]
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        numbers = params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        total -= numbers[2] * point_share(q[index[1 + 2 * segments + p], 2] - level, numbers[0])[2]
    return total


@inlined_law
def _middle(base, q, i):
    return 0.5 * (base[i, 0] + q[i, 0]), 0.5 * (base[i, 1] + q[i, 1]), 0.5 * (base[i, 2] + q[i, 2])


@inlined_law
def _mean_velocity(base, q, i, per_h):
    return per_h * (q[i, 0] - base[i, 0]), per_h * (q[i, 1] - base[i, 1]), per_h * (q[i, 2] - base[i, 2])


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step, and its exact derivative.

    It is `force` at the middle of the step, apart from the buoyancy of still water: that takes the weights of `wetted_between`, so
    that its work is the change of its energy. The work of all other forces counts as dissipated; in water at rest it is never
    negative.
    """
    level, current, wave, begin = _read_params(params)
    segments, waves, per_h, dissipated, last = index[0], len(wave) > 0, 1.0 / h, 0.0, -1
    flow_i = flow_at(t, (0.0, 0.0, 0.0), level, current, wave)
    flow_j = flow_i
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        q1, q2 = _middle(base, q, i), _middle(base, q, j)
        flow_i = flow_j if i == last else flow_at(t, q1, level, current, wave)
        flow_j, last = flow_at(t, q2, level, current, wave), j
        v1, v2, d, lift = _mean_velocity(base, q, i, per_h), _mean_velocity(base, q, j, per_h), _difference(q2, q1), numbers[4]
        wet = wetted(flow_i[0], flow_j[0], numbers[1])
        if not waves:
            g1, g2, s11, s12, s21, s22 = wetted_between(
                base[i, 2] - level, base[j, 2] - level, q[i, 2] - level, q[j, 2] - level, numbers[1]
            )  # fmt: skip
            f[i, 2] += lift * g1
            f[j, 2] += lift * g2
            if i < D.shape[0]:
                D[i, 2, 2] -= lift * s11
                near[s, 0, 2, 2] -= lift * s12
            if j < D.shape[0]:
                D[j, 2, 2] -= lift * s22
                near[s, 1, 2, 2] -= lift * s21
            lift = 0.0
        if wet[1] + wet[2] == 0.0:
            continue
        tx, ty, tz, per_l = tangent_of(d[0], d[1], d[2], numbers[0])
        _segment_slopes(s, i, j, flow_i, flow_j, v1, v2, (tx, ty, tz), per_l, wet, lift, numbers, waves, 0.5, per_h, D, near)
        for side in range(2):
            node, flow, V, w = (i, flow_i, v1, wet[1]) if side == 0 else (j, flow_j, v2, wet[2])
            F = segment_force(
                _difference(flow[2], V), flow[4], (tx, ty, tz), numbers[2], numbers[3], numbers[5], numbers[6], numbers[7]
            )
            _add(f, node, w, F, w * lift)
            dissipated -= h * w * (F[0] * V[0] + F[1] * V[1] + (F[2] + lift) * V[2])
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        flow, V, lift = flow_at(t, _middle(base, q, node), level, current, wave), _mean_velocity(base, q, node, per_h), numbers[2]
        if not waves:
            g, slope = point_share_between(base[node, 2] - level, q[node, 2] - level, numbers[0])
            f[node, 2] += lift * g
            D[node, 2, 2] -= lift * slope
            lift = 0.0
        wet = point_share(flow[0], numbers[0])
        _point_slopes(node, flow, V, wet, lift, numbers, 0.5, per_h, D)
        F = point_force(_difference(flow[2], V), flow[4], numbers[1], numbers[3], numbers[4])
        _add(f, node, wet[0], F, wet[0] * lift)
        dissipated -= h * wet[0] * (F[0] * V[0] + F[1] * V[1] + (F[2] + lift) * V[2])
    return dissipated, 0.0


@njit(INERTIA_SIGNATURE, cache=True, error_model="numpy")
def inertia(t, q, index, params, A):
    """Add the added masses, see the module."""
    level, _, wave, begin = _read_params(params)
    segments, last, z1, z2 = index[0], -1, 0.0, 0.0
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        z1 = z2 if i == last else height_at(t, q, i, level, wave)
        z2, last = height_at(t, q, j, level, wave), j
        _, w1, w2, _, _, _ = wetted(z1, z2, numbers[1])
        if w1 + w2 == 0.0:
            continue
        d = _difference(_row(q, j), _row(q, i))
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        if i < A.shape[0]:
            add_mass(w1 * numbers[5], numbers[6], numbers[7], (tx, ty, tz), A[i])
        if j < A.shape[0]:
            add_mass(w2 * numbers[5], numbers[6], numbers[7], (tx, ty, tz), A[j])
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        m = point_share(height_at(t, q, node, level, wave), numbers[0])[0] * numbers[3] * numbers[4]
        A[node, 0, 0] += m
        A[node, 1, 1] += m
        A[node, 2, 2] += m
