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

from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.prescribed.smoothstep_kernel import ramped

_vector, _matrix = types.UniTuple(types.float64, 3), types.UniTuple(types.float64, 9)
_f1 = types.Array(types.float64, 1, "C")
AT_REST = ((0.0,) * 4, (0.0,) * 3, (0.0,) * 9, (0.0,) * 3, (0.0,) * 9)


@inlined_law
def _gradient(along_x, along_y, u_s, u_z, w_s, w_z):
    """Gradient (9,) of a velocity with the component u along the level unit vector (along_x, along_y) and w upwards.

    Its slopes are those along it, with suffix s, and those in z.
    """
    return (
        along_x * along_x * u_s, along_x * along_y * u_s, along_x * u_z,
        along_x * along_y * u_s, along_y * along_y * u_s, along_y * u_z,
        along_x * w_s, along_y * w_s, w_z,
    )  # fmt: skip


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
    amplitude, k, omega, start_phase, along_x, along_y = wave[0], wave[1], wave[2], wave[3], wave[4], wave[5]
    depth, ramp, still_level = wave[6], wave[7], wave[8]
    theta = k * (along_x * x + along_y * y) - omega * t + start_phase
    cos, sin = math.cos(theta), math.sin(theta)
    growth, growth_rate, _ = ramped(t, ramp)
    height, height_rate = growth * amplitude, growth_rate * amplitude
    eta, eta_s = height * cos, -height * k * sin
    per_stretch = 1.0 / (1.0 + eta / depth)
    Z = (z - still_level - eta) * per_stretch
    Z_z, Z_eta = per_stretch, -per_stretch * (1.0 + Z / depth)
    if Z > 0.0:
        Z, Z_z, Z_eta = 0.0, 0.0, 0.0
    elif Z < -depth:
        Z, Z_z, Z_eta = -depth, 0.0, 0.0
    # cosh and sinh of k (Z + depth) over sinh(k depth), and their slopes; a suffix marks what a derivative is taken by
    up, down, bottom = math.exp(k * Z), math.exp(-k * (Z + 2.0 * depth)), 1.0 / (1.0 - math.exp(-2.0 * k * depth))
    cosh, sinh = (up + down) * bottom, (up - down) * bottom
    cosh_z, sinh_z, cosh_s, sinh_s = k * sinh * Z_z, k * cosh * Z_z, k * sinh * Z_eta * eta_s, k * cosh * Z_eta * eta_s
    # the velocity along the wave is swing_u cosh, that upwards swing_w sinh
    swing_u, swing_w = height * omega * cos, height * omega * sin
    swing_u_t = height * omega * omega * sin + height_rate * omega * cos
    swing_w_t = -height * omega * omega * cos + height_rate * omega * sin
    swing_u_s, swing_w_s = -k * swing_w, k * swing_u
    swing_u_ts = k * (height * omega * omega * cos - height_rate * omega * sin)
    swing_w_ts = k * (height * omega * omega * sin + height_rate * omega * cos)
    u, w, u_t, w_t = swing_u * cosh, swing_w * sinh, swing_u_t * cosh, swing_w_t * sinh
    return (
        (eta, height_rate * cos + height * omega * sin, along_x * eta_s, along_y * eta_s),
        (along_x * u, along_y * u, w),
        _gradient(
            along_x, along_y,
            swing_u_s * cosh + swing_u * cosh_s, swing_u * cosh_z, swing_w_s * sinh + swing_w * sinh_s, swing_w * sinh_z,
        ),
        (along_x * u_t, along_y * u_t, w_t),
        _gradient(
            along_x, along_y,
            swing_u_ts * cosh + swing_u_t * cosh_s, swing_u_t * cosh_z,
            swing_w_ts * sinh + swing_w_t * sinh_s, swing_w_t * sinh_z,
        ),
    )  # fmt: skip
