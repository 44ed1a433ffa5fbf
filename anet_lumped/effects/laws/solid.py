"""The depth of a place in a solid: a core, with all that is nearer to it than a rounding r.

In the axes of the solid, u are coordinates that are not negative: distances from its centre along each axis, or from several axes
at once (`merged`: the distance from the axis of a cylinder, from the centre of a sphere). The core is u_j <= c_j, and

    s = r - |w| + kappa ,    w_j = max(u_j - c_j, 0) ,    kappa = max(min(c_j - u_j), 0) .

So outside of the core s is r less the distance from the core, and in it r plus the distance to its nearest face. s is negative
outside of the solid, with |grad s| = 1.

Between two places a and b, with D = b - a, the gradient G has G . D = s_b - s_a exactly, as a discrete gradient should, and no
difference is divided by a small one where the surface is smooth:

    u_b - u_a = (x_a + x_b)/(u_a + u_b) . D ,    |w_b| - |w_a| = (w_a + w_b)/(|w_a| + |w_b|) . (w_b - w_a) ,

w_b - w_a by the secants of the ramps, and kappa one coordinate after the other, b replacing a (Itoh & Abe). With a = b, G is the
gradient and 2 dG/db the matrix of second derivatives.
Source: Itoh & Abe, J. Comput. Phys. 76 (1988) 85; Gonzalez, J. Nonlinear Sci. 6 (1996) 449, for discrete gradients.

``params`` holds `NUMBERS` numbers from ``first`` on: the centre [m], the three axes, `merged`, three c [m], and r [m].
"""

import math
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.compiled.jit import inlined_law, law

NUMBERS = 17
OUTSIDE = -1  # instead of the number of the nearest face of the core
X, Y, Z = np.arange(3)  # numbers of axes; for a literal 0, 1 or 2 Numba would compile anew each function that it is passed to


class Between(NamedTuple):
    """G (3,); the gradient at b (3,); dG/db (3, 3) [1/m], a row for each component of G."""

    G: Any
    at_end: Any
    turning: Any


def numbers_of(at: Any, solid: Any) -> np.ndarray:
    """Numbers of a `shapes.base.Solid` at a place (3,) [m], for the functions below, (17,)."""
    return np.array([*at, *np.ravel(solid.rows), solid.merged, *solid.core, solid.rounding], float)


@law
def _seen(q, i, params, first):
    """Place of a node from the centre, in the axes of the solid [m]."""
    x, y, z = q[i, 0] - params[first], q[i, 1] - params[first + 1], q[i, 2] - params[first + 2]
    return (
        params[first + 3] * x + params[first + 4] * y + params[first + 5] * z,
        params[first + 6] * x + params[first + 7] * y + params[first + 8] * z,
        params[first + 9] * x + params[first + 10] * y + params[first + 11] * z,
    )


@law
def _coordinates(x, merged):
    """u of the module's docstring [m]."""
    if merged == 1.0:
        return abs(x[0]), abs(x[1]), abs(x[2])
    if merged == 2.0:
        return math.sqrt(x[0] * x[0] + x[1] * x[1]), abs(x[2]), 0.0
    return math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), 0.0, 0.0


@law
def _coordinate_of_axis(merged, x):
    """Number of the coordinate that measures along an axis."""
    return x if merged == 1.0 else (x // 2 if merged == 2.0 else 0)


@law
def _beyond(u, core):
    """w [m] and its length."""
    w = max(u[0] - core[0], 0.0), max(u[1] - core[1], 0.0), max(u[2] - core[2], 0.0)
    return w, math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])


@law
def _within(u0, u1, u2, core):
    """kappa [m], and the number of the nearest face of the core, `OUTSIDE` of it."""
    d0, d1, d2 = core[0] - u0, core[1] - u1, core[2] - u2
    least = min(d0, d1, d2)
    if least <= 0.0:
        return 0.0, OUTSIDE
    return least, (0 if d0 == least else (1 if d1 == least else 2))


@law
def _core(params, first):
    return params[first + 13], params[first + 14], params[first + 15]


@law
def depth(q, i, params, first):
    """s of a node [m]."""
    u, core = _coordinates(_seen(q, i, params, first), params[first + 12]), _core(params, first)
    return params[first + 16] - _beyond(u, core)[1] + _within(u[0], u[1], u[2], core)[0]


@inlined_law
def _item(three, j):
    """The item j of three, without an index: for one that varies Numba writes code that may raise."""
    return three[0] if j == 0 else (three[1] if j == 1 else three[2])


@law
def _one(a, b):
    return 1.0 if a == b else 0.0


@law
def _ramp(u_a, u_b, core):
    """Secant of w over u, and its slope in u_b [1/m]."""
    inside_a, inside_b = u_a <= core, u_b <= core
    if inside_a == inside_b:
        return (0.0 if inside_b else 1.0), 0.0
    secant = (max(u_b - core, 0.0) - max(u_a - core, 0.0)) / (u_b - u_a)
    return secant, ((0.0 if inside_b else 1.0) - secant) / (u_b - u_a)


@law
def _secant_within(j, k, u_a, u_b, core):
    """Secant of kappa over u_j, after the coordinates before j, and its slope in u_b[k] [1/m]."""
    before, face_before = _within(u_b[0] if j > 0 else u_a[0], u_b[1] if j > 1 else u_a[1], u_a[2], core)
    after, face = _within(u_b[0], u_b[1] if j > 0 else u_a[1], u_b[2] if j > 1 else u_a[2], core)
    if face == face_before:
        return -_one(face, j), 0.0
    change = _item(u_b, j) - _item(u_a, j)
    secant = (after - before) / change
    slope = (_one(face_before, k) if k < j else 0.0) - (_one(face, k) if k <= j else 0.0)
    return secant, (slope - _one(j, k) * secant) / change


