"""diffrax's solvers on M dv/dt = f(t, q, v), with the work of all forces carried along.

The state is y = (q, v) of the moving nodes, and three integrals of powers that the force returns anyway; the integrals have no
influence on steps. A compiled loop takes the steps one by one with diffrax's solver and step size controller, so that the work of
each step can be counted.

The stages of an implicit solver are found by a chord iteration of our own, because diffrax's takes the dense Jacobian of dy/dt.
A stage y = y_p + tau dy/dt has q = q_p + tau v and v = v_p + tau a, which leaves

    M a = f(t, q_p + tau (v_p + tau a), v_p + tau a) ,    corrected by    (M - tau df/dv - tau^2 df/dq) da = M a - f ,

a system of second order whose structure the motion knows. All implicit stages have the same tau, so the matrix is made once a step,
near its first implicit stage. The iteration ends when the remaining error, estimated from its convergence, is below `KAPPA` of
the step's tolerance. Hairer & Wanner, Solving Ordinary Differential Equations II, IV.8.

JAX computes in float64 here: importing this module sets ``jax_enable_x64`` for the whole process.
"""

import time
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jax import lax

from integrators.system import COUNTS, DIVERGED, DONE, FACTORISATIONS, FORCES, NEWTON, REJECTED, STEPS, UNCONVERGED

from .outcome import LARGEST_COORDINATE, Outcome, Task, fastest_node

jax.config.update("jax_enable_x64", True)

MOST_WORK = 5_000_000  # steps tried in a run; a bound on what is otherwise unbounded
STEPS_PER_CALL = 100  # steps tried in one compiled call; Ctrl-C acts between calls
KAPPA = 1e-2
ITERATIONS = 10  # for a stage, before the step is tried with a fifth of its length, as diffrax has it
SHORTEST_STEP = 1e-14  # a step, relative to the time and the stretch marched


class Motion(Protocol):
    """M dv/dt = f(t, q, v), a pytree whose methods JAX can trace; the moving nodes alone, q and v (n_free, 3) [m], [m/s].

    What is prescribed is smooth up to the time ``stop``; asked for beyond it, it goes on as it was.
    """

    mass: jax.Array  # (n_free,) [kg]

    def force(self, t, stop, q, v):
        """Force (n_free, 3) [N], and powers (3,) [W]: taken inside, taken outside, put in."""

    def factor(self, t, stop, q, v, tau):
        """Whatever `solve` needs of M - tau df/dv - tau^2 df/dq."""

    def solve(self, factor, r):
        """Solution x (n_free, 3) of (M - tau df/dv - tau^2 df/dq) x = r."""


class _State(NamedTuple):
    """y, or dy/dt, or a tolerance: positions, velocities, work (3,), and a slot in which a stage counts its iterations."""

    q: Any
    v: Any
    energy: Any
    iterations: Any


class _March(NamedTuple):
    """State of a march: time, next time, y, memory of solver and controller, states saved, counts, how it fails."""

    t: Any
    t_next: Any
    y: _State
    solver: Any
    controller: Any
    saved: Any
    out: _State
    tried: Any
    steps: Any
    stages: Any
    iterations: Any
    failure: Any


NO_FAILURE, TOO_SHORT, NO_STAGE, NOT_FINITE, TOO_LARGE = range(5)  # how a march fails
REASONS = {
    TOO_SHORT: (UNCONVERGED, "the step needed is too short for the arithmetic"),
    NO_STAGE: (UNCONVERGED, "a stage was not solved even with the shortest step"),
    NOT_FINITE: (DIVERGED, "places, velocities or forces are not finite even with the shortest step"),
    TOO_LARGE: (DIVERGED, "places or velocities are beyond any sense"),
}


def _norm(y):
    """Root of the mean square over places and velocities alone."""
    return jnp.sqrt((jnp.sum(y.q**2) + jnp.sum(y.v**2)) / (y.q.size + y.v.size))


def _rates(t, y, args):
    """dy/dt."""
    motion, stop, _ = args
    f, power = motion.force(t, stop, y.q, y.v)
    return _State(y.v, f / motion.mass[:, None], power, jnp.zeros(()))


class _ChordState(NamedTuple):
    size: Any
    before: Any
    iterations: Any


