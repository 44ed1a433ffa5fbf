"""How much of a straight segment, or of a sphere, is under water, without a jump at the surface.

A height z above the surface counts as the centre of a sphere of diameter d, of which the share

    h(z) = x^2 (3 - 2 x) ,    x = 1/2 - z/d  cut to [0, 1] ,

is under water: exactly that for the volume of a point's sphere, and for a cable, with d its diameter, a smooth law that is within
0.04 of the share of a level cylinder. Along a segment with ends at z1 and z2 the height is linear, z(s) = z1 + s (z2 - z1), and

    e = int_0^1 H(z(s)) ds ,   w1 = int (1 - s) h(z(s)) ds = de/dz1 ,   w2 = int s h(z(s)) ds = de/dz2 ,   H' = h ,

so that the weights w1 and w2 are the shares of its volume that each end carries, by virtual work, and -e the buoyancy's energy:
the submerged length of an inclined segment, and a smooth step over the diameter for a level one. The integrand is a polynomial
of degree four where the segment goes through the surface, which three Gauss points integrate exactly, and known below it.

All is plain arithmetic and `select`, as in `axial`.
Source: Archimedes, On Floating Bodies and On the Sphere and Cylinder (volume of a cap); the weights by virtual work.
"""

import math

from numba import njit

from .axial import select

POINT = 0.7745966692414834  # Gauss-Legendre, three points: 0 and +-sqrt(3/5), of weights 4/9 and 5/18 on [0, 1]
SMALL = 1e-4  # of the diameter: for a smaller change of height the middle stands for the secant, to a share of SMALL^2/24


def sphere(point):
    """Diameter of the sphere that a point's volume is [m], or, of a point that has drag alone, of a disc with Cd = 1."""
    if point.volume > 0.0:
        return (6.0 * point.volume / math.pi) ** (1.0 / 3.0)
    return math.sqrt(4.0 * point.CdA / math.pi)


@njit(cache=True, forceinline=True)
def cut(x):
    """``x``, but from 0 to 1."""
    return select(x > 0.0, select(x < 1.0, x, 1.0), 0.0)


@njit(cache=True, forceinline=True)
def share(z, d):
    """Share under water at a height z, its slope [1/m], and its integral H [m], 0 above the water.

    Parameters
    ----------
    z, d : float64 [m]
        Height of the centre above the surface, and diameter.
    """
    x = cut(0.5 - z / d)
    H = select(z < -0.5 * d, z + 0.5 * d, 0.0) - d * x * x * x * (1.0 - 0.5 * x)
    return x * x * (3.0 - 2.0 * x), -6.0 * x * (1.0 - x) / d, H


@njit(cache=True, forceinline=True)
def immersed(z1, z2, d):
    """The integrals of the module over a segment.

    Parameters
    ----------
    z1, z2 : float64 [m]
        Heights of its ends above the surface.
    d : float64 [m]

    Returns
    -------
    e : float64 [m]
    w1, w2 : float64
        1/2 each for a segment under water.
    k11, k12, k22 : float64 [1/m]
        Slopes of the weights: dw1/dz1, dw1/dz2 = dw2/dz1, dw2/dz2.
    """
    up = z1 <= z2
    a, b = select(up, z1, z2), select(up, z2, z1)
    rise = select(b - a > 1e-9 * d, b - a, 1e-9 * d)
    p, r = cut((-0.5 * d - a) / rise), cut((0.5 * d - a) / rise)  # under water up to s = p, dry from s = r
    slope = b - a
    e = p * (a + 0.5 * p * slope)
    low, high = p - 0.5 * p * p, 0.5 * p * p
    m, half, width = 0.5 * (p + r), 0.5 * POINT * (r - p), r - p
    s1, s2, s3 = m - half, m, m + half
    h1, g1, H1 = share(a + s1 * slope, d)
    h2, g2, H2 = share(a + s2 * slope, d)
    h3, g3, H3 = share(a + s3 * slope, d)
    c1, c2 = width * 5.0 / 18.0, width * 4.0 / 9.0
    e = e + c1 * (H1 + H3) + c2 * H2
    high = high + c1 * (s1 * h1 + s3 * h3) + c2 * s2 * h2
    low = low + c1 * ((1.0 - s1) * h1 + (1.0 - s3) * h3) + c2 * (1.0 - s2) * h2
    kll = c1 * ((1.0 - s1) ** 2 * g1 + (1.0 - s3) ** 2 * g3) + c2 * (1.0 - s2) ** 2 * g2
    klh = c1 * (s1 * (1.0 - s1) * g1 + s3 * (1.0 - s3) * g3) + c2 * s2 * (1.0 - s2) * g2
    khh = c1 * (s1 * s1 * g1 + s3 * s3 * g3) + c2 * s2 * s2 * g2
    return e, select(up, low, high), select(up, high, low), select(up, kll, khh), klh, select(up, khh, kll)


