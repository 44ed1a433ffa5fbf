"""Drag of a fluid on a segment and on a point: the law that air and water share.

The cross-flow principle: let t be the unit tangent of a segment, and u the velocity of the fluid relative to it, with the part
u_n = u - (u.t) t across and the component s = u.t along the segment. The force per length is

    rho/2 d (Cdn |u_n| u_n + pi Cdt |s| s t) .

Each node of a segment carries half of this force, taken at the node's own velocity. So the force on a node depends on no other
node's velocity. In a fluid at rest no node gains energy: f.v = -(normal |v_n|^3 + along |v_t|^3) <= 0. The area is the area d L0 of
the unstretched cable, since a stretched cable is longer and thinner.

The forces are written in plain arithmetic and `select`, so that JAX can trace the lines that Numba compiles (`axial.with_select`).

Source
------
Hoerner, Fluid-Dynamic Drag (1965), ch. 3; DNV-RP-C205 (2010), 6.2 and 6.3 (normal and tangential force on an inclined cylinder).
"""

import math

from anet_lumped.compiled.jit import inlined_law

from .axial import select

SHORTEST = 1e-2  # of the rest length: a shorter segment turns in the tangent as one of this length does


def segment_coefficients(density, cable):
    """Drag coefficients that a node has of one segment of a cable: half of those of the segment.

    Returns
    -------
    normal, along : float [kg/m]
        rho/2 d Cdn L0/2 and rho/2 pi d Cdt L0/2; the force is normal |u_n| u_n + along |s| s t.
    """
    half = 0.25 * density * cable.diameter * cable.L0
    return half * cable.Cdn, half * math.pi * cable.Cdt


def point_coefficient(density, point):
    """Drag coefficient of the body that a point carries, rho/2 CdA [kg/m]; the force is the coefficient times |u| u."""
    return 0.5 * density * point.CdA


@inlined_law
def vector_length(x, y, z):
    """Length of a vector, differentiable where it is zero."""
    square = x * x + y * y + z * z
    nonzero = square > 0.0
    return select(nonzero, select(nonzero, square, 1.0) ** 0.5, 0.0)


@inlined_law
def tangent_of(dx, dy, dz, L0):
    """Unit vector along d = (dx, dy, dz), and 1/l, by which a change of d across that vector turns it [1/m].

    The vector is shorter than 1 only if l < 1e-12 L0. For l < `SHORTEST` L0, 1/(SHORTEST L0) takes the place of 1/l.
    """
    l = vector_length(dx, dy, dz)
    per_l = 1.0 / select(l > 1e-12 * L0, l, 1e-12 * L0)
    return dx * per_l, dy * per_l, dz * per_l, 1.0 / select(l > SHORTEST * L0, l, SHORTEST * L0)


@inlined_law
def segment_drag(ux, uy, uz, tx, ty, tz, normal, along):
    """Force on a node from its half of a segment, f = normal |u_n| u_n + along |s| s t.

    Parameters
    ----------
    ux, uy, uz : float64 [m/s]
        Velocity of the fluid less the velocity of the node.
    tx, ty, tz : float64
        Unit tangent of the segment.
    normal, along : float64 [kg/m]
        From `segment_coefficients`.

    Returns
    -------
    fx, fy, fz : float64 [N]

    Source
    ------
    DNV-RP-C205 (2010), 6.2.2 and 6.3; see the module.
    """
    s = ux * tx + uy * ty + uz * tz
    nx, ny, nz = ux - s * tx, uy - s * ty, uz - s * tz
    across, lengthwise = normal * vector_length(nx, ny, nz), along * abs(s) * s
    return across * nx + lengthwise * tx, across * ny + lengthwise * ty, across * nz + lengthwise * tz


