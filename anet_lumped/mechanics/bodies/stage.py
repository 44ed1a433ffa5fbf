"""A stage of an implicit method with bodies: their equations, and their part of the Newton step.

From a to b over h, with the rotation R_b R_a^T of the Cayley vector theta and the mean s of the arms of a force at both times,

    m (v_b - v_a)/h = sum F ,    (J_b w_b - J_a w_a)/h = sum s x F ,    w_b = 2 theta/h - R_b R_a^T w_a .

Because a force's point moves by dr + theta x s exactly, the work of F is the change of kinetic energy to the last bit, whatever F
is. Stages of other laws take forces, and the inertia m W (target - q) of each node, at the end.
Source: Simo and Wong, Int. J. Numer. Methods Engrg. 31 (1991) 19; Armero and Romero, Comput. Methods Appl. Mech. Engrg. 190 (2001)
2603.
"""

import math

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.mechanics.optional import CableBalance
from anet_lumped.mechanics.residual import FORCE_ROUNDING
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    BODY_AS_PREDICTED,
    BODY_BEFORE,
    BODY_BY_LAW,
    BODY_COORDINATE,
    BODY_FORCE,
    BODY_INERTIA,
    BODY_MOMENT,
    BODY_RADIUS,
    BODY_SECOND_ORDER,
    BODY_SPIN_BEFORE,
    BODY_TURNING,
    JOINT_BODY,
    JOINT_OTHER,
    JOINT_OTHER_POSITION,
    JOINT_POSITION,
)
from integrators.stage import LAW_BETWEEN

from .inertia import NO_MATRIX
from .rotation import group_of, hung_at_joint, moved_mean, place, rotation_between
from .vectors import (
    added,
    applied,
    cross,
    cross_matrix,
    cross_twice,
    dot,
    inertia_of,
    largest,
    matrix_product,
    minus,
    plus,
    put,
    put_three,
    row,
    scaled,
    solved,
    three,
    times_scalar,
    turned,
)

NO_VECTOR = (0.0, 0.0, 0.0)
MOMENT_WEIGHT = 1e3  # in steps that keep momenta, of a moment over the radius of gyration among forces


@inlined
def _before(net, b, group, base, target, per_h):
    """Angular velocity and momentum of a body at the start of a step, whose velocities are (target - base)/h."""
    bodies, momentum, inertia = net.bodies, NO_VECTOR, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        start, m = row(base, i), net.mass[i]
        arm = minus(start, group.before)
        momentum = plus(momentum, scaled(m * per_h, cross(arm, minus(row(target, i), start))))
        inertia = added(inertia, inertia_of(m, arm))
    return solved(inertia, momentum), momentum


@inlined
def _slow(net, b, base, target, per_h, of_centre, spin):
    """Write how much the nodes of a body slow down in the mean over a step, by its velocities at both ends, to ``bodies.slowing``.

    Only added masses ask for it. The centre of mass slows down by ``of_centre`` [m/s2], and the body turns by ``spin`` at the end.
    """
    bodies = net.bodies
    start = scaled(per_h, moved_mean(net, b, base, target))
    if bodies.pivot[b] >= 0:
        start = NO_VECTOR
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        before = minus(scaled(per_h, minus(row(target, i), row(base, i))), start)
        turning = minus(before, cross(spin, row(bodies.arm_end, k)))
        put(bodies.slowing, i - bodies.first, plus(of_centre, scaled(per_h, turning)))


@inlined
def _slow_backward(stage, net, b, group, base, target, q, J):
    """The same in a step of backward Euler, whose mean velocity and mean angular momentum are those at its end."""
    bodies, per_h, momentum = net.bodies, 1.0 / stage.tau, NO_VECTOR
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        momentum = plus(momentum, scaled(net.mass[i] * per_h, cross(row(bodies.arm_end, k), minus(row(q, i), row(base, i)))))
    spin, shift_rate = solved(J, momentum), scaled(per_h, minus(group.now, group.before))
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        moved = scaled(stage.tau, plus(shift_rate, cross(spin, row(bodies.arm_end, k))))
        put(bodies.slowing, i - bodies.first, scaled(stage.W, minus(minus(row(target, i), row(base, i)), moved)))


