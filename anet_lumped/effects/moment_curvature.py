"""Bending of cables whose moment is no multiple of their curvature: M(kappa), straight between given points.

The law of `bending` with another energy. Two neighbouring segments with unit tangents t1 and t2 have the curvature
kappa = |t2 - t1|/L0, and store E = L0 U(kappa), U the integral of M; a clamp of direction c stores it over half of that length,
with kappa = 2 |t - c|/L0. With y = 1 - t1 . t2 = (L kappa)^2/2 over a length L,

    dE/dy = B = M/(L kappa) ,     over a step     (E_b - E_a)/(y_b - y_a) = 2 <M>/(L (kappa_a + kappa_b)) ,

with the mean <M> of the moment between both curvatures, take the place of the constant B of `bending`: so the force over a step
does the work by which the energy changes. Beyond the last point the moment stays what it is, as in MoorDyn.
Source: as of `bending`; MoorDyn's Line.cpp (getNonlinearEI).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import SceneError, Vector, as_entries, check_direction, check_number, check_pairs, quoted, shown
from anet_lumped.compiled.jit import inlined_law, law, njit

from .effect import Effect, names_left
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

HEADER, PAIR, CLAMP = 2, 6, 4  # in ``index``: numbers before all others, and those of each pair and clamp
OF_PAIR, OF_CLAMP, OF_POINT = 3, 6, 4  # in ``params``: numbers of each pair, clamp and point of a curve
SAME = 1e-7  # of their sum: curvatures that are nearer have the mean of both moments, to rounding
Curve = Sequence[Sequence[float]]


@dataclass(frozen=True)
class MomentCurvature(Effect):
    """Bending of cables by curves of moment over curvature. With `Bending` in the scene, an `EI` of theirs acts besides.

    As for `Bending`, give such a cable ``compression="linear"``.

    Parameters
    ----------
    curves : dict of str and rows (curvature [1/m], moment [N m])
        By the name of a cable, from (0, 0) on, which may be left out. Curvatures increase, and moments never fall.
    clamped : dict or pairs of str and (3,) array_like
        Fixed or driven points, and the direction in which their cable leaves them; its length must not be zero.
    """

    curves: Mapping[str, Curve] | Sequence[tuple[str, Curve]]
    clamped: Mapping[str, Vector] | Sequence[tuple[str, Vector]] = ()

    coupled_neighbours: ClassVar[int] = 2
    same_everywhere: ClassVar[bool] = True

    def check_parameters(self) -> None:
        curves = check_pairs("curves", self.curves, "a cable's name and rows of a curvature and a moment", self._called)
        self._set(curves=tuple((name, _checked(rows, f"{self._called} of cable {quoted(name)}")) for name, rows in curves))
        clamped = check_pairs("clamped", self.clamped, "a point's name and a direction", self._called, may_be_empty=True)
        directions = ((name, check_direction("clamped", to, f"{self._called} at point {quoted(name)}")) for name, to in clamped)
        self._set(clamped=tuple(directions))

    def highest_frequency(self, scene: Any) -> float:
        """Of a free chain with a bending spring at each node."""
        return max(_frequency(scene.cable(name), curve) for name, curve in dict(self.curves).items())

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls({scene.cables[0].name: ((1.0, 1e-3), (2.0, 1.5e-3))})

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Number of pairs of segments, and where in ``params`` the curves begin; of each pair its three nodes, first segment,
            first point of its curve and the point after the last; of each clamp its point, the next node and the points likewise.
        params : float64
            Length for its shortest [m], length L of the curvature [m] and highest frequency [rad/s] of each pair; the same and the
            direction of each clamp; of each point of a curve kappa [1/m], M [N m], slope beyond it [N m2] and U [N].

        Raises
        ------
        SceneError : an unknown cable, a clamp at a free point, or not at the end of one cable with a curve
        """
        scene, pairs, clamps, numbers = model.scene, [], [], []
        points: list[list[float]] = []
        for name, curve in dict(self.curves).items():
            cable = scene.cable(name)
            first_point = len(points)
            points += _points(curve)
            run = first_point, len(points)
            of_pair = [cable.L0, cable.L0, _frequency(cable, curve)]
            first, count = model.segment_run(scene.cable_numbers[name])
            for s in range(first, first + count - 1):
                pairs.append([*model.ends[s], model.ends[s + 1, 1], s, *run])
                numbers += of_pair
            clamps += [(name, run, [cable.L0, 0.5 * cable.L0, of_pair[2]])]
        by_cable = {name: (run, of) for name, run, of in clamps}
        rows = []
        for point, direction in dict(self.clamped).items():
            cable = clamped_cable(model, point, by_cable, "a curve", self._called)
            run, of_clamp = by_cable[cable.name]
            rows.append([model.node(point), node_after(model, point, cable), *run])
            numbers += [*of_clamp, *(np.array(direction) / np.linalg.norm(direction))]
        index = [len(pairs), len(numbers), *(number for row in [*pairs, *rows] for number in row)]
        return np.array(index, np.int64), np.array([*numbers, *(number for point in points for number in point)])

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        curves = [(piece, curve) for name, curve in dict(self.curves).items() for piece in names_left(name, pieces)]
        left = {name for name, _ in curves}
        ends = {end for cable in cables if cable.name in left for end in (cable.start, cable.end)}
        clamped = tuple((name, direction) for name, direction in dict(self.clamped).items() if name in ends)
        return MomentCurvature(tuple(curves), clamped) if curves else None

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step}


