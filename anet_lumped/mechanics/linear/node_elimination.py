"""The elimination of one node of a cable, or of one node of each of the four cables of a group; `chain` is built on it.

`eliminate` serves cables whose nodes are joined by segments alone. `eliminate_near` serves cables in which effects join neighbours
by ``net.near_blocks``. `eliminate_far` serves cables in which effects join next-but-one neighbours too, by ``net.far_blocks``.
A matrix is a tuple of its 9 entries by rows, a vector a tuple of 3.
"""

from typing import Any, NamedTuple

from anet_lumped.compiled.jit import inlined


class SegmentTangent(NamedTuple):
    """Linearised tension T = T_0 + k g . (d_next - d) of a segment along e, and its geometric stiffness a.

    Parameters
    ----------
    ex, ey, ez, gx, gy, gz : vectors e and g
    a, k : [N/m]
    T_0 : [N]
    """

    ex: Any
    ey: Any
    ez: Any
    gx: Any
    gy: Any
    gz: Any
    a: Any
    k: Any
    T_0: Any


class EliminatedNode(NamedTuple):
    """What the elimination of a node gives; the letters are those of the docstring of `chain`.

    Parameters
    ----------
    ahead : tuple of 12, or of 42 from `eliminate_far`
        Block (9) and right-hand side (3) that the node and all that lies behind it add to the next node.
    follows : tuple of 16, or of 28 from `eliminate_far`
        H (9), h (3), w (3) and T_c: the displacement of the node is d = H d_next + h, the tension of the segment is
        T = w . d_next + T_c. A row of ``Net.factor``.
    M_inverse : tuple of 9, M^-1
    y, z : tuples of 3, M^-1 e and M^-T g
    rho_k : rho k
    """

    ahead: Any
    follows: Any
    M_inverse: Any
    y: Any
    z: Any
    rho_k: Any


@inlined
def inverse(m):
    """Inverse of a 3x3 matrix by LU without pivoting.

    Backward stable for a matrix that is nearly symmetric and positive definite. The adjugate would lose twice as many digits as
    the condition number says. An eliminated row is not divided by its pivot (Bareiss), so that one division serves all pivots.
    """
    m00, m01, m02, m10, m11, m12, m20, m21, m22 = m
    p11, p12 = m00 * m11 - m10 * m01, m00 * m12 - m10 * m02
    p21, p22 = m00 * m21 - m20 * m01, m00 * m22 - m20 * m02
    det = p11 * p22 - p12 * p21
    per_product = 1.0 / (m00 * p11 * det)
    per_00, per_11, i2 = per_product * p11 * det, per_product * m00 * det, per_product * (m00 * p11) * (m00 * p11)
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
    """Matrix times vector."""
    return (
        m[0] * x + m[1] * y + m[2] * z,
        m[3] * x + m[4] * y + m[5] * z,
        m[6] * x + m[7] * y + m[8] * z,
    )


@inlined
def times_transposed(m, x, y, z):
    """Transposed matrix times vector."""
    return (
        m[0] * x + m[3] * y + m[6] * z,
        m[1] * x + m[4] * y + m[7] * z,
        m[2] * x + m[5] * y + m[8] * z,
    )


@inlined
def _product(a, b):
    """Matrix times matrix."""
    first, second = times_transposed(b, a[0], a[1], a[2]), times_transposed(b, a[3], a[4], a[5])
    return first + second + times_transposed(b, a[6], a[7], a[8])


@inlined
def _outer(x, y):
    """Outer product x y^T."""
    return (
        x[0] * y[0], x[0] * y[1], x[0] * y[2], x[1] * y[0], x[1] * y[1], x[1] * y[2], x[2] * y[0], x[2] * y[1], x[2] * y[2]
    )  # fmt: skip


@inlined
def _sum(a, b):
    """Matrix plus matrix."""
    return (
        a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5], a[6] + b[6], a[7] + b[7], a[8] + b[8]
    )  # fmt: skip