@on_demand
def place_bodies(stage, net_address, base, target, q):
    """Move the rows of each body in q to the nearest place that keeps its shape, and write ``bodies.state``."""
    net = view_net(net_address)
    bodies, per_h, has_fluid, joint = net.bodies, 1.0 / stage.tau, net.added_mass.shape[0] > 0, 0
    for b in range(bodies.pivot.shape[0]):
        group = group_of(net, b, base, q)
        theta = rotation_between(net, b, group, base, q)
        if joint < bodies.joint.shape[0] and bodies.joint[joint, JOINT_BODY] == b:
            group = hung_at_joint(net, joint, group, theta, base, q)
            joint += 1
        J = place(net, b, group, theta, base, q)
        of, shift, moment, stiffness, coordinate = bodies.state[b], NO_VECTOR, NO_VECTOR, times_scalar(stage.W, J), 0.0
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            m, ahead = net.mass[i] * stage.W, minus(row(target, i), row(q, i))
            coordinate = max(coordinate, largest(row(q, i)))
            shift = plus(shift, scaled(m, ahead))
            if stage.law != LAW_BETWEEN:
                arm = row(bodies.arm_end, k)
                moment = plus(moment, scaled(m, cross(arm, ahead)))
                stiffness = added(stiffness, cross_twice(scaled(-m, ahead), arm))
        second_order = stage.W * (J[0] + J[4] + J[8])
        if stage.law == LAW_BETWEEN:
            spin, momentum_before = _before(net, b, group, base, target, per_h)
            w = turned(theta, spin)
            end = minus(scaled(2.0 * per_h, theta), w)
            momentum = applied(J, end)
            moment = scaled(-per_h, minus(momentum, momentum_before))
            outer = (
                theta[0] * theta[0], theta[0] * theta[1], theta[0] * theta[2], theta[1] * theta[0], theta[1] * theta[1],
                theta[1] * theta[2], theta[2] * theta[0], theta[2] * theta[1], theta[2] * theta[2],
            )  # fmt: skip
            half, one = cross_matrix(scaled(-0.5, theta)), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
            rate = times_scalar(2.0 * per_h, added(added(one, half), times_scalar(0.25, outer)))
            rate = added(rate, cross_matrix(plus(end, w)))
            stiffness = times_scalar(per_h, added(matrix_product(J, rate), cross_matrix(scaled(-1.0, momentum))))
            second_order += per_h * (J[0] + J[4] + J[8]) * math.sqrt(dot(end, end))
            mean_ahead = scaled(1.0 / (group.mass * stage.W), shift)
            if bodies.pivot[b] >= 0:
                mean_ahead = NO_VECTOR
            for x in range(3):
                of[BODY_BEFORE + x], of[BODY_SPIN_BEFORE + x] = group.before[x], spin[x]
            if has_fluid:
                _slow(net, b, base, target, per_h, scaled(stage.W, mean_ahead), end)
        elif has_fluid:
            _slow_backward(stage, net, b, group, base, target, q, J)
        of[BODY_INERTIA], of[BODY_RADIUS] = group.mass * stage.W, math.sqrt(0.5 * (J[0] + J[4] + J[8]) / group.mass)
        of[BODY_SECOND_ORDER], of[BODY_COORDINATE] = second_order, coordinate
        for x in range(3):
            of[BODY_FORCE + x], of[BODY_MOMENT + x] = shift[x], moment[x]
        for x in range(9):
            of[BODY_TURNING + x] = stiffness[x]


@inlined
def _total(net, b, forces, first, between):
    """Force and moment of the forces on the nodes of a body, whose rows begin with node ``first``."""
    bodies, force, moment = net.bodies, NO_VECTOR, NO_VECTOR
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        f = row(forces, bodies.node[k] - first)
        force = plus(force, f)
        moment = plus(moment, cross(row(bodies.arm_mean, k) if between else row(bodies.arm_end, k), f))
    return force, moment


@inlined
def out_of_balance(net, b, forces, first, between):
    """Force and moment of the forces on the nodes of a body, whose rows begin with node ``first``, less its inertia."""
    of = net.bodies.state[b]
    force, moment = _total(net, b, forces, first, between)
    return plus(force, three(of, BODY_FORCE)), plus(moment, three(of, BODY_MOMENT))


@inlined
def pass_to_other(net, j, column, between):
    """Give the force of joint j to the other body: what is out of balance on the one that is pinned; returns it.

    That body is left with its moment about the joint. ``column`` is where ``bodies.state`` has force and moment.
    """
    bodies, joint = net.bodies, net.bodies.joint[j]
    of, other, arm = bodies.state[joint[JOINT_BODY]], joint[JOINT_OTHER], bodies.arm_mean if between else bodies.arm_end
    force = three(of, column)
    put_three(of, column, NO_VECTOR)
    put_three(of, column + 3, minus(three(of, column + 3), cross(row(arm, joint[JOINT_POSITION]), force)))
    if other >= 0:
        of = bodies.state[other]
        put_three(of, column, plus(three(of, column), force))
        put_three(of, column + 3, plus(three(of, column + 3), cross(row(arm, joint[JOINT_OTHER_POSITION]), force)))
    return force


