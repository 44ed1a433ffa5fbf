"""The share of a straight segment, or of a sphere, that is under water. It changes smoothly at the surface.

The centre of a sphere of diameter d is at a height z above the surface. The share

    h(z) = x^2 (3 - 2 x) ,    x = 1/2 - z/d  limited to [0, 1] ,

of the sphere is under water. For the sphere of a point this is exact. For a cable of diameter d the same law is used; it is within
0.04 of the share of a level cylinder. Along a segment with ends at the heights z1 and z2 the height is linear,
z(s) = z1 + s (z2 - z1). With the integral H of h, H' = h, let

    e = int_0^1 H(z(s)) ds ,   w1 = int (1 - s) h(z(s)) ds = de/dz1 ,   w2 = int s h(z(s)) ds = de/dz2 .

By virtual work, w1 and w2 are the shares of the segment's volume whose buoyancy each end carries. The energy is -e times the
buoyancy of the whole segment. w1 + w2 is the submerged share of the length of an inclined segment; for a level segment it is a
smooth step over the diameter. Where the segment is wholly under water, the integrals are known in closed form. Where it goes
through the surface, the integrand is a polynomial of degree four, which three Gauss points integrate exactly.

All functions are written in plain arithmetic and `select`, as in `axial`.
Source: Archimedes, On Floating Bodies and On the Sphere and Cylinder (volume of a cap); the weights by virtual work.
"""

import math

from anet_lumped.compiled.jit import inlined_law, law

from .axial import select

GAUSS_POINT = 0.7745966692414834  # Gauss-Legendre, three points: 0 and +-sqrt(3/5), of weights 4/9 and 5/18 on [0, 1]
ALWAYS_UNDER = 0.0  # in place of the diameter of a point that is under water at any height
SMALL_CHANGE = 1e-4  # of the diameter: over a smaller change of height the slope in the middle is the secant, to SMALL_CHANGE^2/24


def sphere_diameter(point):
    """Diameter of the sphere that has the volume of a point [m]; for a point without volume, of the disc that has the area CdA."""
    if point.volume > 0.0:
        return (6.0 * point.volume / math.pi) ** (1.0 / 3.0)
    return math.sqrt(4.0 * point.CdA / math.pi)


@inlined_law
def limited(x):
    """``x`` limited to [0, 1]."""
    return select(x > 0.0, select(x < 1.0, x, 1.0), 0.0)


@inlined_law
def submerged_share(z, d):
    """Submerged share h at a height z, its slope in z [1/m], and its integral H [m], which is 0 above the water.

    Parameters
    ----------
    z, d : float64 [m]
        Height of the centre above the surface, and diameter.
    """
    x = limited(0.5 - z / d)
    H = select(z < -0.5 * d, z + 0.5 * d, 0.0) - d * x * x * x * (1.0 - 0.5 * x)
    return x * x * (3.0 - 2.0 * x), -6.0 * x * (1.0 - x) / d, H


