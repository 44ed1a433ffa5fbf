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


@njit(void(int64[::1], float64[::1], float64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], float64, float64), cache=True)
def lead(pieces, breaks, coefficients, before, after, t, t_end):
    """Lead paths that are driven from outside through a step: the cubic that has both positions and both velocities.

    At the end of the step, and beyond, such a path has the position and the velocity that were given, to the last bit.

    Parameters
    ----------
    pieces : (m,) int64
        First of the two pieces of each path.
    breaks, coefficients : of the `PathTable`, written
    before, after : (m, 2, 3) float64 [m], [m/s]
        Position and velocity at the start and at the end of the step.
    t, t_end : float64 [s]
    """
    h = t_end - t
    for k in range(pieces.shape[0]):
        piece = pieces[k]
        breaks[piece], breaks[piece + 1] = t, t_end
        for x in range(3):
            p0, v0, p1, v1 = before[k, 0, x], before[k, 1, x], after[k, 0, x], after[k, 1, x]
            mean = (p1 - p0) / h
            coefficients[piece, 0, x], coefficients[piece, 1, x] = p0, v0
            coefficients[piece, 2, x] = (3.0 * mean - 2.0 * v0 - v1) / h
            coefficients[piece, 3, x] = (v0 + v1 - 2.0 * mean) / (h * h)
            coefficients[piece + 1, 0, x], coefficients[piece + 1, 1, x] = p1, v1
