"""The classical Runge-Kutta method of order 4.

Stable for h omega <= 2 sqrt(2) without damping, and for real eigenvalues down to -2.785/h.
Source: Kutta, Z. Math. Phys. 46 (1901) 435.
"""

from numba import njit

from .march import arrive
from .system import DONE, FORCES

ORDER = 4
MEMORY = 6


@njit(cache=True, error_model="numpy")
def step(system, net, t, h, q, v, memory, options, counts, balance):
    """One step; memory[0] is the force at its start, and then at its end."""
    f, q_s, v_s, dq, dv = memory[0], memory[1], memory[2], memory[3], memory[4]
    power = memory[5, 0, :2]
    for stage in range(4):
        weight = 1.0 / 6.0 if stage == 0 or stage == 3 else 1.0 / 3.0
        ahead = h if stage == 2 else 0.5 * h
        for i in range(system.n_free):
            per_m = 1.0 / system.mass[i]
            for x in range(3):
                speed = v[i, x] if stage == 0 else v_s[i, x]
                acceleration = per_m * f[i, x]
                if stage == 0:
                    dq[i, x], dv[i, x] = 0.0, 0.0
                dq[i, x] += weight * speed
                dv[i, x] += weight * acceleration
                q_s[i, x] = q[i, x] + ahead * speed
                v_s[i, x] = v[i, x] + ahead * acceleration
        if stage < 3:
            for i in range(system.n_free, q.shape[0]):
                for x in range(3):
                    q_s[i, x], v_s[i, x] = q[i, x], v[i, x]
            system.prescribe(t + ahead, net, q_s, v_s)
            system.force(t + ahead, q_s, v_s, net, f, power)
            counts[FORCES] += 1
    for i in range(system.n_free):
        for x in range(3):
            q[i, x] += h * dq[i, x]
            v[i, x] += h * dv[i, x]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    return DONE