@inlined_law
def immersed(z1, z2, d):
    """The integrals e, w1 and w2 of the module over a segment, and the slopes of w1 and w2.

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
    rising = z1 <= z2
    a, b = select(rising, z1, z2), select(rising, z2, z1)
    rise = select(b - a > 1e-9 * d, b - a, 1e-9 * d)
    wet_until, dry_from = limited((-0.5 * d - a) / rise), limited((0.5 * d - a) / rise)
    slope = b - a
    e = wet_until * (a + 0.5 * wet_until * slope)
    low_weight, high_weight = wet_until - 0.5 * wet_until * wet_until, 0.5 * wet_until * wet_until
    m, half, width = 0.5 * (wet_until + dry_from), 0.5 * GAUSS_POINT * (dry_from - wet_until), dry_from - wet_until
    s1, s2, s3 = m - half, m, m + half
    h1, g1, H1 = submerged_share(a + s1 * slope, d)
    h2, g2, H2 = submerged_share(a + s2 * slope, d)
    h3, g3, H3 = submerged_share(a + s3 * slope, d)
    c1, c2 = width * 5.0 / 18.0, width * 4.0 / 9.0
    e = e + c1 * (H1 + H3) + c2 * H2
    high_weight = high_weight + c1 * (s1 * h1 + s3 * h3) + c2 * s2 * h2
    low_weight = low_weight + c1 * ((1.0 - s1) * h1 + (1.0 - s3) * h3) + c2 * (1.0 - s2) * h2
    slope_low = c1 * ((1.0 - s1) ** 2 * g1 + (1.0 - s3) ** 2 * g3) + c2 * (1.0 - s2) ** 2 * g2
    slope_mixed = c1 * (s1 * (1.0 - s1) * g1 + s3 * (1.0 - s3) * g3) + c2 * s2 * (1.0 - s2) * g2
    slope_high = c1 * (s1 * s1 * g1 + s3 * s3 * g3) + c2 * s2 * s2 * g2
    return (
        e,
        select(rising, low_weight, high_weight),
        select(rising, high_weight, low_weight),
        select(rising, slope_low, slope_high),
        slope_mixed,
        select(rising, slope_high, slope_low),
    )


@law
def wetted(z1, z2, d):
    """`immersed`, in closed form for a segment that is wholly under water or wholly out of it."""
    if max(z1, z2) <= -0.5 * d:
        return 0.5 * (z1 + z2), 0.5, 0.5, 0.0, 0.0, 0.0
    if min(z1, z2) >= 0.5 * d:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return immersed(z1, z2, d)


@law
def wetted_between(z1a, z2a, z1b, z2b, d):
    """Weights g that act over a step from heights a to heights b, such that their work g.(z_b - z_a) is the change of e.

    They are the discrete gradient

        g = w(mean) + c (z_b - z_a),   c = (e_b - e_a - w(mean).(z_b - z_a))/|z_b - z_a|^2 ,

    with the weights w at the mean heights. For changes of height below `SMALL_CHANGE` the diameter they are w(mean).

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
    if square < (SMALL_CHANGE * d) ** 2:
        return w1, w2, 0.5 * k11, 0.5 * k12, 0.5 * k12, 0.5 * k22
    before, after = wetted(z1a, z2a, d), wetted(z1b, z2b, d)
    per_square = 1.0 / square
    c = (after[0] - before[0] - w1 * x - w2 * y) * per_square
    cx = (after[1] - w1 - 0.5 * (k11 * x + k12 * y) - 2.0 * c * x) * per_square
    cy = (after[2] - w2 - 0.5 * (k12 * x + k22 * y) - 2.0 * c * y) * per_square
    return w1 + c * x, w2 + c * y, 0.5 * k11 + c + x * cx, 0.5 * k12 + x * cy, 0.5 * k12 + y * cx, 0.5 * k22 + c + y * cy


@law
def submerged_share_between(z_a, z_b, d):
    """Submerged share of a sphere that acts over a step, the secant (H_b - H_a)/(z_b - z_a), and its slope in z_b [1/m]."""
    rise = z_b - z_a
    if abs(rise) < SMALL_CHANGE * d:
        h, slope, _ = submerged_share(0.5 * (z_a + z_b), d)
        return h, 0.5 * slope
    _, _, before = submerged_share(z_a, d)
    h, _, after = submerged_share(z_b, d)
    g = (after - before) / rise
    return g, (h - g) / rise


@inlined_law
def point_share(z, d):
    """`submerged_share` of a point, all of which is under water where d is `ALWAYS_UNDER`."""
    if d == ALWAYS_UNDER:
        return 1.0, 0.0, z
    return submerged_share(z, d)


@inlined_law
def point_share_between(z_a, z_b, d):
    """`submerged_share_between` of a point, all of which is under water where d is `ALWAYS_UNDER`."""
    if d == ALWAYS_UNDER:
        return 1.0, 0.0
    return submerged_share_between(z_a, z_b, d)
