"""The energy account of a step of edmc, and the damping of axial ringing that the step cannot resolve."""

import math

from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, internal, kernel, on_demand
from anet_lumped.compiled.lanes import WIDTH, column, group_members, is_below, load, select, shifted, store, sum_of_lanes
from anet_lumped.compiled.rows_of_lanes import load_row, spread, store_row, thrice
from anet_lumped.effects.laws.axial import damped_changes
from anet_lumped.effects.signatures import as_force, as_settle
from anet_lumped.mechanics.cable_rows import add_to_points, put_row3, row3, segment_count, sum_of_members
from anet_lumped.mechanics.creeping_law import creep_in_step, fast_spring, with_largest_tension
from anet_lumped.mechanics.effect_forces import any_live, numbers_of, take_middle
from anet_lumped.mechanics.optional import (
    CableAccount,
    as_cable_settle,
    as_energy_of_paid_out,
    as_settle_effects,
    as_settle_joints,
    as_stiffen_bodies,
    as_turn_bodies,
    as_work_of_lengths,
)
from anet_lumped.mechanics.plain_cables import are_plain, law_of, plain_law_of, plain_stage
from anet_lumped.mechanics.segment_law import SHORTEST, TINY, numerical_damper, tension_law
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_L0_RATE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_STIFFNESS,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_START,
    CREPT_STRETCH,
    CREPT_T_MAX,
    KERNEL_ENERGY_OF_PAID_OUT,
    KERNEL_SETTLE_EFFECTS,
    KERNEL_SETTLE_GROUPS,
    KERNEL_SETTLE_JOINTS,
    KERNEL_SETTLE_SINGLES,
    KERNEL_STIFFEN_BODIES,
    KERNEL_TURN_BODIES,
    KERNEL_WORK_OF_LENGTHS,
    LINEARISED_BEGINNING,
    LINEARISED_CURRENT,
    LINEARISED_LEAST_DAMPER,
    LINEARISED_NEXT_STEP,
    LINEARISED_TAKEN,
    LINEARISED_TAKEN_BY_METHOD,
    SEGMENT_COLUMNS,
    SEGMENT_NUMERICAL_DAMPER,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
    SLOT_FORCE,
    SLOT_SETTLE,
)
from integrators.flat_view import flat
from integrators.stage import STAGE

_f1, _f2 = float64[::1], float64[:, ::1]

MOST_SPENT = 1e-5  # of the kinetic energy: the numerical damper acts in full where it takes less than this in a step


@inlined
def _mobility(net, node):
    """Inverse of the mass of a moving node [1/kg]; 0 for a prescribed one."""
    return select(is_below(node, net.n_free), 1.0 / load(net.mass, node), 0.0)


@inlined
def _driven_distance(net, node, position_before, position, direction):
    """Distance that a driven node moves along a direction in a step [m]; 0 for any other node."""
    return select(
        is_below(node, net.n_driven),
        0.0,
        direction[0] * (position[0] - position_before[0])
        + direction[1] * (position[1] - position_before[1])
        + direction[2] * (position[2] - position_before[2]),
    )


@inlined
def _unresolved_share(ratio):
    """s'/(1 + s') with s' = ``ratio``^2.

    Near 1 for a motion that the step does not resolve; where the step resolves the motion, of the order of ``ratio``^2.
    """
    return ratio * ratio / (1.0 + ratio * ratio)


@inlined
def _shares_to_remove(stage, law, h, omega_squared, damper, k):
    """Share of the unresolved rate of length that a segment removes while it is taut and while it is slack, see `settle`.

    One that does not stretch removes as much as any can.
    """
    spring, two_way_damper, inextensible = law
    most = 2.0 * stage.dissipation
    if inextensible > 0.0:
        return most + 0.0 * omega_squared, most + 0.0 * omega_squared
    spring_term, damping_term = 0.25 * h * h * omega_squared, 0.5 * h * omega_squared * damper / k
    taut = most * _unresolved_share(spring_term + damping_term * damping_term)
    slack = spring.push_share * spring_term + two_way_damper * damping_term * damping_term
    return taut, most * _unresolved_share(slack)


@inlined
def _damper_share(x_a, x_b, per_h, spring, damper, two_way_damper, numerical):
    """Share of the force of both dampers over a step that is the cable's own, and not that of the method."""
    change, numerically_damped_change = damped_changes(x_a, x_b, spring.push_share, two_way_damper)
    own, of_method = damper * per_h * abs(change), numerical * abs(numerically_damped_change)
    return own / max(own + of_method, TINY)


