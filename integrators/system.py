"""What an integrator is given: M dv/dt = f(t, q, v) for the first ``n_free`` nodes, the rest prescribed.

The compiled functions of a system are first-class (`numba.types.FunctionType`), so that a scheme is compiled and cached once
and for all. Whatever they work on is handed through as ``net``, an address that they alone understand.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from .stage import STAGE

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")

# Status of a step or a run.
DONE, UNCONVERGED, DIVERGED, INTERRUPTED = 0, 1, 2, 3
# Work counts.
STEPS, REJECTED, HALVINGS, FORCES, NEWTON, FACTORISATIONS = range(6)
# Energy balance: kinetic, elastic, potential energy now; work put in and energy dissipated since the start; then the power
# of the last two at the current time, from which they are integrated, and scratch for two more.
KINETIC, ELASTIC, POTENTIAL, PUT_IN, DISSIPATED, POWER_PUT_IN, POWER_DISSIPATED, SCRATCH = range(8)
BALANCE = 9  # numbers in all
# Numbers that steps are given: Newton's relative tolerance on force, its largest number of iterations, then the scheme's.
TOLERANCE, ITERATIONS, SCHEME = 0, 1, 2


class System(NamedTuple):
    """Compiled functions of a system, the inverse of its masses (n, 3) [1/kg], a column an axis, and the number of moving nodes.

    Attributes
    ----------
    prescribe(t, net, q, v)
        Write the prescribed rows of q and v at time t.
    force(t, q, v, net, f, power)
        Write the force f (n, 3) [N]; power (2,) [W] is dissipated and put in by prescribed nodes.
    residual(stage, base, target, q, net) -> norm, scale, noise, predicted
        Out-of-balance force of a stage [N]; linearise it. ``predicted`` is that with the internal forces that the last
        full Newton step predicted, which are the better ones where they are stiff.
    direction(stage, net) -> factorisations
        Newton step of the stage linearised last.
    correct(net, length, q)
        q += length times the Newton step.
    settle(stage, base, q, net, energy)
        energy (2,) [J]: put in and dissipated between base and q by the law ``BETWEEN`` that was linearised last.
    adopt(net)
        Take the internal forces where `residual` was last for those that act in the step.
    forget(net)
        Drop what earlier Newton steps left to the next.
    calm(stage, v, net) -> put_in, lost
        Take out of the velocities, after a step of law ``BETWEEN``, what it cannot resolve; the work put in and the energy
        that goes [J].
    observe(q, v, net, row)
        What else is saved of a state, such as internal forces.
    energy(t, q, v, net, energy)
        Kinetic, elastic and other potential energy (3,) [J].
    """

    prescribe: object
    force: object
    residual: object
    direction: object
    correct: object
    settle: object
    adopt: object
    forget: object
    calm: object
    observe: object
    energy: object
    per_mass: np.ndarray
    n_free: int


def compiled(function, signature):
    """A function of Numba's, compiled for one signature (or loaded from the cache) when it is first asked for."""
    if not function.signatures:
        function.compile(signature)
        function.disable_compile()
    return function


def first_class(function):
    """A compiled function with one signature as a first-class value, so that its type is its signature's alone."""
    (compiled,) = function.overloads.values()
    return types.CompileResultWAP(compiled)


_f8, _i8 = types.float64, types.int64
_FUNCTIONS = (
    types.void(_f8, _i8, _f2, _f2),
    types.void(_f8, _f2, _f2, _i8, _f2, _f1),
    types.UniTuple(_f8, 4)(STAGE, _f2, _f2, _f2, _i8),
    _i8(STAGE, _i8),
    types.void(_i8, _f8, _f2),
    types.void(STAGE, _f2, _f2, _i8, _f1),
    types.void(_i8),
    types.void(_i8),
    types.UniTuple(_f8, 2)(STAGE, _f2, _i8),
    types.void(_f2, _f2, _i8, _f1),
    types.void(_f8, _f2, _f2, _i8, _f1),
)
SYSTEM = types.NamedTuple((*map(types.FunctionType, _FUNCTIONS), _f2, _i8), System)
# step(system, net, t, h, q, v, memory, options, counts, balance) -> status, of every scheme
STEP = _i8(SYSTEM, _i8, _f8, _f8, _f2, _f2, _f3, _f1, _i1, _f1)
