"""Simulate a scene: method and step, the march through its events, and the verdicts on the run."""

import math
import warnings
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, number, quoted, shown
from anet_lumped.model import rest_lengths
from anet_lumped.model.build import build
from anet_lumped.model.remainder import lightest
from anet_lumped.results.audit import audited
from anet_lumped.results.near_origin import computed_near_origin
from anet_lumped.results.run import STATUS, Run, RunInterrupt
from anet_lumped.results.state import State
from anet_lumped.scene.origin import largest_distance
from anet_lumped.scene.scene import Driven, Scene, check_scene
from anet_lumped.statics.equilibrium import equilibrium
from anet_lumped.statics.starts import Start, start_state, straight
from integrators import schemes
from integrators.schemes.record import Origin, Scheme
from integrators.system import DIVERGED, UNCONVERGED

from .accuracy import TENSION_ERROR, Wanted, keep_error
from .choice import LONGEST_CHOSEN, Choice, by_links, check_method, choose, links_are_cheaper
from .energy_gain import GAINED, flag_energy_gain
from .extrapolation import extrapolated, method_to_extrapolate
from .failure_messages import with_cause
from .judged_states import as_asked, judged_every
from .legs import Settings, march_legs
from .link_legs import SLACK_ALLOWED, slack_time
from .run_warnings import warnings_of
from .stability import transverse_frequency
from .times import check_counts
from .tolerance import keep_error_by_tolerance

RUNS_INSTEAD = 4  # of links by default, in place of an implicit method: four powers of ten of the tolerance
MEANT_STRAIN = 0.2  # of a straight start: cords break before
DEFAULT_RTOL, DEFAULT_ATOL = 1e-6, 1e-9  # [m]; of the largest coordinate where no tolerance is given
_audits = ContextVar("audits", default=False)  # whether this thread makes a run for an audit, which gives no warnings
__all__ = ["RunError", "RunInterrupt", "StabilityWarning", "simulate", "straight"]


class StabilityWarning(UserWarning):
    """A step beyond the predicted limit of its method."""


class RunError(RuntimeError):
    """A run that is not "done"; ``run`` holds what there is of it."""

    def __init__(self, run: Run) -> None:
        super().__init__(run.message)
        self.run = run


