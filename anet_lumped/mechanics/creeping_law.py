"""The tension of a segment that creeps in a step of `edmc`, and its linearisation.

The fast part of a segment is a segment as in `segment_law`, whose rest length is L0 plus the slow stretch s. For each length at
the end of a step, `creep_of_step` finds the slow stretch at which both parts carry the same tension. So s is no unknown of the
step. The slope of the tension in the length is that of two springs in series,

    dT/dl = S F/(S + F - f) ,

with the slopes S of the slow part in its stretch, F of the fast part in its own, and f by which the fast part gets stiffer.
"""

import math

from anet_lumped.compiled.jit import inlined, internal
from anet_lumped.effects.laws.axial import Spring, secant_tension
from anet_lumped.effects.laws.creep import (
    Creep,
    creep_of_step,
    has_working_curve,
    slow_numerical_damper,
    slow_part,
    stored_energy,
)
from anet_lumped.effects.laws.working_curve import WorkingCurves
from anet_lumped.mechanics.segment_law import (
    CableLaw,
    TautLaw,
    cable_law,
    largest_moving_mass,
    linearise,
    numerical_damper_of_step,
    reduced_slope,
    tension_error_weight,
)
from anet_lumped.mechanics.segment_row import LinearisedSegment
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    CREEP_CURVES_END,
    CREEP_DAMPER,
    CREEP_FAST,
    CREEP_ORIGINAL,
    CREEP_PARALLEL,
    CREEP_PER_TENSION,
    CREEP_PERMANENT,
    CREEP_STATIC,
    CREEP_WORKING,
    CREPT_CHANGE,
    CREPT_STRETCH,
    CREPT_T_MAX,
    LINEARISED_SAME_STEP,
)


@inlined
def creep_of(net, c, s):
    """`Creep` of segment s of cable c."""
    row = net.creep[c]
    rows = int(row[CREEP_ORIGINAL]), int(row[CREEP_WORKING]), int(row[CREEP_CURVES_END])
    shape = row[CREEP_PERMANENT], row[CREEP_PARALLEL], net.crept[s, CREPT_T_MAX]
    curves = WorkingCurves(net.axial[c, AXIAL_L0], net.springs, rows[0], rows[1], rows[2], shape[0], shape[1], shape[2])
    of_springs = row[CREEP_STATIC], row[CREEP_FAST], row[CREEP_PER_TENSION]
    return Creep(of_springs[0], of_springs[1], of_springs[2], row[CREEP_DAMPER], net.axial[c, AXIAL_DAMPER], curves)


@inlined
def with_largest_tension(creep, T_max):
    """`Creep` of a segment that has held another largest tension [N]."""
    old, law = creep.curves, creep
    curves = WorkingCurves(old.L0, old.curve, old.original, old.working, old.end, old.permanent, old.parallel, T_max)
    return Creep(law.static_stiffness, law.fast_stiffness, law.per_tension, law.damper, law.fast_damper, curves)


@inlined
def fast_spring(net, k_d, L0):
    """`Spring` of the fast part of a segment, of the rest length ``L0`` that it has with the slow stretch."""
    return Spring(k_d, 0.0, L0, net.springs, 0, 0)


@inlined
def _in_series(slow, fast):
    return slow * fast / (slow + fast)


@inlined
def creeping_cable_law(stage, net, c, creep, step):
    """`CableLaw` of a cable that creeps: of the fast part, with the slopes of both in series."""
    law = cable_law(stage, net, c, step)
    taut, k, k_d = law.taut, creep.static_stiffness, creep.fast_stiffness
    slow = 0.5 * k * k_d / (k_d - k) + creep.damper / stage.tau + slow_numerical_damper(stage.tau, stage.dissipation, creep)
    undamped, damped = _in_series(slow, taut.undamped_slope), _in_series(slow, taut.damped_slope)
    inertia = stage.W * largest_moving_mass(net, c)
    weight = min(tension_error_weight(damped, taut.force_per_length_error, inertia), 1.0)
    of_both = TautLaw(taut.numerical_damper, 0.0, undamped, damped, taut.force_per_length_error, weight)
    return CableLaw(
        fast_spring(net, k_d, net.axial[c, AXIAL_L0]),
        k_d,
        law.L0_at_start,
        law.damper,
        0.0,
        0.0,
        of_both,
        step,
        law.least_damper_share,
    )


