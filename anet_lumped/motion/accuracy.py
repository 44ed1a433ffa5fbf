"""Keep an error: a pilot over the first part of a motion, then the whole, with shorter steps until its estimates are small enough.

A run tells its own errors (`results.error_estimate`), so that one run is enough where they are small enough. Where they are not,
the next one takes steps that its predecessor's errors ask for, a whole number of them in each of its predecessor's. Then there are
two runs to compare: what they differ by is the error of the coarser one, and what that is of the error which it told corrects what
the finer one tells. Where it is many times as much, the motion has multiplied errors: past a whip, or in chaos, no step keeps an
error, and the run says from when on. Nodes of a loose cable fly until it is taut again, and where they are then changes at once
with the step: two runs whose steps are far apart say little of how the error falls, and a third one between them is asked; so it is
of a node that one segment catches, where the error is kept by what a coarser run says of it alone. Nor is
the error of such a motion kept by the word of one run: one with four of its steps in one is beside it, and a third one where that
is off by more than is allowed. Links that go slack and are taut at a blow are off by when the blow falls, and two runs may agree
by chance: there no comparison takes anything off what a run tells. Where the method took vibrations along cables that could move
their nodes by more than is allowed (`lost_vibrations`), two of its runs agree, too: one from which it takes nothing is beside it.
All runs have the saved states of the coarser ones.

A motion that asks for far shorter steps than those it began with would take minutes or hours. What all runs cost is counted in
Newton iterations times moving nodes, which are the same on every machine. Where the next run would cost more than the budget, the
last one is returned and says so. For an error that is asked for there is a larger one, unless not even that is enough for the steps
which the error needs as it falls with the order of the method: then they are not begun.
"""

import logging
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from anet_lumped.limits import STEPS, most_of
from anet_lumped.results.lost_vibrations import lost_sway
from anet_lumped.results.rigid_blows import has_rigid_blows
from anet_lumped.results.run import Run
from integrators import schemes

from .choice import EXPLICIT_COST, IMPLICIT_COST, Choice
from .known_errors import Known, Wanted, alone, at_least, beside, compared, is_caught_and_corrected, left_of, may_multiply
from .run_warnings import ALLOWED_LOSS
from .times import SAVES
from .told_errors import ASKED, Beyond, told
from .verdict import least_steps

LOG = logging.getLogger(__name__)
PILOT = 0.125  # of the time of a run; the pilot's cost is that share of the first run's
FEWEST_STEPS = 400  # a shorter run costs so little that it is its own pilot
BESIDE = 4  # steps in one of a run beside which a motion that goes loose is judged, where no other one is
BETWEEN = 2  # the same of a third run, where that one is off by more than is allowed: it shows whether errors fall
STABLE = 0.9  # of the limit of an explicit step, at most that of such a run
AIM = 0.5  # of the error asked for, by an estimate that may be half of the truth; of tensions, where no second run corrects it, too
MOST_AT_ONCE = 8  # steps that one is replaced by
MOST_FOR_PLACES, MOST_FOR_TENSIONS = 512, 32  # steps in all that one of the first choice is replaced by; beyond, the run says so
TRUSTED_PARTS = 2  # steps in one: beyond, the error of a motion that goes loose need not have fallen as its order says
MOST_BETWEEN = 4  # steps in one of a third run beside one whose nodes are caught: it costs up to a quarter more
NEARER, NEARER_TENSION = 0.7, 0.8  # of an error of places, and of a tension: what shorter steps must leave at most, or are in vain
BUDGET = 5e7  # Newton iterations times moving nodes of all runs: some 15 s on one core, a minute in waves; or, if that is more,
BUDGET_OF_FIRST = 8.0  # times those of a run with the steps of the first choice


