"""The Newton step of a stage: solved again until no segment turns slack or taut in it."""

import math

from numba import float64, int64, types, void

from anet_lumped.compiled.jit import inlined, kernel, on_demand
from anet_lumped.compiled.lanes import column, group_members, lane, load, load_four, max_of_lanes, select, shifted, store
from anet_lumped.mechanics.cable_rows import row3, segment_count
from anet_lumped.mechanics.effect_forces import clear
from anet_lumped.mechanics.linear import solve
from anet_lumped.mechanics.optional import as_finish
from anet_lumped.mechanics.residual import EPS
from anet_lumped.mechanics.segment_law import (
    AFRESH,
    group_constant,
    penalty,
    reduced_slope,
    spring_of,
    tension_law,
    weights,
)
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_CURVE,
    CABLE_CURVE_END,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    KERNEL_FINISH_GROUPS,
    KERNEL_FINISH_SINGLES,
    LINEARISED_BEGINNING,
    LINEARISED_LAW,
    SEGMENT_COLUMNS,
    SEGMENT_DIRECTION,
    SEGMENT_GEOMETRIC,
    SEGMENT_GRADIENT,
    SEGMENT_NUMERICAL_DAMPER,
    SEGMENT_STIFFNESS,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
)
from integrators.flat_view import flat
from integrators.stage import LAW_AT_END, LAW_BETWEEN, STAGE

_f2 = float64[:, ::1]

ROUNDS = 4  # eliminations a Newton step may spend on finding which segments are slack


@inlined
def _cable_finish(stage, net, c):
    """Add to the tensions of a cable, or of a group, the part a n . d that `reduced_slope` took out of their slopes.

    Returns
    -------
    bound : float64 [N]
        The force that a whole Newton step leaves out of balance is at most this large; 1e300 if no bound is known.

    The bound is of second order in the step d of a segment's end relative to its start. The segment turns by up to
    |d|/(l_a + l); the tangent contains the part of that turn that the predicted tension makes. The length changes by up to
    |d|^2/(2 l) more than its linearisation says; `weights` tells the force that this length counts for.

    No bound is known where the law is not a straight line over the step: for a tension-strain curve, and for a segment that
    cannot push and was not linearised as taut, or becomes shorter than its rest length. A positive tension does not exclude
    the latter: the secant from a taut length to a short one is positive too.
    """
    first, node = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE)
    end = column(net.cable, c, CABLE_END)
    L0, step, segment, count = column(net.axial, c, AXIAL_L0), flat(net.newton_step), flat(net.segment), segment_count(net, c)
    _, _, undamped_slope, damped_slope, _, tension_weight = weights(stage, net, c)
    one_way = group_constant(net, c, AXIAL_PUSH_SHARE) < 1.0 and group_constant(net, c, AXIAL_INEXTENSIBLE) == 0.0
    has_curve = lane(column(net.cable, c, CABLE_CURVE), 0) < lane(column(net.cable, c, CABLE_CURVE_END), 0)
    per_length, second_order = (0.5 if stage.law == LAW_BETWEEN else 1.0) / L0, tension_weight * damped_slope / (2.0 * L0)
    largest_force, largest_square = 0.0 * L0, 0.0 * L0
    x0, y0, z0 = row3(step, column(net.cable, c, CABLE_START))
    for j in range(count):
        i = shifted(node, j, 1, 0) if j < count - 1 else end
        s = shifted(first, j, 1, 0)
        x1, y1, z1 = row3(step, i)
        gx, gy, gz, a = load_four(segment, shifted(s, 0, SEGMENT_COLUMNS, SEGMENT_GRADIENT))
        dx, dy, dz, T = x1 - x0, y1 - y0, z1 - z0, load(net.tension, s)
        x0, y0, z0 = x1, y1, z1
        step_square = dx * dx + dy * dy + dz * dz
        stiffness, lengthening = load(segment, shifted(s, 0, SEGMENT_COLUMNS, SEGMENT_STIFFNESS)), gx * dx + gy * dy + gz * dz
        if one_way:
            stretch, _, _, numerical = load_four(segment, shifted(s, 0, SEGMENT_COLUMNS, SEGMENT_STRETCH))
            taut_slope = undamped_slope + numerical if stage.law == LAW_BETWEEN else undamped_slope
            linearised_as_taut = (stretch > 0.0) | (stiffness + a > (1.0 - 1e-9) * taut_slope)
            largest_force = max(largest_force, select(linearised_as_taut & (stretch + lengthening > 0.0), 0.0, 1e300))
        T = select(stiffness != 0.0, T + a * lengthening, T)
        store(net.tension, s, T)
        turned_force = abs(T * per_length - a) * math.sqrt(step_square) + T * per_length * per_length * step_square
        largest_force, largest_square = max(largest_force, turned_force), max(largest_square, step_square)
    return 1e300 if has_curve else max_of_lanes(max(2.0 * largest_force, second_order * largest_square))


