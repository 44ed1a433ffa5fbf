"""Warnings attached to a completed run: energy lost or added by its steps, or given by forces that these do not resolve, cables too
long for their tension, no limit in sight, points that nothing has moved, wind under water, obstacles that were not seen, errors
that may have been multiplied, starts and steps not resolved, largest tensions between saved states.

A run with a warning is done all the same: a method that damps the motion is asked for by name, and a rest may be right that
was reached by wrong damping. But a reader of its swing or its stretch must know. On the catalogue of hard cases
(`studies.catalogue`) every run that breaks a statement, and that has not gained energy, has a warning.
"""

import math
from enum import Enum

import numpy as np

from anet_lumped.checks import quoted
from anet_lumped.effects import REGISTRY
from anet_lumped.results.amplification import is_hardly_seen
from anet_lumped.results.auditing import SHARE
from anet_lumped.results.buckling import first_buckled
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.results.free_flight import MULTIPLIED, first_loose, times_at_most
from anet_lumped.results.lost_vibrations import said_sway
from anet_lumped.results.peaks import hidden_peak
from anet_lumped.results.rigid_blows import has_rigid_blows
from anet_lumped.results.tension_error import lowest_axial_mode
from anet_lumped.scene.platform import driven_from_outside
from anet_lumped.scene.scene import Driven
from integrators import schemes

from .energy_gain import ALLOWED_GAIN, rounding
from .first_step import thrown, unresolved_start
from .unresolved_forces import unresolved_force

EXCESS_STRETCH = 0.1  # by which a cable may be stretched more than its tension stretches it, over the latter
SHARE_OF_PATH = 0.05  # of the path of a node: error of the finer of two runs up to which they are extrapolated
STILL = 1e-6  # of its cables' length, by which a net may move that counts as still
ALLOWED_LOSS = 0.01  # of the energy in play, which a method may take without a warning
TOLERANCE = 1e-7  # of its length: what Newton's tolerance leaves
MOST_HIDDEN = 0.1  # of the largest tension, by which saved states may show less without a warning
MANY_PARTS = 4.0  # in which each step is taken on average: a start that is hard to solve takes some steps in two


class Finding(Enum):
    """What a warning is about."""

    UNACCOUNTED_ENERGY = "energy that work and dissipation do not account for"
    TAKEN_BY_METHOD = "energy that the method took"
    GIVEN_BY_FORCE = "energy that a force gave which steps do not resolve"
    EXCESS_LENGTH = "a cable longer than its tension can hold it"
    FAR_FROM_LIMIT = "two extrapolated runs that are far apart"
    WIND_UNDER_WATER = "air whose wind blows on what is under water"
    STOOD_STILL = "points that are driven from outside, which nothing has moved"
    THROUGH_AN_OBSTACLE = "cables that may have gone through an obstacle"
    MULTIPLIED_ERRORS = "errors that the motion may have multiplied"
    LOST_VIBRATIONS = "vibrations which the method took, that could move nodes"
    THROWN_AT_START = "a start that the first step does not resolve"
    HIDDEN_PEAK = "a largest tension that passes between saved states"
    TAKEN_IN_PARTS = "steps whose equations were solved in many parts only"
    RIGID_BLOWS = "blows of cables that do not stretch"


def findings(run, adaptive=False):
    """What is found of a completed run, and the sentence that says how much of it there is and what to try.

    Parameters
    ----------
    run : Run, done
    adaptive : bool, whether its steps were chosen by a tolerance

    Returns
    -------
    dict of Finding to str
    """
    step = "a smaller tolerance" if adaptive else f"a smaller step than dt={run.dt:.3g} s"
    texts = (
        (Finding.UNACCOUNTED_ENERGY, _unaccounted_energy(run, step)),
        (Finding.TAKEN_BY_METHOD, _taken_by_method(run, step, adaptive)),
        (Finding.GIVEN_BY_FORCE, _given_by_force(run, step)),
        (Finding.EXCESS_LENGTH, _excess_length(run, step)),
        (Finding.FAR_FROM_LIMIT, _far_from_limit(run, step)),
        (Finding.WIND_UNDER_WATER, _wind_under_water(run)),
        (Finding.STOOD_STILL, _stood_still(run)),
        (Finding.THROUGH_AN_OBSTACLE, _through_an_obstacle(run, step)),
        (Finding.MULTIPLIED_ERRORS, _multiplied_errors(run)),
        (Finding.LOST_VIBRATIONS, _lost_vibrations(run, step)),
        (Finding.THROWN_AT_START, "" if adaptive or run.kept else _thrown_at_start(run, step)),
        (Finding.HIDDEN_PEAK, _hidden_peak(run)),
        (Finding.TAKEN_IN_PARTS, "" if adaptive or run.extrapolated else _taken_in_parts(run)),
        (Finding.RIGID_BLOWS, _rigid_blows(run)),
    )
    found = {finding: text for finding, text in texts if text}
    if found.keys() & {Finding.TAKEN_BY_METHOD, Finding.MULTIPLIED_ERRORS}:  # which say as much
        found.pop(Finding.LOST_VIBRATIONS, None)
    if Finding.RIGID_BLOWS in found:  # which says as much
        for less in (Finding.TAKEN_BY_METHOD, Finding.HIDDEN_PEAK):
            found.pop(less, None)
    return found


