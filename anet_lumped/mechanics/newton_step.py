"""The Newton step of a stage: solved again until no segment turns slack or taut in it."""

import math

from numba import float64, int64, njit, types, void

from anet_lumped.compiled.lanes import (
    at,
    four,
    index,
    lane,
    largest,
    members_of,
    of_table,
    put,
    select,
)
from anet_lumped.mechanics.cable_rows import row3, segment_count
from anet_lumped.mechanics.linear import chain
from anet_lumped.mechanics.residual import EPS
from anet_lumped.mechanics.segment_law import (
    AFRESH,
    law_of,
    less,
    penalty,
    spring_of,
    switch,
    weights,
)
from anet_lumped.model.net import net_at
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
from integrators.stage import LAW_AT_END, LAW_BETWEEN, STAGE

_f2 = float64[:, ::1]

ROUNDS = 4  # eliminations a Newton step may spend on finding which segments are slack


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _finish_tensions(stage, net):
    """Give the tensions what `less` has left to the end; returns a bound of the force that the step leaves out of balance [N].

    Of second order in the step d of a segment's ends against each other: its force turns by up to |d|/(l_a + l), of which
    the tangent has the part that the guessed tension makes, and its length by up to |d|^2/(2 l), which counts as in `weights`.
    No bound (1e300) where a segment that cannot push was not linearised as taut, or ends short: a tension can be positive
    there, as the secant from a taut length to a short one is, and yet the law is not straight; nor is a tension-strain curve.
    """
    left = 0.0
    for g in range(net.group.shape[0]):
        left = max(left, _finish_tensions_of(stage, net, members_of(net.group, g)))
    for c in net.alone:
        left = max(left, _finish_tensions_of(stage, net, c))
    return 2.0 * left


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _finish_tensions_of(stage, net, c):
    """`_finish_tensions` of a cable, or of a group."""
    first, node, end = (
        of_table(net.cable, c, CABLE_FIRST_SEGMENT),
        of_table(net.cable, c, CABLE_FIRST_NODE),
        of_table(net.cable, c, CABLE_END),
    )
    L0, step, segment, count = of_table(net.axial, c, AXIAL_L0), net.step.ravel(), net.segment.ravel(), segment_count(net, c)
    _, _, soft, taut, _, share = weights(stage, net, c)
    one_way = switch(net, c, AXIAL_PUSH_SHARE) < 1.0 and switch(net, c, AXIAL_INEXTENSIBLE) == 0.0
    curved = lane(of_table(net.cable, c, CABLE_CURVE), 0) < lane(of_table(net.cable, c, CABLE_CURVE_END), 0)
    per_sum, strain = (0.5 if stage.law == LAW_BETWEEN else 1.0) / L0, share * taut / (2.0 * L0)
    most, longest = 0.0 * L0, 0.0 * L0
    x0, y0, z0 = row3(step, of_table(net.cable, c, CABLE_START))
    for j in range(count):
        i = index(node, j, 1, 0) if j < count - 1 else end
        s = index(first, j, 1, 0)
        x1, y1, z1 = row3(step, i)
        gx, gy, gz, a = four(segment, index(s, 0, SEGMENT_COLUMNS, SEGMENT_GRADIENT))
        dx, dy, dz, T = x1 - x0, y1 - y0, z1 - z0, at(net.tension, s)
        x0, y0, z0 = x1, y1, z1
        square = dx * dx + dy * dy + dz * dz
        stiffness, longer = at(segment, index(s, 0, SEGMENT_COLUMNS, SEGMENT_STIFFNESS)), gx * dx + gy * dy + gz * dz
        if one_way:
            stretch, _, _, numerical = four(segment, index(s, 0, SEGMENT_COLUMNS, SEGMENT_STRETCH))
            straight = soft + numerical if stage.law == LAW_BETWEEN else soft
            as_taut = (stretch > 0.0) | (stiffness + a > (1.0 - 1e-9) * straight)
            most = max(most, select(as_taut & (stretch + longer > 0.0), 0.0, 1e300))
        T = select(stiffness != 0.0, T + a * longer, T)
        put(net.tension, s, T)
        turned = abs(T * per_sum - a) * math.sqrt(square) + T * per_sum * per_sum * square
        most, longest = max(most, turned), max(longest, square)
    return 1e300 if curved else largest(max(2.0 * most, strain * longest))


