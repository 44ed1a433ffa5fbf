"""Forces at the start of a march and at the end of a step, and the work of a step by the trapezoidal rule."""

from .jit import internal
from .system import (
    FORCES,
    POWER_INSIDE,
    POWER_OUTSIDE,
    POWER_PUT_IN,
    POWERS,
    PUT_IN,
    SCRATCH,
    TAKEN_INSIDE,
    TAKEN_OUTSIDE,
    system_at,
)


@internal
def evaluate_start(system_address, data_address, t, state, counts):
    """Prescribed rows, what constraints ask for, the force in ``state.memory[0]``, and its powers."""
    system, balance = system_at(system_address), state.balance
    power = balance[SCRATCH:]
    system.prescribe(t, data_address, state.q, state.v)
    balance[PUT_IN] += system.project(t, data_address, state.q, state.v)
    system.force(t, state.q, state.v, data_address, state.memory[0], power)
    counts[FORCES] += 1
    for k in range(3):
        balance[POWERS + k] = power[k]


@internal
def add_work(balance, time, power):
    """Add the work of powers (3,) [W] over a time [s] to the account of energy."""
    balance[TAKEN_INSIDE] += time * power[POWER_INSIDE]
    balance[TAKEN_OUTSIDE] += time * power[POWER_OUTSIDE]
    balance[PUT_IN] += time * power[POWER_PUT_IN]


@internal
def evaluate_end(system_address, data_address, t, h, state, counts, end_share=0.5):
    """Write the prescribed rows at t + h, what constraints ask for, and the force there, in ``state.memory[0]``.

    Adds the work of the step from t. The dissipated energy weights the powers at the end of the step by ``end_share``, the weight
    of the forces there in the step.
    """
    system, balance = system_at(system_address), state.balance
    power = balance[SCRATCH:]
    system.prescribe(t + h, data_address, state.q, state.v)
    balance[PUT_IN] += system.project(t + h, data_address, state.q, state.v)
    system.force(t + h, state.q, state.v, data_address, state.memory[0], power)
    counts[FORCES] += 1
    power_at_start, start_share = balance[POWERS:], 1.0 - end_share
    balance[TAKEN_INSIDE] += h * (start_share * power_at_start[POWER_INSIDE] + end_share * power[POWER_INSIDE])
    balance[TAKEN_OUTSIDE] += h * (start_share * power_at_start[POWER_OUTSIDE] + end_share * power[POWER_OUTSIDE])
    balance[PUT_IN] += 0.5 * h * (power_at_start[POWER_PUT_IN] + power[POWER_PUT_IN])
    for k in range(3):
        power_at_start[k] = power[k]