class Budget:
    """What all runs together may cost, in Newton iterations times moving nodes; see `cost`."""

    def __init__(self) -> None:
        self.most, self.spent = math.inf, 0.0

    def spend(self, run: Run, of_first: float, share: float = 1.0) -> Run:
        """Count a run over a ``share`` of the whole time, whose steps are ``of_first`` of those of the first choice; return it."""
        self.spent += cost(run)
        if self.most == math.inf:
            self.most = max(BUDGET, BUDGET_OF_FIRST * of_first * cost(run) / share)
        return run

    def parts(self, run: Run, wished: int, needed: float, share: float = 1.0, asked: bool = False) -> int:
        """Number of steps, ``wished`` at most and 1 at least, in which each step of such a run may be taken in another run.

        For an error that is ``asked`` for they may cost `ASKED` times as much, if that is enough for the number ``needed``.
        """
        left, more = ((self.most * times - self.spent) * share / max(cost(run), 1.0) for times in (1.0, ASKED))
        return max(min(wished, math.floor(min(more if asked and needed <= more else left, 1e9))), 1)


def cost(run: Run) -> float:
    """Newton iterations of a run times its moving nodes; a step of an explicit method counts as much less as it costs less."""
    work = run.work.newton_iterations or run.work.steps * EXPLICIT_COST / IMPLICIT_COST
    return float(work * run.model.n_free)


