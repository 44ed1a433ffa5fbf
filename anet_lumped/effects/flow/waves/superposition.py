"""A sum of regular waves, evaluated in compiled code.

    eta = r (m + sum a cos(theta)) ,    u = r sum a omega cosh(k (Z + depth))/sinh(k depth) cos(theta) (d_x, d_y) ,
    w = r sum a omega sinh(k (Z + depth))/sinh(k depth) sin(theta) ,    theta = k (d_x x + d_y y) - omega t + phase ,

with the growth r(t), a constant elevation m, and the stretched height Z of `kernel`, by the elevation of all waves together. One
evaluation takes some 13 ns for each wave, and half of that at depths that its motion does not reach. Waves are sorted by their
length, so that those come last, and a processor adds several at once.
"""

import math
from collections.abc import Sequence

import numpy as np

from anet_lumped.checks import SceneError
from anet_lumped.compiled.jit import sum_on_demand
from anet_lumped.effects.laws.sine import exponential, sine_and_cosine
from anet_lumped.prescribed.smoothstep_kernel import ramped

from .base import AMPLITUDE, FREQUENCY, PHASE, Wave, highest_wave, wave_number

HEADER, ROW = 4, 8  # numbers in front of those of the waves; of each wave
MOST = 5000  # waves in one sum
STILL = -40.0  # k Z from where on down a wave moves the water less than rounding does at the surface, exp(-40) = 4e-18


def numbers(waves: Sequence[Wave], g: float, level: float) -> np.ndarray:
    """Numbers that `superposition` reads.

    Returns
    -------
    (4 + 8 n,) float64
        Depth [m], ramp [s], level of the still surface and constant elevation [m]; of all regular waves, from the longest on, their
        amplitudes [m], wave numbers [rad/m], circular frequencies [rad/s], phases [rad], both components of the level unit vector,
        e = exp(-2 k depth) and 1/(1 - e).

    Raises
    ------
    SceneError : a wave that would break, or too many of them
    """
    depth, ramp = waves[0].depth, waves[0].ramp
    mean, table = 0.0, []
    for wave in waves:
        owner = f"wave {type(wave).__name__}"
        rows = wave.rows(g)
        moving = rows[:, FREQUENCY] > 0.0
        mean += float(np.sum(rows[~moving, AMPLITUDE] * np.cos(rows[~moving, PHASE])))
        for row in rows[moving & (rows[:, AMPLITUDE] != 0.0)]:
            k = wave_number(row[FREQUENCY], depth, g)
            highest = highest_wave(k, depth)
            if 2.0 * abs(row[AMPLITUDE]) > highest:
                raise SceneError(
                    f"A wave of a period of {2.0 * math.pi / row[FREQUENCY]:.4g} s must be lower than {highest:.4g} m, where it "
                    f"breaks, but {owner} has one of {2.0 * abs(row[AMPLITUDE]):.4g} m."
                )
            mirror = -2.0 * k * depth
            table.append([row[AMPLITUDE], k, *row[FREQUENCY:], math.exp(mirror), -1.0 / math.expm1(mirror)])
    if len(table) > MOST:
        raise SceneError(f"At most {MOST} regular waves may add up, but the waves of {owner} are {len(table)}.")
    if abs(mean) >= depth:
        raise SceneError(f"A constant elevation must be less than the depth of {depth:.4g} m, but {owner} has {mean:.4g} m.")
    table.sort(key=lambda row: row[1])
    return np.array([depth, ramp, level, mean, *np.array(table).T.ravel()])


