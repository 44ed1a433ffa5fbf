"""The elimination of one node of a cable, on which `chain` is built: of one cable, or of four that are alike.

`eliminate` is that of a cable alone, `eliminate_near` that of one whose neighbours effects join by the blocks that its name says,
and `eliminate_far` that of one whose next-but-one neighbours they join too. Matrices are tuples by rows.
"""

from anet_lumped.compiled.jit import inlined


@inlined
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


@inlined
def times(m, x, y, z):
    return (
        m[0] * x + m[1] * y + m[2] * z,
        m[3] * x + m[4] * y + m[5] * z,
        m[6] * x + m[7] * y + m[8] * z,
    )


@inlined
def times_transposed(m, x, y, z):
    return (
        m[0] * x + m[3] * y + m[6] * z,
        m[1] * x + m[4] * y + m[7] * z,
        m[2] * x + m[5] * y + m[8] * z,
    )


@inlined
def _product(a, b):
    first, second = times_transposed(b, a[0], a[1], a[2]), times_transposed(b, a[3], a[4], a[5])
    return first + second + times_transposed(b, a[6], a[7], a[8])


@inlined
def _outer(x, y):
    return (
        x[0] * y[0], x[0] * y[1], x[0] * y[2], x[1] * y[0], x[1] * y[1], x[1] * y[2], x[2] * y[0], x[2] * y[1], x[2] * y[2]
    )  # fmt: skip


@inlined
def _plus(a, b):
    return (
        a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5], a[6] + b[6], a[7] + b[7], a[8] + b[8]
    )  # fmt: skip


@inlined
def minus(a, b):
    return (
        a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3], a[4] - b[4], a[5] - b[5], a[6] - b[6], a[7] - b[7], a[8] - b[8]
    )  # fmt: skip


@inlined
def less(a, m):
    """a I - m."""
    return a - m[0], -m[1], -m[2], -m[3], a - m[4], -m[5], -m[6], -m[7], a - m[8]


@inlined
def _condense(state, D, r, row):
    """M, y, z, u = M^-1 r, rho k and the constant part of T, as in the docstring of `chain`; M the inverse."""
    s00, m01, m02, m10, s11, m12, m20, m21, s22, r0, r1, r2 = state
    ex, ey, ez, gx, gy, gz, a, k, T_0 = row
    r0, r1, r2 = r0 + r[0], r1 + r[1], r2 + r[2]
    m00, m01, m02 = s00 + D[0] + a, m01 + D[1], m02 + D[2]
    m10, m11, m12 = m10 + D[3], s11 + D[4] + a, m12 + D[5]
    m20, m21, m22 = m20 + D[6], m21 + D[7], s22 + D[8] + a
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
    z = times_transposed(M, gx, gy, gz)
    T, rho = rho * (T_0 - k * (z[0] * r0 + z[1] * r1 + z[2] * r2)), rho * k
    return M, times(M, ex, ey, ez), z, times(M, r0, r1, r2), rho, T


