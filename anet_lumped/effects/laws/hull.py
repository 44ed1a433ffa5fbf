"""The lift of a box-shaped hull, on the first four nodes of its body: its origin, and a point on each of its axes.

The heights of these nodes are linear in the height c of the hull's centre and in the vertical components n of the axes, see `box`.
So the forces on them are vertical, and lift and moment are those of the part under water.

``numbers`` of a body, from `fluid_on_bodies.FluidOnBodies.table`, holds the distance of the points on its axes from its origin in
column 9, the edges of the hull from column 10 on, and its centre from column 13 on. ``index[at:at + 4]`` are the nodes, and
``index[at + 5]`` is the first of the rows of their pairs.
"""

from anet_lumped.compiled.jit import inlined_law, law

from .box import box_immersed
from .submergence import SMALL_CHANGE

NONE = (0.0, 0.0, 0.0, 0.0)


@inlined_law
def _from_heights(z0, zx, zy, zz, numbers):
    """c and n of `laws.box` from heights of the first four nodes of a body above the surface."""
    per = 1.0 / numbers[9]
    n = (per * (zx - z0), per * (zy - z0), per * (zz - z0))
    return z0 + numbers[13] * n[0] + numbers[14] * n[1] + numbers[15] * n[2], n


@inlined_law
def _column(numbers, i):
    """Slopes of (c, n) in the height of the i-th of the first four nodes of a body."""
    per = 1.0 / numbers[9]
    if i == 0:
        return 1.0 - per * (numbers[13] + numbers[14] + numbers[15]), -per, -per, -per
    return per * numbers[12 + i], per if i == 1 else 0.0, per if i == 2 else 0.0, per if i == 3 else 0.0


@inlined_law
def _dot4(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]


@inlined_law
def _times(H, x):
    """The symmetric matrix H (10,) times x (4,)."""
    return (
        H[0] * x[0] + H[1] * x[1] + H[2] * x[2] + H[3] * x[3], H[1] * x[0] + H[4] * x[1] + H[5] * x[2] + H[6] * x[3],
        H[2] * x[0] + H[5] * x[1] + H[7] * x[2] + H[8] * x[3], H[3] * x[0] + H[6] * x[1] + H[8] * x[2] + H[9] * x[3],
    )  # fmt: skip


@law
def add_lift_slopes(index, at, numbers, weight, H, u, w, D, near):
    """Add ``weight`` times the matrix H + u w^T over (c, n), in the heights of the first four nodes, to their blocks."""
    pair = 0
    for i in range(4):
        of_i = _column(numbers, i)
        by_i, u_i, w_i = _times(H, of_i), _dot4(u, of_i), _dot4(w, of_i)
        D[index[at + i], 2, 2] += weight * (_dot4(by_i, of_i) + u_i * w_i)
        for j in range(i + 1, 4):
            of_j = _column(numbers, j)
            both, row = _dot4(by_i, of_j), index[at + 5] + pair
            near[row, 0, 2, 2] += weight * (both + u_i * _dot4(w, of_j))
            near[row, 1, 2, 2] += weight * (both + _dot4(u, of_j) * w_i)
            pair += 1


@inlined_law
def _mean(base, q, i):
    return 0.5 * (base[i, 2] + q[i, 2])


@law
def hull_immersed(base, q, level, index, at, numbers):
    """`Immersed` of a hull in the middle of base and q, under a surface at a level [m]."""
    c, n = _from_heights(
        _mean(base, q, index[at]) - level, _mean(base, q, index[at + 1]) - level, _mean(base, q, index[at + 2]) - level,
        _mean(base, q, index[at + 3]) - level, numbers,
    )  # fmt: skip
    return box_immersed(c, n, (numbers[10], numbers[11], numbers[12]))


@inlined_law
def hull_share(wet, numbers):
    """Share of a hull that is under water."""
    return -wet.g[0] / (numbers[10] * numbers[11] * numbers[12])


@inlined_law
def weight_on_node(g, numbers, i):
    """Slope in the height of the i-th of the four nodes, from the slopes g in (c, n)."""
    return _dot4(g, _column(numbers, i))


@law
def add_lift_over_step(base, q, level, per_volume, index, at, numbers, f, D, near):
    """Lift of a hull over a step in still water: its work is the change of its energy.

    With x = (c, n), the change d of x, and the metric m = (1, R, R, R), R the square of the gyration radius,

        g = g(mean) + e m d ,     e = (I_b - I_a - g(mean).d)/(d.m d) .
    """
    o, x, y, z = index[at], index[at + 1], index[at + 2], index[at + 3]
    c_a, n_a = _from_heights(base[o, 2] - level, base[x, 2] - level, base[y, 2] - level, base[z, 2] - level, numbers)
    c_b, n_b = _from_heights(q[o, 2] - level, q[x, 2] - level, q[y, 2] - level, q[z, 2] - level, numbers)
    edges, R = (numbers[10], numbers[11], numbers[12]), numbers[9] * numbers[9]
    d = (c_b - c_a, n_b[0] - n_a[0], n_b[1] - n_a[1], n_b[2] - n_a[2])
    mean_n = (0.5 * (n_a[0] + n_b[0]), 0.5 * (n_a[1] + n_b[1]), 0.5 * (n_a[2] + n_b[2]))
    mean = box_immersed(0.5 * (c_a + c_b), mean_n, edges)
    md = (d[0], R * d[1], R * d[2], R * d[3])
    square, g, w = _dot4(d, md), mean.g, (0.0, 0.0, 0.0, 0.0)
    e = 0.0
    if square > (SMALL_CHANGE * numbers[3]) ** 2:
        before, after = box_immersed(c_a, n_a, edges), box_immersed(c_b, n_b, edges)
        e = (after.I - before.I - _dot4(g, d)) / square
        H, per, e2, after_g = _times(mean.H, d), 1.0 / square, 2.0 * e, after.g
        w = (
            per * (after_g[0] - g[0] - 0.5 * H[0] - e2 * md[0]), per * (after_g[1] - g[1] - 0.5 * H[1] - e2 * md[1]),
            per * (after_g[2] - g[2] - 0.5 * H[2] - e2 * md[2]), per * (after_g[3] - g[3] - 0.5 * H[3] - e2 * md[3]),
        )  # fmt: skip
        g = (g[0] + e * md[0], g[1] + e * md[1], g[2] + e * md[2], g[3] + e * md[3])
    for i in range(4):
        f[index[at + i], 2] -= per_volume * _dot4(g, _column(numbers, i))
    m = mean.H
    K = (
        0.5 * m[0] + e, 0.5 * m[1], 0.5 * m[2], 0.5 * m[3], 0.5 * m[4] + e * R, 0.5 * m[5], 0.5 * m[6], 0.5 * m[7] + e * R,
        0.5 * m[8], 0.5 * m[9] + e * R,
    )  # fmt: skip
    add_lift_slopes(index, at, numbers, per_volume, K, md, w, D, near)
