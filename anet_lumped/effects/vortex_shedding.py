"""Vortices that cables shed in water, and the lift across the flow with which they shake them; `Water` makes it of a cable's `Cl`.

The law is in `laws.shed_lift`. Each node inside a cable has a phase of its own, and bears the lift of the two half segments beside
it; the tangent there is the direction from the node before to the one behind. Nodes at the ends of cables bear none. The phases
start spread over one turn along the cable, 2 pi k/segments at the k-th node, so that no shape of vibration is left out by symmetry.

Phase, frequency and mean squares are inner states, which `settle` advances at the end of each step. Within a step of h the lift
acts with the phase in its middle,

    phi_m = phi + (h/2) 2 pi s |w|/d ,

with the frequency s of the step before and the flow of this step. At the end the velocities in the middle, (q_b - q_a)/h, and the
mean acceleration, (v_b - v_a)/h, give the frequency of this step, and the phase and the mean squares advance by the midpoint rule.
So all is of order 2. Where the frequency of a node is 0 it bears no lift: so it is at rest, since a lift that goes to and fro has
no mean. The lift does work, which the account counts as taken by effects, with the sign turned.

Velocities are those of the cable in the scene's axes, as in MoorDyn. A cable that is towed through water at rest sheds its vortices
at the Strouhal number, and does not lock in: give the tow as a current. In-line vibrations are not modelled.
Source: see `laws.shed_lift`.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numba import float64

from anet_lumped.compiled.jit import inlined_law, kernel
from anet_lumped.effects.flow.waves.base import Wave
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.wind.kernel import pack
from anet_lumped.effects.laws.over_a_step import middle_of, minus, velocity_of
from anet_lumped.effects.laws.shed_lift import across, frequency, lift, lift_slopes
from anet_lumped.effects.laws.submergence import point_share

from .effect import Effect
from .flow.surface import flow_at
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, SETTLE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

HEADER, NODE_INDEX, NODE_NUMBERS = 3, 5, 11  # numbers before all others, and of each node
WINDOW_PERIODS = 10.0  # of the vortices, in which a vibration is known by its mean squares
SAMPLES, SAMPLED_TIME = 33, 100.0  # times and places, and the time [s], at which the largest flow is looked for
SPEED_SIGNATURE = float64(float64, float64[:, ::1], float64[::1])
INNER = 7  # where the inner states of a node begin: phase, frequency, and mean squares of velocity and acceleration


@dataclass(frozen=True)
class VortexShedding(Effect):
    """Vortices of the cables of a scene that have a `Cl`; `Water` makes it of its own parameters."""

    density: float
    level: float
    flow: Any
    waves: tuple[Wave, ...] = ()
    g: float = 0.0

    coupled_neighbours: ClassVar[int] = 1
    from_outside: ClassVar[bool] = True

    @property
    def no_force_at_rest(self) -> bool:
        """Where the inner states are those of the table: in statics."""
        return True

    @property
    def keeps_energy(self) -> bool:
        """The lift gives energy."""
        return False

    def highest_frequency(self, scene: Any) -> float:
        """2 pi (St + St_range) U/d of the vortices, with the largest flow U that `SAMPLES` of times and heights show."""
        current, wave = pack(self.flow), pack_waves(self.waves, self.g, self.level)
        params = np.concatenate([[self.level, len(current), len(wave)], current, wave])
        times, highest = np.linspace(0.0, SAMPLED_TIME, SAMPLES), 0.0
        driven = max((float(np.linalg.norm(path.at(t)[1])) for path in _paths(scene) for t in times), default=0.0)
        for cable in scene.cables:
            if cable.Cl and cable.diameter:
                places = _places(cable, scene)
                speed = driven + max((fastest(float(t), places, params) for t in times), default=0.0)
                highest = max(highest, 2.0 * math.pi * (cable.St + cable.St_range) * speed / cable.diameter)
        return highest

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Number of nodes; of each its number, those of the nodes before and behind it along the cable, and the rows among the
            blocks of neighbours in which its row meets theirs, two rows a segment.
        params : float64
            Level [m]; how many numbers describe current and waves, and those numbers. Of each node: rho/2 d Cl times the length of
            a segment [kg/m], diameter [m], St, St_range, 1/window [1/s] or 0, 1/window per speed [1/m] or 0, length of a segment
            [m]; phase, frequency, mean squares of the velocity [m2/s2] and of the acceleration [m2/s4] across the flow.
        """
        current, wave = pack(self.flow), pack_waves(self.waves, self.g, self.level)
        index: list[list[int]] = []
        params: list[list[float]] = []
        for cable in model.scene.cables:
            if cable.Cl == 0.0:
                continue
            nodes, segments = model.nodes(cable.name), np.arange(model.n_segments)[model.segments(cable.name)]
            window = (
                (1.0 / cable.shedding_window, 0.0) if cable.shedding_window else (0.0, cable.St / cable.diameter / WINDOW_PERIODS)
            )
            c = 0.5 * self.density * cable.diameter * cable.Cl * cable.L0
            numbers = [c, cable.diameter, cable.St, cable.St_range, *window, cable.L0, 0.0, 0.0, 0.0, 0.0]
            for k in range(1, cable.segments):
                rows = (2 * int(s) + int(model.ends[s, 1] == nodes[k]) for s in segments[k - 1 : k + 1])
                index.append([int(nodes[k]), int(nodes[k - 1]), int(nodes[k + 1]), *rows])
                params.append(numbers)
        header = [self.level, len(current), len(wave)]
        return (
            np.concatenate([[len(index)], *index]).astype(np.int64),
            np.concatenate([header, current, wave, *params]),
        )

    def inner_states(self, index: np.ndarray, params: np.ndarray) -> np.ndarray:
        of_nodes = np.arange(len(params) - NODE_NUMBERS * int(index[0]), len(params)).reshape(-1, NODE_NUMBERS)
        return of_nodes[:, INNER:].ravel()

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "settle": settle}


