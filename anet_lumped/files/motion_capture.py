"""Exports of motion-capture programs as they come: the CSV of OptiTrack's Motive, and the trajectories of Vicon's Nexus.

* Motive: a first line `Format Version,...` that has the `Length Units`; a few lines below, each named in its second cell, `Type`,
  `Name`, and one that says `Position` or `Rotation`; then `Frame,Time (Seconds),X,Y,Z,...` and the numbers. Its axes have y up.
* Nexus: a line `Trajectories`, the frames a second, the names of the markers over every third column, `Frame,Sub Frame,X,Y,Z,...`,
  the units, and the numbers up to an empty line. Its axes have z up.

An empty cell is a marker that was hidden. Names of subjects before a colon are taken off where a name is unique without them.

Source: OptiTrack, Motive Documentation, Data Export: CSV; Vicon Nexus User Guide, ASCII file format.
"""

import csv
import math
from collections import Counter
from dataclasses import dataclass
from os import PathLike

import numpy as np

from anet_lumped.checks import InputError, shown

UNITS = {"meters": "m", "centimeters": "cm", "millimeters": "mm", "m": "m", "cm": "cm", "mm": "mm"}
METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
UP = {"z": ((0, 1, 2), (1.0, 1.0, 1.0)), "y": ((0, 2, 1), (1.0, -1.0, 1.0))}
"""For the axis of a file that points up: which of its axes those of a scene are, and with which sign."""
HEAD = 12  # lines within which the names of the columns must be


class SeriesError(InputError):
    """A file of measured series that cannot be read."""


@dataclass(frozen=True)
class Capture:
    """What a motion-capture program exported, in metres and with z up.

    Parameters
    ----------
    program : "Motive" or "Nexus"
    t : (k,) float64 [s]
    markers, bodies : by name (k, 3) float64 [m], NaN where hidden; of a rigid body its origin
    unit : of lengths in the file
    up : axis of the file that points up
    """

    program: str
    t: np.ndarray
    markers: dict[str, np.ndarray]
    bodies: dict[str, np.ndarray]
    unit: str
    up: str


def is_capture(text: str) -> bool:
    """Whether a text begins as an export of one of these programs does."""
    return text.lstrip("\ufeff \r\n").startswith("Format Version") or _of_nexus(text.splitlines()) is not None


def _of_nexus(lines: list[str]) -> int | None:
    """Number of the line that heads the trajectories, which may stand below other sections."""
    return next((i for i, line in enumerate(lines) if line.strip("\ufeff \t,;") == "Trajectories"), None)


def z_up(places: np.ndarray, up: str) -> np.ndarray:
    """Places (..., 3) of a file whose axis ``up`` points up, in axes of which z does, by a turn about x."""
    if up not in UP:
        raise SeriesError(f'The axis of a file that points up must be "y" or "z", but up={shown(up)} was given.')
    order, sign = UP[up]
    return places[..., list(order)] * sign


def read_capture(text: str, path: str | PathLike[str], up: str | None = None) -> Capture:
    """Read an export, see the module.

    Parameters
    ----------
    text : str, what the file holds
    path : for messages
    up : "y", "z" or None, the axis of the file that points up; by default that of the program

    Raises
    ------
    SeriesError : a part of the layout is missing, a unit is not known, or what should be a number is none
    """
    lines = text.lstrip("\ufeff \r\n").splitlines()
    lines = lines[_of_nexus(lines) or 0 :]
    rows = [[cell.strip() for cell in row] for row in csv.reader(lines, delimiter="\t" if "\t" in lines[-1] else ",")]
    if rows[0][0] == "Format Version":
        program, up, unit, (t, places, kinds) = "Motive", up or "y", _motive_unit(rows[0], path), _motive(rows, path)
    else:
        program, up, (unit, t, places, kinds) = "Nexus", up or "z", _nexus(rows, path)
    short = {name: name.rpartition(":")[2] for name in places}
    unique = Counter(short.values())
    found = {
        (short[name] if unique[short[name]] == 1 else name): z_up(METRES[unit] * xyz, up)
        for name, xyz in places.items()
        if np.isfinite(xyz).all(axis=1).any()
    }
    bodies = {short[name] if unique[short[name]] == 1 else name for name, kind in kinds.items() if kind == "Rigid Body"}
    markers = {name: xyz for name, xyz in found.items() if name not in bodies}
    return Capture(program, t, markers, {name: found[name] for name in found if name in bodies}, unit, up)


