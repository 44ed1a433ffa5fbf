"""Compiled evaluation of a wave.

Of linear theory, with theta = k s - omega t + phase, the amplitude a grown by r(t), and Z the stretched depth,

    eta = r a cos(theta) ,
    u = r a omega cosh(k (Z + depth))/sinh(k depth) cos(theta) ,    w = r a omega sinh(k (Z + depth))/sinh(k depth) sin(theta) ,

and the acceleration is the change in time of (u, w) at the same Z. Wheeler's stretching Z = (z - eta)/(1 + eta/depth) brings what
the theory says of the still surface to the instantaneous one; above that Z is 0, so that the velocities are those of the surface.
Source: DNV-RP-C205 (2010), 3.3.2; Wheeler, J. Petrol. Technol. 22 (1970) 359.
"""

import math

from numba import types

from anet_lumped.compiled.jit import njit
from anet_lumped.prescribed.smoothstep_kernel import ramped

_vector, _matrix = types.UniTuple(types.float64, 3), types.UniTuple(types.float64, 9)
_f1 = types.Array(types.float64, 1, "C")
AT_REST = ((0.0,) * 4, (0.0,) * 3, (0.0,) * 9, (0.0,) * 3, (0.0,) * 9)


@njit(cache=True, forceinline=True)
def _along(x, y, of_s, of_z, ws, wz):
    """Gradient (9) of a velocity of components along (x, y) and up, from their slopes along (x, y) and in z."""
    return (x * x * of_s, x * y * of_s, x * of_z, x * y * of_s, y * y * of_s, y * of_z, x * ws, y * ws, wz)


@njit(
    types.Tuple((types.UniTuple(types.float64, 4), _vector, _matrix, _vector, _matrix))(*(types.float64,) * 4, _f1),
    cache=True, error_model="numpy", fastmath={"contract"},
)  # fmt: skip
def wave_at(t, x, y, z, wave):
    """Surface, velocity and acceleration of a wave at a time and place.

    Parameters
    ----------
    t : float64 [s]
    x, y, z : float64 [m]
    wave : (9,) float64
        From `waves.Airy.numbers`; of no length: water at rest.

    Returns
    -------
    surface : 4 float64 [m], [m/s], [1], [1]
        Elevation eta, its rate, and its slopes in x and y.
    velocity : 3 float64 [m/s]
    gradient : 9 float64 [1/s]
        Slope of the first component in x, y, z, then of the second and the third.
    acceleration : 3 float64 [m/s2]
    its gradient : 9 float64 [1/s2]

    Source
    ------
    See the module.
    """
    if len(wave) == 0:
        return AT_REST
    amplitude, k, omega, X, Y, depth = wave[0], wave[1], wave[2], wave[4], wave[5], wave[6]
    theta = k * (X * x + Y * y) - omega * t + wave[3]
    c, s = math.cos(theta), math.sin(theta)
    grown, growing, _ = ramped(t, wave[7])
    a, da = grown * amplitude, growing * amplitude
    eta, eta_s = a * c, -a * k * s
    per = 1.0 / (1.0 + eta / depth)
    Z = (z - wave[8] - eta) * per
    of_z, of_eta = per, -per * (1.0 + Z / depth)
    if Z > 0.0:
        Z, of_z, of_eta = 0.0, 0.0, 0.0
    elif Z < -depth:
        Z, of_z, of_eta = -depth, 0.0, 0.0
    up, down, bottom = math.exp(k * Z), math.exp(-k * (Z + 2.0 * depth)), 1.0 / (1.0 - math.exp(-2.0 * k * depth))
    C, S = (up + down) * bottom, (up - down) * bottom  # cosh and sinh over sinh(k depth); dC/dZ = k S, dS/dZ = k C
    Cz, Sz, Cs, Ss = k * S * of_z, k * C * of_z, k * S * of_eta * eta_s, k * C * of_eta * eta_s
    o = omega
    p, q = a * o * c, a * o * s  # u = p C, w = q S
    pt, qt = a * o * o * s + da * o * c, -a * o * o * c + da * o * s
    ps, qs, pts, qts = -k * q, k * p, k * (a * o * o * c - da * o * s), k * (a * o * o * s + da * o * c)
    u, w, ut, wt = p * C, q * S, pt * C, qt * S
    return (
        (eta, da * c + a * o * s, X * eta_s, Y * eta_s),
        (X * u, Y * u, w),
        _along(X, Y, ps * C + p * Cs, p * Cz, qs * S + q * Ss, q * Sz),
        (X * ut, Y * ut, wt),
        _along(X, Y, pts * C + pt * Cs, pt * Cz, qts * S + qt * Ss, qt * Sz),
    )
