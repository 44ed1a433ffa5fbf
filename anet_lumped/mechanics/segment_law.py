"""The tension of a segment in a stage: by which law, how it is linearised, and what an error of its length counts for.

All of it is written for one cable or for four that are alike, see `lanes`; the switches of `Net.axial` are the same in those.
"""

import math

from anet_lumped.compiled.jit import inlined
from anet_lumped.compiled.lanes import column, is_below, lane, load, select
from anet_lumped.effects.laws.axial import tension_between, tension_slopes
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_OMEGA_SQUARED,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    CABLE_CURVE,
    CABLE_CURVE_END,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_SEGMENTS,
    CABLE_START,
)
from integrators.stage import LAW_AT_END, LAW_BETWEEN

STRICT = 300.0  # times its inertia is what a length that must not change counts for
PENALTY = 1e7  # of a length that must not change, over the inertia of a node
BEGINS, AFRESH = 1.0, 2.0  # of `linearise`: the stage begins a step, and does so without one before it


@inlined
def group_constant(net, c, axial_column):
    """Number of `Net.axial` that is the same in all cables of a group."""
    return lane(column(net.axial, c, axial_column), 0)


@inlined
def spring_of(net, c):
    """What the laws in `effects.axial` take as ``spring``."""
    first, last, share = lane(column(net.cable, c, CABLE_CURVE), 0), lane(column(net.cable, c, CABLE_CURVE_END), 0), 1.0
    if first < last:
        share, first = net.springs[first, 1], first + 1
    return (
        share * column(net.axial, c, AXIAL_STIFFNESS), group_constant(net, c, AXIAL_PUSH_SHARE), column(net.axial, c, AXIAL_L0),
        net.springs, first, last
    )  # fmt: skip


@inlined
def moving_mass(net, node):
    """Mass of a node if it moves [kg]."""
    return select(is_below(node, net.n_free), load(net.mass, node), 0.0)


@inlined
def _largest_moving_mass(net, c):
    """Largest mass that moves of a cable's nodes [kg]."""
    ends = max(moving_mass(net, column(net.cable, c, CABLE_START)), moving_mass(net, column(net.cable, c, CABLE_END)))
    if lane(column(net.cable, c, CABLE_SEGMENTS), 0) > 1:
        return max(ends, load(net.mass, column(net.cable, c, CABLE_FIRST_NODE)))
    return ends


@inlined
def penalty(stage, net, c):
    """Penalty of a cable that does not stretch [N/m], 0 for one that does.

    Its tension is a multiplier: each Newton step adds the penalty times the length that is too much, whatever the penalty,
    until none is left (augmented Lagrangian); a large one leaves next to nothing after the first.
    """
    if group_constant(net, c, AXIAL_INEXTENSIBLE) == 0.0:
        return 0.0 * column(net.axial, c, AXIAL_L0)
    if lane(column(net.cable, c, CABLE_SEGMENTS), 0) > 1:
        return PENALTY * stage.W * load(net.mass, column(net.cable, c, CABLE_FIRST_NODE))
    return PENALTY * stage.W * _largest_moving_mass(net, c)


@inlined
def numerical_damper(stage, net, c):
    """Most that the numerical damper of a cable's segments may be [N/m]: alpha k s^2/(1 + s^2), s = omega h/2.

    In full where the step does not resolve the highest frequency omega of a segment; of third order in the step where it does.
    """
    square = 0.25 * stage.tau * stage.tau * column(net.axial, c, AXIAL_OMEGA_SQUARED)
    return stage.dissipation * column(net.axial, c, AXIAL_STIFFNESS) * (square / (1.0 + square))


@inlined
def _unsteady(change, last):
    """Square of |dl - dl'|/(|dl| + |dl'|) for the changes dl and dl' of a segment's length in the last two steps.

    The share of the numerical damper that is needed: 1 where the length swings to and fro from step to step, of second order in
    the step where that resolves the stretching, though not that of each segment.
    """
    share = abs(change - last) / max(abs(change) + abs(last), 1e-300)
    return share * share


@inlined
def weights(stage, net, c):
    """What lengths of cable c count for in a stage.

    Returns
    -------
    numerical, rigid : numerical damper in full, and penalty if it does not stretch [N/m]
    soft, taut : slope of the tension in the length when taut, without the numerical damper and with all of it [N/m]
    light : what a length that is off weighs by inertia, or by what it leaves to the next step [N/m]
    share : of the error of a tension by the law that counts: a length that is off costs k/2 of its square; where the length is
        not allowed to be off it must be small by itself
    """
    k, damper, per_tau = column(net.axial, c, AXIAL_STIFFNESS), column(net.axial, c, AXIAL_DAMPER), 1.0 / stage.tau
    numerical, rigid = numerical_damper(stage, net, c), penalty(stage, net, c)
    inertia = stage.W * _largest_moving_mass(net, c)
    if stage.law == LAW_BETWEEN:
        soft = rigid + damper * per_tau + 0.5 * k
        taut, old = soft + numerical, abs(0.5 * k - numerical - damper * per_tau)
    else:
        soft = rigid + damper * per_tau + k
        taut, old = soft, damper * per_tau
    light = max(old, inertia)
    if group_constant(net, c, AXIAL_INEXTENSIBLE) > 0.0:
        share = STRICT * inertia / rigid
    else:
        per_taut = 1.0 / max(taut, 1e-300)
        share = max(light * per_taut, math.sqrt(inertia * per_taut))
    return numerical, rigid, soft, taut, light, min(share, 1.0)


