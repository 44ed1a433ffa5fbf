"""scipy's adaptive solvers on M dv/dt = f(t, q, v), with the work put in and the energy dissipated carried along.

The state handed to scipy is y = (q, v, work, dissipated) of the moving nodes. The last two are integrals of powers that
the force kernel returns anyway: they have a huge absolute tolerance, so that they never decide about a step, and
tolerances are scaled where a solver's norm is a mean over all components, so that its steps are those of (q, v) alone.
"""

import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.integrate import BDF, DOP853, LSODA, RK45, Radau
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from .system import DIVERGED, DONE, FACTORISATIONS, FORCES, NEWTON, REJECTED, STEPS, UNCONVERGED

SOLVERS = {"RK45": RK45, "DOP853": DOP853, "Radau": Radau, "BDF": BDF, "LSODA": LSODA}
MOST = 50_000_000  # force evaluations of a run; a bound on what is otherwise unbounded
LARGEST = 1e12  # [m], [m/s] beyond any sense
FREE = 1e100  # absolute tolerance of what must not decide about a step


class Motion(NamedTuple):
    """M dv/dt = f(t, q, v) for the first ``len(mass)`` nodes, the rest prescribed.

    Attributes
    ----------
    prescribe(t, q, v)
        Write the prescribed rows of q and v (n, 3) [m], [m/s].
    force(t, q, v, f, power)
        Write the force f (n, 3) [N]; power (2,) [W] is dissipated and put in by prescribed nodes.
    energy(t, q, v, energy)
        Write kinetic, elastic and other potential energy to the first three of energy [J].
    jacobian(t, q, v) -> csc_array (6 n_free, 6 n_free)
        Of dy/dt for y = (q, v) of the moving nodes, with a fixed pattern.
    mass : (n_free,) float64 [kg]
    """

    prescribe: Callable
    force: Callable
    energy: Callable
    jacobian: Callable
    mass: np.ndarray


class Outcome(NamedTuple):
    """How a march ended and what it leaves.

    ``status`` and ``counts`` as in `integrators.system`; ``reason`` says why it stopped, at time ``t`` [s] and, if it
    diverged, at ``node`` (or -1); ``q``, ``v`` (k, n, 3) and ``energy`` (k, 5) [J] belong to the first k of the times.
    """

    status: int
    reason: str
    t: float
    node: int
    q: np.ndarray
    v: np.ndarray
    energy: np.ndarray
    counts: np.ndarray


class _OutOfWorkError(Exception):
    """More than `MOST` force evaluations."""


class _Equations:
    """dy/dt and its Jacobian as scipy wants them; component i of its y is ``order[i]`` of (q, v, work, dissipated)."""

    def __init__(self, motion, q, v):
        self.motion, self.calls = motion, 0
        self.q, self.v, self.f, self.power = q.copy(), v.copy(), np.zeros_like(q), np.zeros(2)
        self.free, self.half = slice(0, len(motion.mass)), 3 * len(motion.mass)
        self.per_mass, self.size = 1.0 / motion.mass[:, None], 2 * self.half + 2
        self.order, self.y, self.rate = np.arange(self.size), np.zeros(self.size), np.zeros(self.size)
        self.y[:-2] = np.concatenate([q[self.free].ravel(), v[self.free].ravel()])

    def place(self, t, y):
        """Places and velocities of all nodes at (t, y), y in the natural order."""
        self.q[self.free] = y[: self.half].reshape(-1, 3)
        self.v[self.free] = y[self.half : -2].reshape(-1, 3)
        self.motion.prescribe(t, self.q, self.v)
        return self.q, self.v

    def rates(self, t, y):
        """dy/dt."""
        self.calls += 1
        if self.calls > MOST:
            raise _OutOfWorkError(f"{MOST} force evaluations were not enough")
        self.y[self.order] = y
        self.place(t, self.y)
        self.motion.force(t, self.q, self.v, self.f, self.power)
        rate = self.rate
        rate[: self.half] = self.y[self.half : -2]
        rate[self.half : -2] = (self.per_mass * self.f[self.free]).ravel()
        rate[-2], rate[-1] = self.power[1], self.power[0]
        return rate[self.order]

    def matrix(self, t, y):
        """Jacobian of dy/dt, sparse, in the natural order."""
        self.y[self.order] = y
        J = self.motion.jacobian(t, *self.place(t, self.y))
        return csc_array((J.data, J.indices, np.append(J.indptr, J.indptr[[-1, -1]])), shape=(self.size, self.size))

    def narrow(self, t):
        """Reorder y so that the Jacobian's band is narrow; returns what LSODA has to know about it."""
        J = self.matrix(t, self.y.copy())
        whole = csr_array((np.ones(J.nnz), J.indices, J.indptr), shape=J.shape)  # with its zeros; transposed
        self.order = reverse_cuthill_mckee(whole, symmetric_mode=False)
        place = np.argsort(self.order)
        row, column = place[J.indices], np.repeat(place, np.diff(J.indptr))
        upper, lower = max(0, (column - row).max()), max(0, (row - column).max())

        def banded(t, y):
            packed = np.zeros((lower + upper + 1, self.size))
            packed[row - column + upper, column] = self.matrix(t, y).data
            return packed

        return {"jac": banded, "lband": int(lower), "uband": int(upper)}


