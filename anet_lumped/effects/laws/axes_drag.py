"""Drag on a body by the drag areas along its axes, and the inertia of the water about it.

With the unit vectors e_a of the axes, from the places of the body's origin and of points on its axes, and the velocity u of the
fluid relative to the origin,

    F = sum_a k_a |u_a| u_a e_a ,     u_a = u.e_a ,     k_a = rho/2 CdA_a .

In a fluid at rest F.v <= 0 whatever the axes are. The accelerated water pushes with M (a + sum_a Ca_a (a.e_a) e_a), and the added
mass is M sum_a Ca_a e_a e_a^T, with the displaced mass M.
A turn about each axis is resisted by the moment -c_a |w_a| w_a e_a, c_a = rho/2 CdA_rotation_a, with the angular velocity w of the
body; whether the fluid turns does not count. It is a couple of forces on the origin and on the point at the distance d on the next
axis b, along the third axis e: with their relative velocity s = (v_b - v_0).e = d w_a these are -+ c_a |s| s/d^3 e.
Source: Hall, MoorDyn V2, ASME IOWTC (2020), for the drag; DNV-RP-C205 (2010), 6.3.
"""

import math

from anet_lumped.compiled.jit import inlined_law


@inlined_law
def axis_of(origin, end):
    """Unit vector from one place to another, and the inverse of their distance [1/m]."""
    x, y, z = end[0] - origin[0], end[1] - origin[1], end[2] - origin[2]
    per = 1.0 / math.sqrt(x * x + y * y + z * z)
    return (per * x, per * y, per * z), per


@inlined_law
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined_law
def axes_drag(u, axes, k):
    """F of the module (3,) [N], for u (3,) [m/s], the three axes and k (3,) [kg/m]."""
    sx, sy, sz = dot(u, axes[0]), dot(u, axes[1]), dot(u, axes[2])
    fx, fy, fz = k[0] * abs(sx) * sx, k[1] * abs(sy) * sy, k[2] * abs(sz) * sz
    return (
        fx * axes[0][0] + fy * axes[1][0] + fz * axes[2][0],
        fx * axes[0][1] + fy * axes[1][1] + fz * axes[2][1],
        fx * axes[0][2] + fy * axes[1][2] + fz * axes[2][2],
    )


@inlined_law
def along_axes(a, axes, C):
    """sum_a C_a (a.e_a) e_a, (3,)."""
    sx, sy, sz = C[0] * dot(a, axes[0]), C[1] * dot(a, axes[1]), C[2] * dot(a, axes[2])
    return (
        sx * axes[0][0] + sy * axes[1][0] + sz * axes[2][0],
        sx * axes[0][1] + sy * axes[1][1] + sz * axes[2][1],
        sx * axes[0][2] + sy * axes[1][2] + sz * axes[2][2],
    )


@inlined_law
def subtract_axis_slopes(u, gradient, e, per, k, c_q, c_v, own, other):
    """Subtract c_q dF/dq + c_v dF/dv of one axis from the block of the origin, and from that of the axis' point in its row.

        dF/du = 2 k |s| e e^T ,     dF/dd = k |s| (2 e u^T + s I)(I - e e^T)/|d| ,     s = u.e ,

    with the vector d from the origin to the point. ``gradient`` (9,) [1/s] is that of the fluid's velocity, ``per`` is 1/|d|.
    """
    s = dot(u, e)
    a = k * abs(s)
    turning = c_q * a * per
    for x in range(3):
        for y in range(3):
            df_du_gradient = 2.0 * a * e[x] * (e[0] * gradient[y] + e[1] * gradient[3 + y] + e[2] * gradient[6 + y])
            df_dd = turning * (2.0 * e[x] * (u[y] - s * e[y]) + s * ((1.0 if x == y else 0.0) - e[x] * e[y]))
            own[x, y] -= c_q * df_du_gradient - c_v * 2.0 * a * e[x] * e[y] - df_dd
            other[x, y] -= df_dd


@inlined_law
def turning_drag(V, e, c, d):
    """Force on the point on the next axis (3,) [N], by its velocity relative to the origin V (3,) [m/s], see the module."""
    s = dot(V, e)
    k = -c * abs(s) * s / (d * d * d)
    return k * e[0], k * e[1], k * e[2]


@inlined_law
def subtract_turning_slopes(V, e, c, d, c_v, origin, point, across):
    """Subtract c_v dF/dv of `turning_drag` from the blocks of the origin and the point, and from both (2, 3, 3) between them."""
    k = 2.0 * c_v * c * abs(dot(V, e)) / (d * d * d)
    for x in range(3):
        for y in range(3):
            slope = k * e[x] * e[y]
            origin[x, y] += slope
            point[x, y] += slope
            across[0, x, y] -= slope
            across[1, x, y] -= slope
