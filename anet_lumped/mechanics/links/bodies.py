"""Rigid bodies among links: the mobility of their nodes, the pull of links on them, and their shape.

A force f on node l of a body gives its node k the acceleration W_kl f, beside what velocities and other forces give it:

    W_kl f = f/m + (J^-1 (d_l x f)) x d_k ,    W_kl = I/m - [d_k] J^-1 [d_l] ,

with the mass m of the body and of what its nodes carry, the inertia J and the arms d about the centre of mass, and [x] the matrix of
the cross product. A pinned body has no first term, and J and d are about its pivot. Source: Newton and Euler.
"""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.mechanics.bodies.rotation import centre_of_mass
from anet_lumped.mechanics.bodies.shape import keep_shape
from anet_lumped.mechanics.bodies.vectors import added, cross, dot, inertia_of, minus, plus, put, row, scaled, solved
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    BODY_MEETING_BODY,
    BODY_MEETING_ENTRY,
    BODY_MEETING_FIRST,
    BODY_MEETING_FIRST_NODE,
    BODY_MEETING_SECOND,
    BODY_MEETING_SECOND_NODE,
    BODY_MEETING_SIGN,
    LINKED_BODY_INERTIA,
    LINKED_BODY_PER_MASS,
)

ZERO = (0.0, 0.0, 0.0)


@inlined
def _inertia(links, b):
    """Inertia of body b, a matrix (9,) by rows."""
    J, at = links.body[b], LINKED_BODY_INERTIA
    return J[at], J[at + 1], J[at + 2], J[at + 3], J[at + 4], J[at + 5], J[at + 6], J[at + 7], J[at + 8]


@inlined
def _mobile(links, b, arm_k, arm_l, f):
    """W_kl f of two nodes of body b by their arms."""
    turn = solved(_inertia(links, b), cross(arm_l, f))
    return plus(scaled(links.body[b, LINKED_BODY_PER_MASS], f), cross(turn, arm_k))


@on_demand
def mobility_bodies(net_address, q):
    """Write mass, inertia and arms of each body at the places q, and W_ii of all moving nodes to ``links.matrix_mobility``."""
    net = view_net(net_address)
    links, bodies = net.links, net.bodies
    W = links.matrix_mobility
    for i in range(bodies.first):
        per_mass = 1.0 / net.mass[i] if net.mass[i] > 0.0 else 0.0
        for x in range(3):
            for y in range(3):
                W[i, x, y] = per_mass if x == y else 0.0
    for b in range(bodies.pivot.shape[0]):
        mass, reference = centre_of_mass(net, b, q)
        pivot, J = bodies.pivot[b], (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        if pivot >= 0:
            reference = row(q, pivot)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            arm = minus(row(q, i), reference)
            put(bodies.arm_end, k, arm)
            J = added(J, inertia_of(net.mass[i], arm))
        links.body[b, LINKED_BODY_PER_MASS] = 0.0 if pivot >= 0 else 1.0 / mass
        for x in range(9):
            links.body[b, LINKED_BODY_INERTIA + x] = J[x]
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            own, arm = W[bodies.node[k]], row(bodies.arm_end, k)
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
            links.diagonal[pair[BODY_MEETING_ENTRY]], links.size[first] = 0.0, 0.0
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
        shift, turn = scaled(links.body[b, LINKED_BODY_PER_MASS], force), solved(_inertia(links, b), moment)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            put(x, i, plus(row(x, i), plus(shift, cross(turn, row(bodies.arm_end, k)))))


@on_demand
def shape_bodies(net_address, q):
    """Give bodies their shape back, see `keep_shape`, and write their arms."""
    net = view_net(net_address)
    for b in range(net.bodies.pivot.shape[0]):
        keep_shape(net, b, q)
