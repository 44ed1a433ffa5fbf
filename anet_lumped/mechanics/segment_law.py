"""The tension of a segment in a stage of an implicit method, and its linearisation.

In the current Newton iterate a segment from node i to node j has the vector d, the length l and the rest length L0. At the base of
the stage it has d_a, l_a and L_a, see `integrators.stage`. Its stretches are x = l - L0 and x_a = l_a - L_a; its unit vector is
n = d/l. For displacements dd_i and dd_j of its nodes, the next iterate has the tension

    T = T_0 + k g . (dd_j - dd_i) ,

which acts along e. `linearise` finds T_0, k, g and e, and the geometric stiffness a = T/(l_a + l), or T/l, by which e turns.

Every function here is compiled for one cable, and for a group of four cables whose numbers are `lanes`. The cables of a group have
the same number of segments and the same compression law.
"""

import math
from typing import Any, NamedTuple

from anet_lumped.compiled.jit import inlined
from anet_lumped.compiled.lanes import column, is_below, lane, load, select
from anet_lumped.effects.laws.axial import Spring, tension_between, tension_slopes
from anet_lumped.mechanics.segment_row import LinearisedSegment
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_CURVE,
    CABLE_CURVE_END,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_SEGMENTS,
    CABLE_START,
    CURVE_SHARE,
    LINEARISED_LEAST_DAMPER,
    LINEARISED_NEXT_STEP,
    LINEARISED_SAME_STEP,
)
from integrators.stage import LAW_AT_END, LAW_BACKWARD, LAW_BETWEEN

PENALTY_PER_INERTIA = 1e7  # penalty of a cable that does not stretch, over the inertia W m of its nodes
STRICTNESS = 300.0  # an error of a length that must not change counts as this many times the force that moves its node so far
SHORTEST = 1e-12  # of the rest length: in a division a segment is at least this long
SHORTEST_TURNING = 0.01  # of the rest length: a shorter segment turns in the tangent as one of this length does
LARGEST_PER_LENGTH = 100.0  # the inverse of `SHORTEST_TURNING`
TINY = 1e-300  # least divisor, in place of zero


class TautLaw(NamedTuple):
    """The law of a taut segment of a cable in a stage, and the forces that errors of its length and its tension count for.

    Parameters
    ----------
    numerical_damper : [N/m]
        The numerical damper where no share of it is left out.
    penalty : [N/m]
        Penalty of a cable that does not stretch, else 0.
    undamped_slope, damped_slope : [N/m]
        dT/dl without the numerical damper, and with all of it.
    force_per_length_error : [N/m]
    force_per_tension_error : [1]
        For the tension by the law; at most 1.
    """

    numerical_damper: Any
    penalty: Any
    undamped_slope: Any
    damped_slope: Any
    force_per_length_error: Any
    force_per_tension_error: Any


class CableLaw(NamedTuple):
    """The law of a cable's segments in a stage.

    Parameters
    ----------
    spring : Spring
        Its rest length is that at the end of the stage.
    steepest_slope : [N/m], largest slope dT/dl of the spring
    L0_at_start : [m], rest length at the start of the stage
    damper : [N s/m]
    two_way_damper : 1 where the damper acts on slack segments too, else 0
    inextensible : 1 for a cable that does not stretch, else 0
    taut : TautLaw
    step : LINEARISED_SAME_STEP, LINEARISED_NEXT_STEP or LINEARISED_FIRST_STEP, see `tables`
    least_damper_share : least share of the numerical damper in a step that follows another
    """

    spring: Any
    steepest_slope: Any
    L0_at_start: Any
    damper: Any
    two_way_damper: Any
    inextensible: Any
    taut: Any
    step: Any
    least_damper_share: Any


@inlined
def group_constant(net, c, axial_column):
    """Number of ``Net.axial`` that is the same in all cables of a group."""
    return lane(column(net.axial, c, axial_column), 0)


@inlined
def spring_of(net, c):
    """`Spring` of a cable's segments, with the rest length that ``Net.axial`` holds."""
    first, end, share = lane(column(net.cable, c, CABLE_CURVE), 0), lane(column(net.cable, c, CABLE_CURVE_END), 0), 1.0
    if first < end:  # the first piece of a tension-strain curve is the spring that acts from no strain on
        share, first = net.springs[first, CURVE_SHARE], first + 1
    return Spring(
        share * column(net.axial, c, AXIAL_STIFFNESS), group_constant(net, c, AXIAL_PUSH_SHARE), column(net.axial, c, AXIAL_L0),
        net.springs, first, end
    )  # fmt: skip


