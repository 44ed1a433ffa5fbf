"""Compiled: small displacements across the motion of a net, carried along by the tensions of its saved states."""

import numpy as np
from numba import float64, int64, void

from anet_lumped.compiled.jit import kernel

MOST_PARTS = 32  # of the time between two saved states; nodes too light for so many count as heavier
LARGEST = 1e100  # displacement at which all are scaled down

_f1, _f2, _f3 = float64[::1], float64[:, ::1], float64[:, :, ::1]


@kernel(void(_f1, _f3, _f2, int64[:, ::1], _f1, _f2, _f2, _f1))
def carry_across(t, q, tension, ends, mass, motion, scratch, logarithm):  # type: ignore[no-untyped-def]  # its signature is above
    """Carry a displacement z across the motion from the first saved state to the last.

        m_i d2z_i/dt2 = sum of (T/l) (z_j - z_i) over the segments between i and j ,

    with the means of tensions and lengths at two saved states in a row. Leapfrog steps of h, with h^2 times the largest sum of
    T/(l m) at a node at most 1/2. No frequency^2 is more than twice that sum, and the limit of stability is h^2 frequency^2 = 4.

    Parameters
    ----------
    t : (k,) float64 [s]
    q : (k, n, 3) float64 [m]
    tension : (k, n_segments) float64 [N]
    ends : (n_segments, 2) int64, nodes at both ends of each segment
    mass : (n,) float64 [kg], 0 of a node that is held
    motion : (2, n) float64, z and dz/dt at the start, and then at the end, scaled
    scratch : (2, max(n, n_segments)) float64
    logarithm : (k,) float64, written from the second one on: of the largest |z| at each saved time

    Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, 2006, I.1.4 (leapfrog) and I.5.2 (its limit).
    """
    n, scaled = mass.shape[0], 0.0
    for r in range(tension.shape[0] - 1):
        step, fastest = t[r + 1] - t[r], 0.0
        for i in range(n):
            scratch[0, i] = 0.0
        for s in range(ends.shape[0]):
            a, b, square, later = ends[s, 0], ends[s, 1], 0.0, 0.0
            for x in range(3):
                square += (q[r, b, x] - q[r, a, x]) ** 2
                later += (q[r + 1, b, x] - q[r + 1, a, x]) ** 2
            k = (tension[r, s] + tension[r + 1, s]) / max(np.sqrt(square) + np.sqrt(later), 1e-300)
            scratch[1, s] = k
            scratch[0, a] += abs(k)
            scratch[0, b] += abs(k)
        for i in range(n):
            if mass[i] > 0.0:
                fastest = max(fastest, scratch[0, i] / mass[i])
        parts = min(np.ceil(step * np.sqrt(2.0 * fastest)) + 1.0, float(MOST_PARTS))
        h, largest = step / parts, 0.0
        for i in range(n):  # h/m of a node
            scratch[0, i] = h / max(mass[i], 2.0 * h * h * scratch[0, i]) if mass[i] > 0.0 else 0.0
        for _ in range(int(parts)):
            for i in range(n):
                motion[0, i] += h * motion[1, i]
            for s in range(ends.shape[0]):
                a, b = ends[s, 0], ends[s, 1]
                f = scratch[1, s] * (motion[0, b] - motion[0, a])
                motion[1, a] += scratch[0, a] * f
                motion[1, b] -= scratch[0, b] * f
        for i in range(n):
            largest = max(largest, abs(motion[0, i]))
        logarithm[r + 1] = scaled + np.log(max(largest, 1e-300))
        if largest > LARGEST:
            scaled += np.log(largest)
            for i in range(n):
                motion[0, i] /= largest
                motion[1, i] /= largest
