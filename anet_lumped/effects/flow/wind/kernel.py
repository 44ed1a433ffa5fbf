"""Compiled evaluation of the winds of a scene."""

import math

import numpy as np
from numba import njit, types

from .base import as_winds
from .dryden import Dryden
from .gust import Gust
from .profiles import Logarithmic, PowerLaw, Sampled, Uniform
from .recorded import Recorded

UNIFORM, POWER_LAW, LOGARITHMIC, GUST, DRYDEN, RECORDED, SAMPLED = range(7)
NUMBER = {
    Uniform: UNIFORM,
    PowerLaw: POWER_LAW,
    Logarithmic: LOGARITHMIC,
    Gust: GUST,
    Dryden: DRYDEN,
    Recorded: RECORDED,
    Sampled: SAMPLED,
}
LOWEST = 1e-6  # of the height of a power law; below, its slope, which has no bound at the ground, is that at it
_f1 = types.Array(types.float64, 1, "C")


def pack(winds):
    """(k,) float64: of each of None, one or several winds its number, how many numbers follow, and those."""
    parts = [(NUMBER[type(wind)], wind.numbers()) for wind in as_winds(winds)]
    return np.concatenate([np.zeros(0), *(np.concatenate([[number, len(of)], of]) for number, of in parts)])


@njit(cache=True, forceinline=True)
def _height(kind, z, of):
    """Speed of a profile over that of its reference, and its slope in height [1/m]."""
    if kind == POWER_LAW:
        ratio = (z - of[3]) / of[4]
        if ratio <= 0.0:
            return 0.0, 0.0
        return ratio ** of[5], of[5] * max(ratio, LOWEST) ** (of[5] - 1.0) / of[4]
    ratio = (z - of[3]) / of[4]
    if ratio <= 1.0:
        return 0.0, 0.0
    return math.log(ratio), 1.0 / (z - of[3])


@njit(cache=True, forceinline=True)
def _sampled(z, of):
    """Level velocity of a sampled profile, and its slope in height [1/s]."""
    last = len(of) - 3
    if z <= of[0]:
        return of[1], of[2], 0.0, 0.0
    for i in range(0, last, 3):
        if z < of[i + 3]:
            per = 1.0 / (of[i + 3] - of[i])
            uz, vz, up = per * (of[i + 4] - of[i + 1]), per * (of[i + 5] - of[i + 2]), z - of[i]
            return of[i + 1] + up * uz, of[i + 2] + up * vz, uz, vz
    return of[last + 1], of[last + 2], 0.0, 0.0


@njit(cache=True, forceinline=True)
def _gust(t, of):
    """Share of a gust's amplitude at a time."""
    s = (t - of[3]) / of[4]
    if s <= 0.0 or (s >= 2.0 and of[5] == 0.0):
        return 0.0
    if s >= 1.0 and of[5] != 0.0:
        return 1.0
    return 0.5 - 0.5 * math.cos(math.pi * s)


@njit(cache=True, forceinline=True)
def _recorded(t, of):
    """Velocity of a recorded wind."""
    count = int(of[0])
    low, high = 1, 1 + count
    while high - low > 1:
        middle = (low + high) // 2
        if of[middle] <= t:
            low = middle
        else:
            high = middle
    tau, c = max(t - of[low], 0.0), 1 + count + 12 * (low - 1)
    if low == count:
        tau = 0.0
    return (
        of[c] + tau * (of[c + 3] + tau * (of[c + 6] + tau * of[c + 9])),
        of[c + 1] + tau * (of[c + 4] + tau * (of[c + 7] + tau * of[c + 10])),
        of[c + 2] + tau * (of[c + 5] + tau * (of[c + 8] + tau * of[c + 11])),
    )


@njit(
    types.Tuple((types.UniTuple(types.float64, 3), types.UniTuple(types.float64, 9)))(*(types.float64,) * 4, _f1),
    cache=True, error_model="numpy", fastmath={"contract"},
)  # fmt: skip
def wind_at(t, x, y, z, winds):
    """Velocity of air or water at a time and place, and its gradient: the sum over winds.

    Parameters
    ----------
    t : float64 [s]
    x, y, z : float64 [m]
    winds : (k,) float64
        From `pack`.

    Returns
    -------
    velocity : 3 float64 [m/s]
    gradient : 9 float64 [1/s]
        Slope of the first component in x, y, z, then of the second and the third.
    """
    u, v, w = 0.0, 0.0, 0.0
    ux, uy, uz, vx, vy, vz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    at = 0
    while at < len(winds):
        kind, count = int(winds[at]), int(winds[at + 1])
        of = winds[at + 2 : at + 2 + count]
        at += 2 + count
        if kind == UNIFORM:
            u, v, w = u + of[0], v + of[1], w + of[2]
        elif kind == POWER_LAW or kind == LOGARITHMIC:
            share, slope = _height(kind, z, of)
            u, v, w = u + share * of[0], v + share * of[1], w + share * of[2]
            uz, vz, wz = uz + slope * of[0], vz + slope * of[1], wz + slope * of[2]
        elif kind == GUST:
            share = _gust(t, of)
            u, v, w = u + share * of[0], v + share * of[1], w + share * of[2]
        elif kind == SAMPLED:
            a, b, az, bz = _sampled(z, of)
            u, v, uz, vz = u + a, v + b, uz + az, vz + bz
        elif kind == RECORDED:
            a, b, c = _recorded(t, of)
            u, v, w = u + a, v + b, w + c
        else:
            X, Y, Z = x - of[0] * t, y - of[1] * t, z - of[2] * t
            for m in range(3, count, 9):
                kx, ky, kz = of[m], of[m + 1], of[m + 2]
                phase = kx * X + ky * Y + kz * Z
                cosine, sine = math.cos(phase), math.sin(phase)
                u += of[m + 3] * cosine + of[m + 6] * sine
                v += of[m + 4] * cosine + of[m + 7] * sine
                w += of[m + 5] * cosine + of[m + 8] * sine
                du = of[m + 6] * cosine - of[m + 3] * sine
                dv = of[m + 7] * cosine - of[m + 4] * sine
                dw = of[m + 8] * cosine - of[m + 5] * sine
                ux, uy, uz = ux + du * kx, uy + du * ky, uz + du * kz
                vx, vy, vz = vx + dv * kx, vy + dv * ky, vz + dv * kz
                wx, wy, wz = wx + dw * kx, wy + dw * ky, wz + dw * kz
    return (u, v, w), (ux, uy, uz, vx, vy, vz, wx, wy, wz)
