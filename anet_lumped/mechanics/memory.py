"""What one step of a method leaves to the next."""

from numba import int64, void

from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.model.net import view_net
from integrators.flat_view import flat


@inlined
def _exchange(own, copy, at, back):
    """Copy an array to ``copy`` from ``at`` on, or back; returns where it ends there."""
    for i in range(own.shape[0]):
        if back == 1:
            own[i] = copy[at + i]
        else:
            copy[at + i] = own[i]
    return at + own.shape[0]


@kernel(void(int64, int64))
def remember(net_address, back):
    """Copy what steps leave to the next: the tensions and the law of each segment; or put it back if ``back`` is 1."""
    net = view_net(net_address)
    at = _exchange(flat(net.segment), net.remembered, 0, back)
    at = _exchange(net.tension, net.remembered, at, back)
    at = _exchange(net.mean_tension, net.remembered, at, back)
    _exchange(net.linearised, net.remembered, at, back)
