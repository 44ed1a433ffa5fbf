"""The added mass of fluid at the nodes of bodies in a stage of an implicit method.

A step from a to b resists with A (v_b - v_a)/h at each node, with the velocities of a body that moves as one piece. The rule
v_b = 2 (q_b - q_a)/h - v_a of other nodes would be off by h w^2/6 of a node's speed on a body that turns at w. Stages of other laws
take the inertia W (target - q) of each node, as they do for its mass.
"""

from anet_lumped.compiled.jit import on_demand
from anet_lumped.model.net import view_net
from integrators.stage import LAW_BETWEEN

from .rotation import centre_of_mass, group_of, rotation_between
from .stage import NO_VECTOR, spin_before
from .vectors import cross, minus, plus, row, scaled, turned


@on_demand
def resist_bodies(stage, net_address, base, target, q):
    """Add the force of the added masses of the nodes of bodies to ``net.right_side``, and its slope to ``net.diagonal``.

    Call it after `place_bodies`. The slope takes the acceleration of a node for W times its displacement, to first order in the
    turn over the step.
    """
    net, per_h = view_net(net_address), 1.0 / stage.tau
    bodies = net.bodies
    for b in range(bodies.pivot.shape[0]):
        shift_rate, spin = NO_VECTOR, NO_VECTOR
        if stage.law == LAW_BETWEEN:
            group = group_of(net, b, base, q)
            theta = rotation_between(net, b, group, base, q)
            before, _ = spin_before(net, b, group, base, target, per_h)
            spin = minus(scaled(2.0 * per_h, theta), turned(theta, before))
            _, ahead = centre_of_mass(net, b, target)
            _, start = centre_of_mass(net, b, base)
            if bodies.pivot[b] < 0:
                shift_rate = scaled(per_h, minus(plus(group.now, group.now), plus(start, ahead)))
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            A, away = net.added_mass[i], scaled(stage.W, minus(row(q, i), row(target, i)))
            if stage.law == LAW_BETWEEN:
                now = plus(shift_rate, cross(spin, row(bodies.arm_end, k)))
                away = scaled(per_h, minus(now, scaled(per_h, minus(row(target, i), row(base, i)))))
            for x in range(3):
                for y in range(3):
                    net.right_side[i, x] -= A[x, y] * away[y]
                    net.diagonal[i, x, y] += stage.W * A[x, y]
