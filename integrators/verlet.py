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
    Q, V, per_m = q.ravel(), v.ravel(), system.per_mass.ravel()
    f, f_before = memory[0].ravel(), memory[1].ravel()
    for i in range(3 * system.n_free):
        change = h * per_m[i] * f[i]
        Q[i] += h * (V[i] + 0.5 * change)
        V[i] += change
        f_before[i] = f[i]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    for i in range(3 * system.n_free):
        V[i] += 0.5 * h * per_m[i] * (f[i] - f_before[i])
    return DONE