@sum_on_demand
def superposition(t, x, y, z, waves):
    """Surface, velocity and acceleration of a sum of waves, as `kernel.wave_at` returns them."""
    depth, ramp, still_level, mean = waves[0], waves[1], waves[2], waves[3]
    growth, growth_rate, _ = ramped(t, ramp)
    n = (len(waves) - HEADER) // ROW
    amplitudes, numbers_k, omegas = (
        waves[HEADER : HEADER + n],
        waves[HEADER + n : HEADER + 2 * n],
        waves[HEADER + 2 * n : HEADER + 3 * n],
    )
    phases, alongs_x = waves[HEADER + 3 * n : HEADER + 4 * n], waves[HEADER + 4 * n : HEADER + 5 * n]
    alongs_y, mirrors, spreads = (
        waves[HEADER + 5 * n : HEADER + 6 * n],
        waves[HEADER + 6 * n : HEADER + 7 * n],
        waves[HEADER + 7 * n :],
    )
    eta, eta_t, eta_x, eta_y = mean, 0.0, 0.0, 0.0
    for m in range(n):
        k, along_x, along_y = numbers_k[m], alongs_x[m], alongs_y[m]
        sine, cosine = sine_and_cosine(k * (along_x * x + along_y * y) - omegas[m] * t + phases[m])
        rise = amplitudes[m] * sine
        eta += amplitudes[m] * cosine
        eta_t += omegas[m] * rise
        eta_x -= k * along_x * rise
        eta_y -= k * along_y * rise
    eta, eta_t, eta_x, eta_y = growth * eta, growth * eta_t + growth_rate * eta, growth * eta_x, growth * eta_y
    per_stretch = 1.0 / (1.0 + eta / depth)
    Z = (z - still_level - eta) * per_stretch
    Z_z, Z_eta = per_stretch, -per_stretch * (1.0 + Z / depth)
    if Z > 0.0:
        Z, Z_z, Z_eta = 0.0, 0.0, 0.0
    elif Z < -depth:
        Z, Z_z, Z_eta = -depth, 0.0, 0.0
    # velocity and acceleration, and their slopes: in x and y at constant Z, and in Z
    u, v, w, u_x, u_y, v_y, w_x, w_y, u_Z, v_Z, w_Z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    p, q, r, p_x, p_y, q_y, r_x, r_y, p_Z, q_Z, r_Z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    while n > 0 and numbers_k[n - 1] * Z < STILL:
        n -= 1
    for m in range(n):
        k, omega, along_x, along_y = numbers_k[m], omegas[m], alongs_x[m], alongs_y[m]
        sine, cosine = sine_and_cosine(k * (along_x * x + along_y * y) - omega * t + phases[m])
        swing = amplitudes[m] * omega
        up = exponential(k * Z)
        down, spread = mirrors[m] / up, spreads[m]
        cosine, sine = swing * cosine, swing * sine
        cosh, sinh = spread * (up + down), spread * (up - down)
        C, S = cosine * cosh, sine * sinh  # u along the wave, w
        c, s = cosine * sinh, sine * cosh
        u, v, w = u + along_x * C, v + along_y * C, w + S
        u_x, u_y, v_y = u_x - k * along_x * along_x * s, u_y - k * along_x * along_y * s, v_y - k * along_y * along_y * s
        w_x, w_y = w_x + k * along_x * c, w_y + k * along_y * c
        u_Z, v_Z, w_Z = u_Z + k * along_x * c, v_Z + k * along_y * c, w_Z + k * s
        # the rate turns the cosine into omega times the sine, and the sine into -omega times the cosine
        C, S, c, s = omega * C, omega * S, omega * c, omega * s
        p, q, r = p + along_x * s, q + along_y * s, r - c
        p_x, p_y, q_y = p_x + k * along_x * along_x * C, p_y + k * along_x * along_y * C, q_y + k * along_y * along_y * C
        r_x, r_y = r_x + k * along_x * S, r_y + k * along_y * S
        p_Z, q_Z, r_Z = p_Z + k * along_x * S, q_Z + k * along_y * S, r_Z - k * C
    p, q, r = growth * p + growth_rate * u, growth * q + growth_rate * v, growth * r + growth_rate * w
    p_x, p_y, q_y = growth * p_x + growth_rate * u_x, growth * p_y + growth_rate * u_y, growth * q_y + growth_rate * v_y
    r_x, r_y = growth * r_x + growth_rate * w_x, growth * r_y + growth_rate * w_y
    p_Z, q_Z, r_Z = growth * p_Z + growth_rate * u_Z, growth * q_Z + growth_rate * v_Z, growth * r_Z + growth_rate * w_Z
    u_Z, v_Z, w_Z = growth * u_Z, growth * v_Z, growth * w_Z
    Z_x, Z_y = Z_eta * eta_x, Z_eta * eta_y
    return (
        (eta, eta_t, eta_x, eta_y),
        (growth * u, growth * v, growth * w),
        (
            growth * u_x + u_Z * Z_x, growth * u_y + u_Z * Z_y, u_Z * Z_z,
            growth * u_y + v_Z * Z_x, growth * v_y + v_Z * Z_y, v_Z * Z_z,
            growth * w_x + w_Z * Z_x, growth * w_y + w_Z * Z_y, w_Z * Z_z,
        ),
        (p, q, r),
        (
            p_x + p_Z * Z_x, p_y + p_Z * Z_y, p_Z * Z_z,
            p_y + q_Z * Z_x, q_y + q_Z * Z_y, q_Z * Z_z,
            r_x + r_Z * Z_x, r_y + r_Z * Z_y, r_Z * Z_z,
        ),
    )  # fmt: skip
