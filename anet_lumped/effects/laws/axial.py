"""Axial elasticity with Kelvin-Voigt damping: the law of one segment, at one time and between two times.

Two switches, 0.0 or 1.0, say whether spring and damper of a segment act where it is shorter than its rest length. With ``"damped"``
the spring may push with a part of its stiffness; its switch is that part, EA_compression/EA:

============  ===============  ===============
compression   two_way_spring   two_way_damper
============  ===============  ===============
``"none"``    0                0
``"damped"``  0, or the part   1
``"linear"``  1                1
============  ===============  ===============

A tension-strain curve of straight pieces is this spring in parallel with further springs, each of which acts above a strain eps_i,

    T = k (l - L0) + sum_i share_i k max(l - L0 - eps_i L0, 0) .

Energy and secant of the curve are the sums of those of its springs. So the energy statement of a step with one spring holds for the
curve, as long as the tension never falls with the strain.

The argument ``spring`` of the laws is a tuple: k [N/m], its switch, L0 [m], a table with rows (eps_i, share_i), and the first row
of the cable's curve and the row after its last.

The law at one time is plain arithmetic and `select`: Numba compiles these lines, NumPy runs them on arrays and JAX traces them.
`with_select` gives them another `select`, such as ``numpy.where`` or ``jax.numpy.where``.
"""

from types import FunctionType

import numpy as np
from numba.core.dispatcher import Dispatcher

from anet_lumped.compiled.jit import njit
from anet_lumped.compiled.lanes import select

SWITCHES = {"none": (0.0, 0.0), "damped": (0.0, 1.0), "linear": (1.0, 1.0)}


def with_select(law, where):
    """The law of a compiled function, in plain Python, with ``where`` in place of `select`."""
    names = {**law.py_func.__globals__, "select": where}
    for name in law.py_func.__code__.co_names:
        if name != "select" and isinstance(names.get(name), Dispatcher):
            names[name] = with_select(names[name], where)
    return FunctionType(law.py_func.__code__, names)


def spring_without_curve(k, two_way_spring):
    """``spring`` of a law without a curve."""
    return k, two_way_spring, 1.0, np.zeros((0, 2)), 0, 0


@njit(cache=True, forceinline=True)
def tension_parts(stretch, rate, spring, c, two_way_damper):
    """Tension of a segment at one time, and the tension of its spring alone.

    T = k (l - L0) + c dl/dt. A spring that cannot push does not act below l = L0; with ``"none"`` the damper does not act there
    either, and T is never negative.

    Parameters
    ----------
    stretch, rate : float64
        l - L0 [m] and dl/dt [m/s].
    spring : tuple, see the module
    c : float64
        Damper of the segment [N s/m].
    two_way_damper : float64
        Switch of the compression law, see the module.

    Returns
    -------
    T, elastic : float64 [N]
    """
    k, two_way_spring, L0, springs, first, last = spring
    taut = stretch > 0.0
    elastic = select(taut, k, two_way_spring * k) * stretch
    for i in range(first, last):
        stretch_beyond = stretch - springs[i, 0] * L0
        elastic = elastic + select(stretch_beyond > 0.0, springs[i, 1] * k * stretch_beyond, 0.0)
    T = elastic + select(taut, c, two_way_damper * c) * rate
    return select(T > 0.0, T, two_way_damper * T), elastic


@njit(cache=True, forceinline=True)
def tension_slopes(stretch, rate, spring, c, two_way_damper):
    """Tension of `tension_parts` and its derivatives with respect to stretch [N/m] and to rate [N s/m]."""
    k, two_way_spring, L0, springs, first, last = spring
    taut = stretch > 0.0
    stretch_slope, rate_slope = select(taut, k, two_way_spring * k), select(taut, c, two_way_damper * c)
    T = stretch_slope * stretch + rate_slope * rate
    for i in range(first, last):
        stretch_beyond = stretch - springs[i, 0] * L0
        piece_slope = select(stretch_beyond > 0.0, springs[i, 1] * k, 0.0)
        T, stretch_slope = T + piece_slope * stretch_beyond, stretch_slope + piece_slope
    factor = select(T > 0.0, 1.0, two_way_damper)
    return factor * T, factor * stretch_slope, factor * rate_slope


@njit(cache=True, forceinline=True)
def spring_energy(stretch, k, two_way_spring):
    """Energy of one spring, psi = k/2 (l - L0)^2 [J]; 0 for a short spring that cannot push."""
    taut = 1.0 * (stretch > 0.0)
    return 0.5 * k * stretch * stretch * (two_way_spring + (1.0 - two_way_spring) * taut)


@njit(cache=True, forceinline=True)
def elastic_energy(stretch, spring):
    """Energy psi of the springs of a law [J]."""
    k, two_way_spring, L0, springs, first, last = spring
    energy = spring_energy(stretch, k, two_way_spring)
    for i in range(first, last):
        energy = energy + spring_energy(stretch - springs[i, 0] * L0, springs[i, 1] * k, 0.0)
    return energy


@njit(cache=True, forceinline=True)
def energy_of_length(stretch, spring):
    """Derivative of `elastic_energy` in L0 at constant stretch and k [N]; not zero for a curve, whose pieces begin at eps_i L0."""
    k, _, L0, springs, first, last = spring
    slope = 0.0
    for i in range(first, last):
        slope -= springs[i, 0] * springs[i, 1] * k * max(stretch - springs[i, 0] * L0, 0.0)
    return slope


