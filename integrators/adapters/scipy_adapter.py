"""scipy's adaptive solvers on M dv/dt = f(t, q, v), with the work of all forces carried along.

The state of scipy's solver is y = (q, v, work) of the moving nodes. The work (3,) is the integral of powers that the force kernel
returns anyway: taken inside, taken outside, put in. Steps are those of (q, v) alone: the work has a huge absolute tolerance, and
the other tolerances are scaled where a solver's norm is a mean over all components.
"""

import time
import warnings
from collections.abc import Callable
from contextlib import nullcontext
from threading import Lock
from typing import NamedTuple

import numpy as np
import scipy.integrate
from scipy.optimize import brentq
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from integrators.system import COUNTS, DIVERGED, DONE, EVENT, FACTORISATIONS, FORCES, NEWTON, REJECTED, STEPS, UNCONVERGED

from .outcome import LARGEST_COORDINATE, Outcome, Task, fastest_node

MOST_WORK = 50_000_000  # force evaluations of a run; a bound on what is otherwise unbounded
EPS = np.finfo(float).eps
UNCONTROLLED = 1e100  # absolute tolerance of what must not decide about a step
_LSODA = Lock()


class Motion(NamedTuple):
    """M dv/dt = f(t, q, v) for the first ``len(mass)`` nodes, the rest prescribed.

    Attributes
    ----------
    prescribe(t, q, v)
        Write the prescribed rows of q and v (n, 3) [m], [m/s].
    force(t, q, v, f, power)
        Write the force f (n, 3) [N]; power (3,) [W] is taken inside, taken outside and put in, see `integrators.system`.
    jacobian(t, q, v) -> csc_array (6 n_free, 6 n_free)
        Of dy/dt for y = (q, v) of the moving nodes, with a fixed pattern.
    mass : (n_free,) float64 [kg]
    margin(q, v) -> float, or None
        How far a state is beyond an event, see `integrators.system`; None if there are no events.
    """

    prescribe: Callable
    force: Callable
    jacobian: Callable
    mass: np.ndarray
    margin: Callable | None = None


class _StopError(Exception):
    """Ends a march; its arguments are the status and the reason."""


class _Equations:
    """dy/dt and its Jacobian as scipy wants them; component i of its y is ``order[i]`` of (q, v, work)."""

    def __init__(self, motion, q, v):
        self.motion, self.calls = motion, 0
        self.q, self.v, self.f, self.power = q.copy(), v.copy(), np.zeros_like(q), np.zeros(3)
        self.free, self.half = slice(0, len(motion.mass)), 3 * len(motion.mass)
        self.per_mass, self.size = 1.0 / motion.mass[:, None], 2 * self.half + 3
        self.order, self.y, self.rate = np.arange(self.size), np.zeros(self.size), np.zeros(self.size)
        self.y[:-3] = np.concatenate([q[self.free].ravel(), v[self.free].ravel()])

    def nodes_at(self, t, y):
        """Places and velocities of all nodes at (t, y), y in the natural order."""
        self.q[self.free] = y[: self.half].reshape(-1, 3)
        self.v[self.free] = y[self.half : -3].reshape(-1, 3)
        self.motion.prescribe(t, self.q, self.v)
        return self.q, self.v

    def rates(self, t, y):
        """dy/dt."""
        self.calls += 1
        if self.calls > MOST_WORK:
            raise _StopError(UNCONVERGED, f"{MOST_WORK} force evaluations were not enough")
        self.y[self.order] = y
        self.nodes_at(t, self.y)
        self.motion.force(t, self.q, self.v, self.f, self.power)
        rate = self.rate
        rate[: self.half] = self.y[self.half : -3]
        rate[self.half : -3] = (self.per_mass * self.f[self.free]).ravel()
        rate[-3:] = self.power
        return rate[self.order]

    def matrix(self, t, y):
        """Jacobian of dy/dt, sparse, in the natural order."""
        self.y[self.order] = y
        J = self.motion.jacobian(t, *self.nodes_at(t, self.y))
        return csc_array((J.data, J.indices, np.append(J.indptr, J.indptr[[-1, -1, -1]])), shape=(self.size, self.size))

    def margin(self, t, y):
        """Margin of the motion at (t, y), y in the natural order."""
        return self.motion.margin(*self.nodes_at(t, y))

    def event(self, t_before, t, dense):
        """Time at which the margin turns positive within a step from ``t_before`` to t, and y there, in the natural order."""
        position = np.argsort(self.order)
        if self.margin(t_before, dense(t_before)[position]) < 0.0:
            t = brentq(lambda t: self.margin(t, dense(t)[position]), t_before, t, xtol=1e-9 * (t - t_before), rtol=8 * EPS)
        else:
            t = t_before
        return t, dense(t)[position]

    def narrow(self, t):
        """Reorder y so that the Jacobian's band is narrow; returns the options of LSODA for this band."""
        J = self.matrix(t, self.y.copy())
        pattern = csr_array((np.ones(J.nnz), J.indices, J.indptr), shape=J.shape)  # with its zeros; transposed
        self.order = reverse_cuthill_mckee(pattern, symmetric_mode=False)
        position = np.argsort(self.order)
        row, column = position[J.indices], np.repeat(position, np.diff(J.indptr))
        upper, lower = max(0, (column - row).max()), max(0, (row - column).max())

        def banded(t, y):
            packed = np.zeros((lower + upper + 1, self.size))
            packed[row - column + upper, column] = self.matrix(t, y).data
            return packed

        return {"jac": banded, "lband": int(lower), "uband": int(upper)}


