"""The residual of a stage of an implicit method, which is the force out of balance on every node, and its linearisation."""

from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, internal, kernel, on_demand
from anet_lumped.compiled.lanes import (
    WIDTH,
    column,
    group_members,
    load,
    max_of_lanes,
    select,
    shifted,
    sum_of_lanes,
)
from anet_lumped.compiled.rows_of_lanes import load_row, spread, store_row, thrice
from anet_lumped.effects.signatures import as_force, as_tangent, as_whole_step
from anet_lumped.mechanics.cable_rows import add_to_points, row3, segment_count
from anet_lumped.mechanics.creeping_law import linearise_creeping, with_largest_tension
from anet_lumped.mechanics.effect_forces import add_masses, any_live, clear, eliminates_inertia, numbers_of, take_middle
from anet_lumped.mechanics.optional import (
    CableBalance,
    as_balance_bodies,
    as_cable_residual,
    as_place_bodies,
    as_set_lengths,
)
from anet_lumped.mechanics.plain_cables import are_plain, plain_cable_law, plain_stage
from anet_lumped.mechanics.segment_law import cable_law, linearise
from anet_lumped.mechanics.segment_row import load_history, store_linearised
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_L0_RATE,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_START,
    CREPT_CHANGE,
    CREPT_STRETCH,
    CREPT_T_MAX,
    KERNEL_BALANCE_BODIES,
    KERNEL_PLACE_BODIES,
    KERNEL_RESIDUAL_GROUPS,
    KERNEL_RESIDUAL_SINGLES,
    KERNEL_SET_LENGTHS,
    LINEARISED_BEGINNING,
    LINEARISED_CURRENT,
    LINEARISED_LAW,
    LINEARISED_SAME_STEP,
    LINEARISED_TAKEN,
    LINEARISED_TAKEN_BY_METHOD,
    LINEARISED_TAU,
    LINEARISED_W,
    SEGMENT_COLUMNS,
    SLOT_FORCE,
    SLOT_TANGENT,
    SLOT_WHOLE_STEP,
)
from integrators.flat_view import flat
from integrators.newton import UNKNOWN_FORCE
from integrators.stage import LAW_AT_END, LAW_BETWEEN, STAGE

_f2 = float64[:, ::1]

EPS = 2.220446049250313e-16
FORCE_ROUNDING = 4.0 * EPS  # rounding of a force over its largest terms: two positions, and the sum of two products of them


@internal
def set_stage_lengths(stage, net_address):
    """Write the rest lengths at the start and the end of a stage, and the masses and the effects' numbers at ``stage.t``."""
    t_start = stage.t - (stage.theta * stage.tau if stage.law != LAW_AT_END else 0.0)
    net = view_net(net_address)
    t_end = t_start + stage.tau if stage.law != LAW_AT_END else stage.t
    as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t_start, stage.t, t_end)
    if stage.law == LAW_AT_END:
        for c in net.lengths.cable:
            net.axial[c, AXIAL_L0_BEFORE] = net.axial[c, AXIAL_L0] - stage.tau * net.axial[c, AXIAL_L0_RATE]


