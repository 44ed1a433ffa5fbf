"""Explicit Euler: q+ = q + h v, v+ = v + h a(q, v).

Order 1. Without damping unstable at any step; with damping ratio zeta < 1 stable for h omega <= 2 zeta.
"""

import numpy as np

from integrators.flat_view import flat
from integrators.jit import scheme_step
from integrators.linear_stability import AmplificationPolynomial, StepLimit
from integrators.step_ends import evaluate_end
from integrators.system import DONE, system_at

from .record import Family, own_scheme


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; memory[0] is the force at its start, and then at its end."""
    system = system_at(system_address)
    flat_q, flat_v, f, per_m = flat(state.q), flat(state.v), flat(state.memory[0]), flat(system.per_mass)
    for i in range(3 * system.n_free):
        flat_q[i] += h * flat_v[i]
        flat_v[i] += h * per_m[i] * f[i]
    evaluate_end(system_address, data_address, t, h, state, counts)
    return DONE


class ForwardEuler(AmplificationPolynomial):
    """|1 + z| <= 1: h omega^2 <= d, and h <= 4/(d + sqrt(d^2 - 4 omega^2)) if overdamped."""

    def largest_step(self, omega, d):
        """In closed form: without damping the border lies at 0, which a scan does not find."""
        # fmin: a mode without spring and damper (0/0) is merely free
        return np.fmin(d / omega**2, 4.0 / (d + np.sqrt(np.maximum(d**2 - 4.0 * omega**2, 0.0))))

    def highest_frequency(self, zeta, hd):
        """By bisection of the closed form."""
        return StepLimit.highest_frequency(self, zeta, hd)


EXPLICIT_EULER = own_scheme(
    name="explicit_euler",
    label="explicit Euler",
    family=Family.EXPLICIT_RUNGE_KUTTA,
    order=1,
    explicit=True,
    limit=ForwardEuler(lambda: (1.0, 1.0)),
    note="never stable for swings without mass-proportional damping: no axial damper acts on them",
    error_constant=1 / 2,
    takes_rigid_bodies=True,
    step=step,
    memory_rows=1,
)
