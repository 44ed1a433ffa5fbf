"""Axial elasticity with Kelvin-Voigt damping: the law of one segment, in time and between two times.

What a segment does when it is shorter than its rest length is given by two switches, 0.0 or 1.0:

============  ===============  ===============
compression   two_way_spring   two_way_damper
============  ===============  ===============
``"none"``    0                0
``"damped"``  0                1
``"linear"``  1                1
============  ===============  ===============

The law at one time is plain arithmetic and `select`, so that the same lines are compiled by Numba, run on arrays by NumPy and
traced by JAX: `with_select` gives them another `select`, such as ``numpy.where`` or ``jax.numpy.where``.
"""

from types import FunctionType

from numba import njit

SWITCHES = {"none": (0.0, 0.0), "damped": (0.0, 1.0), "linear": (1.0, 1.0)}


@njit(cache=True, forceinline=True)
def select(condition, a, b):
    """``a`` where the condition holds, else ``b``."""
    return a if condition else b


def with_select(law, where):
    """The law of a compiled function, in plain Python, with ``where`` in place of `select`."""
    return FunctionType(law.py_func.__code__, {**law.py_func.__globals__, "select": where})


@njit(cache=True, forceinline=True)
def tension_parts(stretch, rate, k, c, two_way_spring, two_way_damper):
    """Tension of a segment at one time, and the part of it that the spring alone would have.

    T = k (l - L0) + c dl/dt; a spring that cannot push is cut at l = L0; with ``"none"`` the damper is cut there too and
    T is never negative.

    Parameters
    ----------
    stretch, rate : float64
        l - L0 [m] and dl/dt [m/s].
    k, c : float64
        Spring [N/m] and damper [N s/m] of the segment.
    two_way_spring, two_way_damper : float64
        Switches of the compression law, see the module.

    Returns
    -------
    T, spring : float64 [N]
    """
    taut = stretch > 0.0
    spring = select(taut, k, two_way_spring * k) * stretch
    T = spring + select(taut, c, two_way_damper * c) * rate
    return select(T > 0.0, T, two_way_damper * T), spring


@njit(cache=True, forceinline=True)
def tension_slopes(stretch, rate, k, c, two_way_spring, two_way_damper):
    """Tension of `tension_parts` and its derivatives with respect to stretch [N/m] and to rate [N s/m]."""
    taut = stretch > 0.0
    of_stretch, of_rate = select(taut, k, two_way_spring * k), select(taut, c, two_way_damper * c)
    T = of_stretch * stretch + of_rate * rate
    acts = select(T > 0.0, 1.0, two_way_damper)
    return acts * T, acts * of_stretch, acts * of_rate


@njit(cache=True, forceinline=True)
def stored(stretch, k, two_way_spring):
    """Spring energy psi = k/2 (l - L0)^2 [J], of the taut part only if the spring cannot push."""
    taut = 1.0 * (stretch > 0.0)
    return 0.5 * k * stretch * stretch * (two_way_spring + (1.0 - two_way_spring) * taut)


@njit(cache=True, forceinline=True)
def secant_tension(stretch_a, stretch_b, k, two_way_spring):
    """Secant of the spring energy between two lengths, (psi_b - psi_a)/(l_b - l_a), without cancellation.

    With the cut stretches x = max(l - L0, 0) it is k (x_a + x_b)/2 times (x_b - x_a)/(l_b - l_a), and that last ratio is
    one when both are taut and needs no small difference when only one is.

    Returns
    -------
    T, slope : float64 [N], [N/m]
        The secant and its derivative in l_b.
    """
    if two_way_spring > 0.0 or (stretch_a >= 0.0 and stretch_b > 0.0):
        return 0.5 * k * (stretch_a + stretch_b), 0.5 * k
    if stretch_a <= 0.0 and stretch_b <= 0.0:
        return 0.0, 0.0
    change = stretch_b - stretch_a
    if stretch_b > 0.0:
        T = 0.5 * k * stretch_b * (stretch_b / change)
        return T, (k * stretch_b - T) / change
    T = -0.5 * k * stretch_a * (stretch_a / change)
    return T, -T / change


@njit(cache=True, forceinline=True)
def tension_between(stretch_a, stretch_b, k, damper, two_way_spring, two_way_damper):
    """Tension that acts over a whole step, from a to b, so that no step can raise the energy.

    T = secant + damper (x_b - x_a), where x is the length (its taut part for ``"none"``, and then T >= 0) and
    damper = c/h + alpha k holds the physical damper over the step and the numerical one.

    Returns
    -------
    T, slope, secant : float64 [N], [N/m], [N]
        The tension, its derivative in l_b, and the part that is conservative: (T - secant)(l_b - l_a) >= 0 is dissipated.

    Source
    ------
    After Armero & Romero, Comput. Methods Appl. Mech. Engrg. 190 (2001) 2603 and 6783, for springs that cannot push.
    """
    secant, slope = secant_tension(stretch_a, stretch_b, k, two_way_spring)
    if two_way_damper > 0.0:
        T = secant + damper * (stretch_b - stretch_a)
        return T, slope + damper, secant
    taut_a, taut_b = max(stretch_a, 0.0), max(stretch_b, 0.0)
    T = secant + damper * (taut_b - taut_a)
    if T <= 0.0:
        return 0.0, 0.0, secant
    if stretch_b > 0.0:
        slope += damper
    return T, slope, secant
