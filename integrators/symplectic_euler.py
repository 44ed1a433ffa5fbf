"""Symplectic Euler: v+ = v + h a(q, v), q+ = q + h v+.

Order 1, symplectic without damping; stable for h^2 omega^2 + 4 zeta omega h <= 4.
Source: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), I.1.2.
"""

from numba import njit

from .march import arrive
from .system import DONE

ORDER = 1
MEMORY = 1


@njit(cache=True, error_model="numpy")
def step(system, net, t, h, q, v, memory, options, counts, balance):
    """One step; memory[0] is the force at its start, and then at its end."""
    f = memory[0]
    for i in range(system.n_free):
        per_m = h / system.mass[i]
        for x in range(3):
            v[i, x] += per_m * f[i, x]
            q[i, x] += h * v[i, x]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    return DONE