@on_demand
def finish_of_singles(stage, net_address):
    """`_cable_finish` of the cables that are in no group."""
    net, bound = view_net(net_address), 0.0
    for c in net.single_cables:
        bound = max(bound, _cable_finish(stage, net, c))
    return bound


@on_demand
def finish_of_groups(stage, net_address):
    """`_cable_finish` of the cables that are taken by fours."""
    net, bound = view_net(net_address), 0.0
    for g in range(net.cable_groups.shape[0]):
        bound = max(bound, _cable_finish(stage, net, group_members(net.cable_groups, g)))
    return bound


@kernel(types.Tuple((int64, float64))(STAGE, int64))
def direction(stage, net_address):
    """Newton step of the stage that `residual` linearised last, for ``net.newton_step`` and ``net.tension``.

    A segment that the step would make slack or taut leaves the piece of its law that was linearised: its law is replaced by
    the tangent at the predicted length and the step is solved again, until no segment changes.
    See ARCHITECTURE.md, *Slack and taut*.

    Returns
    -------
    solves : int64
        Eliminations made.
    unbalanced : float64 [N]
        The force that a whole step leaves out of balance is at most this large; 1e300 if only `residual` can tell.
    """
    net = view_net(net_address)
    right_side, law_force, step = net.right_side, net.law_force, net.newton_step
    for i in range(net.n_interior, net.n_free):
        for x in range(3):
            law_force[i, x] = right_side[i, x]
    length_direction, all_taut = SEGMENT_GRADIENT if stage.law == LAW_BETWEEN else SEGMENT_DIRECTION, False
    for solves in range(1, ROUNDS + 1):
        smallest = solve.solve(net_address)
        all_taut = smallest > 0.0  # all are taut and stay so: a slack segment has no tension
        if all_taut or solves == ROUNDS:
            break
        changed = False
        for c in range(net.cable.shape[0]):
            first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
            L0, k, damper = net.axial[c, AXIAL_L0], net.axial[c, AXIAL_STIFFNESS], net.axial[c, AXIAL_DAMPER]
            push_share, two_damper = net.axial[c, AXIAL_PUSH_SHARE], net.axial[c, AXIAL_TWO_WAY_DAMPER]
            spring, has_curve = spring_of(net, c), net.cable[c, CABLE_CURVE] < net.cable[c, CABLE_CURVE_END]
            if push_share == 1.0:
                continue
            length_penalty = penalty(stage, net, c)
            x0, y0, z0 = step[net.cable[c, CABLE_START], 0], step[net.cable[c, CABLE_START], 1], step[net.cable[c, CABLE_START], 2]
            for j in range(count):
                i = node + j if j < count - 1 else net.cable[c, CABLE_END]
                row = net.segment[first + j]
                n = row[length_direction : length_direction + 3]
                x1, y1, z1 = step[i, 0], step[i, 1], step[i, 2]
                lengthening = n[0] * (x1 - x0) + n[1] * (y1 - y0) + n[2] * (z1 - z0)
                x0, y0, z0 = x1, y1, z1
                stretch = row[SEGMENT_STRETCH] + lengthening
                T_linear = net.tension[first + j]
                if length_penalty > 0.0:
                    if row[SEGMENT_STIFFNESS] > 0.0 and T_linear <= 0.0:
                        row[SEGMENT_STIFFNESS], row[SEGMENT_TENSION], changed = 0.0, 0.0, True
                    elif row[SEGMENT_STIFFNESS] == 0.0 and stretch > 0.0:
                        row[SEGMENT_STIFFNESS], row[SEGMENT_TENSION], changed = (
                            reduced_slope(stage, length_penalty, row[SEGMENT_GEOMETRIC]),
                            length_penalty * row[SEGMENT_STRETCH],
                            True,
                        )
                    continue
                if not has_curve and ((T_linear > 0.0) if stretch > 0.0 else row[SEGMENT_TENSION] == 0.0):
                    continue
                T, slope, _ = tension_law(
                    stage, max(stretch, -L0), row[SEGMENT_STRETCH_BEFORE], spring, damper, two_damper, row[SEGMENT_NUMERICAL_DAMPER]
                )
                if has_curve and lengthening != 0.0:
                    T_linearised, _, _ = tension_law(
                        stage,
                        row[SEGMENT_STRETCH],
                        row[SEGMENT_STRETCH_BEFORE],
                        spring,
                        damper,
                        two_damper,
                        row[SEGMENT_NUMERICAL_DAMPER],
                    )
                    slope = max(slope, (T - T_linearised) / lengthening)
                if abs(T - T_linear) > 1e-2 * (abs(T) + abs(T_linear)) + 64.0 * EPS * k:
                    if slope > 0.0 and length_direction == SEGMENT_DIRECTION:
                        slope_ratio = row[SEGMENT_STIFFNESS] / slope  # the part of the gradient that turns has no slope in it
                        for x in range(3):
                            row[SEGMENT_GRADIENT + x] = n[x] + (row[SEGMENT_GRADIENT + x] - n[x]) * slope_ratio
                    row[SEGMENT_STIFFNESS], row[SEGMENT_TENSION] = (
                        reduced_slope(stage, slope, row[SEGMENT_GEOMETRIC]),
                        T - slope * lengthening,
                    )
                    changed = True
        if not changed:
            break
        for i in range(net.n_interior, net.n_free):
            for x in range(3):
                right_side[i, x] = law_force[i, x]
    unbalanced = 0.0 if all_taut and net.effects.linear_in_node_state == 1 else 1e300
    if stage.law == LAW_AT_END:
        return solves, 1e300
    if net.cable_groups.shape[0] > 0:
        unbalanced = max(unbalanced, 2.0 * as_finish(net.kernels[KERNEL_FINISH_GROUPS])(stage, net_address))
    if net.single_cables.shape[0] > 0:
        unbalanced = max(unbalanced, 2.0 * as_finish(net.kernels[KERNEL_FINISH_SINGLES])(stage, net_address))
    return solves, unbalanced