@inlined
def eliminate(state, D, r, row):
    """Eliminate a node, with stiffness D and right-hand side r of its own, through the segment ahead of it; also of `LANES`.

    Parameters
    ----------
    state : tuple of 12, what lies behind: a block and a right-hand side
    D, r, row : tuples of 9, 3 and 9
        Stiffness by rows, right-hand side, and e, g, a, k, T_0 of the segment.

    Returns
    -------
    ahead : tuple of 12, what the next node sees behind it
    follows : tuple of 16, how the node follows the next one, a row of ``Net.factor``: d = H d_next + h, T = w . d_next + T
    M, y, z, rho k : as in the docstring of `chain`, M the inverse
    """
    ex, ey, ez, gx, gy, gz, a = row[:7]
    M, y, z, u, rho, T = _condense(state, D, r, row)
    (yx, yy, yz), (zx, zy, zz), (ux, uy, uz) = y, z, u
    wx, wy, wz = rho * (gx - a * zx), rho * (gy - a * zy), rho * (gz - a * zz)
    H00, H01, H02 = a * M[0] + yx * wx, a * M[1] + yx * wy, a * M[2] + yx * wz
    H10, H11, H12 = a * M[3] + yy * wx, a * M[4] + yy * wy, a * M[5] + yy * wz
    H20, H21, H22 = a * M[6] + yz * wx, a * M[7] + yz * wy, a * M[8] + yz * wz
    hx, hy, hz = ux + yx * T, uy + yy * T, uz + yz * T
    # S = a (I - H) + e w^T, and the right-hand side that goes with it
    ahead = (
        a - a * H00 + ex * wx, ex * wy - a * H01, ex * wz - a * H02,
        ey * wx - a * H10, a - a * H11 + ey * wy, ey * wz - a * H12,
        ez * wx - a * H20, ez * wy - a * H21, a - a * H22 + ez * wz,
        a * hx - ex * T, a * hy - ey * T, a * hz - ez * T,
    )  # fmt: skip
    return ahead, (H00, H01, H02, H10, H11, H12, H20, H21, H22, hx, hy, hz, wx, wy, wz, T), M, y, z, rho


@inlined
def eliminate_near(state, D, r, row, near):
    """The same where effects join the node and the next one: ``near`` (18,), the blocks of the one's row and of the other's.

    With A = a I - near_0 and B = a I - near_1 in place of a I,

        w = rho k (g - A^T z),   H = M^-1 A + y w^T,   S = a I - B H + e w^T .
    """
    e, g, a = row[:3], row[3:6], row[6]
    A, B = less(a, near[:9]), less(a, near[9:])
    M, y, z, u, rho, T = _condense(state, D, r, row)
    turned = times_transposed(A, z[0], z[1], z[2])
    w = rho * (g[0] - turned[0]), rho * (g[1] - turned[1]), rho * (g[2] - turned[2])
    H = _plus(_product(M, A), _outer(y, w))
    h = u[0] + y[0] * T, u[1] + y[1] * T, u[2] + y[2] * T
    back = times(B, h[0], h[1], h[2])
    S, s = _plus(less(a, _product(B, H)), _outer(e, w)), (back[0] - e[0] * T, back[1] - e[1] * T, back[2] - e[2] * T)
    return S + s, (*H, *h, *w, T), M, y, z, rho


@inlined
def eliminate_far(state, D, r, row, near, far):
    """The same where effects join the node and the next but one too, by ``far`` (18,).

    What lies behind now acts on the next two nodes: ``state`` (42,) is that on the next one (12,), the blocks between the two
    (18,), and that on the second (12,). The node follows both, d = H d_1 + J d_2 + h, T = w . d_1 + o . d_2 + T: ``follows`` (28,)
    is that of `eliminate`, J and o. With F = far_0 and G = far_1,

        o = rho k F^T z,   J = y o^T - M^-1 F,   S_12 = e o^T - B J,   S_21 = G H,   S_22 = G J .
    """
    across, beyond = state[12:30], state[30:]
    joined = _plus(near[:9], across[:9]) + _plus(near[9:], across[9:])
    ahead, follows, M, y, z, rho = eliminate_near(state[:12], D, r, row, joined)
    F, G, B = far[:9], far[9:], less(row[6], joined[9:])
    turned = times_transposed(F, z[0], z[1], z[2])
    o = rho * turned[0], rho * turned[1], rho * turned[2]
    J = minus(_outer(y, o), _product(M, F))
    back = times(G, follows[9], follows[10], follows[11])
    S, s = _plus(ahead[:9], beyond[:9]), (ahead[9] + beyond[9], ahead[10] + beyond[10], ahead[11] + beyond[11])
    S_12, S_21, S_22 = minus(_outer(row[:3], o), _product(B, J)), _product(G, follows[:9]), _product(G, J)
    s_2 = (-back[0], -back[1], -back[2])
    return S + s + S_12 + S_21 + S_22 + s_2, follows + J + o, M, y, z, rho
