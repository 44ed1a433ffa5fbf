"""Bending stiffness of cables, and clamped ends: a discrete elastic rod without twist.

Two neighbouring segments with unit tangents t1 and t2 store the energy B (1 - t1 . t2) = B/2 |t2 - t1|^2, B = EI/L0, that of the
curvature |t2 - t1|/L0 over the length L0 that belongs to the node between them. A clamp of direction c and the first segment
store 2 B (1 - c . t), over half of that length. With d the vector of a segment and l its length,

    dE/dd1 = -(B/l1) (t2 - (t1 . t2) t1) ,      dE/dd2 = -(B/l2) (t1 - (t1 . t2) t2) .

Over a whole step from a to b,

    change of |t2 - t1|^2/2 = (mean t2 - t1) . (change of t2 - t1) ,
    t_b - t_a = S (I - e e^T) (d_b - d_a) ,   S = (1/l_a + 1/l_b)/2 ,   e = (d_a + d_b)/(l_a + l_b) .

Therefore these forces, in place of the derivatives above, do exactly the work by which the energy changes:

    g1 = -B S1 (I - e1 e1^T) w ,   g2 = B S2 (I - e2 e2^T) w ,   w = (mean t2 - t1) + alpha k ,   k = change of t2 - t1 ,

apart from the numerical damper alpha. Across t1 the mean of t2 - t1 is as good as that of t2. But e is shorter than one where a
segment turns by an angle a: of t2 a pull B S a^2/4 along the segment would be left, which its tension would have to carry.
Nothing asks for the own tangent's share of w, so it is left out beside a segment that is slack (`share_of_own`): there t turns so
far in one step that its mean is no direction across it, and Newton's iteration found no solution.

The numerical damper takes 2 alpha times the energy of the change k. It damps motion that a step does not resolve: alpha =
`ALPHA` s^2/(1 + s^2), s = h omega/2, with the highest frequency omega = 4 sqrt(EI/mu)/L0^2.

A clamp may turn: its direction c is then that of a path. Over a step the mean c of both ends acts, and the damper takes the turn of
the segment against the clamp. The work of the clamp, 2 B (-(mean t) . (change of c) - alpha (change of t - c) . (change of c)) over
a step and -2 B t . dc/dt in a second, counts as negative dissipation.
Source: Bergou et al., ACM Trans. Graph. 27 (2008) 63, for the energy; Gonzalez, J. Nonlinear Sci. 6 (1996) 449, for the step.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_direction, check_pairs
from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.prescribed.path_in_numbers import length_of_path, motion_at, numbers_of_path, value_at
from anet_lumped.prescribed.paths import Path
from anet_lumped.prescribed.signals import Signal

from .effect import Effect
from .laws.clamps import clamped_cable, node_after
from .laws.rod import (
    add_clamp_block,
    add_row,
    add_turn_block,
    assemble_pair,
    between_nodes,
    combined,
    cross_block,
    damper_of_bending,
    dot,
    mean_bend,
    own_block,
    own_step_block,
    projected,
    share_of_own,
    slope_of_turn,
    step_of,
    tangent_of_segment,
)
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

LOOKS = 200  # at the directions of a clamp that turns, for one that is zero


@dataclass(frozen=True)
class Bending(Effect):
    """Bending of the cables that have an `EI`.

    A cable that is stiff in bending also pushes: give it ``compression="linear"``. In a cable that cannot push, strong bending
    shortens slack segments to nothing, and a run from a crumpled shape may end as unconverged. The same happens with EI above
    EA L0^2, which no real section has.

    Parameters
    ----------
    clamped : dict or pairs of str and (3,) array_like or Path
        Fixed or driven points, and the direction in which their cable leaves them; its length must not be zero. A path of
        `anet_lumped.paths` gives the direction as a function of time, whatever the unit and the length.
    """

    clamped: Mapping[str, Vector | Path] | tuple[tuple[str, Vector | Path], ...] = ()

    coupled_neighbours: ClassVar[int] = 2
    same_everywhere: ClassVar[bool] = True

    def check_parameters(self) -> None:
        what = "a point's name and a direction or path"
        pairs = check_pairs("clamped", self.clamped, what, self._called, may_be_empty=True)
        self._set(clamped=tuple((name, self._direction(name, value)) for name, value in pairs))

    def _direction(self, name: str, value: Any) -> Any:
        """A checked direction, or a path of directions."""
        where = f'{self._called} at point "{name}"'
        if not isinstance(value, Path):
            return check_direction("clamped", value, where)
        if value.kind == "external":
            raise SceneError(
                f"Argument `clamped` must be a direction or a path that is known before a run, but {where} has {value}."
            )
        looks = np.concatenate([value.breaks, np.linspace(0.0, max(float(value.breaks[-1]), 1.0), LOOKS)])
        sizes = np.array([np.linalg.norm(value.at(t)[0]) for t in looks.tolist()])
        if not sizes.min() > 1e-6 * sizes.max():
            raise SceneError(
                f"A path of directions must never be zero, but {where} has {tuple(value.at(looks[sizes.argmin()])[0].tolist())} "
                f"at t={looks[sizes.argmin()]:g} s."
            )
        return value

    @property
    def signals(self) -> tuple[Signal, ...]:
        """The functions of time, whose corners steps end on."""
        return tuple(
            Signal("clamped", ((name, value),), value) for name, value in dict(self.clamped).items() if isinstance(value, Path)
        )

    def highest_frequency(self, scene: Any) -> float:
        """Of a free chain with a bending spring at each node."""
        return max((_stiffness(cable)[2] for cable in scene.cables), default=0.0)

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Number of pairs of segments; of each pair its three nodes and first segment; of each clamp its point, the next node,
            the pieces of the path of its direction, 0 for a constant one, and 1 if the path has a sine.
        params : float64
            B [N m], L0 [m] and highest frequency [rad/s] of each pair; the same and the direction or its path of each clamp.

        Raises
        ------
        SceneError : no cable has an EI; a clamp at a free point, or not at the end of one cable that has an EI
        """
        scene = model.scene
        bent = [cable for cable in scene.cables if cable.EI > 0.0]
        if not bent:
            raise SceneError("The effect Bending needs cables with an `EI` [N m2], but no cable has any.")
        pairs, index, numbers = 0, [], []
        for c, cable in enumerate(scene.cables):
            first, count = model.segment_run(c)
            for s in range(first, first + count - 1) if cable.EI > 0.0 else ():
                index += [*model.ends[s], model.ends[s + 1, 1], s]
                numbers += _stiffness(cable)
                pairs += 1
        for name, direction in dict(self.clamped).items():
            cable, node = clamped_cable(model, name, {cable.name for cable in bent}, "an `EI`", self._called), model.node(name)
            following = node_after(model, name, cable)
            if isinstance(direction, Path):
                index += [node, following, len(direction.breaks), int(direction.sine is not None)]
                numbers += [*_stiffness(cable), *numbers_of_path(direction)]
            else:
                index += [node, following, 0, 0]
                numbers += [*_stiffness(cable), *(np.array(direction) / np.linalg.norm(direction))]
        return np.array([pairs, *index], np.int64), np.array(numbers)

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        """Without the clamps of cables that have fallen off; None if no cable bends that is left."""
        bent = {name for cable in cables if cable.EI > 0.0 for name in (cable.start, cable.end)}
        return Bending(tuple((name, direction) for name, direction in dict(self.clamped).items() if name in bent)) if bent else None

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step}


