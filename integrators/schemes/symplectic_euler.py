"""Symplectic Euler: v+ = v + h a(q, v), q+ = q + h v+.

Order 1, symplectic without damping; stable for h^2 omega^2 + 4 zeta omega h <= 4.
Source: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), I.1.2.
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
    flat_q, flat_v, f, per_m = flat(state.q), flat(state.v), flat(state.memory[0]), flat(system.per_mass)
    for i in range(3 * system.n_free):
        flat_v[i] += h * per_m[i] * f[i]
        flat_q[i] += h * flat_v[i]
    evaluate_end(system_address, data_address, t, h, state, counts)
    return DONE


SYMPLECTIC_EULER = own_scheme(
    name="symplectic_euler",
    label="symplectic Euler",
    family=Family.SYMPLECTIC,
    order=1,
    explicit=True,
    limit=LaggingDamping(1.0),
    note="(h omega)^2 + 4 zeta h omega <= 4",
    energy=EnergyPromise.SWINGS_ABOUT,
    keeps_angular_momentum=True,
    error_constant=1 / 24,
    error_order=2,
    error_shift=1 / 2,
    takes_rigid_bodies=True,
    step=step,
    memory_rows=1,
)