def _paths(scene: Any) -> list[Any]:
    """Paths of the driven points."""
    return [point.path for point in scene.points if hasattr(point, "path")]


def _places(cable: Any, scene: Any) -> np.ndarray:
    """Places on the straight line between the ends of a cable and below it, as far as its slack may sag, (k, 3) [m]."""
    ends = [_start_of(scene.point(name)) for name in (cable.start, cable.end)]
    known = [end for end in ends if end is not None] or [np.zeros(3)]
    a, b = known[0], known[-1]
    down = max(cable.length - float(np.linalg.norm(b - a)), 0.0) * (1.0 if len(known) < 2 else 0.5)
    line = a + np.linspace(0.0, 1.0, SAMPLES)[:, None] * (b - a)
    below = min(a[2], b[2]) - np.linspace(0.0, down, SAMPLES)
    return np.concatenate([line, np.column_stack([np.full(SAMPLES, a[0]), np.full(SAMPLES, a[1]), below])])


def _start_of(point: Any) -> np.ndarray | None:
    """Where a point starts (3,) [m], as far as the scene says."""
    at = point.path.at(0.0)[0] if hasattr(point, "path") else getattr(point, "at", None)
    return None if at is None else np.array(at, float)


@inlined_law
def _water(params):
    """Numbers of current and waves, and where those of the nodes begin."""
    first = HEADER + int(params[1])
    end = first + int(params[2])
    return (params[HEADER:first], params[first:end]), end


@inlined_law
def _times(in_u, gradient, x, y):
    """Entry of the product of two matrices (9,)."""
    return in_u[3 * x] * gradient[y] + in_u[3 * x + 1] * gradient[3 + y] + in_u[3 * x + 2] * gradient[6 + y]


@inlined_law
def _subtract_slopes(i, before, behind, flow, share, F, in_u, in_chord, c_q, c_v, D, near):
    """Subtract the slopes of the lift F on a node; ``before`` and ``behind`` are rows of neighbours' blocks."""
    w, slope, _ = share
    for x in range(3):
        for y in range(3):
            D[i, x, y] += w * (c_v * in_u[3 * x + y] - c_q * _times(in_u, flow[3], x, y)) - c_q * slope * F[x] * flow[1][y]
            along = c_q * w * in_chord[3 * x + y]
            near[before // 2, before % 2, x, y] += along
            near[behind // 2, behind % 2, x, y] -= along


@inlined_law
def _lift_on(t, h, base, q, v, index, params, k):
    """What the k-th node is in: its number, velocity, flow and share under water; what `lift_slopes` takes; the lift.

    Over a step of h from ``base`` to q, with the phase in its middle; at one time where h = 0, and ``base`` is q.
    """
    motion, begin = _water(params)
    a, p = 1 + NODE_INDEX * k, begin + NODE_NUMBERS * k
    i, c, d = index[a], params[p], params[p + 1]
    V, flow = velocity_of(base, q, v, 1.0 / h if h > 0.0 else 0.0, i), flow_at(t, middle_of(base, q, i), params[0], motion)
    u, chord = minus(flow[2], V), minus(middle_of(base, q, index[a + 2]), middle_of(base, q, index[a + 1]))
    along, per_l, w, speed = across(u, chord, params[p + 6])
    ahead = math.pi * h * params[p + INNER + 1] / d
    phase = params[p + INNER] + ahead * speed
    return (i, V, flow, point_share(flow[0], d)), (u, along, per_l, w, speed, c, phase, ahead), lift(w, speed, c, phase)


@inlined_law
def _sheds(params, k):
    """Whether the k-th node has a frequency: none has in statics."""
    _, begin = _water(params)
    return params[begin + NODE_NUMBERS * k + INNER + 1] > 0.0


@inlined_law
def _add(f, i, share, F, V):
    """Add a lift to the force on a node; return the power that it takes [W]."""
    for x in range(3):
        f[i, x] += share * F[x]
    return -share * (F[0] * V[0] + F[1] * V[1] + F[2] * V[2])


@kernel(SPEED_SIGNATURE)
def fastest(t, places, params):
    """Largest speed of the water under its surface at some places [m/s]."""
    largest, (motion, _) = 0.0, _water(params)
    for i in range(places.shape[0]):
        flow = flow_at(t, (places[i, 0], places[i, 1], places[i, 2]), params[0], motion)
        if flow[0] <= 0.0:
            u = flow[2]
            largest = max(largest, math.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]))
    return largest