class _Chord(optx.AbstractRootFinder):
    """The chord iteration of the module's docstring, for a stage that diffrax poses as dy/dt - rates(y_p + tau dy/dt) = 0."""

    rtol: jax.Array
    atol: jax.Array
    norm: Callable = _norm

    def init(self, fn, y, args, options, f_struct, aux_struct, tags):
        """Nothing done; the matrix comes with the arguments."""
        return _ChordState(jnp.array(jnp.inf), jnp.array(jnp.inf), jnp.array(0))

    def step(self, fn, y, args, options, state, tags):
        """Correct the acceleration."""
        _, diagonal, _, _, _, behind, (motion, _, factor), dt = args
        tau = diagonal * dt
        residual, aux = fn(y._replace(q=behind.v + tau * y.v), args)
        correction = jnp.where(tau > 0.0, motion.solve(factor, motion.mass[:, None] * residual.v), residual.v)
        a = y.v - correction
        v = behind.v + tau * a
        scale_q, scale_v = (self.atol + self.rtol * jnp.abs(x) for x in (behind.q + tau * v, v))
        size = _norm(_State(tau * tau * correction / scale_q, tau * correction / scale_v, 0.0, 0.0))
        iterations = state.iterations + 1
        return _State(v, a, y.energy, 1.0 * iterations), _ChordState(size, state.size, iterations), aux

    def terminate(self, fn, y, args, options, state, tags):
        """Whether what is left of the error is small, or the iteration diverges."""
        rate, has_started, has_rate = state.size / state.before, state.iterations > 0, state.iterations > 1
        done = (state.size < KAPPA) | (has_rate & (rate < 1.0) & (state.size * rate < KAPPA * (1.0 - rate)))
        diverges = has_started & ~jnp.isfinite(state.size) | (
            has_rate & (rate > 2.0)
        )  # diffrax asks before the first iteration too
        result = optx.RESULTS.where(diverges & ~done, optx.RESULTS.nonlinear_divergence, optx.RESULTS.successful)
        return done | diverges, result

    def postprocess(self, fn, y, aux, args, options, state, tags, result):
        """Take the powers at the stage found."""
        return y._replace(energy=y.energy - fn(y, args)[0].energy), aux, {}


def _typed(tree):
    """The same numbers without JAX's weak types, so that all calls of a compiled function have the types of the first."""
    return jax.tree.map(lambda x: lax.convert_element_type(x, x.dtype), tree)


def _solver(method, rtol, atol):
    solver = getattr(diffrax, method)
    if issubclass(solver, diffrax.AbstractImplicitSolver):
        return solver(root_finder=_Chord(rtol, atol), root_find_max_steps=ITERATIONS)
    return solver()


@eqx.filter_jit
def _begin(solver, controller, motion, t, stop, first_step, y):
    """Memories of solver and controller where the solver starts, and dy/dt there."""
    term, args = diffrax.ODETerm(_rates), (motion, stop, None)
    t_next, memory = controller.init(term, t, stop, y, first_step, args, solver.func, solver.order(term))
    return t_next, solver.init(term, t, t_next, y, args), (*memory[:2], jnp.array(memory[2])), _rates(t, y, args)


@eqx.filter_jit
def _advance(solver, controller, motion, stop, times, march):
    """Up to `STEPS_PER_CALL` steps towards ``stop``; saves at ``times``."""
    term, diagonal = diffrax.ODETerm(_rates), solver.tableau.a_diagonal
    order, most_tried = solver.order(term), march.tried + STEPS_PER_CALL
    shortest = SHORTEST_STEP * (jnp.abs(march.t) + jnp.abs(stop))

    def unfinished(m):
        return (m.t < stop) & (m.failure == NO_FAILURE) & (m.tried < most_tried)

    def step(m):
        time_left = stop - m.t
        t = jnp.where((m.t_next - m.t) * (1.0 + 1e-9) >= time_left, stop, m.t_next)
        factor = None
        if diagonal is not None:
            tau = diagonal[-1] * (t - m.t)
            to_first_stage, a = 2.0 * tau, m.solver[1].v  # a: acceleration at the end of the last step, or zero
            first_stage = m.y.q + to_first_stage * (m.y.v + 0.5 * to_first_stage * a), m.y.v + to_first_stage * a
            factor = motion.factor(m.t + to_first_stage, stop, *first_stage, tau)
        args = motion, stop, factor
        y, error, dense, memory, result = solver.step(term, m.t, t, m.y, args, m.solver, False)
        # a solver that keeps its last stage as the next step's first one has none to keep when it starts
        computes_first_stage = m.solver[0] if solver.tableau.fsal else jnp.array(True)
        stage_iterations = dense["k"].iterations / (t - m.t)
        iterations = jnp.rint(jnp.sum(stage_iterations[1:]) + jnp.where(computes_first_stage, stage_iterations[0], 0.0)).astype(int)
        y = y._replace(iterations=jnp.zeros(()))
        solved = result == diffrax.RESULTS.successful
        finite = jnp.isfinite(_norm(y))
        usable = solved & finite & jnp.isfinite(_norm(error))
        error = jax.tree.map(lambda e: jnp.where(usable, e, jnp.inf), error)
        accepted, _, t_next, _, controlled, _ = controller.adapt_step_size(m.t, t, m.y, y, args, error, order, m.controller)
        failure_of_step = jnp.where(~finite, NOT_FINITE, jnp.where(~solved, NO_STAGE, TOO_SHORT))
        failure = jnp.where(~accepted & (t_next - m.t < shortest), failure_of_step, NO_FAILURE)
        failure = jnp.where(
            accepted & ~(jnp.maximum(jnp.abs(y.q).max(), jnp.abs(y.v).max()) < LARGEST_COORDINATE), TOO_LARGE, failure
        )
        curve = solver.interpolation_cls(t0=m.t, t1=t, **dense)

        def due(saving):
            return accepted & (saving[0] < len(times)) & (times[jnp.minimum(saving[0], len(times) - 1)] <= t)

        def save(saving):
            k, out = saving
            state_saved = curve.evaluate(times[k])
            state_saved = jax.tree.map(lambda a, b: jnp.where(times[k] == t, b, a), state_saved, y)
            return k + 1, jax.tree.map(lambda rows, a: rows.at[k].set(a), out, state_saved)

        saved, out = lax.while_loop(due, save, (m.saved, m.out))
        t_now, y, memory = jax.tree.map(lambda a, b: jnp.where(accepted, a, b), (t, y, memory), (m.t, m.y, m.solver))
        return _March(
            t_now, t_next, y, memory, controlled, saved, out,
            m.tried + 1, m.steps + accepted, m.stages + solver.tableau.num_stages - ~computes_first_stage,
            m.iterations + iterations, failure,
        )  # fmt: skip

    return _typed(lax.while_loop(unfinished, step, march))


