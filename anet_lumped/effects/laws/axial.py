"""Axial elasticity with Kelvin-Voigt damping: the law of one segment, in time and between two times.

What a segment does when it is shorter than its rest length is given by two switches, 0.0 or 1.0; with ``"damped"`` the spring
may push with a part of its stiffness, and its switch is that part, EA_compression/EA:

============  ===============  ===============
compression   two_way_spring   two_way_damper
============  ===============  ===============
``"none"``    0                0
``"damped"``  0, or the part   1
``"linear"``  1                1
============  ===============  ===============

A tension-strain curve of straight pieces is that spring and more in parallel, each of which acts from a strain eps_i on,

    T = k (l - L0) + sum_i share_i k max(l - L0 - eps_i L0, 0) .

Its energy is the sum of theirs, and the secant between two lengths is, too: what is proved for a step with one spring holds as
long as the tension never falls.

What the laws take as ``spring`` is a tuple: k [N/m], its switch, L0 [m], and of a table with rows (eps_i, share_i) the first one
and the one after the last.

The law at one time is plain arithmetic and `select`, so that the same lines are compiled by Numba, run on arrays by NumPy and
traced by JAX: `with_select` gives them another `select`, such as ``numpy.where`` or ``jax.numpy.where``.
"""

from types import FunctionType

import numpy as np
from numba import njit
from numba.core.dispatcher import Dispatcher

from anet_lumped.compiled.lanes import select

SWITCHES = {"none": (0.0, 0.0), "damped": (0.0, 1.0), "linear": (1.0, 1.0)}


def with_select(law, where):
    """The law of a compiled function, in plain Python, with ``where`` in place of `select`."""
    names = {**law.py_func.__globals__, "select": where}
    for name in law.py_func.__code__.co_names:
        if name != "select" and isinstance(names.get(name), Dispatcher):
            names[name] = with_select(names[name], where)
    return FunctionType(law.py_func.__code__, names)


def one_spring(k, two_way_spring):
    """``spring`` of a law without a curve."""
    return k, two_way_spring, 1.0, np.zeros((0, 2)), 0, 0


@njit(cache=True, forceinline=True)
def tension_parts(stretch, rate, spring, c, two_way_damper):
    """Tension of a segment at one time, and the part of it that the spring alone would have.

    T = k (l - L0) + c dl/dt; a spring that cannot push is cut at l = L0; with ``"none"`` the damper is cut there too and
    T is never negative.

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
        beyond = stretch - springs[i, 0] * L0
        elastic = elastic + select(beyond > 0.0, springs[i, 1] * k * beyond, 0.0)
    T = elastic + select(taut, c, two_way_damper * c) * rate
    return select(T > 0.0, T, two_way_damper * T), elastic


@njit(cache=True, forceinline=True)
def tension_slopes(stretch, rate, spring, c, two_way_damper):
    """Tension of `tension_parts` and its derivatives with respect to stretch [N/m] and to rate [N s/m]."""
    k, two_way_spring, L0, springs, first, last = spring
    taut = stretch > 0.0
    of_stretch, of_rate = select(taut, k, two_way_spring * k), select(taut, c, two_way_damper * c)
    T = of_stretch * stretch + of_rate * rate
    for i in range(first, last):
        beyond = stretch - springs[i, 0] * L0
        acts = select(beyond > 0.0, springs[i, 1] * k, 0.0)
        T, of_stretch = T + acts * beyond, of_stretch + acts
    acts = select(T > 0.0, 1.0, two_way_damper)
    return acts * T, acts * of_stretch, acts * of_rate


@njit(cache=True, forceinline=True)
def stored(stretch, k, two_way_spring):
    """Energy of one spring, psi = k/2 (l - L0)^2 [J], of the taut part only if it cannot push."""
    taut = 1.0 * (stretch > 0.0)
    return 0.5 * k * stretch * stretch * (two_way_spring + (1.0 - two_way_spring) * taut)


@njit(cache=True, forceinline=True)
def elastic_energy(stretch, spring):
    """Energy psi of the springs of a law [J]."""
    k, two_way_spring, L0, springs, first, last = spring
    energy = stored(stretch, k, two_way_spring)
    for i in range(first, last):
        energy = energy + stored(stretch - springs[i, 0] * L0, springs[i, 1] * k, 0.0)
    return energy


@njit(cache=True, forceinline=True)
def energy_of_length(stretch, spring):
    """Derivative of `elastic_energy` in L0 at the same stretch and k [N]: a curve's pieces begin at eps_i L0."""
    k, _, L0, springs, first, last = spring
    slope = 0.0
    for i in range(first, last):
        slope -= springs[i, 0] * springs[i, 1] * k * max(stretch - springs[i, 0] * L0, 0.0)
    return slope


