"""The classical Runge-Kutta method of order 4.

Stable for h omega <= 2 sqrt(2) without damping, and for real eigenvalues down to -2.785/h.
Source: Kutta, Z. Math. Phys. 46 (1901) 435.
"""

from integrators.flat_view import flat
from integrators.jit import scheme_step
from integrators.linear_stability import AmplificationPolynomial
from integrators.step_ends import evaluate_end
from integrators.system import DONE, FORCES, system_at

from .record import Family, own_scheme


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; memory[0] is the force at its start, and then at its end."""
    system, memory = system_at(system_address), state.memory
    flat_q, flat_v, per_m = flat(state.q), flat(state.v), flat(system.per_mass)
    f, Q_s, V_s, dQ, dV = flat(memory[0]), flat(memory[1]), flat(memory[2]), flat(memory[3]), flat(memory[4])
    power, n = memory[5, 0, :2], 3 * system.n_free
    for i in range(n, flat_q.shape[0]):
        Q_s[i], V_s[i] = flat_q[i], flat_v[i]
    for stage in range(4):
        weight = 1.0 / 6.0 if stage == 0 or stage == 3 else 1.0 / 3.0
        stage_step = h if stage == 2 else 0.5 * h
        for i in range(n):
            speed, acceleration = flat_v[i] if stage == 0 else V_s[i], per_m[i] * f[i]
            dQ[i] = weight * speed + (dQ[i] if stage > 0 else 0.0)
            dV[i] = weight * acceleration + (dV[i] if stage > 0 else 0.0)
            Q_s[i] = flat_q[i] + stage_step * speed
            V_s[i] = flat_v[i] + stage_step * acceleration
        if stage < 3:
            system.prescribe(t + stage_step, data_address, memory[1], memory[2])
            system.force(t + stage_step, memory[1], memory[2], data_address, memory[0], power)
            counts[FORCES] += 1
    for i in range(n):
        flat_q[i] += h * dQ[i]
        flat_v[i] += h * dV[i]
    evaluate_end(system_address, data_address, t, h, state, counts)
    return DONE


RK4 = own_scheme(
    name="rk4",
    label="RK4",
    family=Family.EXPLICIT_RUNGE_KUTTA,
    order=4,
    explicit=True,
    limit=AmplificationPolynomial(lambda: (1.0, 1.0, 1 / 2, 1 / 6, 1 / 24)),
    note="undamped modes to h omega = 2.828, overdamped ones to 2.785",
    error_constant=1 / 120,
    takes_rigid_bodies=True,
    step=step,
    memory_rows=6,
    force_evaluations=4,
)
