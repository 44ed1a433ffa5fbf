"""Explicit Euler: q+ = q + h v, v+ = v + h a(q, v).

Order 1. Without damping unstable at any step; with damping ratio zeta < 1 stable for h omega <= 2 zeta.
"""

from numba import njit

from .march import arrive
from .system import DONE

ORDER = 1
MEMORY = 1


@njit(cache=True, error_model="numpy")
def step(system, net, t, h, q, v, memory, options, counts, balance):
    """One step; memory[0] is the force at its start, and then at its end."""
    Q, V, f, per_m = q.ravel(), v.ravel(), memory[0].ravel(), system.per_mass.ravel()
    for i in range(3 * system.n_free):
        Q[i] += h * V[i]
        V[i] += h * per_m[i] * f[i]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    return DONE