def warnings_of(run, adaptive=False):
    """Warnings of a completed run, a tuple of sentences; see `findings`."""
    return tuple(findings(run, adaptive).values())


def _unaccounted_energy(run, step):
    """Changes of energy beyond work and dissipation, if they are more than `ALLOWED_GAIN` of the energy in play."""
    off, balance = error_of_steps(run), run.energy_balance
    if off <= ALLOWED_GAIN or off * balance.in_play <= ALLOWED_GAIN * rounding(run):
        return ""
    lost = (balance.by_method or 0.0) - balance.unaccounted > 0.0
    if any(isinstance(point, Driven) for point in run.scene.all_points):
        what = "are not accounted for by dampers, drag and the work of driven points"
    elif lost:
        what = "were lost in its steps, to neither dampers nor drag: the motion is damped too much"
    else:
        what = "were dissipated beyond what was there: its steps put that in, or its dampers took less than their rates say"
    other = "" if run.method == "edmc" else ', or method="edmc"'
    return f"{run.method}: {off:.2g} of the energy in play {what}; take {step}{other}."


def _taken_by_method(run, step, adaptive):
    """Energy that the steps themselves took, if it is more than `ALLOWED_LOSS` of the energy in play and not said already."""
    balance = run.energy_balance
    if error_of_steps(run) > ALLOWED_GAIN or balance.lost_to_method <= ALLOWED_LOSS * balance.in_play:
        return ""
    if balance.lost_to_method <= ALLOWED_LOSS * rounding(run):
        return ""
    other = "rho_inf=1" if run.method == "edmc" else 'method="edmc"'
    if not adaptive:
        step = f"dt={_halving_step(run):.2g} s for half of that"
    return (
        f"{run.method}: its steps took {balance.lost_to_method:.3g} J, {balance.lost_to_method / balance.in_play:.1%} of the "
        f"energy in play, which no damper and no effect took; take {step}, or {other}."
    )


def _given_by_force(run, step):
    """Energy that effects gave, more than `ALLOWED_GAIN` of the energy in play, where a force changes too fast for the steps."""
    balance = run.energy_balance
    given = -(balance.by_effects or 0.0)
    if given <= ALLOWED_GAIN * (balance.in_play + rounding(run)):
        return ""
    name = unresolved_force(run)
    return name and (
        f"{run.method}: the motion gained {given:.3g} J from effects, {given / balance.in_play:.1%} of the energy in play, and the "
        f"force of {name} changes faster than the steps resolve, which may have put that in; take {step}, or write its energy in "
        "place of its force, which no step of edmc raises."
    )


def _through_an_obstacle(run, step):
    """Steps, or segments, that are longer than half the smallest width of an obstacle: what meets it are nodes at ends of steps."""
    narrowest = min((effect.narrowest for effect in run.scene.effects), default=np.inf)
    if not np.isfinite(narrowest):
        return ""
    way = run.dt * float(np.linalg.norm(run.v, axis=2).max())
    if way > narrowest:
        return (
            f"A node went {way:.2g} m in a step, and half of the smallest width of an obstacle is {narrowest:.2g} m, so that it "
            f"may have gone through; take {step}."
        )
    for cable in run.scene.cables:
        longest = float(np.linalg.norm(np.diff(run.shape(cable.name), axis=1), axis=2).max())
        if longest > 2.0 * narrowest:
            return (
                f"A segment of cable {quoted(cable.name)} was stretched to {longest:.2g} m, more than the smallest width of an "
                f"obstacle, {2.0 * narrowest:.2g} m, so that it may have gone through; take more segments."
            )
    return ""


