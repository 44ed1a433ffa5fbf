"""A Run: the states of a motion, how it ended, and what it cost."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, check_index
from anet_lumped.model import body_rotation
from anet_lumped.model.model import Model
from anet_lumped.model.rest_lengths import at_time
from anet_lumped.scene.scene import Scene
from integrators import schemes
from integrators.schemes.record import EnergyPromise
from integrators.system import DIVERGED, DONE, EVENT, INTERRUPTED, OUT_OF_STEPS, UNCONVERGED

from . import end_forces, error_estimate, free_flight, labelled, peaks, run_file, tension_error, touchdown
from .audit import Audit
from .energy_balance import COLUMNS, UNDIVIDED, EnergyBalance
from .events import BREAK, RELEASE, Event
from .hidden_swings import hides_swings
from .rainflow import Cycles, cycles
from .slack import SlackTime, Snap, slack_times, snaps
from .state import State, segment_tensions
from .stretch import stretch

STATUS = {
    DONE: "done",
    UNCONVERGED: "unconverged",
    DIVERGED: "diverged",
    INTERRUPTED: "interrupted",
    OUT_OF_STEPS: "out of steps",
    EVENT: "event",  # of a leg that a break ended, never of a run
}
FINISHED = ("done", "energy gained", "audit failed")  # statuses of runs that reached their end
OF_STATES = (
    "t", "q", "v", "energy", "segment_tension", "largest_tension", "error_growth", "q_near", "crept", "T_max", "shedding",
)  # fmt: skip
"""Arrays of a run that have a row for each saved state."""
STATUSES = (*(STATUS[k] for k in (UNCONVERGED, DIVERGED, INTERRUPTED, OUT_OF_STEPS)), *FINISHED)


class RunInterrupt(KeyboardInterrupt):
    """Ctrl-C during a run; ``run`` holds what it had done."""

    def __init__(self, run: "Run") -> None:
        super().__init__(run.message)
        self.run = run


@dataclass
class Work:
    """What a run did: steps taken and rejected, steps halved because Newton failed, force evaluations, Newton iterations,
    factorisations."""

    steps: int = 0
    rejected: int = 0
    halvings: int = 0
    force_evaluations: int = 0
    newton_iterations: int = 0
    factorisations: int = 0


@dataclass(frozen=True, eq=False)
class Run:
    """A motion: saved states, how it ended, and what it cost.

    Parameters
    ----------
    model : Model
    t : (k,) float64 [s]
    q, v : (k, n, 3) float64 [m], [m/s]
    energy : (k, 7) float64 [J]
        Kinetic, elastic, potential energy; since the start, work done and energy taken by dampers, by effects and by the method:
        `energy_balance.COLUMNS`. Five columns in runs saved by version 0.1, `energy_balance.UNDIVIDED`.
    method : str
    dt : float [s], the fixed or the first step
    reason : str, why this method and step
    status : "done", "diverged", "unconverged", "interrupted", "out of steps", "energy gained" or "audit failed"
        The last two are of runs that reached their end: see `motion.energy_gain` and `audit`.
    message : str, one sentence that says when, where, why and what to try, if it is not done
    work : Work
    error_growth : (k,) float64 [m] or None
        Sum of what the steps leave out of places, up to each saved time; None of a solver of another package. See `error`.
    error_factor : float
        Times that errors of places are what the run tells by itself, as far as a run with longer steps has shown.
    wall_time : float [s], of the march alone
    warnings : tuple of str, from before the run (see `motion.choice`) and of the completed run (see `motion.run_warnings`)
    segment_tension : (k, n_segments) float64 [N]; None takes the law at every saved time
        Where the steps do not resolve the stretching, the mean over the step that ends at the time: half a step late.
    largest_tension : (k, cables) float64 [N] or None
        Largest tension of each cable up to each saved time, in all steps; None where every step is saved, and of a solver of
        another package. See `peak_tension`.
    peak_at_most : float or None [N]
        What the largest tension may be, where it passes between two saved states and the steps about it have been looked at.
    audit : Audit or None, what an audit found, if one was asked for
    events : tuple of Event
        What happened, in order: payloads that changed, segments that broke; with what its start had behind it. Rows saved at the
        very time show the state before it.
    extrapolated : bool, whether it is the limit of two runs, with a step and with its half
    kept : bool or None
        Whether the errors that were to be kept are, as far as its own estimates tell (see `motion.accuracy`); None if the step was
        given.
    q_near : (k, n, 3) float64 [m] or None, as of a `State`
    pushed : bool, as of a `State`
    crept : (k, n_segments) float64 [m] or None, likewise; of scenes with a cable that creeps
    T_max : (k, n_segments) float64 [N] or None, likewise; of scenes with a `working_curve`
    shedding : (k, n, 4) float64 or None, likewise; of scenes with cables that shed vortices
    """

    model: Model
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    energy: np.ndarray
    method: str
    dt: float
    reason: str = ""
    status: str = "done"
    message: str = ""
    work: Work = field(default_factory=Work)
    error_growth: np.ndarray | None = None
    error_factor: float = 1.0
    wall_time: float = 0.0
    warnings: tuple[str, ...] = ()
    segment_tension: np.ndarray = None  # type: ignore[assignment]  # the law gives it
    largest_tension: np.ndarray | None = None
    peak_at_most: float | None = None
    audit: Audit | None = None
    events: tuple[Event, ...] = ()
    extrapolated: bool = False
    kept: bool | None = None
    q_near: np.ndarray | None = None
    pushed: bool = False
    crept: np.ndarray | None = None
    T_max: np.ndarray | None = None
    shedding: np.ndarray | None = None

    def __repr__(self) -> str:
        states = f"{len(self.t)} states of {self.q.shape[1]} nodes from t={self.t[0]:g} s to {self.t[-1]:g} s"
        return f"<Run {self.status!r}: {self.method} with dt={self.dt:.3g} s, {states}>"

    def _repr_html_(self) -> str:
        from anet_lumped.views.notebook import run_html

        return run_html(self)

    @property
    def scene(self) -> Scene:
        """The scene that moved."""
        return self.model.scene

    @property
    def ok(self) -> bool:
        """Whether the run reached its end, and nothing was found against it."""
        return self.status == "done"

    @property
    def reached_end(self) -> bool:
        """Whether the run reached its end, whatever was found against it."""
        return self.status in FINISHED

    @cached_property
    def energy_balance(self) -> EnergyBalance:
        """Changes of energy over the run and what does not add up, an `EnergyBalance`."""
        return EnergyBalance.of(self.energy)

    @property
    def energy_promise(self) -> EnergyPromise:
        """What the method promises of the energy of this scene: nothing where an effect has a force without an energy.

        Nor does it where a spring gets stiffer as a cable creeps (`EA_dynamic_per_tension`), or follows working curves, and where
        vortices shake a cable.
        """
        kept = all(effect.keeps_energy for effect in self.model.forces)
        kept = kept and not any(cable.EA_dynamic_per_tension or cable.working_curve for cable in self.scene.cables)
        return schemes.scheme(self.method).energy if kept else EnergyPromise.NONE

    @cached_property
    def error(self) -> np.ndarray | None:
        """(k,) largest error of a place up to each saved time [m], estimated; None if it is not known. See `error_estimate`."""
        return None if self.error_growth is None else error_estimate.place_errors(self)

    @property
    def error_estimate(self) -> float | None:
        """Largest error of a place over the run [m], estimated; None if it is not known."""
        return None if self.error is None else float(self.error[-1])

    @property
    def was_compared(self) -> bool:
        """Whether runs with two steps have been compared: it keeps errors, or does not, is a limit of two, or was audited."""
        return self.kept is not None or self.extrapolated or self.audit is not None

    @cached_property
    def multiplies(self) -> float:
        """Times the errors told of places that they may be: 1, or more where it goes loose or buckles (`free_flight.multiplied`).

        1 where runs with two steps have been compared, which shows what the motion multiplies.
        """
        return 1.0 if self.was_compared else free_flight.multiplied(self)

    @cached_property
    def tension_error(self) -> float:
        """Error of the largest tension, `peak_tension`, over what that tension may be, estimated; see `tension_error`."""
        return tension_error.tension_error(self)

    @cached_property
    def slack(self) -> list[SlackTime]:
        """Times for which cables were slack, as far as saved states tell; see `results.slack`."""
        return slack_times(self)

    @cached_property
    def snaps(self) -> list[Snap]:
        """Peaks of tension with which slack cables were taut again, from the largest on; see `results.slack`."""
        return snaps(self)

    @cached_property
    def hides_swings(self) -> bool:
        """Whether it swings between its saved states, so that curves through these show another motion; see `hidden_swings`."""
        return hides_swings(self)

    @property
    def final(self) -> State:
        """State at the last saved time."""
        return self.state(-1)

    def __post_init__(self) -> None:
        if self.segment_tension is None:
            with np.errstate(over="ignore", invalid="ignore"):  # the last state of a run that diverged
                object.__setattr__(self, "segment_tension", segment_tensions(self.model, self.q, self.v))
        self._check_shapes()

    def _check_shapes(self) -> None:
        """A row of each array for each saved time, of the nodes and segments that the model has."""
        rows, places = self.t.shape, (*self.t.shape, self.model.n, 3)
        columns = self.energy.shape[1:] if self.energy.shape[1:] in ((len(COLUMNS),), (len(UNDIVIDED),)) else (len(COLUMNS),)
        shapes = {"q": places, "v": places, "q_near": places, "segment_tension": (*rows, self.model.n_segments)}
        shapes["crept"] = shapes["T_max"] = shapes["segment_tension"]
        shapes["shedding"], shapes["largest_tension"] = (*places[:2], 4), (*rows, len(self.scene.cables))
        for name, shape in (shapes | {"error_growth": rows, "energy": (*rows, *columns)}).items():
            found = getattr(self, name)
            if found is not None and found.shape != shape:
                raise InputError(f"Argument `{name}` of a Run must be of the shape {shape}, but its shape is {found.shape}.")

    def state(self, k: int) -> State:
        """State at the k-th saved time; from the end where k is negative.

        Raises
        ------
        InputError : there is no such time
        """
        k = check_index("k", k, len(self.t), "the number of a saved time")
        t = float(self.t[k])
        near = None if self.q_near is None else self.q_near[k]
        tension, events = self.segment_tension[k], self.events_before(k)
        inner = {name: None if (rows := getattr(self, name)) is None else rows[k] for name in ("crept", "T_max", "shedding")}
        return State(self.model, t, self.q[k], self.v[k], tension, events=events, q_near=near, pushed=self.pushed, **inner)

    def events_before(self, k: int) -> tuple[Event, ...]:
        """What had happened before the k-th saved state."""
        t = float(self.t[k])
        return tuple(event for event in self.events if event.t < t or (event.t == t and event.kind in (BREAK, RELEASE)))

    def position(self, point: str) -> np.ndarray:
        """(k, 3) places of a point [m]."""
        return self.q[:, self.model.node(point)]

    def velocity(self, point: str) -> np.ndarray:
        """(k, 3) velocities of a point [m/s]."""
        return self.v[:, self.model.node(point)]

    def rotation(self, body: str) -> np.ndarray:
        """(k, 3, 3) rotation matrices of a body; their columns are the body's axes."""
        return body_rotation.rotations(self.model, body, self.t, self.q)

    def quaternion(self, body: str) -> np.ndarray:
        """(k, 4) rotations of a body as unit quaternions (w, x, y, z) with w >= 0."""
        return body_rotation.quaternions(self.rotation(body))

    def angular_velocity(self, body: str) -> np.ndarray:
        """(k, 3) angular velocities of a body in the axes of the world [rad/s]."""
        return body_rotation.angular_velocities(self.model, body, self.t, self.q, self.v)

    def shape(self, cable: str) -> np.ndarray:
        """(k, segments + 1, 3) places of a cable's nodes from its start to its end [m]."""
        return self.q[:, self.model.nodes(cable)]

    def tension(self, cable: str) -> np.ndarray:
        """(k, segments) tension of a cable's segments from its start to its end [N]."""
        return self.segment_tension[:, self.model.segments(cable)]

    def peak_tension(self, cable: str | None = None) -> float:
        """Largest tension of a cable, or of any, in all steps of the run [N]; 0 where nothing is taut.

        A peak that passes between two saved states counts (`largest_tension`), which `tension` and what is made of it do not show.
        """
        return peaks.peak_tension(self, cable)

    def end_tension(self, cable: str, point: str) -> np.ndarray:
        """(k,) force with which a cable pulls at a point where it ends [N]: its last half segment included, see `end_forces`."""
        parts = [end_forces.end_force(rows, self.scene, cable, point) for rows in end_forces.rows_of_run(self)]
        return np.linalg.norm(np.concatenate(parts), axis=1)

    def rainflow(self, cable: str, point: str | None = None) -> Cycles:
        """Rainflow cycles of the tension of a cable at a point where it ends, its end if not given, over the saved times.

        What comes and goes between two saved times is not counted: let ``save_every`` be a part of the shortest cycle.
        """
        return cycles(self.t, self.end_tension(cable, self.scene.cable(cable).end if point is None else point))

    def reaction(self, name: str) -> np.ndarray:
        """(k, 3) force of a fixed or driven point, of what drives or pins a body or of the "ground" [N], see `end_forces`."""
        return np.concatenate([end_forces.reaction(rows, self.scene, name) for rows in end_forces.rows_of_run(self)])

    def touchdown_length(self, cable: str) -> np.ndarray:
        """(k,) unstretched length of a cable that lies on the ground [m], known to half a segment; see `results.touchdown`."""
        return touchdown.touchdown_lengths(self.model, end_forces.rows_of_run(self), cable, self.holds(cable))

    def length(self, cable: str) -> np.ndarray:
        """(k,) stretched length of a cable [m], without segments that broke."""
        return (np.linalg.norm(np.diff(self.shape(cable), axis=1), axis=2) * self.holds(cable)).sum(axis=1)

    def stretch(self, cable: str) -> np.ndarray:
        """(k,) stretched length of a cable over its length at rest at that time, less 1, without segments that broke."""
        return stretch(self, cable)

    @cached_property
    def rest_lengths(self) -> dict[str, np.ndarray]:
        """(k,) lengths at rest of the cables whose length changes in time, by name [m]."""
        return at_time(self.scene, self.t)

    def holds(self, cable: str) -> np.ndarray:
        """(k, segments) bool: whether each segment of a cable, from its start to its end, has not broken."""
        whole = np.ones((len(self.t), self.scene.cable(cable).segments), bool)
        for event in self.events:
            if event.kind == BREAK and event.where == cable:
                whole[self.t > event.t, event.segment] = False
        return whole

    def save(self, path: str | PathLike[str]) -> None:
        """Write the run, its scene and its account to one netCDF file."""
        run_file.write(self, path)

    def to_xarray(self) -> Any:
        """The run as a Dataset of xarray whose dimensions are names of points and cables; see `results.labelled.dataset`."""
        return labelled.dataset(self)

    def to_frame(self) -> Any:
        """The run as a DataFrame of pandas, a row for each saved time, with units; see `results.labelled.frame`."""
        return labelled.frame(self)

    def save_vtk(self, folder: str | PathLike[str]) -> Path:
        """Write `run.pvd` and a `.vtp` for each saved state into a folder, for ParaView; see `views.vtk_writer`."""
        from anet_lumped.views.vtk_writer import save_vtk

        return save_vtk(self, folder)

    def plot(self) -> Any:
        """A figure of matplotlib: shapes, tensions and energies, and how the run ended; see `views.run_figure`."""
        from anet_lumped.views.run_figure import plot_run

        return plot_run(self)

    def plot_tension(self) -> Any:
        """A figure of matplotlib: the range of tensions along each cable, and tensions over time; see `views.tension_figure`."""
        from anet_lumped.views.tension_figure import plot_tension

        return plot_tension(self)

    def view(self, path: str | PathLike[str] | None = None) -> Path:
        """Write the run as a page (.html), a film (.gif, .mp4) or a VTK series (.pvd); without a path, open a page in a browser."""
        from anet_lumped.views.show import view

        return view(self, path)


def with_states(run: Run, rows: np.ndarray) -> Run:
    """A run with some of its saved states, of which ``rows`` (k,) bool tells."""
    return replace(run, **{name: array[rows] for name in OF_STATES if (array := getattr(run, name)) is not None})


__all__ = ["Audit", "EnergyBalance", "Run", "Work"]
