"""Linear algebra of a net: each cable's interior is eliminated in O(n), then the free points.

One Newton step solves, for the displacements d of all moving nodes and the tensions T of all segments,

    D_i d_i + sum over segments at i of -+ [ a (d_j - d_i) + e T ] = r_i ,      phi T = eps0 + g . (d_j - d_i) ,

where D_i holds inertia and external stiffness, a the geometric stiffness of the segment, e the direction in which its
tension acts, and phi = 1/(dT/dl) its axial compliance: 0 would be inextensible, inf is slack. Keeping the tension as an
unknown until its node is eliminated makes every number that occurs as large as inertia and tension, not as large as the
stiffness: with M = D + a I,

    y = M^-1 e,   z = M^-T g,   rho = 1/(phi + g . y),   T = rho [eps0 - z . r_i + (g - a z) . d_next]
    S = a I - a^2 M^-1 + rho (e - a y)(g - a z)^T        is what the part behind looks like to the next node,

which is (G^-1 + D^-1)^-1 for the segment stiffness G = a I + e g^T / phi, after Sherman and Morrison.
"""

from numba import njit

# Columns of the scratch table `Net.segment`, one row a segment: e and g of the docstring (three each), a, phi, eps0; and for
# the law: the stretch before (of the old segment, or of its component along the new one), the stretch now, the tension and
# its conservative part.
DIRECTION, GRADIENT, GEOMETRIC, COMPLIANCE, OFFSET = 0, 3, 6, 7, 8
BEFORE, STRETCH, LAW_TENSION, SECANT = 9, 10, 11, 12
# Columns of `Net.cable`.
FIRST_SEGMENT, SEGMENTS, FIRST_NODE, START, END, BORDERED, START_END, END_START = range(8)


@njit(cache=True, error_model="numpy")
def inverse(m):
    """Inverse of a 3x3 matrix, a tuple by rows, by LU without pivoting: backward stable for what is nearly symmetric
    positive definite, where the adjugate would lose twice the digits of the condition number."""
    m00, m01, m02, m10, m11, m12, m20, m21, m22 = m
    i0 = 1.0 / m00
    l10, l20 = m10 * i0, m20 * i0
    i1 = 1.0 / (m11 - l10 * m01)
    u12 = m12 - l10 * m02
    l21 = (m21 - l20 * m01) * i1
    i2 = 1.0 / (m22 - l20 * m02 - l21 * u12)
    a01 = -i0 * m01 * i1
    a12 = -i1 * u12 * i2
    a02 = i0 * (m01 * u12 * i1 - m02) * i2
    b20 = l10 * l21 - l20
    return (
        i0 - a01 * l10 + a02 * b20, a01 - a02 * l21, a02,
        -i1 * l10 + a12 * b20, i1 - a12 * l21, a12,
        i2 * b20, -i2 * l21, i2,
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def _store(block, m):
    for x in range(3):
        block[x, 0], block[x, 1], block[x, 2] = m[3 * x], m[3 * x + 1], m[3 * x + 2]


@njit(cache=True, error_model="numpy")
def _load(b):
    return b[0, 0], b[0, 1], b[0, 2], b[1, 0], b[1, 1], b[1, 2], b[2, 0], b[2, 1], b[2, 2]


@njit(cache=True, error_model="numpy")
def _add(block, m, sign):
    for x in range(3):
        for y in range(3):
            block[x, y] += sign * m[3 * x + y]


@njit(cache=True, error_model="numpy")
def _times(m, x, y, z):
    return (
        m[0] * x + m[1] * y + m[2] * z,
        m[3] * x + m[4] * y + m[5] * z,
        m[6] * x + m[7] * y + m[8] * z,
    )


@njit(cache=True, error_model="numpy")
def _product(m, n):
    """Product of two 3x3 matrices, both tuples by rows."""
    a = _times(m, n[0], n[3], n[6])
    b = _times(m, n[1], n[4], n[7])
    c = _times(m, n[2], n[5], n[8])
    return a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]


