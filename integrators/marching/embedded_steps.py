"""Marching an embedded explicit pair: steps chosen by its own error estimate, saves by its own dense output."""

from typing import NamedTuple

import numpy as np
from numba import types

from integrators.compile_once import compile_for
from integrators.jit import internal, march_loop
from integrators.schemes.embedded_pair import dense_output, judge_step, prepare_dense_output
from integrators.states import NONE, ONE, SAVED, SCRATCH, clear, copy, copy_state, save, worst_node
from integrators.step_ends import evaluate_start
from integrators.system import (
    DIVERGED,
    DONE,
    ENERGIES,
    EVENT,
    INTERRUPTED,
    NO_EVENTS,
    OUT_OF_STEPS,
    PUT_IN,
    REJECTED,
    STEP_STATE,
    STEPS,
    TAKEN_BY_METHOD,
    UNCONVERGED,
    StepState,
    system_at,
)

from .adaptive_steps import ADAPTIVE_STEPS
from .events import locate, margin_of, remember
from .step_control import MOST_REJECTIONS, growth, next_corner, shortened, shrinkage
from .stepper import STEPPER, take_step

MOST_WORK = 1_000_000  # steps tried in a run; a bound on what is otherwise unbounded
SUSTAINED, RELIEVED = 15, 6  # steps in a row after which a march counts as held by stability, and as free again (Hairer & Wanner)
MOST_GROWTH = 5.0  # of a step after another
UNSOLVED = 1e30  # error of a step that does not satisfy constraints: the next try is a fifth as long


class PairLimits(NamedTuple):
    """Numbers by which an embedded pair is marched.

    ``order`` of the pair; ``most`` steps that may be tried; ``stiff_beyond``, h |lambda| of the last two stages above which a step
    is held by stability.
    """

    order: int
    most: int
    stiff_beyond: float


PAIR_LIMITS = types.NamedTuple((types.int64, types.int64, types.float64), PairLimits)


class Stiffness(NamedTuple):
    """Steps that stability keeps short although accuracy would let them grow ("held").

    They count from `SUSTAINED` held steps on, if there are never `RELIEVED` free steps in a row between them.
    """

    held: int  # steps held
    held_for: float  # [s] their time
    held_in_row: int
    free_in_row: int
    row_for: float  # [s] time of those in a row that do not count yet


@internal
def count_held(known, is_held, h):
    """Count a step of h [s] that is held or free."""
    held, held_for, row_for = known.held, known.held_for, known.row_for
    held_in_row, free_in_row = (known.held_in_row + 1, 0) if is_held else (known.held_in_row, known.free_in_row + 1)
    row_for += h if is_held else 0.0
    if free_in_row == RELIEVED:
        held_in_row, row_for = 0, 0.0
    if held_in_row >= SUSTAINED and is_held:
        held += SUSTAINED if held_in_row == SUSTAINED else 1
        held_for += row_for
        row_for = 0.0
    return Stiffness(held, held_for, held_in_row, free_in_row, row_for)


@internal
def save_within(stepper, t, h, end, total_error, scratch, state, rows, saved):
    """Save at the times that a step from t to ``end`` has passed, by dense output; returns the rows written so far.

    ``total_error`` is the sum of the errors of places up to ``end`` [m].
    """
    system, data_address = system_at(stepper.system_address), stepper.data_address
    memory, parameters, prepared, start, balance = state.memory, stepper.parameters, False, scratch.start, scratch.balance
    noticed = scratch.noticed
    while rows < saved.t.shape[0] and saved.t[rows] <= end:
        t_saved, state_saved = saved.t[rows], StepState(saved.q[rows], saved.v[rows], memory[:0], balance)
        copy_state(state, state_saved)
        if t_saved < end:
            if not prepared:
                prepare_dense_output(stepper.system_address, data_address, t, h, start, memory, parameters, stepper.counts)
                prepared = True
            for k in range(PUT_IN, TAKEN_BY_METHOD + 1):
                balance[k] = start.balance[k]
            dense_output((t_saved - t) / h, h, start, memory, parameters, system.n_free, state_saved)
        system.prescribe(t_saved, data_address, state_saved.q, state_saved.v)
        system.project(t_saved, data_address, state_saved.q, state_saved.v)
        system.observe(t_saved, state_saved.q, state_saved.v, data_address, saved.observed[rows], balance)
        copy(balance[:ENERGIES], saved.energy[rows])
        saved.error[rows] = total_error
        copy(noticed[: saved.noticed.shape[1]], saved.noticed[rows])
        rows += 1
    return rows