@inlined
def moving_mass(net, node):
    """Mass of a node if it moves, else 0 [kg]."""
    return select(is_below(node, net.n_free), load(net.mass, node), 0.0)


@inlined
def largest_moving_mass(net, c):
    """Largest mass of a cable's moving nodes [kg]."""
    ends = max(moving_mass(net, column(net.cable, c, CABLE_START)), moving_mass(net, column(net.cable, c, CABLE_END)))
    if lane(column(net.cable, c, CABLE_SEGMENTS), 0) > 1:
        return max(ends, load(net.mass, column(net.cable, c, CABLE_FIRST_NODE)))
    return ends


@inlined
def penalty(stage, net, c):
    """Penalty p of a cable that does not stretch [N/m]; 0 for a cable that stretches.

    The tension of such a cable is a multiplier. Each Newton step adds p (l - L0) to it, until the length is right (augmented
    Lagrangian). Any p leads to the same tension; a large p needs fewer steps.
    """
    if group_constant(net, c, AXIAL_INEXTENSIBLE) == 0.0:
        return 0.0 * column(net.axial, c, AXIAL_L0)
    if lane(column(net.cable, c, CABLE_SEGMENTS), 0) > 1:
        return PENALTY_PER_INERTIA * stage.W * load(net.mass, column(net.cable, c, CABLE_FIRST_NODE))
    return PENALTY_PER_INERTIA * stage.W * largest_moving_mass(net, c)


@inlined
def numerical_damper(stage, net, c):
    """Largest numerical damper of a cable's segments [N/m]: what alpha k s^2/(1 + s^2) is above the physical one, c/h.

    Here s = omega h/2 with the highest frequency omega of a segment, and alpha = ``dissipation``. The damper acts in full where the
    step h does not resolve omega; where it does, the damper is of third order in the step. With both dampers together k/2 a
    vibration that the step does not resolve is gone after one step; more of them would only slow the stretching.
    """
    square = 0.25 * stage.tau * stage.tau * column(net.axial, c, AXIAL_OMEGA_SQUARED)
    full = stage.dissipation * column(net.axial, c, AXIAL_STIFFNESS) * (square / (1.0 + square))
    return max(full - column(net.axial, c, AXIAL_DAMPER) / stage.tau, 0.0)


@inlined
def tension_error_weight(slope, per_length_error, inertia):
    """Force that an error of a tension of a ``slope`` [N/m] counts for, over that error; see `taut_law`."""
    per_slope = 1.0 / max(slope, TINY)
    return max(per_length_error * per_slope, math.sqrt(inertia * per_slope))


@inlined
def taut_law(stage, net, c):
    """`TautLaw` of a cable, or of a group, in a stage.

    An error dl of a length counts as the larger one of two forces: the inertial force W m dl of the node that it displaces, and the
    force that it leaves to the start of the next step, (k/2 - c/tau - c_num) dl in `LAW_BETWEEN` and c/tau dl in the other laws.

    An error dT of a tension by the law counts as the larger one of two forces. The first is the force of the length error
    dl = dT/slope. The second is sqrt(W m/slope) dT: a force F on a node against inertia does the work F^2/(2 W m), as much as the
    elastic energy dT^2/(2 slope) of the error. Where the length must not change, dl = dT/penalty counts as `STRICTNESS` W m dl.
    """
    k, damper, per_tau = column(net.axial, c, AXIAL_STIFFNESS), column(net.axial, c, AXIAL_DAMPER), 1.0 / stage.tau
    numerical, length_penalty = numerical_damper(stage, net, c), penalty(stage, net, c)
    inertia = stage.W * largest_moving_mass(net, c)
    if stage.law == LAW_BETWEEN:
        undamped_slope = length_penalty + damper * per_tau + 0.5 * k
        damped_slope, next_step_slope = undamped_slope + numerical, abs(0.5 * k - numerical - damper * per_tau)
    else:
        undamped_slope = length_penalty + damper * per_tau + k
        damped_slope, next_step_slope = undamped_slope, damper * per_tau
    per_length_error = max(next_step_slope, inertia)
    if group_constant(net, c, AXIAL_INEXTENSIBLE) > 0.0:
        per_tension_error = STRICTNESS * inertia / length_penalty
    else:
        per_tension_error = tension_error_weight(damped_slope, per_length_error, inertia)
    return TautLaw(numerical, length_penalty, undamped_slope, damped_slope, per_length_error, min(per_tension_error, 1.0))