@inlined
def _impulse(acts, change_wanted, rate, shared_mobility):
    """Impulse along a segment that changes the rate of its length as it is wanted, but never beyond a stop [N s]."""
    change = select(abs(change_wanted) > abs(rate), rate, change_wanted)
    return select(acts & (change_wanted * rate > 0.0), change / shared_mobility, 0.0)


@inlined
def cable_settle(stage, net, cables, law, base, q, v, creep):
    """`settle` of a cable, or of a group of cables; returns their `CableAccount`.

    ``cables`` are the address of the cable or group and how many cables it is, ``law`` is what `law_of` returns, and ``creep`` the
    `Creep` of its first segment, None of a cable that does not creep. Writes the changes of velocity by the impulses to
    ``net.middle_v``, and adds each impulse over the step to ``net.tension``.
    """
    (c, members), h, per_h = cables, stage.tau, 1.0 / stage.tau
    first, node = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE)
    start, end, count = column(net.cable, c, CABLE_START), column(net.cable, c, CABLE_END), segment_count(net, c)
    L0, k, damper = column(net.axial, c, AXIAL_L0), column(net.axial, c, AXIAL_STIFFNESS), column(net.axial, c, AXIAL_DAMPER)
    spring, two_way_damper, inextensible = law
    if creep is not None:
        spring = fast_spring(net, creep.fast_stiffness, L0)
    omega_squared, L_a = column(net.axial, c, AXIAL_OMEGA_SQUARED), column(net.axial, c, AXIAL_L0_BEFORE)
    L0_rate = column(net.axial, c, AXIAL_L0_RATE)
    taut_share, slack_share = _shares_to_remove(stage, (spring, two_way_damper, inextensible), h, omega_squared, damper, k)
    flat_base, flat_q, flat_v, velocity_change, segment = flat(base), flat(q), flat(v), flat(net.middle_v), flat(net.segment)
    zero = 0.0 * L0
    by_dampers, by_method, put_in, by_impulses, total_square = zero, zero, zero, zero, zero
    i1, q1, v1, mobility_1 = start, row3(flat_q, start), row3(flat_v, start), _mobility(net, start)
    mobility_of_end, mobility_inside = _mobility(net, end), 1.0 / load(net.mass, node)  # all nodes inside a cable have one mass
    shared_1, shared_by_end = load(net.node_segments, start) * mobility_1, load(net.node_segments, end) * mobility_of_end
    shared_inside = 2.0 * mobility_inside  # of a node whose mass is divided among its segments
    change_behind = zero, zero, zero  # change of the node's velocity by the impulse of the segment behind it
    for j in range(count):
        i2 = shifted(node, j, 1, 0) if j < count - 1 else end
        s = shifted(first, j, 1, 0)
        row, T, q2, v2 = shifted(s, 0, SEGMENT_COLUMNS, 0), load(net.tension, s), row3(flat_q, i2), row3(flat_v, i2)
        mobility_2, shared_2 = (mobility_inside, shared_inside) if j < count - 1 else (mobility_of_end, shared_by_end)
        dx, dy, dz = q2[0] - q1[0], q2[1] - q1[1], q2[2] - q1[2]
        l = math.sqrt(dx * dx + dy * dy + dz * dz)
        per_l, stretch = 1.0 / max(l, SHORTEST * L0), l - L0
        stretch_before = load(segment, shifted(row, 0, 1, SEGMENT_STRETCH_BEFORE))
        numerical = load(segment, shifted(row, 0, 1, SEGMENT_NUMERICAL_DAMPER))
        if creep is not None:
            L_a = L0 + net.crept[s, CREPT_STRETCH]
            of_segment = with_largest_tension(creep, net.crept[s, CREPT_T_MAX]), s, L0
            spring, offset, change, by_slow_part = creep_in_step(stage, net, of_segment, stretch_before, l, numerical)
            by_dampers, by_method = by_dampers + by_slow_part[0], by_method + by_slow_part[1]
            stretch = l - spring.L0
        n, lengthening = (dx * per_l, dy * per_l, dz * per_l), stretch - stretch_before
        x_a, x_b = stretch_before, stretch  # from which the spring pulls
        if creep is not None:
            x_a, x_b = stretch_before - offset, stretch - offset
        T_at_end, _, secant = tension_law(stage, x_b, x_a, spring, damper, two_way_damper, numerical)
        store(segment, shifted(row, 0, 1, SEGMENT_STRETCH), stretch)
        store(segment, shifted(row, 0, 1, SEGMENT_TENSION), T_at_end)
        dissipated = (T - secant) * lengthening
        damper_share = _damper_share(x_a, x_b, per_h, spring, damper, two_way_damper, numerical)
        by_dampers, by_method = by_dampers + damper_share * dissipated, by_method + (1.0 - damper_share) * dissipated
        total_square = total_square + lengthening * lengthening
        rate = n[0] * (v2[0] - v1[0]) + n[1] * (v2[1] - v1[1]) + n[2] * (v2[2] - v1[2]) - L0_rate
        mean_rate = lengthening * per_h
        if creep is not None:
            mean_rate = mean_rate + change * per_h
        change_wanted = select(x_b > 0.0, taut_share, slack_share) * (rate - mean_rate)
        acts = ((T > 0.0) | (two_way_damper > 0.0)) & (mobility_1 + mobility_2 > 0.0)
        impulse = _impulse(acts, change_wanted, rate, shared_1 + shared_2)
        store(net.tension, s, T + impulse * per_h)
        by_impulses = by_impulses - impulse * L0_rate
        speed_1, speed_2 = impulse * mobility_1, impulse * mobility_2
        node_change = change_behind[0] + speed_1 * n[0], change_behind[1] + speed_1 * n[1], change_behind[2] + speed_1 * n[2]
        if j == 0:
            add_to_points(net.middle_v, 0, start, members, node_change, 1.0)
            by_impulses = by_impulses - select(mobility_1 == 0.0, impulse, 0.0) * (n[0] * v1[0] + n[1] * v1[1] + n[2] * v1[2])
        else:
            put_row3(velocity_change, i1, node_change)
        if j == count - 1:
            by_impulses = by_impulses + select((mobility_2 == 0.0) & (mobility_1 > 0.0), impulse, 0.0) * (
                n[0] * v2[0] + n[1] * v2[1] + n[2] * v2[2]
            )
        if j == 0 or j == count - 1:
            a1, a2, per_length = row3(flat_base, i1), row3(flat_base, i2), 1.0 / max(l + stretch_before + L_a, SHORTEST * L_a)
            e = (a2[0] - a1[0] + dx) * per_length, (a2[1] - a1[1] + dy) * per_length, (a2[2] - a1[2] + dz) * per_length
            put_in = put_in + T * (_driven_distance(net, i2, a2, q2, e) - _driven_distance(net, i1, a1, q1, e))
        change_behind = -speed_2 * n[0], -speed_2 * n[1], -speed_2 * n[2]
        i1, q1, v1, mobility_1, shared_1 = i2, q2, v2, mobility_2, shared_2
    add_to_points(net.middle_v, 0, end, members, change_behind, 1.0)
    return CableAccount(
        sum_of_members(by_dampers, members),
        sum_of_members(by_method, members),
        sum_of_members(put_in, members),
        sum_of_members(by_impulses, members),
        sum_of_members(numerical_damper(stage, net, c) * total_square, members),
    )


