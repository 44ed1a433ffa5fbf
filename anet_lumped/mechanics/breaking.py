"""Distance of the cables from breaking."""

from numba import float64, int64

from anet_lumped.compiled.jit import kernel
from anet_lumped.mechanics.observe import observe_cables
from anet_lumped.model.net import view_net
from integrators.system import NO_EVENTS


@kernel(float64(float64[:, ::1], float64[:, ::1], int64))
def margin(q, v, net_address):
    """Largest T/T_max - 1 over the segments of cables that may break, T of `observe_cables`; `NO_EVENTS` if no cable may break."""
    net = view_net(net_address)
    largest = NO_EVENTS
    if net.breaking_tension.shape[0] > 0:
        observe_cables(q, v, net_address, net.observed_tension)
        for s in range(net.breaking_tension.shape[0]):
            largest = max(largest, net.observed_tension[s] / net.breaking_tension[s] - 1.0)
    return largest