@inlined
def difference(a, b):
    """Matrix minus matrix."""
    return (
        a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3], a[4] - b[4], a[5] - b[5], a[6] - b[6], a[7] - b[7], a[8] - b[8]
    )  # fmt: skip


@inlined
def identity_multiple_minus(a, m):
    """a I - m."""
    return a - m[0], -m[1], -m[2], -m[3], a - m[4], -m[5], -m[6], -m[7], a - m[8]


@inlined
def _condense(behind, D, r, segment):
    """M^-1, y, z, M^-1 r, rho k and the constant part of T of the docstring of `chain`; arguments as for `eliminate`."""
    s00, m01, m02, m10, s11, m12, m20, m21, s22, r0, r1, r2 = behind
    ex, ey, ez, gx, gy, gz, a, k, T_0 = segment
    r0, r1, r2 = r0 + r[0], r1 + r[1], r2 + r[2]
    if len(D) == 1:
        m00, m11, m22 = s00 + D[0] + a, s11 + D[0] + a, s22 + D[0] + a
    else:
        m00, m01, m02 = s00 + D[0] + a, m01 + D[1], m02 + D[2]
        m10, m11, m12 = m10 + D[3], s11 + D[4] + a, m12 + D[5]
        m20, m21, m22 = m20 + D[6], m21 + D[7], s22 + D[8] + a
    # LU whose rows are not divided by their pivots m00, p11 and det (Bareiss): one division serves all of them, and
    # g . y = (g0 e0 p11 det + f1 h1 det + f2 h2)/(m00 p11 det) does not wait for it
    p11, p12 = m00 * m11 - m10 * m01, m00 * m12 - m10 * m02
    p21, p22 = m00 * m21 - m20 * m01, m00 * m22 - m20 * m02
    f1, h1 = m00 * ey - m10 * ex, m00 * gy - m01 * gx
    f2, h2 = p11 * (m00 * ez - m20 * ex) - p21 * f1, p11 * (m00 * gz - m02 * gx) - p12 * h1
    det, m_p = p11 * p22 - p12 * p21, m00 * p11
    product = m_p * det
    rho = product / (product + k * (gx * ex * (p11 * det) + f1 * h1 * det + f2 * h2))
    per_product = 1.0 / product
    i0, i1, i2 = per_product * p11 * det, per_product * m00 * m00 * det, per_product * m_p * m_p
    l10, u12, l21 = i0 * m10, i0 * p12, per_product * m00 * det * p21
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
def eliminate(behind, D, r, segment):
    """Eliminate a node, of stiffness D and right-hand side r, through the segment ahead of it.

    Parameters
    ----------
    behind : tuple of 12
        Block (9) and right-hand side (3) that all that lies behind adds to the node.
    D, r : tuples of 9, or of 1 for a multiple of I, and of 3
    segment : SegmentTangent

    Returns
    -------
    EliminatedNode
    """
    ex, ey, ez, gx, gy, gz, a = segment[:7]
    M, y, z, u, rho_k, T = _condense(behind, D, r, segment)
    (yx, yy, yz), (zx, zy, zz), (ux, uy, uz) = y, z, u
    wx, wy, wz = rho_k * (gx - a * zx), rho_k * (gy - a * zy), rho_k * (gz - a * zz)
    H00, H01, H02 = a * M[0] + yx * wx, a * M[1] + yx * wy, a * M[2] + yx * wz
    H10, H11, H12 = a * M[3] + yy * wx, a * M[4] + yy * wy, a * M[5] + yy * wz
    H20, H21, H22 = a * M[6] + yz * wx, a * M[7] + yz * wy, a * M[8] + yz * wz
    hx, hy, hz = ux + yx * T, uy + yy * T, uz + yz * T
    # S = a (I - H) + e w^T, and the right-hand side a h - e T_c
    ahead = (
        a - a * H00 + ex * wx, ex * wy - a * H01, ex * wz - a * H02,
        ey * wx - a * H10, a - a * H11 + ey * wy, ey * wz - a * H12,
        ez * wx - a * H20, ez * wy - a * H21, a - a * H22 + ez * wz,
        a * hx - ex * T, a * hy - ey * T, a * hz - ez * T,
    )  # fmt: skip
    follows = (H00, H01, H02, H10, H11, H12, H20, H21, H22, hx, hy, hz, wx, wy, wz, T)
    return EliminatedNode(ahead, follows, M, y, z, rho_k)


