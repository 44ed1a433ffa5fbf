"""A hard case: a motion, and what physics says of it whatever the method."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from anet_lumped.results.run import Run, State
from anet_lumped.scene.scene import Driven, Scene
from integrators import schemes
from integrators.schemes.record import EnergyPromise

ENERGY, LOAD, MOMENTUM, SPIN, REST, ACCURACY = "energy", "load", "momentum", "spin", "rest", "accuracy"
NEVER, ALMOST_NEVER = 1e-6, 0.1  # share of the energy in play by which it may rise: Newton's tolerance; a bounded oscillation


@dataclass(frozen=True)
class Statement:
    """One thing that must hold: a measured number and the bounds that physics sets to it.

    Parameters
    ----------
    kind : ENERGY, LOAD, MOMENTUM, SPIN, REST or ACCURACY
    what : str, what was measured
    value, least, most : float
    unit : str
    """

    kind: str
    what: str
    value: float
    least: float = -math.inf
    most: float = math.inf
    unit: str = ""

    @property
    def holds(self) -> bool:
        """Whether the number lies within its bounds; NaN does not."""
        return bool(self.least <= self.value <= self.most)

    def __str__(self):
        bounds = [f"at least {self.least:.4g}"] if self.least > -math.inf else []
        bounds += [f"at most {self.most:.4g}"] if self.most < math.inf else []
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.what} is {self.value:.4g}{unit} and must be {' and '.join(bounds)}{unit}"


@dataclass(frozen=True, eq=False)
class Case:
    """A motion and what must hold of it.

    Parameters
    ----------
    hard : what is hard about it, and what must hold, in words
    scene : Scene
    t_end : float [s]
    judge : Run -> Statements, of any method; that the energy does not rise is asked of every case besides
    start : "equilibrium", "straight", a State, or a function that makes one
    dt : float or None [s], the step where the motion asks for one; an explicit method takes half its limit if that is less
    given : bool, the step is not to be chosen by anybody: every method has to take `dt`
    saved : float or None [s], time between saved states
    fed : bool, its effects give energy, as wind and winches do: then it is the account of energy that must close
    measure : Run -> (...) float64, what may change by at most `within` when the step is halved
    within : float
    unit : of `within`
    """

    hard: str
    scene: Scene
    t_end: float
    judge: Callable[[Run], Iterable[Statement]] = lambda run: ()
    start: str | State | Callable[[], State] = "equilibrium"
    dt: float | None = None
    given: bool = False
    fed: bool = False
    saved: float | None = None
    measure: Callable[[Run], np.ndarray] | None = None
    within: float = math.inf
    unit: str = "m"

    def begin(self):
        """What `simulate` is to start from."""
        return self.start() if callable(self.start) else self.start

    @property
    def driven(self) -> bool:
        """Whether points are driven, which puts energy in."""
        return any(isinstance(point, Driven) for point in self.scene.points)


def energy_in_play(run) -> float:
    """The largest of the energies that a run moves between their forms or puts in [J]; what a run that blows up dissipates would
    hide that it does."""
    rows = run.energy
    return float(max(rows[:, 0].max(), rows[:, 1].max(), np.ptp(rows[:, 2]), np.abs(rows[:, 3]).max()))


def energy_rise(run) -> float:
    """Largest rise of energy less work put in, above the least before, over the energy in play."""
    own = run.energy[:, :3].sum(axis=1) - run.energy[:, 3]
    in_play = energy_in_play(run)
    return float((own - np.minimum.accumulate(own)).max() / in_play) if in_play > 0.0 else 0.0


def account_statement(run) -> Statement:
    """That what a run is given and dissipates is the change of its energy."""
    return Statement(ENERGY, "energy that is not accounted for, over the energy in play", run.energy_balance.imbalance, most=0.01)


def never_rises(run) -> bool:
    """Whether the run's method promises that energy does not rise at any step; a mean of two runs does so to its error only."""
    return schemes.scheme(run.method).energy is EnergyPromise.NEVER_RISES and not run.extrapolated


def energy_statement(run) -> Statement:
    """That the energy does not rise by itself, to the bound of the run's method."""
    most = NEVER if never_rises(run) else ALMOST_NEVER
    return Statement(ENERGY, "rise of energy over the energy in play", energy_rise(run), most=most)


def at_time(t, of):
    """What a case is to measure: ``of(run)`` (k, 3), t seconds after the start, between the saved states as it is."""
    return lambda run: np.array([np.interp(run.t[0] + t, run.t, x) for x in of(run).T])


def end_of(point):
    """What a case is to measure: where a point is at the end of the run (3,) [m]."""
    return lambda run: run.position(point)[-1]


def weight(scene) -> float:
    """Weight of the cables and of what they carry [N]."""
    mass = sum(cable.length * cable.mass_per_length for cable in scene.cables)
    return float(np.linalg.norm(scene.gravity)) * (mass + sum(getattr(point, "mass", 0.0) for point in scene.points))


def strongest(run, after=0.0, until=math.inf) -> float:
    """Largest tension of any segment at the saved times between two times [N]."""
    chosen = (run.t >= after) & (run.t <= until)
    return float(max(run.tension(cable.name)[chosen].max() for cable in run.scene.cables))
