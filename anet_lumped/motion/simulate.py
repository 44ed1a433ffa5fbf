"""Simulate a scene: method and step, the march through its events, and the verdicts on the run."""

import warnings
from contextvars import ContextVar
from dataclasses import replace
from typing import Any

from anet_lumped.checks import number, quoted
from anet_lumped.results.auditing import audited
from anet_lumped.results.near_origin import computed_near_origin
from anet_lumped.results.run import Run, RunInterrupt
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene, check_scene
from anet_lumped.statics.first_state import first_state
from anet_lumped.statics.starts import Start, straight
from integrators import schemes

from .extrapolation import extrapolated, method_to_extrapolate
from .kept_errors import Keeps, check_keeps_error, errors_kept
from .known_errors import TENSION_ERROR, Wanted
from .legs import Settings
from .motion import Motion
from .plan import Asked, check_arguments, check_flags, planned
from .verdict import judged

MEANT_STRAIN = 0.2  # of a straight start: cords break before
DEFAULT_RTOL, DEFAULT_ATOL = 1e-6, 1e-9  # [m]; of the largest coordinate where no tolerance is given
_quiet = ContextVar("quiet", default=False)  # whether runs of this thread give no warnings, as those for an audit
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
    start : "equilibrium", "calm", "straight", State or dict
        "calm" is the rest without turbulence and waves, which a scene may have where it has none with those of the first moment.
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
        15 s of one core or 8 times the first step; for one that is given, ten times that (`motion.accuracy`). What is not kept,
        past a whip, in chaos or beyond that budget, ``Run.reason`` and a warning say, from when on, and how to go further.
    audit : bool or float [m]
        Run again with half the step or a tenth of the tolerance, and compare: ``Run.audit`` estimates the error of the run, and its
        status is "audit failed" if that is above the number given (True: 1 % of the longest cable, 5 % of the motion) or if
        energy does not balance. Costs two to three times the run.
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
    check_arguments(t_end, method, dt, save_every, rtol, atol, rho_inf, audit, error, tension_error)
    check_flags(extrapolate=extrapolate, check=check)
    t_end, audit = number(t_end), audit if isinstance(audit, bool) else number(audit)
    dt, save_every, rtol, atol, rho_inf, error, tension_error = (
        None if value is None else number(value) for value in (dt, save_every, rtol, atol, rho_inf, error, tension_error)
    )
    save_every = None if save_every is None else min(save_every, t_end)
    if extrapolate:
        method = method_to_extrapolate(method, rtol, atol)
    scheme = None if method is None else schemes.scheme(method)
    begin = first_state(scene, start, scheme is not None and scheme.keeps_constraints)
    plan = planned(scene, begin, Asked(t_end, method, dt, save_every, rtol, atol, extrapolate))
    for text in plan.choice.warnings:
        _warn(text, StabilityWarning)
    if isinstance(start, str) and start == "straight":
        for text in overstretched(begin):
            _warn(text, UserWarning)
            plan = plan._replace(choice=replace(plan.choice, warnings=(*plan.choice.warnings, text)))
    choice, adaptive = plan.choice, plan.adaptive
    motion = Motion(scene, begin, t_end, save_every, Settings(adaptive, _tolerances(rtol, atol), rho_inf))
    by_default = method is None and dt is None and not adaptive and not extrapolate
    keeps = Keeps(error is not None, tension_error is not None, by_default)
    if keeps.places or keeps.tensions:
        check_keeps_error(schemes.scheme(choice.method), dt, rtol is not None or atol is not None, extrapolate)
    if any(keeps):
        run, motion = errors_kept(motion, plan, Wanted(error, TENSION_ERROR if tension_error is None else tension_error), keeps)
    else:
        run = motion.march(choice)
    adaptive = adaptive or run.method != choice.method
    choice = replace(choice, dt=run.dt)
    if extrapolate:
        every = run.t[1] - run.t[0] if len(run.t) > 2 else t_end
        run = extrapolated(run, motion._replace(save_every=every).march(replace(choice, dt=0.5 * choice.dt)))
    if audit and run.ok:
        run = _audited(run, motion, start, extrapolate, audit)
    run = judged(run, choice.limit, adaptive)
    if check and not run.ok:
        raise RunError(run)
    return run


def _audited(run: Run, motion: Motion, start: Start, extrapolate: bool, allowed: bool | float) -> Run:
    """The run with an audit: it is done again with half the step, or with a tenth of the tolerance of adaptive steps.

    ``allowed`` is the error that it may have [m], or True.
    """
    adaptive, tolerances, rho_inf = motion.settings
    every = motion.save_every if adaptive or len(run.t) < 3 else run.t[1] - run.t[0]
    scheme = schemes.scheme(run.method)

    def again(parts: int) -> Run:
        finer: dict[str, Any] = {"dt": run.dt / parts}
        if adaptive:
            finer = {name: 0.1 * x or None for name, x in zip(("rtol", "atol"), tolerances, strict=True)}
        finer |= {"method": run.method, "rho_inf": rho_inf, "extrapolate": extrapolate, "save_every": every}
        before = _quiet.set(True)
        try:
            return simulate(motion.scene, motion.duration, start=start, **finer)
        finally:
            _quiet.reset(before)

    order = None if adaptive else scheme.extrapolated_order if extrapolate else scheme.order
    return audited(run, again, order, None if allowed is True else allowed)


def quiet_in_this_thread() -> None:
    """Give no warnings for runs of this thread; they are in the runs."""
    _quiet.set(True)


def _warn(text: str, category: type[Warning]) -> None:
    """Give a warning to whoever called `simulate`; the filters of `warnings` would silence it in other threads, too."""
    if not _quiet.get():
        warnings.warn(text, category, stacklevel=4)  # of the caller of `simulate`, beyond its decorator


def _tolerances(rtol: float | None, atol: float | None) -> tuple[float, float]:
    """Relative and absolute tolerance [m] with their defaults: one that is given alone stands alone."""
    if rtol is None and atol is None:
        return DEFAULT_RTOL, DEFAULT_ATOL
    return rtol or 0.0, atol or 0.0


def overstretched(begin: State) -> list[str]:
    """Warning in a list if the places of points stretch cables by more than a start that is meant would."""
    if not begin.scene.cables:
        return []
    worst = max(begin.scene.cables, key=lambda cable: begin.length(cable.name) / cable.length)
    strain = begin.length(worst.name) / worst.length - 1.0
    if strain <= MEANT_STRAIN:
        return []
    return [
        f'start="straight" stretches cable {quoted(worst.name)} of {worst.length:g} m by {strain:.0%}: its ends are '
        f"{begin.length(worst.name):.4g} m apart, and the run begins with the energy of that."
    ]
