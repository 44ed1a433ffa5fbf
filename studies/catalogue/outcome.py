"""How a case goes with a method: its statements hold, or the library says that the method does not serve, or it fails."""

import math
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from anet_lumped.model.build import build
from anet_lumped.motion.caveats import caveats
from anet_lumped.motion.choice import choose
from anet_lumped.motion.simulate import DIFFRAX, SCIPY, StabilityWarning, simulate
from anet_lumped.scene.scene import SceneError
from anet_lumped.statics.equilibrium import EquilibriumError
from integrators import embedded_march, schemes, scipy_adapter
from studies.catalogue.case import ACCURACY, LOAD, REST, SPIN, Case, Statement, account_statement, energy_statement

HELD, REFUSED, FAILED = "held", "refused", "failed"
GAINED = "gained"  # energy, by a random trial with a method that does not promise otherwise
DEFAULT = "default"  # no method given
EXTRAPOLATED = "edmc_extrapolated"  # method="edmc", extrapolate=True
METHODS = (*schemes.EXPLICIT, *schemes.IMPLICIT, *SCIPY)  # without diffrax's, which are compiled for every scene
METHODS_TRIED = (DEFAULT, *schemes.EXPLICIT, "edmc", EXTRAPOLATED, *schemes.IMPLICIT[1:], *SCIPY, *DIFFRAX)
EVALUATIONS = {"rk4": 4, "dop853": 12}  # of the force in an explicit step, where not one
STEP_CHOOSING = (*SCIPY, *DIFFRAX, *schemes.EMBEDDED)
NODE_STEPS = 1e7  # of an explicit run; beyond, it is refused for its number of steps
NODE_EVALUATIONS = {"RK45": 4e5, "DOP853": 4e5, "Radau": 4e4, "BDF": 4e4, "LSODA": 4e4}
"""Nodes times force evaluations of a run with one of scipy's solvers; beyond, it is refused likewise."""
NODE_TRIES = {"dop853": 2e7, "Tsit5": 1e6, "Kvaerno3": 5e5, "Kvaerno5": 2e5}
"""Nodes times steps tried of a run that chooses its steps; beyond, it gives up."""
FEWEST = 200  # evaluations, or steps, that are worth a try
NOT_PROMISED = {  # what a scheme's own note in `anet_lumped.motion.stability` denies
    "backward_euler": (ACCURACY, SPIN),  # damps the motion itself strongly
    "sdirk2": (SPIN,),  # nor do these promise angular momentum
    "tr_bdf2": (SPIN,),
    "generalised_alpha": (SPIN,),
    EXTRAPOLATED: (SPIN,),  # a product, which a mean of two runs does not keep
}
EXCUSED_BY_CAVEAT = (ACCURACY, REST, LOAD)
"""Kinds of statements that a run may break which says so itself, in its caveats; not energy, momentum or spin."""


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


def try_case(case: Case, method: str) -> Outcome:
    """Run a case with a method and judge it.

    A method asked for by name is refused where the library says in words that it does not serve: by an error of its own in place
    of a run, a status other than "done" with a message, a `StabilityWarning`, more work than `NODE_STEPS`, `NODE_EVALUATIONS` or
    `NODE_TRIES` allow, or a caveat of the run where what is broken is of the kinds `EXCUSED_BY_CAVEAT`. The default method has to
    hold: where the library refuses it has failed. Explicit methods run at the step that is chosen for them or at the one that
    the motion asks for, whichever is less; those that choose their steps do so, unless the case is about a step that is given.

    Parameters
    ----------
    method : one of METHODS_TRIED
    """
    try:
        return _try_case(case, method)
    except (SceneError, EquilibriumError, ValueError) as error:
        said = str(error)
    except ModuleNotFoundError as error:  # a package that is not installed; never a file of ours
        if error.name.partition(".")[0] in ("anet_lumped", "integrators", "studies"):
            raise
        said = str(error)
    return Outcome(FAILED if method == DEFAULT else REFUSED, said, method="" if method == DEFAULT else method)