@inlined
def _of_segment(law, k_d, L0, L0_at_start):
    """`CableLaw` of the fast part of a segment, with its stiffness and its rest lengths."""
    spring = Spring(k_d, 0.0, L0, law.spring.curve, 0, 0)
    return CableLaw(spring, law.steepest_slope, L0_at_start, law.damper, 0.0, 0.0, law.taut, law.step, law.least_damper_share)


@internal
def linearise_creeping(stage, of_segment, start, end, base_start, base_end, predicted_tension, history):
    """`linearise` of a segment that creeps, and how much it creeps [m].

    Stretches in the `LinearisedSegment` are those of its fast part.

    ``of_segment`` are the `CableLaw`, the `Creep` and the slow stretch at the start of the step [m].
    """
    law, creep, crept = of_segment
    L0 = law.spring.L0
    dx, dy, dz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    ax, ay, az = base_end[0] - base_start[0], base_end[1] - base_start[1], base_end[2] - base_start[2]
    l, l_a = math.sqrt(dx * dx + dy * dy + dz * dz), math.sqrt(ax * ax + ay * ay + az * az)
    fast_before = l_a - (L0 + crept)
    numerical = history.numerical_damper
    if law.step > LINEARISED_SAME_STEP:
        numerical, _ = numerical_damper_of_step(law, history, fast_before - slow_part(crept, creep).offset)
    found = creep_of_step(fast_before, l - l_a, crept, stage.tau, stage.dissipation, numerical, law.spring.curve, creep)
    fast_law = _of_segment(law, found.fast_stiffness, L0 + (crept + found.change) + found.offset, L0 + crept + found.offset)
    T, new = linearise(stage, fast_law, start, end, base_start, base_end, predicted_tension, history)
    stiffness, tension = new.stiffness, new.tension
    if stiffness != 0.0:
        fast = stiffness + new.geometric
        share = found.slope / (found.slope + fast - found.softening)
        stiffness = reduced_slope(stage, fast * share, new.geometric)
        tension = T + share * (tension - T)  # where a slack segment is linearised as taut
    return T, LinearisedSegment(
        new.ex, new.ey, new.ez, new.gx, new.gy, new.gz, new.geometric, stiffness, tension,
        new.stretch_before + found.offset, new.stretch + found.offset, new.conservative, new.last_change, new.numerical_damper,
    ), found.change  # fmt: skip


@internal
def creep_in_step(stage, net, of_segment, fast_before, l, numerical):
    """Let a segment creep through a step that has been solved, and account for its slow part.

    Parameters
    ----------
    of_segment : Creep, number of the segment, rest length [m]
    fast_before : float64 [m], stretch of the fast part at the start of the step
    l : float64 [m], length at its end
    numerical : float64 [N/m], numerical damper of the fast part

    Returns
    -------
    spring : Spring, of the fast part, with its rest length at the end
    offset : float64 [m], stretch of the fast part without tension
    change : float64 [m], of the slow stretch
    taken : (by damper, by method) [J], by the slow part

    A fast spring that gets stiffer with the tension stores more than the work of the fast part says, and the slow spring, of which
    the tension in the middle is taken, less or more; the damper is booked what is left, so that the account closes, and the method
    where that is less than nothing. So it is for what a working curve loses as the largest tension grows.
    """
    creep, s, L0 = of_segment
    crept, h = net.crept[s, CREPT_STRETCH], stage.tau
    lengthening = l - (L0 + crept + fast_before)
    found = creep_of_step(fast_before, lengthening, crept, h, stage.dissipation, numerical, net.springs, creep)
    change, after = found.change, crept + found.change
    net.crept[s, CREPT_STRETCH], net.crept[s, CREPT_CHANGE] = after, change
    spring = fast_spring(net, found.fast_stiffness, L0 + after)
    by_damper = creep.damper / h * change * change
    if creep.per_tension > 0.0 or has_working_curve(creep):
        P, fast_after, creep_after = slow_part(crept + 0.5 * change, creep).tension, l - spring.L0, creep
        if has_working_curve(creep):
            net.crept[s, CREPT_T_MAX] = max(creep.curves.T_max, slow_part(after, creep).tension)
            creep_after = with_largest_tension(creep, net.crept[s, CREPT_T_MAX])
        secant, _ = secant_tension(fast_before - found.offset, fast_after - found.offset, found.fast_stiffness, 0.0)
        work = P * change + secant * (fast_after - fast_before)
        by_damper += work - stored_energy(fast_after, after, creep_after) + stored_energy(fast_before, crept, creep)
    by_method = slow_numerical_damper(h, stage.dissipation, creep) * change * change + min(by_damper, 0.0)
    return spring, found.offset, change, (max(by_damper, 0.0), by_method)
