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
    Q, V, per_m = q.ravel(), v.ravel(), system.per_mass.ravel()
    f, Q_s, V_s, dQ, dV = memory[0].ravel(), memory[1].ravel(), memory[2].ravel(), memory[3].ravel(), memory[4].ravel()
    power, n = memory[5, 0, :2], 3 * system.n_free
    Q_s[n:], V_s[n:] = Q[n:], V[n:]
    for stage in range(4):
        weight = 1.0 / 6.0 if stage == 0 or stage == 3 else 1.0 / 3.0
        ahead = h if stage == 2 else 0.5 * h
        for i in range(n):
            speed, acceleration = V[i] if stage == 0 else V_s[i], per_m[i] * f[i]
            dQ[i] = weight * speed + (dQ[i] if stage > 0 else 0.0)
            dV[i] = weight * acceleration + (dV[i] if stage > 0 else 0.0)
            Q_s[i] = Q[i] + ahead * speed
            V_s[i] = V[i] + ahead * acceleration
        if stage < 3:
            system.prescribe(t + ahead, net, memory[1], memory[2])
            system.force(t + ahead, memory[1], memory[2], net, memory[0], power)
            counts[FORCES] += 1
    for i in range(n):
        Q[i] += h * dQ[i]
        V[i] += h * dV[i]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    return DONE