@inlined
def cable_law(stage, net, c, step):
    """`CableLaw` of a cable, or of a group, in a stage."""
    return CableLaw(
        spring_of(net, c),
        column(net.axial, c, AXIAL_STIFFNESS),
        column(net.axial, c, AXIAL_L0_BEFORE),
        column(net.axial, c, AXIAL_DAMPER),
        group_constant(net, c, AXIAL_TWO_WAY_DAMPER),
        group_constant(net, c, AXIAL_INEXTENSIBLE),
        taut_law(stage, net, c),
        step,
        net.linearised[LINEARISED_LEAST_DAMPER],
    )


@inlined
def tension_law(stage, stretch, stretch_before, spring, damper, two_way_damper, numerical):
    """Tension by the law of the stage [N], its slope dT/dl [N/m], and the part of it that has an energy [N].

    `LAW_BETWEEN` takes the tension over the step, see `axial.tension_between`, with the numerical damper ``numerical`` [N/m]. The
    other laws take the tension at the end of the stage, with the rate of length (x - x_a)/tau. In a cable without a two-way damper
    the rate is that of the taut part of the length, (max(x, 0) - max(x_a, 0))/tau, so that the tension does not jump where a slack
    segment turns taut.
    """
    if stage.law == LAW_BETWEEN:
        return tension_between(stretch_before, stretch, spring, damper / stage.tau, numerical, two_way_damper)
    if two_way_damper > 0.0:
        rate = (stretch - stretch_before) / stage.tau
    else:
        rate = (max(stretch, 0.0) - max(stretch_before, 0.0)) / stage.tau
    T, stretch_slope, rate_slope = tension_slopes(stretch, rate, spring, damper, two_way_damper)
    return T, stretch_slope + rate_slope / stage.tau, 0.0 * T


@inlined
def reduced_slope(stage, slope, geometric):
    """Slope of a tension less its geometric stiffness a [N/m], so that the tangent of `linear.chain` is exact.

    The force of a tension T along e = (d_a + d)/(l_a + l) changes by a (I - e n^T) dd + e dT. The tangent of `linear.chain` is
    a dd + e dT'. Both agree for T' = T - a n . dd, whose slope is the slope of T less a. `newton_step` adds a n . dd to T' again.
    A slack segment has the slope 0 and keeps it. With `LAW_AT_END` the slope is not reduced.
    """
    return select(slope > 0.0, slope - geometric, slope) if stage.law != LAW_AT_END else slope


@inlined
def _swing_share(change, last_change):
    """Share of the numerical damper by the changes dl and dl' of a segment's length in the last two steps.

        (|dl - dl'|/(|dl| + |dl'|))^2

    is 1 where the length swings to and fro from step to step. It is of second order in the step where the step resolves the
    stretching of the cable, though not that of each segment.
    """
    share = abs(change - last_change) / max(abs(change) + abs(last_change), TINY)
    return share * share


@inlined
def numerical_damper_of_step(law, history, stretch_before):
    """Numerical damper of a segment in a step that begins [N/m], and the change of its stretch in the last step [m].

    The damper acts in full on a slack segment that cannot push, which may snap taut in the step; else with the share of
    `_swing_share`, or with the least share if that is larger.
    """
    spring, numerical = law.spring, law.taut.numerical_damper
    change = history.stretch - history.stretch_before
    if law.step == LINEARISED_NEXT_STEP:
        swing_share = max(_swing_share(change, history.last_change), law.least_damper_share)
        spring_acts = (stretch_before > 0.0) | (spring.push_share > 0.0)
        numerical = select(spring_acts, swing_share, 1.0) * numerical
    if spring.first_piece < spring.end_piece:  # the damper is less where a tension-strain curve is less steep
        _, slope, _ = tension_slopes(stretch_before, 0.0, spring, 0.0, law.two_way_damper)
        numerical = numerical * max(slope, spring.stiffness) / law.steepest_slope
    return numerical, change