@njit(cache=True, error_model="numpy")
def _stiffness(row):
    """Stiffness a I + e g^T / phi of a segment, and its tension before the step, eps0 / phi."""
    a, k = row[GEOMETRIC], 1.0 / row[COMPLIANCE]
    ex, ey, ez = k * row[0], k * row[1], k * row[2]
    gx, gy, gz = row[3], row[4], row[5]
    return (
        a + ex * gx, ex * gy, ex * gz, ey * gx, a + ey * gy, ey * gz, ez * gx, ez * gy, a + ez * gz,
    ), k * row[OFFSET]  # fmt: skip


@njit(cache=True, error_model="numpy")
def eliminate_cables(net):
    """Eliminate the interior of every cable; adds what each looks like to ``net.points.block`` and ``net.right``.

    Reads ``net.segment``, ``net.diagonal`` and ``net.right``; writes ``net.factor`` and ``net.border``.
    """
    diagonal, right, factor, block = net.diagonal, net.right, net.factor, net.points.block
    P = net.n_free - net.n_interior
    for b in range(P, block.shape[0]):
        block[b] = 0.0
    for p in range(P):
        block[p] = diagonal[net.n_interior + p]
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        start, end, bordered = net.cable[c, START], net.cable[c, END], net.cable[c, BORDERED] == 1
        G, T0 = _stiffness(net.segment[first])
        e = net.segment[first, :3]
        if count == 1:
            _single(net, c, G, T0, e)
            continue
        r0, r1, r2 = right[node, 0] - e[0] * T0, right[node, 1] - e[1] * T0, right[node, 2] - e[2] * T0
        D = _load(diagonal[node])
        d00, d01, d02, d10, d11, d12, d20, d21, d22 = D
        d00, d01, d02 = d00 + G[0], d01 + G[1], d02 + G[2]
        d10, d11, d12 = d10 + G[3], d11 + G[4], d12 + G[5]
        d20, d21, d22 = d20 + G[6], d21 + G[7], d22 + G[8]
        C, R = G, G
        if bordered:
            _add(block[start - net.n_interior], G, 1.0)
            for x in range(3):
                right[start, x] += e[x] * T0
        for j in range(1, count):
            row, out = net.segment[first + j], factor[first + j]
            a = row[GEOMETRIC]
            ex, ey, ez, gx, gy, gz = row[0], row[1], row[2], row[3], row[4], row[5]
            M = inverse((d00 + a, d01, d02, d10, d11 + a, d12, d20, d21, d22 + a))
            yx, yy, yz = _times(M, ex, ey, ez)
            zx = M[0] * gx + M[3] * gy + M[6] * gz
            zy = M[1] * gx + M[4] * gy + M[7] * gz
            zz = M[2] * gx + M[5] * gy + M[8] * gz
            ux, uy, uz = _times(M, r0, r1, r2)
            rho = 1.0 / (row[COMPLIANCE] + gx * yx + gy * yy + gz * yz)
            T = rho * (row[OFFSET] - zx * r0 - zy * r1 - zz * r2)
            wx, wy, wz = rho * (gx - a * zx), rho * (gy - a * zy), rho * (gz - a * zz)
            h00, h01, h02 = a * M[0] + yx * wx, a * M[1] + yx * wy, a * M[2] + yx * wz
            h10, h11, h12 = a * M[3] + yy * wx, a * M[4] + yy * wy, a * M[5] + yy * wz
            h20, h21, h22 = a * M[6] + yz * wx, a * M[7] + yz * wy, a * M[8] + yz * wz
            out[0], out[1], out[2], out[3], out[4], out[5] = h00, h01, h02, h10, h11, h12
            out[6], out[7], out[8] = h20, h21, h22
            out[9], out[10], out[11] = ux + yx * T, uy + yy * T, uz + yz * T
            out[12], out[13], out[14], out[15] = wx, wy, wz, T
            if bordered:
                C, R = _eliminate_border(net, first + j, start, a, M, (yx, yy, yz), (zx, zy, zz), rho, C, R)
            # S = a (I - a M^-1) + (e - a y) w^T, and the right-hand side that goes with it
            fx, fy, fz = ex - a * yx, ey - a * yy, ez - a * yz
            aa = a * a
            d00, d01, d02 = a - aa * M[0] + fx * wx, fx * wy - aa * M[1], fx * wz - aa * M[2]
            d10, d11, d12 = fy * wx - aa * M[3], a - aa * M[4] + fy * wy, fy * wz - aa * M[5]
            d20, d21, d22 = fz * wx - aa * M[6], fz * wy - aa * M[7], a - aa * M[8] + fz * wz
            r0, r1, r2 = a * ux - fx * T, a * uy - fy * T, a * uz - fz * T
            if j < count - 1:
                i = node + j
                d00, d01, d02 = d00 + diagonal[i, 0, 0], d01 + diagonal[i, 0, 1], d02 + diagonal[i, 0, 2]
                d10, d11, d12 = d10 + diagonal[i, 1, 0], d11 + diagonal[i, 1, 1], d12 + diagonal[i, 1, 2]
                d20, d21, d22 = d20 + diagonal[i, 2, 0], d21 + diagonal[i, 2, 1], d22 + diagonal[i, 2, 2]
                r0, r1, r2 = r0 + right[i, 0], r1 + right[i, 1], r2 + right[i, 2]
        if end < net.n_free:
            _add(block[end - net.n_interior], (d00, d01, d02, d10, d11, d12, d20, d21, d22), 1.0)
            right[end, 0] += r0
            right[end, 1] += r1
            right[end, 2] += r2
            if bordered:
                _add(block[net.cable[c, END_START]], C, -1.0)
                _add(block[net.cable[c, START_END]], R, -1.0)


