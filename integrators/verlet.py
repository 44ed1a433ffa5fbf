"""Velocity Verlet: q+ = q + h v + h^2/2 a, v+ = v + h/2 (a + a+), with a+ = a(q+, v + h a) so that damping keeps order 2.

Order 2, symplectic without damping; stable for h^2 omega^2 + 8 zeta omega h <= 4.
Source: Swope et al., J. Chem. Phys. 76 (1982) 637; the predicted velocity as in Groot & Warren, J. Chem. Phys. 107 (1997) 4423.
"""

from numba import njit

from .march import arrive
from .system import DONE

ORDER = 2
MEMORY = 2


@njit(cache=True, error_model="numpy")
def step(system, net, t, h, q, v, memory, options, counts, balance):
    """One step; memory[0] is the force at its start, and then at its end."""
    f, before = memory[0], memory[1]
    for i in range(system.n_free):
        per_m = h / system.mass[i]
        for x in range(3):
            change = per_m * f[i, x]
            q[i, x] += h * v[i, x] + 0.5 * h * change
            v[i, x] += change
            before[i, x] = f[i, x]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    for i in range(system.n_free):
        half = 0.5 * h / system.mass[i]
        for x in range(3):
            v[i, x] += half * (f[i, x] - before[i, x])
    return DONE
