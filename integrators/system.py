"""What an integrator is given: M dv/dt = f(t, q, v) for the first ``n_free`` nodes, the rest prescribed.

The compiled functions of a system are first-class (`numba.types.FunctionType`), so that a scheme is compiled and cached once
and for all. Whatever they work on is handed through by its address, ``data_address``, which they alone understand; a scheme is
given the address of the system too, ``system_address``, and looks at it with `system_at`.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import types

from .addresses import view_at, words_of
from .stage import STAGE

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")
_f8, _i8 = types.float64, types.int64

# Status of a step or a run.
DONE, UNCONVERGED, DIVERGED, INTERRUPTED, OUT_OF_STEPS, EVENT = 0, 1, 2, 3, 4, 5
SAME_TIME = 1e-6  # of a step: times that are no farther apart are one; a velocity over less shows rounding
NO_EVENTS = -1e300  # margin of a system that no event can stop
# Work counts.
STEPS, REJECTED, HALVINGS, FORCES, NEWTON, FACTORISATIONS = range(6)
COUNTS = 6  # numbers in all
# Energy balance: kinetic, elastic, potential energy now; since the start, work put in, and energy that internal dampers took, that
# external forces took and that the scheme itself took; then powers at the current time, from which work is integrated, and scratch.
KINETIC, ELASTIC, POTENTIAL, PUT_IN, TAKEN_INSIDE, TAKEN_OUTSIDE, TAKEN_BY_METHOD, POWERS, SCRATCH = 0, 1, 2, 3, 4, 5, 6, 7, 10
BALANCE = 13  # numbers in all
ENERGIES = 7  # numbers of these that are saved
# Powers that come with a force: what internal dampers take, what external forces take, what is put in; and where each is summed up.
POWER_INSIDE, POWER_OUTSIDE, POWER_PUT_IN = range(3)
SUMMED_UP = (TAKEN_INSIDE, TAKEN_OUTSIDE, PUT_IN)
# Parameters of a step: Newton's relative tolerance on force, its largest number of iterations, then the scheme's own.
TOLERANCE, ITERATIONS, FIRST_OWN = 0, 1, 2


class System(NamedTuple):
    """Compiled functions of a system, the inverse of its masses (n, 3) [1/kg], a column an axis, and the number of moving nodes.

    Attributes
    ----------
    prescribe(t, data_address, q, v)
        Write the prescribed rows of q and v at time t.
    force(t, q, v, data_address, f, power)
        Write the force f (n, 3) [N] and the powers (3,) [W]: taken by internal dampers and by external forces, put in.
    residual(stage, base, target, q, data_address) -> norm, scale, noise, predicted
        Out-of-balance force of a stage [N]; linearise it. ``predicted`` is that with the internal forces that the last
        full Newton step predicted, which are the better ones where they are stiff.
    direction(stage, data_address) -> factorisations, left
        Newton step of the stage linearised last, and what a whole step leaves out of balance at most [N].
    correct(data_address, length, q)
        q += length times the Newton step.
    settle(stage, base, q, v, data_address, energy)
        After a step of law ``LAW_BETWEEN``: energy (4,) [J] put in between base and q, and dissipated by internal dampers, by
        external forces and by the method; takes out of the velocities at the end what the step cannot resolve.
    adopt(data_address)
        Take the internal forces where `residual` was last for those that act in the step.
    forget(data_address)
        Drop what earlier Newton steps left to the next.
    remember(data_address, back)
        Copy what steps leave to the next, or put it back if ``back`` is 1. Asked only of a system that has events.
    average(data_address, share, h)
        Add a share of the internal forces of the stage solved last to their mean over a step of h seconds; no share begins one.
    observe(q, v, data_address, row)
        What else is saved of a state, such as internal forces.
    energy(t, q, v, data_address, energy)
        Kinetic, elastic and other potential energy (3,) [J].
    margin(q, v, data_address) -> margin
        How far a state is beyond an event, by any measure that grows through zero there; `NO_EVENTS` if there are none. A march
        stops where it turns positive.
    """

    prescribe: object
    force: object
    residual: object
    direction: object
    correct: object
    settle: object
    adopt: object
    forget: object
    remember: object
    average: object
    observe: object
    energy: object
    margin: object
    per_mass: np.ndarray
    n_free: int


class StepState(NamedTuple):
    """What a step changes.

    ``q``, ``v`` (n, 3) [m], [m/s]; ``memory`` (rows, n, 3), in which a scheme works and of which it leaves the first rows to its
    next step; ``balance`` (BALANCE,) [J], [W], the energy balance.
    """

    q: np.ndarray
    v: np.ndarray
    memory: np.ndarray
    balance: np.ndarray


def compiled(function, signature):
    """A function of Numba's, compiled for one signature (or loaded from the cache) when it is first asked for."""
    if not function.signatures:
        function.compile(signature)
        function.disable_compile()
    return function


def entry_point(function):
    """What Python may call of a function that is compiled for one signature, with arguments of these very types.

    A call through Numba's dispatcher looks at the types of all arguments first; of named tuples of arrays that takes as long as a
    dozen steps of eighty nodes.
    """
    (compiled,) = function.overloads.values()
    return compiled.entry_point


@cache
def first_class(function):
    """A compiled function with one signature as a first-class value, so that its type is its signature's alone."""
    (compiled,) = function.overloads.values()
    value = types.CompileResultWAP(compiled)
    address = value.__wrapper_address__()
    value.__wrapper_address__ = lambda: address  # asked for at every call that takes it
    return value


def words_in_memory(system):
    """A system as words (k,) int64, whose address a march is given; the array and the system must outlive the march."""
    return np.array(words_of(system), np.int64)


_FUNCTIONS = (
    types.void(_f8, _i8, _f2, _f2),
    types.void(_f8, _f2, _f2, _i8, _f2, _f1),
    types.UniTuple(_f8, 4)(STAGE, _f2, _f2, _f2, _i8),
    types.Tuple((_i8, _f8))(STAGE, _i8),
    types.void(_i8, _f8, _f2),
    types.void(STAGE, _f2, _f2, _f2, _i8, _f1),
    types.void(_i8),
    types.void(_i8),
    types.void(_i8, _i8),
    types.void(_i8, _f8, _f8),
    types.void(_f2, _f2, _i8, _f1),
    types.void(_f8, _f2, _f2, _i8, _f1),
    _f8(_f2, _f2, _i8),
)
SYSTEM = types.NamedTuple((*map(types.FunctionType, _FUNCTIONS), _f2, _i8), System)
system_at = view_at(SYSTEM)
STEP_STATE = types.NamedTuple((_f2, _f2, _f3, _f1), StepState)
# step(system_address, data_address, t, h, state, parameters, counts) -> status, of every scheme
STEP = _i8(_i8, _i8, _f8, _f8, STEP_STATE, _f1, _i1)
