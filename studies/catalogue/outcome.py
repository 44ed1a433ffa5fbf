"""How a case goes with a method: its statements hold, or the library says that the method does not serve, or it fails."""

import math
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.model.build import build
from anet_lumped.motion.choice import choose
from anet_lumped.motion.energy_gain import GAINED as ENERGY_GAINED
from anet_lumped.motion.run_warnings import Finding, findings
from anet_lumped.motion.simulate import StabilityWarning, simulate
from anet_lumped.results.run import STATUS
from anet_lumped.statics.equilibrium import EquilibriumError
from integrators import schemes
from integrators.schemes.record import Origin, Stepping
from integrators.system import DIVERGED, OUT_OF_STEPS
from studies.catalogue.case import ACCURACY, LOAD, REST, SPIN, Case, Statement, account_statement, energy_statement

HELD, REFUSED, FAILED = "held", "refused", "failed"
GAINED = "gained"  # energy, by a random trial with a method that does not promise otherwise
DEFAULT = "default"  # no method given
NODE_STEPS = 1e7  # of an explicit run; beyond, it is refused for its number of steps
NODE_EVALUATIONS = {True: 4e5, False: 4e4}
"""Nodes times force evaluations of a run with one of scipy's solvers, explicit or not; beyond, it is refused likewise."""
OWN_NODE_TRIES, EXPLICIT_NODE_TRIES, IMPLICIT_NODE_TRIES = 2e7, 1e6, 1.5e6
"""Nodes times steps tried of a run that chooses its steps; beyond, it gives up. Of an embedded pair of this package, of an explicit
solver of diffrax, and of an implicit one times its order."""
SPENT_A_STEP = 8  # force evaluations of a step of an explicit pair of scipy's, about
SCIPY_MARCH, DIFFRAX_MARCH = "integrators.adapters.scipy_adapter", "integrators.adapters.diffrax_adapter"
EMBEDDED_MARCH = "integrators.marching.embedded_steps"  # modules with a bound `MOST_WORK` of their own
FEWEST = 200  # evaluations, or steps, that are worth a try
EXCUSED_BY_WARNING = (ACCURACY, REST, LOAD)
"""Kinds of statements that a run may break which says so itself, in its warnings; not energy, momentum or spin."""
# Causes of a refusal, as labels of a figure.
STEPS, NODES, WORK, NEVER_STABLE, STEP, RIGID, MISSING, OTHER = (
    "steps", "nodes", "work", "never stable", "step", "EA = inf", "missing", "refused"
)  # fmt: skip
CAUSE_OF_STATUS = {ENERGY_GAINED: "energy", STATUS[DIVERGED]: "diverged", STATUS[OUT_OF_STEPS]: STEPS}
CAUSE_OF_FINDING = {
    Finding.UNACCOUNTED_ENERGY: "lost energy",
    Finding.TAKEN_BY_METHOD: "lost energy",
    Finding.EXCESS_LENGTH: "length",
    Finding.FAR_FROM_LIMIT: "no limit",
    Finding.MULTIPLIED_ERRORS: "errors",
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


def compiled_methods():
    """Methods by name without those of diffrax, which JAX compiles for every scene."""
    return tuple(name for name in schemes.names() if schemes.scheme(name).origin is not Origin.DIFFRAX)


def extrapolated_name(method):
    """Name of the extrapolation of two runs with a method."""
    return f"{method}_extrapolated"


EXTRAPOLATED = extrapolated_name("edmc")


def extrapolations():
    """Methods that can be extrapolated, by the names of their extrapolations."""
    return {extrapolated_name(name): name for name in schemes.names() if schemes.scheme(name).extrapolated_order is not None}


def methods_tried():
    """The default, all methods by name, and beside those that can be extrapolated their extrapolations."""
    found = [DEFAULT]
    for name in schemes.names():
        found += [name, *(extrapolation for extrapolation, method in extrapolations().items() if method == name)]
    return tuple(found)


def not_promised(method):
    """Kinds of statements that a method, or an extrapolation, is not judged by, as the record of its scheme denies them."""
    if method in extrapolations():
        return (SPIN,)  # a product, which a mean of two runs does not keep
    scheme = schemes.scheme(method)
    kinds = (ACCURACY,) if scheme.damps_the_motion else ()
    return kinds if not scheme.own or scheme.explicit or scheme.keeps_angular_momentum else (*kinds, SPIN)


def node_tries(scheme):
    """Nodes times steps tried of a run with a scheme that chooses its steps."""
    if scheme.own:
        return OWN_NODE_TRIES
    return EXPLICIT_NODE_TRIES if scheme.explicit else IMPLICIT_NODE_TRIES / scheme.order


def try_case(case: Case, method: str) -> Outcome:
    """Run a case with a method and judge it.

    A method asked for by name is refused where the library says in words that it does not serve: by an error of its own in place
    of a run, a status other than "done" with a message, a `StabilityWarning`, more work than `NODE_STEPS`, `NODE_EVALUATIONS` or
    `node_tries` allow, or a warning of the run where what is broken is of the kinds `EXCUSED_BY_WARNING`. The default method has
    to hold: where the library refuses, it has failed. Explicit methods run at the step that is chosen for them or at the one that
    the motion asks for, whichever is less; those that choose their steps do so, unless the case is about a step that is given.

    Parameters
    ----------
    method : one of `methods_tried`
    """
    try:
        return _try_case(case, method)
    except (InputError, EquilibriumError) as error:
        rigid = any(cable.inextensible for cable in case.scene.cables) and method != DEFAULT
        said, cause = str(error), RIGID if rigid else OTHER
    except ModuleNotFoundError as error:  # a package that is not installed; never a file of ours
        if error.name.partition(".")[0] in ("anet_lumped", "integrators", "studies"):
            raise
        said, cause = str(error), MISSING
    return Outcome(FAILED if method == DEFAULT else REFUSED, said, method="" if method == DEFAULT else method, cause=cause)


def _try_case(case, asked):
    extrapolate = asked in extrapolations()
    method = None if asked == DEFAULT else extrapolations().get(asked, asked)
    scheme = None if method is None else schemes.scheme(method)
    choice = choose(case.scene, method, case.dt, scheme is not None and scheme.stepping is Stepping.ADAPTIVE)
    dt = case.dt
    if scheme is not None and scheme.own and scheme.explicit and not case.step_is_given:
        own = choose(case.scene, method, None, False).dt
        dt = None if scheme.embedded else min(own, dt or own)
    adaptive = scheme is not None and scheme.chooses_steps(dt)
    cause, refusal = _too_much_work(case, schemes.scheme(choice.method), dt or choice.dt, choice.limit)
    if refusal:
        outcome = FAILED if method is None else REFUSED
        return Outcome(outcome, refusal, method=choice.method, dt=dt or choice.dt, cause=cause)
    options = {"extrapolate": True} if extrapolate else {}
    run, warned = _run(case, method, dt, **options)
    about = {"method": run.method, "dt": run.dt, "steps": run.work.steps, "seconds": run.wall_time}
    finite = all(np.isfinite(x).all() for x in (run.q, run.v, run.energy))
    if warned or not run.ok:
        silent = method is None or not (warned or run.message) or (run.ok and not finite)
        cause = (NEVER_STABLE if choice.limit == 0.0 else STEP) if warned else _cause(case, run)
        return Outcome(FAILED if silent else REFUSED, warned or run.message, cause=cause, **about)
    if not finite:
        return Outcome(FAILED, "the run is done, yet holds numbers that are not finite", **about)
    statements = [*case.judge(run), *_change_with_half_the_step(case, run, options)]
    if not (case.driven or case.energy_is_fed_in) or run.method == "edmc":  # the account of work of other methods is rough
        statements.insert(0, account_statement(run) if case.energy_is_fed_in else energy_statement(run))
    promised = tuple(s for s in statements if s.kind not in not_promised(asked if extrapolate else run.method))
    broken = [s for s in promised if not s.holds]
    if not broken:
        return Outcome(HELD, "", promised, **about)
    found = findings(run, adaptive)
    if method is not None and found and all(s.kind in EXCUSED_BY_WARNING for s in broken):
        return Outcome(REFUSED, " ".join(found.values()), promised, cause=CAUSE_OF_FINDING.get(next(iter(found)), OTHER), **about)
    audited, _ = _run(case, method, dt, audit=True, **options)
    return Outcome(FAILED, "; ".join(map(str, broken)), promised, audit=audited.status, **about)


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


def _run(case, method, dt, **options):
    """The run and what the library warned of before it."""
    scheme = None if method is None else schemes.scheme(method)
    with warnings.catch_warnings(record=True) as caught, bounded_work(*_bounds_of_work(case, scheme)):
        warnings.simplefilter("always")
        every = case.save_every
        if every is not None and not (scheme is not None and scheme.chooses_steps(dt)):
            whole = dt or choose(case.scene, method, None, False).dt
            dt = every / math.ceil(every / whole * (1 - 1e-12))  # steps that end on what is saved
        run = simulate(case.scene, case.t_end, method=method, dt=dt, start=case.start_state(), save_every=every, **options)
    return run, next((str(w.message) for w in caught if issubclass(w.category, StabilityWarning)), "")


def _change_with_half_the_step(case, run, options):
    """How much the result changes with half the step, where the method has a step and order 2."""
    steps_given = schemes.scheme(run.method).stepping is Stepping.FIXED
    if case.measure is None or not steps_given or ACCURACY in not_promised(run.method):
        return []
    other, _ = _run(case, run.method, 0.5 * run.dt, **options)
    change = np.abs(case.measure(run) - case.measure(other)).max() if other.ok else np.inf
    return [Statement(ACCURACY, "change of the result with half the step", float(change), most=case.tolerance, unit=case.unit)]


def _too_much_work(case, scheme, dt, limit):
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


def _bounds_of_work(case, scheme):
    """Arguments of `bounded_work`."""
    if scheme is None or scheme.stepping is Stepping.FIXED:
        return 0, "", 0
    if scheme.origin is Origin.SCIPY:
        return _evaluations(case, scheme), "", 0
    return 0, EMBEDDED_MARCH if scheme.own else DIFFRAX_MARCH, int(node_tries(scheme) / build(case.scene).n)


@contextmanager
def bounded_work(evaluations, march="", tries=0):
    """Within it, a run gives up and says so once it has done its work.

    Parameters
    ----------
    evaluations : of the force, by one of scipy's solvers
    march : name of a module whose march chooses its steps, or ""
    tries : steps that this march may try
    """
    bounds = {SCIPY_MARCH: evaluations} | ({march: tries} if march else {})
    modules = {import_module(name): number for name, number in bounds.items()}
    before = {module: module.MOST_WORK for module in modules}
    for module, number in modules.items():
        module.MOST_WORK = number
    try:
        yield
    finally:
        for module, number in before.items():
            module.MOST_WORK = number
