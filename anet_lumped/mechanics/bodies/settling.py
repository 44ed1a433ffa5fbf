"""Velocities of bodies at the end of a step of edmc: those of one piece."""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.model.net import view_net

from .rotation import centre_of_mass, group_of, reference_of, rotation_between, spin_of
from .vectors import cross, dot, minus, plus, put, row, scaled, turned


@inlined
def _give_velocity(net, b, reference, q, v, shift_rate, spin):
    """Write the velocities of one piece to the rows of a body; returns the kinetic energy that its nodes lose [J]."""
    bodies, lost = net.bodies, 0.0
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        before, now = row(v, i), plus(shift_rate, cross(spin, minus(row(q, i), reference)))
        lost += 0.5 * net.mass[i] * (dot(before, before) - dot(now, now))
        put(v, i, now)
    return lost


@on_demand
def turn_bodies(stage, net_address, base, q, v):
    """Write the velocities of bodies after a step, where v = 2 (q - base)/h - v_a of each node is that of none.

    v_b = 2 dr/h - v_a of the centre of mass and w_b = 2 theta/h - R w_a, see `stage`.
    """
    net, per_h = view_net(net_address), 1.0 / stage.tau
    bodies = net.bodies
    for b in range(bodies.pivot.shape[0]):
        group = group_of(net, b, base, q)
        theta = rotation_between(net, b, group, base, q)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):  # velocities at the start, in the rows of a scratch array
            i = bodies.node[k]
            put(net.law_force, i, minus(scaled(2.0 * per_h, minus(row(q, i), row(base, i))), row(v, i)))
        spin_before, _ = spin_of(net, b, group.before, base, net.law_force)
        spin = minus(scaled(2.0 * per_h, theta), turned(theta, spin_before))
        _, shift_rate = centre_of_mass(net, b, v)
        if bodies.pivot[b] >= 0:
            shift_rate = (0.0, 0.0, 0.0)
        _give_velocity(net, b, group.now, q, v, shift_rate, spin)


@inlined
def stiffen_body(net, b, q, v):
    """Make the velocities of a body those of one piece with the same momenta; returns the kinetic energy that this takes [J]."""
    _, reference = reference_of(net, b, q)
    _, shift_rate = centre_of_mass(net, b, v)
    if net.bodies.pivot[b] >= 0:
        shift_rate = (0.0, 0.0, 0.0)
    spin, _ = spin_of(net, b, reference, q, v)
    return _give_velocity(net, b, reference, q, v, shift_rate, spin)


@on_demand
def stiffen_bodies(net_address, q, v):
    """`stiffen_body` of all bodies; returns the sum [J]."""
    net, lost = view_net(net_address), 0.0
    for b in range(net.bodies.pivot.shape[0]):
        lost += stiffen_body(net, b, q, v)
    return lost
