"""Random nets, starts, paths, methods and steps: each run must end well with its energy accounted for, or say why not.

Run as `python -m studies.fuzz`. A trial is drawn with a `Pick`, so that tests draw the same trials from another source of chance.
"""

import math
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from anet_lumped import Cable, Driven, EquilibriumError, Fixed, Free, InputError, Scene, SceneError, State, effects
from anet_lumped.model.build import build
from anet_lumped.model.tables import AXIAL_STIFFNESS
from anet_lumped.motion.known_errors import TENSION_ERROR, Wanted
from anet_lumped.motion.simulate import StabilityWarning, simulate, straight
from anet_lumped.motion.stability import predict
from anet_lumped.prescribed import paths
from anet_lumped.results.state import segment_tensions
from integrators import schemes
from integrators.schemes.record import EnergyPromise
from studies.catalogue.outcome import DEFAULT, FAILED, GAINED, HELD, REFUSED, bounded_work, compiled_methods
from studies.catalogue.random_extras import with_extras

IMBALANCE, MORE_A_STEP = 1e-4, 1e-7  # of the energy in play, what the exact balance of edmc may miss: Newton's tolerance over
# some ten steps, and over thousands of them
RISE, GAIN = 1e-5, 0.1  # of the energy in play: of methods that never raise it; of the others, counted
FAR_OFF = 10.0  # times the error that a run says it keeps: from there on it is wrong in silence
SMALL = 1e-4  # of the longest cable: an error a tenth of what the default keeps need not be told
KNOWN = 0.2  # of a distance, by which that from a still finer run may differ
MOST_COMPARED = 20_000  # steps of a run that is compared with a finer one
EVALUATIONS = 800  # of the force by one of scipy's solvers
EXPLICIT_STEPS = 400
RIGID_LENGTHS = 1e-7  # of the weight times its place, what is no energy in play where edmc keeps lengths to its tolerance
LENGTHS = 1e-10  # of a length, what edmc's tolerance leaves where cables do not stretch: energy of their weight, once
SLACK_LENGTH = 1.05  # of the distance of its ends, that of a cable which does not stretch, at least
ADAPTIVE_TURNS, SCIPY_TURNS = 300.0, 30.0  # of the fastest axial motion, as omega t


class Pick(Protocol):
    """A source of chance."""

    def integer(self, low: int, high: int) -> int:
        """An integer from low to high, both included."""

    def number(self, low: float, high: float) -> float:
        """A number between low and high."""

    def one_of(self, choices: tuple) -> Any:
        """One of the choices."""


class Random:
    """`Pick` from a seed."""

    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)

    def integer(self, low, high):
        """An integer from low to high, both included."""
        return int(self.rng.integers(low, high + 1))

    def number(self, low, high):
        """A number between low and high."""
        return float(self.rng.uniform(low, high))

    def one_of(self, choices):
        """One of the choices."""
        return choices[int(self.rng.integers(len(choices)))]


@dataclass(frozen=True)
class Trial:
    """A run to try: the arguments of `simulate`; start "thrown" is straight with velocities of up to `speed` [m/s].

    `error` [m] is to be kept, where it is not None.
    """

    scene: Scene
    t_end: float
    method: str | None
    dt: float | None
    rtol: float | None
    start: str
    speed: float = 0.0
    seed: int = 0
    error: float | None = None


def draw(pick: Pick, surroundings: bool = True) -> Trial:
    """A random trial; scenes and arguments that the library does not take raise its own errors.

    Without surroundings a scene has no air, water, ground, bending nor axial damping, and none of `random_extras`.
    """
    scene = _scene(pick, surroundings)
    method = pick.one_of((None, None, "edmc", "edmc", "backward_euler", *compiled_methods()))
    rtol = pick.one_of((None,) * 7 + (1e-4,))
    start = pick.one_of(("equilibrium", "straight", "thrown"))
    steps = pick.integer(5, 40)
    dt = 10.0 ** pick.number(-4.0, -1.0)
    scheme = None if method is None else schemes.scheme(method)
    from_elsewhere = scheme is not None and not scheme.own
    if scheme is not None and scheme.own and scheme.explicit:
        limit = predict(scene, schemes=(method,)).limits[method].step or 1e-4
        dt = limit * 10.0 ** pick.number(-1.0, 0.3)
        t_end = dt * pick.integer(5, EXPLICIT_STEPS)
        if scheme.embedded and pick.integer(0, 1):
            dt = None
    elif from_elsewhere or rtol:  # as many steps as it takes: within some turns of the fastest motion they are few
        turns = SCIPY_TURNS if from_elsewhere else ADAPTIVE_TURNS
        t_end, dt = min(dt * steps, turns / max(cable.omega_max for cable in scene.cables)), None
    else:
        t_end = dt * steps
        if method is None and pick.integer(0, 1):
            dt = None
    speed = 10.0 ** pick.number(-2.0, 1.0)
    rtol = None if from_elsewhere else rtol
    error = 10.0 ** pick.number(-4.0, -1.0) if dt is None and rtol is None and not from_elsewhere and pick.integer(0, 1) else None
    if error is not None and method is not None and schemes.scheme(method).embedded:
        error = None
    trial = Trial(scene, t_end, method, dt, rtol, start, speed, pick.integer(0, 10**6), error)
    if pick.integer(0, 5) == 0:
        trial = _without_stretch(pick, trial)
    return with_extras(pick, trial) if surroundings else trial


