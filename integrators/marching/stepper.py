"""A scheme's step with all its arguments besides time and state."""

from typing import NamedTuple

import numpy as np
from numba import types

from integrators.jit import internal
from integrators.system import DONE, STEP

_f1, _i1, _i8 = types.Array(types.float64, 1, "C"), types.Array(types.int64, 1, "C"), types.int64


class Stepper(NamedTuple):
    """The compiled step, the addresses of a system and of its data, the parameters of the step, and the counts of its work."""

    step: object
    system_address: int
    data_address: int
    parameters: np.ndarray
    counts: np.ndarray


STEPPER = types.NamedTuple((types.FunctionType(STEP), _i8, _i8, _f1, _i1), Stepper)


@internal
def take_step(stepper, t, h, state):
    """Take a step of h; returns its status."""
    return stepper.step(stepper.system_address, stepper.data_address, t, h, state, stepper.parameters, stepper.counts)


@internal
def take_parts(stepper, t, h, parts, state):
    """Take h in equal parts; returns the status of the first one that fails, or of all."""
    for part in range(parts):
        status = take_step(stepper, t + part * h / parts, h / parts, state)
        if status != DONE:
            return status
    return DONE