@inlined
def _turning_of_joint(net, j, force, share):
    """Add what the force of a joint, on the other body, does to the turning of its arms there and on the body that is pinned."""
    bodies, joint = net.bodies, net.bodies.joint[j]
    of, pinned = bodies.state[joint[JOINT_BODY]], cross_twice(scaled(-share, force), row(bodies.arm_end, joint[JOINT_POSITION]))
    for x in range(9):
        of[BODY_TURNING + x] += pinned[x]
    if joint[JOINT_OTHER] >= 0:
        of = bodies.state[joint[JOINT_OTHER]]
        other = cross_twice(scaled(share, force), row(bodies.arm_end, joint[JOINT_OTHER_POSITION]))
        for x in range(9):
            of[BODY_TURNING + x] += other[x]


@inlined
def _weighted(moment, radius, noise, weight):
    """A moment as a force that counts ``weight`` times, but for what rounding leaves."""
    force = largest(moment) / radius
    return max(force, weight * (force - noise))


@inlined
def _stiffness(net, b):
    """Sum over the nodes of a body of the largest slope of an external force, or of the inertia of fluid, in a place [N/m]."""
    total = 0.0
    for k in range(net.bodies.node_at[b], net.bodies.node_at[b + 1]):
        block, slope = net.diagonal[net.bodies.node[k]], 0.0
        for x in range(3):
            for y in range(3):
                slope = max(slope, abs(block[x, y]))
        total += slope
    return total


@on_demand
def balance_bodies(stage, net_address, largest_coordinate, cable_noise, predicted_noise):
    """`CableBalance` of the bodies, with moments over the radius of gyration; adds what forces do to the turning of their arms.

    The last two arguments are what rounding leaves of the forces of cables, by their law and as predicted [N].
    """
    net, between = view_net(net_address), stage.law == LAW_BETWEEN
    bodies, weight, share = net.bodies, MOMENT_WEIGHT if between else 1.0, -0.5 if between else -1.0
    norm, scale, predicted, noise, sum_of_forces = 0.0, 0.0, 0.0, 0.0, 0.0
    for b in range(bodies.pivot.shape[0]):
        of = bodies.state[b]
        force, moment = out_of_balance(net, b, net.law_force, 0, between)
        put_three(of, BODY_BY_LAW, force)
        put_three(of, BODY_BY_LAW + 3, moment)
        force, moment = out_of_balance(net, b, net.predicted_force, net.n_interior, between)
        put_three(of, BODY_AS_PREDICTED, force)
        put_three(of, BODY_AS_PREDICTED + 3, moment)
    for j in range(bodies.joint.shape[0] - 1, -1, -1):
        pass_to_other(net, j, BODY_BY_LAW, between)
        _turning_of_joint(net, j, pass_to_other(net, j, BODY_AS_PREDICTED, between), share)
    for b in range(bodies.pivot.shape[0]):
        of, pinned = bodies.state[b], bodies.pivot[b] >= 0
        shift, moment = three(of, BODY_FORCE), three(of, BODY_MOMENT)
        radius = of[BODY_RADIUS]
        force_by_law, moment_by_law = three(of, BODY_BY_LAW), three(of, BODY_BY_LAW + 3)
        load, load_moment = _total(net, b, net.right_side, 0, between)
        held = 0.0 if pinned else 1.0
        of_inertia = FORCE_ROUNDING * of[BODY_INERTIA] * largest_coordinate
        of_places = of_inertia + FORCE_ROUNDING * _stiffness(net, b) * of[BODY_COORDINATE]
        by_law = _weighted(moment_by_law, radius, cable_noise + of_places, weight)
        norm = max(norm, held * largest(force_by_law), by_law)
        as_predicted = _weighted(three(of, BODY_AS_PREDICTED + 3), radius, predicted_noise + of_places, weight)
        predicted = max(predicted, held * largest(three(of, BODY_AS_PREDICTED)), as_predicted)
        scale = max(scale, largest(load), largest(shift), largest(load_moment) / radius, largest(moment) / radius)
        noise = max(noise, of_places)
        sum_of_forces += dot(force_by_law, (1.0, 1.0, 1.0)) + dot(moment_by_law, (1.0, 1.0, 1.0))
        turning = NO_MATRIX
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            f = row(net.predicted_force, bodies.node[k] - net.n_interior)
            turning = added(turning, cross_twice(scaled(share, f), row(bodies.arm_end, k)))
        for x in range(9):
            of[BODY_TURNING + x] += turning[x]
    return CableBalance(norm, scale, noise, predicted, noise, sum_of_forces)
