"""Inner states of effects, such as the phases of vortices: observed with the tensions, and remembered where a step is taken again.

For scenes that have some; others compile and call none of this.
"""

from numba import int64, void

from anet_lumped.compiled.jit import kernel
from anet_lumped.mechanics.memory import remember
from anet_lumped.mechanics.observe import observe
from anet_lumped.model.net import view_net
from integrators.system import OBSERVE


@kernel(OBSERVE)
def observe_and_inner(t, q, v, net_address, row, energy):
    """`observe.observe`, then the inner states at the end of a row that has room for more than tensions."""
    observe(t, q, v, net_address, row, energy)
    net = view_net(net_address)
    inner, params = net.effects.inner, net.effects.params
    if row.shape[0] > net.tension.shape[0]:
        first = row.shape[0] - inner.shape[0]
        for i in range(inner.shape[0]):
            row[first + i] = params[inner[i]]


@kernel(void(int64, int64))
def remember_with_inner(net_address, back):
    """`memory.remember`, and the inner states at the end of the memory."""
    remember(net_address, back)
    net = view_net(net_address)
    inner, params, memory = net.effects.inner, net.effects.params, net.remembered
    first = memory.shape[0] - inner.shape[0]
    for i in range(inner.shape[0]):
        if back == 1:
            params[inner[i]] = memory[first + i]
        else:
            memory[first + i] = params[inner[i]]
