"""Working curves of a polyester rope: the tension that a segment holds for long depends on the largest one that it ever held.

Stretched for the first time, a segment follows the original curve, of straight pieces from (0, 0) on. Once it has held T_max there,
at the stretch x_max, it follows a working curve from no tension at the stretch x_0 to T_max at x_max,

    x(T) = x_0 + (x_max - x_0) xi ,   T = T_max g(xi) ,

with a shape g of straight pieces from (0, 0) to (1, 1), until its tension exceeds T_max. Where the tension returns to zero it stays
longer by x_0, a share of x_max, or x_max - T_max L0/EA for a working curve of one stiffness EA.

A tension T held for long stretches the fast spring by

    y(T) = ln(1 + per_tension T/fast_stiffness)/per_tension ,    so that    dT/dy = fast_stiffness + per_tension T .

The slow stretch is the rest, s = x(T) - y(T). Here T is found for s: within a piece, s is a convex function of T, so that Newton's
method converges from the upper end of the piece on.

Source: Falkenberg, Ahjem & Yang, OTC-27761 (2017); MoorDyn's documentation, "Syrope Model for Polyester Lines"; Wei, Bingham and
Shao, ESOMOOR D5.1 (2026).
"""

import math
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.compiled.jit import inlined_law, law

MOST_TRIALS = 60
CONVERGED = 1e-9  # of the tension: what a step of Newton's method leaves after so small a correction is below rounding


class WorkingCurves(NamedTuple):
    """The curves of a segment.

    Parameters
    ----------
    L0 : [m], rest length
    curve : (rows, 2) float64
        Rows (strain, tension [N]) of the original curve, and rows (xi, g) of the shape of working curves.
    original, working, end : the first row of both, and the row after the last one; all the same without such curves
    permanent : x_0/x_max
    parallel : EA [N] of working curves of one stiffness, in place of ``permanent``; else 0
    T_max : [N]
    """

    L0: Any
    curve: Any
    original: Any
    working: Any
    end: Any
    permanent: Any
    parallel: Any
    T_max: Any


NO_CURVES = WorkingCurves(1.0, np.zeros((0, 2)), 0, 0, 0, 0.0, 0.0, 0.0)


class _Scaled(NamedTuple):
    """A curve: stretch = at + size x and T = top y for its rows (x, y) from ``first`` to ``end``."""

    at: Any
    size: Any
    top: Any
    first: Any
    end: Any


@inlined_law
def held_fast_stretch(T, fast_stiffness, per_tension):
    """Stretch y of the fast spring [m] under a tension that is held."""
    if per_tension == 0.0:
        return T / fast_stiffness
    return math.log1p(per_tension * T / fast_stiffness) / per_tension


@inlined_law
def _original(curves):
    return _Scaled(0.0, curves.L0, 1.0, curves.original, curves.working)


@inlined_law
def _working(curves):
    """The working curve of T_max > 0, whose upper end is on the original one."""
    curve, j, last, x, T = curves.curve, curves.original, curves.working - 1, 0.0, 0.0
    while j < last and curve[j, 1] < curves.T_max:
        j += 1
    if j > curves.original:
        x, T = curve[j - 1, 0], curve[j - 1, 1]
    largest = curves.L0 * (x + (curves.T_max - T) * (curve[j, 0] - x) / (curve[j, 1] - T))
    at = largest - curves.L0 * curves.T_max / curves.parallel if curves.parallel > 0.0 else curves.permanent * largest
    return _Scaled(at, largest - at, curves.T_max, curves.working, curves.end)


@law
def _tension_on(scaled, curve, crept, fast_stiffness, per_tension):
    """Tension on a curve at a slow stretch [N], and its slope [N/m]; both 0 where the slow stretch is less than that of none."""
    if crept <= scaled.at:
        return 0.0, 0.0
    low, high = scaled.first, scaled.end - 1
    while low < high:
        middle = (low + high) // 2
        T = scaled.top * curve[middle, 1]
        if scaled.at + scaled.size * curve[middle, 0] - held_fast_stretch(T, fast_stiffness, per_tension) < crept:
            low = middle + 1
        else:
            high = middle
    x, y = (curve[low - 1, 0], curve[low - 1, 1]) if low > scaled.first else (0.0, 0.0)
    compliance = scaled.size * (curve[low, 0] - x) / (scaled.top * (curve[low, 1] - y))
    stretch, T_before, T = scaled.at + scaled.size * x, scaled.top * y, scaled.top * curve[low, 1]
    for _ in range(MOST_TRIALS):
        more = stretch + compliance * (T - T_before) - held_fast_stretch(T, fast_stiffness, per_tension) - crept
        step = more / (compliance - 1.0 / (fast_stiffness + per_tension * T))
        T = max(T - step, T_before)
        if abs(step) <= CONVERGED * T:
            break
    return T, 1.0 / (compliance - 1.0 / (fast_stiffness + per_tension * T))


@law
def tension_at_slow_stretch(crept, curves, fast_stiffness, per_tension):
    """Tension that a segment holds for long at a slow stretch s [m]: T [N] and its slope dT/ds [N/m]."""
    if curves.T_max > 0.0:
        working = _working(curves)
        largest = working.at + working.size - held_fast_stretch(curves.T_max, fast_stiffness, per_tension)
        if crept < largest:
            return _tension_on(working, curves.curve, crept, fast_stiffness, per_tension)
    return _tension_on(_original(curves), curves.curve, crept, fast_stiffness, per_tension)


@law
def working_energy(T, curves):
    """Work that a segment gives back from a tension T held for long, on its working curve: the area under it [J]."""
    area, x, y = 0.0, 0.0, 0.0
    if curves.T_max <= 0.0:
        return area
    working = _working(curves)
    for j in range(curves.working, curves.end):
        x_1, y_1 = curves.curve[j, 0], curves.curve[j, 1]
        share = min(max((T / curves.T_max - y) / (y_1 - y), 0.0), 1.0)
        area += share * (x_1 - x) * (y + 0.5 * share * (y_1 - y))
        x, y = x_1, y_1
    return working.size * curves.T_max * area
