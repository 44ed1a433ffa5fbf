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
    """Rest lengths at the end and the start of a stage, and what else follows from them where external forces are taken."""
    begins = stage.t - (stage.theta * stage.tau if stage.law != LAW_AT_END else 0.0)
    net = view_net(net_address)
    ends = begins + stage.tau if stage.law != LAW_AT_END else stage.t
    as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, begins, stage.t, ends)
    if stage.law == LAW_AT_END:
        for c in net.lengths.cable:
            net.axial[c, AXIAL_L0_BEFORE] = net.axial[c, AXIAL_L0] - stage.tau * net.axial[c, AXIAL_L0_RATE]


@inlined
def _cable_residual(stage, net, c, members, base, q, beginning, reach):
    """`residual` of a cable, or of the cables of a group of which ``members`` count.

    Returns norm, scale, noise and predicted of its interior nodes, what rounding leaves of the last, and a number that is not
    finite if a force is not.
    """
    first, node, per_tau = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE), 1.0 / stage.tau
    start, end = column(net.cable, c, CABLE_START), column(net.cable, c, CABLE_END)
    count, two_damper = segment_count(net, c), group_constant(net, c, AXIAL_TWO_WAY_DAMPER)
    L0, k, damper = column(net.axial, c, AXIAL_L0), column(net.axial, c, AXIAL_STIFFNESS), column(net.axial, c, AXIAL_DAMPER)
    numerical, rigid, soft, taut, light, share = weights(stage, net, c)
    law = (
        spring_of(net, c), k, column(net.axial, c, AXIAL_L0_BEFORE), damper, two_damper, group_constant(net, c, AXIAL_INEXTENSIBLE),
        numerical, rigid, light, beginning, net.linearised[LINEARISED_LEAST_DAMPER],
    )  # fmt: skip
    Q, A, R, segment = flat(q), flat(base), flat(net.right_side), flat(net.segment)
    zero = 0.0 * L0
    norm, scale, predicted, finite, off, most, enough = zero, zero, zero, zero, zero, zero, 0.9 * soft
    q0, a0, f, h = row3(Q, start), row3(A, start), (zero, zero, zero), (zero, zero, zero)
    for j in range(count):
        i = shifted(node, j, 1, 0) if j < count - 1 else end
        s = shifted(first, j, 1, 0)
        row, guess, q1, a1 = shifted(s, 0, SEGMENT_COLUMNS, 0), load(net.tension, s), row3(Q, i), row3(A, i)
        stretch, _, last, damped = load_four(segment, shifted(row, 0, 1, SEGMENT_STRETCH))
        old = load(segment, shifted(row, 0, 1, SEGMENT_STRETCH_BEFORE)), stretch, last, damped
        T, new = linearise(stage, q0, q1, a0, a1, law, guess, old)
        store_four(segment, row, new[:4])
        store_four(segment, shifted(row, 0, 1, 4), new[4:8])
        store_four(segment, shifted(row, 0, 1, 8), new[8:12])
        store(segment, shifted(row, 0, 1, SEGMENT_LAST_CHANGE), new[SEGMENT_LAST_CHANGE])
        store(segment, shifted(row, 0, 1, SEGMENT_NUMERICAL_DAMPER), new[SEGMENT_NUMERICAL_DAMPER])
        used = select(two_damper == 0.0, max(guess, 0.0), guess)
        off = max(off, abs(new[SEGMENT_TENSION] - used) * select(new[SEGMENT_STIFFNESS] > enough, share, 1.0))
        t, u = (T * new[0], T * new[1], T * new[2]), (used * new[0], used * new[1], used * new[2])
        if j == 0:
            add_to_points(net.predicted_force, net.n_interior, start, members, u, 1.0)
            add_to_points(net.law_force, 0, start, members, t, 1.0)
        else:
            x, y, z = row3(R, shifted(node, j - 1, 1, 0))
            scale = max(scale, max(abs(x), max(abs(y), abs(z))))
            rx, ry, rz = x + t[0] - f[0], y + t[1] - f[1], z + t[2] - f[2]
            norm, finite = max(norm, max(abs(rx), max(abs(ry), abs(rz)))), finite + (rx + ry + rz)
            px, py, pz = x + u[0] - h[0], y + u[1] - h[1], z + u[2] - h[2]
            predicted = max(predicted, max(abs(px), max(abs(py), abs(pz))))
        f, h, q0, a0, most = t, u, q1, a1, max(most, abs(T))
    add_to_points(net.predicted_force, net.n_interior, end, members, h, -1.0)
    add_to_points(net.law_force, 0, end, members, f, -1.0)
    noise = 4.0 * EPS * (most + (k + damper * per_tau) * max(L0, reach))
    floor = 4.0 * EPS * (most + (share * taut + light) * max(L0, reach))
    return (
        max_of_lanes(norm),
        max_of_lanes(scale),
        max_of_lanes(noise),
        max_of_lanes(max(predicted, off)),
        max_of_lanes(floor),
        sum_of_lanes(finite),
    )


@inlined
def _worse(a, b):
    """Of two results of `_cable_residual`."""
    return max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3]), max(a[4], b[4]), a[5] + b[5]


@on_demand
def residual_of_singles(stage, net_address, base, q, beginning, reach):
    """`_cable_residual` of the cables that are in no group."""
    net, worst = view_net(net_address), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for c in net.single_cables:
        worst = _worse(worst, _cable_residual(stage, net, c, 1, base, q, beginning, reach))
    return worst


