"""A run that keeps errors: by shorter steps, by the tolerance of a method that tells the error of its steps, or by links instead.

Where no cable stretches and neither method nor step was given, links (the lengths as constraints, adaptive steps of order 8) stand
in for the implicit method where they are cheaper and no cable goes slack for long.
"""

import math
from dataclasses import replace
from typing import NamedTuple

from anet_lumped.checks import InputError
from anet_lumped.results.run import Run
from anet_lumped.scene.scene import Scene
from integrators import schemes
from integrators.schemes.record import Scheme

from .about_peak import with_peak_judged
from .accuracy import keep_error
from .choice import Choice, by_links, links_are_cheaper, shedding_cable
from .judged_states import as_asked, judged_every
from .known_errors import Wanted
from .legs import Settings
from .link_legs import SLACK_ALLOWED, slack_time
from .motion import Motion
from .plan import Plan
from .tolerance import keep_error_by_tolerance

RUNS_INSTEAD = 4  # of links by default, in place of an implicit method: four powers of ten of the tolerance


class Keeps(NamedTuple):
    """Which errors are to be kept: those of places and of tensions where they were asked for, else those of the default."""

    places: bool
    tensions: bool
    by_default: bool


def check_keeps_error(scheme: Scheme, dt: float | None, tolerances_given: bool, extrapolate: bool) -> None:
    """An error is kept by the step or the tolerance, of a scheme whose own steps tell it."""
    if scheme.embedded and not tolerances_given:
        return
    given = "`dt`" if dt is not None else "`rtol` or `atol`" if tolerances_given else "`extrapolate`" if extrapolate else None
    if given or not scheme.own:
        what = f"{given} is given" if given else f"the method is {scheme.name}"
        raise InputError(
            f"Arguments `error` and `tension_error` choose the step of one run with a method of this package, but {what}; "
            "leave it out, or take `audit`."
        )


def errors_kept(motion: Motion, plan: Plan, wanted: Wanted, keeps: Keeps) -> tuple[Run, Motion]:
    """Run that keeps errors, or says what it does not keep; and the motion with the settings by which it was marched."""
    choice, duration, save_every = plan.choice, motion.duration, motion.save_every
    if schemes.scheme(choice.method).embedded:
        return _by_tolerance(motion, choice, wanted)
    choice, every = judged_every(choice, save_every, duration)
    stand_in = motion

    def by_links_instead(run: Run, parts: float) -> Run | None:
        nonlocal stand_in
        found, stand_in = _by_links(motion, plan._replace(choice=choice), wanted, run, parts) or (None, motion)
        return found

    def march(choice: Choice, until: float, apart: float | None = None, undamped: bool = False) -> Run:
        saved = every if apart is None else max(apart, every or 0.0)  # what is asked for is saved by all runs but a coarser one
        settings = motion.settings._replace(rho_inf=1.0) if undamped else motion.settings
        some = motion._replace(duration=until, save_every=saved, settings=settings)
        return with_peak_judged(some.march(choice), some, choice)

    rigid = keeps.by_default and _links_may_stand_in(motion.scene)
    asked, instead = (keeps.places, keeps.tensions), by_links_instead if rigid else None
    run = keep_error(march, choice, wanted, duration, save_every or duration, instead, asked=asked)
    if rigid and run.ok and not run.kept:  # what multiplies errors leaves less of those of order 8
        run = by_links_instead(run, math.inf) or run
    if save_every is not None and every != save_every:
        run = as_asked(run, save_every)
    return run, stand_in


def _by_tolerance(motion: Motion, choice: Choice, wanted: Wanted, most: float = math.inf) -> tuple[Run, Motion]:
    """Run of adaptive steps whose tolerance keeps the errors, of ``most`` runs, and the motion with the last tolerance."""
    last = motion

    def march(tolerance: float) -> Run:
        nonlocal last
        last = motion._replace(settings=Settings(True, (0.0, tolerance), motion.settings.rho_inf))
        return with_peak_judged(last.march(choice), last, choice)

    return keep_error_by_tolerance(march, wanted, motion.scene.longest, most), last


def _links_may_stand_in(scene: Scene) -> bool:
    """Whether all cables keep their lengths, and nothing is there that links do not take."""
    taken = not any(body.is_jointed for body in scene.bodies) and shedding_cable(scene) is None
    return taken and bool(scene.cables) and all(cable.inextensible for cable in scene.cables)


def _by_links(motion: Motion, plan: Plan, wanted: Wanted, run: Run, parts: float) -> tuple[Run, Motion] | None:
    """`_by_tolerance` with links, where that keeps the errors and is cheaper than each step of ``run`` in ``parts``."""
    other = by_links(plan.choice, plan.transverse)
    iterations = run.work.newton_iterations / max(run.work.steps, 1)
    if not links_are_cheaper(replace(plan.choice, dt=run.dt), other.limit, parts, iterations):
        return None
    found, last = _by_tolerance(motion, other, wanted, RUNS_INSTEAD)
    return (found, last) if found.kept and slack_time(found) <= SLACK_ALLOWED * motion.duration else None