def _checked(rows: Any, owner: str) -> tuple[tuple[float, float], ...]:
    """A curve without the (0, 0) that it may begin with."""
    entries = [as_entries(row) for row in as_entries(rows) or ()]
    if not entries or any(row is None or len(row) != 2 for row in entries):
        raise SceneError(f"Argument `curves` must be rows of a curvature and a moment, but {owner} has {shown(rows)}.")
    units = ("1/m", "N m")
    curve = [tuple(check_number("curves", x, unit, owner) for x, unit in zip(row or (), units, strict=True)) for row in entries]
    curve = curve[1:] if curve[0] == (0.0, 0.0) else curve
    both = pairwise([(0.0, 0.0), *curve])
    if not curve or curve[0][1] <= 0.0 or any(b[0] <= a[0] or b[1] < a[1] for a, b in both):
        raise SceneError(
            "Curvatures of `curves` must increase from 0 on, and moments rise at first and never fall, but "
            f"{owner} has {shown(rows)}."
        )
    return tuple((kappa, M) for kappa, M in curve)


def _points(curve: Curve) -> list[list[float]]:
    """kappa, M, slope beyond and U of each point of a curve, from (0, 0) on."""
    rows, U = [], 0.0
    whole = [(0.0, 0.0), *curve]
    for (kappa, M), (further, more) in pairwise(whole):
        rows.append([kappa, M, (more - M) / (further - kappa), U])
        U += 0.5 * (M + more) * (further - kappa)
    return [*rows, [*whole[-1], 0.0, U]]


def _frequency(cable: Any, curve: Curve) -> float:
    steepest = max(slope for _, _, slope, _ in _points(curve))
    return 4.0 * math.sqrt(steepest / cable.mass_per_length) / cable.L0**2


@inlined_law
def _bent(kappa, params, curves, first, end):
    """M [N m], its slope [N m2] and U [N] at a curvature, and whether it is on the first piece."""
    r = end - 1
    while r > first and params[curves + OF_POINT * r] > kappa:
        r -= 1
    at = curves + OF_POINT * r
    more = kappa - params[at]
    M = params[at + 1] + params[at + 2] * more
    return M, params[at + 2], params[at + 3] + 0.5 * (params[at + 1] + M) * more, r == first


@law
def _stiffness(kappa, L, params, curves, first, end):
    """B of the module [N m] and its slope in y [N m]."""
    M, slope, _, is_first = _bent(kappa, params, curves, first, end)
    if is_first:
        return slope / L, 0.0
    return M / (L * kappa), (slope - M / kappa) / (L * L * L * kappa * kappa)


@law
def _stiffness_over_step(a, b, L, params, curves, first, end):
    """B over a step from the curvature a to b [N m], and its slope in y_b [N m]; see the module."""
    M_a, _, U_a, a_is_first = _bent(a, params, curves, first, end)
    M_b, slope, U_b, b_is_first = _bent(b, params, curves, first, end)
    if a_is_first and b_is_first:
        return slope / L, 0.0
    total, change = a + b, b - a
    if abs(change) > SAME * total:
        M = (U_b - U_a) / change
        M_slope = (M_b - M) / change
    else:
        M, M_slope = 0.5 * (M_a + M_b), 0.5 * slope
    B = 2.0 * M / (L * total)
    return B, (2.0 * M_slope / L - B) / (total * L * L * max(b, 1e-12 * total))


