"""The part of a box that is under a level surface: its volume and first moments, its energy, and their slopes, exactly.

A point of the box at s from its centre, in its own axes, is at the height z = c + n.s above the surface, with the vertical
components n of these axes. Let

    I(c, n) = int max(0, -z) ds ,   dI/dc = -V ,   dI/dn = -int_wet s ds ,

with the volume V under water. The energy of buoyancy is rho g I, so that the force, upwards, is rho g V, through the centroid of V.
The second slopes are moments of the waterplane, over which ds is an area by |n|:

    d2I/dc2 = int ds ,   d2I/dc dn = int s ds ,   d2I/dn dn = int s s^T ds .

The box is cut into six tetrahedra along its diagonal, and each of them by the surface into tetrahedra under water and triangles of
the waterplane. Each point of a cut edge from x under water to y above it divides the edge as their depths do, so that no numbers
cancel and no direction is special. Nothing asks the axes to be of length 1.
Source: Archimedes, On Floating Bodies, for the force; Kuhn, IBM J. Res. Dev. 4 (1960) 518, for the six tetrahedra.
"""

from typing import NamedTuple

import numpy as np

from anet_lumped.compiled.jit import inlined_law, law


class Immersed(NamedTuple):
    """I [m4] of the module, its slopes g (4,) in (c, n) [m3], [m4], and its second slopes by rows H (10,) of the upper triangle."""

    I: float
    g: tuple
    H: tuple


