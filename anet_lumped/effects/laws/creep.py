"""Creep of a segment: a slow spring and damper in series with the fast ones of `axial`.

The slow part has the stretch s, the fast part the rest y = l - L0 - s of the stretch of the segment. Both carry the same tension,

    T = P(s) + c_s ds/dt = k_d y + c dy/dt ,

of which the fast part makes the law of `axial` for a cable that cannot push. The slow spring P is such that a tension that is held
stretches the segment by T/k, with the static stiffness k, in the end:

    P/k = s + P/k_d ,    k_d = fast_stiffness + per_tension P .

Then P = k_1 s with k_1 = k k_d/(k_d - k), and k_d is the larger root of

    k_d^2 - (fast_stiffness + k + per_tension k s) k_d + fast_stiffness k = 0 .

Over a step from a to b, P is taken at the mean of s_a and s_b, which for a linear spring is the secant of its energy, and the
damper at the mean rate. A slow numerical damper share k_1 (s_b - s_a) is added, with

    share = dissipation x^2/(1 + x^2) ,   x = h (k_1 + k_d)/(2 (c_s + c)) ,

which acts in full where the step does not resolve the creep, and is of third order where it does. The tension does the work

    T (l_b - l_a) = T (s_b - s_a) + T (y_b - y_a) ,

of which each part is a change of stored energy and what a damper takes.

Of a polyester rope P is the tension of its `working_curve` instead, which depends on the largest tension held so far, T_max. Its
fast part is straight about P: with the stretch y(P) of the fast spring under a tension that is held,

    T = P + k_d (y - y(P)) + c dy/dt = k_d (y - offset) + c dy/dt ,    offset = y(P) - P/k_d .

What it stores is the work that the working curve gives back from P, less P^2/(2 k_d), and k_d/2 (y - offset)^2 while it is taut. As
T_max grows, the rest of the work of P is lost. Dampers are booked for it.

Source: Hall, Duong & Lozon, IOWTC2023-119374, eqs. 2, 10 and 14, and MoorDyn's Line.cpp (`ElasticMod` 2 and 3); of
polyester see `working_curve`.
"""

import math
from typing import Any, NamedTuple

from anet_lumped.compiled.jit import inlined_law, law

from .axial import Spring, spring_energy, tension_between
from .working_curve import NO_CURVES, held_fast_stretch, tension_at_slow_stretch, working_energy

MOST_TRIALS = 100  # of the search for the slow stretch; each at least halves an interval that may be halved so often
PRECISION = 4e-16  # of the stretches: a correction that is smaller ends the search
SERIES_BELOW, TERMS = 0.05, 14  # the last of so many terms is below rounding there


class Creep(NamedTuple):
    """The slow part of a segment, and what its fast part has of it.

    Parameters
    ----------
    static_stiffness : k [N/m], of spring and fast spring together
    fast_stiffness : [N/m], of the fast spring without tension
    per_tension : [1/m], by which that grows with the tension of the slow spring
    damper : c_s [N s/m]
    fast_damper : c [N s/m]
    curves : `working_curve.WorkingCurves`, empty but for polyester, whose static stiffness is one that its numbers scale with
    """

    static_stiffness: Any
    fast_stiffness: Any
    per_tension: Any
    damper: Any
    fast_damper: Any
    curves: Any = NO_CURVES


class SlowPart(NamedTuple):
    """The slow part at a slow stretch, and the fast part that goes with it.

    Parameters
    ----------
    tension : P [N]
    slope : dP/ds [N/m]
    fast_stiffness : k_d [N/m]
    offset : [m], stretch of the fast part without tension
    """

    tension: Any
    slope: Any
    fast_stiffness: Any
    offset: Any


class CreepStep(NamedTuple):
    """How far a segment creeps in a step.

    Parameters
    ----------
    change : s_b - s_a [m]
    fast_stiffness : k_d [N/m], in the middle of the step
    offset : [m], stretch of the fast part without tension, likewise
    slope : [N/m], of the tension of the slow part in ``change``
    softening : [N/m], by how much less the tension of the fast part falls with ``change``, as the fast spring gets stiffer
    """

    change: Any
    fast_stiffness: Any
    offset: Any
    slope: Any
    softening: Any


@inlined_law
def fast_stiffness(crept, creep):
    """k_d [N/m] at a slow stretch s [m]."""
    k, k_0 = creep.static_stiffness, creep.fast_stiffness
    if creep.per_tension == 0.0 or crept <= 0.0:
        return k_0
    sum_of_roots = k_0 + k + creep.per_tension * k * crept
    return 0.5 * (sum_of_roots + math.sqrt(sum_of_roots * sum_of_roots - 4.0 * k_0 * k))


@inlined_law
def slow_tension(crept, creep):
    """P [N] and its slope [N/m] at a slow stretch s [m]."""
    k, k_d = creep.static_stiffness, fast_stiffness(crept, creep)
    return k * k_d / (k_d - k) * crept, k * k_d * k_d / (k_d * k_d - creep.fast_stiffness * k)


@inlined_law
def has_working_curve(creep):
    """Whether a segment is of a polyester rope with working curves."""
    return creep.curves.end > creep.curves.original


@inlined_law
def slow_part(crept, creep):
    """`SlowPart` at a slow stretch s [m]."""
    if has_working_curve(creep):
        P, slope = tension_at_slow_stretch(crept, creep.curves, creep.fast_stiffness, creep.per_tension)
        k_d = creep.fast_stiffness + creep.per_tension * P
        return SlowPart(P, slope, k_d, held_fast_stretch(P, creep.fast_stiffness, creep.per_tension) - P / k_d)
    P, slope = slow_tension(crept, creep)
    return SlowPart(P, slope, fast_stiffness(crept, creep), 0.0)