@inlined
def sum_of_accounts(first, second):
    """`CableAccount` of two sets of cables together."""
    return CableAccount(
        first.by_dampers + second.by_dampers,
        first.by_method + second.by_method,
        first.put_in + second.put_in,
        first.by_impulses + second.by_impulses,
        first.by_full_damper + second.by_full_damper,
    )


@on_demand
def settle_of_singles(stage, net_address, base, q, v):
    """`cable_settle` of the cables that are in no group, summed."""
    net, account = view_net(net_address), CableAccount(0.0, 0.0, 0.0, 0.0, 0.0)
    for c in net.single_cables:
        account = sum_of_accounts(account, cable_settle(stage, net, (c, 1), law_of(net, c), base, q, v, None))
    return account


@on_demand
def settle_of_groups(stage, net_address, base, q, v):
    """`cable_settle` of the cables that are taken by fours, summed."""
    net, account = view_net(net_address), CableAccount(0.0, 0.0, 0.0, 0.0, 0.0)
    for g in range(net.cable_groups.shape[0]):
        c, members = group_members(net.cable_groups, g), net.cable_groups[g, WIDTH]
        if are_plain(stage.law, net, c):
            own = cable_settle(plain_stage(stage), net, (c, members), plain_law_of(net, c), base, q, v, None)
        else:
            own = cable_settle(stage, net, (c, members), law_of(net, c), base, q, v, None)
        account = sum_of_accounts(account, own)
    return account


