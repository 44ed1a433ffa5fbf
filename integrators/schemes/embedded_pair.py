"""An embedded explicit Runge-Kutta pair: its step, the error of the step, and its dense output, for any tableau.

On q' = v, M v' = f(t, q, v) a Runge-Kutta method with the matrix A needs the accelerations a_j of its stages alone:
q_s = q + c_s h v + h^2 sum (A A)_sj a_j and v_s = v + h sum A_sj a_j, which halves what is stored and summed. Weights of
errors and of dense output follow likewise. The powers of dissipation and of what prescribed nodes put in are integrated with
the same weights as the velocities, so that the energy balance is of the order of the motion.

Source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.4 (error), II.6 (dense output), II.14
(Nystroem's form); Hairer & Wanner, part II (1996), IV.2 (detection of stiffness).
"""

from typing import NamedTuple

import numpy as np

from integrators.flat_view import flat, part
from integrators.jit import inlined, internal, scheme_step
from integrators.states import worst_node
from integrators.system import (
    DONE,
    FIRST_OWN,
    FORCES,
    POWER_INSIDE,
    POWER_OUTSIDE,
    POWER_PUT_IN,
    POWERS,
    PUT_IN,
    TAKEN_INSIDE,
    TAKEN_OUTSIDE,
    UNCONVERGED,
    system_at,
)

WORKING_ROWS = 8  # besides those of the stages
VELOCITY_TIME = 1.0  # [s] over which an error of a velocity counts as an error of a position
# Coefficients of a step: numbers of stages, of those before the end, and of the powers of theta; then c, A, A A; both error
# estimates of v and of q; the dense output.
STAGES, END, DEGREE, TABLEAU = FIRST_OWN, FIRST_OWN + 1, FIRST_OWN + 2, FIRST_OWN + 3


class Pair(NamedTuple):
    """Tableau of an embedded pair whose last stage is the first stage of the next step.

    Parameters
    ----------
    c : (S,) times of the stages; S counts the end of the step and the stages of the dense output alone
    A : (S, S) weights of the stages, strictly lower triangular; row ``end`` makes the step
    end : int, number of stages before the end of the step
    fine, coarse : (S,) weights of two error estimates e and E, combined as e^2/sqrt(e^2 + E^2/100)
    dense : (S, d) weights of the stages at t + theta h, as coefficients of theta, theta^2, ...
    """

    c: np.ndarray
    A: np.ndarray
    end: int
    fine: np.ndarray
    coarse: np.ndarray
    dense: np.ndarray


def memory_rows(stages):
    """Rows of memory that a step needs: force, accelerations and powers of the stages, seven for the sums, and weights."""
    return 3 * stages + WORKING_ROWS


def coefficients(pair):
    """The tableau as a step takes it, see `TABLEAU`."""
    A = np.asarray(pair.A, np.longdouble)
    errors = [weights for e in (pair.fine, pair.coarse) for weights in (e, np.asarray(e, np.longdouble) @ A)]
    sizes = [len(pair.c), pair.end, pair.dense.shape[1]]
    return np.concatenate([sizes, pair.c, pair.A.ravel(), (A @ A).ravel(), *errors, pair.dense.ravel()]).astype(float)


@inlined
def _next_weight(parameters, of_v, of_q, j, s):
    """Index of the first weight from j on that is not zero; s if there is none before s."""
    while j < s and parameters[of_v + j] == 0.0 and parameters[of_q + j] == 0.0:
        j += 1
    return j


@internal
def _sums(numbers, width, parameters, of_v, of_q, s, n, dV, dQ):
    """Sums of the first s accelerations, rows of ``width`` in ``numbers``, with the weights at ``of_v`` and ``of_q``.

    Four rows are added at once, so that the sums are loaded and stored a quarter as often; a missing row has the weight zero.
    """
    for i in range(n):
        dV[i], dQ[i] = 0.0, 0.0
    j = _next_weight(parameters, of_v, of_q, 0, s)
    while j < s:
        k = _next_weight(parameters, of_v, of_q, j + 1, s)
        l = _next_weight(parameters, of_v, of_q, k + 1, s)
        m = _next_weight(parameters, of_v, of_q, l + 1, s)
        v0, q0 = parameters[of_v + j], parameters[of_q + j]
        v1, q1 = (parameters[of_v + k], parameters[of_q + k]) if k < s else (0.0, 0.0)
        v2, q2 = (parameters[of_v + l], parameters[of_q + l]) if l < s else (0.0, 0.0)
        v3, q3 = (parameters[of_v + m], parameters[of_q + m]) if m < s else (0.0, 0.0)
        a0, a1 = part(numbers, (1 + j) * width, n), part(numbers, (1 + (k if k < s else j)) * width, n)
        a2, a3 = part(numbers, (1 + (l if l < s else j)) * width, n), part(numbers, (1 + (m if m < s else j)) * width, n)
        for i in range(n):
            dV[i] += v0 * a0[i] + v1 * a1[i] + v2 * a2[i] + v3 * a3[i]
            dQ[i] += q0 * a0[i] + q1 * a1[i] + q2 * a2[i] + q3 * a3[i]
        j = _next_weight(parameters, of_v, of_q, m + 1, s)


