"""Positions and velocities of driven points, and of the points of driven bodies."""

from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.mechanics.optional import SIGNATURES
from anet_lumped.model.net import view_net
from anet_lumped.prescribed.path_kernel import evaluate
from anet_lumped.prescribed.turning_kernel import cross, spin, turned


@inlined
def evaluate_driven(t, net, q, v, a):
    """Write the places, velocities and accelerations of the driven nodes at time t, one row a node.

    A point of a driven body is at r + R d, with the path r of its origin and the rotation R of the path of its rotation vector; d
    is its arm as it starts. It has the acceleration r'' + w' x R d + w x (w x R d).
    """
    carried, points = net.carried, q.shape[0] - net.carried.body.shape[0]
    if carried.body.shape[0] == 0:
        evaluate(t, net.paths, q, v, a)
        return
    values = carried.values
    evaluate(t, net.paths, values[0], values[1], values[2])
    for i in range(points):
        for x in range(3):
            q[i, x], v[i, x], a[i, x] = values[0, i, x], values[1, i, x], values[2, i, x]
    for k in range(carried.body.shape[0]):
        i, origin = points + k, points + 2 * carried.body[k]
        turn = origin + 1
        phi = values[0, turn, 0], values[0, turn, 1], values[0, turn, 2]
        rate = values[1, turn, 0], values[1, turn, 1], values[1, turn, 2]
        second = values[2, turn, 0], values[2, turn, 1], values[2, turn, 2]
        omega, alpha = spin(phi, rate, second)
        arm = turned(phi, (carried.arm[k, 0], carried.arm[k, 1], carried.arm[k, 2]))
        across, tangential = cross(omega, arm), cross(alpha, arm)
        inward = cross(omega, across)
        for x in range(3):
            q[i, x], v[i, x] = values[0, origin, x] + arm[x], values[1, origin, x] + across[x]
            a[i, x] = values[2, origin, x] + tangential[x] + inward[x]


@kernel(SIGNATURES["drive"])
def drive(t, net_address, q, v):
    """Write position and velocity of the driven nodes at time t."""
    net = view_net(net_address)
    first = net.n_driven
    acceleration = net.newton_step  # scratch: its rows of prescribed nodes must be zero again afterwards
    evaluate_driven(t, net, q[first:], v[first:], acceleration[first:])
    for i in range(first, q.shape[0]):
        for x in range(3):
            acceleration[i, x] = 0.0
