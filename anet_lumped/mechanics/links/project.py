"""Lengths given back: the smallest change of places and velocities, measured by the masses, after which links keep

    |q_b - q_a| = L    and    (q_b - q_a) . (v_b - v_a) = L L' .

Bodies get their shape back first, and move as one piece then. A change of the velocities is an impulse of the links. A cable that
is caught when it is straight, or whose end sets off at once, gets it without bounce.
"""

import math

import numpy as np
from numba import float64, int64

from anet_lumped.compiled.jit import internal, kernel
from anet_lumped.mechanics.optional import as_shape_bodies, as_stiffen_bodies
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_L0,
    AXIAL_L0_RATE,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    KERNEL_SHAPE_BODIES,
    KERNEL_STIFFEN_BODIES,
)

from .elimination import solve
from .motion import factored, set_masses, write_wanted

_f2 = float64[:, ::1]
NEAR = 1e-14  # of a length: near enough, some roundings
FAR = 1e-6  # of a length: beyond, the system is factored anew for the next sweep
KEPT = 1e-11  # of a length: what rounding may leave where constraints are redundant
SWEEPS = 8  # at most


@internal
def _lack_of_length(net, q):
    """Write the vectors of the links to ``links.vector`` and (L^2 - l^2)/2 to ``links.right_side``.

    Returns
    -------
    worst : float64
        The largest of these over L^2, among links that have a moving node.
    """
    links, worst = net.links, 0.0
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        a, L = net.cable[c, CABLE_START], net.axial[c, AXIAL_L0]
        for j in range(count):
            b, s = node + j if j < count - 1 else net.cable[c, CABLE_END], first + j
            x, y, z = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1], q[b, 2] - q[a, 2]
            links.vector[s, 0], links.vector[s, 1], links.vector[s, 2] = x, y, z
            lack = 0.5 * (L * L - (x * x + y * y + z * z))
            links.right_side[s] = lack
            if a < net.n_free or b < net.n_free:
                worst = max(worst, abs(lack) / (L * L))
            a = b
    return worst


@internal
def _work_of_impulse(net, v):
    """Work of driven nodes and of lengths that change against the impulse that was solved for last [J]."""
    links, work = net.links, 0.0
    before = links.driven[2]
    for c in range(net.cable.shape[0]):
        first, last = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_FIRST_SEGMENT] + net.cable[c, CABLE_SEGMENTS] - 1
        start, end = net.cable[c, CABLE_START] - net.n_driven, net.cable[c, CABLE_END] - net.n_driven
        for x in range(3):
            if start >= 0:
                mean = 0.5 * (before[start, x] + v[net.n_driven + start, x])
                work -= links.right_side[first] * links.vector[first, x] * mean
            if end >= 0:
                mean = 0.5 * (before[end, x] + v[net.n_driven + end, x])
                work += links.right_side[last] * links.vector[last, x] * mean
        rate = 0.5 * net.axial[c, AXIAL_L0_RATE]
        if rate != 0.0:
            for s in range(first, last + 1):
                d = links.vector[s]
                work -= links.right_side[s] * math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * rate
    return work


@kernel(float64(float64, int64, _f2, _f2))
def project(t, net_address, q, v):
    """Change a state at time t, whose prescribed rows hold that time's, so that links keep their lengths and the rates of these.

    ``links.tau`` holds the impulse of every link over its length [N s/m] afterwards.

    Parameters
    ----------
    t : float64 [s]
    net_address : int64
    q, v : (n, 3) float64 [m], [m/s]

    Returns
    -------
    work : float64 [J]
        Of driven nodes and of lengths that change against the impulse: the impulse times the mean of the velocities before and
        after it. Lengths count as if they had not changed before. NaN if no change of this state gives all links their lengths.
    """
    net = view_net(net_address)
    change = net.links.acceleration  # scratch
    with_bodies = net.bodies.first < net.n_free
    if with_bodies:
        as_shape_bodies(net.kernels[KERNEL_SHAPE_BODIES])(net_address, q)
    set_masses(net, t, q)
    passes, before, worst = factored(net, q), 1e300, _lack_of_length(net, q)
    for _ in range(SWEEPS):
        if worst <= NEAR or worst >= 0.5 * before:
            break
        for i in range(q.shape[0]):
            change[i, 0], change[i, 1], change[i, 2] = 0.0, 0.0, 0.0
        solve(net, change)
        for i in range(net.n_free):
            q[i, 0], q[i, 1], q[i, 2] = q[i, 0] + change[i, 0], q[i, 1] + change[i, 1], q[i, 2] + change[i, 2]
        if with_bodies:
            as_shape_bodies(net.kernels[KERNEL_SHAPE_BODIES])(net_address, q)
        before, worst = worst, _lack_of_length(net, q)
        if worst > FAR:
            set_masses(net, t, q)
            passes = factored(net, q)
            worst = _lack_of_length(net, q)
    if not worst <= KEPT:
        return np.nan
    if with_bodies:
        as_stiffen_bodies(net.kernels[KERNEL_STIFFEN_BODIES])(net_address, q, v)
    work, tau = 0.0, net.links.tau
    for k in range(passes):
        write_wanted(net, v, 1)
        solve(net, v)
        work += _work_of_impulse(net, v)
        for s in range(tau.shape[0]):
            tau[s] = net.links.right_side[s] + (tau[s] if k > 0 else 0.0)
    return work
