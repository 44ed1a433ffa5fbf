"""Compiled evaluation of waves: of a regular wave alone, or of a sum of them, each by the function of its kind.

Waves of small height add up. Wheeler's stretching Z = (z - eta)/(1 + eta/depth), with the elevation eta of all waves and z above
the still surface, moves the velocities that the theory gives at the still surface to the instantaneous surface. Above that Z is 0,
so that the velocities are those at the surface. The acceleration is the derivative of the velocity in time at constant Z.

Source: DNV-RP-C205 (2010), 3.3.2; Wheeler, J. Petrol. Technol. 22 (1970) 359.
"""

from collections.abc import Sequence

import numpy as np
from numba import types

from anet_lumped.checks import SceneError
from anet_lumped.compiled.addresses import address_of, callable_at
from anet_lumped.compiled.jit import kernel

from .airy import Airy
from .base import Wave
from .superposition import numbers, superposition

_vector, _matrix = types.UniTuple(types.float64, 3), types.UniTuple(types.float64, 9)
_f1 = types.Array(types.float64, 1, "C")
MOTION = types.Tuple((types.UniTuple(types.float64, 4), _vector, _matrix, _vector, _matrix))(*(types.float64,) * 4, _f1)
as_motion = callable_at(MOTION)
AT_REST = ((0.0,) * 4, (0.0,) * 3, (0.0,) * 9, (0.0,) * 3, (0.0,) * 9)


def pack(waves: Wave | Sequence[Wave], g: float, level: float) -> np.ndarray:
    """Numbers that `wave_at` reads, (k,) float64, of one or several waves; none for no waves.

    Parameters
    ----------
    waves : Wave or sequence of Wave
        They have one depth and one ramp, see `base.check_waves`.
    g : float [m/s2], gravity
    level : float [m], z of the still surface

    Returns
    -------
    (k,) float64
        The address of a function, and the numbers that it reads. An address is a whole number below 2^48, so that it keeps all its
        digits as a float64.

    Raises
    ------
    SceneError : no gravity, a wave that would break, or too many of them
    """
    several = (waves,) if isinstance(waves, Wave) else tuple(waves)
    if not several:
        return np.zeros(0)
    if len(several) == 1 and isinstance(several[0], Airy):
        return np.array([address_of(several[0].kernel(), MOTION), *several[0].numbers(g, level)])
    if not g > 0.0:
        raise SceneError(f"A wave needs gravity, but wave {type(several[0]).__name__} has g={g} m/s2.")
    return np.array([address_of(superposition, MOTION), *numbers(several, g, level)])


@kernel(MOTION)
def wave_at(t, x, y, z, wave):
    """Surface, velocity and acceleration of waves at a time and place.

    Parameters
    ----------
    t : float64 [s]
    x, y, z : float64 [m]
    wave : (k,) float64, or (0,) for water at rest
        From `pack`.

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
    return as_motion(int(wave[0]))(t, x, y, z, wave[1:])
