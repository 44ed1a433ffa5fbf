"""Waves and currents by the option WaterKin, from the one file that MoorDyn's Fortran version reads.

Its rows are a value and a name, in any order here: `WaveKinMod`, `WaveKinFile`, `dtWave`, `WaveDir` [deg] and `CurrentMod`; behind
`CurrentMod` stands a table of heights z and velocities along x and y. `WaveKinMod` 1, and 3 of older files, is an elevation at the
origin, whose waves go along `WaveDir`; `CurrentMod` 1 is the table. 2 of either is given by the program that calls MoorDyn. The
grid that MoorDyn puts the flow on is not needed.

Source: MoorDyn's documentation, "Water Kinematics file (MoorDyn-F)".
"""

import math
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np

from anet_lumped.checks import NAMED, InputError, one_line
from anet_lumped.effects.flow import waves, wind
from anet_lumped.regular_files import read_text

from .moordyn_flow import elevation_series, positive_depth
from .moordyn_line_types import Tables
from .moordyn_options import Options
from .moordyn_rows import WORD, Row, is_number, made, number_of, unreadable

NAMES = ("WaveKinMod", "WaveKinFile", "dtWave", "WaveDir", "CurrentMod")
FROM_OUTSIDE = 2
OF_ELEVATION = (1, 3)
PROFILE = 1


def read_water_file(options: Options, depth: Callable[[], float], tables: Tables) -> dict[str, Any]:
    """Return the arguments `waves` and `current` of the water, as far as the file of an option WaterKin has them.

    Parameters
    ----------
    options : Options
    depth : callable
        Returns the depth of the water [m].
    tables : Tables
        Where the deck is.
    """
    name = str(options.values.get("WaterKin", ""))
    with options.findings.refusing():
        return _flow(options.rows["WaterKin"], name, depth, tables) if name else {}
    return {}


def _flow(row: Row, name: str, depth: Callable[[], float], tables: Tables) -> dict[str, Any]:
    path = tables.path(row, name, "WaterKin")
    if not path.exists():
        row.findings.remark(
            f"Line {row.line}: WaterKin names a file that is not there, {one_line(name, WORD)}; MoorDyn's C++ version never "
            "reads one. The water is still."
        )
        return {}
    values, table = _read(row, path)
    if not {"WaveKinMod", "CurrentMod"} & set(values):
        raise row.error(f"WaterKin must name a file with WaveKinMod and CurrentMod, but {one_line(path.name, NAMED)} has neither.")
    found: dict[str, Any] = {}
    kinds = {name: number_of(values.get(name, "0")) for name in ("WaveKinMod", "CurrentMod")}
    known = {"WaveKinMod": (0, FROM_OUTSIDE, *OF_ELEVATION), "CurrentMod": (0, FROM_OUTSIDE, PROFILE)}
    for name, kind in kinds.items():
        if kind not in known[name]:
            given = one_line(values[name], WORD)
            raise row.error(f"{name} of {path.name} must be one of {', '.join(map(str, known[name]))}, but is {given}.")
        if kind == FROM_OUTSIDE:
            row.findings.remark(
                f"Line {row.line}: {name} 2 of {one_line(path.name, NAMED)} is given by the program that calls MoorDyn. "
                "Nothing flows by it here."
            )
    if kinds["WaveKinMod"] in OF_ELEVATION:
        wave = _wave(row, path, values, depth)
        found |= {} if wave is None else {"waves": wave}
    if kinds["CurrentMod"] == PROFILE:
        found["current"] = _current(row, path, table)
    return found


def _read(row: Row, path: pathlib.Path) -> tuple[dict[str, str], list[list[float]]]:
    """Values by name, and the table behind CurrentMod."""
    try:
        text = read_text(path, "It", errors="replace")
    except InputError as error:
        raise row.error(f"WaterKin must name a readable file, but {unreadable(path, error)}") from None
    values: dict[str, str] = {}
    table: list[list[float]] = []
    for line in text.splitlines():
        words = line.split()
        name = next((name for name in NAMES if len(words) > 1 and words[1].lower() == name.lower()), None)
        if name is not None:
            values[name] = words[0].strip("\"'")
        elif "CurrentMod" in values and len(words) > 2 and all(map(is_number, words[:3])):
            table.append([number_of(word) for word in words[:3]])
    return values, table


def _current(row: Row, path: pathlib.Path, table: list[list[float]]) -> wind.Wind:
    if not table:
        raise row.error(f"{one_line(path.name, NAMED)} must have a table of heights and velocities behind CurrentMod.")
    if all(z >= 0.0 for z, _, _ in table) and any(z > 0.0 for z, _, _ in table):
        row.findings.remark(f"Line {row.line}: the heights of the current in {one_line(path.name, NAMED)} are read as depths.")
        table = [[-z, u, v] for z, u, v in table]
    return made(row, wind.Sampled, tuple((z, u, v) for z, u, v in sorted(table)))


def _wave(row: Row, path: pathlib.Path, values: dict[str, str], depth: Callable[[], float]) -> waves.Wave | None:
    """Waves of the Fourier series of an elevation, with all that its steps resolve."""
    name, of = values.get("WaveKinFile", ""), one_line(path.name, NAMED)
    file = path.parent / pathlib.Path(name).name
    if not name or not file.exists():
        row.findings.remark(
            f"Line {row.line}: WaveKinFile of {of}, {one_line(name, WORD)}, is not beside it. There are no waves here."
        )
        return None
    try:
        lines = [line.split() for line in read_text(file, "It", errors="replace").splitlines()]
    except InputError as error:
        raise row.error(f"WaveKinFile of {of} must be a table. {error}") from None
    samples = [[number_of(word) for word in words[:2]] for words in lines if len(words) > 1 and all(map(is_number, words[:2]))]
    step, heading = number_of(values.get("dtWave", "nan")), number_of(values.get("WaveDir", "0"))
    if not (step > 0.0 and math.isfinite(heading)):
        raise row.error(f"dtWave of {of} must be a positive number, and WaveDir a number.")
    series = elevation_series(np.array(samples).reshape(-1, 2), step, math.inf, lambda k, why: row.error(f"{file.name}: {why}"))
    rows = [(amplitude, omega, phase, math.radians(heading)) for amplitude, omega, phase in series.tolist() if amplitude]
    return made(row, waves.Components, tuple(rows), positive_depth(row, depth)) if rows else None
