"""What an integrator is given: M dv/dt = f(t, q, v) for the first ``n_free`` nodes, the rest prescribed.

The compiled functions of a system are first-class (`numba.types.FunctionType`), so that one compiled and cached scheme serves all
systems. A scheme passes on ``data_address``, the address of the data of these functions, which they alone can read. The system has
an address too, ``system_address``; `system_at` makes it readable.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from .addresses import view_at, words_of
from .compile_once import compiling, once
from .stage import STAGE

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")
_f8, _i8 = types.float64, types.int64

# Status of a step or a run.
DONE, UNCONVERGED, DIVERGED, INTERRUPTED, OUT_OF_STEPS, EVENT = 0, 1, 2, 3, 4, 5
SAME_TIME = 1e-6  # of a step: times that are closer count as equal; a difference of positions over less time shows rounding
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
    """Compiled functions of a system, and four things more.

    The inverse of its masses ``per_mass`` (n, 3) [1/kg], a column an axis; how many largest values it ``notices``; the number
    ``n_free`` of moving nodes; and the ``largest`` distance [m] plus relative velocity [m/s] of a node and the last one, beyond
    which a motion has diverged.

    Attributes
    ----------
    prescribe(t, data_address, q, v)
        Write the prescribed rows of q and v at time t.
    force(t, q, v, data_address, f, power)
        Write the force f (n, 3) [N] and the powers (3,) [W]: taken by internal dampers and by external forces, put in.
    residual(stage, base, target, q, data_address) -> norm, scale, noise, predicted
        Out-of-balance force of a stage [N]; linearise it. ``predicted`` is the same with the internal forces that the last full
        Newton step predicted, which are more exact where they are stiff. ``scale`` is the largest force on a node, ``noise`` what
        rounding leaves in ``norm``.
    direction(stage, data_address) -> factorisations, unbalanced
        Newton step of the stage linearised last; the force that a whole step leaves out of balance is at most ``unbalanced`` [N].
    correct(data_address, length, q)
        q += length times the Newton step.
    settle(stage, base, q, v, data_address, energy)
        After a step of law ``LAW_BETWEEN``: write the energy (4,) [J] put in between base and q, and dissipated by internal
        dampers, by external forces and by the method. Damp what the step cannot resolve in the velocities at its end.
    adopt(data_address)
        Let the internal forces at the q of the last `residual` act in the step.
    forget(data_address)
        Drop the internal forces that earlier Newton steps predicted.
    remember(data_address, back)
        Copy the data that a step leaves to the next one, or restore them if ``back`` is 1. Called only if the system has events.
    average(data_address, share, h)
        Add ``share`` times the internal forces of the stage solved last to their mean over a step of h seconds; a share of 0 sets
        the mean to zero.
    observe(t, q, v, data_address, row, energy)
        Write what else is saved of a state, such as internal forces, and its kinetic, elastic and other potential energy [J] to the
        first three numbers of ``energy``. Where that has no room, no energies are written, and t does not count.
    notice(t, q, v, data_address, row, noticed)
        Let the first half of ``noticed`` (2 * notices,) be the largest so far of what is looked at in states between those that are
        saved; the second half is its own memory, zero at the start. ``row`` is scratch that `observe` may write.
    margin(q, v, data_address) -> margin
        How far a state is beyond an event, by any continuous measure that is positive beyond the event; `NO_EVENTS` if there is
        none. A march stops where it turns positive.
    project(t, data_address, q, v) -> work
        Change a state whose prescribed rows are those of time t by as little as its constraints ask for; returns the work put in by
        that [J], NaN if no change satisfies them. It is called after each step, before the force there.
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
    notice: object
    margin: object
    project: object
    per_mass: np.ndarray
    notices: int
    n_free: int
    largest: float


class StepState(NamedTuple):
    """What a step changes.

    ``q``, ``v`` (n, 3) [m], [m/s]. ``memory`` (rows, n, 3): working memory of the scheme, whose first rows pass from a step to the
    next. ``balance`` (BALANCE,) [J], [W]: the energy balance.
    """

    q: np.ndarray
    v: np.ndarray
    memory: np.ndarray
    balance: np.ndarray


@once
def entry_point(function):
    """The entry that Python may call of a function compiled for one signature, with arguments of exactly these types.

    Numba's dispatcher would look at the types of all arguments first. For named tuples of arrays that takes as long as a dozen
    steps of eighty nodes.
    """
    (compiled,) = function.overloads.values()
    return compiled.entry_point


@once
def first_class(function):
    """A compiled function with one signature as a first-class value, so that its type is its signature's alone."""
    (compiled,) = function.overloads.values()
    with compiling():
        value = types.CompileResultWAP(compiled)
    address = value.__wrapper_address__()
    value.__wrapper_address__ = lambda: address  # asked for at every call that takes it
    return value


def words_in_memory(system):
    """A system as words (k,) int64, whose address a march is given; the array and the system must outlive the march."""
    return np.array(words_of(system), np.int64)


OBSERVE = types.void(_f8, _f2, _f2, _i8, _f1, _f1)
NOTICE = OBSERVE
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
    OBSERVE,
    NOTICE,
    _f8(_f2, _f2, _i8),
    _f8(_f8, _i8, _f2, _f2),
)
SYSTEM = types.NamedTuple((*map(types.FunctionType, _FUNCTIONS), _f2, _i8, _i8, _f8), System)
system_at = view_at(SYSTEM)
STEP_STATE = types.NamedTuple((_f2, _f2, _f3, _f1), StepState)
# step(system_address, data_address, t, h, state, parameters, counts) -> status, of every scheme
STEP = _i8(_i8, _i8, _f8, _f8, STEP_STATE, _f1, _i1)
