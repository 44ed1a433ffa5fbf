"""The system of `chain` with effects that join neighbours along a cable: a block-banded elimination, O(n) too.

To the system of `chain` come general 3x3 blocks between neighbours (``net.near``) and next-but-one neighbours (``net.far``) of a
cable. Unknowns are ordered T_0, d_1, T_1, d_2, ..., T_(N-1): each node's displacement and the tension of the segment ahead of
it, for the reason given in `chain`. Their matrix has half a bandwidth of 6 or 10, and is factored without pivoting: a tension's
pivot is 1 + k g . M^-1 e > 0. A cable's interior follows from its ends,

    x = X_0 + X_e d_end + X_s d_start + X_T T_0 ,

whose columns are found for all that are needed at once: the last two for a cable between two free points only, whose first
tension stays an unknown until its ends are known; otherwise T_0 is the first of x. What is left to the ends goes to the free
points' blocks. Source: Golub & Van Loan, Matrix Computations (2013), 4.3.
"""

import numpy as np
from numba import njit

from .chain import _single, solve_points
from .elimination import (
    BORDERED,
    DIRECTION,
    END,
    END_START,
    FIRST_NODE,
    FIRST_SEGMENT,
    GEOMETRIC,
    GRADIENT,
    SEGMENTS,
    START,
    START_END,
    STIFFNESS,
    TENSION,
)
from .net import COLUMNS, HALF_BAND, net_at


@njit(cache=True, error_model="numpy")
def _add(band, width, row, column, K):
    """Add a 3x3 block whose first number stands at (row, column)."""
    for x in range(3):
        for y in range(3):
            band[row + x, width + column + y - row - x] += K[x, y]


@njit(cache=True, error_model="numpy")
def _add_to_columns(X, row, column, K):
    """Move a 3x3 block of the matrix to the right-hand side, to the columns from ``column`` on."""
    for x in range(3):
        for y in range(3):
            X[row + x, column + y] -= K[x, y]


@njit(cache=True, error_model="numpy")
def _assemble(net, c, band, X, width):
    """Matrix of a cable's interior, and its right-hand sides."""
    first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
    bordered, far = net.cable[c, BORDERED] == 1, net.far.shape[0] > 0
    band[:, :] = 0.0
    X[:, :] = 0.0
    for j in range(1, count):  # node j of the cable, at 4 j - 3
        at = 4 * j - 3
        _add(band, width, at, at, net.diagonal[node + j - 1])
        for x in range(3):
            X[at + x, 0] = net.right[node + j - 1, x]
    for j in range(count):  # segment j, from node j to node j + 1; its tension at 4 j
        row, s = net.segment[first + j], first + j
        a, k = row[GEOMETRIC], row[STIFFNESS]
        e, g = row[DIRECTION : DIRECTION + 3], row[GRADIENT : GRADIENT + 3]
        T, before, after = 4 * j, 4 * j - 3, 4 * j + 1
        carried = j == 0 and bordered
        band[T, width] = 1.0
        if not carried:
            X[T, 0] = row[TENSION]
        for x in range(3):
            if j > 0:
                band[before + x, width] += a
                band[before + x, width + T - before - x] = -e[x]
                band[T, width + before + x - T] = k * g[x]
            if j < count - 1:
                band[after + x, width] += a
                if carried:
                    X[after + x, 7] -= e[x]
                else:
                    band[after + x, width + T - after - x] = e[x]
                    band[T, width + after + x - T] = -k * g[x]
            elif not carried:
                X[T, 1 + x] += k * g[x]
            if 0 < j < count - 1:
                band[before + x, width + after - before] -= a
                band[after + x, width + before - after] -= a
            elif j == 0 and count > 1:
                X[after + x, 4 + x] += a
            if j == count - 1 and j > 0:
                X[before + x, 1 + x] += a
        if 0 < j < count - 1:
            _add(band, width, before, after, net.near[s, 0])
            _add(band, width, after, before, net.near[s, 1])
        elif j == 0:
            _add_to_columns(X, after, 4, net.near[s, 1])
        else:
            _add_to_columns(X, before, 1, net.near[s, 0])
        if far and j < count - 1:  # between nodes j and j + 2
            i2 = 4 * j + 5
            if 0 < j < count - 2:
                _add(band, width, before, i2, net.far[s, 0])
                _add(band, width, i2, before, net.far[s, 1])
            elif j == 0 and count > 2:
                _add_to_columns(X, i2, 4, net.far[s, 1])
            elif j > 0:
                _add_to_columns(X, before, 1, net.far[s, 0])


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _solve_band(band, X, width):
    """Factor the matrix in place, without pivoting, and solve for all columns of X in place."""
    n, columns = band.shape[0], X.shape[1]
    for i in range(n):
        per = 1.0 / band[i, width]
        band[i, width] = per
        for r in range(i + 1, min(n, i + width + 1)):
            L = band[r, width + i - r] * per
            if L == 0.0:
                continue
            for j in range(1, width + 1):
                band[r, width + i - r + j] -= L * band[i, width + j]
            for x in range(columns):
                X[r, x] -= L * X[i, x]
    for i in range(n - 1, -1, -1):
        for j in range(1, min(width, n - 1 - i) + 1):
            U = band[i, width + j]
            if U != 0.0:
                for x in range(columns):
                    X[i, x] -= U * X[i + j, x]
        for x in range(columns):
            X[i, x] *= band[i, width]