def _without_stretch(pick, trial):
    """The trial with cables that do not stretch and reach, some of them straight, which not all methods take."""
    at = {point.name: np.array(point.path.at(0.0)[0] if isinstance(point, Driven) else point.at) for point in trial.scene.points}
    are_straight, free = pick.integer(0, 1), {point.name for point in trial.scene.free_points}
    cables = []
    for cable in trial.scene.cables:
        apart = float(np.linalg.norm(at[cable.end] - at[cable.start]))
        straight = are_straight and apart > 0.0 and (cable.start in free or cable.end in free)
        length = apart if straight else max(cable.length, SLACK_LENGTH * apart)
        cables.append(replace(cable, length=length, EA=math.inf, zeta=0.0, tension_strain=None, EA_compression=0.0))
    method, dt = pick.one_of(("links", "links", "links", None, "edmc")), pick.one_of((None, 10.0 ** pick.number(-4.0, -1.0)))
    t_end = 10.0 ** pick.number(-2.0, 0.5) if dt is None else dt * pick.integer(1, EXPLICIT_STEPS)
    rtol = pick.one_of((None, None, 10.0 ** pick.number(-10.0, -1.0))) if dt is None else None
    error = trial.error if dt is None and rtol is None else None
    scene = replace(trial.scene, cables=cables)
    return replace(trial, scene=scene, method=method, dt=dt, t_end=t_end, rtol=rtol, error=error)


def _scene(pick, surroundings):
    n = pick.integer(2, 6)
    coordinates = tuple(x / 2 for x in range(-2, 3))
    kinds = [pick.one_of(("fixed", "driven", "free", "free", "free")) for _ in range(n)]
    points = []
    for i, kind in enumerate(kinds):
        at = tuple(pick.one_of(coordinates) for _ in range(3))
        if kind == "fixed":
            points.append(Fixed(f"p{i}", at))
        elif kind == "driven":
            points.append(Driven(f"p{i}", _path(pick, at)))
        else:
            points.append(Free(f"p{i}", mass=pick.one_of((0.0, 0.0, 1e-6, 0.01, 1.0, 100.0)), at=at))
    links = [(pick.integer(0, i - 1), i) for i in range(1, n)]  # all are joined
    for _ in range(pick.integer(0, 3)):  # loops, parallel cables
        a = pick.integer(0, n - 1)
        links.append((a, (a + pick.integer(1, n - 1)) % n))
    EA, zeta = 10.0 ** pick.number(2.0, 9.0), pick.one_of((0.0, 0.05, 1.0, 30.0, 1e4))
    law, mu = pick.one_of(("none", "none", "damped", "linear")), 10.0 ** pick.number(-3.0, 0.0)
    elastic = {"tension_strain": _curve(pick, EA)} if pick.integer(0, 4) == 0 else {"EA": EA}
    diameter = 10.0 ** pick.number(-3.0, -1.5)
    cables = [
        Cable(
            f"p{a}", f"p{b}", length=pick.one_of((0.1, 0.5, 1.0, 2.0)), mass_per_length=mu, zeta=zeta, segments=pick.integer(1, 12),
            compression=law, name=f"c{c}", diameter=diameter, EI=EA * diameter**2 / 16.0, **elastic,
        )
        for c, (a, b) in enumerate(links)
    ]  # fmt: skip
    g = pick.one_of((9.81, 9.81, 9.81, 0.0, -9.81))
    acting = [effects.Gravity(abs(g), (0.0, 0.0, -1.0 if g > 0 else 1.0))] if g else []
    rate = pick.one_of((0.0, 0.0, 0.5, 50.0))
    acting += [effects.ViscousDamping(rate)] if rate else []
    return Scene(points, cables, acting + (_surroundings(pick) if surroundings else []))


def _curve(pick, EA):
    """A tension-strain curve of up to four pieces, the steepest of slope EA."""
    slopes = [10.0 ** pick.number(-3.0, 0.0) for _ in range(pick.integer(1, 4))]
    knots, T, curve = sorted(10.0 ** pick.number(-5.0, -1.0) * (1 + i) for i in range(len(slopes))), 0.0, []
    for before, eps, slope in zip((0.0, *knots), knots, slopes, strict=False):
        T += EA * slope / max(slopes) * (eps - before)
        curve.append((eps, T))
    return tuple(curve)