@inlined
def cable_residual(stage, net, cables, base, q, law, creep, largest_coordinate):
    """Linearise the segments of a cable, or of a group of cables, and return their `CableBalance`.

    ``cables`` are the address of the cable or group and how many cables it is, ``law`` its `CableLaw`, and ``creep`` the `Creep` of
    its first segment, None of a cable that does not creep. Adds the forces of the cable on its end points to ``net.law_force``,
    and the same forces with the predicted tensions to ``net.predicted_force``.
    """
    c, members = cables
    first, node, per_tau = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE), 1.0 / stage.tau
    start, end = column(net.cable, c, CABLE_START), column(net.cable, c, CABLE_END)
    count = segment_count(net, c)
    L0, k, damper, taut, two_way_damper = law.spring.L0, law.steepest_slope, law.damper, law.taut, law.two_way_damper
    flat_q, flat_base, flat_right, segment = flat(q), flat(base), flat(net.right_side), flat(net.segment)
    zero = 0.0 * L0
    norm, scale, predicted, sum_of_forces, tension_gap, largest_tension = zero, zero, zero, zero, zero, zero
    largest_used = zero
    least_taut_slope = 0.9 * taut.undamped_slope  # a segment of a smaller slope is not linearised as taut
    q0, a0, pull_behind, predicted_behind = row3(flat_q, start), row3(flat_base, start), (zero, zero, zero), (zero, zero, zero)
    for j in range(count):
        i = shifted(node, j, 1, 0) if j < count - 1 else end
        s = shifted(first, j, 1, 0)
        row, predicted_tension, q1 = shifted(s, 0, SEGMENT_COLUMNS, 0), load(net.tension, s), row3(flat_q, i)
        a1 = row3(flat_base, i)
        if creep is None:
            T, new = linearise(stage, law, q0, q1, a0, a1, predicted_tension, load_history(segment, row))
        else:
            of_segment = law, with_largest_tension(creep, net.crept[s, CREPT_T_MAX]), net.crept[s, CREPT_STRETCH]
            history = load_history(segment, row)
            T, new, net.crept[s, CREPT_CHANGE] = linearise_creeping(stage, of_segment, q0, q1, a0, a1, predicted_tension, history)
        store_linearised(segment, row, new)
        tension_used = select(two_way_damper == 0.0, max(predicted_tension, 0.0), predicted_tension)
        largest_used = max(largest_used, abs(tension_used))
        tension_gap = max(
            tension_gap,
            abs(new.tension - tension_used) * select(new.stiffness > least_taut_slope, taut.force_per_tension_error, 1.0),
        )
        pull = (T * new.ex, T * new.ey, T * new.ez)
        predicted_pull = (tension_used * new.ex, tension_used * new.ey, tension_used * new.ez)
        if j == 0:
            add_to_points(net.predicted_force, net.n_interior, start, members, predicted_pull, 1.0)
            add_to_points(net.law_force, 0, start, members, pull, 1.0)
        else:
            x, y, z = row3(flat_right, shifted(node, j - 1, 1, 0))
            scale = max(scale, max(abs(x), max(abs(y), abs(z))))
            rx, ry, rz = x + pull[0] - pull_behind[0], y + pull[1] - pull_behind[1], z + pull[2] - pull_behind[2]
            norm, sum_of_forces = max(norm, max(abs(rx), max(abs(ry), abs(rz)))), sum_of_forces + (rx + ry + rz)
            px, py = x + predicted_pull[0] - predicted_behind[0], y + predicted_pull[1] - predicted_behind[1]
            pz = z + predicted_pull[2] - predicted_behind[2]
            predicted = max(predicted, max(abs(px), max(abs(py), abs(pz))))
        pull_behind, predicted_behind, q0, a0, largest_tension = pull, predicted_pull, q1, a1, max(largest_tension, abs(T))
    add_to_points(net.predicted_force, net.n_interior, end, members, predicted_behind, -1.0)
    add_to_points(net.law_force, 0, end, members, pull_behind, -1.0)
    largest_length = max(L0, largest_coordinate)
    # where all segments are slack, by the law and by the Newton step, no rounding of a length becomes a force
    rounded_length = select(max(largest_tension, largest_used) > 0.0, largest_length, zero)
    noise = FORCE_ROUNDING * (largest_tension + (k + damper * per_tau) * rounded_length)
    predicted_noise = FORCE_ROUNDING * (
        largest_tension + (taut.force_per_tension_error * taut.damped_slope + taut.force_per_length_error) * rounded_length
    )
    return CableBalance(
        max_of_lanes(norm),
        max_of_lanes(scale),
        max_of_lanes(noise),
        max_of_lanes(max(predicted, tension_gap)),
        max_of_lanes(predicted_noise),
        sum_of_lanes(sum_of_forces),
    )


@inlined
def joined(first, second):
    """`CableBalance` of two sets of cables together: the larger one of each number, and the sum of the sums of forces."""
    return CableBalance(
        max(first.norm, second.norm),
        max(first.scale, second.scale),
        max(first.noise, second.noise),
        max(first.predicted, second.predicted),
        max(first.predicted_noise, second.predicted_noise),
        first.sum_of_forces + second.sum_of_forces,
    )


