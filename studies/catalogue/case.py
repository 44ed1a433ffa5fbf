"""A hard case: a motion, and what physics says of it whatever the method."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.results.run import Run
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Driven, Scene
from integrators import schemes
from integrators.schemes.record import EnergyPromise

ENERGY, LOAD, MOMENTUM, SPIN, REST, ACCURACY = "energy", "load", "momentum", "spin", "rest", "accuracy"
NO_RISE, BOUNDED_RISE = 1e-6, 0.1  # of the energy in play: Newton's tolerance; a bounded oscillation


@dataclass(frozen=True)
class Statement:
    """A measured number and the bounds that physics sets to it.

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
    description : what is hard about it, and what must hold
    scene : Scene
    t_end : float [s]
    judge : Run -> Statements, of a run with any method; that the energy does not rise is stated of every case besides
    start : "equilibrium", "straight", a State, or a function that makes one
    dt : float or None [s], the step where the motion asks for one; an explicit method takes half its limit if that is less
    step_is_given : bool, every method has to take `dt`
    save_every : float or None [s], time between saved states
    energy_is_fed_in : bool, effects such as wind and winches put energy in: then the energy balance must close instead
    measure : Run -> (...) float64, a result that changes by `tolerance` at most when the step is halved
    tolerance : float
    unit : of `tolerance`
    """

    description: str
    scene: Scene
    t_end: float
    judge: Callable[[Run], Iterable[Statement]] = lambda run: ()
    start: str | State | Callable[[], State] = "equilibrium"
    dt: float | None = None
    step_is_given: bool = False
    energy_is_fed_in: bool = False
    save_every: float | None = None
    measure: Callable[[Run], np.ndarray] | None = None
    tolerance: float = math.inf
    unit: str = "m"

    def start_state(self):
        """State or word that `simulate` starts from."""
        return self.start() if callable(self.start) else self.start

    @property
    def driven(self) -> bool:
        """Whether points are driven, which puts energy in."""
        return any(isinstance(point, Driven) for point in self.scene.points)


def energy_in_play(run) -> float:
    """Largest of the kinetic and elastic energy, the range of the potential energy and the work put in [J].

    Dissipated energy does not count: a run that blows up dissipates so much that its rise of energy would look small.
    """
    rows = run.energy
    return float(max(rows[:, 0].max(), rows[:, 1].max(), np.ptp(rows[:, 2]), np.abs(rows[:, 3]).max()))


def energy_rise(run) -> float:
    """Largest rise of energy less work put in, above the least before, over the energy in play."""
    own = run.energy[:, :3].sum(axis=1) - run.energy[:, 3]
    in_play = energy_in_play(run)
    return float((own - np.minimum.accumulate(own)).max() / in_play) if in_play > 0.0 else 0.0


def account_statement(run) -> Statement:
    """The change of a run's energy is the work put in less what is dissipated."""
    return Statement(ENERGY, "energy that is not accounted for, over the energy in play", error_of_steps(run), most=0.01)


def promises_no_energy_gain(method: str) -> bool:
    """Whether a scheme promises that energy does not rise at any step."""
    return schemes.scheme(method).energy is EnergyPromise.NEVER_RISES


def must_not_gain_energy(run) -> bool:
    """Whether the run's method promises that energy does not rise at any step.

    An extrapolated run, which is a mean of two, keeps this only to its error.
    """
    return promises_no_energy_gain(run.method) and not run.extrapolated


def energy_statement(run) -> Statement:
    """The energy does not rise by itself, within the bound of the run's method."""
    most = NO_RISE if must_not_gain_energy(run) else BOUNDED_RISE
    return Statement(ENERGY, "rise of energy over the energy in play", energy_rise(run), most=most)


def at_time(t, positions):
    """A measure of a case: ``positions(run)`` (k, 3) t seconds after the start, interpolated between the saved states."""
    return lambda run: np.array([np.interp(run.t[0] + t, run.t, x) for x in positions(run).T])


def position_at_end(point):
    """A measure of a case: position of a point at the end of the run (3,) [m]."""
    return lambda run: run.position(point)[-1]


def weight(scene) -> float:
    """Weight of the cables and of what they carry [N]."""
    mass = sum(cable.length * cable.mass_per_length for cable in scene.cables)
    return float(np.linalg.norm(scene.gravity)) * (mass + sum(getattr(point, "mass", 0.0) for point in scene.points))


def largest_tension(run, after=0.0, until=math.inf) -> float:
    """Largest tension of any segment at the saved times between two times [N]."""
    chosen = (run.t >= after) & (run.t <= until)
    return float(max(run.tension(cable.name)[chosen].max() for cable in run.scene.cables))
