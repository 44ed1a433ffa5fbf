"""One step of a march with fixed steps, taken in halves, quarters and so on where its equations are not solved."""

from integrators.jit import internal
from integrators.states import ONE, copy_state, worst_node
from integrators.system import DONE, EVENT, HALVINGS, NO_EVENTS, STEPS, UNCONVERGED, system_at

from .events import locate, margin_of, remember
from .stepper import take_step

SMALLEST_PART = 2.0**-12  # of a step: a march ends where Newton's method fails for a shorter one


@internal
def one_step(stepper, t, length, needs_copied_start, margin, start, state):
    """Take a step from t; it ends at an event, see `events.locate`.

    Parameters
    ----------
    stepper : Stepper
    t, length : float64 [s]
    needs_copied_start : bool
        Whether a step may fail and leave another state than the one before it. If not, that is copied only for events.
    margin : float64
        Margin of the system at t; `NO_EVENTS` if it has no events.
    start : StepState, overwritten by the state before the last part of the step
    state : StepState, at t, and then at the end

    Returns
    -------
    status, t, margin : int64, float64 [s], float64
        How it ended, the time reached, the margin there.
    """
    counts, taken, part, has_events = stepper.counts, 0.0, 1.0, margin > NO_EVENTS
    copies_start = has_events or needs_copied_start
    largest = system_at(stepper.system_address).largest
    while taken < 1.0:
        if copies_start:
            copy_state(state, start)
        if has_events:
            remember(stepper)
        t_part, h = t + taken * length, part * length
        if take_step(stepper, t_part, h, state) != DONE:
            if copies_start:
                copy_state(start, state)
            counts[HALVINGS] += 1
            part *= 0.5
            if part < SMALLEST_PART:
                return UNCONVERGED, t_part, margin
            continue
        counts[STEPS] += 1
        if has_events:
            margin_before, margin = margin, margin_of(stepper, state)
            if margin > 0.0 and worst_node(state.q, state.v, largest) < 0:
                t_part += locate(stepper, t_part, h, ONE, margin_before, margin, start, state)
                return EVENT, t_part, margin
        taken += part
        if taken % (2.0 * part) == 0.0:
            part = min(2.0 * part, 1.0)
    return DONE, t + length, margin
