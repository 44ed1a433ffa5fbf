"""Forces at the start of a march and at the end of a step, and the work of a step by the trapezoidal rule."""

from numba import njit

from .system import DISSIPATED, FORCES, POWER_DISSIPATED, POWER_PUT_IN, PUT_IN, SCRATCH, system_at


@njit(cache=True, error_model="numpy")
def evaluate_start(system_address, data_address, t, state, counts):
    """Prescribed rows, the force in ``state.memory[0]``, and its powers."""
    system, balance = system_at(system_address), state.balance
    power = balance[SCRATCH:]
    system.prescribe(t, data_address, state.q, state.v)
    system.force(t, state.q, state.v, data_address, state.memory[0], power)
    counts[FORCES] += 1
    balance[POWER_DISSIPATED], balance[POWER_PUT_IN] = power[0], power[1]


@njit(cache=True, error_model="numpy")
def evaluate_end(system_address, data_address, t, h, state, counts, end_share=0.5):
    """Prescribed rows and the force at t + h in ``state.memory[0]``; adds the work of the step from t.

    Of the power dissipated, that at the end has the ``end_share`` that its forces have in the step.
    """
    system, balance = system_at(system_address), state.balance
    power = balance[SCRATCH:]
    system.prescribe(t + h, data_address, state.q, state.v)
    system.force(t + h, state.q, state.v, data_address, state.memory[0], power)
    counts[FORCES] += 1
    dissipated, put_in = power[0], power[1]
    balance[DISSIPATED] += h * ((1.0 - end_share) * balance[POWER_DISSIPATED] + end_share * dissipated)
    balance[PUT_IN] += 0.5 * h * (balance[POWER_PUT_IN] + put_in)
    balance[POWER_DISSIPATED], balance[POWER_PUT_IN] = dissipated, put_in
