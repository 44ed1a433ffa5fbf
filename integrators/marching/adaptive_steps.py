"""Marching with steps chosen by step doubling: one step of h is compared with two of h/2, and the march goes on from the two.

The error of the two is |q_2 - q_1|/(2^order - 1) by Richardson's estimate. A step is accepted when the largest component of its
error over the moving nodes is at most atol + rtol max|q|; the next is chosen by a PI controller (`step_control.growth`). Source:
Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.4.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from integrators.compile_once import compile_for
from integrators.flat_view import flat
from integrators.jit import internal, march_loop
from integrators.states import NONE, SAVED, SCRATCH, TWO, clear, copy, copy_state, save, worst_node
from integrators.step_ends import evaluate_start
from integrators.system import (
    DONE,
    ENERGIES,
    EVENT,
    INTERRUPTED,
    NO_EVENTS,
    REJECTED,
    STEP_STATE,
    STEPS,
    UNCONVERGED,
    system_at,
)

from .events import locate, margin_of, remember
from .step_control import MOST_REJECTIONS, growth, next_corner, shortened, shrinkage
from .stepper import STEPPER, take_step

SMALLEST_PART = 2.0**-12  # of the first step: a march ends where Newton's method fails for a shorter one
MOST_GROWTH = 4.0  # of a step after another


class AdaptiveSteps(NamedTuple):
    """Times and tolerances of a march that chooses its steps.

    Parameters
    ----------
    t0, t_end : float [s]
    first : float [s], the first step
    rtol, atol : float, [m]
        The error of a step is kept below atol + rtol times the largest coordinate.
    corners : increasing (k,) float64 [s]
        Times that a step must end on, besides t_end.
    """

    t0: float
    t_end: float
    first: float
    rtol: float
    atol: float
    corners: np.ndarray


ADAPTIVE_STEPS = types.NamedTuple((types.float64,) * 5 + (types.Array(types.float64, 1, "C"),), AdaptiveSteps)


@internal
def interpolate(theta, h, start, end, q, v):
    """Positions and velocities at the share theta of a step of length h between two states, by a cubic Hermite polynomial."""
    complement, q_a, v_a, q_b, v_b = 1.0 - theta, start.q, start.v, end.q, end.v
    for i in range(q.shape[0]):
        for x in range(3):
            rise = q_b[i, x] - q_a[i, x]
            curve_a, curve_b = h * v_a[i, x] - rise, rise - h * v_b[i, x]
            q[i, x] = complement * q_a[i, x] + theta * q_b[i, x] + theta * complement * (complement * curve_a + theta * curve_b)
            slope = rise + (1.0 - 2.0 * theta) * (complement * curve_a + theta * curve_b) + theta * complement * (curve_b - curve_a)
            v[i, x] = slope / h


@internal
def largest_coordinate(q):
    """Largest coordinate of any node [m]."""
    largest = 0.0
    for x in flat(q):
        largest = max(largest, abs(x))
    return largest


@internal
def double_step(stepper, t, h, order, start, state, whole):
    """Take a step of h, then two of h/2 from the same start.

    Parameters
    ----------
    start : StepState
        A copy of the state at t.
    state : StepState
        At t; overwritten by the state after the two steps.
    whole : (n, 3) float64
        Overwritten by the positions after the one step.

    Returns
    -------
    error, size : float64 [m]
        Estimated error of positions, inf if a step failed or the state has diverged; the largest coordinate.
    """
    if take_step(stepper, t, h, state) != DONE:
        return np.inf, 0.0
    copy(flat(state.q), flat(whole))
    copy_state(start, state)
    if take_step(stepper, t, 0.5 * h, state) != DONE or take_step(stepper, t + 0.5 * h, 0.5 * h, state) != DONE:
        return np.inf, 0.0
    system, error, size = system_at(stepper.system_address), 0.0, 0.0
    for i in range(system.n_free):
        for x in range(3):
            error = max(error, abs(state.q[i, x] - whole[i, x]))
            size = max(size, abs(state.q[i, x]))
    return error / (2.0**order - 1.0) if worst_node(state.q, state.v, system.largest) < 0 else np.inf, size


@march_loop
def adaptive_steps(stepper, times, order, state, scratch, saved, stop):
    """March from t0 to t_end, saving at the times in ``saved.t`` by interpolation.

    Steps end on the corners of the prescribed motions and on t_end. The march ends at an event, see `events.locate`; its last
    row is the state there.

    Parameters
    ----------
    stepper : Stepper
    times : AdaptiveSteps
    order : int64, of the scheme
    state, scratch, saved, stop
        As in `fixed_steps.fixed_steps`.

    Returns
    -------
    status, rows, t, node, error : int64, int64, float64, int64, float64
        As `fixed_steps.fixed_steps`, and the sum of the accepted errors [m].
    """
    system_address, data_address, counts = stepper.system_address, stepper.data_address, stepper.counts
    system, t0, t_end, atol, rtol = system_at(system_address), times.t0, times.t_end, times.atol, times.rtol
    evaluate_start(system_address, data_address, t0, state, counts)
    noticed = scratch.noticed
    clear(noticed)
    rows = save(system_address, data_address, NONE, t0, 0.0, state, noticed, saved)
    start, whole, balance_saved, observed_a = scratch.start, scratch.q, scratch.balance, scratch.observed_a
    observed_b = scratch.observed_b
    copy(saved.observed[0], observed_b)
    t, h, total_error, error_before, rejections, corner = t0, times.first, 0.0, 1.0, 0, NONE
    margin, has_events, status = -1.0, margin_of(stepper, state) > NO_EVENTS, DONE
    while t < t_end:
        if stop[0] != 0:
            return INTERRUPTED, rows, t, -1, total_error
        corner = next_corner(times.corners, corner, t, 1e-12 * (t_end - t0))
        goal = min(times.corners[corner], t_end) if corner < times.corners.shape[0] else t_end
        h_wanted = h
        h, _ = shortened(t, h, goal)
        copy_state(state, start)
        if has_events:
            remember(stepper)
        error, size = double_step(stepper, t, h, order, start, state, whole)
        allowed = atol + rtol * size
        error = error / allowed if allowed > 0.0 or error == np.inf else (0.0 if error == 0.0 else np.inf)  # nothing moves
        if not error <= 1.0:
            counts[REJECTED] += 1
            rejections += 1
            copy_state(start, state)
            h *= shrinkage(error, order + 1.0)
            if rejections > MOST_REJECTIONS or (error == np.inf and h < SMALLEST_PART * times.first):
                return UNCONVERGED, rows, t, -1, total_error
            continue
        counts[STEPS] += 1
        total_error += error * (atol + rtol * largest_coordinate(state.q))
        end = goal if t + h >= goal - 1e-9 * h else t + h
        if has_events:
            margin_before, margin = margin, margin_of(stepper, state)
            if margin > 0.0:
                status = EVENT
                end = t + locate(stepper, t, h, TWO, margin_before, margin, start, state)
        copy(observed_b, observed_a)
        system.observe(end, state.q, state.v, data_address, observed_b, balance_saved[:0])
        while rows < saved.t.shape[0] and saved.t[rows] <= end:
            theta = (saved.t[rows] - t) / (end - t)
            interpolate(theta, end - t, start, state, saved.q[rows], saved.v[rows])
            copy(state.balance, balance_saved)
            system.observe(saved.t[rows], saved.q[rows], saved.v[rows], data_address, saved.observed[rows], balance_saved)
            copy(balance_saved[:ENERGIES], saved.energy[rows])
            for i in range(observed_a.shape[0]):  # in place of what a state says that no step has reached
                saved.observed[rows, i] = (1.0 - theta) * observed_a[i] + theta * observed_b[i]
            saved.error[rows] = total_error
            copy(noticed[: saved.noticed.shape[1]], saved.noticed[rows])
            rows += 1
        t = end
        system.notice(t, state.q, state.v, data_address, observed_a, noticed)
        if status == EVENT:
            if saved.t[rows - 1] < t:
                rows = save(system_address, data_address, rows, t, total_error, state, noticed, saved)
            return EVENT, rows, t, -1, total_error
        h = max(h * growth(error, error_before, order + 1.0, MOST_GROWTH), h_wanted if h < h_wanted and error < 0.5 else 0.0)
        error_before, rejections = error, 0
    return DONE, rows, t, -1, total_error


def compiled_adaptive_steps():
    """`adaptive_steps`, compiled (or loaded from the cache) when it is first asked for."""
    stop = types.Array(types.int64, 1, "C")
    return compile_for(adaptive_steps, (STEPPER, ADAPTIVE_STEPS, types.int64, STEP_STATE, SCRATCH, SAVED, stop))