def _motive_unit(head: list[str], path: str | PathLike[str]) -> str:
    told = dict(zip(head[::2], head[1::2], strict=False)).get("Length Units", "")
    if told.lower() not in UNITS:
        raise SeriesError(f"A Motive export must have Length Units of meters or millimeters, but {path} has {shown(told)}.")
    return UNITS[told.lower()]


def _motive(rows: list[list[str]], path: str | PathLike[str]) -> tuple:
    """Times, places and kinds of what has a position."""
    at = next((i for i, row in enumerate(rows[:HEAD]) if row[:1] == ["Frame"]), None)
    named = {row[1]: row for row in rows[1:at] if len(row) > 2 and row[1]} if at else {}
    quantity = rows[at - 1] if at else []
    if not (at and {"Type", "Name"} <= set(named)):
        raise SeriesError(f"A Motive export must have lines Type, Name and Frame, but {path} lacks one within {HEAD} lines.")
    columns: dict[str, dict[str, int]] = {}
    kinds: dict[str, str] = {}
    for i in range(2, len(rows[at])):
        kind, name, what = (row[i] if i < len(row) else "" for row in (named["Type"], named["Name"], quantity))
        if what == "Position" and kind in ("Marker", "Rigid Body Marker", "Rigid Body"):
            labelled = f"{name} ({kind})" if kinds.get(name, kind) != kind else name  # a marker and its place on a rigid body
            kinds[labelled] = kind
            columns.setdefault(labelled, {})[rows[at][i].upper()] = i
    if any(kind == "Marker" for kind in kinds.values()):  # as seen, and not where a rigid body has them
        columns = {name: own for name, own in columns.items() if kinds[name] != "Rigid Body Marker"}
    table = _table(rows[at + 1 :], len(rows[at]), path)
    return table[:, 1], _places(table, columns, path), kinds


def _nexus(rows: list[list[str]], path: str | PathLike[str]) -> tuple:
    """Unit, times and places of the trajectories, and no kinds."""
    try:
        rate = float(rows[1][0])
        names, axes, units = rows[2], rows[3], rows[4]
    except (IndexError, ValueError):
        raise SeriesError(f"A Nexus export must have its frames a second below Trajectories, but {path} does not.") from None
    told = {unit for unit in units[2:] if unit}
    if axes[:2] != ["Frame", "Sub Frame"] or len(told) != 1 or not told <= set(UNITS) or not rate > 0.0:
        raise SeriesError(
            f"A Nexus export must have columns Frame and Sub Frame and one unit, m or mm, but {path} has {shown(axes[:2])} and "
            f"{shown(sorted(told))}."
        )
    columns: dict[str, dict[str, int]] = {}
    name = ""
    for i in range(2, len(axes)):
        name = names[i] if i < len(names) and names[i] else name
        columns.setdefault(name, {})[axes[i].upper()] = i
    body = rows[5:]
    end = next((i for i, row in enumerate(body) if not any(row)), len(body))  # other sections follow
    table = _table(body[:end], len(axes), path)
    return UNITS[told.pop()], table[:, 0] / rate, _places(table, columns, path), {}


def _table(rows: list[list[str]], width: int, path: str | PathLike[str]) -> np.ndarray:
    """(k, width) numbers, NaN for an empty cell."""
    found = np.full((len(rows), width), math.nan)
    for k, row in enumerate(rows):
        try:
            found[k, : min(len(row), width)] = [float(cell) if cell else math.nan for cell in row[:width]]
        except ValueError:
            raise SeriesError(f"Samples must be numbers, but {path}, row {k + 1} of them, has {shown(row[:8])}.") from None
    return found[np.isfinite(found[:, 0])]


def _places(table: np.ndarray, columns: dict[str, dict[str, int]], path: str | PathLike[str]) -> dict[str, np.ndarray]:
    for name, own in columns.items():
        if set(own) != set("XYZ"):
            raise SeriesError(f"A marker must have the columns X, Y and Z, but {path} has {shown(sorted(own))} of {shown(name)}.")
    if not columns or not len(table):
        raise SeriesError(f"A motion-capture export must hold places of markers, but {path} has none.")
    return {name: table[:, [own[axis] for axis in "XYZ"]] for name, own in columns.items()}