@kernel(FORCE_SIGNATURE)
def force(t, q, v, index, params, f):
    """Add the lift of each node with its phase; return the power that it takes [W]."""
    power = 0.0
    for k in range(index[0]):
        if _sheds(params, k):
            (i, V, _, share), _, F = _lift_on(t, 0.0, q, q, v, index, params, k)
            power += _add(f, i, share[0], F, V)
    return power


@kernel(TANGENT_SIGNATURE)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes of `force`."""
    for k in range(index[0]):
        if _sheds(params, k):
            (i, _, flow, share), (u, along, per_l, w, speed, c, phase, ahead), F = _lift_on(t, 0.0, q, q, v, index, params, k)
            in_u, in_chord = lift_slopes(u, along, per_l, w, speed, c, phase, ahead)
            a = 1 + NODE_INDEX * k
            _subtract_slopes(i, index[a + 3], index[a + 4], flow, share, F, in_u, in_chord, c_q, c_v, D, near)


@kernel(ENERGY_SIGNATURE)
def energy(t, q, index, params):
    """None [J]."""
    return 0.0


@kernel(WHOLE_STEP_SIGNATURE)
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Lift over a whole step with the phase in its middle, and its derivative."""
    power = 0.0
    for k in range(index[0]):
        if _sheds(params, k):
            (i, V, flow, share), (u, along, per_l, w, speed, c, phase, ahead), F = _lift_on(t, h, base, q, q, index, params, k)
            power += _add(f, i, share[0], F, V)
            in_u, in_chord = lift_slopes(u, along, per_l, w, speed, c, phase, ahead)
            a = 1 + NODE_INDEX * k
            _subtract_slopes(i, index[a + 3], index[a + 4], flow, share, F, in_u, in_chord, 0.5, 1.0 / h, D, near)
    return h * power, 0.0


@kernel(SETTLE_SIGNATURE)
def settle(t, h, damper, base, q, v, index, params):
    """Advance phases, frequencies and mean squares over a step of h that ends at t; takes no energy."""
    _, begin = _water(params)
    per_h = 1.0 / h
    for k in range(index[0]):
        if not _sheds(params, k):
            continue
        (i, V, _, _), (_, _, _, w, speed, _, phase, _), _ = _lift_on(t - 0.5 * h, h, base, q, q, index, params, k)
        if speed == 0.0:
            continue  # no flow across the cable: nothing is shed
        p = begin + NODE_NUMBERS * k
        velocity = (w[0] * V[0] + w[1] * V[1] + w[2] * V[2]) / speed
        acceleration = 2.0 * per_h * (w[0] * (v[i, 0] - V[0]) + w[1] * (v[i, 1] - V[1]) + w[2] * (v[i, 2] - V[2])) / speed
        forgotten = 1.0 - math.exp(-0.5 * h * (params[p + 4] + params[p + 5] * speed))  # in half of the step
        for x, y in ((2, velocity), (3, acceleration)):
            params[p + INNER + x] += forgotten * (y * y - params[p + INNER + x])
        s = frequency(
            params[p + 2], params[p + 3], phase, velocity, acceleration, params[p + INNER + 2], params[p + INNER + 3]
        )  # fmt: skip
        for x, y in ((2, velocity), (3, acceleration)):
            params[p + INNER + x] += forgotten * (y * y - params[p + INNER + x])
        params[p + INNER] += 2.0 * math.pi * h * s * speed / params[p + 1]
        params[p + INNER + 1] = s
    return 0.0
