"""The Newton step of a stage, solved again until it turns no segment slack or taut."""

import math

from numba import float64, int64, types, void

from anet_lumped.compiled.jit import inlined, kernel, on_demand
from anet_lumped.compiled.lanes import column, group_members, lane, load, load_four, max_of_lanes, select, shifted, store
from anet_lumped.mechanics.cable_rows import row3, segment_count
from anet_lumped.mechanics.effect_forces import clear
from anet_lumped.mechanics.linear import solve
from anet_lumped.mechanics.optional import as_finish, as_finish_bodies, as_relinearise_creep
from anet_lumped.mechanics.residual import EPS
from anet_lumped.mechanics.segment_law import (
    group_constant,
    penalty,
    reduced_slope,
    spring_of,
    taut_law,
    tension_law,
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
    KERNEL_FINISH_BODIES,
    KERNEL_FINISH_GROUPS,
    KERNEL_FINISH_SINGLES,
    KERNEL_RELINEARISE_CREEP,
    LINEARISED_BEGINNING,
    LINEARISED_CURRENT,
    LINEARISED_FIRST_STEP,
    LINEARISED_LAW,
    LINEARISED_NO_LAW,
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
from integrators.newton import UNKNOWN_FORCE
from integrators.stage import LAW_AT_END, LAW_BETWEEN, STAGE

_f2 = float64[:, ::1]

ROUNDS = 4  # eliminations that a Newton step may spend on finding which segments are slack
MANY_POINTS, ROUNDS_OF_MANY = 16, 2  # of a net of more free points, where an elimination costs far more than a residual:
# a third and a fourth save few of its Newton steps, and take a sixth to two fifths more eliminations in all
NEARLY_EQUAL = 1e-2  # of two tensions: a smaller difference does not ask for another elimination


@inlined
def _cable_finish(stage, net, c):
    """Add to each tension of a cable, or of a group, the part a n . d that `reduced_slope` took out of its slope.

    Here d is the step of a segment's end relative to its start.

    Returns
    -------
    bound : float64 [N]
        Bound on the force that a whole Newton step leaves out of balance; `UNKNOWN_FORCE` if no bound is known.

    The force left has two parts, both of second order in d. The segment turns by up to |d|/(l_a + l), of which the tangent contains
    the part that the predicted tension makes:

        |T/(l_a + l) - a| |d| + T |d|^2/(l_a + l)^2 .

    Its length changes by up to |d|^2/(2 l) more than its linearisation says, an error of the tension that counts as

        force_per_tension_error dT/dl |d|^2/(2 l) ,    see `TautLaw`.

    No bound is known where the law is not a straight line over the step: for a tension-strain curve; and for a segment that cannot
    push, if it was not linearised as taut or becomes shorter than its rest length. A positive tension does not show that it stays
    longer: the secant from a taut length to a short one is positive too. With `LAW_BETWEEN` it must be longer at the base as well:
    the secant from a short length x_a to a taut one x is k/2 x^2/(x - x_a), whose tangent is wrong by any share of it for small x.
    """
    first, node = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE)
    end = column(net.cable, c, CABLE_END)
    L0, step, segment, count = column(net.axial, c, AXIAL_L0), flat(net.newton_step), flat(net.segment), segment_count(net, c)
    taut = taut_law(stage, net, c)
    one_way = group_constant(net, c, AXIAL_PUSH_SHARE) < 1.0 and group_constant(net, c, AXIAL_INEXTENSIBLE) == 0.0
    has_curve = lane(column(net.cable, c, CABLE_CURVE), 0) < lane(column(net.cable, c, CABLE_CURVE_END), 0)
    per_length = (0.5 if stage.law == LAW_BETWEEN else 1.0) / L0
    second_order = taut.force_per_tension_error * taut.damped_slope / (2.0 * L0)
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
            before, stretch, _, _ = load_four(segment, shifted(s, 0, SEGMENT_COLUMNS, SEGMENT_STRETCH_BEFORE))
            numerical = load(segment, shifted(s, 0, SEGMENT_COLUMNS, SEGMENT_NUMERICAL_DAMPER))
            taut_slope = taut.undamped_slope + numerical if stage.law == LAW_BETWEEN else taut.undamped_slope
            linearised_as_taut = (stretch > 0.0) | (stiffness + a > (1.0 - 1e-9) * taut_slope)
            stays_taut = linearised_as_taut & (stretch + lengthening > 0.0)
            if stage.law == LAW_BETWEEN:
                stays_taut = stays_taut & (before > 0.0)
            largest_force = max(largest_force, select(stays_taut, 0.0, UNKNOWN_FORCE))
        T = select(stiffness != 0.0, T + a * lengthening, T)
        store(net.tension, s, T)
        turned_force = abs(T * per_length - a) * math.sqrt(step_square) + T * per_length * per_length * step_square
        largest_force, largest_square = max(largest_force, turned_force), max(largest_square, step_square)
    return UNKNOWN_FORCE if has_curve else max_of_lanes(max(2.0 * largest_force, second_order * largest_square))


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


