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
    Q, V, f, per_m = q.ravel(), v.ravel(), memory[0].ravel(), system.per_mass.ravel()
    for i in range(3 * system.n_free):
        V[i] += h * per_m[i] * f[i]
        Q[i] += h * V[i]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    return DONE