@njit(types.Tuple((int64, float64))(STAGE, int64), cache=True, error_model="numpy", fastmath={"contract"})
def direction(stage, place):
    """Newton step of the stage that `residual` linearised last, for ``net.step`` and ``net.tension``.

    A segment that the step would make slack or taut leaves the piece of its law that was linearised: its law is replaced by
    the tangent at the predicted length and the step is solved again, until no segment changes. Source: DESIGN, numerics 3.

    Returns
    -------
    solves : int64
        Eliminations made.
    left : float64 [N]
        What a whole step leaves out of balance at most; 1e300 if that is not known without looking.
    """
    net = net_at(place)
    right, kept, step = net.right, net.pull, net.step
    for i in range(net.n_interior, net.n_free):
        for x in range(3):
            kept[i, x] = right[i, x]
    length_direction, taut = SEGMENT_GRADIENT if stage.law == LAW_BETWEEN else SEGMENT_DIRECTION, False
    for solves in range(1, ROUNDS + 1):
        smallest = chain.solve(place)
        taut = smallest > 0.0  # all are taut and stay so: a slack segment has no tension
        if taut or solves == ROUNDS:
            break
        changed = False
        for c in range(net.cable.shape[0]):
            first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
            L0, k, damper, two_spring, two_damper = (
                net.axial[c, AXIAL_L0],
                net.axial[c, AXIAL_STIFFNESS],
                net.axial[c, AXIAL_DAMPER],
                net.axial[c, AXIAL_PUSH_SHARE],
                net.axial[c, AXIAL_TWO_WAY_DAMPER],
            )
            spring, curved = spring_of(net, c), net.cable[c, CABLE_CURVE] < net.cable[c, CABLE_CURVE_END]
            if two_spring == 1.0:
                continue
            rigid = penalty(stage, net, c)
            x0, y0, z0 = step[net.cable[c, CABLE_START], 0], step[net.cable[c, CABLE_START], 1], step[net.cable[c, CABLE_START], 2]
            for j in range(count):
                i = node + j if j < count - 1 else net.cable[c, CABLE_END]
                row = net.segment[first + j]
                n = row[length_direction : length_direction + 3]
                x1, y1, z1 = step[i, 0], step[i, 1], step[i, 2]
                longer = n[0] * (x1 - x0) + n[1] * (y1 - y0) + n[2] * (z1 - z0)
                x0, y0, z0 = x1, y1, z1
                stretch = row[SEGMENT_STRETCH] + longer
                T_linear = net.tension[first + j]
                if rigid > 0.0:
                    if row[SEGMENT_STIFFNESS] > 0.0 and T_linear <= 0.0:
                        row[SEGMENT_STIFFNESS], row[SEGMENT_TENSION], changed = 0.0, 0.0, True
                    elif row[SEGMENT_STIFFNESS] == 0.0 and stretch > 0.0:
                        row[SEGMENT_STIFFNESS], row[SEGMENT_TENSION], changed = (
                            less(stage, rigid, row[SEGMENT_GEOMETRIC]),
                            rigid * row[SEGMENT_STRETCH],
                            True,
                        )
                    continue
                if not curved and ((T_linear > 0.0) if stretch > 0.0 else row[SEGMENT_TENSION] == 0.0):
                    continue
                T, slope, _ = law_of(
                    stage, max(stretch, -L0), row[SEGMENT_STRETCH_BEFORE], spring, damper, two_damper, row[SEGMENT_NUMERICAL_DAMPER]
                )
                if curved and longer != 0.0:
                    here, _, _ = law_of(
                        stage,
                        row[SEGMENT_STRETCH],
                        row[SEGMENT_STRETCH_BEFORE],
                        spring,
                        damper,
                        two_damper,
                        row[SEGMENT_NUMERICAL_DAMPER],
                    )
                    slope = max(slope, (T - here) / longer)
                if abs(T - T_linear) > 1e-2 * (abs(T) + abs(T_linear)) + 64.0 * EPS * k:
                    if slope > 0.0 and length_direction == SEGMENT_DIRECTION:
                        turn = row[SEGMENT_STIFFNESS] / slope  # the part of the gradient that turns has no slope in it
                        for x in range(3):
                            row[SEGMENT_GRADIENT + x] = n[x] + (row[SEGMENT_GRADIENT + x] - n[x]) * turn
                    row[SEGMENT_STIFFNESS], row[SEGMENT_TENSION] = less(stage, slope, row[SEGMENT_GEOMETRIC]), T - slope * longer
                    changed = True
        if not changed:
            break
        for i in range(net.n_interior, net.n_free):
            for x in range(3):
                right[i, x] = kept[i, x]
    left = _finish_tensions(stage, net) if stage.law != LAW_AT_END else 1e300
    return solves, left if taut and net.effects.linear == 1 else 1e300


@njit(void(int64, float64, _f2), cache=True, error_model="numpy", fastmath={"contract"})
def correct(place, length, q):
    """q += length times the Newton step, for the moving nodes."""
    net = net_at(place)
    for i in range(net.n_free):
        for x in range(3):
            q[i, x] += length * net.step[i, x]


@njit(void(int64), cache=True, error_model="numpy", fastmath={"contract"})
def adopt(place):
    """Let the tensions of the net be those of the law, where `residual` was last: they balance the forces there."""
    net = net_at(place)
    for c in range(net.cable.shape[0]):
        first = net.cable[c, CABLE_FIRST_SEGMENT]
        for s in range(first, first + net.cable[c, CABLE_SEGMENTS]):
            net.tension[s] = (
                max(net.segment[s, SEGMENT_TENSION], 0.0)
                if net.axial[c, AXIAL_TWO_WAY_DAMPER] == 0.0
                else net.segment[s, SEGMENT_TENSION]
            )
    for i in range(net.kept.shape[0]):
        for x in range(3):
            net.kept[i, x] = net.pull[net.n_interior + i, x]


@njit(void(int64), cache=True, error_model="numpy", fastmath={"contract"})
def forget(place):
    """Drop the predicted tensions, so that what a failed iteration left does not shape the next tangent."""
    net = net_at(place)
    net.tension[:] = 0.0
    net.linearised[LINEARISED_LAW], net.linearised[LINEARISED_BEGINNING] = -1.0, AFRESH