def march(motion: Motion, task: Task) -> Outcome:
    """March with one of diffrax's solvers.

    The error of a step is kept within its tolerance in the mean square over places [m] and velocities [m/s]. The first step is
    taken after every stop too. States between steps are interpolated as the solver has it: by cubic Hermite polynomials for the
    implicit ones, by a polynomial of its own, of order four, for Tsit5.
    """
    rtol, atol, times = jnp.asarray(task.rtol, float), jnp.asarray(task.atol, float), task.saved_times()
    solver, controller = _solver(task.method, rtol, atol), diffrax.PIDController(rtol, atol, norm=_norm)
    q, v = (x[: len(motion.mass)] for x in (task.q, task.v))
    y = _State(jnp.asarray(q, float), jnp.asarray(v, float), jnp.zeros(3), jnp.zeros(()))
    out = jax.tree.map(lambda a: jnp.zeros((len(times) + 1, *a.shape)).at[0].set(a), y)
    zero = jnp.array(0)
    m = _March(jnp.asarray(float(task.t0)), None, y, None, None, zero + 1, out, zero, zero, zero, zero, zero)
    failure, node, starts = NO_FAILURE, -1, 0
    saving = jnp.asarray(times)
    for stop in jnp.asarray(task.ends()):
        first = jnp.minimum(task.first_step, stop - m.t)
        t_next, memory, controlled, rates = _begin(solver, controller, motion, m.t, stop, first, m.y)
        m = _typed(m._replace(t_next=t_next, solver=memory, controller=controlled))
        starts += 1
        if starts == 1:
            _advance(solver, controller, motion, stop, saving, m._replace(failure=_typed(zero + NOT_FINITE)))
            started = time.perf_counter()  # what was needed is compiled, by a march of no step
        if not np.isfinite(rates.v).all():
            failure, node = NOT_FINITE, fastest_node(rates.v)
            break
        while m.t < stop and failure == NO_FAILURE and m.tried < MOST_WORK:
            m = _advance(solver, controller, motion, stop, saving, m)
            failure = int(m.failure)
        if m.t < stop:
            break
    status, reason = REASONS.get(failure, (DONE, ""))
    if failure == NO_FAILURE and m.tried >= MOST_WORK:
        status, reason = UNCONVERGED, f"{MOST_WORK} steps tried were not enough"
    if failure == NOT_FINITE and m.tried == 0:
        reason = "the force at the start is not finite"
    elif status == DIVERGED:
        node = fastest_node(_rates(m.t, m.y, (motion, stop, None)).v)
    saved, out, reached = int(m.saved), [np.array(a) for a in m.out[:3]], float(m.t)
    times = np.append(times, 0.0)
    if status != DONE and reached > times[saved - 1]:
        times[saved] = reached
        for rows, a in zip(out, m.y, strict=False):
            rows[saved] = a
        saved += 1
    return Outcome(
        status, reason, node, times[:saved], out[0][:saved], out[1][:saved], out[2][:saved],
        _counts(solver, m, starts), time.perf_counter() - started,
    )  # fmt: skip


def _counts(solver, m, starts):
    """Work counts: a force at every start, in every stage, and in every iteration of an implicit stage."""
    tried, steps, stages, iterations = map(int, (m.tried, m.steps, m.stages, m.iterations))
    counts = np.zeros(COUNTS, np.int64)
    counts[STEPS], counts[REJECTED], counts[FORCES], counts[NEWTON] = steps, tried - steps, starts + stages + iterations, iterations
    counts[FACTORISATIONS] = tried if isinstance(solver, diffrax.AbstractImplicitSolver) else 0
    return counts
