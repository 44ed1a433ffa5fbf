"""Sine, cosine and exponential function without branches and calls, so that a processor works on several of them at once.

Those of the C library are called one by one: a sum over waves that calls them takes most of its time there.

Source
------
Cody & Waite, Software Manual for the Elementary Functions (1980), ch. 6 and 8 (reduction by parts of pi/2, and polynomials); the
coefficients of sine and cosine are those of Taylor's series, whose next terms are below 1e-17 for angles up to pi/4.
"""

import numpy as np

from anet_lumped.compiled.jit import njit

from .axial import select

HALF_PI, HALF_PI_REST = 1.5707963267341256, 6.077100506506192e-11  # parts of pi/2; the first has 33 bits: k HALF_PI is exact
PER_PART = 1.0 / 64.0  # 2^-6

in_this_order = njit(forceinline=True, cache=True, error_model="numpy", fastmath={"contract"})
"""As `inlined_law`, but what the caller allows does not hold here: sums in another order would lose the parts of pi/2."""


@in_this_order
def sine_and_cosine(x):
    """Sine and cosine of an angle [rad], to 2e-16 besides what the rounding of the angle itself makes."""
    quarters = np.floor(x * 0.6366197723675814 + 0.5)
    r = (x - quarters * HALF_PI) - quarters * HALF_PI_REST
    z = r * r
    odd = 1.0 / 6227020800.0 - z * (1.0 / 1307674368000.0 - z * (1.0 / 355687428096000.0))
    odd = 1.0 / 120.0 - z * (1.0 / 5040.0 - z * (1.0 / 362880.0 - z * (1.0 / 39916800.0 - z * odd)))
    even = 1.0 / 479001600.0 - z * (1.0 / 87178291200.0 - z * (1.0 / 20922789888000.0))
    even = 1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40320.0 - z * (1.0 / 3628800.0 - z * even)))
    s, c = r - r * z * (1.0 / 6.0 - z * odd), 1.0 - z * (0.5 - z * even)
    quadrant = quarters - 4.0 * np.floor(0.25 * quarters)
    swapped = (quadrant == 1.0) | (quadrant == 3.0)
    sine, cosine = select(swapped, c, s), select(swapped, s, c)
    return select(quadrant >= 2.0, -sine, sine), select((quadrant == 1.0) | (quadrant == 2.0), -cosine, cosine)


@in_this_order
def exponential(x):
    """exp(x) for x from -40 to 0, to 1e-14 of itself: exp(x/64), squared six times."""
    y = x * PER_PART
    e = 1.0 + y * (1.0 / 12.0) * (1.0 + y * (1.0 / 13.0) * (1.0 + y * (1.0 / 14.0) * (1.0 + y * (1.0 / 15.0))))
    e = 1.0 + y * (1.0 / 9.0) * (1.0 + y * (1.0 / 10.0) * (1.0 + y * (1.0 / 11.0) * e))
    e = 1.0 + y * (1.0 / 6.0) * (1.0 + y * (1.0 / 7.0) * (1.0 + y * (1.0 / 8.0) * e))
    e = 1.0 + y * (1.0 / 3.0) * (1.0 + y * (1.0 / 4.0) * (1.0 + y * (1.0 / 5.0) * e))
    e = 1.0 + y * (1.0 + y * 0.5 * e)
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    return e * e
