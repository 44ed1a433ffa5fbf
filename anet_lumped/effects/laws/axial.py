"""Axial elasticity with Kelvin-Voigt damping: the law of one segment, at one time and over a step.

A cable's ``compression`` says whether spring and damper of a segment act while it is shorter than its rest length. Two numbers
express this: the share of the stiffness with which the spring pushes, EA_compression/EA, and 1.0 for a damper that acts on slack
segments too.

============  =============  ==============
compression   push_share     two_way_damper
============  =============  ==============
``"none"``    0              0
``"damped"``  0 to 1         1
``"linear"``  1              1
============  =============  ==============

A tension-strain curve of straight pieces is this spring in parallel with further springs, which cannot push. Spring i acts above a
strain eps_i:

    T = k (l - L0) + sum_i share_i k max(l - L0 - eps_i L0, 0) .

Energy and secant of the curve are the sums of the energies and secants of its springs. So the energy statement of a step, which
holds for one spring, holds for the curve, as long as the tension never falls with the strain.

The law at one time is written in plain arithmetic and `select`: Numba compiles these lines, NumPy runs them on arrays, and JAX
traces them. `with_select` puts another `select` in its place, such as ``numpy.where`` or ``jax.numpy.where``.
"""

from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
from numba.core.dispatcher import Dispatcher

from anet_lumped.compiled.jit import inlined_law
from anet_lumped.compiled.lanes import all_of, select

SWITCHES = {"none": (0.0, 0.0), "damped": (0.0, 1.0), "linear": (1.0, 1.0)}
"""push_share and two_way_damper of each compression law, ``"damped"`` without EA_compression."""


class Spring(NamedTuple):
    """The springs of a segment.

    Parameters
    ----------
    stiffness : k [N/m], of the spring that acts from no strain on
    push_share : share of k with which that spring pushes
    L0 : rest length [m]
    curve : (rows, 2), rows (eps_i, share_i) of the further springs of tension-strain curves
    first_piece, end_piece : first row of ``curve`` for this segment, and the row after the last one
    """

    stiffness: Any
    push_share: Any
    L0: Any
    curve: Any
    first_piece: Any
    end_piece: Any


def with_select(law, where):
    """The function that Numba compiled as ``law``, in plain Python and with ``where`` in place of `select`."""
    names = {**law.py_func.__globals__, "select": where}
    for name in law.py_func.__code__.co_names:
        if name != "select" and isinstance(names.get(name), Dispatcher):
            names[name] = with_select(names[name], where)
    return FunctionType(law.py_func.__code__, names)


def spring_without_curve(k, push_share):
    """`Spring` of a segment without a tension-strain curve; of any rest length, since only a curve asks for it."""
    return Spring(k, push_share, 1.0, np.zeros((0, 2)), 0, 0)


@inlined_law
def tension_parts(stretch, rate, spring, c, two_way_damper):
    """Tension of a segment at one time, and the tension of its spring alone.

    T = k (l - L0) + c dl/dt. A spring that cannot push does not act below l = L0. With ``"none"`` the damper does not act there
    either, and T is never negative.

    Parameters
    ----------
    stretch, rate : float64
        Stretch l - L0 [m] and rate of length dl/dt [m/s].
    spring : Spring
    c : float64
        Damper of the segment [N s/m].
    two_way_damper : float64
        See the module.

    Returns
    -------
    T, elastic : float64 [N]
    """
    k, push_share, L0, curve, first, end = spring
    taut = stretch > 0.0
    elastic = select(taut, k, push_share * k) * stretch
    for i in range(first, end):
        stretch_beyond = stretch - curve[i, 0] * L0
        elastic = elastic + select(stretch_beyond > 0.0, curve[i, 1] * k * stretch_beyond, 0.0)
    T = elastic + select(taut, c, two_way_damper * c) * rate
    return select(T > 0.0, T, two_way_damper * T), elastic


@inlined_law
def tension_slopes(stretch, rate, spring, c, two_way_damper):
    """The tension T of `tension_parts` [N], and its derivatives in the stretch [N/m] and in the rate [N s/m]."""
    k, push_share, L0, curve, first, end = spring
    taut = stretch > 0.0
    stretch_slope, rate_slope = select(taut, k, push_share * k), select(taut, c, two_way_damper * c)
    T = stretch_slope * stretch + rate_slope * rate
    for i in range(first, end):
        stretch_beyond = stretch - curve[i, 0] * L0
        piece_slope = select(stretch_beyond > 0.0, curve[i, 1] * k, 0.0)
        T, stretch_slope = T + piece_slope * stretch_beyond, stretch_slope + piece_slope
    factor = select(T > 0.0, 1.0, two_way_damper)
    return factor * T, factor * stretch_slope, factor * rate_slope


@inlined_law
def spring_energy(stretch, k, push_share):
    """Energy of one spring, psi = k/2 (l - L0)^2 [J], of which a spring shorter than L0 has the share ``push_share``."""
    taut = 1.0 * (stretch > 0.0)
    return 0.5 * k * stretch * stretch * (push_share + (1.0 - push_share) * taut)


@inlined_law
def elastic_energy(stretch, spring):
    """Energy psi of all springs of a segment [J]."""
    k, push_share, L0, curve, first, end = spring
    energy = spring_energy(stretch, k, push_share)
    for i in range(first, end):
        energy = energy + spring_energy(stretch - curve[i, 0] * L0, curve[i, 1] * k, 0.0)
    return energy


@inlined_law
def energy_of_length(stretch, spring):
    """Derivative of `elastic_energy` in L0 at constant stretch and k [N].

    It is zero without a curve. The pieces of a curve begin at the stretches eps_i L0, which change with L0.
    """
    k, _, L0, curve, first, end = spring
    slope = 0.0
    for i in range(first, end):
        slope -= curve[i, 0] * curve[i, 1] * k * max(stretch - curve[i, 0] * L0, 0.0)
    return slope