def march(method, motion, t0, t_end, stops, q, v, times, first_step, rtol, atol):
    """March from t0 to t_end with one of `SOLVERS`.

    Radau and BDF factorise the sparse Jacobian. LSODA takes a dense or a banded one, so y is reordered (reverse
    Cuthill-McKee) to make its band narrow.

    Parameters
    ----------
    method : str
    motion : Motion
    stops : increasing (k,) float64 [s]
        Times that a step must end on, where the solver starts afresh.
    q, v : (n, 3) float64 [m], [m/s], not changed
    times : increasing (k,) float64 [s], from t0 to t_end, at which to save
    first_step : float [s]
    rtol : float
    atol : (6 n_free,) float64 [m], [m/s]
        The error of y_i in a step is kept below atol_i + rtol |y_i|.

    Returns
    -------
    Outcome
    """
    equations, counts = _Equations(motion, q, v), np.zeros(6, np.int64)
    moving, states = equations.size - 2, np.empty((len(times), equations.size))
    states[0], saved, t, y = equations.y, 1, t0, equations.y.copy()
    status, reason, node, options, atol = DONE, "", -1, {}, np.append(atol, [FREE, FREE])
    if not np.isfinite(equations.rates(t0, y)).all():
        status, reason = DIVERGED, "the force at the start is not finite"
    elif method == "LSODA":
        options = equations.narrow(t0)
    else:
        shrink = np.sqrt(moving / equations.size)  # so that the mean square over y is the one over (q, v)
        rtol, atol = shrink * rtol, shrink * atol
        options = {"jac": equations.matrix} if method in ("Radau", "BDF") else {}
    order = equations.order
    with warnings.catch_warnings(record=True) as said:  # LSODA tells its reasons as warnings
        warnings.simplefilter("default")
        for stop in [*stops[(stops > t0) & (stops < t_end)].tolist(), t_end]:
            first, solver = min(first_step, stop - t) if t == t0 else None, None
            try:
                while status == DONE and t < stop:
                    if solver is None:
                        solver = SOLVERS[method](
                            equations.rates, t, y[order], stop, rtol=rtol, atol=atol[order], first_step=first, **options
                        )
                    before = equations.calls
                    failure = solver.step()
                    _count(method, solver, equations.calls - before, failure is None, counts)
                    if failure is not None:
                        status = UNCONVERGED if np.isfinite(equations.rate).all() else DIVERGED
                        reason = str(said[-1].message) if method == "LSODA" and said else failure
                        break
                    t = stop if solver.status == "finished" else solver.t
                    y[order] = solver.y
                    node = _beyond_sense(y[:moving])
                    if node >= 0:
                        status, reason = DIVERGED, "places or velocities are beyond any sense"
                        break
                    due = saved + np.searchsorted(times[saved:], t, side="right")
                    if due > saved:
                        states[saved:due, order] = solver.dense_output()(np.minimum(times[saved:due], solver.t)).T
                        saved = due
            except (_OutOfWorkError, RuntimeError) as error:  # the latter from a singular matrix
                status, reason = UNCONVERGED, str(error)
            counts[FACTORISATIONS] += 0 if solver is None else solver.nlu
    counts[FORCES] = equations.calls
    out = np.empty((saved, *q.shape)), np.empty((saved, *q.shape)), np.empty((saved, 5))
    for k in range(saved):
        out[0][k], out[1][k] = equations.place(times[k], states[k])
        motion.energy(times[k], out[0][k], out[1][k], out[2][k])
    out[2][:, 3:] = states[:saved, -2:]
    return Outcome(status, reason, t, node, *out, counts)


def _beyond_sense(y):
    """Node whose place or velocity is not finite or beyond any sense, or -1."""
    worst = np.argmax(np.abs(y))
    return -1 if abs(y[worst]) < LARGEST else int(worst % (len(y) // 2)) // 3


def _count(method, solver, calls, done, counts):
    """Add up a step of ``calls`` force evaluations; scipy itself does not tell rejected steps nor Newton iterations."""
    counts[STEPS] += done
    if method == "BDF":
        counts[NEWTON] += calls
    elif method == "Radau":
        counts[NEWTON] += calls // 3  # three stages an iteration, one more for the state reached or an error estimate
    elif method != "LSODA":
        counts[REJECTED] += calls // solver.n_stages - done
