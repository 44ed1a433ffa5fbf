"""Positions and velocities of driven points."""

from anet_lumped.compiled.jit import kernel
from anet_lumped.mechanics.optional import SIGNATURES
from anet_lumped.model.net import view_net
from anet_lumped.prescribed.path_kernel import evaluate


@kernel(SIGNATURES["drive"])
def drive(t, net_address, q, v):
    """Write position and velocity of the driven nodes at time t."""
    net = view_net(net_address)
    first, acceleration = net.n_driven, net.newton_step  # scratch: rows of prescribed nodes, which must be zero again afterwards
    evaluate(t, net.paths, q[first:], v[first:], acceleration[first:])
    for i in range(first, q.shape[0]):
        for x in range(3):
            acceleration[i, x] = 0.0
