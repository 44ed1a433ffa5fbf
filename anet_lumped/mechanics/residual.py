"""The residual of a stage of an implicit method, and its linearisation."""

from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, internal, kernel, on_demand
from anet_lumped.compiled.lanes import (
    WIDTH,
    column,
    group_members,
    load,
    load_four,
    max_of_lanes,
    select,
    shifted,
    store,
    store_four,
    sum_of_lanes,
)
from anet_lumped.effects.signatures import as_force, as_tangent, as_whole_step
from anet_lumped.mechanics.cable_rows import add_to_points, row3, segment_count
from anet_lumped.mechanics.effect_forces import add_masses, any_live, clear, numbers_of, take_middle
from anet_lumped.mechanics.optional import as_cable_residual, as_set_lengths
from anet_lumped.mechanics.segment_law import (
    group_constant,
    linearise,
    spring_of,
    weights,
)
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_L0_RATE,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_START,
    KERNEL_RESIDUAL_GROUPS,
    KERNEL_RESIDUAL_SINGLES,
    KERNEL_SET_LENGTHS,
    LINEARISED_BEGINNING,
    LINEARISED_LAW,
    LINEARISED_LEAST_DAMPER,
    LINEARISED_TAU,
    SEGMENT_COLUMNS,
    SEGMENT_LAST_CHANGE,
    SEGMENT_NUMERICAL_DAMPER,
    SEGMENT_STIFFNESS,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
    SLOT_FORCE,
    SLOT_TANGENT,
    SLOT_WHOLE_STEP,
)
from integrators.flat_view import flat
from integrators.stage import LAW_AT_END, LAW_BETWEEN, STAGE

_f2 = float64[:, ::1]

EPS = 2.220446049250313e-16


@internal
def set_stage_lengths(stage, net_address):
    """Write the rest lengths at the start and the end of a stage, and masses and the effects' numbers at its time ``stage.t``."""
    t_start = stage.t - (stage.theta * stage.tau if stage.law != LAW_AT_END else 0.0)
    net = view_net(net_address)
    t_end = t_start + stage.tau if stage.law != LAW_AT_END else stage.t
    as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t_start, stage.t, t_end)
    if stage.law == LAW_AT_END:
        for c in net.lengths.cable:
            net.axial[c, AXIAL_L0_BEFORE] = net.axial[c, AXIAL_L0] - stage.tau * net.axial[c, AXIAL_L0_RATE]


@inlined
def _cable_residual(stage, net, c, members, base, q, beginning, largest_coordinate):
    """`residual` of a cable, or of the cables of a group of which ``members`` count.

    Returns
    -------
    norm, scale, noise, predicted : float64 [N]
        As `residual`, of the interior nodes.
    floor : float64 [N]
        What rounding alone leaves in ``predicted``.
    sum_of_forces : float64 [N]
        Not finite if any force is not.
    """
    first, node, per_tau = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE), 1.0 / stage.tau
    start, end = column(net.cable, c, CABLE_START), column(net.cable, c, CABLE_END)
    count, two_damper = segment_count(net, c), group_constant(net, c, AXIAL_TWO_WAY_DAMPER)
    L0, k, damper = column(net.axial, c, AXIAL_L0), column(net.axial, c, AXIAL_STIFFNESS), column(net.axial, c, AXIAL_DAMPER)
    numerical_damper, length_penalty, undamped_slope, damped_slope, length_weight, tension_weight = weights(stage, net, c)
    law = (
        spring_of(net, c), k, column(net.axial, c, AXIAL_L0_BEFORE), damper, two_damper, group_constant(net, c, AXIAL_INEXTENSIBLE),
        numerical_damper, length_penalty, length_weight, beginning, net.linearised[LINEARISED_LEAST_DAMPER],
    )  # fmt: skip
    flat_q, flat_base, flat_right, segment = flat(q), flat(base), flat(net.right_side), flat(net.segment)
    zero = 0.0 * L0
    norm, scale, predicted, sum_of_forces, tension_gap, largest_tension = zero, zero, zero, zero, zero, zero
    stiff_enough = 0.9 * undamped_slope
    q0, a0, pull_behind, predicted_behind = row3(flat_q, start), row3(flat_base, start), (zero, zero, zero), (zero, zero, zero)
    for j in range(count):
        i = shifted(node, j, 1, 0) if j < count - 1 else end
        s = shifted(first, j, 1, 0)
        row, predicted_tension, q1 = shifted(s, 0, SEGMENT_COLUMNS, 0), load(net.tension, s), row3(flat_q, i)
        a1 = row3(flat_base, i)
        stretch, _, last_change, damper_used = load_four(segment, shifted(row, 0, 1, SEGMENT_STRETCH))
        old = load(segment, shifted(row, 0, 1, SEGMENT_STRETCH_BEFORE)), stretch, last_change, damper_used
        T, new = linearise(stage, q0, q1, a0, a1, law, predicted_tension, old)
        store_four(segment, row, new[:4])
        store_four(segment, shifted(row, 0, 1, 4), new[4:8])
        store_four(segment, shifted(row, 0, 1, 8), new[8:12])
        store(segment, shifted(row, 0, 1, SEGMENT_LAST_CHANGE), new[SEGMENT_LAST_CHANGE])
        store(segment, shifted(row, 0, 1, SEGMENT_NUMERICAL_DAMPER), new[SEGMENT_NUMERICAL_DAMPER])
        tension_used = select(two_damper == 0.0, max(predicted_tension, 0.0), predicted_tension)
        tension_gap = max(
            tension_gap,
            abs(new[SEGMENT_TENSION] - tension_used) * select(new[SEGMENT_STIFFNESS] > stiff_enough, tension_weight, 1.0),
        )
        pull = (T * new[0], T * new[1], T * new[2])
        predicted_pull = (tension_used * new[0], tension_used * new[1], tension_used * new[2])
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
    noise = 4.0 * EPS * (largest_tension + (k + damper * per_tau) * max(L0, largest_coordinate))
    floor = 4.0 * EPS * (largest_tension + (tension_weight * damped_slope + length_weight) * max(L0, largest_coordinate))
    return (
        max_of_lanes(norm),
        max_of_lanes(scale),
        max_of_lanes(noise),
        max_of_lanes(max(predicted, tension_gap)),
        max_of_lanes(floor),
        sum_of_lanes(sum_of_forces),
    )