def _multiplied_errors(run):
    """Errors of a motion that may multiply them, beyond `SHARE` of the longest cable, which no second run has shown.

    By what steps have left out: all that a run tells of its errors takes a tenth of the time of a short one.
    """
    if run.was_compared or run.error_growth is None:
        return ""
    if run.segment_tension.min(initial=1.0) > 0.0 and not is_hardly_seen(run):
        return ""  # what stays taut neither goes loose nor buckles
    times, allowed = times_at_most(run), SHARE * run.scene.longest
    if times * run.error_growth[-1] <= allowed or float(np.abs(run.q - run.q[0]).max()) <= allowed:
        return ""
    begins = {"nodes of cables are loose": first_loose(run), "cables that push buckle": first_buckled(run)}
    what, since = min(begins.items(), key=lambda one: math.inf if one[1] is None else one[1])
    if since is None and not is_hardly_seen(run):
        return ""
    told = times == MULTIPLIED and run.multiplies > 1.0
    most = f"up to {run.multiplies:.2g} times what run.error_estimate tells" if told else "as large as the way of a node"
    if since is None:
        return (
            f"{run.method}: tensions swing faster than saved states show, and such a motion may multiply errors: those of places "
            f"may be {most}; a smaller save_every shows it, and audit=True, or error=... without dt, compares two runs."
        )
    return (
        f"{run.method}: {what} from t={since:.4g} s on, and such a motion may multiply errors: those of places "
        f"may be {most}; audit=True, or error=... without dt, compares two runs."
    )


def _lost_vibrations(run, step):
    """Vibrations along cables that the method took, where they could move nodes across them."""
    sway = 0.0 if run.was_compared else said_sway(run)
    if sway == 0.0:
        return ""
    return (
        f"{run.method}: its steps took vibrations along cables, {run.energy_balance.by_method:.2g} J, with which nodes could swing "
        f"by {sway:.2g} m across them; run.error_estimate does not tell that. Take {step}, or rho_inf=1, and compare."
    )


def _thrown_at_start(run, step):
    """Nodes that a first step has thrown which does not resolve the forces at the start."""
    own = schemes.scheme(run.method).own
    speed, left_with = (thrown(run), unresolved_start(run)) if own else (None, None)
    if speed is None and left_with is None:
        return ""
    if speed is None:
        return (
            f"{run.method}: its first step gives a node {left_with:.2g} m/s, most of what is seen in the run, and does not "
            "resolve the forces at the start: that velocity is known to some per cent only, and so is the way of a node that flies "
            f"with it, which run.error_estimate does not tell; take {step}."
        )
    return (
        f"{run.method}: its first step throws a node off with {speed:.2g} m/s, most of what is seen in the run, and does not "
        f'resolve the forces at the start; places may be wrong by the way of such a node. Take {step}, or method="edmc".'
    )


def _hidden_peak(run):
    """A largest tension that saved states do not come near to: curves of them would not show it."""
    hidden = hidden_peak(run)
    if hidden is None or hidden.shown >= (1.0 - MOST_HIDDEN) * hidden.tension:
        return ""
    before, after = run.t[max(hidden.row - 1, 0)], run.t[hidden.row]
    return (
        f"The largest tension is {hidden.tension:.4g} N in cable {quoted(run.scene.cables[hidden.cable].name)} between "
        f"t={before:.4g} s and t={after:.4g} s (run.peak_tension()), but {hidden.shown:.4g} N in the states that are saved; "
        "a smaller save_every shows it."
    )


def _taken_in_parts(run):
    """Steps that were taken in `MANY_PARTS` and more each on average, because their equations were not solved in fewer."""
    work, duration = run.work, float(run.t[-1] - run.t[0])
    planned = max(1, round(duration / run.dt))
    if not work.halvings or work.steps < MANY_PARTS * planned:
        return ""
    return (
        f"{run.method}: steps of dt={run.dt:.3g} s were solved in parts only, {work.steps} in place of {planned}, and "
        f"{work.halvings} times not at all: the motion changes far faster than that; take dt={duration / work.steps:.2g} s or less."
    )


def _rigid_blows(run):
    """Blows of cables that do not stretch, whose tension has no value."""
    if not has_rigid_blows(run):
        return ""
    took, in_play = run.energy_balance.by_method or 0.0, run.energy_balance.in_play
    took_words = f", which took {took:.3g} J" if took > ALLOWED_LOSS * in_play else ""
    return (
        f"{run.method}: the largest tension has no value, because cables that do not stretch were caught in blows{took_words}: it "
        "grows as steps get shorter. Give EA: a cable that catches a mass m at the speed v pulls with some v sqrt(m EA/length)."
    )


