"""The event that ends a march: where the margin of a system turns positive within a step."""

from integrators.jit import internal
from integrators.states import copy_state
from integrators.system import DONE, SAME_TIME, system_at

from .stepper import take_parts

MARGIN_FOUND = 1e-8  # an event is found if the margin is at most this, or its time is known to `SAME_TIME` of a step
TRIALS = 60  # steps that the search for an event may take
AT_ONCE = 1e-6  # of a step: an event nearer to its start is one of a margin that jumps when a step is taken, however short


@internal
def remember(stepper):
    """Let the system copy the data that a step leaves to the next one."""
    system_at(stepper.system_address).remember(stepper.data_address, 0)


@internal
def margin_of(stepper, state):
    """How far a state is beyond an event, see `System.margin`."""
    return system_at(stepper.system_address).margin(state.q, state.v, stepper.data_address)


@internal
def _go_back(stepper, start, state):
    """Go back to the start of the step."""
    copy_state(start, state)
    system_at(stepper.system_address).remember(stepper.data_address, 1)


@internal
def locate(stepper, t, h, parts, margin_before, margin_after, start, state):
    """Find the event within a step at whose end the margin is positive, by shorter steps from the same start.

    Regula falsi on the length of the step with Illinois' rule. The margin changes its sign between two lengths, and the interval
    between both shrinks, whatever the margin does. Where every step has a positive margin, however short, as the mean tension of a
    spring that does not stretch may have, the event is taken where the margin is zero on the straight line between its values at
    both ends of the step. Source: Dowell & Jarratt, BIT 11 (1971) 168.

    Parameters
    ----------
    t, h : float64 [s]
        Start of the step and its length, which is taken in ``parts`` equal steps.
    margin_before, margin_after : float64
        Margin at its start, or any number below zero, and at its end.
    start : StepState
        The state at its start; `remember` must have been called there.
    state : StepState
        At the end of the step; overwritten by the state at the event.

    Returns
    -------
    length : float64 [s]
        The shortest length found with a positive margin; the state is the one at its end.
    """
    low, high, margin_low, margin_high, margin = 0.0, h, min(margin_before, -MARGIN_FOUND), margin_after, margin_after
    length_taken, side, first = h, 0, 0.0
    for _ in range(TRIALS):
        if margin <= MARGIN_FOUND or high - low <= SAME_TIME * h:
            break
        trial = high - margin_high * (high - low) / (margin_high - margin_low)
        least_distance = 1e-3 * (high - low)
        trial = min(max(trial, low + least_distance), high - least_distance)
        if first == 0.0:
            first = trial
        _go_back(stepper, start, state)
        if take_parts(stepper, t, trial, parts, state) != DONE:
            length_taken = -1.0
            break
        length_taken, margin_there = trial, margin_of(stepper, state)
        if margin_there > 0.0:
            high, margin_high, margin = trial, margin_there, margin_there
            margin_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, margin_low = trial, min(margin_there, -MARGIN_FOUND * MARGIN_FOUND)
            margin_high *= 0.5 if side == -1 else 1.0
            side = -1
    if high <= AT_ONCE * h and margin > MARGIN_FOUND:
        high = first
    if length_taken != high:
        _go_back(stepper, start, state)
        take_parts(stepper, t, high, parts, state)
    return high
