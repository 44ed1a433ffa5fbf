"""Which effects a scene needs: each that it has or could have, by its dimensionless number and by a run with and without it.

What an effect changes is the largest distance between the two runs of a place, or of a tension, at any time, at one step that is
small enough for the question: it is halved until the run without any change is known to a tenth of the error. Numbers are of the
cable where they are largest, speeds and tensions are those of the run.
"""

import logging
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, number, quoted, shown
from anet_lumped.motion.choice import SHARE_OF_TIME_SCALE
from anet_lumped.motion.simulate import simulate
from anet_lumped.results.run import Run
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Free, Scene, SceneError, check_scene
from anet_lumped.statics.equilibrium import EquilibriumError

from .audited_effects import Audited, InputMissing, Scales, audited_in, scales
from .recommend import scale_of_motion, two_swings

LOG = logging.getLogger(__name__)
SAVES = 40  # times at which runs are compared
KNOWN_TO = 0.1  # of the error, the run at the step that is used
DECIDES = 3.0  # times what the motion is known to: changes of a chaotic motion differ by chance
HALVINGS = 6  # of the step, at most
REPEATS = 9  # of a timing, whose shortest counts
NEEDED, NEGLIGIBLE, STIFF, UNDECIDED, UNKNOWN = (
    "needed", "negligible", "negligible; it makes steps short", "undecided", "not judged"
)  # fmt: skip
USE_RIGID = "negligible; use EA = inf"  # of elasticity that makes steps short


@dataclass(frozen=True)
class Verdict:
    """What was found of one effect.

    Parameters
    ----------
    effect : str
    present : bool, in the scene as it was given
    numbers : dict of str and float, dimensionless
    change : float [m] or [N], that it makes in what is asked for; NaN if there is no run
    cost : float, time of the run with it over that without, less 1; NaN if there is no run
    stiffness : float, how many stable explicit steps it makes of one that the motion asks for; 0 if it has no frequency
    verdict : str, one of the capitals above
    reason : str, a sentence
    missing : str, name of the input without which it was not judged; "" if there is none
    """

    effect: str
    present: bool
    numbers: dict[str, float]
    change: float
    cost: float
    stiffness: float
    verdict: str
    reason: str
    missing: str = ""


@dataclass(frozen=True)
class EffectAudit:
    """What `audit_effects` found.

    Parameters
    ----------
    verdicts : tuple of Verdict
    of : str, whose place or tension it is about
    unit : "m" or "N"
    error : float [m] or [N], asked for
    known_to : float [m] or [N], how far the run of the scene as it was given is from one with half the step
    dt, t_end : float [s]
    left_out : tuple of str, effects that Ctrl-C left without a verdict
    """

    verdicts: tuple[Verdict, ...]
    of: str
    unit: str
    error: float
    known_to: float
    dt: float
    t_end: float
    left_out: tuple[str, ...] = ()

    def __getitem__(self, effect: str) -> Verdict:
        return {verdict.effect: verdict for verdict in self.verdicts}[effect]


def audit_effects(
    scene: Scene,
    error: float,
    *,
    at: str | None = None,
    tension: str | None = None,
    t_end: float | None = None,
    start: str | State = "equilibrium",
    water_level: float | None = None,
) -> EffectAudit:
    """Judge each effect that a scene has, and each that it lacks though all that it needs is known.

    Parameters
    ----------
    scene : Scene
    error : float [m], or [N] with `tension`
        What matters.
    at : str or None
        The free point whose place counts; None takes all, or all nodes where there is none.
    tension : str or None
        The cable whose tension counts, in place of a place.
    t_end : float or None [s]
        How long to simulate; None takes two swings after the last corner of a driven path and the last event.
    start : "equilibrium", "calm", "straight" or State
    water_level : float or None [m]
        Height of still water, if it may matter.

    Returns
    -------
    EffectAudit

    Raises
    ------
    SceneError : no point or cable of that name; water where there is no such effect
    InputError : an argument out of its range
    RunError : the scene as it is does not run
    """
    check_scene(scene)
    for name, value in (("error", error), ("t_end", t_end)):
        if value is not None and not 0 < number(value) < math.inf:
            raise InputError(f"Argument `{name}` must be positive and finite, but it is {shown(value)}.")
    error, t_end = number(error), None if t_end is None else number(t_end)
    if at is not None and tension is not None:
        raise InputError(f"Only one of `at` and `tension` may be given, but they are {quoted(at)} and {quoted(tension)}.")
    if at is not None and not isinstance(scene.point(at), Free):
        raise SceneError(f"The place of a free point can be asked for, but {quoted(at)} is held.")
    if tension is not None:
        scene.cable(tension)
    scale = scale_of_motion(scene, start)
    t_end = t_end or two_swings(scene, scale)
    runs = _Runs(error, at, tension, t_end, start, SHARE_OF_TIME_SCALE * scale)
    reference, known_to = runs.reference(scene)
    sizes = scales(reference, 2.0 * math.pi * scale)
    asked, found = audited_in(scene), []
    try:
        for number_of, (name, audited) in enumerate(asked.items(), 1):
            LOG.info("effect %d of %d: %s", number_of, len(asked), name)
            found.append(_verdict(name, audited, scene, reference, runs, sizes, known_to, water_level))
    except KeyboardInterrupt:
        if not found:
            raise
    of = at or tension or ", ".join(point.name for point in scene.points if isinstance(point, Free)) or "all nodes"
    unit, left_out = "N" if tension else "m", tuple(asked)[len(found) :]
    return EffectAudit(tuple(found), of, unit, error, known_to, runs.dt, t_end, left_out)