@inlined_law
def subtract_segment_slopes(u, gradient, t, per_l, normal, along, side, c_q, c_v, own, other):
    """Subtract c_q df/dq + c_v df/dv of `segment_drag` from blocks of the tangent.

    With a = normal |u_n|, b = normal/|u_n|, c = 2 along |s|, and the vector d of length l from the segment's start to its end,

        df/du = a I + (c - a) t t^T + b u_n u_n^T ,     df/dv = -df/du ,
        df/dd = ((c/2 - a) s (I - t t^T) + (c - a) t u_n^T - b s u_n u_n^T)/l .

    Parameters
    ----------
    u : tuple of 3 float64 [m/s]
    gradient : tuple of 9 float64 [1/s]
        Derivatives of the fluid's velocity with respect to position, row by row; an empty tuple where they are zero.
    t, per_l : tuple of 3 float64, float64 [1/m]
        From `tangent_of`.
    normal, along : float64 [kg/m]
    side : float64
        -1 for the node at the segment's start, 1 for the node at its end.
    c_q, c_v : float64 [1], [1/s]
    own : (3, 3) float64 [N/m]
        Diagonal block of the node.
    other : (3, 3) float64 [N/m]
        Block in the row of the node and the column of the segment's other node.
    """
    s = u[0] * t[0] + u[1] * t[1] + u[2] * t[2]
    n = (u[0] - s * t[0], u[1] - s * t[1], u[2] - s * t[2])
    speed = vector_length(n[0], n[1], n[2])
    a, c = normal * speed, 2.0 * along * abs(s)
    b, turning = normal / speed if speed > 0.0 else 0.0, side * c_q * per_l
    k, of_tn, of_nn, of_tt = turning * (0.5 * c - a) * s, turning * (c - a), turning * s * b, c_v * (c - a)
    turned = (of_tn * n[0] - k * t[0], of_tn * n[1] - k * t[1], of_tn * n[2] - k * t[2])
    _add(t, turned, n, (-of_nn * n[0], -of_nn * n[1], -of_nn * n[2]), k, other)
    at_t, of_nn = (of_tt * t[0] - turned[0], of_tt * t[1] - turned[1], of_tt * t[2] - turned[2]), of_nn + c_v * b
    _add(t, at_t, n, (of_nn * n[0], of_nn * n[1], of_nn * n[2]), c_v * a - k, own)
    if len(gradient) > 0:
        _add(t, _row_times(-c_q * (c - a), t, gradient), n, _row_times(-c_q * b, n, gradient), 0.0, own)
        subtract_multiple(c_q * a, gradient, own)


@inlined_law
def _row_times(factor, x, g):
    """Row vector factor x^T G, of a vector x and a matrix G (9,)."""
    return (
        factor * (x[0] * g[0] + x[1] * g[3] + x[2] * g[6]),
        factor * (x[0] * g[1] + x[1] * g[4] + x[2] * g[7]),
        factor * (x[0] * g[2] + x[1] * g[5] + x[2] * g[8]),
    )


@inlined_law
def subtract_multiple(factor, g, block):
    """Subtract factor G from a block, of a matrix G (9,), an empty tuple for zero."""
    if len(g) == 0:
        return
    for x in range(3):
        block[0, x] -= factor * g[x]
        block[1, x] -= factor * g[3 + x]
        block[2, x] -= factor * g[6 + x]


@inlined_law
def _add(t, a, n, b, c, block):
    """Add t a^T + n b^T + c I to a block.

    Entries of tuples are named one by one: compiled code that takes an entry by a variable branches over all of them, which took
    twenty times as long as the arithmetic.
    """
    block[0, 0] += t[0] * a[0] + n[0] * b[0] + c
    block[0, 1] += t[0] * a[1] + n[0] * b[1]
    block[0, 2] += t[0] * a[2] + n[0] * b[2]
    block[1, 0] += t[1] * a[0] + n[1] * b[0]
    block[1, 1] += t[1] * a[1] + n[1] * b[1] + c
    block[1, 2] += t[1] * a[2] + n[1] * b[2]
    block[2, 0] += t[2] * a[0] + n[2] * b[0]
    block[2, 1] += t[2] * a[1] + n[2] * b[1]
    block[2, 2] += t[2] * a[2] + n[2] * b[2] + c


@inlined_law
def point_drag(ux, uy, uz, coefficient):
    """Force (fx, fy, fz) [N] on the body that a point carries, f = coefficient |u| u, with the coefficient rho/2 CdA [kg/m]."""
    a = coefficient * vector_length(ux, uy, uz)
    return a * ux, a * uy, a * uz


@inlined_law
def subtract_point_slopes(u, gradient, coefficient, c_q, c_v, own):
    """Subtract c_q df/dq + c_v df/dv of `point_drag` from a diagonal block: df/du = coefficient (|u| I + u u^T/|u|)."""
    speed = vector_length(u[0], u[1], u[2])
    a = coefficient * speed
    b = coefficient / speed if speed > 0.0 else 0.0
    x, y, z = c_v * b * u[0], c_v * b * u[1], c_v * b * u[2]
    _add(u, (x, y, z), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), c_v * a, own)
    if len(gradient) > 0:
        _add(u, _row_times(-c_q * b, u, gradient), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, own)
        subtract_multiple(c_q * a, gradient, own)