def _surroundings(pick):
    """Effects that put no energy in; one that is not drawn is not even imported."""
    which = pick.one_of(("none",) * 4 + ("air", "water", "ground", "bending", "axial damping", "all"))
    level = pick.one_of((-2.0, -0.5, 0.0, 3.0))
    friction, rate = pick.one_of((0.0, 0.5)), pick.one_of((0.5, 50.0))
    known = {
        "air": lambda: effects.Air(),
        "water": lambda: effects.Water(level=level, g=9.81),
        "ground": lambda: effects.Ground(height=level - 1.0, friction=friction),
        "bending": lambda: effects.Bending(),
        "axial damping": lambda: effects.AxialDamping(rate=rate),
    }
    return [make() for name, make in known.items() if which in (name, "all")]


def _path(pick, at):
    kind = pick.one_of(("line", "harmonic", "samples"))
    velocity = np.array([pick.number(-1.0, 1.0) for _ in range(3)]) * 10.0 ** pick.number(-3.0, 0.7)
    if kind == "line":
        return paths.line(at, tuple(velocity), ramp=pick.one_of((0.0, 0.01, 1.0)))
    if kind == "harmonic":
        return paths.harmonic(at, tuple(0.1 * velocity), 10.0 ** pick.number(-1.0, 2.0), ramp=pick.one_of((0.0, 0.1)))
    t = np.linspace(0.0, 0.5, 6)
    return paths.samples(t, np.array(at) + np.outer(np.sin(7 * t) * t, velocity))


def attempt(trial: Trial) -> tuple[str, str]:
    """Run a trial: HELD, REFUSED, GAINED or FAILED; and why.

    It is refused by a status other than "done", a warning or an error of the library's own, each in words.
    """
    try:
        with warnings.catch_warnings(record=True) as caught, bounded_work(EVALUATIONS):
            warnings.simplefilter("always")
            run = simulate(
                trial.scene, trial.t_end, method=trial.method, dt=trial.dt, rtol=trial.rtol, start=_start(trial), error=trial.error
            )  # fmt: skip
    except (InputError, EquilibriumError) as error:
        return (REFUSED if str(error).strip() else FAILED), f"{type(error).__name__}: {error}"
    except Exception as error:
        return FAILED, f"{type(error).__name__}: {error}"
    finite = np.isfinite(run.q).all() and np.isfinite(run.v).all()
    if not run.ok:
        return (REFUSED if run.message and len(run.t) else FAILED), run.message
    if not (finite and np.isfinite(run.energy).all()):
        return FAILED, "done, yet not finite"
    if abs(run.t[-1] - run.t[0] - trial.t_end) > 1e-9 * trial.t_end:
        return FAILED, f"done at t={run.t[-1]:g} s instead of {trial.t_end:g} s"
    said = next((str(w.message) for w in caught if issubclass(w.category, StabilityWarning)), "")
    outcome = (REFUSED, said) if said else _audit(trial, run)
    if outcome[0] != HELD or run.work.steps >= MOST_COMPARED:
        return outcome
    return _kept(trial, run) if run.kept else _told(trial, run)


