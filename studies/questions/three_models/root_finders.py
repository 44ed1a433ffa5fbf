"""Root finders for the catenary number a of Eq. 3.4: the thesis's two, one without a bracket, and that of this library.

f(a) = a sinh(d/2a) - sqrt(L² - v²)/2 = 0 for a cable of length L between ends d apart in the horizontal and v in the vertical. f is
even in a: with a root a it has the root -a, which is a cable that pushes.
"""

import math
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
from scipy import optimize

from anet_lumped.statics.catenary import catenary

EPSILON = 1e-10  # [m] of |f| at which the thesis's methods end, Eqs. 3.8 and 3.12
MOST = 100_000  # iterations
BISECTION, FALSE_POSITION, OURS, POWELL = "bisection", "false position", "this library", "Powell's hybrid (fsolve)"
BRACKETS = ((0.05, 10.0), (1e-2, 10.0), (1e-4, 10.0), (0.5, 10.0), (-10.0, -0.05))  # [m]
QUICK_BRACKETS = BRACKETS[:1] + BRACKETS[2:]
STARTS = tuple(float(x) for x in np.logspace(-3, 2, 16))  # [m] of the search without a bracket


class Span(NamedTuple):
    """A cable of a length between ends that are apart by d in the horizontal and by v in the vertical, all [m]."""

    name: str
    d: float
    v: float
    length: float


SPANS = (
    Span("2 m over 1 m", 1.0, 0.0, 2.0),
    Span("1 m, half of it", 0.5, 0.7963883559, 1.0),
    Span("nearly taut", 0.999, 0.0, 1.0),
    Span("nearly folded", 0.01, 0.0, 1.0),
)


class Found(NamedTuple):
    """What a root finder found: the root [m], iterations, and a status: "done", "mirrored" or why not."""

    root: float
    iterations: int
    status: str


def mismatch(span):
    """f of Eq. 3.4 [m] as a function of a [m]; infinite where sinh overflows."""
    half = 0.5 * math.sqrt(span.length**2 - span.v**2)

    def f(a):
        try:
            return a * math.sinh(0.5 * span.d / a) - half
        except (OverflowError, ZeroDivisionError):
            return math.inf

    return f


def bracketed(span, bracket, method):
    """Eqs. 3.5 to 3.12: bisection, or false position, which the thesis calls true region.

    Parameters
    ----------
    span : Span
    bracket : (2,) [m]
    method : BISECTION or FALSE_POSITION

    Returns
    -------
    Found
    """
    f = mismatch(span)
    (low, high), (f_low, f_high) = bracket, map(f, bracket)
    if not f_low * f_high < 0.0:
        return Found(math.nan, 0, "no change of sign")
    for k in range(1, MOST + 1):
        c = 0.5 * (low + high) if method == BISECTION else (low * f_high - high * f_low) / (f_high - f_low)
        if not math.isfinite(c):
            return Found(math.nan, k, "not a number")
        f_c = f(c)
        if abs(f_c) < EPSILON:
            return Found(c, k, _judged(c))
        if f_c * f_low < 0.0:
            high, f_high = c, f_c
        else:
            low, f_low = c, f_c
    return Found(math.nan, MOST, "too many iterations")


def unbracketed(span, start):
    """SciPy's `fsolve`, from a start [m], as a `Found`."""
    f = mismatch(span)
    with np.errstate(all="ignore"):
        roots, info, flag, _ = optimize.fsolve(lambda a: f(float(a[0])), [start], full_output=True, xtol=EPSILON)
    root = float(roots[0])
    return Found(root, int(info["nfev"]), _judged(root)) if flag == 1 else Found(math.nan, int(info["nfev"]), "no root")


def ours(span):
    """The library's `catenary`, which takes no bracket, as a `Found`; iterations are those of Brent's method in it."""
    taken = []
    brent = optimize.brentq

    def counted(function, low, high, **settings):
        root, record = brent(function, low, high, full_output=True, **settings)
        taken.append(record.iterations)
        return root

    with patch.object(optimize, "brentq", counted):
        found = catenary((0.0, 0.0), (span.d, span.v), span.length)
    return Found(found.a, sum(taken), _judged(found.a))


def _judged(root):
    return "done" if root > 0.0 else "mirrored"