class _Runs:
    """Runs of one question, all with one step."""

    def __init__(self, error: float, at: str | None, tension: str | None, t_end: float, start: str | State, dt: float) -> None:
        self.error, self.at, self.tension, self.t_end, self.start = error, at, tension, t_end, start
        self.save = t_end / SAVES
        self.dt = self.save / math.ceil(self.save / dt - 1e-9)

    def run(self, scene: Scene, start: str | State | None = None, dt: float | None = None, check: bool = False) -> Run:
        """A run of edmc, which takes all cables and any stiffness."""
        settings: dict[str, Any] = dict(method="edmc", dt=dt or self.dt, save_every=self.save, check=check)
        return simulate(scene, self.t_end, start=self.start if start is None else start, **settings)

    def beside(self, scene: Scene, reference: Run) -> tuple[Run, State | None]:
        """A run of another scene, and what it starts from: as without weight nothing may rest, where the reference does."""
        try:
            return self.run(scene), None
        except EquilibriumError:
            start = replace(reference.state(0), t=0.0, events=())
            return self.run(scene, start), start

    def reference(self, scene: Scene) -> tuple[Run, float]:
        """The run of the scene as it is, and to what it is known; chooses the step."""
        run = self.run(scene, check=True)
        for _ in range(HALVINGS):
            finer = self.run(scene, dt=0.5 * self.dt, check=True)
            known_to = self.apart(run, finer)
            if known_to <= KNOWN_TO * self.error:
                break
            run, self.dt = finer, 0.5 * self.dt
        return run, known_to

    def quantity(self, run: Run) -> np.ndarray:
        """(k, m, d) what is asked for at the saved times."""
        if self.tension is not None:
            return run.tension(self.tension)[:, :, None]
        free = [self.at] if self.at else [point.name for point in run.scene.points if isinstance(point, Free)]
        return np.stack([run.position(name) for name in free], axis=1) if free else run.q

    def apart(self, one: Run, other: Run) -> float:
        """Largest difference of what is asked for between two runs."""
        return float(np.linalg.norm(self.quantity(one) - self.quantity(other), axis=2).max())

    def cost(self, with_it: Scene, without: Scene, start: State | None) -> float:
        """Time of the motion with an effect over that without, less 1; they take turns."""
        took = np.array([[self.run(scene, start).wall_time for scene in (with_it, without)] for _ in range(REPEATS)])
        longer, shorter = took.min(axis=0)
        return float(longer / shorter - 1.0)


def _verdict(
    name: str,
    audited: Audited,
    scene: Scene,
    reference: Run,
    runs: _Runs,
    sizes: Scales,
    known_to: float,
    water_level: float | None,
) -> Verdict:
    """What is found of one effect."""
    present = audited.present(scene)
    try:
        other = audited.without(scene) if present else audited.with_it(scene, water_level)
        run, start = runs.beside(other, reference)
    except SceneError as lacking:
        missing = lacking.missing if isinstance(lacking, InputMissing) else ""
        return Verdict(name, present, {}, math.nan, math.nan, 0.0, UNKNOWN, str(lacking), missing)
    having = scene if present else other
    numbers, stiffness = audited.numbers(having, sizes), 0.5 * runs.dt * audited.frequency(having)
    if not run.ok:
        reason = f"The run {'without' if present else 'with'} it ended at t={run.t[-1]:.4g} s: {run.message}"
        return Verdict(name, present, numbers, math.nan, math.nan, stiffness, UNDECIDED, reason)
    change = runs.apart(reference, run)
    cost = runs.cost(having, other if present else scene, start)
    verdict, reason = _judged(change, known_to, runs.error, stiffness, "N" if runs.tension else "m")
    if name == "elasticity" and present and verdict in (STIFF, NEGLIGIBLE):
        verdict = USE_RIGID if verdict == STIFF else verdict
        reason += ' EA=inf with method="links" takes the stiffness out.'
    return Verdict(name, present, numbers, change, cost, stiffness, verdict, reason)


def _judged(change: float, known_to: float, error: float, stiffness: float, unit: str) -> tuple[str, str]:
    """The verdict on a change, and a sentence."""
    changes = f"changes {change:.3g} {unit} where {error:g} {unit} matter"
    if known_to > KNOWN_TO * error and change <= DECIDES * known_to + error:
        return UNDECIDED, f"The numerical error of this comparison is {known_to:.3g} {unit}; it {changes}."
    if change > error:
        return NEEDED, f"It {changes}."
    if stiffness > 1.0:
        return STIFF, f"It {changes}, and an explicit step has to be {stiffness:.3g} times shorter than the motion needs."
    return NEGLIGIBLE, f"It {changes}."
