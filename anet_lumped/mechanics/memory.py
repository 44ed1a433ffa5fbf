"""What one step of a method leaves to the next."""

from numba import float64, int64, njit, void

from anet_lumped.model.net import net_at
from anet_lumped.model.tables import (
    LINEARISED_MEAN_STEP,
)


@njit(cache=True, error_model="numpy", forceinline=True)
def _exchange(own, copy, at, back):
    """Copy an array to ``copy`` from ``at`` on, or back; returns where it ends there."""
    for i in range(own.shape[0]):
        if back == 1:
            own[i] = copy[at + i]
        else:
            copy[at + i] = own[i]
    return at + own.shape[0]


@njit(void(int64, int64), cache=True, error_model="numpy")
def remember(place, back):
    """Copy what steps leave to the next: the tensions and the law of each segment; or put it back if ``back`` is 1."""
    net = net_at(place)
    at = _exchange(net.segment.ravel(), net.remembered, 0, back)
    at = _exchange(net.tension, net.remembered, at, back)
    at = _exchange(net.mean, net.remembered, at, back)
    _exchange(net.linearised, net.remembered, at, back)


@njit(void(int64, float64, float64), cache=True, error_model="numpy", fastmath={"contract"})
def average(place, share, h):
    """Add a share of the tensions that balance the stage solved last to their mean over a step of h seconds; 0 begins one."""
    net = net_at(place)
    if share == 0.0:
        net.mean[:] = 0.0
        net.linearised[LINEARISED_MEAN_STEP] = h
        return
    for s in range(net.mean.shape[0]):
        net.mean[s] += share * net.tension[s]