@inlined
def tension_law(stage, stretch, before, spring, c, two_damper, numerical):
    """Tension, its slope in the length, and its conservative part, for the law that the stage asks for.

    ``before`` is the stretch that belongs to the start of the stage. Where a segment cannot push, the damper acts on the
    change of the taut part of the length, so that the tension is continuous in the length when a slack segment turns taut.
    ``numerical`` is the damper that the scheme adds [N/m], see `numerical_damper`.
    """
    if stage.law == LAW_BETWEEN:
        return tension_between(before, stretch, spring, c / stage.tau, numerical, two_damper)
    if two_damper > 0.0:
        rate = (stretch - before) / stage.tau
    else:
        rate = (max(stretch, 0.0) - max(before, 0.0)) / stage.tau
    T, of_stretch, of_rate = tension_slopes(stretch, rate, spring, c, two_damper)
    return T, of_stretch + of_rate / stage.tau, 0.0 * T


@inlined
def reduced_slope(stage, slope, a):
    """Slope of a tension less the geometric stiffness.

    A tension T that acts along e = (d_a + d)/(l_a + l) changes its force by a (I - e n^T) dd + e dT, and `chain` has a dd + e dT':
    with T' = T - a n . dd the tangent is exact. `newton_step._finish_tensions` gives T. A slack segment, of slope 0, keeps that.
    """
    return select(slope > 0.0, slope - a, slope) if stage.law != LAW_AT_END else slope


@inlined
def linearise(stage, q0, q1, a0, a1, law, guess, old):
    """Linearised tension of a segment.

    A segment that cannot push, is short by a length that inertia (``light`` [N/m]) hardly feels and was predicted taut is
    linearised as taut.

    Parameters
    ----------
    stage : Stage
    q0, q1, a0, a1 : tuples of 3 [m], its ends now and those of the base
    law : tuple
        ``spring`` of `spring_of`, the steepest slope, L0 at the start of the stage, damper; switches two_damper and inextensible;
        numerical, rigid and light of `weights`; beginning, or 0 for a stage that begins no step; the least share of the numerical
        damper
    guess : the tension that its geometric stiffness takes [N]
    old : tuple, columns BEFORE, STRETCH, LAST and NUMERICAL of ``Net.segment``

    Returns
    -------
    T : the tension [N]
    row : tuple of 14, the columns of ``Net.segment``
    """
    spring, steepest, L_a, damper, two_damper, inextensible, numerical, rigid, light, beginning, least = law
    L0, last = spring[2], old[2]
    dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
    ax, ay, az = a1[0] - a0[0], a1[1] - a0[1], a1[2] - a0[2]
    l = math.sqrt(dx * dx + dy * dy + dz * dz)
    per_l = 1.0 / max(l, 1e-12 * L0)
    stretch, largest_per = l - L0, 100.0 / L0
    nx, ny, nz = dx * per_l, dy * per_l, dz * per_l
    ex, ey, ez, gx, gy, gz = nx, ny, nz, nx, ny, nz
    per_sum = min(per_l, largest_per)
    if stage.law == LAW_AT_END:
        before = nx * ax + ny * ay + nz * az - L_a
    else:
        l_a = math.sqrt(ax * ax + ay * ay + az * az)
        before = l_a - L_a
        if stage.law == LAW_BETWEEN:
            if beginning > 0.0:
                change = old[1] - old[0]
                if beginning == BEGINS:  # a slack segment may snap taut
                    share = select((before > 0.0) | (spring[1] > 0.0), max(_unsteady(change, last), least), 1.0)
                    numerical = share * numerical
                if spring[4] < spring[5]:  # where a curve is not as steep as anywhere, nor is its damper
                    _, slope, _ = tension_slopes(before, 0.0, spring, 0.0, two_damper)
                    numerical = numerical * max(slope, spring[0]) / steepest
                last = change
            else:
                numerical = old[3]
            per = 1.0 / max(l_a + l, 1e-12 * L0)
            ex, ey, ez = (ax + dx) * per, (ay + dy) * per, (az + dz) * per
            per_sum = min(per, largest_per)
    if inextensible > 0.0:
        T, slope, secant = guess + rigid * stretch, rigid, 0.0 * rigid
        if two_damper == 0.0:
            slack = guess + light * stretch <= 0.0
            T, slope = select(slack, 0.0, T), select(slack, 0.0, slope)
    else:
        T, slope, secant = tension_law(stage, stretch, before, spring, damper, two_damper, numerical)
    if stage.law == LAW_AT_END:
        # dT = slope n.dd - (c/tau)(I - n n^T) d_hat . dd / l: the damper sees the segment turn
        turns = (slope > 0.0) & ((before > 0.0) | (two_damper > 0.0))
        turn = select(turns, damper / (slope * stage.tau * max(l, 0.01 * L0)), 0.0)
        along = before + L_a
        gx, gy, gz = nx - turn * (ax - along * nx), ny - turn * (ay - along * ny), nz - turn * (az - along * nz)
    a = max(guess, 0.0) * per_sum
    stiffness, of_row = reduced_slope(stage, slope, a), T
    if two_damper == 0.0:
        if inextensible > 0.0:
            T = max(T, 0.0)
        elif stage.law == LAW_BETWEEN:
            again = (T == 0.0) & (guess > 0.0) & (guess + light * min(stretch, before) > 0.0)
            linear = spring[0], 1.0, L0, spring[3], 0, 0
            of_taut, slope, _ = tension_between(before, stretch, linear, damper / stage.tau, numerical, 1.0)
            of_row, stiffness = select(again, of_taut, of_row), select(again, reduced_slope(stage, slope, a), stiffness)
    return T, (ex, ey, ez, gx, gy, gz, a, stiffness, of_row, before, stretch, secant, last, numerical)
