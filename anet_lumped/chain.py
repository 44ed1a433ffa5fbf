"""Linear algebra of a net: each cable's interior is eliminated in O(n), then the free points.

One Newton step solves, for the displacements d of all moving nodes and the tensions T of all segments,

    D_i d_i + sum over segments at i of -+ [ a (d_j - d_i) + e T ] = r_i ,      T = T_0 + k g . (d_j - d_i) ,

where D_i holds inertia and external stiffness, a the geometric stiffness of the segment, e the direction in which its
tension acts, and k = dT/dl, 0 for a slack segment. Keeping the tension as an unknown until its node is eliminated makes every
number that occurs as large as inertia and tension, not as large as the stiffness: with M = D + a I,

    y = M^-1 e,   z = M^-T g,   rho = 1/(1 + k g . y),   T = rho [T_0 + k (g - a z) . d_next - k z . r_i]
    S = a I - a^2 M^-1 + rho k (e - a y)(g - a z)^T        is what the part behind looks like to the next node,

which is (G^-1 + D^-1)^-1 for the segment stiffness G = a I + k e g^T, after Sherman and Morrison.
"""

import numpy as np
from numba import njit

from .net import net_at

# Columns of the scratch table `Net.segment`, one row a segment: e and g of the docstring (three each), a, k, T_0; and for the
# law: the stretch before (of the old segment, or of its component along the new one), the stretch now, and the conservative
# part of the tension.
DIRECTION, GRADIENT, GEOMETRIC, STIFFNESS, TENSION = 0, 3, 6, 7, 8
BEFORE, STRETCH, SECANT = 9, 10, 11
# Columns of `Net.cable`.
FIRST_SEGMENT, SEGMENTS, FIRST_NODE, START, END, BORDERED, START_END, END_START = range(8)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def inverse(m):
    """Inverse of a 3x3 matrix, a tuple by rows, by LU without pivoting: backward stable for what is nearly symmetric
    positive definite, where the adjugate would lose twice the digits of the condition number.

    The eliminated rows keep the factor of their pivot (Bareiss), so that one division serves all three pivots.
    """
    m00, m01, m02, m10, m11, m12, m20, m21, m22 = m
    p11, p12 = m00 * m11 - m10 * m01, m00 * m12 - m10 * m02
    p21, p22 = m00 * m21 - m20 * m01, m00 * m22 - m20 * m02
    det = p11 * p22 - p12 * p21
    per = 1.0 / (m00 * p11 * det)
    per_00, per_11, i2 = per * p11 * det, per * m00 * det, per * (m00 * p11) * (m00 * p11)
    i1, l10, u12, l21 = per_11 * m00, per_00 * m10, per_00 * p12, per_11 * p21
    a01 = -per_00 * m01 * i1
    a12 = -i1 * u12 * i2
    a02 = per_00 * (m01 * u12 * i1 - m02) * i2
    b20 = l10 * l21 - per_00 * m20
    return (
        per_00 - a01 * l10 + a02 * b20, a01 - a02 * l21, a02,
        -i1 * l10 + a12 * b20, i1 - a12 * l21, a12,
        i2 * b20, -i2 * l21, i2,
    )  # fmt: skip


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _add(block, m, sign):
    for x in range(3):
        for y in range(3):
            block[x, y] += sign * m[3 * x + y]


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _times(m, x, y, z):
    return (
        m[0] * x + m[1] * y + m[2] * z,
        m[3] * x + m[4] * y + m[5] * z,
        m[6] * x + m[7] * y + m[8] * z,
    )


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _stiffness(row):
    """Stiffness a I + k e g^T of a segment, by rows."""
    a, k = row[GEOMETRIC], row[STIFFNESS]
    ex, ey, ez = k * row[0], k * row[1], k * row[2]
    gx, gy, gz = row[3], row[4], row[5]
    return (
        a + ex * gx, ex * gy, ex * gz, ey * gx, a + ey * gy, ey * gz, ez * gx, ez * gy, a + ez * gz,
    )  # fmt: skip


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _first(net, c):
    """What the first segment of cable c adds to the first interior node: stiffness by rows, then right-hand side."""
    row = net.segment[net.cable[c, FIRST_SEGMENT]]
    G, T = _stiffness(row), row[TENSION]
    return (*G, -row[0] * T, -row[1] * T, -row[2] * T)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _pass(state, D, r, row, out):
    """Eliminate a node, with stiffness D and right-hand side r of its own, through the segment ahead of it.

    ``state`` is what lies behind, as `_first` gives it; writes how the node follows the next one to ``out``. Returns what the
    next node sees behind it, and M^-1, y, z, rho k of the docstring of the module.
    """
    s00, m01, m02, m10, s11, m12, m20, m21, s22, r0, r1, r2 = state
    a, k, ex, ey, ez, gx, gy, gz = row[GEOMETRIC], row[STIFFNESS], row[0], row[1], row[2], row[3], row[4], row[5]
    r0, r1, r2 = r0 + r[0], r1 + r[1], r2 + r[2]
    m00, m01, m02 = s00 + D[0, 0] + a, m01 + D[0, 1], m02 + D[0, 2]
    m10, m11, m12 = m10 + D[1, 0], s11 + D[1, 1] + a, m12 + D[1, 2]
    m20, m21, m22 = m20 + D[2, 0], m21 + D[2, 1], s22 + D[2, 2] + a
    # LU whose rows keep the factor of their pivot (Bareiss): pivots m00, p11, det serve one division, and g . y =
    # (g0 e0 p11 det + f1 h1 det + f2 h2)/(m00 p11 det) does not wait for it
    p11, p12 = m00 * m11 - m10 * m01, m00 * m12 - m10 * m02
    p21, p22 = m00 * m21 - m20 * m01, m00 * m22 - m20 * m02
    f1, h1 = m00 * ey - m10 * ex, m00 * gy - m01 * gx
    f2, h2 = p11 * (m00 * ez - m20 * ex) - p21 * f1, p11 * (m00 * gz - m02 * gx) - p12 * h1
    det, m_p = p11 * p22 - p12 * p21, m00 * p11
    whole = m_p * det
    rho = whole / (whole + k * (gx * ex * (p11 * det) + f1 * h1 * det + f2 * h2))
    per = 1.0 / whole
    i0, i1, i2 = per * p11 * det, per * m00 * m00 * det, per * m_p * m_p
    l10, u12, l21 = i0 * m10, i0 * p12, per * m00 * det * p21
    a01, a12 = -i0 * m01 * i1, -i1 * u12 * i2
    a02, b20 = i0 * (m01 * u12 * i1 - m02) * i2, l10 * l21 - i0 * m20
    M = (
        i0 - a01 * l10 + a02 * b20, a01 - a02 * l21, a02,
        -i1 * l10 + a12 * b20, i1 - a12 * l21, a12,
        i2 * b20, -i2 * l21, i2,
    )  # fmt: skip
    yx, yy, yz = _times(M, ex, ey, ez)
    zx = M[0] * gx + M[3] * gy + M[6] * gz
    zy = M[1] * gx + M[4] * gy + M[7] * gz
    zz = M[2] * gx + M[5] * gy + M[8] * gz
    ux, uy, uz = _times(M, r0, r1, r2)
    T, rho = rho * (row[TENSION] - k * (zx * r0 + zy * r1 + zz * r2)), rho * k
    wx, wy, wz = rho * (gx - a * zx), rho * (gy - a * zy), rho * (gz - a * zz)
    # d = H d_next + h and T = w . d_next + T
    H00, H01, H02 = a * M[0] + yx * wx, a * M[1] + yx * wy, a * M[2] + yx * wz
    H10, H11, H12 = a * M[3] + yy * wx, a * M[4] + yy * wy, a * M[5] + yy * wz
    H20, H21, H22 = a * M[6] + yz * wx, a * M[7] + yz * wy, a * M[8] + yz * wz
    hx, hy, hz = ux + yx * T, uy + yy * T, uz + yz * T
    out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7], out[8] = H00, H01, H02, H10, H11, H12, H20, H21, H22
    out[9], out[10], out[11], out[12], out[13], out[14], out[15] = hx, hy, hz, wx, wy, wz, T
    # S = a (I - H) + e w^T, and the right-hand side that goes with it
    ahead = (
        a - a * H00 + ex * wx, ex * wy - a * H01, ex * wz - a * H02,
        ey * wx - a * H10, a - a * H11 + ey * wy, ey * wz - a * H12,
        ez * wx - a * H20, ez * wy - a * H21, a - a * H22 + ez * wz,
        a * hx - ex * T, a * hy - ey * T, a * hz - ez * T,
    )  # fmt: skip
    return ahead, M, (yx, yy, yz), (zx, zy, zz), rho


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _finish(net, c, state):
    """Hand what cable c looks like from its end to its end point, if that is free."""
    end = net.cable[c, END]
    if end < net.n_free:
        S, b = net.points.block[end - net.n_interior], net.right[end]
        for x in range(3):
            S[x, 0] += state[3 * x]
            S[x, 1] += state[3 * x + 1]
            S[x, 2] += state[3 * x + 2]
            b[x] += state[9 + x]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def eliminate_cables(place):
    """Eliminate the interior of every cable; adds what each looks like to ``net.points.block`` and ``net.right``.

    Reads ``net.segment``, ``net.diagonal`` and ``net.right``; writes ``net.factor`` and ``net.border``. A node waits for the
    one before it and little else does, so two cables of one length are eliminated side by side.
    """
    net = net_at(place)
    diagonal, right, factor, segment, block = net.diagonal, net.right, net.factor, net.segment, net.points.block
    P = net.n_free - net.n_interior
    block[P:] = 0.0
    for p in range(P):
        for x in range(3):
            for y in range(3):
                block[p, x, y] = diagonal[net.n_interior + p, x, y]
    c = 0
    while c < net.cable.shape[0]:
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        D, r = diagonal[node : node + count - 1], right[node : node + count - 1]
        row, out = segment[first + 1 : first + count], factor[first + 1 : first + count]
        if count == 1:
            _single(place, c)
        elif net.cable[c, BORDERED] == 1:
            _eliminate_bordered(place, c, D, r, row, out)
        elif c + 1 < net.cable.shape[0] and net.cable[c + 1, SEGMENTS] == count and net.cable[c + 1, BORDERED] == 0:
            c += 1
            first, node = net.cable[c, FIRST_SEGMENT], net.cable[c, FIRST_NODE]
            D2, r2 = diagonal[node : node + count - 1], right[node : node + count - 1]
            row2, out2 = segment[first + 1 : first + count], factor[first + 1 : first + count]
            state, state2 = _first(net, c - 1), _first(net, c)
            for j in range(count - 1):
                state = _pass(state, D[j], r[j], row[j], out[j])[0]
                state2 = _pass(state2, D2[j], r2[j], row2[j], out2[j])[0]
            _finish(net, c - 1, state)
            _finish(net, c, state2)
        else:
            state = _first(net, c)
            for j in range(count - 1):
                state = _pass(state, D[j], r[j], row[j], out[j])[0]
            _finish(net, c, state)
        c += 1


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _single(place, c):
    """A cable of one segment has no interior: its stiffness goes straight to its end points."""
    net = net_at(place)
    start, end, block, e = net.cable[c, START], net.cable[c, END], net.points.block, net.segment[net.cable[c, FIRST_SEGMENT]]
    G, T = _stiffness(e), e[TENSION]
    if start < net.n_free:
        _add(block[start - net.n_interior], G, 1.0)
        for x in range(3):
            net.right[start, x] += e[x] * T
    if end < net.n_free:
        _add(block[end - net.n_interior], G, 1.0)
        for x in range(3):
            net.right[end, x] -= e[x] * T
    if net.cable[c, BORDERED] == 1:
        _add(block[net.cable[c, START_END]], G, -1.0)
        _add(block[net.cable[c, END_START]], G, -1.0)


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _eliminate_bordered(place, c, D, r, row, out):
    """Eliminate a cable whose start is a free point too.

    The displacement of the start and the tension T of the first segment are carried along as four unknowns u = (d_start, T):
    the first node sees a_0 (d_start - d) - e_0 T behind it, so that no stiffness enters before T itself is eliminated at the
    end. C (3, 4) is what u adds to the right-hand side of the node eliminated now, and d_first = Q d + p + P u is the first
    node's displacement in terms of that node's.
    """
    net = net_at(place)
    start, end = net.cable[c, START], net.cable[c, END]
    first, block, before = net.segment[net.cable[c, FIRST_SEGMENT]], net.points.block, start - net.n_interior
    a0, k0, e0, g0 = first[GEOMETRIC], first[STIFFNESS], first[:3], first[3:6]
    net.carried[:] = 0.0
    C, P, fresh, p = net.carried[0], net.carried[1], net.carried[2], net.carried[3, 0]
    Q, X, H, turned = net.carried[4], net.carried[5], net.carried[6], net.carried[7]  # the last column of these is idle
    for x in range(3):
        C[x, x], C[x, 3], Q[x, x] = a0, -e0[x], 1.0
    state = (a0, 0.0, 0.0, 0.0, a0, 0.0, 0.0, 0.0, a0, 0.0, 0.0, 0.0)
    for j in range(D.shape[0]):
        state, M, y, z, rho = _pass(state, D[j], r[j], row[j], out[j])
        e, a, border = row[j], row[j, GEOMETRIC], net.border[net.cable[c, FIRST_SEGMENT] + 1 + j]
        for x in range(3):
            for i in range(3):
                X[x, i] = M[3 * x + i] - rho * y[x] * z[i]
                H[x, i] = out[j, 3 * x + i]
        for u in range(4):
            of_T = z[0] * C[0, u] + z[1] * C[1, u] + z[2] * C[2, u]
            border[12 + u] = -rho * of_T
            for x in range(3):
                border[4 * x + u] = X[x, 0] * C[0, u] + X[x, 1] * C[1, u] + X[x, 2] * C[2, u]
            for x in range(3):
                along = M[3 * x] * C[0, u] + M[3 * x + 1] * C[1, u] + M[3 * x + 2] * C[2, u]
                fresh[x, u] = a * along + rho * (e[x] - a * y[x]) * of_T
        for x in range(3):
            for i in range(3):
                p[x] += Q[x, i] * out[j, 9 + i]
                turned[x, i] = Q[x, 0] * H[0, i] + Q[x, 1] * H[1, i] + Q[x, 2] * H[2, i]
            for u in range(4):
                P[x, u] += Q[x, 0] * border[u] + Q[x, 1] * border[4 + u] + Q[x, 2] * border[8 + u]
        for x in range(3):
            for u in range(4):
                Q[x, u], C[x, u] = turned[x, u], fresh[x, u]
    # T = T_0 + k_0 g_0 . (d_first - d_start), solved for T: = tie . (d_end, d_start) + constant
    tie = net.factor[net.cable[c, FIRST_SEGMENT]]
    rho = 1.0 / (1.0 - k0 * (g0[0] * P[0, 3] + g0[1] * P[1, 3] + g0[2] * P[2, 3]))
    for i in range(3):
        tie[i] = rho * k0 * (g0[0] * Q[0, i] + g0[1] * Q[1, i] + g0[2] * Q[2, i])
        tie[3 + i] = rho * k0 * (g0[0] * P[0, i] + g0[1] * P[1, i] + g0[2] * P[2, i] - g0[i])
    tie[6] = rho * (first[TENSION] + k0 * (g0[0] * p[0] + g0[1] * p[1] + g0[2] * p[2]))
    _finish(net, c, state)
    behind, ahead, far = block[before], block[end - net.n_interior], net.right
    to_end, to_start = block[net.cable[c, START_END]], block[net.cable[c, END_START]]
    for x in range(3):
        # force on the start: a_0 (d_first - d_start) + e_0 T; on the end: what `_finish` gave it, and C u
        of_T = a0 * P[x, 3] + e0[x]
        far[start, x] += a0 * p[x] + of_T * tie[6]
        far[end, x] += C[x, 3] * tie[6]
        behind[x, x] += a0
        for i in range(3):
            behind[x, i] -= a0 * P[x, i] + of_T * tie[3 + i]
            to_end[x, i] -= a0 * Q[x, i] + of_T * tie[i]
            to_start[x, i] -= C[x, i] + C[x, 3] * tie[3 + i]
            ahead[x, i] -= C[x, 3] * tie[i]


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _factor(M):
    """LU of a 3x3 block in place, unit lower, the inverse of the diagonal kept."""
    M[0, 0] = 1.0 / M[0, 0]
    M[1, 0] *= M[0, 0]
    M[2, 0] *= M[0, 0]
    M[1, 1] = 1.0 / (M[1, 1] - M[1, 0] * M[0, 1])
    M[1, 2] -= M[1, 0] * M[0, 2]
    M[2, 1] = (M[2, 1] - M[2, 0] * M[0, 1]) * M[1, 1]
    M[2, 2] = 1.0 / (M[2, 2] - M[2, 0] * M[0, 2] - M[2, 1] * M[1, 2])


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _solved(M, x, y, z):
    """M^-1 (x, y, z) for a factored block."""
    y -= M[1, 0] * x
    z -= M[2, 0] * x + M[2, 1] * y
    z *= M[2, 2]
    y = (y - M[1, 2] * z) * M[1, 1]
    return (x - M[0, 1] * y - M[0, 2] * z) * M[0, 0], y, z


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def solve_points(place):
    """Block LU of the free points in their elimination order; their displacements go to ``net.step``.

    By solves with factored blocks, never by their inverses: two points tied by a stiff cable share a block whose condition is
    that of the stiffness over the inertia, and an inverse would lose it three times over.
    """
    net = net_at(place)
    points, right, step, base = net.points, net.right, net.step, net.n_interior
    block, P = points.block, net.n_free - net.n_interior
    for p in range(P):
        M, rp = block[p], right[base + p]
        _factor(M)
        rp[0], rp[1], rp[2] = _solved(M, rp[0], rp[1], rp[2])
        first, last, at = points.later_at[p], points.later_at[p + 1], points.target_at[p]
        for j in range(first, last):
            U = block[points.upper[j]]
            for i in range(3):
                U[0, i], U[1, i], U[2, i] = _solved(M, U[0, i], U[1, i], U[2, i])
        for i in range(first, last):
            L, rq = block[points.lower[i]], right[base + points.later[i]]
            for x in range(3):
                rq[x] -= L[x, 0] * rp[0] + L[x, 1] * rp[1] + L[x, 2] * rp[2]
            for j in range(first, last):
                S, U = block[points.target[at]], block[points.upper[j]]
                for x in range(3):
                    for y in range(3):
                        S[x, y] -= L[x, 0] * U[0, y] + L[x, 1] * U[1, y] + L[x, 2] * U[2, y]
                at += 1
    for p in range(P - 1, -1, -1):
        d = step[base + p]
        d[0], d[1], d[2] = right[base + p, 0], right[base + p, 1], right[base + p, 2]
        for j in range(points.later_at[p], points.later_at[p + 1]):
            U, after = block[points.upper[j]], step[base + points.later[j]]
            for x in range(3):
                d[x] -= U[x, 0] * after[0] + U[x, 1] * after[1] + U[x, 2] * after[2]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def substitute_cables(place):
    """From the free points back along each cable: displacements to ``net.step``, tensions to ``net.tension``.

    Returns the smallest tension [N].
    """
    net = net_at(place)
    step, factor, tension, smallest = net.step, net.factor, net.tension, np.inf
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        start, end, bordered = net.cable[c, START], net.cable[c, END], net.cable[c, BORDERED] == 1 and count > 1
        x, y, z = step[end, 0], step[end, 1], step[end, 2]
        sx, sy, sz = step[start, 0], step[start, 1], step[start, 2]
        tie = factor[first]
        T0 = tie[6] + tie[0] * x + tie[1] * y + tie[2] * z + tie[3] * sx + tie[4] * sy + tie[5] * sz
        for j in range(count - 1, 0, -1):
            f = factor[first + j]
            T = f[15] + f[12] * x + f[13] * y + f[14] * z
            hx = f[9] + f[0] * x + f[1] * y + f[2] * z
            hy = f[10] + f[3] * x + f[4] * y + f[5] * z
            hz = f[11] + f[6] * x + f[7] * y + f[8] * z
            if bordered:
                b = net.border[first + j]
                hx += b[0] * sx + b[1] * sy + b[2] * sz + b[3] * T0
                hy += b[4] * sx + b[5] * sy + b[6] * sz + b[7] * T0
                hz += b[8] * sx + b[9] * sy + b[10] * sz + b[11] * T0
                T += b[12] * sx + b[13] * sy + b[14] * sz + b[15] * T0
            x, y, z = hx, hy, hz
            tension[first + j] = T
            smallest = min(smallest, T)
            i = node + j - 1
            step[i, 0], step[i, 1], step[i, 2] = x, y, z
        if bordered:
            tension[first] = T0
            smallest = min(smallest, T0)
            continue
        row = net.segment[first]
        longer = row[3] * (x - sx) + row[4] * (y - sy) + row[5] * (z - sz)
        tension[first] = row[TENSION] + row[STIFFNESS] * longer
        smallest = min(smallest, tension[first])
    return smallest


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def solve(place):
    """Solve the linear system of the module's docstring for ``net.step`` and ``net.tension``; overwrites ``net.right``.

    Returns the smallest tension [N].
    """
    eliminate_cables(place)
    solve_points(place)
    return substitute_cables(place)