def _stiffness(cable: Any) -> list[float]:
    return [cable.EI / cable.L0, cable.L0, 4.0 * math.sqrt(cable.EI / cable.mass_per_length) / cable.L0**2]


@inlined_law
def _clamp(t, params, at, pieces, sine):
    """Direction of a clamp at a time; a constant one is written as it is."""
    if pieces == 0:
        return params[at], params[at + 1], params[at + 2]
    c, _ = value_at(t, params, at, pieces, sine != 0)
    size = math.sqrt(dot(c, c))
    return c[0] / size, c[1] / size, c[2] / size


@inlined_law
def _clamp_rate(t, params, at, pieces, sine):
    """Rate of the direction of a clamp that turns, (r - c (c . r))/|path| for a path of the rate r."""
    path, rate, _, _ = motion_at(t, params, at, pieces, sine != 0)
    size = math.sqrt(dot(path, path))
    c = path[0] / size, path[1] / size, path[2] / size
    return combined(1.0 / size, rate, -dot(c, rate) / size, c)


@inlined_law
def _clamp_numbers(pieces, sine):
    """How many numbers a clamp has."""
    return 3 + (3 if pieces == 0 else length_of_path(pieces, sine != 0))


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i -= dE/dq_i; see the module. Returns what clamps that turn take [W], negative where they work on the cable."""
    i_index, i_params, power = 1, 0, 0.0
    for _ in range(index[0]):
        i, j, k = index[i_index], index[i_index + 1], index[i_index + 2]
        B, L0 = params[i_params], params[i_params + 1]
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), L0)
        t2, l2 = tangent_of_segment(between_nodes(q, j, k), L0)
        g1, g2 = slope_of_turn(B, l1, t1, t2), slope_of_turn(B, l2, t2, t1)
        add_row(f, i, g1, 1.0)
        add_row(f, j, g1, -1.0)
        add_row(f, j, g2, 1.0)
        add_row(f, k, g2, -1.0)
        i_index, i_params = i_index + 4, i_params + 3
    while i_index < index.shape[0]:
        i, j, pieces, sine = index[i_index], index[i_index + 1], index[i_index + 2], index[i_index + 3]
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), params[i_params + 1])
        g = slope_of_turn(2.0 * params[i_params], l1, t1, _clamp(t, params, i_params + 3, pieces, sine))
        add_row(f, i, g, 1.0)
        add_row(f, j, g, -1.0)
        if pieces > 0:
            power += 2.0 * params[i_params] * dot(t1, _clamp_rate(t, params, i_params + 3, pieces, sine))
        i_index, i_params = i_index + 4, i_params + _clamp_numbers(pieces, sine)
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Exact second derivatives of the energy; see the module."""
    H11, H12, H21, H22 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    i_index, i_params = 1, 0
    for _ in range(index[0]):
        i, j, k, s = index[i_index], index[i_index + 1], index[i_index + 2], index[i_index + 3]
        B, L0 = params[i_params], params[i_params + 1]
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), L0)
        t2, l2 = tangent_of_segment(between_nodes(q, j, k), L0)
        own_block(H11, B, l1, t1, t2)
        own_block(H22, B, l2, t2, t1)
        cross_block(H12, -B / (l1 * l2), t1, t2)
        cross_block(H21, -B / (l1 * l2), t2, t1)
        assemble_pair(c_q, i, j, k, s, H11, H12, H21, H22, D, near, far)
        i_index, i_params = i_index + 4, i_params + 3
    while i_index < index.shape[0]:
        t1, l1 = tangent_of_segment(between_nodes(q, index[i_index], index[i_index + 1]), params[i_params + 1])
        pieces, sine = index[i_index + 2], index[i_index + 3]
        own_block(H11, 2.0 * params[i_params], l1, t1, _clamp(t, params, i_params + 3, pieces, sine))
        add_clamp_block(c_q, index[i_index + 1], H11, D)
        i_index, i_params = i_index + 4, i_params + _clamp_numbers(pieces, sine)


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """Sum of B/2 |t2 - t1|^2 and of B |c - t|^2 [J]."""
    total, i_index, i_params = 0.0, 1, 0
    for _ in range(index[0]):
        t1, _ = tangent_of_segment(between_nodes(q, index[i_index], index[i_index + 1]), params[i_params + 1])
        t2, _ = tangent_of_segment(between_nodes(q, index[i_index + 1], index[i_index + 2]), params[i_params + 1])
        turn = combined(1.0, t2, -1.0, t1)
        total += 0.5 * params[i_params] * dot(turn, turn)
        i_index, i_params = i_index + 4, i_params + 3
    while i_index < index.shape[0]:
        t1, _ = tangent_of_segment(between_nodes(q, index[i_index], index[i_index + 1]), params[i_params + 1])
        pieces, sine = index[i_index + 2], index[i_index + 3]
        turn = combined(1.0, t1, -1.0, _clamp(t, params, i_params + 3, pieces, sine))
        total += params[i_params] * dot(turn, turn)
        i_index, i_params = i_index + 4, i_params + _clamp_numbers(pieces, sine)
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Forces over a whole step as discrete gradients of the energy, with the numerical damper; see the module."""
    H11, H12, H21, H22 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    dissipated, by_method, i_index, i_params = 0.0, 0.0, 1, 0
    for _ in range(index[0]):
        i, j, k, s = index[i_index], index[i_index + 1], index[i_index + 2], index[i_index + 3]
        B, L0, alpha = params[i_params], params[i_params + 1], damper_of_bending(h, params[i_params + 2])
        t1a, t1, l1a, l1, S1, e1, turn1 = step_of(base, q, i, j, L0)
        t2a, t2, l2a, l2, S2, e2, turn2 = step_of(base, q, j, k, L0)
        bend = combined(1.0, turn2, -1.0, turn1)
        share = share_of_own(l1a, l2a, L0)
        w1 = mean_bend(share, t1a, t1, t2a, t2, alpha, bend)
        w2 = mean_bend(share, t2a, t2, t1a, t1, -alpha, bend)
        g1, g2 = projected(-B * S1, e1, w1), projected(-B * S2, e2, w2)
        add_row(f, i, g1, 1.0)
        add_row(f, j, g1, -1.0)
        add_row(f, j, g2, 1.0)
        add_row(f, k, g2, -1.0)
        by_method += alpha * B * dot(bend, bend)
        own_step_block(H11, B, S1, e1, t1, l1a, l1, w1)
        add_turn_block(H11, (0.5 * share + alpha) * B, S1, e1, t1, l1)
        own_step_block(H22, B, S2, e2, t2, l2a, l2, w2)
        add_turn_block(H22, (0.5 * share + alpha) * B, S2, e2, t2, l2)
        H12[:, :] = 0.0
        H21[:, :] = 0.0
        add_turn_block(H12, -(0.5 + alpha) * B, S1, e1, t2, l2)
        add_turn_block(H21, -(0.5 + alpha) * B, S2, e2, t1, l1)
        assemble_pair(1.0, i, j, k, s, H11, H12, H21, H22, D, near, far)
        i_index, i_params = i_index + 4, i_params + 3
    while i_index < index.shape[0]:
        i, j, pieces, sine = index[i_index], index[i_index + 1], index[i_index + 2], index[i_index + 3]
        B, L0, alpha = 2.0 * params[i_params], params[i_params + 1], damper_of_bending(h, params[i_params + 2])
        c_a, c_b = _clamp(t - 0.5 * h, params, i_params + 3, pieces, sine), _clamp(t + 0.5 * h, params, i_params + 3, pieces, sine)
        t1a, t1, l1a, l1, S1, e1, turn1 = step_of(base, q, i, j, L0)
        turned = combined(1.0, c_b, -1.0, c_a)
        bend = combined(1.0, turn1, -1.0, turned)
        share = share_of_own(l1a, l1a, L0)
        w1 = mean_bend(share, t1a, t1, c_a, c_b, -alpha, bend)
        g1 = projected(-B * S1, e1, w1)
        add_row(f, i, g1, 1.0)
        add_row(f, j, g1, -1.0)
        by_method += alpha * B * dot(bend, bend)
        dissipated += B * (0.5 * (dot(t1a, turned) + dot(t1, turned)) + alpha * dot(bend, turned))
        own_step_block(H11, B, S1, e1, t1, l1a, l1, w1)
        add_turn_block(H11, (0.5 * share + alpha) * B, S1, e1, t1, l1)
        add_clamp_block(1.0, j, H11, D)
        i_index, i_params = i_index + 4, i_params + _clamp_numbers(pieces, sine)
    return dissipated, by_method