@inlined
def eliminate_near(behind, D, r, segment, near):
    """`eliminate` where effects join the node and the next one.

    ``near`` (18,) holds two blocks: near_0 in the row of the node and the column of the next one, near_1 the other way round.
    A = a I - near_0 and B = a I - near_1 take the place of a I:

        w = rho k (g - A^T z),   H = M^-1 A + y w^T,   S = a I - B H + e w^T .
    """
    e, g, a = segment[:3], segment[3:6], segment.a
    A, B = identity_multiple_minus(a, near[:9]), identity_multiple_minus(a, near[9:])
    M, y, z, u, rho_k, T = _condense(behind, D, r, segment)
    A_z = times_transposed(A, z[0], z[1], z[2])
    w = rho_k * (g[0] - A_z[0]), rho_k * (g[1] - A_z[1]), rho_k * (g[2] - A_z[2])
    H = _sum(_product(M, A), _outer(y, w))
    h = u[0] + y[0] * T, u[1] + y[1] * T, u[2] + y[2] * T
    B_h = times(B, h[0], h[1], h[2])
    S, s = _sum(identity_multiple_minus(a, _product(B, H)), _outer(e, w)), (B_h[0] - e[0] * T, B_h[1] - e[1] * T, B_h[2] - e[2] * T)
    return EliminatedNode(S + s, (*H, *h, *w, T), M, y, z, rho_k)


@inlined
def eliminate_far(behind, D, r, segment, near, far):
    """`eliminate_near` where effects join the node and the next-but-one node too, by the two blocks of ``far`` (18,).

    All that lies behind acts on this node and on the next one. ``behind`` (42,) holds the block and right-hand side that it adds to
    this node (12), the two blocks between both nodes (18), and the block and right-hand side that it adds to the next node (12);
    ``ahead`` holds the same for the next node. The node follows the next two nodes,

        d = H d_1 + J d_2 + h ,    T = w . d_1 + o . d_2 + T_c ,

    and ``follows`` (28,) holds H, h, w, T_c, J and o. With F = far_0 and G = far_1,

        o = rho k F^T z,   J = y o^T - M^-1 F,   S_12 = e o^T - B J,   S_21 = G H,   S_22 = G J .
    """
    between_both, on_second = behind[12:30], behind[30:]
    blocks_between = _sum(near[:9], between_both[:9]) + _sum(near[9:], between_both[9:])
    ahead, follows, M, y, z, rho_k = eliminate_near(behind[:12], D, r, segment, blocks_between)
    F, G, B = far[:9], far[9:], identity_multiple_minus(segment.a, blocks_between[9:])
    F_z = times_transposed(F, z[0], z[1], z[2])
    o = rho_k * F_z[0], rho_k * F_z[1], rho_k * F_z[2]
    J = difference(_outer(y, o), _product(M, F))
    G_h = times(G, follows[9], follows[10], follows[11])
    S, s = _sum(ahead[:9], on_second[:9]), (ahead[9] + on_second[9], ahead[10] + on_second[10], ahead[11] + on_second[11])
    S_12, S_21, S_22 = difference(_outer(segment[:3], o), _product(B, J)), _product(G, follows[:9]), _product(G, J)
    s_2 = (-G_h[0], -G_h[1], -G_h[2])
    return EliminatedNode(S + s + S_12 + S_21 + S_22 + s_2, follows + J + o, M, y, z, rho_k)
