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
def _axes(array, a, b, c, d):
    """Three directions across each other from four points, the longest of a body's axes first."""
    p, q, r, s = row(array, a), row(array, b), row(array, c), row(array, d)
    third = minus(plus(p, s), plus(q, r))
    second = minus(plus(p, r), plus(q, s))
    u = scaled(1.0 / math.sqrt(dot(third, third)), third)
    second = minus(second, scaled(dot(second, u), u))
    w = scaled(1.0 / math.sqrt(dot(second, second)), second)
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
    a = first + 1  # the four masses that stand for the body follow its origin
    reference = _axes(bodies.arm, a, a + 1, a + 2, a + 3)
    axes = _axes(q, bodies.node[a], bodies.node[a + 1], bodies.node[a + 2], bodies.node[a + 3])
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
