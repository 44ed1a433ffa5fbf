"""What becomes of a case with a method: its statements hold, or the library says that they cannot, or it fails."""

import math
import warnings
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from anet_lumped.choice import choose
from anet_lumped.equilibrium import EquilibriumError
from anet_lumped.model import build
from anet_lumped.scene import SceneError
from anet_lumped.simulate import SCIPY, StabilityWarning, simulate
from integrators import schemes, scipy_adapter
from studies.catalogue.case import ACCURACY, SPIN, Case, Statement, energy_statement

HELD, REFUSED, FAILED = "held", "refused", "failed"
DEFAULT = "default"  # no method given
METHODS = (*schemes.EXPLICIT, *schemes.IMPLICIT, *SCIPY)  # without those that have to be compiled for every scene
WAYS = (DEFAULT, *METHODS)
NODE_STEPS = 1e7  # of an explicit run; beyond, it is refused for its number of steps
NODE_EVALUATIONS = {"RK45": 4e5, "DOP853": 4e5, "Radau": 4e4, "BDF": 4e4, "LSODA": 4e4}
"""Nodes times force evaluations of a run with one of scipy's solvers; beyond, it is refused likewise."""
FEWEST = 200  # evaluations that are worth a try
NOT_ASKED = {  # what a scheme's own note in `anet_lumped.stability` denies
    "backward_euler": (ACCURACY, SPIN),  # damps the motion itself strongly
    "sdirk2": (SPIN,),  # nor do these promise angular momentum
    "tr_bdf2": (SPIN,),
    "generalised_alpha": (SPIN,),
}


@dataclass(frozen=True)
class Outcome:
    """How a case went with a method.

    Parameters
    ----------
    outcome : HELD, REFUSED or FAILED
    reason : str, one sentence with numbers, if not held
    statements : what was measured
    method : str, taken in the end
    dt : float [s]
    steps : int
    seconds : float, of the march
    audit : str, status of the same run with ``audit=True``, if it failed
    """

    outcome: str
    reason: str = ""
    statements: tuple[Statement, ...] = ()
    method: str = ""
    dt: float = math.nan
    steps: int = 0
    seconds: float = 0.0
    audit: str = ""


def meet(case: Case, way: str) -> Outcome:
    """Run a case with a method and judge it.

    An error of the library's own in place of a run is a refusal, and so are not reaching the end with a message, a
    `StabilityWarning`, and more work than `NODE_STEPS` or `NODE_EVALUATIONS` allow; but for the default method: that one has
    to hold. Explicit methods run at half of their predicted limit or at the step that the motion asks for, whichever is less.
    """
    try:
        return _meet(case, None if way == DEFAULT else way, way)
    except (SceneError, EquilibriumError, ValueError) as error:
        return Outcome(FAILED if way == DEFAULT else REFUSED, str(error), method="" if way == DEFAULT else way)


def _meet(case, method, way):
    choice = choose(case.scene, method, case.dt, way in SCIPY)
    dt = case.dt
    if way in schemes.EXPLICIT and not case.given:
        own = choose(case.scene, method, None, False).dt
        dt = min(own, dt or own)
    refusal = _too_many(case, choice.method, dt or choice.dt, choice.limit)
    if refusal:
        return Outcome(FAILED if method is None else REFUSED, refusal, method=choice.method, dt=dt or choice.dt)
    run, said = _run(case, method, dt)
    done = {"method": run.method, "dt": run.dt, "steps": run.work.steps, "seconds": run.wall_time}
    finite = all(np.isfinite(x).all() for x in (run.q, run.v, run.energy))
    if said or not run.ok:
        silent = method is None or not (said or run.message) or (run.ok and not finite)
        return Outcome(FAILED if silent else REFUSED, said or run.message, **done)
    if not finite:
        return Outcome(FAILED, "the run is done, yet holds numbers that are not finite", **done)
    statements = [*case.judge(run), *_halved(case, run)]
    if not case.driven or run.method == "edmc":  # of work at a jump of velocity, other methods' accounts are rough
        statements.insert(0, energy_statement(run))
    asked = tuple(s for s in statements if s.kind not in NOT_ASKED.get(run.method, ()))
    broken = [s for s in asked if not s.holds]
    if not broken:
        return Outcome(HELD, "", asked, **done)
    audited, _ = _run(case, method, dt, audit=True)
    return Outcome(FAILED, "; ".join(map(str, broken)), asked, audit=audited.status, **done)


def _run(case, method, dt, audit=False):
    """The run and what the library warned of before it."""
    with warnings.catch_warnings(record=True) as caught, bounded(_evaluations(case, method)):
        warnings.simplefilter("always")
        every = case.saved
        if every is not None and method not in SCIPY:
            whole = dt or choose(case.scene, method, None, False).dt
            dt = every / math.ceil(every / whole * (1 - 1e-12))  # steps that end on what is saved
        run = simulate(case.scene, case.t_end, method=method, dt=dt, start=case.begin(), save_every=every, audit=audit)
    return run, next((str(w.message) for w in caught if issubclass(w.category, StabilityWarning)), "")


def _halved(case, run):
    """How much the result changes with half the step, where the method has a step and order 2."""
    if case.measure is None or run.method in SCIPY or ACCURACY in NOT_ASKED.get(run.method, ()):
        return []
    other, _ = _run(case, run.method, 0.5 * run.dt)
    change = np.abs(case.measure(run) - case.measure(other)).max() if other.ok else np.inf
    return [Statement(ACCURACY, "change of the result with half the step", float(change), most=case.within, unit=case.unit)]


def _too_many(case, method, dt, limit):
    """Why a run would take too many steps, or ""."""
    nodes = build(case.scene).n
    if method in schemes.EXPLICIT:
        most = NODE_STEPS / (4 if method == "rk4" else 1)
        if case.t_end / dt * nodes > most and math.isfinite(limit) and dt < limit:
            return f"{method} would need {case.t_end / dt:.2g} steps of {dt:.2g} s"
    if method in SCIPY and _evaluations(case, method) < FEWEST:
        return f"{method} may spend {_evaluations(case, method)} force evaluations on {nodes} nodes here, too few steps to try"
    if method in ("RK45", "DOP853") and case.t_end / limit * 8 > _evaluations(case, method):
        return f"{method} would need {case.t_end / limit:.2g} steps, as its error control is driven to {limit:.2g} s"
    return ""


def _evaluations(case, method):
    """Force evaluations that a run with one of scipy's solvers may take."""
    return int(NODE_EVALUATIONS.get(method, 0) / build(case.scene).n)


@contextmanager
def bounded(most):
    """Within it, a run with one of scipy's solvers may evaluate the force at most so many times; then it gives up and says so."""
    kept, scipy_adapter.MOST = scipy_adapter.MOST, most
    try:
        yield
    finally:
        scipy_adapter.MOST = kept