@kernel(void(int64, float64, _f2))
def correct(net_address, length, q):
    """Add ``length`` times the Newton step to the positions of the moving nodes."""
    net = view_net(net_address)
    for i in range(net.n_free):
        for x in range(3):
            q[i, x] += length * net.newton_step[i, x]


@kernel(void(int64))
def adopt(net_address):
    """Set the tensions of the net to those of the law at the positions of the last `residual`, which balance the forces there."""
    net = view_net(net_address)
    for c in range(net.cable.shape[0]):
        first = net.cable[c, CABLE_FIRST_SEGMENT]
        for s in range(first, first + net.cable[c, CABLE_SEGMENTS]):
            net.tension[s] = (
                max(net.segment[s, SEGMENT_TENSION], 0.0)
                if net.axial[c, AXIAL_TWO_WAY_DAMPER] == 0.0
                else net.segment[s, SEGMENT_TENSION]
            )
    for i in range(net.predicted_force.shape[0]):
        for x in range(3):
            net.predicted_force[i, x] = net.law_force[net.n_interior + i, x]


@kernel(void(int64))
def forget(net_address):
    """Set the predicted tensions to zero, so that those of a failed iteration do not enter the next tangent."""
    net = view_net(net_address)
    clear(net.tension)
    net.linearised[LINEARISED_LAW], net.linearised[LINEARISED_BEGINNING] = -1.0, AFRESH