@njit(cache=True)
def wetted(z1, z2, d):
    """`immersed`, at no cost for a segment that is under water or out of it."""
    if max(z1, z2) <= -0.5 * d:
        return 0.5 * (z1 + z2), 0.5, 0.5, 0.0, 0.0, 0.0
    if min(z1, z2) >= 0.5 * d:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return immersed(z1, z2, d)


@njit(cache=True)
def wetted_between(z1a, z2a, z1b, z2b, d):
    """Weights that act over a step from heights a to heights b, so that their work is the change of e.

    g = w(mean) + c (z_b - z_a),   c = (e_b - e_a - w(mean).(z_b - z_a))/|z_b - z_a|^2 ,

    the discrete gradient, but for steps so small that the weights in their middle do as well.

    Parameters
    ----------
    z1a, z2a, z1b, z2b, d : float64 [m]

    Returns
    -------
    g1, g2 : float64
    s11, s12, s21, s22 : float64 [1/m]
        dg1/dz1b, dg1/dz2b, dg2/dz1b, dg2/dz2b.

    Source
    ------
    Gonzalez, J. Nonlinear Sci. 6 (1996) 449, eq. 16.
    """
    if max(z1a, z2a, z1b, z2b) <= -0.5 * d:
        return 0.5, 0.5, 0.0, 0.0, 0.0, 0.0
    if min(z1a, z2a, z1b, z2b) >= 0.5 * d:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    _, w1, w2, k11, k12, k22 = wetted(0.5 * (z1a + z1b), 0.5 * (z2a + z2b), d)
    x, y = z1b - z1a, z2b - z2a
    square = x * x + y * y
    if square < (SMALL * d) ** 2:
        return w1, w2, 0.5 * k11, 0.5 * k12, 0.5 * k12, 0.5 * k22
    before, after = wetted(z1a, z2a, d), wetted(z1b, z2b, d)
    per = 1.0 / square
    c = (after[0] - before[0] - w1 * x - w2 * y) * per
    cx = (after[1] - w1 - 0.5 * (k11 * x + k12 * y) - 2.0 * c * x) * per
    cy = (after[2] - w2 - 0.5 * (k12 * x + k22 * y) - 2.0 * c * y) * per
    return w1 + c * x, w2 + c * y, 0.5 * k11 + c + x * cx, 0.5 * k12 + x * cy, 0.5 * k12 + y * cx, 0.5 * k22 + c + y * cy


@njit(cache=True)
def share_between(z_a, z_b, d):
    """Share under water that acts over a step of a sphere, (H_b - H_a)/(z_b - z_a), and its slope in z_b [1/m]."""
    change = z_b - z_a
    if abs(change) < SMALL * d:
        h, slope, _ = share(0.5 * (z_a + z_b), d)
        return h, 0.5 * slope
    _, _, before = share(z_a, d)
    h, _, after = share(z_b, d)
    g = (after - before) / change
    return g, (h - g) / change