def keep_error(
    march: Callable[..., Run],
    choice: Choice,
    wanted: Wanted,
    duration: float,
    span: float,
    instead: Callable[[Run, float], Run | None] | None = None,
    asked: tuple[bool, bool] = (False, False),
) -> Run:
    """March with steps short enough for the errors that are wanted.

    Parameters
    ----------
    march : callable(choice, duration) -> Run, from the start of the motion; with a time between saved states, if that is given, and
        without what the method takes, if it is told so by ``undamped``
    choice : Choice
        Method and first step.
    wanted : Wanted
    duration : float [s]
    span : float [s], between saved states, or the duration: it holds a whole number of steps
    instead : callable(run, parts) -> Run or None
        Asked before steps are taken in ``parts``, of which a run over some time says that they are needed: a run by another method,
        if that is cheaper and keeps the error.
    asked : tuple of bool
        Whether the error of places was asked for, and that of the largest tension. No run is begun with which all runs would cost
        more than `BUDGET` and `BUDGET_OF_FIRST` times the first choice; or `ASKED` times that, for an error that was asked for.

    Returns
    -------
    Run
        The last one; `Run.reason` says what was kept. If it is not "done", nothing more was tried.
    """
    least = least_steps(schemes.scheme(choice.method))
    if duration < least * choice.dt:  # in fewer steps no error is seen
        choice = _finer(choice, math.ceil(least * choice.dt / duration * (1.0 - 1e-12)), span)
    first, budget = choice.dt, Budget()

    def affordable(run: Run, wishes: tuple[int, int], known: Known, share: float) -> int:
        needs = _needed(run, wanted, known, share)
        return max(budget.parts(run, wish, needed, share, one) for wish, needed, one in zip(wishes, needs, asked, strict=True))

    def march_undamped(run: Run, other: Choice) -> Run:
        return budget.spend(march(other, duration, _beyond(run, other), undamped=True), other.dt / first)

    if duration > FEWEST_STEPS * first:
        pilot = march(choice, span * max(1.0, math.floor(PILOT * duration / span)) if span < duration else PILOT * duration)
        if pilot.ok:
            share = (pilot.t[-1] - pilot.t[0]) / duration
            known = alone(pilot)
            other = instead(pilot, _needed(pilot, wanted, known, share)[0]) if instead is not None else None
            if other is not None:
                return other
            budget.spend(pilot, 1.0, share)
            choice = _finer(choice, affordable(pilot, _parts(pilot, wanted, known, share), known, share), span)
    run, in_vain, as_far_before = budget.spend(march(choice, duration), choice.dt / first), (False, False), False
    known, undamped_beside, lacked_vibrations = alone(run), False, False
    while run.ok:
        most = int(most_of(STEPS) * choice.dt / duration)
        for_places, for_tensions = _parts(run, wanted, known, 1.0, choice.dt / first, in_vain)
        wishes = min(for_places, most), min(for_tensions, most)
        if max(wishes) < 2:
            if not undamped_beside and lost_sway(run) > max(known.error, wanted.of_places(run)):
                before, known, undamped_beside = known, _without_loss(run, choice, known, wanted, march_undamped), True
                lacked_vibrations = known.error > before.error
                in_vain = in_vain[0] and not lacked_vibrations, in_vain[1]  # the error had not been seen
                continue
            longer = _longer(choice, duration, least)
            if longer is None or known.apart < math.inf or not may_multiply(run):
                break
            coarser = budget.spend(march(longer, duration, _beyond(run, longer)), longer.dt / first)
            if not coarser.ok or coarser.error is None:
                break
            known = beside(run, coarser, known, wanted)
            nearer = replace(choice, dt=choice.dt * BETWEEN)
            if known.apart > wanted.of_places(run) >= known.error and nearer.dt < longer.dt:
                coarser = budget.spend(march(nearer, duration, _beyond(run, nearer)), nearer.dt / first)
                known = beside(run, coarser, known, wanted) if coarser.ok and coarser.error is not None else known
            continue
        needs = _needed(run, wanted, known, 1.0)
        other = instead(run, needs[0]) if instead is not None and known.apart == math.inf else None
        if other is not None:
            return other
        parts = affordable(run, wishes, known, 1.0)
        if parts < 2:
            first_unkept = 0 if known.error > wanted.of_places(run) else 1
            one = asked[first_unkept]
            next_parts = math.ceil(needs[first_unkept]) if one else max(wishes)
            return told(run, known, wanted, beyond=Beyond(next_parts, budget.most * (ASKED if one else 1.0), one))
        coarser, before, before_choice, choice = run, known, choice, _finer(choice, parts, span)
        took = parts * run.wall_time
        LOG.info("with dt=%.3g s places are known to %.2g m, the largest tension to %.2g", run.dt, known.error, known.tension_error)
        LOG.info("again with dt=%.3g s, which takes about %.2g s", choice.dt, took)
        run = budget.spend(march(choice, duration, _within(coarser, choice, duration)), choice.dt / first)
        if not run.ok:
            return run
        whips = may_multiply(run)  # then a coarser run that tells less knows less
        tells_more = (run.error_estimate or 0.0) > 2.0 * (coarser.error_estimate or 0.0)
        if tells_more and run.tension_error > before.tension_error and not whips:
            return told(coarser, before, wanted, too_short=run.dt)
        known = compared(run, coarser, wanted, 0.0 if lacked_vibrations else before.apart)
        undamped_beside = lacked_vibrations = False
        seems_kept = known.error <= wanted.of_places(run)
        if parts > TRUSTED_PARTS and seems_kept and (whips or is_caught_and_corrected(run, known, wanted)):
            in_parts = (parts + 1) // 2 if whips else max((parts + 1) // MOST_BETWEEN, 2)
            third = _finer(before_choice, in_parts, span)
            between = budget.spend(march(third, duration, _within(coarser, third, duration)), 1.0)
            if between.ok:
                known = at_least(left_of(run, between), known, run)
        # where the method takes much, shorter steps bring the motion nearer, however little the last ones did; but for blows
        loses = run.energy_balance.lost_to_method > ALLOWED_LOSS * run.energy_balance.in_play and not has_rigid_blows(run)
        as_far = known.tension_error > NEARER_TENSION * before.tension_error
        out_of_reach = _parts_as_it_falls(known, before, parts, wanted.of_places(run)) > MOST_FOR_PLACES * choice.dt / first
        in_vain = (
            (known.error > NEARER * before.error or out_of_reach) and not loses,
            as_far and as_far_before,
        )  # peaks come nearer by fits and starts
        as_far_before = as_far
    return told(run, known, wanted) if run.ok else run


def _finer(choice: Choice, parts: int, span: float) -> Choice:
    """The choice with every step in parts."""
    return replace(choice, dt=span / (parts * round(span / choice.dt))) if parts > 1 else choice


