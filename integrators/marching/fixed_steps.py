"""Marching with fixed steps; a step whose equations are not solved is taken in halves, quarters and so on."""

from typing import NamedTuple

import numpy as np
from numba import types

from integrators.compile_once import compile_for
from integrators.jit import march_loop
from integrators.states import NONE, SAVED, SCRATCH, clear, save, worst_node
from integrators.step_ends import evaluate_start
from integrators.system import (
    DIVERGED,
    DONE,
    INTERRUPTED,
    NO_EVENTS,
    SAME_TIME,
    STEP_STATE,
    system_at,
)

from .error_growth import GROWTH, STEP_ERROR, WAITS, begin, follow, largest_error
from .events import margin_of
from .one_step import one_step
from .stepper import STEPPER

CHECK_EVERY = 16  # steps between two checks for a divergence


class FixedSteps(NamedTuple):
    """Times of a march with fixed steps.

    Parameters
    ----------
    t0, t_end : float [s]
    dt : float [s]
        Steps end on multiples of it after ``origin``, and the last one on t_end.
    origin : float [s], at most t0
    stride : int
        Every stride-th state after ``origin`` is saved, and the first and the last one.
    look_every : int
        Of the states that are not saved, every look_every-th is looked at, see `System.notice`; 0 looks at none.
    """

    t0: float
    t_end: float
    dt: float
    origin: float
    stride: int
    look_every: int = 0


FIXED_STEPS = types.NamedTuple((types.float64,) * 4 + (types.int64,) * 2, FixedSteps)


@march_loop
def fixed_steps(stepper, times, step_error, state, scratch, growth, saved, stop):
    """March from t0 to t_end; the march ends at an event, see `events.locate`.

    Parameters
    ----------
    stepper : Stepper
    times : FixedSteps
    step_error : StepError
    state : StepState, at the start, and then at the end
    scratch : Scratch
    growth : Growth, overwritten
    saved : Saved, rows to write
    stop : (1,) int64, ends the march when another thread sets it

    Returns
    -------
    status, rows, t, node : int64, int64, float64, int64
        How it ended, rows written, time reached, and the node where it went wrong (or -1).
    """
    system_address, data_address, counts, t = stepper.system_address, stepper.data_address, stepper.counts, times.t0
    system = system_at(system_address)
    n_free, largest = system.n_free, system.largest
    evaluate_start(system_address, data_address, t, state, counts)
    noticed = scratch.noticed
    clear(noticed)
    rows = save(system_address, data_address, NONE, t, 0.0, state, noticed, saved)
    steps, weight, error, error_is_current = begin(growth, state.v, n_free), 1.0, 0.0, True
    start, margin = scratch.start, -1.0 if margin_of(stepper, state) > NO_EVENTS else NO_EVENTS
    last = max(1, int(np.ceil((times.t_end - times.origin) / times.dt - SAME_TIME))) - 1
    for s in range(min(int(np.floor((times.t0 - times.origin) / times.dt + SAME_TIME)), last), last + 1):
        goal = times.t_end if s == last else times.origin + (s + 1) * times.dt
        length = goal - t
        status, t_reached, margin = one_step(stepper, t, length, step_error.needs_copied_start, margin, start, state)
        if status != DONE:
            rows = save(system_address, data_address, rows, t_reached, largest_error(growth, n_free), state, noticed, saved)
            return status, rows, t_reached, -1
        t = goal
        if steps < WAITS:  # not worth a call, where a step of a small system costs no more than one
            steps += 1
        else:
            steps, weight = follow(growth, step_error, steps, weight, length, state.v, n_free)
            error_is_current = error_is_current and steps >= 0  # below 0, errors have grown
        is_last = s == last or stop[0] != 0
        is_saved = (s + 1) % times.stride == 0 or is_last
        if is_saved or s % CHECK_EVERY == 0:
            node = worst_node(state.q, state.v, largest)
            if node >= 0:
                return DIVERGED, rows, t, node
        if is_saved:
            if not error_is_current:
                error, error_is_current = largest_error(growth, n_free), True
            rows = save(system_address, data_address, rows, t, error, state, noticed, saved)
        elif times.look_every > 0 and (s + 1) % times.look_every == 0:
            system.notice(t, state.q, state.v, data_address, scratch.observed_a, noticed)
        if stop[0] != 0:
            return INTERRUPTED, rows, t, -1
    return DONE, rows, t, -1


def compiled_fixed_steps():
    """`fixed_steps`, compiled (or loaded from the cache) when it is first asked for."""
    stop = types.Array(types.int64, 1, "C")
    return compile_for(fixed_steps, (STEPPER, FIXED_STEPS, STEP_ERROR, STEP_STATE, SCRATCH, GROWTH, SAVED, stop))
