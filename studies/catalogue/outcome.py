"""What becomes of a case with a method: its statements hold, or the library says that they cannot, or it fails."""

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
from integrators import schemes, scipy_adapter
from studies.catalogue.case import ACCURACY, LOAD, REST, SPIN, Case, Statement, account_statement, energy_statement

HELD, REFUSED, FAILED = "held", "refused", "failed"
DEFAULT = "default"  # no method given
EXTRAPOLATED = "edmc_extrapolated"  # method="edmc", extrapolate=True
METHODS = (*schemes.EXPLICIT, *schemes.IMPLICIT, *SCIPY)  # without diffrax's, which are compiled for every scene
WAYS = (DEFAULT, *schemes.EXPLICIT, "edmc", EXTRAPOLATED, *schemes.IMPLICIT[1:], *SCIPY, *DIFFRAX)
EVALUATIONS = {"rk4": 4, "dop853": 12}  # of the force in an explicit step, where not one
OF_ITSELF = (*SCIPY, *DIFFRAX, *schemes.EMBEDDED)
NODE_STEPS = 1e7  # of an explicit run; beyond, it is refused for its number of steps
NODE_EVALUATIONS = {"RK45": 4e5, "DOP853": 4e5, "Radau": 4e4, "BDF": 4e4, "LSODA": 4e4}
"""Nodes times force evaluations of a run with one of scipy's solvers; beyond, it is refused likewise."""
NODE_TRIES = {"dop853": 2e7, "Tsit5": 1e6, "Kvaerno3": 5e5, "Kvaerno5": 2e5}
"""Nodes times steps tried of a run that chooses its steps; beyond, it gives up."""
FEWEST = 200  # evaluations, or steps, that are worth a try
NOT_ASKED = {  # what a scheme's own note in `anet_lumped.motion.stability` denies
    "backward_euler": (ACCURACY, SPIN),  # damps the motion itself strongly
    "sdirk2": (SPIN,),  # nor do these promise angular momentum
    "tr_bdf2": (SPIN,),
    "generalised_alpha": (SPIN,),
    EXTRAPOLATED: (SPIN,),  # a product, which a mean of two runs does not keep
}
EXCUSED = (ACCURACY, REST, LOAD)
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


def meet(case: Case, way: str) -> Outcome:
    """Run a case with a method and judge it.

    An error of the library's own in place of a run is a refusal, and so are a status other than "done" with a message, a
    `StabilityWarning`, more work than `NODE_STEPS`, `NODE_EVALUATIONS` or `NODE_TRIES` allow, and a caveat of the run where what
    is broken is `EXCUSED`; but for the default method: that one has to hold. Explicit methods run at the step that is chosen for
    them or at the one that the motion asks for, whichever is less; `OF_ITSELF` those that choose their steps, unless the case is
    about a step that is given.
    """
    try:
        method = {DEFAULT: None, EXTRAPOLATED: "edmc"}.get(way, way)
        return _meet(case, method, way, {"extrapolate": True} if way == EXTRAPOLATED else {})
    except (SceneError, EquilibriumError, ValueError, ModuleNotFoundError) as error:
        return Outcome(FAILED if way == DEFAULT else REFUSED, str(error), method="" if way == DEFAULT else way)


def _meet(case, method, way, how):
    of_itself = way in SCIPY + DIFFRAX
    choice = choose(case.scene, method, case.dt, of_itself)
    dt = case.dt
    if way in schemes.EMBEDDED and not case.given:
        dt = None
    elif way in schemes.EXPLICIT and not case.given:
        own = choose(case.scene, method, None, False).dt
        dt = min(own, dt or own)
    refusal = _too_many(case, choice.method, dt or choice.dt, choice.limit)
    if refusal:
        return Outcome(FAILED if method is None else REFUSED, refusal, method=choice.method, dt=dt or choice.dt)
    run, said = _run(case, method, dt, **how)
    done = {"method": run.method, "dt": run.dt, "steps": run.work.steps, "seconds": run.wall_time}
    finite = all(np.isfinite(x).all() for x in (run.q, run.v, run.energy))
    if said or not run.ok:
        silent = method is None or not (said or run.message) or (run.ok and not finite)
        return Outcome(FAILED if silent else REFUSED, said or run.message, **done)
    if not finite:
        return Outcome(FAILED, "the run is done, yet holds numbers that are not finite", **done)
    statements = [*case.judge(run), *_halved(case, run, how)]
    if not (case.driven or case.fed) or run.method == "edmc":  # other methods' accounts of work that is fed in are rough
        statements.insert(0, account_statement(run) if case.fed else energy_statement(run))
    asked = tuple(s for s in statements if s.kind not in NOT_ASKED.get(way if how else run.method, ()))
    broken = [s for s in asked if not s.holds]
    if not broken:
        return Outcome(HELD, "", asked, **done)
    own = caveats(run, of_itself or (way in schemes.EMBEDDED and dt is None))
    if method is not None and own and all(s.kind in EXCUSED for s in broken):
        return Outcome(REFUSED, " ".join(own), asked, **done)
    audited, _ = _run(case, method, dt, audit=True, **how)
    return Outcome(FAILED, "; ".join(map(str, broken)), asked, audit=audited.status, **done)


def _run(case, method, dt, **how):
    """The run and what the library warned of before it."""
    with warnings.catch_warnings(record=True) as caught, bounded(*_most(case, method)):
        warnings.simplefilter("always")
        every = case.saved
        if every is not None and not (method in SCIPY + DIFFRAX or (method in schemes.EMBEDDED and dt is None)):
            whole = dt or choose(case.scene, method, None, False).dt
            dt = every / math.ceil(every / whole * (1 - 1e-12))  # steps that end on what is saved
        run = simulate(case.scene, case.t_end, method=method, dt=dt, start=case.begin(), save_every=every, **how)
    return run, next((str(w.message) for w in caught if issubclass(w.category, StabilityWarning)), "")


def _halved(case, run, how):
    """How much the result changes with half the step, where the method has a step and order 2."""
    if case.measure is None or run.method in OF_ITSELF or ACCURACY in NOT_ASKED.get(run.method, ()):
        return []
    other, _ = _run(case, run.method, 0.5 * run.dt, **how)
    change = np.abs(case.measure(run) - case.measure(other)).max() if other.ok else np.inf
    return [Statement(ACCURACY, "change of the result with half the step", float(change), most=case.within, unit=case.unit)]


def _too_many(case, method, dt, limit):
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


def _most(case, method):
    """Force evaluations of one of scipy's solvers, and where the steps of a method are bounded otherwise."""
    where = "embedded" if method in schemes.EMBEDDED else "diffrax_adapter" if method in DIFFRAX else ""
    return _evaluations(case, method), where, int(NODE_TRIES.get(method, 0) / build(case.scene).n)


@contextmanager
def bounded(most, where="", tries=0):
    """Within it, a run with one of scipy's solvers may evaluate the force at most so many times; then it gives up and says so.

    So does one whose march is in the module ``where`` of `integrators`, of the steps that it may try.
    """
    of = {scipy_adapter: most} | ({import_module(f"integrators.{where}"): tries} if where else {})
    kept = {module: module.MOST for module in of}
    for module, number in of.items():
        module.MOST = number
    try:
        yield
    finally:
        for module, number in kept.items():
            module.MOST = number