@inlined_law
def slow_energy(crept, creep):
    """Energy of the slow spring [J] at a slow stretch s [m]: the integral of P, P^2 (1/(2 k) - S/fast_stiffness),

    with S = (ln(1 + u) - u/(1 + u))/u^2 and u = per_tension P/fast_stiffness; S is 1/2 for u = 0.
    """
    P, _ = slow_tension(crept, creep)
    u = creep.per_tension * max(P, 0.0) / creep.fast_stiffness
    if u < SERIES_BELOW:
        S, power = 0.0, 1.0
        for n in range(1, TERMS):
            S, power = S + power * n / (n + 1.0), -power * u
    else:
        S = (math.log(1.0 + u) - u / (1.0 + u)) / (u * u)
    return P * P * (0.5 / creep.static_stiffness - S / creep.fast_stiffness)


@inlined_law
def stored_energy(fast_stretch, crept, creep):
    """Energy of both springs [J], at their stretches y and s [m]."""
    part = slow_part(crept, creep)
    of_fast = spring_energy(fast_stretch - part.offset, part.fast_stiffness, 0.0)
    if has_working_curve(creep):
        return working_energy(part.tension, creep.curves) - 0.5 * part.tension * part.tension / part.fast_stiffness + of_fast
    return slow_energy(crept, creep) + of_fast


@inlined_law
def slow_numerical_damper(h, dissipation, creep):
    """Numerical damper of the slow part [N/m] in a step of h [s]."""
    k, k_d = creep.static_stiffness, creep.fast_stiffness
    k_1 = k * k_d / (k_d - k)
    x = 0.5 * h * (k_1 + k_d) / (creep.damper + creep.fast_damper)
    return dissipation * k_1 * (x * x / (1.0 + x * x))


@inlined_law
def tension_at_once(fast_stretch, crept, rate, creep):
    """Tension [N] at one time, by the stretches y and s [m] of both parts and the rate of length [m/s]; none of a slack segment.

    Both parts carry it, so that T (c_s + c) = c_s (k_d y + c rate) + c P.
    """
    part = slow_part(crept, creep)
    if fast_stretch <= part.offset:
        return 0.0
    elastic = part.fast_stiffness * (fast_stretch - part.offset)
    both = creep.damper * (elastic + creep.fast_damper * rate) + creep.fast_damper * part.tension
    return max(both / (creep.damper + creep.fast_damper), 0.0)


class _Gap(NamedTuple):
    """Tension of the slow part less that of the fast part [N], the slope of the latter [N/m], and the `CreepStep`."""

    tension: Any
    fast_slope: Any
    step: Any


@inlined_law
def _gap(change, fast_stretch, lengthening, crept, slow_damper, damper, numerical, curve, creep):
    """`_Gap` for a change of the slow stretch in a step."""
    middle = crept + 0.5 * change
    part = slow_part(middle, creep)
    P, k_d, before = part.tension, part.fast_stiffness, fast_stretch - part.offset
    spring = Spring(k_d, 0.0, 1.0, curve, 0, 0)
    T, fast_slope, secant = tension_between(before, before + lengthening - change, spring, damper, numerical, 0.0)
    stiffens = creep.per_tension > 0.0 and middle > 0.0 and T > 0.0
    straightened = P if has_working_curve(creep) else 0.0  # where the fast part is straight about P, only what exceeds it counts
    softening = 0.5 * creep.per_tension * part.slope * (secant - straightened) / k_d if stiffens else 0.0
    step = CreepStep(change, k_d, part.offset, 0.5 * part.slope + slow_damper, softening)
    return _Gap(P + slow_damper * change - T, fast_slope, step)


@law
def creep_of_step(fast_stretch, lengthening, crept, h, dissipation, numerical, curve, creep):
    """`CreepStep` of a segment whose length changes by ``lengthening`` in a step.

    Finds the change d of the slow stretch at which both parts carry the same tension, by Newton's method within an interval that
    holds it. The tension of the slow part grows with d, and that of the fast part falls.

    Parameters
    ----------
    fast_stretch, lengthening, crept : float64 [m]
        y_a, l_b - l_a and s_a.
    h : float64 [s]
    dissipation : float64, see the module
    numerical : float64 [N/m]
        Numerical damper of the fast part.
    curve : (rows, 2) float64
        Of `axial.Spring`; a segment that creeps has no rows there.
    creep : Creep

    Returns
    -------
    CreepStep
    """
    damper, slow_damper = creep.fast_damper / h, creep.damper / h + slow_numerical_damper(h, dissipation, creep)
    low = -2.0 * max(crept, 0.0)  # there the slow spring has no tension in the mean, and its damper pushes
    given = slow_damper, damper, numerical, curve, creep
    high = low - _gap(low, fast_stretch, lengthening, crept, *given).tension / (0.5 * creep.static_stiffness + slow_damper)
    for _ in range(MOST_TRIALS):
        linear = creep.per_tension == 0.0 and not has_working_curve(creep)
        if linear or _gap(high, fast_stretch, lengthening, crept, *given).tension >= 0.0:
            break
        high += high - low
    size, change = abs(fast_stretch) + abs(lengthening) + abs(crept), min(max(0.0, low), high)
    found = _gap(change, fast_stretch, lengthening, crept, *given)
    for _ in range(MOST_TRIALS):
        if found.tension > 0.0:
            high = change
        else:
            low = change
        slope = max(found.step.slope + found.fast_slope - found.step.softening, 0.5 * found.step.slope)
        step = -found.tension / slope
        if abs(step) <= PRECISION * size or high - low <= PRECISION * size:
            break
        change = change + step if low <= change + step <= high else 0.5 * (low + high)
        found = _gap(change, fast_stretch, lengthening, crept, *given)
    return found.step