@on_demand
def residual_of_groups(stage, net_address, base, q, beginning, reach):
    """`_cable_residual` of the cables that are taken by fours."""
    net, worst = view_net(net_address), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for g in range(net.cable_groups.shape[0]):
        members = group_members(net.cable_groups, g)
        worst = _worse(worst, _cable_residual(stage, net, members, net.cable_groups[g, WIDTH], base, q, beginning, reach))
    return worst


@kernel(types.UniTuple(float64, 4)(STAGE, _f2, _f2, _f2, int64))
def residual(stage, base, target, q, net_address):
    """Out-of-balance force of a stage, and its linearisation in the net.

    Parameters
    ----------
    stage : Stage
    base, target, q : (n, 3) float64 [m]
        See `integrators.stage`; prescribed rows of q hold the prescribed places, those of base what makes v_m theirs.
    net_address : int64
        Address of the net; its ``tension`` holds the tensions that the geometric stiffness takes; ``segment``, ``diagonal``
        and ``right`` are written.

    Returns
    -------
    norm, scale, noise, predicted : float64 [N]
        Largest component of the out-of-balance force; the largest inertial or external force on a node, which a tolerance
        is relative to; what rounding of the places alone leaves in it; and the out-of-balance force with the tensions of the
        net instead of those of the law at q, or, if it is more, the length by which the two laws of a segment differ, as
        inertia would feel it, less what rounding leaves. That length is all that a stiff segment leaves open, and the
        tension that goes with it is known far better from the Newton step than from the places.
    """
    net = view_net(net_address)
    if net.lengths.cable.shape[0] > 0:
        set_stage_lengths(stage, net_address)
    n, n_free, mass, right, diagonal = q.shape[0], net.n_free, net.mass, net.right_side, net.diagonal
    middle_q, middle_v, per_tau = net.middle_q, net.middle_v, 1.0 / stage.tau
    reach, scale, heaviest = 0.0, 0.0, 0.0
    for i in range(n):
        W = mass[i] * stage.W if i < n_free else 0.0
        x, y, z = q[i, 0], q[i, 1], q[i, 2]
        fx, fy, fz = W * (target[i, 0] - x), W * (target[i, 1] - y), W * (target[i, 2] - z)
        right[i, 0], right[i, 1], right[i, 2] = fx, fy, fz
        # one of three first, so that a node waits but once for the one before it
        reach, scale = max(reach, max(abs(x), abs(y), abs(z))), max(scale, max(abs(fx), abs(fy), abs(fz)))
        heaviest = max(heaviest, W)
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
        (index, params), of = numbers_of(effects, e), effects.address[e]
        if of[SLOT_WHOLE_STEP] != 0 and stage.law == LAW_BETWEEN:
            as_whole_step(of[SLOT_WHOLE_STEP])(
                stage.t, stage.tau, stage.dissipation, base, q, index, params, right, diagonal, net.near_blocks, net.far_blocks
            )
            continue
        as_force(of[SLOT_FORCE])(stage.t, middle_q, middle_v, index, params, right)
        if of[SLOT_TANGENT] != 0:
            as_tangent(of[SLOT_TANGENT])(
                stage.t, middle_q, middle_v, index, params, stage.theta, per_tau, diagonal, net.near_blocks, net.far_blocks
            )
    if net.added_mass.shape[0] > 0:
        add_masses(net, stage.t, middle_q)
        for i in range(n_free):
            A = net.added_mass[i]
            for x in range(3):
                for y in range(3):
                    right[i, x] += stage.W * A[x, y] * (target[i, y] - q[i, y])
                    diagonal[i, x, y] += stage.W * A[x, y]
    pull = net.law_force
    for i in range(net.n_interior, n):
        for x in range(3):
            pull[i, x] = right[i, x]
    norm, noise, finite, predicted, floor = 0.0, 4.0 * EPS * heaviest * reach, 0.0, 0.0, 4.0 * EPS * heaviest * reach
    kept, beginning = net.predicted_force, net.linearised[LINEARISED_BEGINNING]
    net.linearised[LINEARISED_LAW], net.linearised[LINEARISED_TAU], net.linearised[LINEARISED_BEGINNING] = stage.law, stage.tau, 0.0
    for i in range(net.n_interior, n):
        for x in range(3):
            kept[i - net.n_interior, x] = right[i, x]
    worst = norm, scale, noise, predicted, floor, finite
    if net.cable_groups.shape[0] > 0:
        cables = as_cable_residual(net.kernels[KERNEL_RESIDUAL_GROUPS])(stage, net_address, base, q, beginning, reach)
        worst = _worse(worst, cables)
    if net.single_cables.shape[0] > 0:
        cables = as_cable_residual(net.kernels[KERNEL_RESIDUAL_SINGLES])(stage, net_address, base, q, beginning, reach)
        worst = _worse(worst, cables)
    norm, scale, noise, predicted, floor, finite = worst
    for i in range(net.n_interior, n_free):
        norm = max(norm, abs(pull[i, 0]), abs(pull[i, 1]), abs(pull[i, 2]))
        finite += pull[i, 0] + pull[i, 1] + pull[i, 2]
        p = i - net.n_interior
        predicted = max(predicted, abs(kept[p, 0]), abs(kept[p, 1]), abs(kept[p, 2]))
    if not finite - finite == 0.0:
        norm = 1e300
    if stage.law == LAW_AT_END or not finite - finite == 0.0:
        predicted = 1e300
    return norm, scale, noise, max(0.0, predicted - floor)