@inlined
def linearise(stage, law, start, end, base_start, base_end, predicted_tension, history):
    """Tension of a segment by the law, and its linearisation.

    The direction e and the gradient g are

        LAW_BETWEEN    e = (d_a + d)/(l_a + l) ,   g = n ;
        LAW_BACKWARD   e = n ,                     g = n ;
        LAW_AT_END     e = n ,                     g = n - c/(k tau l) (d_a - (n . d_a) n) ,

    the last one because the rate of length n . (d - d_a)/tau, which is n . v there, changes when the segment turns. For this rate
    the stretch x_a at the base is n . d_a - L_a in `LAW_AT_END`; in the other laws it is l_a - L_a.

    A segment is linearised as taut although the law says that it is slack, if it cannot push, was predicted taut, and is short by
    so little that the predicted tension outweighs the force of that length error (`TautLaw.force_per_length_error`). All pieces
    of a tension-strain curve count in that tension: the segment may begin the step on a less steep one.

    Parameters
    ----------
    stage : Stage
    law : CableLaw
    start, end : tuples of 3 [m], current positions of its nodes
    base_start, base_end : tuples of 3 [m], positions of its nodes at the base of the stage
    predicted_tension : [N], tension that its geometric stiffness is taken with
    history : SegmentHistory

    Returns
    -------
    T : [N]
    new : LinearisedSegment
    """
    spring, damper, two_way_damper = law.spring, law.damper, law.two_way_damper
    numerical, last_change = law.taut.numerical_damper, history.last_change
    length_penalty, per_length_error = law.taut.penalty, law.taut.force_per_length_error
    L0 = spring.L0
    dx, dy, dz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    ax, ay, az = base_end[0] - base_start[0], base_end[1] - base_start[1], base_end[2] - base_start[2]
    l = math.sqrt(dx * dx + dy * dy + dz * dz)
    per_l = 1.0 / max(l, SHORTEST * L0)
    stretch, largest_per_length = l - L0, LARGEST_PER_LENGTH / L0
    nx, ny, nz = dx * per_l, dy * per_l, dz * per_l
    ex, ey, ez, gx, gy, gz = nx, ny, nz, nx, ny, nz
    per_length_sum = min(per_l, largest_per_length)
    if stage.law == LAW_AT_END:
        stretch_before = nx * ax + ny * ay + nz * az - law.L0_at_start
    else:
        l_a = math.sqrt(ax * ax + ay * ay + az * az)
        stretch_before = l_a - law.L0_at_start
        if stage.law == LAW_BETWEEN:
            if law.step > LINEARISED_SAME_STEP:
                numerical, last_change = numerical_damper_of_step(law, history, stretch_before)
            else:
                numerical = history.numerical_damper
            per_sum = 1.0 / max(l_a + l, SHORTEST * L0)
            ex, ey, ez = (ax + dx) * per_sum, (ay + dy) * per_sum, (az + dz) * per_sum
            per_length_sum = min(per_sum, largest_per_length)
    if law.inextensible > 0.0:
        T, slope, conservative = predicted_tension + length_penalty * stretch, length_penalty, 0.0 * length_penalty
        if two_way_damper == 0.0:
            slack = predicted_tension + per_length_error * stretch <= 0.0
            T, slope = select(slack, 0.0, T), select(slack, 0.0, slope)
    else:
        T, slope, conservative = tension_law(stage, stretch, stretch_before, spring, damper, two_way_damper, numerical)
    if stage.law == LAW_AT_END:
        turns = (slope > 0.0) & ((stretch_before > 0.0) | (two_way_damper > 0.0))
        turn = select(turns, damper / (slope * stage.tau * max(l, SHORTEST_TURNING * L0)), 0.0)
        along = stretch_before + law.L0_at_start
        gx, gy, gz = nx - turn * (ax - along * nx), ny - turn * (ay - along * ny), nz - turn * (az - along * nz)
    pushes = stage.law == LAW_BACKWARD and two_way_damper > 0.0  # steps to a rest are long: only the exact tangent converges
    geometric = (predicted_tension if pushes else max(predicted_tension, 0.0)) * per_length_sum
    stiffness, linearised_tension = reduced_slope(stage, slope, geometric), T
    if two_way_damper == 0.0:
        if law.inextensible > 0.0:
            T = max(T, 0.0)
        elif stage.law == LAW_BETWEEN:
            hardly_short = predicted_tension + per_length_error * min(stretch, stretch_before) > 0.0
            as_taut = (T == 0.0) & (predicted_tension > 0.0) & hardly_short
            damper_of_step, two_way_spring = damper / stage.tau, Spring(spring.stiffness, 1.0, L0, spring.curve, 0, 0)
            taut_tension, slope, _ = tension_between(stretch_before, stretch, two_way_spring, damper_of_step, numerical, 1.0)
            if spring.first_piece < spring.end_piece:
                curved = Spring(spring.stiffness, 1.0, L0, spring.curve, spring.first_piece, spring.end_piece)
                taut_tension, slope, _ = tension_between(stretch_before, stretch, curved, damper_of_step, numerical, 1.0)
            linearised_tension = select(as_taut, taut_tension, linearised_tension)
            stiffness = select(as_taut, reduced_slope(stage, slope, geometric), stiffness)
    return T, LinearisedSegment(
        ex, ey, ez, gx, gy, gz, geometric, stiffness, linearised_tension,
        stretch_before, stretch, conservative, last_change, numerical,
    )  # fmt: skip