class Call(NamedTuple):
    """Arguments that all stages of a step share: start time t [s], length h [s], state at the start, memory, parameters, counts."""

    system_address: int
    data_address: int
    t: float
    h: float
    Q: np.ndarray
    V: np.ndarray
    memory: np.ndarray
    parameters: np.ndarray
    counts: np.ndarray


@inlined
def _stage(call, s, q_s, v_s, f):
    """Places and velocities of stage s in q_s and v_s from Q and V; its force in f; its acceleration and powers in memory.

    Returns UNCONVERGED if the end of the step cannot be made to satisfy constraints.
    """
    system, h, parameters, memory = system_at(call.system_address), call.h, call.parameters, call.memory
    S, n, width, numbers = int(parameters[STAGES]), 3 * system.n_free, call.Q.shape[0], flat(memory)
    c, row = parameters[TABLEAU + s], TABLEAU + S + s * S
    Q_s, V_s, F, per_m = flat(q_s), flat(v_s), flat(f), flat(system.per_mass)
    dQ, dV = part(numbers, (2 * S + 4) * width, n), part(numbers, (2 * S + 5) * width, n)
    _sums(numbers, width, parameters, row, row + S * S, s, n, dV, dQ)
    for i in range(n):
        Q_s[i] = call.Q[i] + h * (c * call.V[i] + h * dQ[i])
        V_s[i] = call.V[i] + h * dV[i]
    power = memory[1 + S + s, 0]
    system.prescribe(call.t + c * h, call.data_address, q_s, v_s)
    status = DONE
    if s == int(parameters[END]) and np.isnan(system.project(call.t + c * h, call.data_address, q_s, v_s)):
        status = UNCONVERGED
    system.force(call.t + c * h, q_s, v_s, call.data_address, f, power)
    call.counts[FORCES] += 1
    a = part(numbers, (1 + s) * width, n)
    for i in range(n):
        a[i] = per_m[i] * F[i]
    return status