@inlined_law
def _curvature(t1, t2, L):
    turn = combined(1.0, t2, -1.0, t1)
    return math.sqrt(dot(turn, turn)) / L


@inlined_law
def _add_product(H, weight, a, b):
    """Add weight a b^T to H."""
    for x in range(3):
        for y in range(3):
            H[x, y] += weight * a[x] * b[y]


@inlined_law
def _direction(params, at):
    return params[at], params[at + 1], params[at + 2]


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i -= dE/dq_i; see the module. Returns 0 [W]."""
    curves, at, n = index[1], HEADER, 0
    for _ in range(index[0]):
        i, j, k = index[at], index[at + 1], index[at + 2]
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), params[n])
        t2, l2 = tangent_of_segment(between_nodes(q, j, k), params[n])
        B, _ = _stiffness(_curvature(t1, t2, params[n + 1]), params[n + 1], params, curves, index[at + 4], index[at + 5])
        g1, g2 = slope_of_turn(1.0, l1, t1, t2), slope_of_turn(1.0, l2, t2, t1)
        add_row(f, i, g1, B)
        add_row(f, j, g1, -B)
        add_row(f, j, g2, B)
        add_row(f, k, g2, -B)
        at, n = at + PAIR, n + OF_PAIR
    while at < index.shape[0]:
        i, j, c = index[at], index[at + 1], _direction(params, n + 3)
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), params[n])
        B, _ = _stiffness(_curvature(c, t1, params[n + 1]), params[n + 1], params, curves, index[at + 2], index[at + 3])
        g = slope_of_turn(1.0, l1, t1, c)
        add_row(f, i, g, B)
        add_row(f, j, g, -B)
        at, n = at + CLAMP, n + OF_CLAMP
    return 0.0


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Exact second derivatives of the energy; see the module."""
    H11, H12, H21, H22 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    curves, at, n = index[1], HEADER, 0
    for _ in range(index[0]):
        i, j, k, s = index[at], index[at + 1], index[at + 2], index[at + 3]
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), params[n])
        t2, l2 = tangent_of_segment(between_nodes(q, j, k), params[n])
        B, slope = _stiffness(_curvature(t1, t2, params[n + 1]), params[n + 1], params, curves, index[at + 4], index[at + 5])
        y1, y2 = slope_of_turn(1.0, l1, t1, t2), slope_of_turn(1.0, l2, t2, t1)
        own_block(H11, B, l1, t1, t2)
        own_block(H22, B, l2, t2, t1)
        cross_block(H12, -B / (l1 * l2), t1, t2)
        cross_block(H21, -B / (l1 * l2), t2, t1)
        _add_product(H11, slope, y1, y1)
        _add_product(H12, slope, y1, y2)
        _add_product(H21, slope, y2, y1)
        _add_product(H22, slope, y2, y2)
        assemble_pair(c_q, i, j, k, s, H11, H12, H21, H22, D, near, far)
        at, n = at + PAIR, n + OF_PAIR
    while at < index.shape[0]:
        c = _direction(params, n + 3)
        t1, l1 = tangent_of_segment(between_nodes(q, index[at], index[at + 1]), params[n])
        B, slope = _stiffness(_curvature(c, t1, params[n + 1]), params[n + 1], params, curves, index[at + 2], index[at + 3])
        y1 = slope_of_turn(1.0, l1, t1, c)
        own_block(H11, B, l1, t1, c)
        _add_product(H11, slope, y1, y1)
        add_clamp_block(c_q, index[at + 1], H11, D)
        at, n = at + CLAMP, n + OF_CLAMP


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """Sum of L U [J]."""
    total, curves, at, n = 0.0, index[1], HEADER, 0
    for _ in range(index[0]):
        t1, _ = tangent_of_segment(between_nodes(q, index[at], index[at + 1]), params[n])
        t2, _ = tangent_of_segment(between_nodes(q, index[at + 1], index[at + 2]), params[n])
        total += params[n + 1] * _bent(_curvature(t1, t2, params[n + 1]), params, curves, index[at + 4], index[at + 5])[2]
        at, n = at + PAIR, n + OF_PAIR
    while at < index.shape[0]:
        t1, _ = tangent_of_segment(between_nodes(q, index[at], index[at + 1]), params[n])
        kappa = _curvature(_direction(params, n + 3), t1, params[n + 1])
        total += params[n + 1] * _bent(kappa, params, curves, index[at + 2], index[at + 3])[2]
        at, n = at + CLAMP, n + OF_CLAMP
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Forces over a whole step as discrete gradients of the energy, with the numerical damper; see the module and `bending`."""
    H11, H12, H21, H22 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    by_method, curves, at, n = 0.0, index[1], HEADER, 0
    for _ in range(index[0]):
        i, j, k, s = index[at], index[at + 1], index[at + 2], index[at + 3]
        L0, L, alpha = params[n], params[n + 1], damper_of_bending(h, params[n + 2])
        t1a, t1, l1a, l1, S1, e1, turn1 = step_of(base, q, i, j, L0)
        t2a, t2, l2a, l2, S2, e2, turn2 = step_of(base, q, j, k, L0)
        a, b = _curvature(t1a, t2a, L), _curvature(t1, t2, L)
        B, slope = _stiffness_over_step(a, b, L, params, curves, index[at + 4], index[at + 5])
        bend = combined(1.0, turn2, -1.0, turn1)
        share = share_of_own(l1a, l2a, L0)
        w1 = mean_bend(share, t1a, t1, t2a, t2, alpha, bend)
        w2 = mean_bend(share, t2a, t2, t1a, t1, -alpha, bend)
        u1, u2 = projected(-S1, e1, w1), projected(-S2, e2, w2)
        add_row(f, i, u1, B)
        add_row(f, j, u1, -B)
        add_row(f, j, u2, B)
        add_row(f, k, u2, -B)
        by_method += alpha * B * dot(bend, bend)
        y1, y2 = slope_of_turn(1.0, l1, t1, t2), slope_of_turn(1.0, l2, t2, t1)
        own_step_block(H11, B, S1, e1, t1, l1a, l1, w1)
        add_turn_block(H11, (0.5 * share + alpha) * B, S1, e1, t1, l1)
        own_step_block(H22, B, S2, e2, t2, l2a, l2, w2)
        add_turn_block(H22, (0.5 * share + alpha) * B, S2, e2, t2, l2)
        H12[:, :] = 0.0
        H21[:, :] = 0.0
        add_turn_block(H12, -(0.5 + alpha) * B, S1, e1, t2, l2)
        add_turn_block(H21, -(0.5 + alpha) * B, S2, e2, t1, l1)
        _add_product(H11, slope, u1, y1)
        _add_product(H12, slope, u1, y2)
        _add_product(H21, slope, u2, y1)
        _add_product(H22, slope, u2, y2)
        assemble_pair(1.0, i, j, k, s, H11, H12, H21, H22, D, near, far)
        at, n = at + PAIR, n + OF_PAIR
    while at < index.shape[0]:
        i, j, c = index[at], index[at + 1], _direction(params, n + 3)
        L0, L, alpha = params[n], params[n + 1], damper_of_bending(h, params[n + 2])
        t1a, t1, l1a, l1, S1, e1, turn1 = step_of(base, q, i, j, L0)
        a, b = _curvature(c, t1a, L), _curvature(c, t1, L)
        B, slope = _stiffness_over_step(a, b, L, params, curves, index[at + 2], index[at + 3])
        share = share_of_own(l1a, l1a, L0)
        w1 = mean_bend(share, t1a, t1, c, c, -alpha, turn1)
        u1 = projected(-S1, e1, w1)
        add_row(f, i, u1, B)
        add_row(f, j, u1, -B)
        by_method += alpha * B * dot(turn1, turn1)
        own_step_block(H11, B, S1, e1, t1, l1a, l1, w1)
        add_turn_block(H11, (0.5 * share + alpha) * B, S1, e1, t1, l1)
        _add_product(H11, slope, u1, slope_of_turn(1.0, l1, t1, c))
        add_clamp_block(1.0, j, H11, D)
        at, n = at + CLAMP, n + OF_CLAMP
    return 0.0, by_method
