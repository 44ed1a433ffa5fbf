"""The linear system over many free points: multifrontal block LU, see `model.fronts`; compiled when a scene first needs it.

A front is a dense matrix and, as one more column, its right side, which is eliminated with it. Its rows are longer than that by
three unused numbers, so that a row may be worked on from any column on, four numbers at a time.
"""

from anet_lumped.compiled.jit import inlined, internal, on_demand
from anet_lumped.compiled.lanes import WIDTH, sum_of_lanes
from anet_lumped.compiled.rows_of_lanes import load_row, store_row
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    FRONT_FIRST_ENTRY,
    FRONT_FIRST_FACTOR,
    FRONT_FIRST_IN_SUBTREE,
    FRONT_FIRST_POINT,
    FRONT_PIVOTS,
    FRONT_ROWS,
    FRONT_WAITING_AT,
)
from integrators.flat_view import part


@inlined
def _subtract(F, row, factor, other, first, size):
    """Subtract ``factor`` times the row of a front at the address ``other`` from that at ``row``, from column ``first`` on."""
    for j in range(first, size + 1, WIDTH):
        store_row(F, row + j, load_row(F, row + j) - factor * load_row(F, other + j))


@internal
def _eliminate(F, size, width, pivots):
    """Eliminate the first ``pivots`` rows of a front by three at a time; the diagonal of U is stored as its inverse, L is not.

    As in `junctions`, rows are not exchanged.
    """
    for k in range(0, pivots, 3):
        p, q, r = k * width, (k + 1) * width, (k + 2) * width
        F[p + k] = 1.0 / F[p + k]
        _subtract(F, q, F[q + k] * F[p + k], p, k + 1, size)
        F[q + k + 1] = 1.0 / F[q + k + 1]
        _subtract(F, r, F[r + k] * F[p + k], p, k + 1, size)
        _subtract(F, r, F[r + k + 1] * F[q + k + 1], q, k + 2, size)
        F[r + k + 2] = 1.0 / F[r + k + 2]
        d0, d1, d2, u01, u02, u12 = F[p + k], F[q + k + 1], F[r + k + 2], F[p + k + 1], F[p + k + 2], F[q + k + 2]
        for i in range(k + 3, size, 3):
            a, b, c = i * width, (i + 1) * width, (i + 2) * width
            a0, b0, c0 = F[a + k] * d0, F[b + k] * d0, F[c + k] * d0
            a1, b1, c1 = (F[a + k + 1] - a0 * u01) * d1, (F[b + k + 1] - b0 * u01) * d1, (F[c + k + 1] - c0 * u01) * d1
            a2, b2 = (F[a + k + 2] - a0 * u02 - a1 * u12) * d2, (F[b + k + 2] - b0 * u02 - b1 * u12) * d2
            c2 = (F[c + k + 2] - c0 * u02 - c1 * u12) * d2
            for j in range(k + 3, size + 1, WIDTH):
                u, v, w = load_row(F, p + j), load_row(F, q + j), load_row(F, r + j)
                store_row(F, a + j, load_row(F, a + j) - a0 * u - a1 * v - a2 * w)
                store_row(F, b + j, load_row(F, b + j) - b0 * u - b1 * v - b2 * w)
                store_row(F, c + j, load_row(F, c + j) - c0 * u - c1 * v - c2 * w)


@internal
def _assemble(points, right_side, f, F, size, width):
    """Write a front: the blocks and right sides of its pivots, and what its children left."""
    fronts = points.fronts
    front, n_entries = fronts.front, fronts.entry.shape[0]
    F[:] = 0.0
    last = front[f + 1, FRONT_FIRST_ENTRY] if f + 1 < front.shape[0] else n_entries
    for e in range(front[f, FRONT_FIRST_ENTRY], last):
        block, i, j = points.block[fronts.entry[e, 0]], 3 * fronts.entry[e, 1], 3 * fronts.entry[e, 2]
        for x in range(3):
            for y in range(3):
                F[(i + x) * width + j + y] = block[x, y]
    for i in range(front[f, FRONT_PIVOTS]):
        for x in range(3):
            F[(3 * i + x) * width + size] = right_side[fronts.point[front[f, FRONT_FIRST_POINT] + i], x]
    child = f - 1
    while child >= front[f, FRONT_FIRST_IN_SUBTREE]:
        rows = front[child, FRONT_ROWS]
        of, long = part(fronts.in_parent, front[child, FRONT_FIRST_POINT] + front[child, FRONT_PIVOTS], rows), 3 * rows + 1
        for i in range(rows):
            for x in range(3):
                row = part(F, (3 * of[i] + x) * width, width)
                left = part(fronts.waiting, front[child, FRONT_WAITING_AT] + long * (3 * i + x), long)
                for j in range(rows):
                    for y in range(3):
                        row[3 * of[j] + y] += left[3 * j + y]
                row[size] += left[long - 1]
        child = front[child, FRONT_FIRST_IN_SUBTREE] - 1


@on_demand
def solve_fronts(net_address):
    """Solve the system over the free points front by front; write ``net.newton_step``.

    A front of s pivots and r rows leaves s rows of U in ``fronts.factor``, and the r x (r + 1) rest in ``fronts.waiting``, until
    the front behind it takes it.
    """
    net = view_net(net_address)
    points, fronts = net.points, net.points.fronts
    front, right_side, step = fronts.front, net.right_side[net.n_interior :], net.newton_step[net.n_interior :]
    for f in range(front.shape[0]):
        pivots, rows = 3 * front[f, FRONT_PIVOTS], 3 * front[f, FRONT_ROWS]
        size = pivots + rows
        width = size + WIDTH
        F = part(fronts.dense, 0, size * width)
        _assemble(points, right_side, f, F, size, width)
        _eliminate(F, size, width, pivots)
        upper = part(fronts.factor, front[f, FRONT_FIRST_FACTOR], pivots * width)
        for i in range(pivots * width):
            upper[i] = F[i]
        left = part(fronts.waiting, front[f, FRONT_WAITING_AT], rows * (rows + 1))
        for i in range(rows):
            row = part(F, (pivots + i) * width + pivots, rows + 1)
            for j in range(rows + 1):
                left[i * (rows + 1) + j] = row[j]
    for f in range(front.shape[0] - 1, -1, -1):
        pivots, size = 3 * front[f, FRONT_PIVOTS], 3 * (front[f, FRONT_PIVOTS] + front[f, FRONT_ROWS])
        width, point = size + WIDTH, part(fronts.point, front[f, FRONT_FIRST_POINT], size // 3)
        upper, local = part(fronts.factor, front[f, FRONT_FIRST_FACTOR], pivots * width), part(fronts.dense, 0, width)
        local[size:] = 0.0
        local[size] = -1.0  # that of the right side, so that a row is one sum
        for i in range(pivots, size):
            local[i] = step[point[i // 3], i % 3]
        for i in range(pivots - 1, -1, -1):
            taken = 0.0 * load_row(upper, i * width + i)
            for j in range(i + 1, size + 1, WIDTH):
                taken = taken + load_row(upper, i * width + j) * load_row(local, j)
            local[i] = -sum_of_lanes(taken) * upper[i * width + i]
            step[point[i // 3], i % 3] = local[i]
