"""Runs by names: as a Dataset of xarray over points and cables, as a table over time, and labels of nodes and segments in files."""

from typing import Any

import numpy as np

from anet_lumped.model.model import Model

from .energy_balance import COLUMNS, UNDIVIDED
from .peaks import largest_so_far

AXES = ("x", "y", "z")


def energy_names(run: Any) -> tuple[str, ...]:
    """Names of the columns of a run's energies."""
    return COLUMNS if run.energy.shape[1] == len(COLUMNS) else UNDIVIDED


def dataset(run: Any) -> Any:
    """A run as an `xarray.Dataset` whose dimensions are names: ``ds.sel(point="bottle")``, ``ds.sel(cable="line1")``.

    Variables: `position` and `velocity` (t, point, axis), `shape` (t, cable, node, axis), `tension` (t, cable, segment),
    `largest_tension` (t, cable), in all steps up to each time, and `energy` (t, energy_of). Coordinates: `arc` (cable, node) and
    `arc_of_segment` (cable, segment), unstretched lengths from the start of each cable as the scene has it. Nodes and segments are
    counted from the start of a cable. Where cables have fewer than others, NaN follows.
    """
    import xarray as xr

    scene = run.scene
    points, cables = [point.name for point in scene.all_points], [cable.name for cable in scene.cables]
    most, rows = max((cable.segments for cable in scene.cables), default=0), len(run.t)
    largest = largest_so_far(run.model, run.segment_tension) if run.largest_tension is None else run.largest_tension
    shape, tension = np.full((rows, len(cables), most + 1, 3), np.nan), np.full((rows, len(cables), most), np.nan)
    arc, middle = np.full((len(cables), most + 1), np.nan), np.full((len(cables), most), np.nan)
    for c, cable in enumerate(scene.cables):
        n = cable.segments
        shape[:, c, : n + 1], tension[:, c, :n] = run.shape(cable.name), run.tension(cable.name)
        arc[c, : n + 1], middle[c, :n] = _arcs(cable)
    nodes = [run.model.node(name) for name in points]
    return xr.Dataset(
        {
            "position": (("t", "point", "axis"), run.q[:, nodes], {"units": "m"}),
            "velocity": (("t", "point", "axis"), run.v[:, nodes], {"units": "m/s"}),
            "shape": (("t", "cable", "node", "axis"), shape, {"units": "m", "long_name": "places of nodes"}),
            "tension": (("t", "cable", "segment"), tension, {"units": "N"}),
            "largest_tension": (("t", "cable"), largest, {"units": "N", "long_name": "largest in all steps so far"}),
            "energy": (("t", "energy_of"), run.energy, {"units": "J"}),
        },
        coords={
            "t": ("t", run.t, {"units": "s"}),
            "point": points,
            "cable": cables,
            "axis": list(AXES),
            "energy_of": list(energy_names(run)),
            "arc": (("cable", "node"), arc, {"units": "m", "long_name": "unstretched length from the start of the cable"}),
            "arc_of_segment": (("cable", "segment"), middle, {"units": "m", "long_name": "the same, of the middle of a segment"}),
        },
        attrs={"status": run.status, "method": run.method, "step_s": float(run.dt)},
    )


def frame(run: Any) -> Any:
    """A run as a `pandas.DataFrame`, a row for each saved time [s]; each column says its unit.

    Of each point its place and velocity, of each cable its stretched length and its least and largest tension, and the energies.
    """
    import pandas

    columns: dict[str, np.ndarray] = {}
    for point in run.scene.all_points:
        for symbol, unit, rows in (("", "m", run.position(point.name)), ("v", "m/s", run.velocity(point.name))):
            columns |= {f"{point.name} {symbol}{axis} [{unit}]": rows[:, i] for i, axis in enumerate(AXES)}
    for cable in run.scene.cables:
        tension = run.tension(cable.name)
        columns[f"{cable.name} length [m]"] = run.length(cable.name)
        columns[f"{cable.name} least tension [N]"] = tension.min(axis=1)
        columns[f"{cable.name} largest tension [N]"] = tension.max(axis=1)
    columns |= {f"{name} [J]": run.energy[:, i] for i, name in enumerate(energy_names(run))}
    return pandas.DataFrame(columns, index=pandas.Index(run.t, name="t [s]"))


def labels(model: Model) -> dict[str, tuple[str, Any, dict[str, str]]]:
    """Dimension, values and attributes of what a file says of each node and segment.

    A point is of the first cable that ends there; one without a cable has "" and NaN. Inner nodes have "" for a point.
    """
    point, cable, arc = np.full(model.n, "", object), np.full(model.n, "", object), np.full(model.n, np.nan)
    segment_cable, segment_arc = np.full(model.n_segments, "", object), np.empty(model.n_segments)
    for name, node in model.node_of.items():
        point[node] = name
    for one in reversed(model.scene.cables):  # the first is written last
        nodes, (ends, middles) = model.nodes(one.name), _arcs(one)
        cable[nodes], arc[nodes] = one.name, ends
        segment_cable[model.segments(one.name)], segment_arc[model.segments(one.name)] = one.name, middles
    along = {"units": "m", "long_name": "unstretched length from the start of the cable"}
    return {
        "point": ("node", point.astype(str), {"long_name": "point of the scene that a node is"}),
        "cable": ("node", cable.astype(str), {"long_name": "cable that a node is on"}),
        "arc": ("node", arc, along),
        "segment_cable": ("segment", segment_cable.astype(str), {"long_name": "cable that a segment is of"}),
        "segment_arc": ("segment", segment_arc, along),
    }


LABELS = ("point", "cable", "arc", "segment_cable", "segment_arc")
"""Names of what `labels` says. A file is read without them, since its scene says the same."""


def _arcs(cable: Any) -> tuple[np.ndarray, np.ndarray]:
    """Unstretched lengths from the start of a cable to its nodes, and to the middles of its segments [m]."""
    ends = np.linspace(0.0, cable.length, cable.segments + 1)
    return ends, 0.5 * (ends[:-1] + ends[1:])