@march_loop
def embedded_steps(stepper, times, pair, state, scratch, saved, stop):
    """March with steps chosen by the error that an embedded pair estimates.

    A step is accepted when its error (see `embedded_pair.judge_step`) is at most atol + rtol max|q|; the next is chosen by a PI
    controller. Steps end on t_end and on the corners of the prescribed motions; a step that ends on a corner takes the velocity
    from the left there. States at the times in ``saved.t`` come from the dense output. The march ends at an event, see
    `events.locate`.

    Parameters
    ----------
    stepper : Stepper
    times : AdaptiveSteps
    pair : PairLimits
    state, scratch, saved, stop
        As in `fixed_steps.fixed_steps`.

    Returns
    -------
    status, rows, t, node, error, held, held_for : int64, int64, float64, int64, float64, int64, float64
        As `fixed_steps.fixed_steps`, the last row being the state reached; the sum of the estimated errors of places [m]; how many
        steps stability held, and their time [s], see `Stiffness`.
    """
    system_address, data_address, counts = stepper.system_address, stepper.data_address, stepper.counts
    system, t0, t_end, corners = system_at(system_address), times.t0, times.t_end, times.corners
    evaluate_start(system_address, data_address, t0, state, counts)
    clear(scratch.noticed)
    rows = save(system_address, data_address, NONE, t0, 0.0, state, scratch.noticed, saved)
    t, h, total_error, error_before, rejections, tried = t0, times.first, 0.0, 1.0, 0, 0
    start, stiffness = scratch.start, Stiffness(NONE, 0.0, NONE, NONE, 0.0)
    corner = next_corner(corners, NONE, t, 1e-12 * (t_end - t0))
    status, node, margin, has_events = DONE, -1, -1.0, margin_of(stepper, state) > NO_EVENTS
    while t < t_end:
        if stop[0] != 0 or tried == pair.most:
            status = INTERRUPTED if stop[0] != 0 else OUT_OF_STEPS
            break
        tried += 1
        at_corner = corner < corners.shape[0] and corners[corner] < t_end
        goal = corners[corner] if at_corner else t_end
        h_wanted = h
        h, ends_on_goal = shortened(t, h, goal)
        if ends_on_goal and at_corner:  # the last stages look back from a corner: some roundings of the time before it
            h -= 1e-15 * (abs(goal) + abs(t))
        copy_state(state, start)
        if has_events:
            remember(stepper)
        taken = take_step(stepper, t, h, state)
        error, of_places, size, h_lambda = judge_step(system.n_free, system.largest, h, state, stepper.parameters)
        error_allowed = times.atol + times.rtol * size
        error = error / error_allowed if error_allowed > 0.0 or error == np.inf else (0.0 if error == 0.0 else np.inf)
        if taken != DONE and error < np.inf:
            error = UNSOLVED
        if not error <= 1.0:
            counts[REJECTED] += 1
            rejections += 1
            node = worst_node(state.q, state.v, system.largest)
            copy_state(start, state)
            h *= shrinkage(error, 1.0 * pair.order)
            if rejections > MOST_REJECTIONS or t + 0.1 * h <= t:
                status = UNCONVERGED if error < np.inf else DIVERGED
                break
            continue
        counts[STEPS] += 1
        total_error += of_places
        stiffness = count_held(stiffness, h_lambda > pair.stiff_beyond, h)
        end = goal if ends_on_goal else t + h
        if has_events:
            margin_before, margin = margin, margin_of(stepper, state)
            if margin > 0.0:
                h = locate(stepper, t, h, ONE, margin_before, margin, start, state)
                end, status = t + h, EVENT
        system.notice(end, state.q, state.v, data_address, scratch.observed_a, scratch.noticed)
        rows = save_within(stepper, t, h, end, total_error, scratch, state, rows, saved)
        t = end
        if status == EVENT:
            break
        if ends_on_goal and at_corner:
            corner += 1
            evaluate_start(system_address, data_address, t, state, counts)
        factor = growth(error, error_before, 1.0 * pair.order, MOST_GROWTH if rejections == 0 else 1.0)
        h = max(h * factor, h_wanted if h < h_wanted and error < 0.5 else 0.0)
        error_before, rejections = error, 0
    if status != DONE and saved.t[rows - 1] < t and rows < saved.t.shape[0]:  # the state that was reached
        system.prescribe(t, data_address, state.q, state.v)
        rows = save(system_address, data_address, rows, t, total_error, state, scratch.noticed, saved)
    return status, rows, t, node if status == DIVERGED else -1, total_error, stiffness.held, stiffness.held_for


def compiled_embedded_steps():
    """`embedded_steps`, compiled (or loaded from the cache) when it is first asked for."""
    stop = types.Array(types.int64, 1, "C")
    return compile_for(embedded_steps, (STEPPER, ADAPTIVE_STEPS, PAIR_LIMITS, STEP_STATE, SCRATCH, SAVED, stop))
