"""Rotation vectors phi: the axis times the angle [rad]; plain arithmetic, also compiled by `turning_kernel`.

Source: Cardona and Geradin, Int. J. Numer. Methods Engrg. 26 (1988) 2403, for the angular velocity of a rotation vector.
"""

import math
from typing import Any

import numpy as np

SMALL_ANGLE_SQUARED = 1e-4  # [rad2] below which the functions of the angle are summed from their series


def coefficients(s):
    """A = sin(a)/a, B = (1 - cos a)/a^2 and C = (1 - A)/a^2 for s = a^2, and their derivatives in s."""
    if s < SMALL_ANGLE_SQUARED:
        A = 1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0))
        B = 0.5 - s / 24.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0))
        C = 1.0 / 6.0 - s / 120.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0))
        dA = -1.0 / 6.0 + s / 60.0 * (1.0 - s / 28.0)
        dB = -1.0 / 24.0 + s / 360.0 * (1.0 - 3.0 * s / 112.0)
        dC = -1.0 / 120.0 + s / 2520.0 * (1.0 - s / 48.0)
        return A, B, C, dA, dB, dC
    a = math.sqrt(s)
    A, B = math.sin(a) / a, (1.0 - math.cos(a)) / s
    C = (1.0 - A) / s
    dA, dB = (math.cos(a) - A) / (2.0 * s), (A - 2.0 * B) / (2.0 * s)
    return A, B, C, dA, dB, -(dA + C) / s


def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def spin(phi, rate, second):
    """Angular velocity [rad/s] and acceleration [rad/s2] of the rotation phi with its derivatives in time, in the world's axes.

    omega = A phi' + B phi x phi' + C phi (phi . phi')
    """
    A, B, C, dA, dB, dC = coefficients(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2])
    along = phi[0] * rate[0] + phi[1] * rate[1] + phi[2] * rate[2]
    rate_square = rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2]
    along_rate = rate_square + phi[0] * second[0] + phi[1] * second[1] + phi[2] * second[2]
    ds = 2.0 * along
    across, across_rate = cross(phi, rate), cross(phi, second)
    omega = (
        A * rate[0] + B * across[0] + C * along * phi[0],
        A * rate[1] + B * across[1] + C * along * phi[1],
        A * rate[2] + B * across[2] + C * along * phi[2],
    )
    per_rate, per_phi = ds * dA + C * along, ds * dC * along + C * along_rate
    alpha = (
        A * second[0] + per_rate * rate[0] + B * across_rate[0] + ds * dB * across[0] + per_phi * phi[0],
        A * second[1] + per_rate * rate[1] + B * across_rate[1] + ds * dB * across[1] + per_phi * phi[1],
        A * second[2] + per_rate * rate[2] + B * across_rate[2] + ds * dB * across[2] + per_phi * phi[2],
    )
    return omega, alpha


def turned(phi, arm):
    """The vector ``arm`` after the rotation phi: arm + A phi x arm + B phi x (phi x arm)."""
    A, B, _, _, _, _ = coefficients(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2])
    once = cross(phi, arm)
    twice = cross(phi, once)
    return arm[0] + A * once[0] + B * twice[0], arm[1] + A * once[1] + B * twice[1], arm[2] + A * once[2] + B * twice[2]


def matrix_of(vector: Any) -> np.ndarray:
    """(3, 3) matrix of the rotation about ``vector`` (3,) by its length [rad]; its columns are the turned axes."""
    phi = tuple(map(float, vector))
    return np.array([turned(phi, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]).T


def turned_by(vector: Any, first: Any) -> tuple[float, float, float]:
    """Rotation vector (3,) of the rotation about ``first`` followed by that about ``vector``."""
    from scipy.spatial.transform import Rotation

    both = Rotation.from_rotvec(np.asarray(vector, float)) * Rotation.from_rotvec(np.asarray(first, float))
    x, y, z = both.as_rotvec().tolist()
    return x, y, z
