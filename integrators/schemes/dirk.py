"""Diagonally implicit Runge-Kutta methods: each stage is one solve, q = q_hat + gamma h v, M (v - v_hat) = gamma h f(q, v).

`midpoint`, `sdirk2` and `tr_bdf2` have a tableau each. All are unconditionally stable for a linear system; none keeps a nonlinear
one from gaining energy.

Where a step does not resolve stretching, the internal forces of single stages are wrong. The stages of sdirk2 are of order 1, and
the error of their forces does not fall with the step: for a mass that circles on a stiff spring the force of the first stage is
-1/sqrt 2 times the centripetal force, that of the last stage 3/2 (2 + sqrt 2) = 5.12 times, while their mean with the weights b is
right (stages on the circle, q_s = q + h sum A V, in the limit of small steps). With the midpoint rule no forces balance the
positions at the end of a step. Therefore the mean over the step is observed with these two. The stages of tr_bdf2 are of order 2,
and the force of its last stage is right.
"""

import math

import numpy as np

from integrators.jit import scheme_step
from integrators.linear_stability import NoLimit
from integrators.newton import newton
from integrators.stage import LAW_AT_END, Stage
from integrators.step_ends import add_work
from integrators.system import DONE, FIRST_OWN, FORCES, POWERS, SCRATCH, UNCONVERGED, system_at

from .record import Family, own_scheme

MOST_STAGES = 3
# Coefficients of a step: number of stages, whether the internal forces are averaged over them, the rows of A, b.
STAGES, AVERAGES, TABLE = FIRST_OWN, FIRST_OWN + 1, FIRST_OWN + 2


def dirk_scheme(A, b, order, observes_mean_over_stages=False, **known):
    """The record of a scheme with the tableau A (s, s), b (s,), lower triangular, of at most `MOST_STAGES` stages."""

    def coefficients():
        table = np.zeros((MOST_STAGES + 1, MOST_STAGES))
        table[: len(b), : len(b)] = A
        table[MOST_STAGES, : len(b)] = b
        return np.concatenate([[len(b), observes_mean_over_stages], table.ravel()])

    return own_scheme(
        order=order,
        family=Family.DIAGONALLY_IMPLICIT,
        explicit=False,
        limit=NoLimit(),
        error_constant=abs(1.0 / math.factorial(order + 1) - float(np.dot(b, np.linalg.matrix_power(A, order).sum(axis=1)))),
        observes_mean_over_stages=observes_mean_over_stages,
        step=step,
        memory_rows=11,
        coefficients=coefficients,
        **known,
    )


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; with an explicit first stage memory[0] is the force at its start, and then at its end.

    Work is that of the stages with the weights b, as the motion is: the force at the end of a step need not be one that acted.
    """
    system, q, v, memory, balance = system_at(system_address), state.q, state.v, state.memory, state.balance
    power = balance[SCRATCH:]
    stages, averages, table = int(parameters[STAGES]), parameters[AVERAGES] != 0.0, parameters[TABLE:]
    b = table[MOST_STAGES * MOST_STAGES :]
    if averages:
        system.average(data_address, 0.0, h)
    q_s, base, target, v_s = memory[1], memory[2], memory[3], memory[4]
    for s in range(stages):
        V, A = memory[5 + s], memory[8 + s]
        row = table[MOST_STAGES * s : MOST_STAGES * (s + 1)]
        c_s = 0.0
        for r in range(stages):
            c_s += row[r]
        gamma_h = h * row[s]
        if gamma_h == 0.0:
            for i in range(system.n_free):
                for x in range(3):
                    V[i, x], A[i, x] = v[i, x], memory[0, i, x] * system.per_mass[i, x]
            add_work(balance, h * b[s], balance[POWERS:])
            continue
        for i in range(q.shape[0]):
            for x in range(3):
                q_hat, v_hat = q[i, x], v[i, x]
                for r in range(s):
                    q_hat += h * row[r] * memory[5 + r, i, x]
                    v_hat += h * row[r] * memory[8 + r, i, x]
                base[i, x] = q_hat
                target[i, x] = q_hat + gamma_h * v_hat
                q_s[i, x] = target[i, x]
        for i in range(system.n_free, q.shape[0]):
            for x in range(3):
                q_s[i, x], v_s[i, x] = q[i, x], v[i, x]
        system.prescribe(t + c_s * h, data_address, q_s, v_s)
        for i in range(system.n_free, q.shape[0]):
            for x in range(3):
                base[i, x] = q_s[i, x] - gamma_h * v_s[i, x]
        stage = Stage(LAW_AT_END, t + c_s * h, 1.0 / (gamma_h * gamma_h), 1.0, gamma_h, 0.0)
        if not newton(system_address, data_address, stage, base, target, q_s, parameters, counts):
            return UNCONVERGED
        if averages:
            system.average(data_address, b[s], h)
        for i in range(system.n_free):
            for x in range(3):
                v_s[i, x] = V[i, x] = (q_s[i, x] - base[i, x]) / gamma_h
        system.force(t + c_s * h, q_s, v_s, data_address, A, power)  # for its powers
        counts[FORCES] += 1
        add_work(balance, h * b[s], power)
        for i in range(system.n_free):
            for x in range(3):
                A[i, x] = (V[i, x] - (target[i, x] - base[i, x]) / gamma_h) / gamma_h
    for i in range(system.n_free):
        for x in range(3):
            for s in range(stages):
                q[i, x] += h * b[s] * memory[5 + s, i, x]
                v[i, x] += h * b[s] * memory[8 + s, i, x]
    system.prescribe(t + h, data_address, q, v)
    if table[0] == 0.0:
        for k in range(3):
            balance[POWERS + k] = power[k]
        # an explicit first stage goes on with the force that the last one balanced, whose damper saw the taut part of it
        for i in range(system.n_free):
            for x in range(3):
                memory[0, i, x] = memory[7 + stages, i, x] / system.per_mass[i, x]
    return DONE