@on_demand
def settle_effects(stage, net_address, base, q, v):
    """Damp the ringing of contacts in the velocities v at the end of a step; returns the energy that it takes [J]."""
    net, taken = view_net(net_address), 0.0
    for e in range(net.effects.address.shape[0]):
        if net.effects.address[e, SLOT_SETTLE] != 0:
            index, params = numbers_of(net.effects, e)
            taken += as_settle(net.effects.address[e, SLOT_SETTLE])(
                stage.t + 0.5 * stage.tau, stage.tau, stage.dissipation, base, q, v, index, params
            )
    return taken


@inlined
def _evaluate_effects(stage, net, base, q):
    """Write what `residual` leaves of the effects, at the positions after a Newton step that it has not seen.

    Newton's method ends with such a step only where all forces are linear in the state of their node, which none over a whole
    step is.
    """
    take_middle(net, 0.5, 1.0 / stage.tau, base, q)
    for i in range(net.n_free, q.shape[0]):
        for x in range(3):
            net.right_side[i, x] = 0.0
    taken = 0.0
    for e in range(net.effects.address.shape[0]):
        index, params = numbers_of(net.effects, e)
        taken += as_force(net.effects.address[e, SLOT_FORCE])(stage.t, net.middle_q, net.middle_v, index, params, net.right_side)
    net.linearised[LINEARISED_TAKEN], net.linearised[LINEARISED_TAKEN_BY_METHOD] = stage.tau * taken, 0.0


@internal
def _change_velocities(net_address, v):
    """Add the changes in ``net.middle_v`` to the velocities v of the moving nodes; four nodes are taken at once.

    Returns
    -------
    kinetic : float64 [J]
        Kinetic energy before that.
    gained : float64 [J]
        What the changes add to it.
    """
    net = view_net(net_address)
    V, change, mass, by_fours = flat(v), flat(net.middle_v), net.mass, net.n_free - net.n_free % WIDTH
    squares, gains = spread(0.0), spread(0.0)
    for i in range(0, by_fours, WIDTH):
        masses = thrice(load_row(mass, i))
        for k in range(3):
            a = 3 * i + WIDTH * k
            m = masses[0] if k == 0 else masses[1] if k == 1 else masses[2]
            old, change_of = load_row(V, a), load_row(change, a)
            squares = squares + m * (old * old)
            gains = gains + m * (change_of * (old + 0.5 * change_of))
            store_row(V, a, old + change_of)
    kinetic, gained = 0.5 * sum_of_lanes(squares), sum_of_lanes(gains)
    for i in range(by_fours, net.n_free):
        for x in range(3):
            old, change_of = v[i, x], net.middle_v[i, x]
            kinetic += 0.5 * mass[i] * old * old
            gained += mass[i] * change_of * (old + 0.5 * change_of)
            v[i, x] = old + change_of
    return kinetic, gained


@inlined
def _account_of_effects(stage, net, base, q, v):
    """Energy that effects took in a step, what kept their steps stable took, and what driving nodes against them put in [J]."""
    if net.linearised[LINEARISED_CURRENT] == 0.0:
        _evaluate_effects(stage, net, base, q)
    by_effects, put_in = net.linearised[LINEARISED_TAKEN], 0.0
    for i in range(net.n_driven, q.shape[0]):
        for x in range(3):
            put_in -= net.right_side[i, x] * (q[i, x] - base[i, x])
    for i in range(net.added_mass.shape[0]):  # energy given to the fluid: the step's acceleration is 2 (v_b - v_mean)/h
        for x in range(3):
            for y in range(3):
                half_change = v[i, y] - net.middle_v[i, y]
                if i >= net.bodies.first:  # whose velocities before the step `turn_bodies` has left there
                    half_change = 0.5 * (v[i, y] - net.law_force[i, y])
                by_effects += 2.0 * net.middle_v[i, x] * net.added_mass[i, x, y] * half_change
    return by_effects, net.linearised[LINEARISED_TAKEN_BY_METHOD], put_in