@inlined
def _larger(first, second):
    """Larger one of each number of two results of `_cable_residual`; of the last number, the sum."""
    return (
        max(first[0], second[0]),
        max(first[1], second[1]),
        max(first[2], second[2]),
        max(first[3], second[3]),
        max(first[4], second[4]),
        first[5] + second[5],
    )


@on_demand
def residual_of_singles(stage, net_address, base, q, beginning, largest_coordinate):
    """`_cable_residual` of the cables that are in no group."""
    net, largest = view_net(net_address), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for c in net.single_cables:
        largest = _larger(largest, _cable_residual(stage, net, c, 1, base, q, beginning, largest_coordinate))
    return largest


@on_demand
def residual_of_groups(stage, net_address, base, q, beginning, largest_coordinate):
    """`_cable_residual` of the cables that are taken by fours."""
    net, largest = view_net(net_address), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for g in range(net.cable_groups.shape[0]):
        members = group_members(net.cable_groups, g)
        largest = _larger(
            largest, _cable_residual(stage, net, members, net.cable_groups[g, WIDTH], base, q, beginning, largest_coordinate)
        )
    return largest


@kernel(types.UniTuple(float64, 4)(STAGE, _f2, _f2, _f2, int64))
def residual(stage, base, target, q, net_address):
    """Out-of-balance force of a stage, and its linearisation in the net.

    Parameters
    ----------
    stage : Stage
    base, target, q : (n, 3) float64 [m]
        See `integrators.stage`. Prescribed rows of q hold the prescribed positions; those of base are such that
        (q - base)/tau is the prescribed velocity.
    net_address : int64
        Address of the net. The geometric stiffness is that of the tensions in ``tension``; ``segment``, ``diagonal``
        and ``right_side`` are written.

    Returns
    -------
    norm, scale, noise, predicted : float64 [N]
        ``norm``: largest component of the out-of-balance force. ``scale``: largest inertial or external force on a node, which
        tolerances are relative to. ``noise``: what rounding of the positions alone leaves in ``norm``.

        ``predicted``: the out-of-balance force with the tensions that the last Newton step predicted, in place of those of the
        law at q. Or, if that is larger, the difference between both tensions of a segment: in full where the segment is not
        linearised as taut, else by the share of it that `weights` says. Less what rounding leaves in either. The Newton
        step gives the tension of a stiff segment far more exactly than the law does from rounded positions.
    """
    net = view_net(net_address)
    if net.lengths.cable.shape[0] > 0:
        set_stage_lengths(stage, net_address)
    n, n_free, mass, right_side, diagonal = q.shape[0], net.n_free, net.mass, net.right_side, net.diagonal
    middle_q, middle_v, per_tau = net.middle_q, net.middle_v, 1.0 / stage.tau
    largest_coordinate, scale, largest_inertia = 0.0, 0.0, 0.0
    for i in range(n):
        W = mass[i] * stage.W if i < n_free else 0.0
        x, y, z = q[i, 0], q[i, 1], q[i, 2]
        fx, fy, fz = W * (target[i, 0] - x), W * (target[i, 1] - y), W * (target[i, 2] - z)
        right_side[i, 0], right_side[i, 1], right_side[i, 2] = fx, fy, fz
        # the largest of the three first, so that the maximum over all nodes waits only once for each node
        largest_coordinate, scale = max(largest_coordinate, max(abs(x), abs(y), abs(z))), max(scale, max(abs(fx), abs(fy), abs(fz)))
        largest_inertia = max(largest_inertia, W)
        if i < n_free:
            D = diagonal[i]
            D[0, 0], D[0, 1], D[0, 2] = W, 0.0, 0.0
            D[1, 0], D[1, 1], D[1, 2] = 0.0, W, 0.0
            D[2, 0], D[2, 1], D[2, 2] = 0.0, 0.0, W
    effects = net.effects
    if any_live(net):
        take_middle(net, stage.theta, per_tau, base, q)
    if net.near_blocks.shape[0] > 0:
        clear(net.near_blocks)
        clear(net.far_blocks)
    for e in range(effects.address.shape[0]):
        (index, params), addresses = numbers_of(effects, e), effects.address[e]
        if addresses[SLOT_WHOLE_STEP] != 0 and stage.law == LAW_BETWEEN:
            as_whole_step(addresses[SLOT_WHOLE_STEP])(
                stage.t, stage.tau, stage.dissipation, base, q, index, params, right_side, diagonal, net.near_blocks, net.far_blocks
            )
            continue
        as_force(addresses[SLOT_FORCE])(stage.t, middle_q, middle_v, index, params, right_side)
        if addresses[SLOT_TANGENT] != 0:
            as_tangent(addresses[SLOT_TANGENT])(
                stage.t, middle_q, middle_v, index, params, stage.theta, per_tau, diagonal, net.near_blocks, net.far_blocks
            )
    if net.added_mass.shape[0] > 0:
        add_masses(net, stage.t, middle_q)
        for i in range(n_free):
            A = net.added_mass[i]
            for x in range(3):
                for y in range(3):
                    right_side[i, x] += stage.W * A[x, y] * (target[i, y] - q[i, y])
                    diagonal[i, x, y] += stage.W * A[x, y]
    law_force = net.law_force
    for i in range(net.n_interior, n):
        for x in range(3):
            law_force[i, x] = right_side[i, x]
    norm, noise, sum_of_forces, predicted = 0.0, 4.0 * EPS * largest_inertia * largest_coordinate, 0.0, 0.0
    floor = 4.0 * EPS * largest_inertia * largest_coordinate
    predicted_force, beginning = net.predicted_force, net.linearised[LINEARISED_BEGINNING]
    net.linearised[LINEARISED_LAW], net.linearised[LINEARISED_TAU], net.linearised[LINEARISED_BEGINNING] = stage.law, stage.tau, 0.0
    for i in range(net.n_interior, n):
        for x in range(3):
            predicted_force[i - net.n_interior, x] = right_side[i, x]
    largest = norm, scale, noise, predicted, floor, sum_of_forces
    if net.cable_groups.shape[0] > 0:
        of_cables = as_cable_residual(net.kernels[KERNEL_RESIDUAL_GROUPS])(
            stage, net_address, base, q, beginning, largest_coordinate
        )
        largest = _larger(largest, of_cables)
    if net.single_cables.shape[0] > 0:
        of_cables = as_cable_residual(net.kernels[KERNEL_RESIDUAL_SINGLES])(
            stage, net_address, base, q, beginning, largest_coordinate
        )
        largest = _larger(largest, of_cables)
    norm, scale, noise, predicted, floor, sum_of_forces = largest
    for i in range(net.n_interior, n_free):
        norm = max(norm, abs(law_force[i, 0]), abs(law_force[i, 1]), abs(law_force[i, 2]))
        sum_of_forces += law_force[i, 0] + law_force[i, 1] + law_force[i, 2]
        p = i - net.n_interior
        predicted = max(predicted, abs(predicted_force[p, 0]), abs(predicted_force[p, 1]), abs(predicted_force[p, 2]))
    if not sum_of_forces - sum_of_forces == 0.0:
        norm = 1e300
    if stage.law == LAW_AT_END or not sum_of_forces - sum_of_forces == 0.0:
        predicted = 1e300
    return norm, scale, noise, max(0.0, predicted - floor)
