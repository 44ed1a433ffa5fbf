"""Tensions and energies of a state whose cables are taken by fours; compiled when a scene first has such cables."""

from numba import float64, int64, void

from anet_lumped.compiled.jit import kernel
from anet_lumped.compiled.lanes import WIDTH, group_members
from anet_lumped.mechanics.cable_rows import sum_of_members
from anet_lumped.mechanics.observe import elastic_energy_of_cable, energies_of_singles, observe_cable, observe_singles
from anet_lumped.mechanics.plain_cables import are_plain, law_of, plain_law_of, plain_spring
from anet_lumped.mechanics.segment_law import spring_of
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import LINEARISED_LAW
from integrators.stage import LAW_BETWEEN
from integrators.system import ELASTIC

_f1, _f2 = float64[::1], float64[:, ::1]


@kernel(void(_f2, _f2, int64, _f1))
def observe(q, v, net_address, tension):
    """`observe.observe_singles` of all cables."""
    observe_singles(q, v, net_address, tension)
    net = view_net(net_address)
    stage_law = net.linearised[LINEARISED_LAW]
    for g in range(net.cable_groups.shape[0]):
        c = group_members(net.cable_groups, g)
        if are_plain(stage_law, net, c):
            observe_cable(net, c, LAW_BETWEEN, plain_law_of(net, c), q, v, tension, None)
        else:
            observe_cable(net, c, stage_law, law_of(net, c), q, v, tension, None)


@kernel(void(float64, _f2, _f2, int64, _f1))
def energies(t, q, v, net_address, energy):
    """`observe.energies_of_singles` of all cables."""
    energies_of_singles(t, q, v, net_address, energy)
    net = view_net(net_address)
    for g in range(net.cable_groups.shape[0]):
        c = group_members(net.cable_groups, g)
        if are_plain(LAW_BETWEEN, net, c):
            of_cables = elastic_energy_of_cable(net, c, plain_spring(net, c), q, None)
        else:
            of_cables = elastic_energy_of_cable(net, c, spring_of(net, c), q, None)
        energy[ELASTIC] += sum_of_members(of_cables, net.cable_groups[g, WIDTH])
