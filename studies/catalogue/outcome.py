"""What becomes of a case with a method: its statements hold, or the library says that they cannot, or it fails."""

import math
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from anet_lumped.model.build import build
from anet_lumped.motion.choice import choose
from anet_lumped.motion.energy_gain import GAINED
from anet_lumped.motion.run_warnings import Finding, findings
from anet_lumped.motion.simulate import StabilityWarning, simulate
from anet_lumped.results.run import STATUS
from anet_lumped.scene.scene import SceneError
from anet_lumped.statics.equilibrium import EquilibriumError
from integrators import schemes
from integrators.schemes.record import Origin, Stepping
from integrators.system import DIVERGED, OUT_OF_STEPS
from studies.catalogue.case import ACCURACY, LOAD, REST, SPIN, Case, Statement, account_statement, energy_statement

HELD, REFUSED, FAILED = "held", "refused", "failed"
DEFAULT = "default"  # no method given
NODE_STEPS = 1e7  # of an explicit run; beyond, it is refused for its number of steps
NODE_EVALUATIONS = {True: 4e5, False: 4e4}
"""Nodes times force evaluations of a run with one of scipy's solvers, explicit or not; beyond, it is refused likewise."""
OWN_NODE_TRIES, EXPLICIT_NODE_TRIES, IMPLICIT_NODE_TRIES = 2e7, 1e6, 1.5e6
"""Nodes times steps tried of a run that chooses its steps; beyond, it gives up. Of an embedded pair of this package, of an explicit
solver of diffrax, and of an implicit one times its order."""
SPENT_A_STEP = 8  # force evaluations of a step of an explicit pair of scipy's, about
SCIPY_MARCH, DIFFRAX_MARCH = "integrators.adapters.scipy_adapter", "integrators.adapters.diffrax_adapter"
EMBEDDED_MARCH = "integrators.marching.embedded_steps"  # modules with a bound `MOST` of their own
FEWEST = 200  # evaluations, or steps, that are worth a try
EXCUSED = (ACCURACY, REST, LOAD)
"""Kinds of statements that a run may break which says so itself, in its warnings; not energy, momentum or spin."""
# Causes of a refusal, as labels of a figure.
STEPS, NODES, WORK, NEVER_STABLE, STEP, RIGID, MISSING, OTHER = (
    "steps", "nodes", "work", "never stable", "step", "EA = inf", "missing", "refused"
)  # fmt: skip
CAUSE_OF_STATUS = {GAINED: "energy", STATUS[DIVERGED]: "diverged", STATUS[OUT_OF_STEPS]: STEPS}
CAUSE_OF_FINDING = {
    Finding.UNACCOUNTED_ENERGY: "lost energy",
    Finding.EXCESS_LENGTH: "length",
    Finding.FAR_FROM_LIMIT: "no limit",
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
    cause : str, label of what it is refused for
    """

    outcome: str
    reason: str = ""
    statements: tuple[Statement, ...] = ()
    method: str = ""
    dt: float = math.nan
    steps: int = 0
    seconds: float = 0.0
    audit: str = ""
    cause: str = ""


def methods():
    """Methods by name without those of diffrax, which JAX compiles for every scene."""
    return tuple(name for name in schemes.names() if schemes.scheme(name).origin is not Origin.DIFFRAX)


def extrapolated_way(method):
    """Name of the way that extrapolates two runs of a method."""
    return f"{method}_extrapolated"


EXTRAPOLATED = extrapolated_way("edmc")


def extrapolations():
    """Methods that are extrapolated, by the name of the way."""
    return {extrapolated_way(name): name for name in schemes.names() if schemes.scheme(name).extrapolated_order is not None}


def ways():
    """The default, all methods by name, and beside those that are extrapolated their extrapolations."""
    found = [DEFAULT]
    for name in schemes.names():
        found += [name, *(way for way, method in extrapolations().items() if method == name)]
    return tuple(found)


def not_asked(way):
    """Kinds of statements that are not asked of a way, because the record of its scheme denies them."""
    if way in extrapolations():
        return (SPIN,)  # a product, which a mean of two runs does not keep
    scheme = schemes.scheme(way)
    kinds = (ACCURACY,) if scheme.damps_the_motion else ()
    return kinds if not scheme.own or scheme.explicit or scheme.keeps_angular_momentum else (*kinds, SPIN)


def node_tries(scheme):
    """Nodes times steps tried of a run with a scheme that chooses its steps."""
    if scheme.own:
        return OWN_NODE_TRIES
    return EXPLICIT_NODE_TRIES if scheme.explicit else IMPLICIT_NODE_TRIES / scheme.order


def meet(case: Case, way: str) -> Outcome:
    """Run a case with a method and judge it.

    An error of the library's own in place of a run is a refusal, and so are a status other than "done" with a message, a
    `StabilityWarning`, more work than `NODE_STEPS`, `NODE_EVALUATIONS` or `node_tries` allow, and a warning of the run where what
    is broken is `EXCUSED`; but for the default method: that one has to hold. Explicit methods run at the step that is chosen for
    them or at the one that the motion asks for, whichever is less; those that choose their steps do so, unless the case is
    about a step that is given.
    """
    try:
        method = None if way == DEFAULT else extrapolations().get(way, way)
        return _meet(case, method, way, {"extrapolate": True} if way in extrapolations() else {})
    except (SceneError, EquilibriumError, ValueError, ModuleNotFoundError) as error:
        method, cause = "" if way == DEFAULT else way, OTHER
        if isinstance(error, ModuleNotFoundError):
            cause = MISSING
        elif any(cable.inextensible for cable in case.scene.cables) and way != DEFAULT:
            cause = RIGID
        return Outcome(FAILED if way == DEFAULT else REFUSED, str(error), method=method, cause=cause)


def _meet(case, method, way, how):
    scheme = None if method is None else schemes.scheme(method)
    choice = choose(case.scene, method, case.dt, scheme is not None and scheme.stepping is Stepping.ADAPTIVE)
    dt = case.dt
    if scheme is not None and scheme.own and scheme.explicit and not case.given:
        own = choose(case.scene, method, None, False).dt
        dt = None if scheme.embedded else min(own, dt or own)
    adaptive = scheme is not None and scheme.chooses_steps(dt)
    cause, refusal = _too_many(case, schemes.scheme(choice.method), dt or choice.dt, choice.limit)
    if refusal:
        return Outcome(
            FAILED if method is None else REFUSED, refusal, method=choice.method, dt=dt or choice.dt, cause=cause
        )  # fmt: skip
    run, said = _run(case, method, dt, **how)
    done = {"method": run.method, "dt": run.dt, "steps": run.work.steps, "seconds": run.wall_time}
    finite = all(np.isfinite(x).all() for x in (run.q, run.v, run.energy))
    if said or not run.ok:
        silent = method is None or not (said or run.message) or (run.ok and not finite)
        cause = (NEVER_STABLE if choice.limit == 0.0 else STEP) if said else _cause(case, run)
        return Outcome(FAILED if silent else REFUSED, said or run.message, cause=cause, **done)
    if not finite:
        return Outcome(FAILED, "the run is done, yet holds numbers that are not finite", **done)
    statements = [*case.judge(run), *_halved(case, run, how)]
    if not (case.driven or case.fed) or run.method == "edmc":  # other methods' accounts of work that is fed in are rough
        statements.insert(0, account_statement(run) if case.fed else energy_statement(run))
    asked = tuple(s for s in statements if s.kind not in not_asked(way if how else run.method))
    broken = [s for s in asked if not s.holds]
    if not broken:
        return Outcome(HELD, "", asked, **done)
    found = findings(run, adaptive)
    if method is not None and found and all(s.kind in EXCUSED for s in broken):
        return Outcome(REFUSED, " ".join(found.values()), asked, cause=CAUSE_OF_FINDING[next(iter(found))], **done)
    audited, _ = _run(case, method, dt, audit=True, **how)
    return Outcome(FAILED, "; ".join(map(str, broken)), asked, audit=audited.status, **done)


def _cause(case, run):
    """Label of what stopped a run."""
    if run.status in CAUSE_OF_STATUS:
        return CAUSE_OF_STATUS[run.status]
    scheme, nodes = schemes.scheme(run.method), build(case.scene).n
    if scheme.own:
        return "tolerance" if scheme.embedded else "no root"
    tried = run.work.steps + run.work.rejected
    most = tried >= int(node_tries(scheme) / nodes) if scheme.origin is Origin.DIFFRAX else False
    return WORK if most or run.work.force_evaluations > _evaluations(case, scheme) > 0 else "gave up"


def _run(case, method, dt, **how):
    """The run and what the library warned of before it."""
    scheme = None if method is None else schemes.scheme(method)
    with warnings.catch_warnings(record=True) as caught, bounded(*_most(case, scheme)):
        warnings.simplefilter("always")
        every = case.saved
        if every is not None and not (scheme is not None and scheme.chooses_steps(dt)):
            whole = dt or choose(case.scene, method, None, False).dt
            dt = every / math.ceil(every / whole * (1 - 1e-12))  # steps that end on what is saved
        run = simulate(case.scene, case.t_end, method=method, dt=dt, start=case.begin(), save_every=every, **how)
    return run, next((str(w.message) for w in caught if issubclass(w.category, StabilityWarning)), "")


def _halved(case, run, how):
    """How much the result changes with half the step, where the method has a step and order 2."""
    steps_given = schemes.scheme(run.method).stepping is Stepping.FIXED
    if case.measure is None or not steps_given or ACCURACY in not_asked(run.method):
        return []
    other, _ = _run(case, run.method, 0.5 * run.dt, **how)
    change = np.abs(case.measure(run) - case.measure(other)).max() if other.ok else np.inf
    return [Statement(ACCURACY, "change of the result with half the step", float(change), most=case.within, unit=case.unit)]


def _too_many(case, scheme, dt, limit):
    """Label and sentence of why a run would take too many steps; empty ones if it would not."""
    nodes, method = build(case.scene).n, scheme.name
    needed = f"{method} would need {case.t_end / limit:.2g} steps, as its error control is driven to {limit:.2g} s" if limit else ""
    evaluations, tries = _evaluations(case, scheme), node_tries(scheme) / nodes if scheme.order else math.inf
    if scheme.own and scheme.explicit:
        most = NODE_STEPS / scheme.force_evaluations
        if case.t_end / dt * nodes > most and math.isfinite(limit) and dt < limit:
            return STEPS, f"{method} would need {case.t_end / dt:.2g} steps of {dt:.2g} s"
    if scheme.origin is Origin.SCIPY and evaluations < FEWEST:
        return NODES, f"{method} may spend {evaluations} force evaluations on {nodes} nodes here, too few steps to try"
    if scheme.origin is Origin.DIFFRAX and tries < FEWEST:
        return NODES, f"{method} may try {int(tries)} steps on {nodes} nodes here, too few steps to try"
    if scheme.explicit and scheme.stepping is not Stepping.FIXED:
        allowed = evaluations / SPENT_A_STEP if scheme.origin is Origin.SCIPY else tries
        if case.t_end / limit > allowed:
            return STEPS, needed
    return "", ""


def _evaluations(case, scheme):
    """Force evaluations that a run may take with one of scipy's solvers; 0 with another."""
    return int(NODE_EVALUATIONS[scheme.explicit] / build(case.scene).n) if scheme.origin is Origin.SCIPY else 0


def _most(case, scheme):
    """Force evaluations of one of scipy's solvers, and where the steps of a method are bounded otherwise."""
    if scheme is None or scheme.stepping is Stepping.FIXED:
        return 0, "", 0
    if scheme.origin is Origin.SCIPY:
        return _evaluations(case, scheme), "", 0
    return 0, EMBEDDED_MARCH if scheme.own else DIFFRAX_MARCH, int(node_tries(scheme) / build(case.scene).n)


@contextmanager
def bounded(most, where="", tries=0):
    """Within it, a run with one of scipy's solvers may evaluate the force at most so many times; then it gives up and says so.

    So does one whose march is in the module ``where``, of the steps that it may try.
    """
    bounds = {SCIPY_MARCH: most} | ({where: tries} if where else {})
    modules = {import_module(name): number for name, number in bounds.items()}
    before = {module: module.MOST for module in modules}
    for module, number in modules.items():
        module.MOST = number
    try:
        yield
    finally:
        for module, number in before.items():
            module.MOST = number
