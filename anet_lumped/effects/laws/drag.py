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
        Derivatives of the fluid's velocity with respect to position, row by row.
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
    b = normal / speed if speed > 0.0 else 0.0
    factors, turning = (a, b, c, s), side * c_q * per_l
    _subtract_row(0, (1.0, 0.0, 0.0), t[0], n[0], t, n, factors, turning, gradient, c_q, c_v, own, other)
    _subtract_row(1, (0.0, 1.0, 0.0), t[1], n[1], t, n, factors, turning, gradient, c_q, c_v, own, other)
    _subtract_row(2, (0.0, 0.0, 1.0), t[2], n[2], t, n, factors, turning, gradient, c_q, c_v, own, other)


@inlined_law
def _subtract_row(x, e, tx, nx, t, n, factors, turning, gradient, c_q, c_v, own, other):
    """Row x, of the unit vector e, of `subtract_segment_slopes`.

    Entries of tuples are named one by one: compiled code that takes an entry by a variable branches over all of them, which took
    twenty times as long as the arithmetic.
    """
    a, b, c, s = factors
    du0 = (c - a) * tx * t[0] + b * nx * n[0] + a * e[0]
    du1 = (c - a) * tx * t[1] + b * nx * n[1] + a * e[1]
    du2 = (c - a) * tx * t[2] + b * nx * n[2] + a * e[2]
    dd0 = turning * ((0.5 * c - a) * s * (e[0] - tx * t[0]) + (c - a) * tx * n[0] - s * b * nx * n[0])
    dd1 = turning * ((0.5 * c - a) * s * (e[1] - tx * t[1]) + (c - a) * tx * n[1] - s * b * nx * n[1])
    dd2 = turning * ((0.5 * c - a) * s * (e[2] - tx * t[2]) + (c - a) * tx * n[2] - s * b * nx * n[2])
    own[x, 0] -= dd0 + c_q * (du0 * gradient[0] + du1 * gradient[3] + du2 * gradient[6]) - c_v * du0
    own[x, 1] -= dd1 + c_q * (du0 * gradient[1] + du1 * gradient[4] + du2 * gradient[7]) - c_v * du1
    own[x, 2] -= dd2 + c_q * (du0 * gradient[2] + du1 * gradient[5] + du2 * gradient[8]) - c_v * du2
    other[x, 0] += dd0
    other[x, 1] += dd1
    other[x, 2] += dd2


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
    along0 = u[0] * gradient[0] + u[1] * gradient[3] + u[2] * gradient[6]
    along1 = u[0] * gradient[1] + u[1] * gradient[4] + u[2] * gradient[7]
    along2 = u[0] * gradient[2] + u[1] * gradient[5] + u[2] * gradient[8]
    own[0, 0] -= c_q * (b * u[0] * along0 + a * gradient[0]) - c_v * (b * u[0] * u[0] + a)
    own[0, 1] -= c_q * (b * u[0] * along1 + a * gradient[1]) - c_v * (b * u[0] * u[1])
    own[0, 2] -= c_q * (b * u[0] * along2 + a * gradient[2]) - c_v * (b * u[0] * u[2])
    own[1, 0] -= c_q * (b * u[1] * along0 + a * gradient[3]) - c_v * (b * u[1] * u[0])
    own[1, 1] -= c_q * (b * u[1] * along1 + a * gradient[4]) - c_v * (b * u[1] * u[1] + a)
    own[1, 2] -= c_q * (b * u[1] * along2 + a * gradient[5]) - c_v * (b * u[1] * u[2])
    own[2, 0] -= c_q * (b * u[2] * along0 + a * gradient[6]) - c_v * (b * u[2] * u[0])
    own[2, 1] -= c_q * (b * u[2] * along1 + a * gradient[7]) - c_v * (b * u[2] * u[1])
    own[2, 2] -= c_q * (b * u[2] * along2 + a * gradient[8]) - c_v * (b * u[2] * u[2] + a)