@computed_near_origin
def simulate(
    scene: Scene, t_end: float, *, method: str | None = None, dt: float | None = None, start: Start = "equilibrium",
    save_every: float | None = None, rtol: float | None = None, atol: float | None = None, rho_inf: float | None = None,
    extrapolate: bool = False, error: float | None = None, tension_error: float | None = None, audit: bool | float = False,
    check: bool = False,
) -> Run:  # fmt: skip
    """Motion of a scene from rest or from a State, through its events and the breaks of its cables (`Run.events`).

    Parameters
    ----------
    scene : Scene
    t_end : float [s]
    method : str or None
        A scheme of `integrators.schemes`; None picks one from the predicted limits and the motion's time scale, see ``Run.reason``.
    dt : float or None [s]
        Step; None picks it. With rtol or atol, the first step of an adaptive march; `dop853` without dt is adaptive at
        rtol=1e-6, as the solvers of other packages are.
    start : "equilibrium", "straight", State or dict
        "straight" has the nodes evenly spaced between the places of the points, at rest; a dict holds the places of each cable's
        nodes by the cable's name, (segments + 1, 3) [m], at rest.
    save_every : float or None [s]
        Time between saved states, a multiple of dt for a fixed step; None saves about 400 states, or every step if fewer.
    rtol, atol : float or None
        Adaptive steps by step doubling: the error of a step is kept below atol [m] + rtol times the largest coordinate.
        `dop853` has an estimate of its own, which counts an error of a velocity as that of a place a second later.
    rho_inf : float or None
        Spectral radius at infinite frequency, for `edmc` (default 0) and `generalised_alpha` (default 0.8).
    extrapolate : bool
        Run with half the step too, and take the limit that the two runs of `edmc` tend to: order 4 where the motion is smooth, for
        half as much again as the finer run.
    error, tension_error : float or None [m], 1
        Errors to keep, of places and of the largest tension over that tension: the step is made shorter until the run's own
        estimates are within them (`Run.error_estimate`, `Run.tension_error`). None, and neither method nor step given, keeps 1 mm
        in a metre of the longest cable, 5 % of the motion, and 2 % of the largest tension, as far as that costs no more than some
        15 s of one core or 8 times the first step; with errors given, ten times that (`motion.accuracy`). What is not kept, past a
        whip, in chaos or beyond that budget, ``Run.reason`` and a warning say, from when on, and how to go further.
    audit : bool or float [m]
        Run again with half the step or a tenth of the tolerance, and compare: ``Run.audit`` estimates the error of the run, and
        its status is "audit failed" if that is above the number given (True: 1 % of the longest cable) or if the energy
        does not balance. Costs two to three times the run.
    check : bool
        Raise `RunError` if the run is not "done", instead of returning what there is.

    Returns
    -------
    Run

    Raises
    ------
    InputError : an argument out of its range
    RunError : with ``check=True``
    RunInterrupt : Ctrl-C; with what was done as its ``run``
    """
    check_scene(scene)
    _check(t_end, method, dt, save_every, rtol, atol, rho_inf, audit, error, tension_error)
    t_end, audit = number(t_end), audit if isinstance(audit, bool) else number(audit)
    dt, save_every, rtol, atol, rho_inf, error, tension_error = (
        None if value is None else number(value) for value in (dt, save_every, rtol, atol, rho_inf, error, tension_error)
    )
    save_every = None if save_every is None else min(save_every, t_end)
    if extrapolate:
        method = method_to_extrapolate(method, rtol, atol)
    scheme = None if method is None else schemes.scheme(method)
    if isinstance(start, str) and start == "equilibrium":
        begin = equilibrium(scene)
    else:
        begin = start_state(build(scene), start, scheme is not None and scheme.keeps_constraints)
    _check_external(scene, begin)
    apart, most = float(np.ptp(begin.q, axis=0).max()), largest_distance(scene)
    if not apart < most:
        raise InputError(
            f"Nodes must start within {most:.3g} m of each other, beyond which a motion counts as diverged, but they are "
            f"{apart:.3g} m apart."
        )
    adaptive = rtol is not None or atol is not None or (scheme is not None and scheme.chooses_steps(dt))
    if scheme is not None and not scheme.takes_changing_rest_lengths and rest_lengths.changes(scene):
        able = ", ".join(schemes.names(takes_changing_rest_lengths=True))
        raise InputError(f"Lengths that change in time need a method of this package, {able}, but the method is {method}.")
    if scheme is not None and not scheme.takes_rigid_bodies and begin.model.has_bodies:
        able = ", ".join(schemes.names(takes_rigid_bodies=True))
        raise InputError(f"Bodies that move need one of the methods {able}, but the method is {method}.")
    if scheme is not None and not scheme.own and begin.model.n_free == 0:
        raise InputError(
            f"Solvers of other packages need a node that moves freely, but the scene has none and the method is {method}."
        )
    lightest_scene = lightest(rest_lengths.at_shortest(scene, begin.t, begin.t + t_end))
    transverse = transverse_frequency(begin)
    speed = float(np.ptp(begin.v, axis=0).max())
    choice = choose(lightest_scene, method, dt, adaptive, begin.least_tension, transverse, speed)
    scheme = schemes.scheme(choice.method)
    _check_breaks(scene, scheme, extrapolate)
    if adaptive:
        longest = LONGEST_CHOSEN * choice.dt if dt is None else None
    else:
        longest = choice.dt if dt is not None or save_every is None else min(choice.dt, save_every)
    check_counts(scene, begin.t, begin.t + t_end, longest, save_every, adaptive)
    if dt is None and not adaptive:
        span = save_every or t_end
        choice = _ending_on(choice, span, "t_end" if save_every is None else "save_every")
    for text in choice.warnings:
        _warn(text, StabilityWarning)
    if isinstance(start, str) and start == "straight":
        for text in overstretched(begin):
            _warn(text, UserWarning)
            choice = replace(choice, warnings=(*choice.warnings, text))
    settings = Settings(adaptive, _tolerances(rtol, atol), rho_inf)
    whole = partial(march_legs, _march_of(scheme), scene, start=begin, t_end=begin.t + t_end, settings=settings)
    asked = error is not None or tension_error is not None
    by_default = method is None and dt is None and not adaptive and not extrapolate
    wanted = Wanted(error, TENSION_ERROR if tension_error is None else tension_error)
    length = max(cable.length for cable in scene.cables)

    def by_tolerance(choice: Choice, most: float = math.inf) -> Run:
        def march(tolerance: float) -> Run:
            nonlocal settings
            settings = Settings(True, (0.0, tolerance), rho_inf)
            return whole(choice, save_every=save_every, settings=settings)

        return keep_error_by_tolerance(march, wanted, length, most)

    def by_links_instead(run: Run, parts: float) -> Run | None:
        other = by_links(choice, transverse)
        iterations = run.work.newton_iterations / max(run.work.steps, 1)
        if not links_are_cheaper(replace(choice, dt=run.dt), other.limit, parts, iterations):
            return None
        found = by_tolerance(other, RUNS_INSTEAD)
        return found if found.kept and slack_time(found) <= SLACK_ALLOWED * t_end else None

    if asked and scheme.embedded and rtol is None and atol is None:
        run = by_tolerance(choice)
    elif asked or by_default:
        _check_keeps_error(scheme, dt, adaptive, extrapolate)
        choice, every = judged_every(choice, save_every, t_end)

        def march(choice: Choice, duration: float) -> Run:
            return whole(choice, save_every=every, t_end=begin.t + duration)

        rigid = by_default and all(cable.inextensible for cable in scene.cables)
        run = keep_error(march, choice, wanted, t_end, save_every or t_end, by_links_instead if rigid else None, asked=asked)
        if rigid and run.ok and not run.kept:  # what multiplies errors leaves less of those of order 8
            run = by_links_instead(run, math.inf) or run
        if save_every is not None and every != save_every:
            run = as_asked(run, save_every, wanted.tension_error)
    else:
        run = whole(choice, save_every=save_every)
    if run.method != choice.method:
        adaptive, scheme = True, schemes.scheme(run.method)
    choice = replace(choice, dt=run.dt)
    if extrapolate:
        every = run.t[1] - run.t[0] if len(run.t) > 2 else t_end
        run = extrapolated(run, whole(replace(choice, dt=0.5 * choice.dt), save_every=every))
    if audit and run.ok:
        every = save_every if adaptive or len(run.t) < 3 else run.t[1] - run.t[0]

        def again(parts: int) -> Run:
            finer: dict[str, Any] = {"dt": run.dt / parts}
            if adaptive:
                finer = {name: 0.1 * x or None for name, x in zip(("rtol", "atol"), settings.tolerances, strict=True)}
            finer |= {"method": run.method, "rho_inf": rho_inf, "extrapolate": extrapolate, "save_every": every}
            before = _audits.set(True)
            try:
                return simulate(scene, t_end, start=start, **finer)
            finally:
                _audits.reset(before)

        order = None if adaptive else scheme.extrapolated_order if extrapolate else scheme.order
        run = audited(run, again, order, None if audit is True else audit)
    if run.ok:
        run = flag_energy_gain(run, choice.limit, adaptive)
    if run.ok:
        run = replace(run, warnings=run.warnings + warnings_of(run, adaptive))
    if run.status in (STATUS[DIVERGED], STATUS[UNCONVERGED], GAINED):
        run = with_cause(run)
    if check and not run.ok:
        raise RunError(run)
    return run


