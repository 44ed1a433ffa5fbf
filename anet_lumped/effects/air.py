"""Drag of the air, at rest or in wind, on cables, on what free points carry, and on bodies."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import Vector, check_number
from anet_lumped.compiled.jit import njit
from anet_lumped.effects.flow.wind import Wind
from anet_lumped.effects.flow.wind.base import as_winds, check_winds, same_at_each_height, steady
from anet_lumped.effects.flow.wind.kernel import pack, wind_at
from anet_lumped.effects.laws.diameters import check_diameters
from anet_lumped.effects.laws.drag import (
    point_coefficient,
    point_drag,
    segment_coefficients,
    segment_drag,
    subtract_point_slopes,
    subtract_segment_slopes,
    tangent_of,
)
from anet_lumped.effects.laws.submergence import sphere_diameter, submerged_share, wetted

from .effect import Effect
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE

HEADER, SEGMENT_NUMBERS, POINT_NUMBERS = 2, 4, 2  # numbers in ``params`` before all others, of each segment and of each point
NO_SURFACE = -1e300  # [m]


@dataclass(frozen=True)
class Air(Effect):
    """Quadratic drag on every segment, across and along it, and on free points with a `CdA`, by the law of `laws.drag`.

    On rigid bodies it acts by their `CdA` and on their rods, see `fluid_on_bodies`.

    Each cable needs a `diameter`. Where wind drives the cables, the energy that the air takes is negative. In a scene with water,
    give the `surface` of the still water, below which no air acts; waves do not move this surface.

    Parameters
    ----------
    density : float [kg/m3]; 1.225 at 15 degC and sea level (ISO 2533)
    wind : None for air at rest, a wind of `anet_lumped.wind`, or several, whose velocities add up
    surface : float [m] or None, z of the still water below the air; a cable leaves the air smoothly over its diameter
    """

    density: float = 1.225
    wind: Wind | Sequence[Wind] | None = None
    surface: float | None = None

    coupled_neighbours: ClassVar[int] = 1

    def check_parameters(self) -> None:
        self._set(
            density=check_number("density", self.density, "kg/m3", self._called, sign="positive"),
            wind=check_winds("wind", self.wind, self._called),
            surface=None if self.surface is None else check_number("surface", self.surface, "m", self._called),
        )

    @property
    def no_force_at_rest(self) -> bool:
        """Without wind."""
        return self.wind is None

    @property
    def sudden(self) -> tuple[tuple[float, float, float], ...]:
        return tuple(times for wind in as_winds(self.wind) for times in wind.sudden)

    def steady(self) -> Effect:
        left = steady(self.wind)
        return self if left is self.wind else replace(self, wind=left)

    def seen_from(self, origin: Vector, scene: Any) -> Effect | None:
        return self if origin[2] == 0.0 and same_at_each_height(self.wind) else None

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Number of segments; both nodes of each; nodes of the points with a CdA.
        params : float64
            Surface [m]; how many numbers describe the winds, and those numbers; of each segment unstretched length [m],
            diameter [m] and the coefficients normal and along [kg/m]; of each point diameter [m] and coefficient [kg/m].

        Raises
        ------
        SceneError : a cable without a diameter
        """
        cables = model.scene.cables
        check_diameters(cables, "effect Air")
        points = [point for point in model.scene.loaded_points if point.CdA > 0.0]
        of_cable = np.array([[cable.L0, cable.diameter, *segment_coefficients(self.density, cable)] for cable in cables])
        winds = pack(self.wind)
        nodes = [model.node(point.name) for point in points]
        of_point = np.array([[sphere_diameter(point), point_coefficient(self.density, point)] for point in points])
        header = [NO_SURFACE if self.surface is None else self.surface, len(winds)]
        index = np.concatenate([[model.n_segments], model.ends.ravel(), nodes]).astype(np.int64)
        return index, np.concatenate([header, winds, of_cable[model.cable_of].ravel(), of_point.ravel()])

    def on_bodies(self, scene: Any) -> Effect | None:
        if not any(body.has_drag or body.rods for body in scene.bodies if not body.is_driven):
            return None
        from .fluid_on_bodies import FluidOnBodies  # compiled for those scenes alone

        return FluidOnBodies(self.density, NO_SURFACE if self.surface is None else self.surface, self.wind, dry=True)

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy}


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add the drag on both nodes of every segment and on points; returns -sum f_i . v_i [W]. Source: see `laws.drag`."""
    segments, surface, begin = index[0], params[0], HEADER + int(params[1])
    winds, power = params[HEADER:begin], 0.0
    last, wind = -1, (0.0, 0.0, 0.0)
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        tx, ty, tz, _ = tangent_of(q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2], numbers[0])
        w1, w2 = 0.0, 0.0
        if surface > NO_SURFACE:
            _, w1, w2, _, _, _ = wetted(q[i, 2] - surface, q[j, 2] - surface, numbers[1])
        for node, dry in ((i, 1.0 - 2.0 * w1), (j, 1.0 - 2.0 * w2)):
            if node != last and len(winds) > 0:  # the next segment of a cable begins where this one ends
                wind, _ = wind_at(t, q[node, 0], q[node, 1], q[node, 2], winds)
                last = node
            x, y, z = v[node, 0], v[node, 1], v[node, 2]
            fx, fy, fz = segment_drag(wind[0] - x, wind[1] - y, wind[2] - z, tx, ty, tz, dry * numbers[2], dry * numbers[3])
            f[node, 0] += fx
            f[node, 1] += fy
            f[node, 2] += fz
            power -= fx * x + fy * y + fz * z
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        wind, _ = wind_at(t, q[node, 0], q[node, 1], q[node, 2], winds)
        x, y, z = v[node, 0], v[node, 1], v[node, 2]
        dry = 1.0 - submerged_share(q[node, 2] - surface, numbers[0])[0]
        fx, fy, fz = point_drag(wind[0] - x, wind[1] - y, wind[2] - z, dry * numbers[1])
        f[node, 0] += fx
        f[node, 1] += fy
        f[node, 2] += fz
        power -= fx * x + fy * y + fz * z
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes of the drag, including those of the wind with the position; derivation in `laws.drag`."""
    segments, surface, begin = index[0], params[0], HEADER + int(params[1])
    winds = params[HEADER:begin]
    last, wind = -1, (0.0, 0.0, 0.0)
    gradient = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        tx, ty, tz, per_l = tangent_of(q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2], numbers[0])
        w1, w2, k11, k12, k22 = 0.0, 0.0, 0.0, 0.0, 0.0
        if surface > NO_SURFACE:
            _, w1, w2, k11, k12, k22 = wetted(q[i, 2] - surface, q[j, 2] - surface, numbers[1])
        for side in range(2):
            node, dry, k = (i, 1.0 - 2.0 * w1, k11) if side == 0 else (j, 1.0 - 2.0 * w2, k22)
            if node >= D.shape[0]:
                continue
            if node != last and len(winds) > 0:
                wind, gradient = wind_at(t, q[node, 0], q[node, 1], q[node, 2], winds)
                last = node
            u = (wind[0] - v[node, 0], wind[1] - v[node, 1], wind[2] - v[node, 2])
            subtract_segment_slopes(
                u,
                gradient,
                (tx, ty, tz),
                per_l,
                dry * numbers[2],
                dry * numbers[3],
                2.0 * side - 1.0,
                c_q,
                c_v,
                D[node],
                near[s, side],
            )
            if k != 0.0 or k12 != 0.0:
                undiminished = segment_drag(u[0], u[1], u[2], tx, ty, tz, numbers[2], numbers[3])
                for x in range(3):
                    D[node, x, 2] += c_q * 2.0 * k * undiminished[x]
                    near[s, side, x, 2] += c_q * 2.0 * k12 * undiminished[x]
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        wind, gradient = wind_at(t, q[node, 0], q[node, 1], q[node, 2], winds)
        u = (wind[0] - v[node, 0], wind[1] - v[node, 1], wind[2] - v[node, 2])
        wet, slope, _ = submerged_share(q[node, 2] - surface, numbers[0])
        subtract_point_slopes(u, gradient, (1.0 - wet) * numbers[1], c_q, c_v, D[node])
        undiminished = point_drag(u[0], u[1], u[2], numbers[1])
        for x in range(3):
            D[node, x, 2] += c_q * slope * undiminished[x]


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Drag has no energy."""
    return 0.0
