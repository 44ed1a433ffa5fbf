"""The linear system over the free points: block elimination in an order of least fill."""

from anet_lumped.compiled.jit import inlined, internal
from anet_lumped.mechanics.optional import as_solve_fronts
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import KERNEL_SOLVE_FRONTS


@inlined
def add_block(block, m, sign):
    """Add ``sign`` times a matrix (9,) to a 3x3 block."""
    for x in range(3):
        for y in range(3):
            block[x, y] += sign * m[3 * x + y]


@inlined
def _factor(M):
    """Overwrite a 3x3 block by its LU factors. The diagonal of L is 1 and not stored; that of U is stored as its inverse."""
    M[0, 0] = 1.0 / M[0, 0]
    M[1, 0] *= M[0, 0]
    M[2, 0] *= M[0, 0]
    M[1, 1] = 1.0 / (M[1, 1] - M[1, 0] * M[0, 1])
    M[1, 2] -= M[1, 0] * M[0, 2]
    M[2, 1] = (M[2, 1] - M[2, 0] * M[0, 1]) * M[1, 1]
    M[2, 2] = 1.0 / (M[2, 2] - M[2, 0] * M[0, 2] - M[2, 1] * M[1, 2])


@inlined
def _solved(M, x, y, z):
    """M^-1 (x, y, z) for a factored block."""
    y -= M[1, 0] * x
    z -= M[2, 0] * x + M[2, 1] * y
    z *= M[2, 2]
    y = (y - M[1, 2] * z) * M[1, 1]
    return (x - M[0, 1] * y - M[0, 2] * z) * M[0, 0], y, z


@internal
def solve_points(net_address):
    """Solve the system over the free points, many of them by `fronts`; write ``net.newton_step``."""
    net = view_net(net_address)
    if net.points.fronts.front.shape[0] > 0:
        as_solve_fronts(net.kernels[KERNEL_SOLVE_FRONTS])(net_address)
        return
    solve_blocks(net.points, net.right_side, net.newton_step, net.n_interior)


@inlined
def solve_blocks(points, right_side, step, base):
    """Solve a system by block LU in its elimination order; the rows of ``right_side`` and ``step`` begin at ``base``.

    `model.net.Points` describes the blocks. They are factored and never inverted: where a stiff cable joins two points, the
    condition number of their block is the ratio of stiffness to inertia, and an inverse would lose three times as many digits.
    """
    block, points_free = points.block, points.later_at.shape[0] - 1
    for e in range(points_free):
        p = points.order[e]
        M, rp = block[p], right_side[base + p]
        _factor(M)
        rp[0], rp[1], rp[2] = _solved(M, rp[0], rp[1], rp[2])
        first, last, target = points.later_at[e], points.later_at[e + 1], points.target_at[e]
        for j in range(first, last):
            U = block[points.upper[j]]
            for i in range(3):
                U[0, i], U[1, i], U[2, i] = _solved(M, U[0, i], U[1, i], U[2, i])
        for i in range(first, last):
            L, rq = block[points.lower[i]], right_side[base + points.later[i]]
            for x in range(3):
                rq[x] -= L[x, 0] * rp[0] + L[x, 1] * rp[1] + L[x, 2] * rp[2]
            for j in range(first, last):
                S, U = block[points.target[target]], block[points.upper[j]]
                for x in range(3):
                    for y in range(3):
                        S[x, y] -= L[x, 0] * U[0, y] + L[x, 1] * U[1, y] + L[x, 2] * U[2, y]
                target += 1
    for e in range(points_free - 1, -1, -1):
        p = points.order[e]
        d = step[base + p]
        d[0], d[1], d[2] = right_side[base + p, 0], right_side[base + p, 1], right_side[base + p, 2]
        for j in range(points.later_at[e], points.later_at[e + 1]):
            U, step_later = block[points.upper[j]], step[base + points.later[j]]
            for x in range(3):
                d[x] -= U[x, 0] * step_later[0] + U[x, 1] * step_later[1] + U[x, 2] * step_later[2]