def _warn(text: str, category: type[Warning]) -> None:
    """Give a warning to whoever called `simulate`; the filters of `warnings` would silence it in other threads, too."""
    if not _audits.get():
        warnings.warn(text, category, stacklevel=4)  # of the caller of `simulate`, beyond its decorator


def _tolerances(rtol: float | None, atol: float | None) -> tuple[float, float]:
    """Relative and absolute tolerance [m] with their defaults: one that is given alone stands alone."""
    if rtol is None and atol is None:
        return DEFAULT_RTOL, DEFAULT_ATOL
    return rtol or 0.0, atol or 0.0


def _march_of(scheme: Scheme) -> Callable[..., Any]:
    """What marches a leg with a scheme; JAX is imported, and computes in float64 from then on, for the solvers of diffrax."""
    if scheme.origin is Origin.OWN:
        from .own_methods import march
    elif scheme.origin is Origin.SCIPY:
        from .scipy_methods import march
    else:
        try:
            from .jax.diffrax_methods import march
        except ModuleNotFoundError as missing:
            raise ModuleNotFoundError(
                f'Method "{scheme.name}" needs the packages jax and diffrax, but there is no {missing.name}; '
                'pip install "anet-lumped[diffrax]" brings them.'
            ) from missing
    return march


def overstretched(begin: State) -> list[str]:
    """Warning in a list if the places of points stretch cables by more than a start that is meant would."""
    worst = max(begin.scene.cables, key=lambda cable: begin.length(cable.name) / cable.length)
    strain = begin.length(worst.name) / worst.length - 1.0
    if strain <= MEANT_STRAIN:
        return []
    return [
        f'start="straight" stretches cable {quoted(worst.name)} of {worst.length:g} m by {strain:.0%}: its ends are '
        f"{begin.length(worst.name):.4g} m apart, and the run begins with the energy of that."
    ]