@njit(cache=True, error_model="numpy")
def _gather(rows, K, X, at):
    """rows -= K times the rows of X from ``at`` on: what a neighbour's displacement brings to an end."""
    for x in range(3):
        for y in range(3):
            for u in range(COLUMNS):
                rows[x, u] -= K[x, y] * X[at + y, u]


@njit(cache=True, error_model="numpy")
def _hand_over(net, c, X, rows):
    """Give what a solved cable looks like to its ends to the free points' blocks and right-hand sides.

    ``rows`` (7, 8) scratch: force on the start, its first tension, and force on the end, in terms of (1, d_end, d_start, T_0).
    """
    first, count, start, end = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, START], net.cable[c, END]
    bordered, far, last = net.cable[c, BORDERED] == 1, net.far.shape[0] > 0, first + count - 1
    rows[:, :] = 0.0
    at_start, tension, at_end = rows[:3], rows[3], rows[4:]
    row, T, d = net.segment[last], 4 * count - 4, 4 * count - 7
    for x in range(3):
        at_end[x, 1 + x] -= row[GEOMETRIC]
        for u in range(COLUMNS):
            at_end[x, u] += row[GEOMETRIC] * X[d + x, u] - row[DIRECTION + x] * X[T, u]
    _gather(at_end, net.near[last, 1], X, d)
    if far and count > 2:
        _gather(at_end, net.far[last - 1, 1], X, d - 4)
    if not bordered:
        if end < net.n_free:
            S, b = net.points.block[end - net.n_interior], net.right[end]
            for x in range(3):
                b[x] += at_end[x, 0]
                for y in range(3):
                    S[x, y] -= at_end[x, 1 + y]
        return
    row = net.segment[first]
    a, k = row[GEOMETRIC], row[STIFFNESS]
    for x in range(3):
        at_start[x, 4 + x] -= a
        at_start[x, 7] += row[DIRECTION + x]
        tension[4 + x] -= k * row[GRADIENT + x]
        for u in range(COLUMNS):
            at_start[x, u] += a * X[1 + x, u]
            tension[u] += k * row[GRADIENT + x] * X[1 + x, u]
    _gather(at_start, net.near[first, 0], X, 1)
    if far and count > 2:
        _gather(at_start, net.far[first, 0], X, 5)
    elif far:
        for x in range(3):
            for y in range(3):
                at_start[x, 1 + y] -= net.far[first, 0, x, y]
                at_end[x, 4 + y] -= net.far[first, 1, x, y]
    tension[0] += row[TENSION]
    per = 1.0 / (1.0 - tension[7])
    tie = net.factor[first]  # T_0 = tie . (d_end, d_start) + constant, as in `chain`
    for u in range(6):
        tie[u] = per * tension[1 + u]
    tie[6] = per * tension[0]
    blocks, p, e = net.points.block, start - net.n_interior, end - net.n_interior
    for x in range(3):
        net.right[start, x] += at_start[x, 0] + at_start[x, 7] * tie[6]
        net.right[end, x] += at_end[x, 0] + at_end[x, 7] * tie[6]
        for y in range(3):
            blocks[p, x, y] -= at_start[x, 4 + y] + at_start[x, 7] * tie[3 + y]
            blocks[net.cable[c, START_END], x, y] -= at_start[x, 1 + y] + at_start[x, 7] * tie[y]
            blocks[net.cable[c, END_START], x, y] -= at_end[x, 4 + y] + at_end[x, 7] * tie[3 + y]
            blocks[e, x, y] -= at_end[x, 1 + y] + at_end[x, 7] * tie[y]


