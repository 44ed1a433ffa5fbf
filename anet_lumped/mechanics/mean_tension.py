"""The mean of tensions over the stages of a Runge-Kutta step."""

from numba import float64, int64, void

from anet_lumped.compiled.jit import kernel
from anet_lumped.mechanics.effect_forces import clear
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import LINEARISED_MEAN_STEP


@kernel(void(int64, float64, float64))
def average(net_address, share, h):
    """Add ``share`` times the tensions of the stage solved last to their mean over a step of h [s]; a share of 0 begins a mean."""
    net = view_net(net_address)
    if share == 0.0:
        clear(net.mean_tension)
        net.linearised[LINEARISED_MEAN_STEP] = h
        return
    for s in range(net.mean_tension.shape[0]):
        net.mean_tension[s] += share * net.tension[s]
