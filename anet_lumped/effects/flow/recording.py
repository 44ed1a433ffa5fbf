"""Recordings: tables of numbers over time in CSV files, with a line of names above them."""

import numpy as np

from anet_lumped.checks import LARGEST, NAMED, SceneError, one_line, shown
from anet_lumped.regular_files import read_text

WORDS = {2: "two", 4: "four"}


def read_recording(path: str, names: tuple[str, ...], what: str) -> np.ndarray:
    """Return the table of a file, (k, len(names)) float64 with k of at least 2; the first column are times that increase.

    Parameters
    ----------
    path : str
    names : tuple of str
        Names of the columns, which the first line of the file must hold.
    what : str
        What it is, for messages: "A recorded wind".

    Raises
    ------
    SceneError : no such file, or one that holds something else
    """
    file, columns = one_line(path, NAMED), ", ".join(names)
    first, *lines = read_text(path, what, SceneError).split("\n")
    if tuple(name.strip() for name in first.split(",")) != names:
        raise SceneError(f'{what} must begin with the line "{",".join(names)}", but {file} begins with {shown(first)}.')
    try:
        table = np.array([[float(entry) for entry in line.split(",")] for line in lines if line.strip()])
    except ValueError as error:
        raise SceneError(f"{what} must hold {WORDS[len(names)]} numbers ({columns}) a line, but {file}: {error}.") from None
    if table.ndim != 2 or table.shape[1] != len(names) or len(table) < 2 or not (np.abs(table) <= LARGEST).all():
        beyond = "" if (np.abs(table) <= LARGEST).all() else f" with entries that are not finite, or larger than {LARGEST:g}"
        raise SceneError(
            f"{what} must hold at least two lines of {WORDS[len(names)]} finite numbers ({columns}), but "
            f"{file} has shape {table.shape}{beyond}."
        )
    steps = np.diff(table[:, 0])
    if not (steps > 0.0).all():
        row = int(np.argmin(steps > 0.0))
        raise SceneError(
            f"The times of {what[0].lower()}{what[1:]} must increase, but in {file} t={table[row, 0]} is followed by "
            f"t={table[row + 1, 0]}."
        )
    return table