@njit(cache=True, error_model="numpy")
def _add_single(net, c):
    """Blocks of a cable of one segment, which go straight to its ends."""
    s = net.cable[c, FIRST_SEGMENT]
    if net.cable[c, BORDERED] == 1:
        net.points.block[net.cable[c, START_END]] += net.near[s, 0]
        net.points.block[net.cable[c, END_START]] += net.near[s, 1]


@njit(cache=True, error_model="numpy")
def solve_wide(place):
    """Solve the linear system of the module's docstring for ``net.step`` and ``net.tension``; overwrites ``net.right``.

    Returns the smallest tension [N].
    """
    net = net_at(place)
    block, step, smallest = net.points.block, net.step, np.inf
    width = HALF_BAND[2] if net.far.shape[0] > 0 else HALF_BAND[1]
    block[net.n_free - net.n_interior :] = 0.0
    for p in range(net.n_free - net.n_interior):
        block[p] = net.diagonal[net.n_interior + p]
    for c in range(net.cable.shape[0]):
        count, at = net.cable[c, SEGMENTS], 4 * net.cable[c, FIRST_NODE] + c
        if count == 1:
            _single(place, c)
            _add_single(net, c)
            continue
        band, X = net.band[at : at + 4 * count - 3, : 2 * width + 1], net.columns[at : at + 4 * count - 3]
        _assemble(net, c, band, X, width)
        _solve_band(band, X, width)
        _hand_over(net, c, X, net.ends)
    solve_points(place)
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        d0, d1 = step[net.cable[c, START]], step[net.cable[c, END]]
        row, X, T = net.segment[first], net.columns[4 * node + c :], net.tension[first : first + count]
        bordered, tie = net.cable[c, BORDERED] == 1, net.factor[first]
        if count == 1:
            T[0] = row[TENSION]
            for x in range(3):
                T[0] += row[STIFFNESS] * row[GRADIENT + x] * (d1[x] - d0[x])
            smallest = min(smallest, T[0])
            continue
        T_0 = 0.0
        if bordered:
            T_0 = tie[6]
            for x in range(3):
                T_0 += tie[x] * d1[x] + tie[3 + x] * d0[x]
        for i in range(4 * count - 3):
            value = X[i, 0] + X[i, 7] * T_0
            for x in range(3):
                value += X[i, 1 + x] * d1[x] + X[i, 4 + x] * d0[x]
            if i % 4 == 0:
                T[i // 4] = value
            else:
                step[node + i // 4, i % 4 - 1] = value
        if bordered:
            T[0] = T_0
        for j in range(count):
            smallest = min(smallest, T[j])
    return smallest
