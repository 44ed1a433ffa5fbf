"""What one step of a method leaves to the next."""

from numba import float64, int64, void

from anet_lumped.compiled.flat_view import flat
from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.mechanics.effect_forces import clear
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    LINEARISED_MEAN_STEP,
)


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


@kernel(void(int64, float64, float64))
def average(net_address, share, h):
    """Add a share of the tensions that balance the stage solved last to their mean over a step of h seconds; 0 begins one."""
    net = view_net(net_address)
    if share == 0.0:
        clear(net.mean_tension)
        net.linearised[LINEARISED_MEAN_STEP] = h
        return
    for s in range(net.mean_tension.shape[0]):
        net.mean_tension[s] += share * net.tension[s]