@on_demand
def residual_of_singles(stage, net_address, base, q, step, largest_coordinate):
    """`cable_residual` of the cables that are in no group."""
    net, balance = view_net(net_address), CableBalance(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for c in net.single_cables:
        law = cable_law(stage, net, c, step)
        balance = joined(balance, cable_residual(stage, net, (c, 1), base, q, law, None, largest_coordinate))
    return balance


@on_demand
def residual_of_groups(stage, net_address, base, q, step, largest_coordinate):
    """`cable_residual` of the cables that are taken by fours."""
    net, balance = view_net(net_address), CableBalance(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for g in range(net.cable_groups.shape[0]):
        c, members = group_members(net.cable_groups, g), net.cable_groups[g, WIDTH]
        law = cable_law(stage, net, c, step)
        if are_plain(stage.law, net, c):
            known_stage, known_law = plain_stage(stage), plain_cable_law(net, c, law)
            own = cable_residual(known_stage, net, (c, members), base, q, known_law, None, largest_coordinate)
        else:
            own = cable_residual(stage, net, (c, members), base, q, law, None, largest_coordinate)
        balance = joined(balance, own)
    return balance


@internal
def _begin_with_inertia(net_address, weight, target, q):
    """Write the inertial forces of a stage to ``net.right_side``, and no force on prescribed nodes.

    ``weight`` is its W. The inertia of bodies is not that of each of their nodes. Four nodes are taken at once.

    Returns
    -------
    largest_coordinate : [m], and the largest components of inertial force [N] and inertial stiffness [N/m]
    """
    net = view_net(net_address)
    mass, with_inertia, right_side, flat_q, flat_target = net.mass, net.bodies.first, flat(net.right_side), flat(q), flat(target)
    by_fours = with_inertia - with_inertia % WIDTH
    coordinates, forces, inertias = spread(0.0), spread(0.0), spread(0.0)
    for i in range(0, by_fours, WIDTH):
        a, W = 3 * i, weight * load_row(mass, i)
        b, c, (W_a, W_b, W_c) = a + WIDTH, a + 2 * WIDTH, thrice(W)
        x, y, z = load_row(flat_q, a), load_row(flat_q, b), load_row(flat_q, c)
        fx, fy, fz = (
            W_a * (load_row(flat_target, a) - x),
            W_b * (load_row(flat_target, b) - y),
            W_c * (load_row(flat_target, c) - z),
        )
        store_row(right_side, a, fx)
        store_row(right_side, b, fy)
        store_row(right_side, c, fz)
        # the largest of three first: so the running maximum waits for one comparison, not for three
        coordinates = max(coordinates, max(max(abs(x), abs(y)), abs(z)))
        forces, inertias = max(forces, max(max(abs(fx), abs(fy)), abs(fz))), max(inertias, W)
    largest_coordinate, scale, largest_inertia = max_of_lanes(coordinates), max_of_lanes(forces), max_of_lanes(inertias)
    for i in range(by_fours, q.shape[0]):
        W, a = mass[i] * weight if i < with_inertia else 0.0, 3 * i
        x, y, z = flat_q[a], flat_q[a + 1], flat_q[a + 2]
        largest_coordinate, largest_inertia = max(largest_coordinate, abs(x), abs(y), abs(z)), max(largest_inertia, W)
        fx, fy, fz = W * (flat_target[a] - x), W * (flat_target[a + 1] - y), W * (flat_target[a + 2] - z)
        if i >= net.n_free:
            fx, fy, fz = 0.0, 0.0, 0.0  # also where a target is not finite
        scale = max(scale, abs(fx), abs(fy), abs(fz))
        right_side[a], right_side[a + 1], right_side[a + 2] = fx, fy, fz
    return largest_coordinate, scale, largest_inertia


@inlined
def _begin_with_inertial_stiffness(net, weight):
    """Write the inertial stiffness of a stage to ``net.diagonal``, of the free nodes whose elimination reads it."""
    D, with_inertia = flat(net.diagonal), net.bodies.first
    for i in range(net.n_interior if eliminates_inertia(net) else 0, net.n_free):
        W, b = net.mass[i] * weight if i < with_inertia else 0.0, 9 * i
        D[b], D[b + 1], D[b + 2], D[b + 3] = W, 0.0, 0.0, 0.0
        D[b + 4], D[b + 5], D[b + 6], D[b + 7], D[b + 8] = W, 0.0, 0.0, 0.0, W


@inlined
def _add_effects(stage, net, base, q):
    """Add the forces of effects to ``net.right_side``, and their stiffness to ``net.diagonal`` and the blocks of neighbours.

    An effect with a force of its own for a whole step has that in a step of `LAW_BETWEEN`, else the one at the middle of the stage.

    Returns
    -------
    taken, taken_by_method : float64 [J], in the step, by the effects and by what keeps their steps stable
    """
    effects, middle_q, middle_v, per_tau = net.effects, net.middle_q, net.middle_v, 1.0 / stage.tau
    if any_live(net):
        take_middle(net, stage.theta, per_tau, base, q)
    if net.near_blocks.shape[0] > 0:
        clear(net.near_blocks)
        clear(net.far_blocks)
    taken, taken_by_method = 0.0, 0.0
    for e in range(effects.address.shape[0]):
        (index, params), addresses = numbers_of(effects, e), effects.address[e]
        if addresses[SLOT_WHOLE_STEP] != 0 and stage.law == LAW_BETWEEN:
            by_effect, by_method = as_whole_step(addresses[SLOT_WHOLE_STEP])(
                stage.t,
                stage.tau,
                stage.dissipation,
                base,
                q,
                index,
                params,
                net.right_side,
                net.diagonal,
                net.near_blocks,
                net.far_blocks,
            )
            taken, taken_by_method = taken + by_effect, taken_by_method + by_method
            continue
        taken += stage.tau * as_force(addresses[SLOT_FORCE])(stage.t, middle_q, middle_v, index, params, net.right_side)
        if addresses[SLOT_TANGENT] != 0:
            as_tangent(addresses[SLOT_TANGENT])(
                stage.t, middle_q, middle_v, index, params, stage.theta, per_tau, net.diagonal, net.near_blocks, net.far_blocks
            )
    return taken, taken_by_method


@inlined
def _add_fluid(stage, net, target, q):
    """Add the inertia of the fluid that moves along with nodes to ``net.right_side`` and ``net.diagonal``."""
    right_side, diagonal = net.right_side, net.diagonal
    add_masses(net, stage.t, net.middle_q)
    for i in range(net.n_free):
        A = net.added_mass[i]
        for y in range(3):
            slowing = stage.W * (target[i, y] - q[i, y])
            if i >= net.bodies.first:
                slowing = net.bodies.slowing[i - net.bodies.first, y]
            for x in range(3):
                right_side[i, x] += A[x, y] * slowing
        for x in range(3):
            for y in range(3):
                diagonal[i, x, y] += stage.W * A[x, y]


@inlined
def _note_stage(stage, net, taken, taken_by_method):
    """Write of which stage ``net.segment`` holds the linearisation, and what its effects take, for those who read either."""
    linearised = net.linearised
    linearised[LINEARISED_LAW], linearised[LINEARISED_TAU], linearised[LINEARISED_W] = stage.law, stage.tau, stage.W
    linearised[LINEARISED_BEGINNING], linearised[LINEARISED_CURRENT] = LINEARISED_SAME_STEP, 1.0
    linearised[LINEARISED_TAKEN], linearised[LINEARISED_TAKEN_BY_METHOD] = taken, taken_by_method


@inlined
def _add_cables_and_bodies(stage, net_address, net, base, q, step, largest_coordinate, balance):
    """Linearise all segments and bodies, and add their forces; returns their `CableBalance` together with ``balance``."""
    if net.cable_groups.shape[0] > 0:
        of_groups = as_cable_residual(net.kernels[KERNEL_RESIDUAL_GROUPS])
        balance = joined(balance, of_groups(stage, net_address, base, q, step, largest_coordinate))
    if net.single_cables.shape[0] > 0:
        of_singles = as_cable_residual(net.kernels[KERNEL_RESIDUAL_SINGLES])
        balance = joined(balance, of_singles(stage, net_address, base, q, step, largest_coordinate))
    if net.bodies.first < net.n_free:
        of_bodies = as_balance_bodies(net.kernels[KERNEL_BALANCE_BODIES])
        balance = joined(balance, of_bodies(stage, net_address, largest_coordinate, balance.noise, balance.predicted_noise))
    return balance


@inlined
def _with_points(net, balance):
    """``norm``, ``predicted`` and the sum of forces of a `CableBalance`, with those of the points between cables."""
    norm, predicted, sum_of_forces = balance.norm, balance.predicted, balance.sum_of_forces
    law_force, predicted_force = net.law_force, net.predicted_force
    for i in range(net.n_interior, net.bodies.first):
        p = i - net.n_interior
        norm = max(norm, abs(law_force[i, 0]), abs(law_force[i, 1]), abs(law_force[i, 2]))
        sum_of_forces += law_force[i, 0] + law_force[i, 1] + law_force[i, 2]
        predicted = max(predicted, abs(predicted_force[p, 0]), abs(predicted_force[p, 1]), abs(predicted_force[p, 2]))
    return norm, predicted, sum_of_forces


@kernel(types.UniTuple(float64, 4)(STAGE, _f2, _f2, _f2, int64))
def residual(stage, base, target, q, net_address):
    """Out-of-balance force of a stage on every node, and its linearisation in the net.

    On node i the force is r_i = m_i W (target_i - q_i) + f_i + sum over its segments of +- T e, with the external force f_i.

    Parameters
    ----------
    stage : Stage
    base, target, q : (n, 3) float64 [m]
        See `integrators.stage`. The rows of prescribed nodes hold the prescribed positions in q, and in base such positions that
        (q - base)/tau is the prescribed velocity.
    net_address : int64
        Address of the net. The geometric stiffness of each segment is that of its tension in ``net.tension``. ``net.segment``,
        ``net.diagonal`` and ``net.right_side`` are written; the latter holds the forces of effects on prescribed nodes.

    Returns
    -------
    norm : float64 [N]
        Largest component of r.
    scale : float64 [N]
        Largest inertial or external force on a node, which tolerances are relative to.
    noise : float64 [N]
        What rounding of the positions alone leaves in ``norm``.
    predicted : float64 [N]
        Largest component of r with the tensions that the last Newton step predicted, in place of the tensions by the law at q; or
        the largest difference between both tensions of a segment, if that is larger. The difference counts in full for a segment
        that is not linearised as taut, else times `TautLaw.force_per_tension_error`. What rounding leaves is subtracted. The
        Newton step gives the tension of a stiff segment far more exactly than the law does from rounded positions.
    """
    net = view_net(net_address)
    if net.lengths.cable.shape[0] > 0:
        set_stage_lengths(stage, net_address)
    if net.bodies.first < net.n_free:
        as_place_bodies(net.kernels[KERNEL_PLACE_BODIES])(stage, net_address, base, target, q)
    largest_coordinate, scale, largest_inertia = _begin_with_inertia(net_address, stage.W, target, q)
    _begin_with_inertial_stiffness(net, stage.W)
    taken, taken_by_method = _add_effects(stage, net, base, q)
    if net.added_mass.shape[0] > 0:
        _add_fluid(stage, net, target, q)
    for i in range(net.n_interior, q.shape[0]):  # to which the cables add by their law, and as the last step predicted
        for x in range(3):
            net.law_force[i, x] = net.predicted_force[i - net.n_interior, x] = net.right_side[i, x]
    step = net.linearised[LINEARISED_BEGINNING]
    _note_stage(stage, net, taken, taken_by_method)
    inertia_noise = FORCE_ROUNDING * largest_inertia * largest_coordinate
    balance = CableBalance(0.0, scale, inertia_noise, 0.0, inertia_noise, 0.0)
    balance = _add_cables_and_bodies(stage, net_address, net, base, q, step, largest_coordinate, balance)
    norm, predicted, sum_of_forces = _with_points(net, balance)
    finite = sum_of_forces - sum_of_forces == 0.0
    if not finite:
        norm = UNKNOWN_FORCE
    if stage.law == LAW_AT_END or not finite:
        predicted = UNKNOWN_FORCE
    return norm, balance.scale, balance.noise, max(0.0, predicted - balance.predicted_noise)
