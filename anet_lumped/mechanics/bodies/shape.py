"""Bodies of explicit steps: each step leaves their nodes a little out of shape, and this gives their shape back."""

import math

from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.model.net import view_net

from .settling import stiffen_body
from .vectors import added, cross, dot, inertia_of, minus, plus, put, row, scaled, solved, turned

_f2 = float64[:, ::1]

REFINEMENTS = 2  # of a rotation that is off by what one step leaves out


@inlined
def _axes(array, origin, x, y):
    """Three directions across each other, from the places of the origin of a body and of points on its first two axes."""
    to_x, to_y = minus(row(array, x), row(array, origin)), minus(row(array, y), row(array, origin))
    u = scaled(1.0 / math.sqrt(dot(to_x, to_x)), to_x)
    across = minus(to_y, scaled(dot(to_y, u), u))
    w = scaled(1.0 / math.sqrt(dot(across, across)), across)
    return u, w, cross(u, w)


@inlined
def _between(reference, axes, arm):
    """The vector ``arm`` turned as the axes are from the reference axes."""
    x, y, z = dot(reference[0], arm), dot(reference[1], arm), dot(reference[2], arm)
    return plus(scaled(x, axes[0]), plus(scaled(y, axes[1]), scaled(z, axes[2])))


@inlined
def keep_shape(net, b, q):
    """Move the nodes of a body to the nearest place at which it has its shape, by the masses of the nodes."""
    bodies = net.bodies
    first, end = bodies.node_at[b], bodies.node_at[b + 1]
    reference = _axes(bodies.arm, first, first + 1, first + 2)  # points on the axes of a body follow its origin
    axes = _axes(q, bodies.node[first], bodies.node[first + 1], bodies.node[first + 2])
    mass, centre, middle = 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(first, end):
        m = net.mass[bodies.node[k]]
        mass, centre = mass + m, plus(centre, scaled(m, row(q, bodies.node[k])))
        middle = plus(middle, scaled(m, row(bodies.arm, k)))
    centre, middle = scaled(1.0 / mass, centre), scaled(1.0 / mass, middle)
    pivot = bodies.pivot[b]
    if pivot >= 0:
        centre = row(q, pivot)
        for k in range(first, end):
            if bodies.node[k] == pivot:
                middle = row(bodies.arm, k)
    for k in range(first, end):
        put(bodies.arm_end, k, _between(reference, axes, minus(row(bodies.arm, k), middle)))
    for _ in range(REFINEMENTS):
        inertia, moment = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for k in range(first, end):
            arm, m = row(bodies.arm_end, k), net.mass[bodies.node[k]]
            d = minus(minus(row(q, bodies.node[k]), centre), arm)
            s = plus(arm, scaled(0.5, d))
            inertia, moment = added(inertia, inertia_of(m, s)), plus(moment, scaled(m, cross(s, d)))
        theta = solved(inertia, moment)
        for k in range(first, end):
            put(bodies.arm_end, k, turned(theta, row(bodies.arm_end, k)))
    for k in range(first, end):
        put(q, bodies.node[k], plus(centre, row(bodies.arm_end, k)))


@kernel(types.float64(float64, int64, _f2, _f2))
def keep_bodies(t, net_address, q, v):
    """`System.project` of a net with bodies: shape and velocities of one piece; momenta stay, and no work is put in."""
    net = view_net(net_address)
    for b in range(net.bodies.pivot.shape[0]):
        keep_shape(net, b, q)
        stiffen_body(net, b, q, v)
    return 0.0