@law
def _row(j, u_a, u_b, core):
    """Secant of s over u_j, the slope of s in u_j at b, and the slopes of the secant in u_b (3,) [1/m]."""
    (w_a, L_a), (w_b, L_b), (_, face) = _beyond(u_a, core), _beyond(u_b, core), _within(u_b[0], u_b[1], u_b[2], core)
    per, per_b = (1.0 / (L_a + L_b) if L_a + L_b > 0.0 else 0.0), (1.0 / L_b if L_b > 0.0 else 0.0)
    e, (ramp, of_ramp) = per * (_item(w_a, j) + _item(w_b, j)), _ramp(_item(u_a, j), _item(u_b, j), _item(core, j))
    within, to_0 = _secant_within(j, X, u_a, u_b, core)
    to_1, to_2 = _secant_within(j, Y, u_a, u_b, core)[1], _secant_within(j, Z, u_a, u_b, core)[1]
    turning = (
        to_0 - _turned(j, X, e, ramp * per, per_b * w_b[0]),
        to_1 - _turned(j, Y, e, ramp * per, per_b * w_b[1]),
        to_2 - _turned(j, Z, e, ramp * per, per_b * w_b[2]),
    )
    own = e * of_ramp
    turning = turning[0] - own * _one(j, X), turning[1] - own * _one(j, Y), turning[2] - own * _one(j, Z)
    return within - e * ramp, -per_b * _item(w_b, j) - _one(face, j), turning


@law
def _turned(j, k, e, weight, n):
    """How (w_a + w_b)_j/(|w_a| + |w_b|) = e changes with u_b[k], ``n`` being w_b[k]/|w_b|, times a weight; 0 where w_b[k] is."""
    return weight * (_one(j, k) - e * n) if n > 0.0 else 0.0


@law
def _along(k, l, x_a, x_b, u, rows):
    """Along the axes k and l of the solid: G and the gradient at b along k, and dG_k/dx_b[l]; ``u`` are merged, u_a and u_b."""
    merged, u_a, u_b = u
    i, j = _coordinate_of_axis(merged, k), _coordinate_of_axis(merged, l)
    u_i, x_k, (g, at_end, turning) = _item(u_b, i), _item(x_b, k), _item(rows, i)
    both = _item(u_a, i) + u_i
    e = (_item(x_a, k) + x_k) / both if both > 0.0 else 0.0
    u_j = _item(u_b, j)
    n_k, n_l = (x_k / u_i if u_i > 0.0 else 0.0), (_item(x_b, l) / u_j if u_j > 0.0 else 0.0)
    slope = _item(turning, j) * e * n_l
    if both > 0.0:
        slope += g * (_one(k, l) - _one(i, j) * e * n_l) / both
    return g * e, at_end * n_k, slope


@law
def _back(a, params, first):
    """A vector in the axes of the solid, in those of the world."""
    return (
        params[first + 3] * a[0] + params[first + 6] * a[1] + params[first + 9] * a[2],
        params[first + 4] * a[0] + params[first + 7] * a[1] + params[first + 10] * a[2],
        params[first + 5] * a[0] + params[first + 8] * a[1] + params[first + 11] * a[2],
    )


@law
def between(base, q, i, params, first):
    """`Between` of the places of a node in ``base`` and in ``q``."""
    x_a, x_b, core = _seen(base, i, params, first), _seen(q, i, params, first), _core(params, first)
    merged = params[first + 12]
    u_a, u_b = _coordinates(x_a, merged), _coordinates(x_b, merged)
    rows = _row(X, u_a, u_b, core), _row(Y, u_a, u_b, core), _row(Z, u_a, u_b, core)
    u = merged, u_a, u_b
    xx, xy, xz = _along(X, X, x_a, x_b, u, rows), _along(X, Y, x_a, x_b, u, rows), _along(X, Z, x_a, x_b, u, rows)
    yx, yy, yz = _along(Y, X, x_a, x_b, u, rows), _along(Y, Y, x_a, x_b, u, rows), _along(Y, Z, x_a, x_b, u, rows)
    zx, zy, zz = _along(Z, X, x_a, x_b, u, rows), _along(Z, Y, x_a, x_b, u, rows), _along(Z, Z, x_a, x_b, u, rows)
    x, y, z = (  # rows of dG/db along the axes of the solid, with columns along those of the world
        _back((xx[2], xy[2], xz[2]), params, first),
        _back((yx[2], yy[2], yz[2]), params, first),
        _back((zx[2], zy[2], zz[2]), params, first),
    )
    of_x, of_y, of_z = (
        _back((x[0], y[0], z[0]), params, first),
        _back((x[1], y[1], z[1]), params, first),
        _back((x[2], y[2], z[2]), params, first),
    )
    turning = (of_x[0], of_y[0], of_z[0]), (of_x[1], of_y[1], of_z[1]), (of_x[2], of_y[2], of_z[2])
    G, at_end = _back((xx[0], yy[0], zz[0]), params, first), _back((xx[1], yy[1], zz[1]), params, first)
    return Between(G, at_end, turning)
