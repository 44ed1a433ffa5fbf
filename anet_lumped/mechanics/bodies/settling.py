"""Velocities of bodies at the end of a step of edmc: those of one piece."""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import BODY_BEFORE, BODY_SPIN_BEFORE

from .rotation import Group, mean_of, moved_mean, reference_of, rotation_between, spin_of
from .vectors import cross, dot, minus, plus, put, row, scaled, three, turned


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
    bodies, has_fluid = net.bodies, net.added_mass.shape[0] > 0
    for b in range(bodies.pivot.shape[0]):
        of, pinned = bodies.state[b], bodies.pivot[b] >= 0
        before, spin_before = three(of, BODY_BEFORE), three(of, BODY_SPIN_BEFORE)
        now, shift_rate = before, (0.0, 0.0, 0.0)
        if not pinned:
            now, shift_rate = plus(before, moved_mean(net, b, base, q)), mean_of(net, b, v)
        theta = rotation_between(net, b, Group(0.0, before, now), base, q)
        if has_fluid:
            for k in range(bodies.node_at[b], bodies.node_at[b + 1]):  # velocities at the start, which `settle` asks for
                i = bodies.node[k]
                put(net.law_force, i, minus(scaled(2.0 * per_h, minus(row(q, i), row(base, i))), row(v, i)))
        spin = minus(scaled(2.0 * per_h, theta), turned(theta, spin_before))
        _give_velocity(net, b, now, q, v, shift_rate, spin)


@inlined
def stiffen_body(net, b, q, v):
    """Make the velocities of a body those of one piece with the same momenta; returns the kinetic energy that this takes [J]."""
    _, reference = reference_of(net, b, q)
    shift_rate = mean_of(net, b, v)
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