def _check_breaks(scene: Scene, scheme: Scheme, extrapolate: bool) -> None:
    """Cables that may break need a march that looks for it, and one motion."""
    brittle = next((cable.name for cable in scene.cables if cable.breaking_tension is not None), None)
    if brittle is not None and (extrapolate or not scheme.stops_at_events):
        unable = ", ".join(schemes.names(stops_at_events=False))
        given = "`extrapolate` is set" if extrapolate else f"the method is {scheme.name}"
        raise InputError(
            f"A cable with a `breaking_tension` needs a method other than {unable} and one run, but cable {quoted(brittle)} "
            f"has one and {given}."
        )


def _check_keeps_error(scheme: Scheme, dt: float | None, adaptive: bool, extrapolate: bool) -> None:
    """An error is kept by the step, of a scheme whose own steps tell it."""
    given = "`dt`" if dt is not None else "`rtol` or `atol`" if adaptive else "`extrapolate`" if extrapolate else None
    if given or not scheme.own:
        what = f"{given} is given" if given else f"the method is {scheme.name}"
        raise InputError(
            f"Arguments `error` and `tension_error` choose the step of one run with a method of this package, but {what}; "
            "leave it out, or take `audit`."
        )


def _check_external(scene: Scene, begin: State) -> None:
    """Points that a session drives stand at their start in a run of their own, so that it cannot begin with them elsewhere."""
    for point in scene.all_points:
        if isinstance(point, Driven) and point.path.kind == "external":
            start = point.path.at(begin.t)[0]
            if not np.allclose(begin.position(point.name), start, rtol=1e-12, atol=1e-12):
                raise InputError(
                    f"A point with the path paths.external stands at its start in a run, {tuple(start.tolist())}, but the state to "
                    f"start from has {quoted(point.name)} at {tuple(begin.position(point.name).tolist())}; go on in a Session, or "
                    "give the point another path."
                )


def _ending_on(choice: Choice, span: float, called: str) -> Choice:
    """The choice with steps that end on what is saved, which its reason says where it shows in three digits."""
    dt = span / math.ceil(span / choice.dt)
    shorter = f"; shortened to {1e3 * dt:.3g} ms to meet {called}" if f"{dt:.3g}" != f"{choice.dt:.3g}" else ""
    return replace(choice, dt=dt, reason=choice.reason + shorter)


def _check(t_end: Any, method: Any, dt: Any, save_every: Any, rtol: Any, atol: Any, rho_inf: Any, audit: Any, *errors: Any) -> None:
    sizes = dict(t_end=t_end, dt=dt, save_every=save_every, rtol=rtol, atol=atol, audit=1.0 if isinstance(audit, bool) else audit)
    sizes |= dict(zip(("error", "tension_error"), errors, strict=True))
    for name, value in sizes.items():
        if (value is not None or name in ("t_end", "audit")) and not (0 < number(value) < math.inf):
            unit = "" if name in ("rtol", "tension_error") else " [m]" if name in ("atol", "audit", "error") else " [s]"
            raise InputError(f"Argument `{name}` must be positive and finite{unit}, but it is {shown(value)}.")
    if dt is not None and number(dt) > number(t_end) * (1 + 1e-9):
        raise InputError(f"Argument `dt` must not exceed t_end={number(t_end):g} s, but it is {number(dt):g} s.")
    check_method(method, rho_inf)
