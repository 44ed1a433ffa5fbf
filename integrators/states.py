"""States of a march in compiled code: copies of them, the rows that are saved, and whether a state has diverged."""

from typing import NamedTuple

import numpy as np
from numba import njit, types

from .system import ENERGIES, StepState, system_at

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))

# Integers for the calls of compiled functions, which Numba would compile once more for a literal 0, 1 or 2.
NONE, ONE, TWO = np.int64(0), np.int64(1), np.int64(2)
LARGEST_SIZE = 1e6  # [m] plus [m/s] of a node, beyond which a motion has diverged


class Saved(NamedTuple):
    """Rows that a march saves: times (k,) [s], q, v (k, n, 3), energies (k, ENERGIES) [J], what the system observes (k, any)."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    energy: np.ndarray
    observed: np.ndarray


SAVED = types.NamedTuple((_f1, _f3, _f3, _f2, _f2), Saved)


@njit(cache=True, error_model="numpy")
def copy(source, target):
    """Copy a flat array; an assignment of arrays would compile for seconds, for the errors that it may raise."""
    for i in range(source.shape[0]):
        target[i] = source[i]


@njit(cache=True, error_model="numpy")
def copy_of(state, carried_rows):
    """A state of its own, with the rows of memory that a scheme carries from step to step."""
    return StepState(state.q.copy(), state.v.copy(), state.memory[:carried_rows].copy(), state.balance.copy())


@njit(cache=True, error_model="numpy")
def copy_state(source, target):
    """Copy a state, and as many rows of memory as both have."""
    copy(source.q.ravel(), target.q.ravel())
    copy(source.v.ravel(), target.v.ravel())
    rows = min(source.memory.shape[0], target.memory.shape[0])
    copy(source.memory[:rows].ravel(), target.memory.ravel())
    copy(source.balance, target.balance)


@njit(cache=True, error_model="numpy")
def save(system_address, data_address, k, t, state, saved):
    """Write row k of what is saved; returns the number of rows written."""
    system = system_at(system_address)
    system.observe(state.q, state.v, data_address, saved.observed[k])
    system.energy(t, state.q, state.v, data_address, state.balance)
    saved.t[k] = t
    copy(state.q.ravel(), saved.q[k].ravel())
    copy(state.v.ravel(), saved.v[k].ravel())
    copy(state.balance[:ENERGIES], saved.energy[k])
    return k + 1


@njit(cache=True, error_model="numpy")
def worst_node(q, v):
    """Node whose place or velocity is not finite or beyond `LARGEST_SIZE`, or -1."""
    for i in range(q.shape[0]):
        size = 0.0
        for x in range(3):
            size += abs(q[i, x]) + abs(v[i, x])
        if not size < LARGEST_SIZE:
            return i
    return -1