@inlined
def _relinearise_rigid(stage, row, length_penalty, T_linear, stretch):
    """Make a segment that does not stretch slack or taut, if the step predicts that it changes; return whether it does.

    A taut segment turns slack at a tension of zero; a slack one turns taut at its rest length.
    """
    if row[SEGMENT_STIFFNESS] > 0.0 and T_linear <= 0.0:
        row[SEGMENT_STIFFNESS], row[SEGMENT_TENSION] = 0.0, 0.0
        return True
    if row[SEGMENT_STIFFNESS] == 0.0 and stretch > 0.0:
        row[SEGMENT_STIFFNESS] = reduced_slope(stage, length_penalty, row[SEGMENT_GEOMETRIC])
        row[SEGMENT_TENSION] = length_penalty * row[SEGMENT_STRETCH]
        return True
    return False


@inlined
def _relinearise_cable(stage, net, c, length_direction):
    """Linearise anew each segment of a cable that the step takes to another piece of its law; return whether there is one.

    With the predicted stretch x' = x + dx of a segment, its law becomes the tangent there, T(x') + T'(x') (dx'' - dx) for a
    lengthening dx''. On a tension-strain curve the slope is at least that of the secant between x and x'.

    ``length_direction`` is the first of the three columns of ``Net.segment`` that hold the gradient of the length.
    """
    first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
    L0, k, damper = net.axial[c, AXIAL_L0], net.axial[c, AXIAL_STIFFNESS], net.axial[c, AXIAL_DAMPER]
    two_way_damper, spring = net.axial[c, AXIAL_TWO_WAY_DAMPER], spring_of(net, c)
    has_curve, length_penalty = net.cable[c, CABLE_CURVE] < net.cable[c, CABLE_CURVE_END], penalty(stage, net, c)
    step, start, changed = net.newton_step, net.cable[c, CABLE_START], False
    x0, y0, z0 = step[start, 0], step[start, 1], step[start, 2]
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
            changed = _relinearise_rigid(stage, row, length_penalty, T_linear, stretch) or changed
            continue
        if not has_curve and ((T_linear > 0.0) if stretch > 0.0 else row[SEGMENT_TENSION] == 0.0):
            continue  # taut and stays taut, or slack and stays slack
        stretch_before, numerical = row[SEGMENT_STRETCH_BEFORE], row[SEGMENT_NUMERICAL_DAMPER]
        T, slope, _ = tension_law(stage, max(stretch, -L0), stretch_before, spring, damper, two_way_damper, numerical)
        if has_curve and lengthening != 0.0:
            T_now, _, _ = tension_law(stage, row[SEGMENT_STRETCH], stretch_before, spring, damper, two_way_damper, numerical)
            slope = max(slope, (T - T_now) / lengthening)
        if abs(T - T_linear) > NEARLY_EQUAL * (abs(T) + abs(T_linear)) + 64.0 * EPS * k:
            if slope > 0.0 and length_direction == SEGMENT_DIRECTION:
                slope_ratio = row[SEGMENT_STIFFNESS] / slope  # g = n - c/(k tau l) (...): its second part goes as 1/k
                for x in range(3):
                    row[SEGMENT_GRADIENT + x] = n[x] + (row[SEGMENT_GRADIENT + x] - n[x]) * slope_ratio
            row[SEGMENT_STIFFNESS] = reduced_slope(stage, slope, row[SEGMENT_GEOMETRIC])
            row[SEGMENT_TENSION] = T - slope * lengthening
            changed = True
    return changed


