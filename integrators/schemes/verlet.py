"""Velocity Verlet: q+ = q + h v + h^2/2 a, v+ = v + h/2 (a + a+), with a+ = a(q+, v + h a) so that damping keeps order 2.

Order 2, symplectic without damping; stable for h^2 omega^2 + 8 zeta omega h <= 4.
Source: Swope et al., J. Chem. Phys. 76 (1982) 637; the predicted velocity as in Groot & Warren, J. Chem. Phys. 107 (1997) 4423.
"""

from integrators.flat_view import flat
from integrators.jit import scheme_step
from integrators.linear_stability import LaggingDamping
from integrators.step_ends import evaluate_end
from integrators.system import DONE, system_at

from .record import EnergyPromise, Family, own_scheme


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; memory[0] is the force at its start, and then at its end."""
    system = system_at(system_address)
    flat_q, flat_v, per_m = flat(state.q), flat(state.v), flat(system.per_mass)
    f, f_before = flat(state.memory[0]), flat(state.memory[1])
    for i in range(3 * system.n_free):
        change = h * per_m[i] * f[i]
        flat_q[i] += h * (flat_v[i] + 0.5 * change)
        flat_v[i] += change
        f_before[i] = f[i]
    evaluate_end(system_address, data_address, t, h, state, counts)
    for i in range(3 * system.n_free):
        flat_v[i] += 0.5 * h * per_m[i] * (f[i] - f_before[i])
    return DONE


VERLET = own_scheme(
    name="verlet",
    label="velocity Verlet",
    family=Family.SYMPLECTIC,
    order=2,
    explicit=True,
    limit=LaggingDamping(2.0),
    note="(h omega)^2 + 8 zeta h omega <= 4; damping at the predicted velocity halves the dashpot it tolerates",
    energy=EnergyPromise.SWINGS_ABOUT,
    keeps_angular_momentum=True,
    error_constant=1 / 24,
    takes_rigid_bodies=True,
    step=step,
    memory_rows=2,
)
