"""Segments that hang slack and are caught: the tension that their ends set off, which lasts less than a step or a saved state.

The ends of a slack segment go apart at the rate u when it becomes taut. With the stiffness k = EA/L0, m = m_a m_b/(m_a + m_b) of
the masses at both and the damping ratio zeta, its tension is that of a spring and a damper that a mass runs into,

    T(t) = u sqrt(k m) exp(-zeta tau) (2 zeta cos(w tau) + (1 - 2 zeta^2)/w sin(w tau)) ,   w = sqrt(1 - zeta^2) , tau = omega t ,

whose largest value is u sqrt(k m) without a damper, and 2 zeta of that, at once, from zeta = 1/2 on. Between many segments that is
half of the wave u sqrt(EA mu) of a bar, with masses of mu L0 at its ends. States that are saved every h show it but for the share
s^2/(1 + s^2), s = omega h/2: a mooring near its anchor is slack, caught for a few milliseconds and slack again.

Where a segment is slack at a saved state, and would be longer than L0 at the next one if its ends went on, it is caught in between,
whatever the next state shows of that. The velocities of implicit steps swing from step to step where a vibration is not resolved;
so the rate is not more than that since the state before.

Source: the oscillator that begins with a velocity, see Chopra, Dynamics of Structures, 4th ed., 2012, section 2.2; the wave is
d'Alembert's, see Graff, Wave Motion in Elastic Solids, 1975, section 2.3.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np

AT_ONCE = 0.5  # damping ratio from which on the damper alone gives the largest tension


@lru_cache(maxsize=64)
def impact(zeta: float) -> float:
    """Largest tension of a spring and a damper that a mass m runs into with the velocity u, over u sqrt(k m).

    Parameters
    ----------
    zeta : float, damping ratio
    """
    if zeta >= AT_ONCE:
        return 2.0 * zeta
    square = zeta**2
    w = math.sqrt(1.0 - square)
    tau = math.atan2(w * (1.0 - 4.0 * square), zeta * (3.0 - 4.0 * square)) / w  # where its derivative is 0
    return math.exp(-zeta * tau) * (2.0 * zeta * math.cos(w * tau) + (1.0 - 2.0 * square) / w * math.sin(w * tau))


def caught_tension(run: Any) -> float:
    """Largest tension of segments that are caught, as far as saved states do not show it [N].

    Of cables that do not stretch, or that push as they pull, 0.
    """
    T, model = run.segment_tension, run.model
    if T.min(initial=1.0) > 0.0:
        return 0.0
    cables, steps, mass = run.scene.cables, np.diff(run.t), model.mass[: model.n_free]
    counts = np.array([not (cable.inextensible or cable.compression == "linear") for cable in cables])[model.cable_of]
    rows, segments = np.nonzero((T[:-1] <= 0.0) & counts)
    a, b = model.ends[segments].T
    apart, before = run.q[rows, b] - run.q[rows, a], np.maximum(rows - 1, 0)
    lengths, lengths_before = np.linalg.norm(apart, axis=1), np.linalg.norm(run.q[before, b] - run.q[before, a], axis=1)
    rate = np.einsum("sx,sx->s", apart, run.v[rows, b] - run.v[rows, a]) / np.maximum(lengths, 1e-300)
    rate = np.where(rows > 0, np.minimum(rate, (lengths - lengths_before) / steps[before]), rate)
    L0 = np.array([cable.L0 for cable in cables])[model.cable_of[segments]]
    caught = (rate > 0.0) & (lengths + rate * steps[rows] > L0)
    if not caught.any():
        return 0.0
    per_mass = np.zeros(model.n)
    per_mass[: model.n_free] = np.divide(1.0, mass, out=np.zeros(model.n_free), where=mass > 0.0)
    cable, rate = model.cable_of[segments[caught]], rate[caught]
    k = np.array([0.0 if one.inextensible else one.EA_fast / one.L0 for one in cables])[cable]
    time_of_damper = np.array([0.0 if one.inextensible else one.dashpot / one.stiffness for one in cables])[cable]
    omega = np.sqrt(k * (per_mass[a[caught]] + per_mass[b[caught]]))
    square = (0.5 * omega * steps[rows[caught]]) ** 2
    impedance = np.divide(k, omega, out=np.zeros(len(k)), where=omega > 0.0)  # sqrt(k m)
    hidden = rate * impedance * square / (1.0 + square)
    kinds, which = np.unique((0.5 * time_of_damper * omega).round(6), return_inverse=True)
    return float((hidden * np.array([impact(zeta) for zeta in kinds.tolist()])[which]).max())
