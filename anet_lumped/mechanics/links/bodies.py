"""Rigid bodies among links: the mobility of their nodes, the pull of links on them, and their shape.

A force f on node l of a body gives its node k the acceleration W_kl f, beside what velocities and other forces give it:

    W_kl f = f/m + (J^-1 (d_l x f)) x d_k ,    W_kl = I/m - [d_k] J^-1 [d_l] ,

with the mass m of the body and of what its nodes carry, the inertia J and the arms d about the centre of mass, and [x] the matrix
of the cross product. A pinned body has no first term, and J and d are about its pivot. `mechanics.bodies.inertia` has the same in
a fluid. Source: Newton and Euler.
"""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.mechanics.bodies.inertia import Inertia, inertia_with_fluid, moved_by
from anet_lumped.mechanics.bodies.rotation import reference_of
from anet_lumped.mechanics.bodies.shape import keep_shape
from anet_lumped.mechanics.bodies.vectors import cross, dot, minus, nine, plus, put, row
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    BODY_MEETING_BODY,
    BODY_MEETING_ENTRY,
    BODY_MEETING_FIRST,
    BODY_MEETING_FIRST_NODE,
    BODY_MEETING_SECOND,
    BODY_MEETING_SECOND_NODE,
    BODY_MEETING_SIGN,
    LINKED_BODY_CARRIED,
    LINKED_BODY_PER_MASS,
    LINKED_BODY_TURNING,
)

ZERO = (0.0, 0.0, 0.0)


@inlined
def _inertia(links, b):
    """`Inertia` of body b as `mobility_bodies` left it."""
    own = links.body[b]
    return Inertia(nine(own, LINKED_BODY_PER_MASS), nine(own, LINKED_BODY_CARRIED), nine(own, LINKED_BODY_TURNING))


@inlined
def _mobile(links, b, arm_k, arm_l, f):
    """W_kl f of two nodes of body b by their arms."""
    shift, turn = moved_by(_inertia(links, b), f, cross(arm_l, f))
    return plus(shift, cross(turn, arm_k))


@on_demand
def mobility_bodies(net_address, q):
    """Write inertia and arms of each body at the places q, and W_ii of its nodes to ``links.matrix_mobility``."""
    net = view_net(net_address)
    links, bodies = net.links, net.bodies
    W, first = links.matrix_mobility, net.n_free - links.matrix_mobility.shape[0]
    for b in range(bodies.pivot.shape[0]):
        mass, reference = reference_of(net, b, q)
        inertia = inertia_with_fluid(net, b, mass, reference, q)
        for x in range(9):
            links.body[b, LINKED_BODY_PER_MASS + x] = inertia.per_mass[x]
            links.body[b, LINKED_BODY_CARRIED + x] = inertia.carried[x]
            links.body[b, LINKED_BODY_TURNING + x] = inertia.turning[x]
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            own, arm = W[bodies.node[k] - first], minus(row(q, bodies.node[k]), reference)
            put(bodies.arm_end, k, arm)
            for x in range(3):
                put(own, x, _mobile(links, b, arm, arm, (1.0 if x == 0 else 0.0, 1.0 if x == 1 else 0.0, 1.0 if x == 2 else 0.0)))


@on_demand
def meet_bodies(net_address):
    """Add to the system of the end links what joins those that end at one body; one with both ends on it carries nothing."""
    net = view_net(net_address)
    links, arms = net.links, net.bodies.arm_end
    for j in range(links.body_meeting.shape[0]):
        pair = links.body_meeting[j]
        first, second = pair[BODY_MEETING_FIRST], pair[BODY_MEETING_SECOND]
        if first == second:
            links.end_pivot[pair[BODY_MEETING_ENTRY]], links.diagonal[first] = 0.0, 0.0
            continue
        k, l = pair[BODY_MEETING_FIRST_NODE], pair[BODY_MEETING_SECOND_NODE]
        moved = _mobile(links, pair[BODY_MEETING_BODY], row(arms, l), row(arms, k), row(links.vector, first))
        links.entry[pair[BODY_MEETING_ENTRY]] += pair[BODY_MEETING_SIGN] * dot(row(links.vector, second), moved)


@on_demand
def pull_bodies(net_address, x):
    """Add to the rows of bodies in x what the pulls of links in ``links.body_pull`` give them, W_kl f_l summed over l."""
    net = view_net(net_address)
    links, bodies = net.links, net.bodies
    for b in range(bodies.pivot.shape[0]):
        force, moment = ZERO, ZERO
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k] - bodies.first
            f = row(links.body_pull, i)
            put(links.body_pull, i, ZERO)
            force, moment = plus(force, f), plus(moment, cross(row(bodies.arm_end, k), f))
        shift, turn = moved_by(_inertia(links, b), force, moment)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            put(x, i, plus(row(x, i), plus(shift, cross(turn, row(bodies.arm_end, k)))))


@on_demand
def shape_bodies(net_address, q):
    """Give bodies their shape back, see `keep_shape`, and write their arms."""
    net = view_net(net_address)
    for b in range(net.bodies.pivot.shape[0]):
        keep_shape(net, b, q)
