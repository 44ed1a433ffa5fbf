"""A path as a row of numbers among others, and its motion in compiled code.

Its pieces, each the time at which it begins and its `POWERS` coefficients of three numbers, then its sine if it has one.
"""

import math

import numpy as np

from anet_lumped.compiled.jit import inlined

from .paths import DEGREE, Path
from .smoothstep_kernel import ramped

POWERS = int(DEGREE) + 1
PIECE, SINE = 1 + 3 * POWERS, 7  # numbers of a piece, and of a sine: amplitude (3,), omega, phase, ramp, zero


def numbers_of_path(path: Path) -> np.ndarray:
    """The numbers of a path, of which it has ``PIECE len(path.breaks)``, and `SINE` more if it has a sine."""
    pieces = [np.concatenate([[t], c.ravel()]) for t, c in zip(path.breaks, path.coefficients, strict=True)]
    if path.sine is not None:
        amplitude, omega, phase, ramp = path.sine
        pieces.append(np.array([*amplitude, omega, phase, ramp, 0.0]))
    return np.concatenate(pieces)


def counted(path: Path) -> np.ndarray:
    """How many pieces a path has and whether it has a sine, and its numbers."""
    return np.concatenate([[len(path.breaks), path.sine is not None], numbers_of_path(path)])


def constant(value: np.ndarray) -> Path:
    """A path that stays at a place (3,)."""
    coefficients = np.zeros((1, POWERS, 3))
    coefficients[0, 0] = value
    return Path("constant", (), np.zeros(1), coefficients, np.zeros(0))


@inlined
def length_of_path(pieces, has_sine):
    """How many numbers a path has."""
    return PIECE * pieces + (SINE if has_sine else 0)


@inlined
def _piece_at(t, numbers, at, pieces):
    """Where the numbers of the piece at time t begin, see `motion_at`."""
    low, high = 0, pieces
    while high - low > 1:
        middle = (low + high) // 2
        if numbers[at + PIECE * middle] <= t:
            low = middle
        else:
            high = middle
    return at + PIECE * low


@inlined
def value_at(t, numbers, at, pieces, has_sine):
    """Value of a path at time t and where the numbers behind it begin, as of `motion_at`, for those who need no rates."""
    piece = _piece_at(t, numbers, at, pieces)
    tau = max(t - numbers[piece], 0.0)
    x, y, z = 0.0, 0.0, 0.0
    for i in range(POWERS - 1, -1, -1):
        c = piece + 1 + 3 * i
        x, y, z = x * tau + numbers[c], y * tau + numbers[c + 1], z * tau + numbers[c + 2]
    behind = at + PIECE * pieces
    if has_sine:
        share, _, _ = ramped(t, numbers[behind + 5])
        share *= math.sin(numbers[behind + 3] * t + numbers[behind + 4])
        x, y, z = x + share * numbers[behind], y + share * numbers[behind + 1], z + share * numbers[behind + 2]
        behind += SINE
    return (x, y, z), behind


@inlined
def motion_at(t, numbers, at, pieces, has_sine):
    """Value, rate and second rate of a path at time t, as `Path.at`, and where the numbers behind it begin.

    Parameters
    ----------
    t : float64 [s]
    numbers : (k,) float64, with the path from ``numbers[at]`` on
    pieces : int64
    has_sine : bool
    """
    piece = _piece_at(t, numbers, at, pieces)
    tau = max(t - numbers[piece], 0.0)
    x, y, z = 0.0, 0.0, 0.0
    dx, dy, dz = 0.0, 0.0, 0.0
    half_x, half_y, half_z = 0.0, 0.0, 0.0
    for i in range(POWERS - 1, -1, -1):
        c = piece + 1 + 3 * i
        half_x, half_y, half_z = half_x * tau + dx, half_y * tau + dy, half_z * tau + dz
        dx, dy, dz = dx * tau + x, dy * tau + y, dz * tau + z
        x, y, z = x * tau + numbers[c], y * tau + numbers[c + 1], z * tau + numbers[c + 2]
    moves = 1.0 if t >= numbers[piece] else 0.0  # held before the first piece
    rate, second = (moves * dx, moves * dy, moves * dz), (2.0 * moves * half_x, 2.0 * moves * half_y, 2.0 * moves * half_z)
    behind = at + PIECE * pieces
    if has_sine:
        share, rise, bend = ramped(t, numbers[behind + 5])
        omega, phase = numbers[behind + 3], numbers[behind + 4]
        sine, cosine = math.sin(omega * t + phase), math.cos(omega * t + phase)
        first = rise * sine + share * omega * cosine
        twice = bend * sine + 2.0 * rise * omega * cosine - share * omega * omega * sine
        share *= sine
        a, b, c = numbers[behind], numbers[behind + 1], numbers[behind + 2]
        x, y, z = x + share * a, y + share * b, z + share * c
        rate = rate[0] + first * a, rate[1] + first * b, rate[2] + first * c
        second = second[0] + twice * a, second[1] + twice * b, second[2] + twice * c
        behind += SINE
    return (x, y, z), rate, second, behind