def _longer(choice: Choice, duration: float, least: int) -> Choice | None:
    """The choice with `BESIDE` steps in one or half of these, stable and at ``least`` so many in all; None without such."""
    for together in (BESIDE, BESIDE // 2):
        if together * choice.dt <= min(STABLE * choice.limit, duration / least):
            return replace(choice, dt=together * choice.dt)
    return None


def _within(run: Run, choice: Choice, duration: float) -> float:
    """Time between saved states of another run with shorter steps, a part of that of ``run``: it has all states of that [s].

    Runs that each save some `SAVES` states in their own rhythm may have two in common, at which they agree by chance.
    """
    steps, wished = round(_apart(run) / choice.dt), max(duration / choice.dt / SAVES, 1.0)
    strides = (n for n in range(1, steps + 1) if steps % n == 0)
    return min(strides, key=lambda n: abs(math.log(n / wished)), default=1) * choice.dt


def _beyond(run: Run, longer: Choice) -> float:
    """Time between saved states of a run with ``longer`` steps, all of which ``run`` has but the last [s]."""
    return math.lcm(round(_apart(run) / run.dt), round(longer.dt / run.dt)) * run.dt


def _apart(run: Run) -> float:
    """Time between saved states of a run [s]: those of events come besides."""
    return float(np.median(np.diff(run.t)))


def _without_loss(run: Run, choice: Choice, known: Known, wanted: Wanted, march: Callable[[Run, Choice], Run]) -> Known:
    """What is known of a run beside one from which the method takes nothing, with longer steps if those are enough."""
    for together in (BETWEEN, 1):
        undamped = march(run, replace(choice, dt=together * choice.dt))
        if not undamped.ok or undamped.error is None:
            continue
        seen = compared(run, undamped, wanted, 0.0)
        if seen.apart <= wanted.of_places(run):
            return known
        if together == 1:
            of_damper = at_least(seen.apart, seen, run)  # with the same steps, what they differ by is what the damper did
            return of_damper._replace(tension_error=known.tension_error, apart=known.apart)
    return at_least(lost_sway(run), known, run)


def _parts(
    run: Run, wanted: Wanted, known: Known, share: float, of_first: float = 1.0, in_vain: tuple[bool, bool] = (False, False)
) -> tuple[int, int]:
    """Numbers of steps that each step of a run should be replaced by, for its places and for its largest tension.

    As what is ``known`` of its errors over a ``share`` of the whole time asks for; its steps are ``of_first`` of those that were
    chosen first, and shorter ones were ``in_vain`` for places, or for tensions.
    """
    for_places = for_tensions = 1
    needed, most = _needed(run, wanted, known, share), (MOST_FOR_PLACES * of_first, MOST_FOR_TENSIONS * of_first)
    if known.error / share > wanted.of_places(run) and not in_vain[0]:
        for_places = min(math.ceil(needed[0]), int(most[0]), MOST_AT_ONCE)
    tensions_aimed_at = (AIM if known.apart == math.inf else 1.0) * wanted.tension_error
    if known.tension_error > tensions_aimed_at and not in_vain[1] and not has_rigid_blows(run):
        for_tensions = min(math.ceil(needed[1]), int(most[1]), MOST_AT_ONCE)
    return max(for_places, 1), max(for_tensions, 1)


def _needed(run: Run, wanted: Wanted, known: Known, share: float) -> tuple[float, float]:
    """Numbers of steps that each step of a run should be replaced by, however many, for its places and for its largest tension.

    As errors fall with the order of the method; see `_parts`.
    """
    scheme = schemes.scheme(run.method)
    order = scheme.error_order or scheme.order or 1
    places, tensions = known.error / share / wanted.of_places(run), known.tension_error / wanted.tension_error
    return (places / AIM) ** (1.0 / order), (tensions / AIM) ** 0.5


def _parts_as_it_falls(known: Known, before: Known, parts: int, allowed: float) -> float:
    """Number of steps that each step should be replaced by for an error of places to fall to what is ``allowed`` [m].

    It goes on falling as it did when each step was replaced by ``parts``: past a catch or a whip, slower than the method's order
    says. Infinite where it did not fall.
    """
    if known.error <= allowed:
        return 1.0
    if known.error >= before.error:
        return math.inf
    order_seen = math.log(before.error / known.error) / math.log(parts)
    return math.exp(min(math.log(known.error / allowed) / order_seen, 700.0))
