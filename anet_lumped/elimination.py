"""The elimination of one node of a cable, on which `chain` is built: of one cable, or of four that are alike."""

from numba import njit

# Columns of the scratch table `Net.segment`, one row a segment: e and g of the docstring (three each), a, k, T_0; and for the
# law: the stretch before (of the old segment, or of its component along the new one), the stretch now, the conservative part
# of the tension, the change of length in the step before, and the numerical damper.
DIRECTION, GRADIENT, GEOMETRIC, STIFFNESS, TENSION = 0, 3, 6, 7, 8
BEFORE, STRETCH, SECANT, LAST, NUMERICAL = 9, 10, 11, 12, 13
COLUMNS = 14
# Columns of `Net.cable`.
FIRST_SEGMENT, SEGMENTS, FIRST_NODE, START, END, BORDERED, START_END, END_START, CURVE, CURVE_END = range(10)


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
def times(m, x, y, z):
    return (
        m[0] * x + m[1] * y + m[2] * z,
        m[3] * x + m[4] * y + m[5] * z,
        m[6] * x + m[7] * y + m[8] * z,
    )


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def eliminate(state, D, r, row):
    """Eliminate a node, with stiffness D and right-hand side r of its own, through the segment ahead of it; also of `LANES`.

    Parameters
    ----------
    state : tuple of 12, what lies behind, as `_first` gives it
    D, r, row : tuples of 9, 3 and 9
        Stiffness by rows, right-hand side, and e, g, a, k, T_0 of the segment.

    Returns
    -------
    ahead : tuple of 12, what the next node sees behind it
    follows : tuple of 16, how the node follows the next one, a row of ``Net.factor``: d = H d_next + h, T = w . d_next + T
    M, y, z, rho k : as in the docstring of the module, M the inverse
    """
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
    yx, yy, yz = times(M, ex, ey, ez)
    zx = M[0] * gx + M[3] * gy + M[6] * gz
    zy = M[1] * gx + M[4] * gy + M[7] * gz
    zz = M[2] * gx + M[5] * gy + M[8] * gz
    ux, uy, uz = times(M, r0, r1, r2)
    T, rho = rho * (T_0 - k * (zx * r0 + zy * r1 + zz * r2)), rho * k
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
    return ahead, (H00, H01, H02, H10, H11, H12, H20, H21, H22, hx, hy, hz, wx, wy, wz, T), M, (yx, yy, yz), (zx, zy, zz), rho