def march(motion: Motion, task: Task) -> Outcome:
    """March with one of scipy's solvers.

    Radau and BDF factorise the sparse Jacobian. LSODA takes a dense or a banded one, so y is reordered (reverse
    Cuthill-McKee) to make its band narrow; one thread at a time marches with LSODA, whose numbers are global before scipy 1.17 and
    which gives its reasons as warnings, whose filters are global, too.
    """
    with _LSODA if task.method == "LSODA" else nullcontext():
        return _march(motion, task)


def _march(motion, task):
    started = time.perf_counter()
    equations, counts = _Equations(motion, task.q, task.v), np.zeros(COUNTS, np.int64)
    times = task.saved_times()
    states = np.empty((len(times), equations.size))
    states[0], saved = equations.y, 1
    status, reason, t, y = DONE, "", task.t0, equations.y.copy()
    try:
        t_before = t
        for t, y, dense in _steps(equations, task, counts):
            if motion.margin is not None and equations.margin(t, y) > 0.0:
                t, y = equations.event(t_before, t, dense())
                status = EVENT
            t_before = t
            saved_after = saved + np.searchsorted(times[saved:], t, side="right")
            if saved_after > saved:
                states[saved:saved_after, equations.order] = dense()(times[saved:saved_after]).T
                saved = saved_after
            if times[saved - 1] == t:
                states[saved - 1] = y
            if status == EVENT:
                raise _StopError(EVENT, "")
    except _StopError as stopped:
        status, reason = stopped.args
        if t > times[saved - 1]:
            times[saved], states[saved] = t, y
            saved += 1
    counts[FORCES] = equations.calls
    node = fastest_node(np.abs(equations.rate[:-3]).reshape(2, -1, 3).max(axis=0)) if status == DIVERGED else -1
    q, v = np.moveaxis(states[:saved, :-3].reshape(saved, 2, -1, 3), 1, 0)
    work = states[:saved, -3:]
    return Outcome(status, reason, node, times[:saved], q, v, work, counts, time.perf_counter() - started)


def _steps(equations, task, counts):
    """Yield, after each step of a march, the time, the state in the natural order and the function that makes the dense output."""
    t, y, options, make_solver = task.t0, equations.y.copy(), {}, getattr(scipy.integrate, task.method)
    rtol, atol = task.rtol, np.append(np.full(equations.size - 3, task.atol), [UNCONTROLLED] * 3)
    if not np.isfinite(equations.rates(t, y)).all():
        raise _StopError(DIVERGED, "the force at the start is not finite")
    if task.method == "LSODA":
        options = equations.narrow(t)
    else:
        shrink = np.sqrt(1.0 - 3.0 / equations.size)  # so that the mean square over y is the one over (q, v)
        rtol, atol[:-3] = shrink * rtol, shrink * atol[:-3]
        if task.method in ("Radau", "BDF"):
            options = {"jac": equations.matrix}
    order, atol, position = equations.order, atol[equations.order], np.argsort(equations.order)
    for stop in task.ends():
        first = min(task.first_step, stop - t) if t == task.t0 else None
        solver = make_solver(equations.rates, t, y[order], stop, rtol=rtol, atol=atol, first_step=first, **options)
        while solver.status == "running":
            calls, factorisations = equations.calls, solver.nlu
            failure = _step(solver)
            _count(task.method, solver, equations.calls - calls, failure is None, counts)
            counts[FACTORISATIONS] += solver.nlu - factorisations
            if failure is not None:
                raise _StopError(UNCONVERGED if np.isfinite(equations.rate).all() else DIVERGED, failure)
            if not np.abs(solver.y[position[:-3]]).max() < LARGEST_COORDINATE:
                raise _StopError(DIVERGED, "places or velocities are beyond any sense")
            t, y = stop if solver.status == "finished" else solver.t, solver.y[position]
            yield t, y, solver.dense_output


def _step(solver):
    """Take a step; returns None or why it failed."""
    try:
        if not isinstance(solver, scipy.integrate.LSODA):
            with np.errstate(all="ignore"):
                return solver.step()
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            failure = solver.step()
        return str(warned[-1].message) if failure and warned else failure
    except RuntimeError as error:  # a singular matrix
        return str(error)


def _count(method, solver, calls, accepted, counts):
    """Count the work of a step with ``calls`` force evaluations; scipy does not count rejected steps and Newton iterations."""
    counts[STEPS] += accepted
    if method == "BDF":
        counts[NEWTON] += calls
    elif method == "Radau":
        counts[NEWTON] += calls // 3  # three stages an iteration; one more for the state reached or an error estimate
    elif method != "LSODA":
        counts[REJECTED] += calls // solver.n_stages - accepted
