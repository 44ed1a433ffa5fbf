"""A state to start from, from a file of places along cables.

A CSV with a row for each place, below the names `cable`, `x`, `y`, `z` [m] and, if it has velocities, `vx`, `vy`, `vz` [m/s], in
any order beside whatever else: such as the `nodes.csv` that `anet-lumped equilibrium --out` writes. The rows of a cable are in the
order along it, from either end; how many they are is free, see `State.of`.
"""

import csv
from os import PathLike

from anet_lumped.checks import InputError, quoted
from anet_lumped.regular_files import read_text
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene

PLACES, VELOCITIES = ("x", "y", "z"), ("vx", "vy", "vz")


def read_start(path: str | PathLike[str], scene: Scene) -> State:
    """Read a state of a scene; see the module.

    Parameters
    ----------
    path : str or pathlib.Path
    scene : Scene

    Raises
    ------
    InputError : no such file, a column that it lacks, what is no number, and whatever `State.of` refuses
    """
    rows = csv.DictReader(read_text(path, "A start").splitlines())
    names = [name.strip() for name in rows.fieldnames or ()]
    rows.fieldnames = names
    for name in ("cable", *PLACES):
        if name not in names:
            raise InputError(f"A start must have the columns cable, x, y and z, but {path} has no column {quoted(name)}.")
    columns = PLACES + (VELOCITIES if set(VELOCITIES) <= set(names) else ())
    found: dict[str, list[list[float]]] = {}
    for row in rows:
        try:
            numbers = [float(row[name]) for name in columns]
        except (TypeError, ValueError):
            raise InputError(f"A start must hold numbers, but in {path}, line {rows.line_num}, there is none.") from None
        found.setdefault(str(row["cable"]), []).append(numbers)
    shapes = {name: [numbers[:3] for numbers in own] for name, own in found.items()}
    velocities = {name: [numbers[3:] for numbers in own] for name, own in found.items()} if len(columns) > 3 else None
    return State.of(scene, shapes, velocities)
