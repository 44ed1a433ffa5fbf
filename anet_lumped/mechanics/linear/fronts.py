"""The linear system over many free points: multifrontal block LU, see `model.fronts`; compiled when a scene first needs it."""

from anet_lumped.compiled.jit import inlined, internal, on_demand
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

PANEL = (
    24  # columns that are factored before the rest of a front hears of them: three rows of 24 numbers stay in the registers' reach
)


@inlined
def _subtract_products(F, size, first, last):
    """F[i, j] -= F[i, first:last] F[first:last, j] for all i, j from ``last`` on, three rows and three columns at a time."""
    for i in range(last, size, 3):
        a, b, c = part(F, i * size, size), part(F, (i + 1) * size, size), part(F, (i + 2) * size, size)
        for k in range(first, last, 3):
            u, v, w = part(F, k * size, size), part(F, (k + 1) * size, size), part(F, (k + 2) * size, size)
            a0, a1, a2 = a[k], a[k + 1], a[k + 2]
            b0, b1, b2 = b[k], b[k + 1], b[k + 2]
            c0, c1, c2 = c[k], c[k + 1], c[k + 2]
            for j in range(last, size):
                x, y, z = u[j], v[j], w[j]
                a[j] -= a0 * x + a1 * y + a2 * z
                b[j] -= b0 * x + b1 * y + b2 * z
                c[j] -= c0 * x + c1 * y + c2 * z


@internal
def _eliminate(F, size, pivots):
    """Eliminate the first ``pivots`` rows of a dense matrix (size * size,), by panels; the diagonal of U is stored as its inverse.

    As in `junctions`, rows are not exchanged.
    """
    for first in range(0, pivots, PANEL):
        last = min(first + PANEL, pivots)
        for k in range(first, last):
            upper = part(F, k * size, size)
            upper[k] = 1.0 / upper[k]
            for i in range(k + 1, size):
                row = part(F, i * size, size)
                row[k] *= upper[k]
                for j in range(k + 1, last):
                    row[j] -= row[k] * upper[j]
        for k in range(first, last):
            upper = part(F, k * size, size)
            for i in range(k + 1, last):
                row = part(F, i * size, size)
                for j in range(last, size):
                    row[j] -= row[k] * upper[j]
        _subtract_products(F, size, first, last)


@internal
def _assemble(points, f, F, size):
    """Write a front: the blocks of its pivots, and what its children left."""
    fronts = points.fronts
    front, n_entries = fronts.front, fronts.entry.shape[0]
    F[:] = 0.0
    last = front[f + 1, FRONT_FIRST_ENTRY] if f + 1 < front.shape[0] else n_entries
    for e in range(front[f, FRONT_FIRST_ENTRY], last):
        block, i, j = points.block[fronts.entry[e, 0]], 3 * fronts.entry[e, 1], 3 * fronts.entry[e, 2]
        for x in range(3):
            for y in range(3):
                F[(i + x) * size + j + y] = block[x, y]
    child = f - 1
    while child >= front[f, FRONT_FIRST_IN_SUBTREE]:
        rows = front[child, FRONT_ROWS]
        of = part(fronts.in_parent, front[child, FRONT_FIRST_POINT] + front[child, FRONT_PIVOTS], rows)
        for i in range(rows):
            for x in range(3):
                row = part(F, (3 * of[i] + x) * size, size)
                left = part(fronts.waiting, front[child, FRONT_WAITING_AT] + 3 * rows * (3 * i + x), 3 * rows)
                for j in range(rows):
                    for y in range(3):
                        row[3 * of[j] + y] += left[3 * j + y]
        child = front[child, FRONT_FIRST_IN_SUBTREE] - 1


@on_demand
def solve_fronts(net_address):
    """Solve the system over the free points front by front; write ``net.newton_step``. Overwrites ``net.right_side``.

    A front of s pivots and r rows leaves s rows of U, then r rows of L, in ``fronts.factor``, and the r x r rest in
    ``fronts.waiting``, until the front behind it takes it.
    """
    net = view_net(net_address)
    points, base = net.points, net.n_interior
    fronts = points.fronts
    front, right_side, step = fronts.front, net.right_side, net.newton_step
    local = part(fronts.dense, 0, 0)
    for f in range(front.shape[0]):
        pivots, rows = 3 * front[f, FRONT_PIVOTS], 3 * front[f, FRONT_ROWS]
        size, first = pivots + rows, front[f, FRONT_FIRST_POINT]
        F = part(fronts.dense, 0, size * size)
        _assemble(points, f, F, size)
        _eliminate(F, size, pivots)
        upper = part(fronts.factor, front[f, FRONT_FIRST_FACTOR], pivots * size)
        for i in range(pivots * size):
            upper[i] = F[i]
        left = part(fronts.waiting, front[f, FRONT_WAITING_AT], rows * rows)
        lower = part(fronts.factor, front[f, FRONT_FIRST_FACTOR] + pivots * size, rows * pivots)
        for i in range(rows):
            row = part(F, (pivots + i) * size, size)
            for k in range(pivots):
                lower[i * pivots + k] = row[k]
            for j in range(rows):
                left[i * rows + j] = row[pivots + j]
        local = part(fronts.dense, 0, pivots)  # the front is copied: its first row holds the right side of its pivots now
        for i in range(pivots):
            point = right_side[base + fronts.point[first + i // 3]]
            local[i] = point[i % 3]
            for k in range(i):
                local[i] -= upper[i * size + k] * local[k]
            point[i % 3] = local[i]
        for i in range(rows):
            taken = 0.0
            for k in range(pivots):
                taken += lower[i * pivots + k] * local[k]
            right_side[base + fronts.point[first + (pivots + i) // 3], i % 3] -= taken
    for f in range(front.shape[0] - 1, -1, -1):
        pivots, size = 3 * front[f, FRONT_PIVOTS], 3 * (front[f, FRONT_PIVOTS] + front[f, FRONT_ROWS])
        first, upper = front[f, FRONT_FIRST_POINT], part(fronts.factor, front[f, FRONT_FIRST_FACTOR], pivots * size)
        local = part(fronts.dense, 0, size)
        for i in range(pivots, size):
            local[i] = step[base + fronts.point[first + i // 3], i % 3]
        for i in range(pivots - 1, -1, -1):
            node, row = base + fronts.point[first + i // 3], part(upper, i * size, size)
            rest = right_side[node, i % 3]
            for k in range(i + 1, size):
                rest -= row[k] * local[k]
            local[i] = rest * row[i]
            step[node, i % 3] = local[i]