@kernel(types.void(STAGE, _f2, _f2, _f2, int64, _f1))
def settle(stage, base, q, v, net_address, energy):
    """Account for the energy of a step of `LAW_BETWEEN` from base to q, and damp axial ringing that the step cannot resolve.

    **Account.** Work and dissipation are those of the forces that acted in the step. A change of rest length puts in the work
    -T (L_b - L_a). Therefore dampers dissipate by the change of l - L0.

    **Ringing.** Where stretching has died out within a step, the velocity v_b = 2 (q_b - q_a)/h - v_a changes its sign from step to
    step for ever, while the positions are at rest. Let r be the rate of l - L0 of a segment at the end of the step, less its mean
    rate over the step. Each segment removes the share

        2 dissipation s'/(1 + s') ,    s' = ((h omega/2)^2 + (h omega^2 c/(2 k))^2)^2 ,

    of r, by opposite impulses on its nodes along itself. Only a spring and a damper that act on the segment count in s', so that a
    slack segment of a cable that cannot push removes nothing. All impulses act at once, and each node's mass counts as if it were
    divided among its segments. So momenta are kept, and the kinetic energy falls, apart from the work of prescribed nodes and of
    changing rest lengths. Where the step resolves stretching, the change is of fifth order in the step. The impulses, divided by
    the step, are added to the tensions that acted.

    **Numerical damper.** Sets the least share of the numerical damper in the next step. The share is 1, unless the full damper
    would take more than `MOST_SPENT` of the kinetic energy. Where stretching is no part of the motion, the full damper removes the
    error that is left in a length.

    Parameters
    ----------
    stage, base, net_address
        As in the last call of `residual`.
    q, v : (n, 3) float64 [m], [m/s]
        At the end of the step; v is overwritten by the damped velocities.
    energy : (4,) float64 [J], overwritten
        Energy put in; energies dissipated by dampers, by effects and by the method.
    """
    net = view_net(net_address)
    put_in, by_effects, by_steps_of_effects = 0.0, 0.0, 0.0
    lengths_change, has_bodies = net.lengths.cable.shape[0] > 0, net.bodies.first < net.n_free
    if has_bodies:
        as_turn_bodies(net.kernels[KERNEL_TURN_BODIES])(stage, net_address, base, q, v)
    if lengths_change:
        put_in = as_work_of_lengths(net.kernels[KERNEL_WORK_OF_LENGTHS])(stage, net_address, base, q, v)
    if any_live(net):
        by_effects, by_steps_of_effects, against_effects = _account_of_effects(stage, net, base, q, v)
        put_in += against_effects
    for i in range(net.n_interior, q.shape[0]):
        for x in range(3):
            net.middle_v[i, x] = 0.0
    account = CableAccount(0.0, 0.0, 0.0, 0.0, 0.0)
    if net.cable_groups.shape[0] > 0:
        account = as_cable_settle(net.kernels[KERNEL_SETTLE_GROUPS])(stage, net_address, base, q, v)
    if net.single_cables.shape[0] > 0:
        account = sum_of_accounts(account, as_cable_settle(net.kernels[KERNEL_SETTLE_SINGLES])(stage, net_address, base, q, v))
    put_in += account.put_in + account.by_impulses
    by_method = account.by_method + (account.by_impulses + by_steps_of_effects)
    kinetic, by_changes = _change_velocities(net_address, v)
    by_method -= by_changes
    if net.kernels[KERNEL_SETTLE_EFFECTS] != 0:
        by_method += as_settle_effects(net.kernels[KERNEL_SETTLE_EFFECTS])(stage, net_address, base, q, v)
    if has_bodies:
        by_method += as_stiffen_bodies(net.kernels[KERNEL_STIFFEN_BODIES])(net_address, q, v)
    if net.kernels[KERNEL_SETTLE_JOINTS] != 0:
        of_joints, taken = as_settle_joints(net.kernels[KERNEL_SETTLE_JOINTS])(stage, net_address, base, q, v)
        put_in, by_method = put_in + of_joints, by_method + taken
    net.linearised[LINEARISED_LEAST_DAMPER] = min(1.0, MOST_SPENT * kinetic / max(account.by_full_damper, TINY))
    net.linearised[LINEARISED_BEGINNING] = LINEARISED_NEXT_STEP
    if lengths_change:
        put_in += as_energy_of_paid_out(net.kernels[KERNEL_ENERGY_OF_PAID_OUT])(stage, net_address, q, v)
    energy[0], energy[1], energy[2], energy[3] = put_in, account.by_dampers, by_effects, by_method
