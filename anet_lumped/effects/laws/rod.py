"""Parts of what discrete elastic rods exert: tangents of segments, and the blocks of pairs of segments; see `bending`."""

import math

from anet_lumped.compiled.jit import inlined_law, law

SLACK = 0.9  # of its length at rest: a shorter segment is slack
ALPHA = 0.05  # numerical damper in full, see `bending`
SHORT = 1e-6  # of L0: a shorter segment counts as this long, since a segment of no length has no direction


@inlined_law
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined_law
def combined(factor_a, a, factor_b, b):
    """x a + y b."""
    return factor_a * a[0] + factor_b * b[0], factor_a * a[1] + factor_b * b[1], factor_a * a[2] + factor_b * b[2]


@inlined_law
def between_nodes(q, i, j):
    return q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2]


@inlined_law
def tangent_of_segment(d, L0):
    """Unit tangent and length of a segment, at least `SHORT` of L0."""
    l = max(math.sqrt(dot(d, d)), SHORT * L0)
    return (d[0] / l, d[1] / l, d[2] / l), l


@inlined_law
def add_row(f, i, a, sign):
    f[i, 0] += sign * a[0]
    f[i, 1] += sign * a[1]
    f[i, 2] += sign * a[2]


@inlined_law
def damper_of_bending(h, omega):
    """alpha of the numerical damper over a step h, for the highest frequency omega; see `bending`."""
    square = (0.5 * h * omega) ** 2
    return ALPHA * square / (1.0 + square)


@inlined_law
def slope_of_turn(B, l, t, other):
    """dE/dd = -(B/l) (other - (t . other) t), of E = B (1 - t . other)."""
    return combined(-B / l, other, B / l * dot(t, other), t)


@inlined_law
def own_block(H, B, l, t, other):
    """d2E/dd2 = (B/l^2) (t p^T + p t^T + c (I - t t^T)), p = other - c t, c = t . other, for H."""
    c, per = dot(t, other), B / (l * l)
    p = combined(1.0, other, -c, t)
    for x in range(3):
        for y in range(3):
            H[x, y] = per * (t[x] * p[y] + p[x] * t[y] - c * t[x] * t[y])
        H[x, x] += per * c


@law
def add_clamp_block(weight, node, H, D):
    """Add weight times the block of the node next to a clamp."""
    if node < D.shape[0]:
        for x in range(3):
            for y in range(3):
                D[node, x, y] += weight * H[x, y]


@law
def assemble_pair(weight, i, j, k, s, H11, H12, H21, H22, D, near, far):
    """Add weight times the blocks of the three nodes of a pair of segments; Hij is the derivative of g_i with respect to d_j."""
    free = D.shape[0]
    for x in range(3):
        for y in range(3):
            a, b, c, d = weight * H11[x, y], weight * H12[x, y], weight * H21[x, y], weight * H22[x, y]
            if i < free:
                D[i, x, y] += a
            if j < free:
                D[j, x, y] += a - b - c + d
            if k < free:
                D[k, x, y] += d
            near[s, 0, x, y] += b - a
            near[s, 1, x, y] += c - a
            near[s + 1, 0, x, y] += b - d
            near[s + 1, 1, x, y] += c - d
            far[s, 0, x, y] -= b
            far[s, 1, x, y] -= c


@inlined_law
def step_of(base, q, i, j, L0):
    """Of a segment in a step from ``base`` to ``q``: both tangents, both lengths, S and e of the module, change of the tangent."""
    a, b = between_nodes(base, i, j), between_nodes(q, i, j)
    t_a, l_a = tangent_of_segment(a, L0)
    t_b, l_b = tangent_of_segment(b, L0)
    per = 1.0 / (l_a + l_b)
    e = combined(per, a, per, b)
    return t_a, t_b, l_a, l_b, 0.5 * (1.0 / l_a + 1.0 / l_b), e, combined(1.0, t_b, -1.0, t_a)


@inlined_law
def share_of_own(l1_a, l2_a, L0):
    """Share of its own mean tangent in what bends a segment: 1, and 0 beside one that is slack; see `bending`."""
    return 1.0 if min(l1_a, l2_a) > SLACK * L0 else 0.0


@inlined_law
def mean_bend(share, t1_a, t1_b, t2_a, t2_b, alpha, change):
    """The mean of t2 - share t1 over a step, and alpha times what its numerical damper acts on."""
    return combined(1.0, combined(0.5, combined(1.0, t2_a, -share, t1_a), 0.5, combined(1.0, t2_b, -share, t1_b)), alpha, change)


@inlined_law
def projected(S, e, w):
    """S (I - e e^T) w."""
    return combined(S, w, -S * dot(e, w), e)


@inlined_law
def own_step_block(H, B, S, e, t_b, l_a, l_b, w):
    """Derivative in d_b of -B S (I - e e^T) w at constant w, for H."""
    along, per = dot(e, w), S / (l_a + l_b)
    across = combined(1.0, w, -along, e)
    for x in range(3):
        for y in range(3):
            H[x, y] = B * (0.5 / (l_b * l_b) * across[x] * t_b[y] + per * (e[x] * w[y] - 2.0 * along * e[x] * t_b[y]))
        H[x, x] += B * per * along


@inlined_law
def cross_block(H, per, t1, t2):
    """per (I - t1 t1^T)(I - t2 t2^T), for H."""
    c = dot(t1, t2)
    for x in range(3):
        for y in range(3):
            H[x, y] = per * (c * t1[x] * t2[y] - t1[x] * t1[y] - t2[x] * t2[y])
        H[x, x] += per


@inlined_law
def add_turn_block(H, weight, S, e, t_b, l_b):
    """Add weight S (I - e e^T)(I - t_b t_b^T)/l_b to H."""
    c, per = dot(e, t_b), weight * S / l_b
    for x in range(3):
        for y in range(3):
            H[x, y] += per * (c * e[x] * t_b[y] - e[x] * e[y] - t_b[x] * t_b[y])
        H[x, x] += per
