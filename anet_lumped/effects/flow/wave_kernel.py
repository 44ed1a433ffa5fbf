"""Compiled evaluation of a wave.

By linear theory, with the phase angle theta = k s - omega t + phase, the amplitude a times its growth r(t), and the stretched
height Z of a place, the elevation eta of the surface and the velocities u along the wave and w upwards are

    eta = r a cos(theta) ,
    u = r a omega cosh(k (Z + depth))/sinh(k depth) cos(theta) ,    w = r a omega sinh(k (Z + depth))/sinh(k depth) sin(theta) ,

The acceleration is the derivative of (u, w) in time at constant Z. Wheeler's stretching Z = (z - eta)/(1 + eta/depth), with z above
the still surface, moves the velocities that the theory gives at the still surface to the instantaneous surface. Above that Z is 0,
so that the velocities are those at the surface. Source: DNV-RP-C205 (2010), 3.3.2; Wheeler, J. Petrol. Technol. 22 (1970) 359.
"""

import math

from numba import types

from anet_lumped.compiled.jit import njit
from anet_lumped.prescribed.smoothstep_kernel import ramped

_vector, _matrix = types.UniTuple(types.float64, 3), types.UniTuple(types.float64, 9)
_f1 = types.Array(types.float64, 1, "C")
AT_REST = ((0.0,) * 4, (0.0,) * 3, (0.0,) * 9, (0.0,) * 3, (0.0,) * 9)


@njit(cache=True, forceinline=True)
def _gradient(X, Y, u_s, u_z, w_s, w_z):
    """Gradient (9,) of a velocity with the component u along the level unit vector (X, Y) and w upwards.

    Its slopes are those along (X, Y), with suffix s, and those in z.
    """
    return (X * X * u_s, X * Y * u_s, X * u_z, X * Y * u_s, Y * Y * u_s, Y * u_z, X * w_s, Y * w_s, w_z)


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
    wave : (9,) float64, or (0,) for water at rest
        From `waves.Airy.numbers`.

    Returns
    -------
    surface : 4 float64 [m], [m/s], [1], [1]
        Elevation eta, its rate, and its slopes in x and y.
    velocity : 3 float64 [m/s]
    gradient : 9 float64 [1/s]
        Slopes of the first component in x, y, z, then of the second and of the third.
    acceleration : 3 float64 [m/s2]
    acceleration_gradient : 9 float64 [1/s2]

    Source
    ------
    See the module.
    """
    if len(wave) == 0:
        return AT_REST
    amplitude, k, omega, start_phase, X, Y = wave[0], wave[1], wave[2], wave[3], wave[4], wave[5]
    depth, ramp, still_level = wave[6], wave[7], wave[8]
    theta = k * (X * x + Y * y) - omega * t + start_phase
    c, s = math.cos(theta), math.sin(theta)
    growth, growth_rate, _ = ramped(t, ramp)
    a, a_t = growth * amplitude, growth_rate * amplitude
    eta, eta_s = a * c, -a * k * s
    per_stretch = 1.0 / (1.0 + eta / depth)
    Z = (z - still_level - eta) * per_stretch
    Z_z, Z_eta = per_stretch, -per_stretch * (1.0 + Z / depth)
    if Z > 0.0:
        Z, Z_z, Z_eta = 0.0, 0.0, 0.0
    elif Z < -depth:
        Z, Z_z, Z_eta = -depth, 0.0, 0.0
    up, down, bottom = math.exp(k * Z), math.exp(-k * (Z + 2.0 * depth)), 1.0 / (1.0 - math.exp(-2.0 * k * depth))
    C, S = (up + down) * bottom, (up - down) * bottom  # cosh and sinh over sinh(k depth); dC/dZ = k S, dS/dZ = k C
    Cz, Sz, Cs, Ss = k * S * Z_z, k * C * Z_z, k * S * Z_eta * eta_s, k * C * Z_eta * eta_s
    o = omega
    p, q = a * o * c, a * o * s  # u = p C, w = q S; below, the suffixes t, s and z mark their derivatives
    pt, qt = a * o * o * s + a_t * o * c, -a * o * o * c + a_t * o * s
    ps, qs, pts, qts = -k * q, k * p, k * (a * o * o * c - a_t * o * s), k * (a * o * o * s + a_t * o * c)
    u, w, ut, wt = p * C, q * S, pt * C, qt * S
    return (
        (eta, a_t * c + a * o * s, X * eta_s, Y * eta_s),
        (X * u, Y * u, w),
        _gradient(X, Y, ps * C + p * Cs, p * Cz, qs * S + q * Ss, q * Sz),
        (X * ut, Y * ut, wt),
        _gradient(X, Y, pts * C + pt * Cs, pt * Cz, qts * S + qt * Ss, qt * Sz),
    )
