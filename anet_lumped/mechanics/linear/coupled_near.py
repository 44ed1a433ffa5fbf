"""The elimination of `chain` for nets whose effects join neighbours along a cable, compiled when a scene first asks for it.

The substitution is that of `chain`, since each displacement still depends on that of one neighbour alone.
"""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.model.net import view_net
from integrators.flat_view import flat

from .bordered import eliminate_all_bordered
from .chain import eliminate_all_groups, eliminate_all_singles


@inlined
def _blocks(net_address):
    """The blocks between neighbours."""
    return (flat(view_net(net_address).near_blocks),)


@on_demand
def eliminate_groups(net_address):
    """`eliminate_all_groups` with the blocks between neighbours along a cable."""
    eliminate_all_groups(net_address, _blocks(net_address))


@on_demand
def eliminate_singles(net_address):
    """`eliminate_all_singles` with the blocks between neighbours along a cable."""
    eliminate_all_singles(net_address, _blocks(net_address))


@on_demand
def eliminate_bordered(net_address):
    """`eliminate_all_bordered` with the blocks between neighbours along a cable."""
    eliminate_all_bordered(net_address, _blocks(net_address))
