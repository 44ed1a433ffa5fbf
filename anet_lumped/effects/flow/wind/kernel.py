"""Compiled evaluation of the winds of a scene: the sum of their velocities, each by the function of its kind."""

from collections.abc import Sequence

import numpy as np
from numba import types

from anet_lumped.compiled.addresses import address_of, callable_at
from anet_lumped.compiled.jit import kernel

from .base import Wind, as_winds

_f1 = types.Array(types.float64, 1, "C")
VELOCITY = types.Tuple((types.UniTuple(types.float64, 3), types.UniTuple(types.float64, 9)))(*(types.float64,) * 4, _f1)
as_velocity = callable_at(VELOCITY)
HEADER = 2  # numbers in front of the numbers of each wind: the address of its function, and how many numbers it has


def pack(winds: Wind | Sequence[Wind] | None) -> np.ndarray:
    """Numbers of None, one or several winds, (k,) float64.

    For each wind they are the address of its function, how many numbers it has, and these numbers. An address is a whole number
    below 2^48, so that it keeps all its digits as a float64.
    """
    parts = [[address_of(wind.kernel(), VELOCITY), len(own := wind.numbers()), *own] for wind in as_winds(winds)]
    return np.concatenate([np.zeros(0), *parts])


@kernel(VELOCITY)
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
        Slopes of the first component in x, y, z, then of the second and of the third.
    """
    u, v, w = 0.0, 0.0, 0.0
    ux, uy, uz, vx, vy, vz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    first = 0
    while first < len(winds):
        after = first + HEADER + int(winds[first + 1])
        own, slope = as_velocity(int(winds[first]))(t, x, y, z, winds[first + HEADER : after])
        u, v, w = u + own[0], v + own[1], w + own[2]
        ux, uy, uz = ux + slope[0], uy + slope[1], uz + slope[2]
        vx, vy, vz = vx + slope[3], vy + slope[4], vz + slope[5]
        wx, wy, wz = wx + slope[6], wy + slope[7], wz + slope[8]
        first = after
    return (u, v, w), (ux, uy, uz, vx, vy, vz, wx, wy, wz)
