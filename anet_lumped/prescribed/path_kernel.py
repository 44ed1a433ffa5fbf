"""Compiled evaluation of the prescribed motions packed by `paths.pack`."""

import math

from numba import float64, int64, types, void

from anet_lumped.compiled.jit import njit

from .paths import DEGREE, PathTable
from .smoothstep_kernel import ramped

TABLE = types.NamedTuple((int64[::1], float64[::1], float64[:, :, ::1], int64[::1], float64[:, ::1], float64[:, ::1]), PathTable)
_DEGREE = int(DEGREE)


@njit(void(float64, TABLE, float64[:, ::1], float64[:, ::1], float64[:, ::1]), cache=True)
def evaluate(t, table, q, v, a):
    """Write the places, velocities and accelerations of all paths at time t, one row a path.

    q = Σ c_i·tau^i + S(t/ramp)·amplitude·sin(omega·t + phase), tau the time since the piece began; v and a are its
    exact derivatives, limits from the right at a corner.

    Parameters
    ----------
    t : float64 [s]
    table : PathTable
    q, v, a : (n_paths, 3) float64 [m], [m/s], [m/s²], written
    """
    for p in range(q.shape[0]):
        low, high = table.first[p], table.first[p + 1]
        while high - low > 1:
            middle = (low + high) // 2
            if table.breaks[middle] <= t:
                low = middle
            else:
                high = middle
        tau = t - table.breaks[low]
        for axis in range(3):
            if tau < 0.0:
                q[p, axis], v[p, axis], a[p, axis] = table.coefficients[low, 0, axis], 0.0, 0.0
                continue
            x, dx, half_ddx = 0.0, 0.0, 0.0
            for i in range(_DEGREE, -1, -1):
                half_ddx = half_ddx * tau + dx
                dx = dx * tau + x
                x = x * tau + table.coefficients[low, i, axis]
            q[p, axis], v[p, axis], a[p, axis] = x, dx, 2.0 * half_ddx
    for h in range(table.harmonic_path.shape[0]):
        p = table.harmonic_path[h]
        omega, phase, ramp = table.wave[h, 0], table.wave[h, 1], table.wave[h, 2]
        e, de, dde = ramped(t, ramp)
        sine, cosine = math.sin(omega * t + phase), math.cos(omega * t + phase)
        for axis in range(3):
            amplitude = table.amplitude[h, axis]
            q[p, axis] += amplitude * e * sine
            v[p, axis] += amplitude * (de * sine + e * omega * cosine)
            a[p, axis] += amplitude * (dde * sine + 2.0 * de * omega * cosine - e * omega * omega * sine)