@inlined_law
def _secant_of_two_springs(stretch_a, stretch_b, k, push_stiffness):
    """`secant_tension` of a spring that pulls with the stiffness k and pushes with ``push_stiffness`` [N/m].

    If both lengths are on one side of L0, the secant is the mean of both tensions. If not, it is

        (k_b x_b^2 - k_a x_a^2)/(2 (x_b - x_a)) ,

    with the stretches x_a and x_b and the stiffness that each of them meets.
    """
    k_a, k_b = select(stretch_a > 0.0, k, push_stiffness), select(stretch_b > 0.0, k, push_stiffness)
    both_taut, both_short = (stretch_a >= 0.0) & (stretch_b > 0.0), (stretch_a <= 0.0) & (stretch_b <= 0.0)
    change = stretch_b - stretch_a
    per_change = 1.0 / select(abs(change) > 1e-300, change, 1e-300)
    T = 0.5 * (k_b * stretch_b * (stretch_b * per_change) - k_a * stretch_a * (stretch_a * per_change))
    slope = (k_b * stretch_b - T) * per_change
    return select(both_taut | both_short, 0.5 * k_b * (stretch_a + stretch_b), T), select(both_taut | both_short, 0.5 * k_b, slope)


@inlined_law
def secant_tension(stretch_a, stretch_b, k, push_share):
    """Secant of the energy of one spring between two lengths, (psi_b - psi_a)/(l_b - l_a), without cancellation.

    With the taut stretches x = max(l - L0, 0) the secant is k (x_a + x_b)/2 times (x_b - x_a)/(l_b - l_a). The last ratio is one if
    both lengths are taut. If only one of them is taut, no two nearly equal numbers are subtracted.

    Returns
    -------
    T, slope : float64 [N], [N/m]
        The secant and its derivative in l_b.
    """
    if push_share > 0.0 and push_share < 1.0:
        return _secant_of_two_springs(stretch_a, stretch_b, k, push_share * k)
    linear = (stretch_a >= 0.0) & (stretch_b > 0.0) | (push_share > 0.0)
    if all_of(linear):  # of most segments, which need no division then
        return 0.5 * k * (stretch_a + stretch_b), 0.5 * k
    taut_a, taut_b, change = max(stretch_a, 0.0), max(stretch_b, 0.0), stretch_b - stretch_a
    per_change = 1.0 / select(abs(change) > 1e-300, change, 1e-300)
    T = 0.5 * k * (taut_b * (taut_b * per_change) - taut_a * (taut_a * per_change))
    slope = (k * taut_b - T) * per_change
    return select(linear, 0.5 * k * (stretch_a + stretch_b), T), select(linear, 0.5 * k, slope)


@inlined_law
def elastic_secant(stretch_a, stretch_b, spring):
    """Sum of `secant_tension` over all springs of a segment [N], and its derivative in l_b [N/m]."""
    k, push_share, L0, curve, first, end = spring
    T, slope = secant_tension(stretch_a, stretch_b, k, push_share)
    for i in range(first, end):
        stretch_from = curve[i, 0] * L0
        piece_T, piece_slope = secant_tension(stretch_a - stretch_from, stretch_b - stretch_from, curve[i, 1] * k, 0.0)
        T, slope = T + piece_T, slope + piece_slope
    return T, slope


@inlined_law
def damped_changes(stretch_a, stretch_b, push_share, two_way_damper):
    """Change of length in a step that the physical damper damps, and the change that the numerical damper damps [m].

    Both damp the change of the taut part of the length. Below the rest length the physical damper acts if it is a two-way damper.
    The numerical damper acts there with the share ``push_share``, as the spring does: it stands for a spring that the step does not
    resolve, and where no spring acts, it would hold a slack segment like glue.
    """
    taut = max(stretch_b, 0.0) - max(stretch_a, 0.0)
    slack = (stretch_b - stretch_a) - taut
    return taut + two_way_damper * slack, taut + push_share * slack


@inlined_law
def tension_between(stretch_a, stretch_b, spring, damper, numerical, two_way_damper):
    """Tension that acts over a whole step, from a to b, such that no step can raise the energy.

    T = secant + damper (x_b - x_a) + numerical (y_b - y_a), with the changes x_b - x_a and y_b - y_a from `damped_changes`. With
    ``"none"`` T is never negative.

    Parameters
    ----------
    stretch_a, stretch_b : float64 [m]
        l - L0 at both times.
    spring : Spring
    damper, numerical : float64 [N/m]
        The physical damper over the step, c/h, and the one that the scheme adds.
    two_way_damper : float64, see the module

    Returns
    -------
    T, slope, secant : float64 [N], [N/m], [N]
        The tension, its derivative in l_b, and the part of it that has an energy. The step dissipates (T - secant)(l_b - l_a),
        which is never negative.

    Source
    ------
    After Armero & Romero, Comput. Methods Appl. Mech. Engrg. 190 (2001) 2603 and 6783, for springs that cannot push.
    """
    secant, slope = elastic_secant(stretch_a, stretch_b, spring)
    damped_change, numerically_damped_change = damped_changes(stretch_a, stretch_b, spring.push_share, two_way_damper)
    T = secant + damper * damped_change + numerical * numerically_damped_change
    slope = slope + select(stretch_b > 0.0, damper + numerical, two_way_damper * damper + spring.push_share * numerical)
    acts = (T > 0.0) | (two_way_damper > 0.0)
    return select(acts, T, 0.0), select(acts, slope, 0.0), secant
