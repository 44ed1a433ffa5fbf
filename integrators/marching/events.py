"""The event that ends a march: where the margin of a system turns positive within a step."""

from integrators.jit import internal
from integrators.states import copy_state
from integrators.system import DONE, SAME_TIME, system_at

from .stepper import take_parts

NEAR = 1e-8  # margin of an event to which its time is found, or else to `SAME_TIME`
TRIALS = 60  # steps that finding it may take
AT_ONCE = 1e-6  # of a step: an event nearer to its start is one of the margin that jumps when a step is taken, however short


@internal
def remember(stepper):
    """Have the system copy what its steps leave to the next."""
    system_at(stepper.system_address).remember(stepper.data_address, 0)


@internal
def margin_of(stepper, state):
    """How far a state is beyond an event, see `System.margin`."""
    return system_at(stepper.system_address).margin(state.q, state.v, stepper.data_address)


@internal
def _back(stepper, start, state):
    """Go back to the start of the step."""
    copy_state(start, state)
    system_at(stepper.system_address).remember(stepper.data_address, 1)


@internal
def locate(stepper, t, h, parts, before, after, start, state):
    """Find the event within a step, at whose end the margin is positive: the step is taken again, from its start and shorter.

    Regula falsi on the length of the step with Illinois' rule; whatever the margin does, its sign changes between two lengths
    that close up on each other. Where every step has a positive margin, however short, as the mean tension of a spring that does
    not stretch may have, the event is taken where the margin is zero on the straight line between its values at both ends of the
    step. Source: Dowell & Jarratt, BIT 11 (1971) 168.

    Parameters
    ----------
    t, h : float64 [s]
        Start of the step and its length, taken in ``parts`` equal ones.
    before, after : float64
        Margin at its start, or any number below zero, and at its end.
    start : StepState
        Copied at its start, when the system was told to remember.
    state : StepState
        At the end of the step; then at the event.

    Returns
    -------
    length : float64 [s]
        Shortest one found with a positive margin; the state is the one at its end.
    """
    low, high, g_low, g_high, margin, here, side = 0.0, h, min(before, -NEAR), after, after, h, 0
    first = 0.0
    for _ in range(TRIALS):
        if margin <= NEAR or high - low <= SAME_TIME * h:
            break
        trial = high - g_high * (high - low) / (g_high - g_low)
        nearest = 1e-3 * (high - low)
        trial = min(max(trial, low + nearest), high - nearest)
        if first == 0.0:
            first = trial
        _back(stepper, start, state)
        if take_parts(stepper, t, trial, parts, state) != DONE:
            here = -1.0
            break
        here, found = trial, margin_of(stepper, state)
        if found > 0.0:
            high, g_high, margin = trial, found, found
            g_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, g_low = trial, min(found, -NEAR * NEAR)
            g_high *= 0.5 if side == -1 else 1.0
            side = -1
    if high <= AT_ONCE * h and margin > NEAR:
        high = first
    if here != high:
        _back(stepper, start, state)
        take_parts(stepper, t, high, parts, state)
    return high