@inlined
def _add_work(balance, duration, powers):
    """Add the work of powers over a duration [s] to the energy balance."""
    balance[TAKEN_INSIDE] += duration * powers[POWER_INSIDE]
    balance[TAKEN_OUTSIDE] += duration * powers[POWER_OUTSIDE]
    balance[PUT_IN] += duration * powers[POWER_PUT_IN]


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; memory[0] is the force at its start, and then at its end; the stages stay in memory."""
    system, q, v, memory, balance = system_at(system_address), state.q, state.v, state.memory, state.balance
    S, end, n = int(parameters[STAGES]), int(parameters[END]), 3 * system.n_free
    q_s, v_s = memory[2 * S + 1], memory[2 * S + 2]
    numbers, per_m, width = flat(memory), flat(system.per_mass), 3 * q.shape[0]
    for i in range(n):
        numbers[width + i] = per_m[i] * numbers[i]
    for k in range(3):
        memory[1 + S, 0, k] = balance[POWERS + k]
    for i in range(system.n_free, q.shape[0]):
        for x in range(3):
            q_s[i, x], v_s[i, x] = q[i, x], v[i, x]
    call = Call(system_address, data_address, t, h, flat(q), flat(v), memory, parameters, counts)
    for s in range(1, end):
        _stage(call, s, q_s, v_s, memory[2 * S + 3])
    status = _stage(call, end, q, v, memory[0])
    row = TABLEAU + S + end * S
    for j in range(end):
        _add_work(balance, h * parameters[row + j], memory[1 + S + j, 0])
    for k in range(3):
        balance[POWERS + k] = memory[1 + S + end, 0, k]
    return status


@internal
def judge_step(n_free, largest, h, state, parameters):
    """Error of the last step, and the product of its length and the fastest rate |lambda| of the motion.

    Each estimate e_v = h sum w_j a_j, e_q = h^2 sum (w A)_j a_j is taken at its largest component over the moving nodes. The last
    stage before the end has the time of the end too; with the differences d between both, h |lambda| is about
    |(h dv, h^2 da)|/|(dq, h dv)|.

    Returns
    -------
    error, of_places, size, stiff : float64
        The larger one of the error of positions and of that of velocities over `VELOCITY_TIME` [m], inf if the state has diverged;
        the error of positions [m]; the largest coordinate [m]; h |lambda|.
    """
    q, v = state.q, state.v
    S, end, n = int(parameters[STAGES]), int(parameters[END]), 3 * n_free
    if worst_node(q, v, largest) >= 0:
        return np.inf, np.inf, 0.0, 0.0
    weights, numbers, width = TABLEAU + S + 2 * S * S, flat(state.memory), 3 * q.shape[0]
    fine_dv, fine_dq = part(numbers, (2 * S + 4) * width, n), part(numbers, (2 * S + 5) * width, n)
    coarse_dv, coarse_dq = part(numbers, (2 * S + 6) * width, n), part(numbers, (2 * S + 7) * width, n)
    _sums(numbers, width, parameters, weights, weights + S, end + 1, n, fine_dv, fine_dq)
    _sums(numbers, width, parameters, weights + 2 * S, weights + 3 * S, end + 1, n, coarse_dv, coarse_dq)
    Q, V, Q_s, V_s = flat(q), flat(v), part(numbers, (2 * S + 1) * width, n), part(numbers, (2 * S + 2) * width, n)
    a, a_s = part(numbers, (1 + end) * width, n), part(numbers, end * width, n)
    fine_v, fine_q, coarse_v, coarse_q, size, square_above, square_below = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        fine_v, fine_q = max(fine_v, abs(fine_dv[i])), max(fine_q, abs(fine_dq[i]))
        coarse_v, coarse_q = max(coarse_v, abs(coarse_dv[i])), max(coarse_q, abs(coarse_dq[i]))
        size = max(size, abs(Q[i]))
        dq, dv, da = Q[i] - Q_s[i], h * (V[i] - V_s[i]), h * h * (a[i] - a_s[i])
        square_above += dv * dv + da * da
        square_below += dq * dq + dv * dv
    of_places = h * h * _combined(fine_q, coarse_q)
    error = max(of_places, VELOCITY_TIME * h * _combined(fine_v, coarse_v))
    return error, of_places, size, np.sqrt(square_above / square_below) if square_below > 0.0 else 0.0


@internal
def _combined(fine, coarse):
    """Combined error e^2/sqrt(e^2 + E^2/100), of order 8 for errors e and E of orders 5 and 3."""
    return fine * fine / np.sqrt(fine * fine + 0.01 * coarse * coarse) if fine > 0.0 else 0.0


@internal
def prepare_dense_output(system_address, data_address, t, h, start, memory, parameters, counts):
    """Compute the stages that only the dense output needs, of the last step, which was taken from t and the state ``start``."""
    S, end = int(parameters[STAGES]), int(parameters[END])
    call = Call(system_address, data_address, t, h, flat(start.q), flat(start.v), memory, parameters, counts)
    for s in range(end + 1, S):
        _stage(call, s, memory[2 * S + 1], memory[2 * S + 2], memory[2 * S + 3])


@internal
def dense_output(theta, h, start, memory, parameters, n_free, found):
    """Write the moving nodes of the state at t + theta h of the step from ``start`` to ``found``; add the work up to there."""
    S, n = int(parameters[STAGES]), 3 * n_free
    degree, A, balance = int(parameters[DEGREE]), TABLEAU + S, found.balance
    dense = A + 2 * S * S + 4 * S
    Q, V, Q_to, V_to = flat(start.q), flat(start.v), flat(found.q), flat(found.v)
    for i in range(n):
        Q_to[i], V_to[i] = Q[i] + theta * h * V[i], V[i]
    weights = memory[2 * S + WORKING_ROWS :, 0, 0]
    for j in range(S):
        weight = 0.0
        for k in range(degree - 1, -1, -1):
            weight = theta * (weight + parameters[dense + j * degree + k])
        weights[j] = weight
    for j in range(S):
        v_weight, q_weight = h * weights[j], 0.0
        for s in range(j + 1, S):
            q_weight += h * h * weights[s] * parameters[A + s * S + j]
        _add_work(balance, v_weight, memory[1 + S + j, 0])
        a = flat(memory[1 + j])
        for i in range(n):
            Q_to[i] += q_weight * a[i]
            V_to[i] += v_weight * a[i]
