"""The state of a net that a step leaves to the next one, so that a step can be taken again."""

from numba import int64, void

from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.model.net import view_net
from integrators.flat_view import flat


@inlined
def _exchange(numbers, memory, first, back):
    """Copy an array to ``memory``, from position ``first`` on, or back; return the position behind it."""
    for i in range(numbers.shape[0]):
        if back == 1:
            numbers[i] = memory[first + i]
        else:
            memory[first + i] = numbers[i]
    return first + numbers.shape[0]


@kernel(void(int64, int64))
def remember(net_address, back):
    """Remember the tensions and the linearised law of each segment, which the next step reads; restore them if ``back`` is 1."""
    net = view_net(net_address)
    first = _exchange(flat(net.segment), net.remembered, 0, back)
    first = _exchange(net.tension, net.remembered, first, back)
    first = _exchange(net.mean_tension, net.remembered, first, back)
    first = _exchange(net.linearised, net.remembered, first, back)
    _exchange(flat(net.crept), net.remembered, first, back)
