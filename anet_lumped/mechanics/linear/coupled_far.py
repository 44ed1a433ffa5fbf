"""The elimination of `chain` for nets whose effects join next-but-one neighbours, compiled when a scene first asks for it."""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.model.net import view_net
from integrators.flat_view import flat

from .bordered import eliminate_all_bordered, substitute_all_bordered
from .chain import (
    eliminate_all_groups,
    eliminate_all_singles,
    substitute_all_groups,
    substitute_all_singles,
)


@inlined
def _blocks(net_address):
    """The blocks between neighbours and between next-but-one neighbours."""
    net = view_net(net_address)
    return flat(net.near_blocks), flat(net.far_blocks)


@inlined
def _far_factors(net_address):
    """The factors by which a displacement depends on that of the next-but-one neighbour, see `chain`."""
    return (flat(view_net(net_address).far_factor),)


@on_demand
def eliminate_groups(net_address):
    """`eliminate_all_groups` with the blocks between next-but-one neighbours along a cable."""
    eliminate_all_groups(net_address, _blocks(net_address))


@on_demand
def eliminate_singles(net_address):
    """`eliminate_all_singles` with the blocks between next-but-one neighbours along a cable."""
    eliminate_all_singles(net_address, _blocks(net_address))


@on_demand
def eliminate_bordered(net_address):
    """`eliminate_all_bordered` with the blocks between next-but-one neighbours along a cable."""
    eliminate_all_bordered(net_address, _blocks(net_address))


@on_demand
def substitute_groups(net_address):
    """`substitute_all_groups` with the blocks between next-but-one neighbours along a cable."""
    return substitute_all_groups(net_address, _far_factors(net_address))


@on_demand
def substitute_singles(net_address):
    """`substitute_all_singles` with the blocks between next-but-one neighbours along a cable."""
    return substitute_all_singles(net_address, _far_factors(net_address))


@on_demand
def substitute_bordered(net_address):
    """`substitute_all_bordered` with the blocks between next-but-one neighbours along a cable."""
    return substitute_all_bordered(net_address, _far_factors(net_address))