@kernel(types.Tuple((int64, float64))(STAGE, int64))
def direction(stage, net_address):
    """Newton step of the stage that `residual` linearised last, for ``net.newton_step`` and ``net.tension``.

    A segment that the step would turn slack or taut leaves the piece of its law that was linearised. Then its law is replaced by
    the tangent at the predicted length, and the step is solved again, until no segment changes.
    See ARCHITECTURE.md, *Slack and taut*.

    Returns
    -------
    solves : int64
        Eliminations made.
    unbalanced : float64 [N]
        Bound on the force that a whole step leaves out of balance; `UNKNOWN_FORCE` if only `residual` can tell.
    """
    net = view_net(net_address)
    net.linearised[LINEARISED_CURRENT] = 0.0
    right_side, law_force = net.right_side, net.law_force
    for i in range(net.n_interior, net.n_free):
        for x in range(3):
            law_force[i, x] = right_side[i, x]  # the elimination overwrites it
    length_direction, all_taut = SEGMENT_GRADIENT if stage.law == LAW_BETWEEN else SEGMENT_DIRECTION, False
    rounds = ROUNDS_OF_MANY if net.n_free - net.n_interior > MANY_POINTS else ROUNDS
    for solves in range(1, rounds + 1):
        smallest = solve.solve(net_address)
        all_taut = smallest > 0.0  # all are taut and stay taut: a slack segment has no tension
        if all_taut or solves == rounds:
            break
        changed = False
        for c in range(net.cable.shape[0]):
            if net.axial[c, AXIAL_PUSH_SHARE] != 1.0:
                changed = _relinearise_cable(stage, net, c, length_direction) or changed
        if net.kernels[KERNEL_RELINEARISE_CREEP] != 0:
            changed = as_relinearise_creep(net.kernels[KERNEL_RELINEARISE_CREEP])(stage, net_address) == 1 or changed
        if not changed:
            break
        for i in range(net.n_interior, net.n_free):
            for x in range(3):
                right_side[i, x] = law_force[i, x]
    bounded = all_taut and net.effects.linear_in_node_state == 1 and net.creep.shape[0] == 0
    unbalanced = 0.0 if bounded else UNKNOWN_FORCE
    if stage.law == LAW_AT_END:
        return solves, UNKNOWN_FORCE
    if net.cable_groups.shape[0] > 0:
        unbalanced = max(unbalanced, 2.0 * as_finish(net.kernels[KERNEL_FINISH_GROUPS])(stage, net_address))
    if net.single_cables.shape[0] > 0:
        unbalanced = max(unbalanced, 2.0 * as_finish(net.kernels[KERNEL_FINISH_SINGLES])(stage, net_address))
    if net.bodies.first < net.n_free:
        unbalanced = max(unbalanced, 2.0 * as_finish_bodies(net.kernels[KERNEL_FINISH_BODIES])(net_address))
    return solves, unbalanced


@kernel(void(int64, float64, _f2))
def correct(net_address, length, q):
    """Add ``length`` times the Newton step to the positions q of the moving nodes."""
    net, Q = view_net(net_address), flat(q)
    step = flat(net.newton_step)
    for i in range(3 * net.n_free):
        Q[i] += length * step[i]


@kernel(void(int64))
def adopt(net_address):
    """Take the tensions by the law at the positions of the last `residual` for the tensions of the net.

    They are used instead of the predicted ones where forces balance with them.
    """
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
    """Set the predicted tensions to zero, so that the tensions of a failed iteration do not enter the next tangent."""
    net = view_net(net_address)
    clear(net.tension)
    net.linearised[LINEARISED_LAW], net.linearised[LINEARISED_BEGINNING] = LINEARISED_NO_LAW, LINEARISED_FIRST_STEP