@njit(cache=True, forceinline=True)
def _secant_of_two_springs(stretch_a, stretch_b, k, push_stiffness):
    """`secant_tension` of a spring k that pushes with another stiffness, ``push_stiffness`` [N/m].

    If both lengths are on one side of L0, the secant is the mean of both tensions. If not, a stretch x at either end contributes
    k_x x/2 times x/(b - a).
    """
    k_a, k_b = select(stretch_a > 0.0, k, push_stiffness), select(stretch_b > 0.0, k, push_stiffness)
    both_taut, both_short = (stretch_a >= 0.0) & (stretch_b > 0.0), (stretch_a <= 0.0) & (stretch_b <= 0.0)
    change = stretch_b - stretch_a
    per_change = 1.0 / select(abs(change) > 1e-300, change, 1e-300)
    T = 0.5 * (k_b * stretch_b * (stretch_b * per_change) - k_a * stretch_a * (stretch_a * per_change))
    slope = (k_b * stretch_b - T) * per_change
    return select(both_taut | both_short, 0.5 * k_b * (stretch_a + stretch_b), T), select(both_taut | both_short, 0.5 * k_b, slope)


@njit(cache=True, forceinline=True)
def secant_tension(stretch_a, stretch_b, k, two_way_spring):
    """Secant of the energy of one spring between two lengths, (psi_b - psi_a)/(l_b - l_a), without cancellation.

    With the taut stretches x = max(l - L0, 0) the secant is k (x_a + x_b)/2 times (x_b - x_a)/(l_b - l_a). The last ratio is one if
    both lengths are taut, and takes no small difference if only one is.

    Returns
    -------
    T, slope : float64 [N], [N/m]
        The secant and its derivative in l_b.
    """
    if two_way_spring > 0.0 and two_way_spring < 1.0:
        return _secant_of_two_springs(stretch_a, stretch_b, k, two_way_spring * k)
    linear = (stretch_a >= 0.0) & (stretch_b > 0.0) | (two_way_spring > 0.0)
    taut_a, taut_b, change = max(stretch_a, 0.0), max(stretch_b, 0.0), stretch_b - stretch_a
    per_change = 1.0 / select(abs(change) > 1e-300, change, 1e-300)
    T = 0.5 * k * (taut_b * (taut_b * per_change) - taut_a * (taut_a * per_change))
    slope = (k * taut_b - T) * per_change
    return select(linear, 0.5 * k * (stretch_a + stretch_b), T), select(linear, 0.5 * k, slope)


@njit(cache=True, forceinline=True)
def elastic_secant(stretch_a, stretch_b, spring):
    """`secant_tension` of the springs of a law together, and its derivative in l_b."""
    k, two_way_spring, L0, springs, first, last = spring
    T, slope = secant_tension(stretch_a, stretch_b, k, two_way_spring)
    for i in range(first, last):
        stretch_from = springs[i, 0] * L0
        piece_T, piece_slope = secant_tension(stretch_a - stretch_from, stretch_b - stretch_from, springs[i, 1] * k, 0.0)
        T, slope = T + piece_T, slope + piece_slope
    return T, slope


@njit(cache=True, forceinline=True)
def damped_changes(stretch_a, stretch_b, two_way_spring, two_way_damper):
    """Changes of length in a step that the physical damper and the numerical one damp [m].

    Both damp the change of the taut part of the length. Below the rest length the physical damper acts as its switch says, and
    the numerical one as far as the spring does: it stands for a spring that the step does not resolve, and would hold a slack
    segment like glue.
    """
    taut = max(stretch_b, 0.0) - max(stretch_a, 0.0)
    slack = (stretch_b - stretch_a) - taut
    return taut + two_way_damper * slack, taut + two_way_spring * slack


@njit(cache=True, forceinline=True)
def tension_between(stretch_a, stretch_b, spring, damper, numerical, two_way_damper):
    """Tension that acts over a whole step, from a to b, so that no step can raise the energy.

    T = secant + damper (x_b - x_a) + numerical (y_b - y_a), with both changes from `damped_changes`; T >= 0 for ``"none"``.

    Parameters
    ----------
    stretch_a, stretch_b : float64 [m]
        l - L0 at both times.
    spring : tuple, see the module
    damper, numerical : float64 [N/m]
        The physical damper over the step, c/h, and the one that the scheme adds.
    two_way_damper : float64, switch

    Returns
    -------
    T, slope, secant : float64 [N], [N/m], [N]
        The tension, its derivative in l_b, and its conservative part: (T - secant)(l_b - l_a) >= 0 is dissipated.

    Source
    ------
    After Armero & Romero, Comput. Methods Appl. Mech. Engrg. 190 (2001) 2603 and 6783, for springs that cannot push.
    """
    secant, slope = elastic_secant(stretch_a, stretch_b, spring)
    damped_change, numerically_damped_change = damped_changes(stretch_a, stretch_b, spring[1], two_way_damper)
    T = secant + damper * damped_change + numerical * numerically_damped_change
    slope = slope + select(stretch_b > 0.0, damper + numerical, two_way_damper * damper + spring[1] * numerical)
    acts = (T > 0.0) | (two_way_damper > 0.0)
    return select(acts, T, 0.0), select(acts, slope, 0.0), secant
