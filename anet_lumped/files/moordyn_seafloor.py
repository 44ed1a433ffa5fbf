"""The bottom of a MoorDyn file that is not flat: its table of heights.

MoorDyn's C++ version reads it from the file of its option `SeafloorFile`: how many places x and y the grid has, the places x, the
places y, and rows of x, y and the height z there. Its Fortran version reads it from a file in place of the number of `WtrDpth`: a
title, `nGridX` and `nGridY` with their numbers, the places x, and rows of a place y and the depth at each x. See its documentation,
"Seafloor/Bathymetry File". Beyond the grid both take the depth of its nearest edge.
"""

from typing import NamedTuple

import numpy as np

from anet_lumped.checks import NAMED, InputError, one_line
from anet_lumped.regular_files import read_text

from .moordyn_findings import Findings
from .moordyn_line_types import Tables
from .moordyn_options import NOTHING, Options
from .moordyn_rows import Row, is_number, number_of, unreadable


class Seafloor(NamedTuple):
    """Heights [m] over a grid, (len(x), len(y)), and where the file names them."""

    x: tuple[float, ...]
    y: tuple[float, ...]
    heights: tuple[tuple[float, ...], ...]
    row: Row


def read_seafloor(options: Options, tables: Tables, findings: Findings) -> Seafloor | None:
    """Read the table that the options name; None without one, or if it is refused.

    Parameters
    ----------
    options : Options
    tables : Tables
        Where the deck is.
    findings : Findings
    """
    if not names_seafloor(options):
        return None
    name, row = str(options.values["SeafloorFile"]), options.rows["SeafloorFile"]
    with findings.refusing():
        path = tables.path(row, name, "a seafloor")
        try:
            text = read_text(path, "It", errors="replace")
        except InputError as error:
            raise row.error(f"a seafloor must be in a readable file, but {unreadable(path, error)}") from None
        lines = [line.split() for line in text.splitlines() if line.strip()]
        return _of_grid(lines, row) if lines and is_number(lines[0][0]) else _of_depths(lines, row)
    return None


def names_seafloor(options: Options) -> bool:
    """Whether the options name a table."""
    name = str(options.values.get("SeafloorFile", ""))
    return name.lower() not in NOTHING and number_of(name) != 0.0


def _of_grid(lines: list[list[str]], row: Row) -> Seafloor:
    """The table of MoorDyn's C++ version."""
    _check_numbers(lines, row)
    counts = [int(number_of(word)) for word in lines[0]]
    if len(lines) < 3 or [len(line) for line in lines[1:3]] != counts[:2]:
        raise row.error("a seafloor must begin with the numbers of places x and y, the places x and the places y.")
    x, y = (tuple(map(number_of, line)) for line in lines[1:3])
    heights: dict[tuple[float, float], float] = {}
    for line in lines[3:]:
        at = (number_of(line[0]), number_of(line[1])) if len(line) == 3 else None
        if at is None or at[0] not in x or at[1] not in y:
            raise row.error(
                f"rows of a seafloor must be a place x and a place y of its grid and a height, but one is {' '.join(line)}."
            )
        heights[at] = number_of(line[2])
    missing = [(a, b) for a in x for b in y if (a, b) not in heights]
    if missing:
        raise row.error(f"a seafloor must have a height at each place of its grid, but has none at {missing[0]}.")
    return Seafloor(x, y, tuple(tuple(heights[a, b] for b in y) for a in x), row)


def _of_depths(lines: list[list[str]], row: Row) -> Seafloor:
    """The table of MoorDyn's Fortran version."""
    counts = {words[0].lower(): int(number_of(words[1])) for words in lines[1:3] if len(words) > 1 and is_number(words[1])}
    if set(counts) != {"ngridx", "ngridy"}:
        raise row.error("a seafloor must begin with a title, nGridX and nGridY, or with the numbers of places x and y.")
    table = lines[3 : 4 + counts["ngridy"]]
    _check_numbers(table, row)
    across = counts["ngridx"]
    if len(table) != 1 + counts["ngridy"] or len(table[0]) != across or any(len(line) != across + 1 for line in table[1:]):
        raise row.error("a seafloor must have nGridX places x and then nGridY rows of a place y and a depth at each x.")
    y = tuple(number_of(line[0]) for line in table[1:])
    depths = np.array([[number_of(word) for word in line[1:]] for line in table[1:]])
    return Seafloor(tuple(map(number_of, table[0])), y, tuple(map(tuple, (-depths.T + 0.0).tolist())), row)


def _check_numbers(lines: list[list[str]], row: Row) -> None:
    for line in lines:
        if not all(map(is_number, line)):
            raise row.error(f"a seafloor must be numbers, but has {one_line(' '.join(line), NAMED)}.")


def seafloor_text(x: tuple[float, ...], y: tuple[float, ...], heights: tuple[tuple[float, ...], ...]) -> str:
    """Return the table as MoorDyn's C++ version reads it."""
    rows = [f"{a!r} {b!r} {z!r}" for a, column in zip(x, heights, strict=True) for b, z in zip(y, column, strict=True)]
    return "\n".join((f"{len(x)} {len(y)}", " ".join(map(repr, x)), " ".join(map(repr, y)), *rows))