@njit(cache=True, forceinline=True)
def _secant_of_two_springs(stretch_a, stretch_b, k, soft):
    """`secant_tension` of a spring k that pushes with another stiffness, ``soft`` [N/m].

    On one side of L0 it is the mean of the tensions at both ends; across it each end x has the part k_x x/2 times x/(b - a).
    """
    k_a, k_b = select(stretch_a > 0.0, k, soft), select(stretch_b > 0.0, k, soft)
    taut, short = (stretch_a >= 0.0) & (stretch_b > 0.0), (stretch_a <= 0.0) & (stretch_b <= 0.0)
    change = stretch_b - stretch_a
    per = 1.0 / select(abs(change) > 1e-300, change, 1e-300)
    T = 0.5 * (k_b * stretch_b * (stretch_b * per) - k_a * stretch_a * (stretch_a * per))
    slope = (k_b * stretch_b - T) * per
    return select(taut | short, 0.5 * k_b * (stretch_a + stretch_b), T), select(taut | short, 0.5 * k_b, slope)


@njit(cache=True, forceinline=True)
def secant_tension(stretch_a, stretch_b, k, two_way_spring):
    """Secant of the energy of one spring between two lengths, (psi_b - psi_a)/(l_b - l_a), without cancellation.

    With the cut stretches x = max(l - L0, 0) it is k (x_a + x_b)/2 times (x_b - x_a)/(l_b - l_a), and that last ratio is
    one when both are taut and needs no small difference when only one is.

    Returns
    -------
    T, slope : float64 [N], [N/m]
        The secant and its derivative in l_b.
    """
    if two_way_spring > 0.0 and two_way_spring < 1.0:
        return _secant_of_two_springs(stretch_a, stretch_b, k, two_way_spring * k)
    whole = (stretch_a >= 0.0) & (stretch_b > 0.0) | (two_way_spring > 0.0)
    x_a, x_b, change = max(stretch_a, 0.0), max(stretch_b, 0.0), stretch_b - stretch_a
    per = 1.0 / select(abs(change) > 1e-300, change, 1e-300)
    T = 0.5 * k * (x_b * (x_b * per) - x_a * (x_a * per))
    slope = (k * x_b - T) * per
    return select(whole, 0.5 * k * (stretch_a + stretch_b), T), select(whole, 0.5 * k, slope)


@njit(cache=True, forceinline=True)
def elastic_secant(stretch_a, stretch_b, spring):
    """`secant_tension` of the springs of a law together, and its derivative in l_b."""
    k, two_way_spring, L0, springs, first, last = spring
    T, slope = secant_tension(stretch_a, stretch_b, k, two_way_spring)
    for i in range(first, last):
        begins = springs[i, 0] * L0
        more, steeper = secant_tension(stretch_a - begins, stretch_b - begins, springs[i, 1] * k, 0.0)
        T, slope = T + more, slope + steeper
    return T, slope


@njit(cache=True, forceinline=True)
def damped_changes(stretch_a, stretch_b, two_way_spring, two_way_damper):
    """Changes of length that the physical damper and the numerical one of a step see [m].

    Each sees the taut part of the length, and of the rest as much as it acts there: the numerical damper stands in for a spring
    that the step does not resolve, and acts only as the spring does. On a slack segment it would be glue.
    """
    taut = max(stretch_b, 0.0) - max(stretch_a, 0.0)
    slack = (stretch_b - stretch_a) - taut
    return taut + two_way_damper * slack, taut + two_way_spring * slack


@njit(cache=True, forceinline=True)
def tension_between(stretch_a, stretch_b, spring, damper, numerical, two_way_damper):
    """Tension that acts over a whole step, from a to b, so that no step can raise the energy.

    T = secant + damper (x_b - x_a) + numerical (y_b - y_a), with the changes of `damped_changes`; T >= 0 for ``"none"``.

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
        The tension, its derivative in l_b, and the part that is conservative: (T - secant)(l_b - l_a) >= 0 is dissipated.

    Source
    ------
    After Armero & Romero, Comput. Methods Appl. Mech. Engrg. 190 (2001) 2603 and 6783, for springs that cannot push.
    """
    secant, slope = elastic_secant(stretch_a, stretch_b, spring)
    moved, stretched = damped_changes(stretch_a, stretch_b, spring[1], two_way_damper)
    T = secant + damper * moved + numerical * stretched
    slope = slope + select(stretch_b > 0.0, damper + numerical, two_way_damper * damper + spring[1] * numerical)
    acts = (T > 0.0) | (two_way_damper > 0.0)
    return select(acts, T, 0.0), select(acts, slope, 0.0), secant
