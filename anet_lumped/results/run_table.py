"""What is kept of many runs of scenes with the same points and cables, as one Dataset of xarray over the runs."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, nearest, shown
from anet_lumped.limits import BYTES, check_most
from anet_lumped.model.build import build
from anet_lumped.results.labelled import AXES
from anet_lumped.scene.scene import Scene
from anet_lumped.scene.units import unit_of_field

from .energy_balance import COLUMNS
from .run import Run

KEPT = ("position", "velocity", "tension", "energy")  # by default
KNOWN = {  # what may be kept: its dimensions after `run` and `t`, its unit
    "position": (("point", "axis"), "m"),
    "velocity": (("point", "axis"), "m/s"),
    "tension": (("cable", "segment"), "N"),
    "shape": (("cable", "node", "axis"), "m"),
    "energy": (("energy_of",), "J"),
}
ERRORS = {  # what a run tells of its errors, which may be kept; their unit, and what they are
    "error_estimate": ("m", "largest error of a place, estimated; NaN if it is not known"),
    "tension_error": ("1", "error of the largest tension over that tension, estimated"),
}
ABOUT = {  # units of what each run has besides, None of words, and what it is
    "status": (None, "how the run ended"),
    "reason": (None, "why it is not done"),
    "warnings": (None, "warnings of the run, one a line"),
    "method": (None, "method of the steps"),
    "step": ("s", "fixed or first step"),
    "end_time": ("s", "time of the last saved state"),
    "steps": ("1", "number of steps taken"),
    "newton_iterations": ("1", "number of Newton iterations"),
}
LONG_NAMES = {
    "position": "places of points",
    "velocity": "velocities of points",
    "tension": "tensions of segments, from the start of their cable",
    "shape": "places of nodes, from the start of their cable",
    "energy": "energies, and what was done and taken since the start",
}
NOT_RUN = "not run"  # status of one that Ctrl-C came before
SAME_TIME = 1e-6  # of the time between two saved states
FAILED = "failed"  # status of a run that ended in an exception


class RunTable:
    """Rows of many runs, each written when its run ends, by any thread.

    Parameters
    ----------
    scene : Scene, of any of the runs
    count : int, number of runs
    t : increasing (k,) float64 [s], times at which runs save
    keep : sequence of names in `KNOWN` and `ERRORS`

    Raises
    ------
    InputError : a name that is not known; more than memory holds
    """

    def __init__(self, scene: Scene, count: int, t: np.ndarray, keep: Sequence[str] = KEPT) -> None:
        if isinstance(keep, str) or not isinstance(keep, Iterable):
            raise InputError(f'Argument `keep` must be a list of what is kept of a run, as ["position"], but it is {shown(keep)}.')
        for name in keep:
            if name not in KNOWN and name not in ERRORS:
                known = (*KNOWN, *ERRORS)
                near = nearest(name, known) or f"; known are {', '.join(known)}."
                raise InputError(f"Argument `keep` must list what is kept of a run, but it has {shown(name)}{near}")
        model, most = build(scene), max((cable.segments for cable in scene.cables), default=0)
        self.scene, self.count, self.t = scene, count, t
        sizes = {
            "point": len(scene.all_points), "axis": 3, "cable": len(scene.cables), "segment": most, "node": most + 1,
            "energy_of": len(COLUMNS),
        }  # fmt: skip
        shapes = {name: (count, len(t), *(sizes[axis] for axis in KNOWN[name][0])) for name in keep if name in KNOWN}
        numbers = sum(float(np.prod([float(size) for size in shape])) for shape in shapes.values())
        check_most(BYTES, 8.0 * numbers, f"What is kept of {count} runs at {len(t)} times")
        self.kept = {name: np.full(shape, np.nan) for name, shape in shapes.items()}
        self.points = np.array([model.node(point.name) for point in scene.all_points])
        self.cables = [(cable.segments, model.segments(cable.name), model.nodes(cable.name)) for cable in scene.cables]
        # whether the segments of all cables, one cable behind the other, are those of a model in their order
        in_order = [slice(c * most, (c + 1) * most) for c in range(len(scene.cables))]
        self.tensions_in_order = [segments for _, segments, _ in self.cables] == in_order
        self.errors = {name: np.full(count, np.nan) for name in keep if name in ERRORS}
        self.status = np.full(count, NOT_RUN, object)
        self.texts = {name: np.full(count, "", object) for name in ("reason", "warnings", "method")}
        self.numbers = {name: np.full(count, np.nan) for name in ("step", "end_time")}
        self.counts = {name: np.zeros(count, np.int64) for name in ("steps", "newton_iterations")}

    def take(self, k: int, run: Run) -> None:
        """Write the k-th run."""
        rows, of_run = self._rows(run.t)
        tension = run.segment_tension[of_run]
        for name, kept in self.kept.items():
            own = kept[k]
            if name in ("position", "velocity"):
                of_nodes = (run.q if name == "position" else run.v)[of_run]
                np.take(of_nodes, self.points, axis=1, out=own[rows], mode="clip")  # another mode would copy twice
            elif name == "tension" and self.tensions_in_order:
                own[rows].reshape(tension.shape)[...] = tension
            elif name == "tension":
                for c, (count, segments, _) in enumerate(self.cables):
                    own[rows, c, :count] = tension[:, segments]
            elif name == "shape":
                for c, (count, _, nodes) in enumerate(self.cables):
                    own[rows, c, : count + 1] = run.q[:, nodes][of_run]
            else:
                own[rows] = run.energy[of_run]
        texts = run.message, "\n".join(run.warnings), run.method
        for name, text in zip(self.texts, texts, strict=True):
            self.texts[name][k] = text
        self.numbers["step"][k], self.numbers["end_time"][k] = run.dt, run.t[-1]
        self.counts["steps"][k], self.counts["newton_iterations"][k] = run.work.steps, run.work.newton_iterations
        for name, errors in self.errors.items():
            told = getattr(run, name)
            errors[k] = np.nan if told is None else told
        self.status[k] = run.status

    def fail(self, k: int, error: Exception) -> None:
        """Write that the k-th run ended in an exception."""
        self.texts["reason"][k] = f"{type(error).__name__}: {error}"
        self.status[k] = FAILED

    def _rows(self, t: np.ndarray) -> tuple[Any, Any]:
        """Rows of this table for rows of a run; the state in which a run failed may be at a time that the others do not save."""
        tolerance = SAME_TIME * (self.t[1] - self.t[0])
        if len(t) <= len(self.t) and np.abs(self.t[: len(t)] - t).max() <= tolerance:
            return slice(len(t)), slice(None)
        rows = np.minimum(np.searchsorted(self.t, t - tolerance), len(self.t) - 1)
        of_run = np.flatnonzero(np.abs(self.t[rows] - t) <= tolerance)
        if len(of_run) == 0 or len(set(rows[of_run].tolist())) < len(of_run):
            raise InputError("Runs of one table must save at the same times, but this one saved others.")
        first, last = int(rows[of_run[0]]), int(rows[of_run[-1]])
        if last - first + 1 != len(of_run):
            raise InputError("Runs of one table must save at the same times, but this one lacks some of them.")
        return slice(first, last + 1), of_run

    def dataset(self, varied: dict[str, np.ndarray]) -> Any:
        """An `xarray.Dataset` of all runs; numbers say their units, and what varies where its field says one.

        Parameters
        ----------
        varied : name -> values (runs,), of the fields that vary, which become coordinates
        """
        import xarray as xr

        scene, cables = self.scene, [cable.name for cable in self.scene.cables]
        values: dict[str, Any] = {
            name: (("run", "t", *KNOWN[name][0]), kept, {"units": KNOWN[name][1], "long_name": LONG_NAMES[name]})
            for name, kept in self.kept.items()
        }
        number, names = {"units": "1", "long_name": "number of the run"}, [point.name for point in scene.all_points]
        coordinates: dict[str, Any] = {"run": ("run", np.arange(self.count), number), "t": ("t", self.t, {"units": "s"})}
        coordinates |= {"cable": cables, "point": names, "axis": list(AXES), "energy_of": list(COLUMNS)}
        used = {axis for axes, *_ in values.values() for axis in axes} | {"run", "t"}
        coordinates = {name: found for name, found in coordinates.items() if name in used}
        for name, column in ({"status": self.status} | self.texts | self.numbers | self.counts | self.errors).items():
            unit, long_name = (ABOUT | ERRORS)[name]
            about = {"long_name": long_name} if unit is None else {"units": unit, "long_name": long_name}
            values[name] = ("run", column.astype(str) if column.dtype == object else column, about)
        for name, of_name in varied.items():
            unit = unit_of_field(scene, name)
            entries = (f"{name}.{i}" for i in range(1, of_name.ndim))  # of places and other lists of numbers
            coordinates[name] = (("run", *entries), of_name, {"units": unit} if unit else {})
        return xr.Dataset(values, coordinates)
