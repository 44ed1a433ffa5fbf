"""The added mass of fluid at the nodes of bodies in a stage of an implicit method.

A step from a to b over h resists with A (v_b - v_a)/h at each node, with the velocities v_b that it ends with: those of one piece.
By the rules for other nodes, v_b = 2 (q_b - q_a)/h - v_a or (q_b - q_a)/h, the acceleration w x (w x d) of a node on a body that
turns at w would be off by h w/6 of itself, or by half of it.
"""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.model.net import view_net
from integrators.stage import LAW_BETWEEN

from .rotation import centre_of_mass, group_of, rotation_between
from .stage import NO_VECTOR, spin_before
from .vectors import added, cross, inertia_of, minus, plus, row, scaled, solved, turned


@inlined
def _velocities_between(net, b, group, base, target, q, per_h):
    """Velocity of the centre of mass and spin at the end of a step of edmc."""
    theta = rotation_between(net, b, group, base, q)
    before, _ = spin_before(net, b, group, base, target, per_h)
    _, ahead = centre_of_mass(net, b, target)
    _, start = centre_of_mass(net, b, base)
    shift_rate = scaled(per_h, minus(plus(group.now, group.now), plus(start, ahead)))
    return shift_rate, minus(scaled(2.0 * per_h, theta), turned(theta, before))


@inlined
def _velocities_backward(net, b, group, base, q, per_h):
    """The same of backward Euler: the mean velocity, and the spin that has the angular momentum of the mean velocities of nodes."""
    bodies = net.bodies
    inertia, momentum = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), NO_VECTOR
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i, arm = bodies.node[k], row(bodies.arm_end, k)
        m = net.mass[i]
        inertia = added(inertia, inertia_of(m, arm))
        momentum = plus(momentum, scaled(m * per_h, cross(arm, minus(row(q, i), row(base, i)))))
    return scaled(per_h, minus(group.now, group.before)), solved(inertia, momentum)


@on_demand
def resist_bodies(stage, net_address, base, target, q):
    """Add the force of the added masses of the nodes of bodies to ``net.right_side``, and its slope to ``net.diagonal``.

    Call it after `place_bodies`. The slope takes the acceleration of a node for W times its displacement, to first order in the
    turn over the step.
    """
    net, per_h, between = view_net(net_address), 1.0 / stage.tau, stage.law == LAW_BETWEEN
    bodies, per_acceleration = net.bodies, per_h if between else stage.W * stage.tau
    for b in range(bodies.pivot.shape[0]):
        group = group_of(net, b, base, q)
        if between:
            shift_rate, spin = _velocities_between(net, b, group, base, target, q, per_h)
        else:
            shift_rate, spin = _velocities_backward(net, b, group, base, q, per_h)
        if bodies.pivot[b] >= 0:
            shift_rate = NO_VECTOR
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            A, now = net.added_mass[i], plus(shift_rate, cross(spin, row(bodies.arm_end, k)))
            a = scaled(per_acceleration, minus(now, scaled(per_h, minus(row(target, i), row(base, i)))))
            for x in range(3):
                for y in range(3):
                    net.right_side[i, x] -= A[x, y] * a[y]
                    net.diagonal[i, x, y] += stage.W * A[x, y]
