"""The largest tension of each cable so far, looked at after steps whose states are not saved (`System.notice`)."""

from anet_lumped.compiled.jit import internal, kernel
from anet_lumped.mechanics.observe import observe_cables
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import CABLE_FIRST_SEGMENT, CABLE_SEGMENTS
from integrators.system import NOTICE

RISE = 1e-4  # of the tension that acted in a step, above the largest so far, from which on the tensions at its end are looked at


@internal
def _largest_of_cable(net, c, tension):
    """Largest tension of a cable [N]; 0 where all of it is slack or pushes."""
    first, largest = net.cable[c, CABLE_FIRST_SEGMENT], 0.0
    for s in range(first, first + net.cable[c, CABLE_SEGMENTS]):
        largest = max(largest, tension[s])
    return largest


@internal
def take_in(net, tension, noticed):
    """Let ``noticed`` take in the tensions of a state (n_segments,) [N]."""
    for c in range(net.cable.shape[0]):
        noticed[c] = max(noticed[c], _largest_of_cable(net, c, tension))


@kernel(NOTICE)
def notice_acting(t, q, v, net_address, row, noticed):
    """Look at a state after an implicit step.

    The step knows the tensions that acted in it. Where those of a cable are larger than ever, the tensions at its end are found,
    those that a run would have saved: about once on each flank of a peak higher than all before.
    """
    net, rises = view_net(net_address), False
    cables = net.cable.shape[0]
    for c in range(cables):
        acted = _largest_of_cable(net, c, net.tension)
        if acted > (1.0 + RISE) * noticed[cables + c]:
            noticed[cables + c], rises = acted, True
    if rises:
        observe_cables(q, v, net_address, row)
        take_in(net, row, noticed)


@kernel(NOTICE)
def notice_by_law(t, q, v, net_address, row, noticed):
    """Look at a state by the law of its cables."""
    observe_cables(q, v, net_address, row)
    take_in(view_net(net_address), row, noticed)
