"""A path among the numbers of an effect: how it is written there, and what compiled code reads of it."""

import math
from typing import Any

import numpy as np

from anet_lumped.compiled.jit import inlined
from anet_lumped.prescribed.paths import DEGREE
from anet_lumped.prescribed.smoothstep_kernel import ramped

POWERS = int(DEGREE) + 1
PIECE, SINE = 1 + 3 * POWERS, 7  # numbers of a piece of a path, and of its sine


def numbers_of_path(path: Any) -> np.ndarray:
    """Numbers of a path: the start [s] and the coefficients of each piece, and those of its sine if it has one."""
    rows = [np.concatenate([[t], c.ravel()]) for t, c in zip(path.breaks, path.coefficients, strict=True)]
    if path.sine is not None:
        sine = path.sine
        rows.append(np.array([*sine.amplitude, sine.omega, sine.phase, sine.ramp, 0.0]))
    return np.concatenate(rows)


@inlined
def path_value(t, params, at, pieces, has_sine):
    """Value of a path at time t, as `Path.at`, and where the numbers behind it begin."""
    low, high = 0, pieces
    while high - low > 1:
        middle = (low + high) // 2
        if params[at + PIECE * middle] <= t:
            low = middle
        else:
            high = middle
    piece = at + PIECE * low
    tau = max(t - params[piece], 0.0)
    x, y, z = 0.0, 0.0, 0.0
    for i in range(POWERS - 1, -1, -1):
        c = piece + 1 + 3 * i
        x, y, z = x * tau + params[c], y * tau + params[c + 1], z * tau + params[c + 2]
    behind = at + PIECE * pieces
    if has_sine:
        share, _, _ = ramped(t, params[behind + 5])
        share *= math.sin(params[behind + 3] * t + params[behind + 4])
        x, y, z = x + share * params[behind], y + share * params[behind + 1], z + share * params[behind + 2]
        behind += SINE
    return (x, y, z), behind


@inlined
def length_of_path(pieces, has_sine):
    """How many numbers a path has."""
    return PIECE * pieces + (SINE if has_sine else 0)


@inlined
def path_rate(t, params, at, pieces, has_sine):
    """Rate of change of a path at time t, as `Path.at`."""
    low, high = 0, pieces
    while high - low > 1:
        middle = (low + high) // 2
        if params[at + PIECE * middle] <= t:
            low = middle
        else:
            high = middle
    piece, x, y, z = at + PIECE * low, 0.0, 0.0, 0.0
    tau = t - params[piece]
    if tau >= 0.0:
        for i in range(POWERS - 1, 0, -1):
            c = piece + 1 + 3 * i
            x, y, z = x * tau + i * params[c], y * tau + i * params[c + 1], z * tau + i * params[c + 2]
    if has_sine:
        behind = at + PIECE * pieces
        share, slope, _ = ramped(t, params[behind + 5])
        omega, angle = params[behind + 3], params[behind + 3] * t + params[behind + 4]
        rate = slope * math.sin(angle) + share * omega * math.cos(angle)
        x, y, z = x + rate * params[behind], y + rate * params[behind + 1], z + rate * params[behind + 2]
    return x, y, z
