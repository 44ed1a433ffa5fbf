"""Where a body is: its centre of mass, its rotation between two states, its momenta."""

from typing import NamedTuple

from anet_lumped.compiled.jit import inlined
from anet_lumped.model.tables import JOINT_OTHER_NODE, JOINT_POSITION

from .vectors import added, cross, inertia_of, minus, plus, put, row, scaled, solved, turned


class Group(NamedTuple):
    """Mass [kg] and reference points of a body in two states [m]: its centres of mass, or the pivot about which it is pinned."""

    mass: float
    before: tuple
    now: tuple


@inlined
def centre_of_mass(net, b, q):
    """Mass of a body, and the mean of the rows of q weighted by the masses of its nodes.

    The mean of what is left of the places is added to the mean: alike roundings of many light nodes would else move a body.
    """
    bodies, mass, sum_of, rest = net.bodies, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        m = net.mass[i]
        mass, sum_of = mass + m, plus(sum_of, scaled(m, row(q, i)))
    mean = scaled(1.0 / mass, sum_of)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        rest = plus(rest, scaled(net.mass[i], minus(row(q, i), mean)))
    return mass, plus(mean, scaled(1.0 / mass, rest))


@inlined
def reference_of(net, b, q):
    """Mass of a body, and its reference point: its centre of mass, or the pivot about which it is pinned."""
    mass, reference = centre_of_mass(net, b, q)
    pivot = net.bodies.pivot[b]
    if pivot >= 0:
        reference = row(q, pivot)
    return mass, reference


@inlined
def mean_of(net, b, v):
    """Mean of the rows of v of a body, weighted by the masses of its nodes."""
    bodies, mass, sum_of = net.bodies, 0.0, (0.0, 0.0, 0.0)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        mass, sum_of = mass + net.mass[i], plus(sum_of, scaled(net.mass[i], row(v, i)))
    return scaled(1.0 / mass, sum_of)


@inlined
def moved_mean(net, b, before, after):
    """Mean of what the rows of ``after`` differ by from those of ``before``, weighted by the masses of a body's nodes.

    The difference of both means, without the digits that each of them loses.
    """
    bodies, mass, sum_of = net.bodies, 0.0, (0.0, 0.0, 0.0)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        m = net.mass[i]
        mass, sum_of = mass + m, plus(sum_of, scaled(m, minus(row(after, i), row(before, i))))
    return scaled(1.0 / mass, sum_of)


@inlined
def group_of(net, b, base, q):
    """`Group` of body b."""
    mass, before = centre_of_mass(net, b, base)
    pivot = net.bodies.pivot[b]
    if pivot >= 0:
        return Group(mass, row(base, pivot), row(base, pivot))
    return Group(mass, before, plus(before, moved_mean(net, b, base, q)))


@inlined
def hung_at_joint(net, j, group, theta, base, q):
    """`Group` of the body of joint j, turned by theta from base, with its point at the joint on that to which it is pinned."""
    joint = net.bodies.joint[j]
    pivot = net.bodies.node[joint[JOINT_POSITION]]
    arm = turned(theta, minus(row(base, pivot), group.before))
    return Group(group.mass, group.before, minus(row(q, joint[JOINT_OTHER_NODE]), arm))


@inlined
def rotation_between(net, b, group, base, q):
    """Cayley vector theta of the rotation of body b from base to q.

    It minimises sum m |d - theta x s|^2 with d the displacement of a node less that of the reference point and s its mean place
    from there. For a body that has kept its shape, d = theta x s exactly; else this is the nearest rotation, to second order.
    """
    bodies = net.bodies
    inertia, moment = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        a = minus(row(base, i), group.before)
        d = minus(minus(row(q, i), group.now), a)
        s = a[0] + 0.5 * d[0], a[1] + 0.5 * d[1], a[2] + 0.5 * d[2]
        m = net.mass[i]
        inertia, moment = added(inertia, inertia_of(m, s)), plus(moment, scaled(m, cross(s, d)))
    return solved(inertia, moment)


@inlined
def place(net, b, group, theta, base, q):
    """Move the rows of body b in q from base by the rotation theta about the reference point; returns its inertia there.

    Writes ``arm_end`` and the mean of both arms, ``arm_mean``.
    """
    bodies, inertia = net.bodies, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        before = minus(row(base, i), group.before)
        arm = turned(theta, before)
        put(bodies.arm_end, k, arm)
        put(bodies.arm_mean, k, scaled(0.5, plus(before, arm)))
        put(q, i, plus(group.now, arm))
        inertia = added(inertia, inertia_of(net.mass[i], arm))
    return inertia


@inlined
def spin_of(net, b, reference, q, v):
    """Angular velocity of body b from the velocities of its nodes: inertia^-1 sum m a x v. Returns it and the inertia."""
    bodies = net.bodies
    inertia, momentum = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        a, m = minus(row(q, i), reference), net.mass[i]
        inertia, momentum = added(inertia, inertia_of(m, a)), plus(momentum, scaled(m, cross(a, row(v, i))))
    return solved(inertia, momentum), inertia