def _kept(trial, run):
    """Whether a run that says it kept its errors did, beside one with a quarter of its step, or a small tolerance."""
    allowed, every = Wanted(trial.error, TENSION_ERROR).of_places(run), run.t[1] - run.t[0]
    by_tolerance = schemes.scheme(run.method).embedded
    how, steps = (
        ("a small tolerance", {"atol": 1e-3 * allowed}) if by_tolerance else ("a quarter of its step", {"dt": run.dt / 4.0})
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        finer = simulate(trial.scene, trial.t_end, method=run.method, save_every=every, start=_start(trial), **steps)
    if not finer.ok or len(finer.t) != len(run.t):
        return HELD, ""
    off = float(np.linalg.norm(run.q - finer.q, axis=2).max())
    if off > FAR_OFF * allowed:
        return FAILED, f"{run.method} says that it keeps places to {allowed:.2g} m, but {how} is {off:.2g} m away"
    return HELD, ""


def _told(trial, run):
    """Whether a run at a given step that does not say that its motion multiplies errors is off by little more than it tells."""
    scheme = schemes.scheme(run.method)
    given = trial.dt is not None and trial.rtol is None and scheme.own
    if not given or run.error_estimate is None or run.multiplies > 1.0:
        return HELD, ""
    allowed = max(FAR_OFF * run.error_estimate, SMALL * max(cable.length for cable in trial.scene.cables))
    off = before = math.inf
    for finer in (4.0, 8.0):  # where these two are far apart, no error is known
        before = off
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            beside = simulate(
                trial.scene, trial.t_end, method=run.method, dt=run.dt / finer, save_every=run.t[1] - run.t[0], start=_start(trial)
            )  # fmt: skip
        if not beside.ok or len(beside.t) != len(run.t):
            return HELD, ""
        off = float(np.linalg.norm(run.q - beside.q, axis=2).max())
        if off <= allowed:
            return HELD, ""
    if abs(off - before) > KNOWN * off:
        return HELD, ""
    return FAILED, f"{run.method} tells an error of {run.error_estimate:.2g} m, but an eighth of its step is {off:.2g} m away"


def _start(trial):
    if trial.start != "thrown":
        return trial.start
    model, rng = build(trial.scene), np.random.default_rng(trial.seed)
    q = straight(model)
    free = slice(0, model.n_free)
    moved = rng.normal(scale=0.05 * rng.uniform(), size=(model.n_free, 3))
    q[free] += 0.0 if trial.scene.cables[0].inextensible else moved  # by which some segments would be too long
    v = np.zeros_like(q)
    v[free] = rng.uniform(-trial.speed, trial.speed, (model.n_free, 3))
    return State(model, 0.0, q, v, segment_tensions(model, q, v))


def _audit(trial, run):
    """Whether the energy of a run is accounted for, as far as its method promises."""
    model, scene = run.model, run.scene
    rows = run.energy
    m = model.mass[: model.n_free]
    weighty = m.sum() * (np.linalg.norm(scene.gravity) * np.abs(run.q).max() + (run.v**2).sum(axis=2).max())
    kept = RIGID_LENGTHS if scene.cables[0].inextensible else 1e-9
    rounding = kept * weighty + 1e-15 * float(model.axial[:, AXIAL_STIFFNESS].max()) * np.abs(run.q).max() ** 2
    own, taken = rows[:, :3].sum(axis=1) - rows[:, 3], rows[:, 4:].sum(axis=1)
    in_play = max(rows[:, 0].max(), rows[:, 1].max(), np.ptp(rows[:, 2]), np.abs(rows[:, 3]).max(), taken.max()) + rounding
    in_play = max(in_play, 1e-300)  # of a net that nothing moves
    waves = any(isinstance(effect, effects.Water) and (effect.wave or effect.waves) for effect in scene.effects)
    rising = own + taken if waves else own  # of energy that waves give, only what is not accounted for is out of nothing
    lengths = LENGTHS * weighty if scene.cables[0].inextensible else 0.0  # by which an event changes what lengths miss
    if schemes.scheme(run.method).chooses_steps(trial.dt):  # states between its steps are interpolated, their energies too rough
        rising = rising[[0, -1]]
    rise = max(0.0, float((rising - np.minimum.accumulate(rising)).max()) - lengths) / in_play
    driven = any(isinstance(point, Driven) for point in scene.points)
    if run.method == "edmc":
        off = abs(own[-1] - own[0] + taken[-1] - taken[0]) / in_play
        if off > IMBALANCE + MORE_A_STEP * run.work.steps:
            return FAILED, f"edmc's balance of energy is off by {off:.2g} of the energy in play"
        # states between adaptive steps are interpolated, their energies too rough; added mass that turns gives energy of the water
        if rise > RISE and trial.rtol is None and not any(isinstance(effect, effects.Water) for effect in scene.effects):
            return FAILED, f"edmc raises the energy by {rise:.2g} of the energy in play"
        return HELD, ""
    if driven or trial.rtol is not None:  # of work, other methods' accounts are rough where a point jumps
        return HELD, ""
    scheme, pushes = schemes.scheme(run.method), any(cable.compression == "linear" for cable in scene.cables)
    if scheme.energy is EnergyPromise.NEVER_RISES and not pushes and rise > RISE:
        return FAILED, f"{scheme.label} raises the energy by {rise:.2g} of the energy in play"
    if rise > GAIN:
        return (FAILED if trial.method is None else GAINED), f"{run.method} raises the energy by {rise:.2g} of that in play"
    return HELD, ""


def each(seed: int, first: int, count: int, surroundings: bool = True) -> Iterator[dict]:
    """Trials by number as they end, as dicts: number, method (or "default"), outcome, why, seconds."""
    for number in range(first, first + count):
        began, method = time.perf_counter(), ""
        try:
            trial = draw(Random((seed, number)), surroundings)
            method = trial.method or DEFAULT
            outcome, why = attempt(trial)
        except SceneError as error:  # such as a cable from a point to itself
            outcome, why, method = REFUSED, f"SceneError: {error}", "scene"
        yield {"number": number, "method": method, "outcome": outcome, "why": why, "seconds": time.perf_counter() - began}


def try_many(seed: int, first: int, count: int, surroundings: bool = True) -> list[dict]:
    """What `each` says of trials, once all have ended."""
    return list(each(seed, first, count, surroundings))