@njit(cache=True, error_model="numpy")
def _single(net, c, G, T0, e):
    """A cable of one segment has no interior: its stiffness goes straight to its end points."""
    start, end, block = net.cable[c, START], net.cable[c, END], net.points.block
    if start < net.n_free:
        _add(block[start - net.n_interior], G, 1.0)
        for x in range(3):
            net.right[start, x] += e[x] * T0
    if end < net.n_free:
        _add(block[end - net.n_interior], G, 1.0)
        for x in range(3):
            net.right[end, x] -= e[x] * T0
    if net.cable[c, BORDERED] == 1:
        _add(block[net.cable[c, START_END]], G, -1.0)
        _add(block[net.cable[c, END_START]], G, -1.0)


@njit(cache=True, error_model="numpy")
def _eliminate_border(net, s, start, a, M, y, z, rho, C, R):
    """Carry the coupling to a free start point along a chain.

    C is what the start point's displacement adds to the right-hand side of the node that is eliminated now, R what that
    node's displacement adds to the force on the start point; returns both for the next node.
    """
    X = (
        M[0] - rho * y[0] * z[0], M[1] - rho * y[0] * z[1], M[2] - rho * y[0] * z[2],
        M[3] - rho * y[1] * z[0], M[4] - rho * y[1] * z[1], M[5] - rho * y[1] * z[2],
        M[6] - rho * y[2] * z[0], M[7] - rho * y[2] * z[1], M[8] - rho * y[2] * z[2],
    )  # fmt: skip
    K = _product(X, C)
    out, row = net.factor[s], net.border[s]
    for x in range(9):
        row[x] = K[x]
    for x in range(3):
        row[9 + x] = -rho * (z[0] * C[x] + z[1] * C[3 + x] + z[2] * C[6 + x])
    h = _times(R, out[9], out[10], out[11])
    for x in range(3):
        net.right[start, x] += h[x]
    _add(net.points.block[start - net.n_interior], _product(R, K), -1.0)
    e = net.segment[s, :3]
    f = (rho * (e[0] - a * y[0]), rho * (e[1] - a * y[1]), rho * (e[2] - a * y[2]))
    Y = (
        a * M[0] + f[0] * z[0], a * M[1] + f[0] * z[1], a * M[2] + f[0] * z[2],
        a * M[3] + f[1] * z[0], a * M[4] + f[1] * z[1], a * M[5] + f[1] * z[2],
        a * M[6] + f[2] * z[0], a * M[7] + f[2] * z[1], a * M[8] + f[2] * z[2],
    )  # fmt: skip
    H = (out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7], out[8])
    return _product(Y, C), _product(R, H)