def _halving_step(run):
    """Step with which a method takes about half the energy that it took [s].

    A damping of order p takes from a motion of frequency omega a share of omega (omega h)^p of the energy in a unit of time, once
    the step resolves it, omega h/2 < 1. That of `edmc` is axial, with p = 3, so that it is the lowest axial mode of a cable which
    has to be resolved; the other schemes damp all motion.
    """
    scheme, dt = schemes.scheme(run.method), run.dt
    order = 3 if run.method == "edmc" else scheme.order or 1
    if run.method == "edmc":
        slowest = min((lowest_axial_mode(run.scene, c).omega for c in run.scene.cables if not c.inextensible), default=0.0)
        dt = min(dt, 2.0 / slowest) if slowest > 0.0 else dt
    return dt * 0.5 ** (1.0 / order)


def _excess_length(run, step):
    """A cable that is longer than its tension can hold it.

    A damper delays a stretch and adds none: k x + c dx/dt = T keeps x below the largest T/k so far. If the largest stretch of a
    cable, summed over its taut segments, exceeds that by more than `EXCESS_STRETCH` of it, the steps have made the excess: those of
    a scheme whose reported tension is the mean over its stages, or an extrapolation, which goes straight on where the end of a
    stiff cable goes round.
    """
    if not (run.extrapolated or schemes.scheme(run.method).observes_mean_over_stages):
        return ""
    worst, found = 0.0, ""
    for cable in run.scene.cables:
        stretch = np.linalg.norm(np.diff(run.shape(cable.name), axis=1), axis=2) - cable.L0
        longer = float(np.maximum(stretch, 0.0).sum(axis=1).max())
        pulled = np.maximum(run.tension(cable.name), 0.0)
        hardest = pulled[pulled.sum(axis=1).argmax()]
        held = cable.L0 * sum(map(cable.strain, hardest.tolist()))
        excess = longer - max(held, float(np.maximum(stretch[0], 0.0).sum()))
        if excess > EXCESS_STRETCH * held + TOLERANCE * cable.length and excess / cable.length > worst:
            worst = excess / cable.length
            name, other = (
                ("edmc, extrapolated", "no extrapolation") if run.extrapolated else (run.method, 'method="edmc"')
            )  # fmt: skip
            found = (
                f"{name}: cable {quoted(cable.name)} gets {longer:.2g} m longer than it is unstretched, where its tension "
                f"stretches it by {held:.2g} m; take {step}, or {other}."
            )
    return found


def _far_from_limit(run, step):
    """Two extrapolated runs that are too far apart to tend to one limit, over the cables' length or over the path of a node."""
    if not run.extrapolated:
        return ""
    length = run.scene.longest
    moved = float(np.linalg.norm(run.q - run.q[0], axis=2).max())
    if run.error_estimate <= min(SHARE * length, SHARE_OF_PATH * moved + 1e-3 * TOLERANCE * length):
        return ""
    return (
        f"The two runs that are extrapolated are {3.0 * run.error_estimate:.2g} m apart, which is far from a limit: the result "
        f"need not be any motion; take {step}, or no extrapolation."
    )


def _wind_under_water(run):
    """Wind acts below the surface of the water where the air is not told that there is one."""
    if len(run.scene.effects) < 2:
        return ""
    acting = {REGISTRY.name_of(effect): effect for effect in run.scene.effects}
    air, water = acting.get("air"), acting.get("water")
    if air is None or water is None or air.wind is None or air.surface is not None or not (run.q[..., 2] < water.level).any():
        return ""
    return (
        f"The wind blows on what is under water, too: Air has no `surface` beside Water; surface={water.level:g} lets it end there."
    )


def _stood_still(run):
    """Points that are driven from outside stand still in a run of their own."""
    names = driven_from_outside(run.scene)
    if not names:
        return ""
    moved = float(np.linalg.norm(run.q - run.q[0], axis=2).max())
    still = moved <= STILL * run.scene.longest
    what = "Nothing moves in this run: " if still else ""
    points = f"point {quoted(names[0])} is" if len(names) == 1 else f"{len(names)} points, from {quoted(names[0])} on, are"
    return (
        f"{what}{points} driven from outside and stood still; platform(scene, motions, t_end), --move surge=1sin0.1 or a Session "
        "moves them."
    )
