"""A scheme that is not in the library: position Verlet, q half a step, v a whole one, q the other half.

Order 2 without damping, symplectic; the damping force is that of the velocity at the start of the step, so that
h^2 omega^2 + 2 h d <= 4. Source: Tuckerman et al., J. Chem. Phys. 97 (1992) 1990.
"""

import numpy as np

from integrators.flat_view import flat
from integrators.jit import scheme_step
from integrators.linear_stability import StepLimit
from integrators.schemes.record import EnergyPromise, Family, own_scheme
from integrators.system import DONE, FORCES, PUT_IN, TAKEN_INSIDE, TAKEN_OUTSIDE, system_at


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; memory[0] is the force in its middle."""
    system, power = system_at(system_address), state.memory[1, 0]
    Q, V, f, per_m = flat(state.q), flat(state.v), flat(state.memory[0]), flat(system.per_mass)
    for i in range(3 * system.n_free):
        Q[i] += 0.5 * h * V[i]
    system.prescribe(t + 0.5 * h, data_address, state.q, state.v)
    system.force(t + 0.5 * h, state.q, state.v, data_address, state.memory[0], power)
    counts[FORCES] += 1
    state.balance[TAKEN_INSIDE] += h * power[0]
    state.balance[TAKEN_OUTSIDE] += h * power[1]
    state.balance[PUT_IN] += h * power[2]
    for i in range(3 * system.n_free):
        V[i] += h * per_m[i] * f[i]
        Q[i] += 0.5 * h * V[i]
    system.prescribe(t + h, data_address, state.q, state.v)
    return DONE


class MiddleForce(StepLimit):
    """(h omega)^2 + 2 h d <= 4, of which the largest damping and the highest frequency follow by bisection."""

    def largest_step(self, omega, d):
        """4/(d + sqrt(d^2 + 4 omega^2))."""
        return 4.0 / (d + np.sqrt(d**2 + 4.0 * omega**2))


POSITION_VERLET = own_scheme(
    name="position_verlet",
    label="position Verlet",
    family=Family.SYMPLECTIC,
    order=2,
    explicit=True,
    limit=MiddleForce(),
    note="(h omega)^2 + 4 zeta h omega <= 4",
    energy=EnergyPromise.SWINGS_ABOUT,
    keeps_angular_momentum=True,
    step=step,
    memory_rows=2,
)
