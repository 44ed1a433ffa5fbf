"""Compiled: small displacements across the motion of a net, carried along by the tensions of its saved states."""

import numpy as np
from numba import float64, int64, void

from anet_lumped.compiled.jit import kernel

MOST_PARTS = 32  # of the time between two saved states; nodes too light for so many count as heavier
LARGEST = 1e100  # displacement at which all are scaled down

_f1, _f2 = float64[::1], float64[:, ::1]


@kernel(void(_f1, int64, _f2, int64[:, ::1], _f1, _f2, _f1, _f1))
def carry_across(steps, most_parts, stiffness, ends, mass, motion, scratch, logarithm):  # type: ignore[no-untyped-def]
    """Carry a displacement z across the motion through times in which the stiffness across each segment is the same.

        m_i d2z_i/dt2 = sum of (T/l) (z_j - z_i) over the segments between i and j .

    Leapfrog steps of h, with h^2 times the largest sum of T/(l m) at a node at most 1/2. No frequency^2 is more than twice that
    sum, and the limit of stability is h^2 frequency^2 = 4.

    Parameters
    ----------
    steps : (k,) float64 [s]
    most_parts : int64, of each of these times
    stiffness : (k, n_segments) float64 [N/m], T/l
    ends : (n_segments, 2) int64, nodes at both ends of each segment
    mass : (n,) float64 [kg], 0 of a node that is held
    motion : (2, n) float64, z and dz/dt at the start, and then at the end, scaled
    scratch : (n,) float64
    logarithm : (k,) float64, written: of the largest |z| at the end of each of these times

    Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, 2006, I.1.4 (leapfrog) and I.5.2 (its limit).
    """
    n, scaled = mass.shape[0], 0.0
    for r in range(steps.shape[0]):
        fastest, largest = 0.0, 0.0
        for i in range(n):
            scratch[i] = 0.0
        for s in range(ends.shape[0]):
            scratch[ends[s, 0]] += abs(stiffness[r, s])
            scratch[ends[s, 1]] += abs(stiffness[r, s])
        for i in range(n):
            if mass[i] > 0.0:
                fastest = max(fastest, scratch[i] / mass[i])
        parts = min(np.ceil(steps[r] * np.sqrt(2.0 * fastest)) + 1.0, float(most_parts))
        h = steps[r] / parts
        for i in range(n):  # h/m of a node
            scratch[i] = h / max(mass[i], 2.0 * h * h * scratch[i]) if mass[i] > 0.0 else 0.0
        for _ in range(int(parts)):
            for i in range(n):
                motion[0, i] += h * motion[1, i]
            for s in range(ends.shape[0]):
                a, b = ends[s, 0], ends[s, 1]
                f = stiffness[r, s] * (motion[0, b] - motion[0, a])
                motion[1, a] += scratch[a] * f
                motion[1, b] -= scratch[b] * f
        for i in range(n):
            largest = max(largest, abs(motion[0, i]))
        logarithm[r] = scaled + np.log(max(largest, 1e-300))
        if largest > LARGEST:
            scaled += np.log(largest)
            for i in range(n):
                motion[0, i] /= largest
                motion[1, i] /= largest