def _try_case(case, asked):
    method, extrapolate = {DEFAULT: None, EXTRAPOLATED: "edmc"}.get(asked, asked), asked == EXTRAPOLATED
    other_package = asked in SCIPY + DIFFRAX
    choice = choose(case.scene, method, case.dt, other_package)
    dt = case.dt
    if asked in schemes.EMBEDDED and not case.step_is_given:
        dt = None
    elif asked in schemes.EXPLICIT and not case.step_is_given:
        own = choose(case.scene, method, None, False).dt
        dt = min(own, dt or own)
    refusal = _too_much_work(case, choice.method, dt or choice.dt, choice.limit)
    if refusal:
        return Outcome(FAILED if method is None else REFUSED, refusal, method=choice.method, dt=dt or choice.dt)
    options = {"extrapolate": True} if extrapolate else {}
    run, warned = _run(case, method, dt, **options)
    about = {"method": run.method, "dt": run.dt, "steps": run.work.steps, "seconds": run.wall_time}
    finite = all(np.isfinite(x).all() for x in (run.q, run.v, run.energy))
    if warned or not run.ok:
        silent = method is None or not (warned or run.message) or (run.ok and not finite)
        return Outcome(FAILED if silent else REFUSED, warned or run.message, **about)
    if not finite:
        return Outcome(FAILED, "the run is done, yet holds numbers that are not finite", **about)
    statements = [*case.judge(run), *_change_with_half_the_step(case, run, options)]
    if not (case.driven or case.energy_is_fed_in) or run.method == "edmc":  # the account of work of other methods is rough
        statements.insert(0, account_statement(run) if case.energy_is_fed_in else energy_statement(run))
    promised = tuple(s for s in statements if s.kind not in NOT_PROMISED.get(asked if extrapolate else run.method, ()))
    broken = [s for s in promised if not s.holds]
    if not broken:
        return Outcome(HELD, "", promised, **about)
    said = caveats(run, other_package or (asked in schemes.EMBEDDED and dt is None))
    if method is not None and said and all(s.kind in EXCUSED_BY_CAVEAT for s in broken):
        return Outcome(REFUSED, " ".join(said), promised, **about)
    audited, _ = _run(case, method, dt, audit=True, **options)
    return Outcome(FAILED, "; ".join(map(str, broken)), promised, audit=audited.status, **about)


def _run(case, method, dt, **options):
    """The run and what the library warned of before it."""
    with warnings.catch_warnings(record=True) as caught, bounded_work(*_bounds_of_work(case, method)):
        warnings.simplefilter("always")
        every = case.save_every
        if every is not None and not (method in SCIPY + DIFFRAX or (method in schemes.EMBEDDED and dt is None)):
            whole = dt or choose(case.scene, method, None, False).dt
            dt = every / math.ceil(every / whole * (1 - 1e-12))  # steps that end on what is saved
        run = simulate(case.scene, case.t_end, method=method, dt=dt, start=case.start_state(), save_every=every, **options)
    return run, next((str(w.message) for w in caught if issubclass(w.category, StabilityWarning)), "")


def _change_with_half_the_step(case, run, options):
    """How much the result changes with half the step, where the method has a step and order 2."""
    if case.measure is None or run.method in STEP_CHOOSING or ACCURACY in NOT_PROMISED.get(run.method, ()):
        return []
    other, _ = _run(case, run.method, 0.5 * run.dt, **options)
    change = np.abs(case.measure(run) - case.measure(other)).max() if other.ok else np.inf
    return [Statement(ACCURACY, "change of the result with half the step", float(change), most=case.tolerance, unit=case.unit)]


def _too_much_work(case, method, dt, limit):
    """Why a run would take too many steps, or ""."""
    nodes = build(case.scene).n
    if method in schemes.EXPLICIT:
        most = NODE_STEPS / EVALUATIONS.get(method, 1)
        if case.t_end / dt * nodes > most and math.isfinite(limit) and dt < limit:
            return f"{method} would need {case.t_end / dt:.2g} steps of {dt:.2g} s"
    if method in SCIPY and _evaluations(case, method) < FEWEST:
        return f"{method} may spend {_evaluations(case, method)} force evaluations on {nodes} nodes here, too few steps to try"
    if method in DIFFRAX and NODE_TRIES[method] / nodes < FEWEST:
        return f"{method} may try {int(NODE_TRIES[method] / nodes)} steps on {nodes} nodes here, too few steps to try"
    if method in ("dop853", "Tsit5") and case.t_end / limit > NODE_TRIES[method] / nodes:
        return f"{method} would need {case.t_end / limit:.2g} steps, as its error control is driven to {limit:.2g} s"
    if method in ("RK45", "DOP853") and case.t_end / limit * 8 > _evaluations(case, method):
        return f"{method} would need {case.t_end / limit:.2g} steps, as its error control is driven to {limit:.2g} s"
    return ""


def _evaluations(case, method):
    """Force evaluations that a run with one of scipy's solvers may take."""
    return int(NODE_EVALUATIONS.get(method, 0) / build(case.scene).n)


def _bounds_of_work(case, method):
    """Arguments of `bounded_work`."""
    module = embedded_march if method in schemes.EMBEDDED else None
    if method in DIFFRAX:  # which needs packages of its own
        module = import_module("integrators.diffrax_adapter")
    return _evaluations(case, method), module, int(NODE_TRIES.get(method, 0) / build(case.scene).n)


@contextmanager
def bounded_work(evaluations, module=None, tries=0):
    """Within it, a run gives up and says so once it has done its work.

    Parameters
    ----------
    evaluations : of the force, by one of scipy's solvers
    module : of `integrators`, whose march chooses its steps, or None
    tries : steps that this march may try
    """
    bounds = {scipy_adapter: evaluations} | ({module: tries} if module else {})
    before = {bounded: bounded.MOST for bounded in bounds}
    for bounded, number in bounds.items():
        bounded.MOST = number
    try:
        yield
    finally:
        for bounded, number in before.items():
            bounded.MOST = number
