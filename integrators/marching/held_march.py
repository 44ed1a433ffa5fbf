"""A march that is held between its steps: all that it works on lies at one address, so that a step costs its caller little."""

from typing import NamedTuple

import numpy as np
from numba import types

from integrators.addresses import view_at, words_of
from integrators.compile_once import compile_for
from integrators.jit import march_loop
from integrators.states import worst_node
from integrators.step_ends import evaluate_start
from integrators.system import DIVERGED, DONE, NO_EVENTS, STEP, STEP_STATE, StepState, system_at

from .events import margin_of
from .one_step import one_step
from .stepper import Stepper

_f1, _i1, _i8 = types.Array(types.float64, 1, "C"), types.Array(types.int64, 1, "C"), types.int64
TIME, MARGIN = 0, 1  # in `HeldMarch.numbers`


class HeldMarch(NamedTuple):
    """What a march works on between its steps.

    Parameters
    ----------
    step : the compiled step of a scheme
    system_address, data_address : int
    needs_copied_start : int, 1 if a step may fail and leave another state than the one before it
    parameters, counts : of a `Stepper`
    state : StepState
    start : StepState, scratch
    numbers : (2,) float64, the time reached [s] and the margin there
    """

    step: object
    system_address: int
    data_address: int
    needs_copied_start: int
    parameters: np.ndarray
    counts: np.ndarray
    state: StepState
    start: StepState
    numbers: np.ndarray


HELD_MARCH = types.NamedTuple((types.FunctionType(STEP), _i8, _i8, _i8, _f1, _i1, STEP_STATE, STEP_STATE, _f1), HeldMarch)
_march_at = view_at(HELD_MARCH)


@march_loop
def begin(address):
    """Evaluate the state of a march at its time, as a march does before its first step."""
    march = _march_at(address)
    stepper = Stepper(march.step, march.system_address, march.data_address, march.parameters, march.counts)
    evaluate_start(march.system_address, march.data_address, march.numbers[TIME], march.state, march.counts)
    margin = margin_of(stepper, march.state)
    march.numbers[MARGIN] = -1.0 if margin > NO_EVENTS else NO_EVENTS


@march_loop
def step_to(address, goal):
    """Take one step that ends at the time ``goal`` [s], or at an event before it.

    Returns
    -------
    status, node : int64
        How it ended, and the node where it went wrong (or -1).
    """
    march = _march_at(address)
    stepper = Stepper(march.step, march.system_address, march.data_address, march.parameters, march.counts)
    numbers, state, t = march.numbers, march.state, march.numbers[TIME]
    status, t_reached, margin = one_step(stepper, t, goal - t, march.needs_copied_start == 1, numbers[MARGIN], march.start, state)
    numbers[TIME], numbers[MARGIN] = goal if status == DONE else t_reached, margin
    node = worst_node(state.q, state.v, system_at(march.system_address).largest)
    if status == DONE and node >= 0:
        status = DIVERGED
    return status, node


def compiled():
    """`begin` and `step_to`, compiled (or loaded from the cache) when they are first asked for."""
    return compile_for(begin, (_i8,)), compile_for(step_to, (_i8, types.float64))


def words_in_memory(march):
    """A march as words (k,) int64, whose address its functions are given; the array and the march must outlive the calls."""
    return np.array(words_of(march), np.int64)