@njit(cache=True, error_model="numpy")
def solve_points(net):
    """Block LU of the free points in their elimination order; their displacements go to ``net.step``."""
    points, right, step, base = net.points, net.right, net.step, net.n_interior
    block, P = points.block, net.n_free - net.n_interior
    for p in range(P):
        M = inverse(_load(block[p]))
        _store(block[p], M)
        first, last, at = points.later_at[p], points.later_at[p + 1], points.target_at[p]
        rp = right[base + p]
        for i in range(first, last):
            L = _product(_load(block[points.lower[i]]), M)
            x, y, z = _times(L, rp[0], rp[1], rp[2])
            q = base + points.later[i]
            right[q, 0] -= x
            right[q, 1] -= y
            right[q, 2] -= z
            for j in range(first, last):
                _add(block[points.target[at]], _product(L, _load(block[points.upper[j]])), -1.0)
                at += 1
    for p in range(P - 1, -1, -1):
        x, y, z = right[base + p, 0], right[base + p, 1], right[base + p, 2]
        for i in range(points.later_at[p], points.later_at[p + 1]):
            d = step[base + points.later[i]]
            a, b, c = _times(_load(block[points.upper[i]]), d[0], d[1], d[2])
            x, y, z = x - a, y - b, z - c
        x, y, z = _times(_load(block[p]), x, y, z)
        step[base + p, 0], step[base + p, 1], step[base + p, 2] = x, y, z


@njit(cache=True, error_model="numpy")
def substitute_cables(net):
    """From the free points back along each cable: displacements to ``net.step``, tensions to ``net.tension``."""
    step, factor, tension = net.step, net.factor, net.tension
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        start, end, bordered = net.cable[c, START], net.cable[c, END], net.cable[c, BORDERED] == 1
        x, y, z = step[end, 0], step[end, 1], step[end, 2]
        sx, sy, sz = step[start, 0], step[start, 1], step[start, 2]
        for j in range(count - 1, 0, -1):
            f = factor[first + j]
            T = f[15] + f[12] * x + f[13] * y + f[14] * z
            hx = f[9] + f[0] * x + f[1] * y + f[2] * z
            hy = f[10] + f[3] * x + f[4] * y + f[5] * z
            hz = f[11] + f[6] * x + f[7] * y + f[8] * z
            if bordered:
                b = net.border[first + j]
                T += b[9] * sx + b[10] * sy + b[11] * sz
                hx += b[0] * sx + b[1] * sy + b[2] * sz
                hy += b[3] * sx + b[4] * sy + b[5] * sz
                hz += b[6] * sx + b[7] * sy + b[8] * sz
            x, y, z = hx, hy, hz
            tension[first + j] = T
            i = node + j - 1
            step[i, 0], step[i, 1], step[i, 2] = x, y, z
        row = net.segment[first]
        stretch = row[OFFSET] + row[3] * (x - sx) + row[4] * (y - sy) + row[5] * (z - sz)
        tension[first] = stretch / row[COMPLIANCE]


@njit(cache=True, error_model="numpy")
def solve(net):
    """Solve the linear system of the module's docstring for ``net.step`` and ``net.tension``; overwrites ``net.right``."""
    eliminate_cables(net)
    solve_points(net)
    substitute_cables(net)