NOTHING = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""Sums over the pieces of a box: I; V and its first moments (4); area, first and second moments of the waterplane (10)."""
X, Y, Z = np.arange(3)  # numbers of axes; for a literal 0, 1 or 2 Numba would compile anew the function that it is passed to


@inlined_law
def _between(p, q):
    """The point of the edge from p to q, each (x, y, z, depth), at the depth 0, and the share of the edge that is before it."""
    r = p[3] / (p[3] - q[3])
    return (p[0] + r * (q[0] - p[0]), p[1] + r * (q[1] - p[1]), p[2] + r * (q[2] - p[2]), 0.0), r


@inlined_law
def _with_tetrahedron(sums, volume, a, b, c, d):
    """Add a tetrahedron under water to the sums; a volume below 0 takes it away."""
    mean, q = 0.25 * volume, sums
    return (
        q[0] + mean * (a[3] + b[3] + c[3] + d[3]), q[1] + volume,
        q[2] + mean * (a[0] + b[0] + c[0] + d[0]), q[3] + mean * (a[1] + b[1] + c[1] + d[1]),
        q[4] + mean * (a[2] + b[2] + c[2] + d[2]),
        q[5], q[6], q[7], q[8], q[9], q[10], q[11], q[12], q[13], q[14],
    )  # fmt: skip


@inlined_law
def _product(a, b, c, i, j):
    return a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + (a[i] + b[i] + c[i]) * (a[j] + b[j] + c[j])


@inlined_law
def _with_triangle(sums, area, a, b, c):
    """Add a triangle of the waterplane to the sums."""
    third, twelfth, q = area / 3.0, area / 12.0, sums
    return (
        q[0], q[1], q[2], q[3], q[4], q[5] + area,
        q[6] + third * (a[0] + b[0] + c[0]), q[7] + third * (a[1] + b[1] + c[1]), q[8] + third * (a[2] + b[2] + c[2]),
        q[9] + twelfth * _product(a, b, c, X, X), q[10] + twelfth * _product(a, b, c, X, Y),
        q[11] + twelfth * _product(a, b, c, X, Z), q[12] + twelfth * _product(a, b, c, Y, Y),
        q[13] + twelfth * _product(a, b, c, Y, Z), q[14] + twelfth * _product(a, b, c, Z, Z),
    )  # fmt: skip


@inlined_law
def _ordered(a, b):
    return (a, b) if a[3] >= b[3] else (b, a)


@law
def _with_cut(sums, volume, p0, p1, p2, p3):
    """Add what is under water of a tetrahedron of a volume, with corners (x, y, z, depth)."""
    a, b = _ordered(p0, p1)
    c, d = _ordered(p2, p3)
    a, c = _ordered(a, c)
    b, d = _ordered(b, d)
    b, c = _ordered(b, c)
    if a[3] <= 0.0:
        return sums
    if d[3] >= 0.0:
        return _with_tetrahedron(sums, volume, a, b, c, d)
    if b[3] <= 0.0:  # a alone is under water
        (pb, rb), (pc, rc), (pd, rd) = _between(a, b), _between(a, c), _between(a, d)
        part = volume * rb * rc * rd
        return _with_triangle(_with_tetrahedron(sums, part, a, pb, pc, pd), 3.0 * part / a[3], pb, pc, pd)
    if c[3] > 0.0:  # d alone is above it
        (pa, ra), (pb, rb), (pc, rc) = _between(d, a), _between(d, b), _between(d, c)
        part = volume * ra * rb * rc
        sums = _with_tetrahedron(_with_tetrahedron(sums, volume, a, b, c, d), -part, d, pa, pb, pc)
        return _with_triangle(sums, -3.0 * part / d[3], pa, pb, pc)
    (ac, r_ac), (ad, r_ad), (bc, r_bc), (bd, r_bd) = _between(a, c), _between(a, d), _between(b, c), _between(b, d)
    sums = _with_tetrahedron(sums, volume * r_bc * r_bd, a, b, bc, bd)
    sums = _with_tetrahedron(sums, volume * r_ac * r_ad * (1.0 - r_bd), a, ac, ad, bd)
    sums = _with_tetrahedron(sums, volume * r_ac * (1.0 - r_bc) * r_bd, a, ac, bc, bd)
    per_depth = 3.0 * volume / (a[3] - d[3])
    sums = _with_triangle(sums, per_depth * r_ac * (1.0 - r_bd), ad, ac, bd)
    return _with_triangle(sums, per_depth * abs(r_bc * (r_ac - 1.0 + r_bd) - r_ac * r_bd), ac, bc, bd)


@law
def box_immersed(c, n, edges):
    """`Immersed` of a box.

    Parameters
    ----------
    c : float64 [m]
        Height of its centre above the surface.
    n : tuple of 3 float64
        Vertical components of its axes.
    edges : tuple of 3 float64 [m]

    Returns
    -------
    Immersed
    """
    volume = edges[0] * edges[1] * edges[2]
    reach = 0.5 * (abs(n[0]) * edges[0] + abs(n[1]) * edges[1] + abs(n[2]) * edges[2])
    flat = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if c >= reach:
        return Immersed(0.0, (0.0, 0.0, 0.0, 0.0), flat)
    if c <= -reach:
        return Immersed(-c * volume, (-volume, 0.0, 0.0, 0.0), flat)
    x, y, z = 0.5 * edges[0], 0.5 * edges[1], 0.5 * edges[2]
    u, v, w = n[0] * edges[0], n[1] * edges[1], n[2] * edges[2]
    first = -c + 0.5 * (u + v + w)  # the depth of the corner (-x, -y, -z)
    p0, p7 = (-x, -y, -z, first), (x, y, z, first - u - v - w)
    px, py, pz = (x, -y, -z, first - u), (-x, y, -z, first - v), (-x, -y, z, first - w)
    pxy, pxz, pyz = (x, y, -z, first - u - v), (x, -y, z, first - u - w), (-x, y, z, first - v - w)
    sums, sixth = NOTHING, volume / 6.0
    sums = _with_cut(sums, sixth, p0, px, pxy, p7)
    sums = _with_cut(sums, sixth, p0, px, pxz, p7)
    sums = _with_cut(sums, sixth, p0, py, pxy, p7)
    sums = _with_cut(sums, sixth, p0, py, pyz, p7)
    sums = _with_cut(sums, sixth, p0, pz, pxz, p7)
    sums = _with_cut(sums, sixth, p0, pz, pyz, p7)
    return Immersed(
        sums[0], (-sums[1], -sums[2], -sums[3], -sums[4]),
        (sums[5], sums[6], sums[7], sums[8], sums[9], sums[10], sums[11], sums[12], sums[13], sums[14]),
    )  # fmt: skip
