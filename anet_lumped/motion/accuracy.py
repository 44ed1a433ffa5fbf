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
by chance: there no comparison takes anything off what a run tells. All runs have the saved states of the coarser ones.

A motion that asks for far shorter steps than those it began with would take minutes or hours. What all runs cost is counted in
Newton iterations times moving nodes, which are the same on every machine. Where the next run would cost more than the budget, the
last one is returned and says so. For an error that is asked for there is a larger one, unless not even that is enough for the steps
which the error needs as it falls with the order of the method: then they are not begun.
"""

import logging
import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from anet_lumped.limits import STEPS, most_of
from anet_lumped.results.amplification import is_hardly_seen
from anet_lumped.results.buckling import first_buckled
from anet_lumped.results.distances import distances
from anet_lumped.results.free_flight import goes_loose, loose
from anet_lumped.results.run import Run
from integrators import schemes

from .choice import EXPLICIT_COST, IMPLICIT_COST, Choice
from .first_step import thrown
from .run_warnings import ALLOWED_LOSS
from .times import SAVES
from .verdict import least_steps

LOG = logging.getLogger(__name__)
ERROR_OF_LENGTH = 1e-3  # of the longest cable, and
ERROR_OF_MOTION = 0.05  # of the largest way that a node goes: errors of places that the default keeps
SMALLEST_ERROR = 1e-6  # of the longest cable: a motion that is smaller than its error is at rest
TENSION_ERROR = 0.02  # of the largest tension: what the default keeps
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
AMPLIFIED = 4.0  # times the error that a run tells of itself: from there on the motion has multiplied it
NEARER, NEARER_TENSION = 0.7, 0.8  # of an error of places, and of a tension: what shorter steps must leave at most, or are in vain
LEAST_OF_TOLD = 0.05  # of the error that a run tells of itself, which is left of it by a comparison
BUDGET = 5e7  # Newton iterations times moving nodes of all runs: some 15 s on one core, a minute in waves; or, if that is more,
BUDGET_OF_FIRST = 8.0  # times those of a run with the steps of the first choice
ASKED = 10.0  # times that budget, for an error that is asked for


class Wanted(NamedTuple):
    """Errors to keep.

    Parameters
    ----------
    error : float or None [m], of places; None for the default's, see the module
    tension_error : float, of the largest tension, over it
    """

    error: float | None
    tension_error: float

    def of_places(self, run: Run) -> float:
        """Error of places to keep in a run [m]."""
        if self.error is not None:
            return self.error
        length = run.scene.longest
        way = float(np.abs(run.q - run.q[0]).max())
        return max(min(ERROR_OF_LENGTH * length, ERROR_OF_MOTION * way), SMALLEST_ERROR * length)


class Known(NamedTuple):
    """What is known of the errors of a run.

    Parameters
    ----------
    error : float [m], of places
    tension_error : float, of the largest tension, over it
    of_told : float, the error of places over that which the run tells of itself: more than one where the motion multiplies errors
    since : float [s], from when on they are multiplied; infinite if they are not
    apart : float [m], what its places and those of a coarser run differ by; infinite without one
    """

    error: float
    tension_error: float
    of_told: float = 1.0
    since: float = math.inf
    apart: float = math.inf


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


class Beyond(NamedTuple):
    """Steps that the budget does not allow: the ``parts`` in which they take those of the last run, and the ``budget``.

    ``asked`` tells whether the error that is not kept was asked for.
    """

    parts: int
    budget: float
    asked: bool


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
    march : callable(choice, duration) -> Run, from the start of the motion; with a time between saved states, if that is given
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

    if duration > FEWEST_STEPS * first:
        pilot = march(choice, span * max(1.0, math.floor(PILOT * duration / span)) if span < duration else PILOT * duration)
        if pilot.ok:
            share = (pilot.t[-1] - pilot.t[0]) / duration
            known = _alone(pilot)
            other = instead(pilot, _needed(pilot, wanted, known, share)[0]) if instead is not None else None
            if other is not None:
                return other
            budget.spend(pilot, 1.0, share)
            choice = _finer(choice, affordable(pilot, _parts(pilot, wanted, known, share), known, share), span)
    run, in_vain, as_far_before = budget.spend(march(choice, duration), choice.dt / first), (False, False), False
    known = _alone(run)
    while run.ok:
        most = int(most_of(STEPS) * choice.dt / duration)
        for_places, for_tensions = _parts(run, wanted, known, 1.0, choice.dt / first, in_vain)
        wishes = min(for_places, most), min(for_tensions, most)
        if max(wishes) < 2:
            longer = _longer(choice, duration, least)
            if longer is None or known.apart < math.inf or not _may_multiply(run):
                break
            coarser = budget.spend(march(longer, duration, _beyond(run, longer)), longer.dt / first)
            if not coarser.ok or coarser.error is None:
                break
            known = _beside(run, coarser, known, wanted)
            nearer = replace(choice, dt=choice.dt * BETWEEN)
            if known.apart > wanted.of_places(run) and nearer.dt < longer.dt and _kept(run, known, wanted):
                coarser = budget.spend(march(nearer, duration, _beyond(run, nearer)), nearer.dt / first)
                known = _beside(run, coarser, known, wanted) if coarser.ok and coarser.error is not None else known
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
        whips = _may_multiply(run)  # then a coarser run that tells less knows less
        tells_more = (run.error_estimate or 0.0) > 2.0 * (coarser.error_estimate or 0.0)
        if tells_more and run.tension_error > before.tension_error and not whips:
            return told(coarser, before, wanted, too_short=run.dt)
        known = _compared(run, coarser, wanted, before.apart)
        if parts > TRUSTED_PARTS and _kept(run, known, wanted) and (whips or _is_caught_and_corrected(run, known, wanted)):
            in_parts = (parts + 1) // 2 if whips else max((parts + 1) // MOST_BETWEEN, 2)
            third = _finer(before_choice, in_parts, span)
            between = budget.spend(march(third, duration, _within(coarser, third, duration)), 1.0)
            if between.ok:
                known = known._replace(error=max(known.error, _left_of(run, between)))
        # where the method takes much, shorter steps bring the motion nearer, however little the last ones did
        loses = run.energy_balance.lost_to_method > ALLOWED_LOSS * run.energy_balance.in_play
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


def _is_caught_and_corrected(run: Run, known: Known, wanted: Wanted) -> bool:
    """Whether a run keeps an error of places that it tells to be larger, or that grows, as a coarser one says, and nodes fly in it.

    When a node is caught, a coarse step moves the time of that by much of itself: what the coarse run told may be many times too
    large, or its places near to those of the finer one by chance.
    """
    tells_more = (run.error_estimate or 0.0) > wanted.of_places(run)
    return (tells_more or known.of_told > AMPLIFIED) and run.segment_tension.min(initial=1.0) <= 0.0 and bool(loose(run).any())


def _may_multiply(run: Run) -> bool:
    """Whether a motion goes loose or buckles, or may do so unseen, so that the errors which a run tells may be multiplied.

    A body whose cables go slack tumbles until they catch it.
    """
    known = goes_loose(run) or first_buckled(run) is not None or (run.model.has_bodies and _goes_slack(run))
    return known or is_hardly_seen(run)


def _goes_slack(run: Run) -> bool:
    """Whether a segment holds nothing at a saved time after the start."""
    return bool((run.segment_tension[1:] <= 0.0).any())


def _collides(run: Run) -> bool:
    """Whether cables that do not stretch go slack: they are taut again at a blow, whose time no step resolves."""
    return any(cable.inextensible for cable in run.scene.cables) and _goes_slack(run)


def _beside(run: Run, coarser: Run, known: Known, wanted: Wanted) -> Known:
    """What is known of the errors of a run beside a coarser one, no less than the run tells by itself."""
    seen = _compared(run, coarser, wanted, known.apart if known.apart < math.inf else 0.0)
    more = max(seen.tension_error, known.tension_error)
    if seen.error <= known.error:
        return known._replace(apart=seen.apart, tension_error=more)
    return seen._replace(tension_error=more)


def _alone(run: Run) -> Known:
    """Errors of a run as it tells them by itself; where its first step throws nodes off, all of their way may be wrong."""
    error = run.error_estimate or 0.0
    if thrown(run) is not None:
        error = max(error, float(np.abs(run.q - run.q[0]).max()))
    return Known(error, run.tension_error)


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
    if known.tension_error > (AIM if known.apart == math.inf else 1.0) * wanted.tension_error and not in_vain[1]:
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


def _compared(run: Run, coarser: Run, wanted: Wanted, apart_before: float) -> Known:
    """Errors of a run, as it tells them and as a coarser one before it shows them.

    Where two runs are hardly nearer to each other than the two before them, which were ``apart_before`` [m], nothing says that the
    next will be: what a run differs by from its predecessor is then its error, else what is left of a geometric series. The error
    of the largest tension is what the run tells, times what the largest tensions differ by over what the coarser run told, if that
    is more: two runs from which the method took the same vibration agree.
    """
    own, theirs, by_node = distances(run, coarser)
    apart = np.maximum.accumulate(by_node.max(axis=1))
    told, last = np.maximum(coarser.error[theirs], 1e-300), float(apart[-1])
    ratio = min(last / apart_before, 0.5) if apart_before > 0.0 else 0.0
    own_told = max(run.error_estimate or 0.0, 1e-300)
    least = 1.0 if _collides(run) else LEAST_OF_TOLD
    error = max(own_told * max(last / float(told[-1]), least), last * ratio / (1.0 - ratio))
    of_told = error / own_told
    beyond = apart > np.maximum(AMPLIFIED * told, wanted.of_places(run))
    since = float(run.t[own][np.argmax(beyond)]) if of_told > AMPLIFIED and beyond.any() else math.inf
    peak, peak_of_coarser = run.peak_tension(), coarser.peak_tension()
    changed = abs(peak - peak_of_coarser) / max(peak, peak_of_coarser, 1e-300)
    tension_error = run.tension_error * max(changed / max(coarser.tension_error, 1e-300), 1.0)
    return Known(error, min(tension_error, 1.0), of_told, since, last)


def _left_of(run: Run, coarser: Run) -> float:
    """Error of a run that falls with the order of its method from that of a coarser one [m]."""
    scheme = schemes.scheme(run.method)
    order = scheme.error_order or scheme.order or 1
    return float(distances(run, coarser).apart.max()) / ((coarser.dt / run.dt) ** order - 1.0)


def _kept(run: Run, known: Known, wanted: Wanted) -> bool:
    return known.error <= wanted.of_places(run) and known.tension_error <= wanted.tension_error


def _or_are_saved(run: Run) -> str:
    """What hides jumps of a tension besides the steps: saved states that are farther apart than those."""
    farther = float(np.diff(run.t).max(initial=0.0)) > 1.5 * run.dt
    return ", or its peak is between saved states, of which a smaller save_every has more" if farther else ""


def told(
    run: Run, known: Known, wanted: Wanted, how: str = "", too_short: float | None = None, beyond: Beyond | None = None
) -> Run:
    """The run with what was kept in its reason, and what was not in its warnings.

    ``how`` says with which step or tolerance. Steps of ``too_short`` [s] have told larger errors than those of the run. What it
    does not keep may take steps ``beyond`` the budget.
    """
    how = how or f"dt={run.dt:.3g} s"
    allowed = wanted.of_places(run)
    if run.error is not None:
        run = replace(run, error_factor=run.error_factor * known.of_told)
    reason = (
        f"{run.reason}; {how} keeps places to {allowed:.2g} m (estimated {known.error:.2g} m) "
        f"and peak tensions to {wanted.tension_error:.2g} (estimated {known.tension_error:.2g})"
    )
    if _kept(run, known, wanted):
        return replace(run, reason=reason, kept=True)
    found = []
    if known.error > allowed:
        until = float(run.t[np.argmax(run.error > allowed)])
        why = f", because the motion multiplies errors {known.of_told:.2g} times from t={known.since:.4g} s on"
        found.append(
            f"places are known to {allowed:.2g} m until t={until:.4g} s, to {known.error:.2g} m at the end"
            f"{why if known.since < math.inf else ''}"
        )
    if known.tension_error > wanted.tension_error:
        found.append(
            f"the largest tension is known to {known.tension_error:.1%} where {wanted.tension_error:.1%} are wanted: "
            f"it jumps faster than the steps resolve{_or_are_saved(run)}"
        )
    if too_short is not None:
        found.append(f"dt={too_short:.3g} s was tried too, and told larger errors, of rounding or of vibrations that it shows")
    if beyond is not None:
        wish = f"error={allowed:.2g}" if known.error > allowed else f"tension_error={wanted.tension_error:.2g}"
        more = "" if beyond.asked else f"{wish} has {ASKED:g} times that, and "
        found.append(
            f"shorter steps may keep it, beyond the budget of {beyond.budget:.2g} Newton iterations times nodes; {more}"
            f"dt={run.dt / beyond.parts:.2g} s is next, which takes about {beyond.parts} times this run's time"
        )
    said = "; ".join(found)
    text = f"{run.method} with {how}: {said}."
    return replace(run, reason=f"{run.reason}; with {how} {said}", warnings=(*run.warnings, text), kept=False)
