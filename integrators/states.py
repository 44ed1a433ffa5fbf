"""States of a march in compiled code: copies of them, the rows that are saved, and whether a state has diverged."""

from typing import NamedTuple

import numpy as np
from numba import types

from .flat_view import fetch_line, flat
from .jit import inlined, internal
from .system import BALANCE, ENERGIES, STEP_STATE, StepState, system_at

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))

# Integers as arguments of compiled functions: for a literal 0, 1 or 2 Numba would compile a function once more.
NONE, ONE, TWO = np.int64(0), np.int64(1), np.int64(2)
LINE = 8  # numbers in a line of a processor's cache


class Saved(NamedTuple):
    """Rows that a march saves.

    Times (k,) [s], q, v (k, n, 3), energies (k, ENERGIES) [J], what the system observes (k, any), the largest error of a place
    so far, as far as it is known (k,) [m], and what the system has noticed so far (k, any): nothing where every step is saved.
    """

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    energy: np.ndarray
    observed: np.ndarray
    error: np.ndarray
    noticed: np.ndarray


SAVED = types.NamedTuple((_f1, _f3, _f3, _f2, _f2, _f1, _f2), Saved)


class Scratch(NamedTuple):
    """Arrays that a march works in.

    ``start``: a copy of the state at the start of a step. ``q`` (n, 3): positions. ``balance`` (BALANCE,): an energy balance.
    ``observed_a``, ``observed_b``: what the system observes at the start and at the end of a step. ``noticed``: what it notices.
    """

    start: StepState
    q: np.ndarray
    balance: np.ndarray
    observed_a: np.ndarray
    observed_b: np.ndarray
    noticed: np.ndarray


SCRATCH = types.NamedTuple((STEP_STATE, _f2, _f1, _f1, _f1, _f1), Scratch)


def scratch_for(state, carried_rows, observed, notices=0):
    """`Scratch` for a march of a state, with a scheme that carries some rows of memory from step to step.

    Parameters
    ----------
    state : StepState
    carried_rows : int
    observed, notices : int, how many numbers the system observes and notices
    """
    start = StepState(np.empty_like(state.q), np.empty_like(state.v), np.empty_like(state.memory[:carried_rows]), np.zeros(BALANCE))
    rows = np.zeros(observed), np.zeros(observed), np.zeros(2 * notices)
    return Scratch(start, np.empty_like(state.q), np.zeros(BALANCE), *rows)


@internal
def copy(source, target):
    """Copy a flat array. An assignment of arrays would take seconds to compile, because it may raise errors."""
    for i in range(source.shape[0]):
        target[i] = source[i]


@internal
def clear(array):
    """Set a flat array to zero."""
    for i in range(array.shape[0]):
        array[i] = 0.0


@internal
def fetch_row(row):
    """Let a processor fetch a flat array that is to be written, so that it need not wait when it writes."""
    for i in range(0, row.shape[0], LINE):
        fetch_line(row, i)


@internal
def copy_state(source, target):
    """Copy a state, and as many rows of memory as both have."""
    copy(flat(source.q), flat(target.q))
    copy(flat(source.v), flat(target.v))
    rows = min(source.memory.shape[0], target.memory.shape[0])
    copy(flat(source.memory[:rows]), flat(target.memory))
    copy(source.balance, target.balance)


@internal
def save(system_address, data_address, k, t, error, state, noticed, saved):
    """Write row k of what is saved, with the error of places and what was noticed so far; returns the number of rows written."""
    system = system_at(system_address)
    system.observe(t, state.q, state.v, data_address, saved.observed[k], state.balance)
    saved.t[k], saved.error[k] = t, error
    copy(flat(state.q), flat(saved.q[k]))
    copy(flat(state.v), flat(saved.v[k]))
    copy(state.balance[:ENERGIES], saved.energy[k])
    copy(noticed[: saved.noticed.shape[1]], saved.noticed[k])
    if k + 1 < saved.t.shape[0]:  # the next row comes from memory while the next step is taken
        fetch_row(flat(saved.q[k + 1]))
        fetch_row(flat(saved.v[k + 1]))
        fetch_row(saved.observed[k + 1])
    return k + 1


@inlined
def _distance(q, v, i, j):
    """Distance of two nodes plus the difference of their velocities, by the sums of their components; q and v are given flat."""
    a, b = 3 * i, 3 * j
    return (
        abs(q[a] - q[b]) + abs(q[a + 1] - q[b + 1]) + abs(q[a + 2] - q[b + 2])
        + abs(v[a] - v[b]) + abs(v[a + 1] - v[b + 1]) + abs(v[a + 2] - v[b + 2])
    )  # fmt: skip


@internal
def worst_node(q, v, largest):
    """The first node that is not finite, or farther than ``largest`` from the last node, see `System`; -1 if there is none."""
    flat_q, flat_v, n, within = flat(q), flat(v), q.shape[0], 0
    for i in range(n):  # counted, without a way out: so several are looked at at once
        within += 1 if _distance(flat_q, flat_v, i, n - 1) < largest else 0
    if within == n:
        return -1
    for i in range(n):
        if not _distance(flat_q, flat_v, i, n - 1) < largest:
            return i
    return -1
