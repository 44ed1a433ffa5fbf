"""What a MoorDyn file wants written, of a run: its channels as columns, and files like MoorDyn's.

Channels are those of MoorDyn's documentation ("Outputs"): `FairTen1` and `AnchTen1`, the force at the last and at the first end of
line 1; `Con3px` or `Point3px`, of a point, and `L2N4px` or `Line2N4px`, of a node of a line: places px, py, pz [m], velocities vx,
vy, vz [m/s], net forces fx, fy, fz [N] and T or Ten, their size [N], which is at a node within a line the mean of the tensions on
both sides; `Line1TenA`, `Line1TenB`, at its ends. As in MoorDyn the force at an end includes weight, buoyancy and drag of the half
segment there, and not its inertia. Of a line the letters p, v, t and s are places, velocities, tensions and strains.

Accelerations, forces of single terms and whatever belongs to bodies and rods are not written; `Outputs.missing` names them.
"""

import pathlib
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from os import PathLike
from typing import Any

import numpy as np

from anet_lumped.regular_files import read_text, write_text
from anet_lumped.results.end_forces import end_force, rows_of_run
from anet_lumped.results.run import Run
from anet_lumped.scene.body import OnBody
from anet_lumped.scene.scene import Free, Scene

from .moordyn_file import Deck, deck_from_text
from .moordyn_findings import DeckWarning
from .scene_file import MOORDYN

POINT = re.compile(r"(?:C|CON|CONNECT|P|POINT)(\d+)(P[XYZ]|V[XYZ]|F[XYZ]|T|TEN)")
NODE = re.compile(r"(?:L|LINE)(\d+)N(\d+|A|B)(P[XYZ]|V[XYZ]|F[XYZ]|T|TEN)")
END = re.compile(r"(FAIRTEN|ANCHTEN)(\d+)|(?:L|LINE)(\d+)TEN([AB])")
UNITS = {"P": "m", "V": "m/s", "F": "N", "T": "N"}
LETTERS = "pvts"  # of a line's output
WIDTH, TIME_WIDTH = 20, 10  # characters of a column, as MoorDyn's


@dataclass(frozen=True)
class Outputs:
    """Columns that a file asks for.

    Parameters
    ----------
    columns : dict of name to (k,) float64
        Channels at the saved times of a run.
    units : dict of name to str
    lines : dict of int to dict of name to (k,) float64
        Columns of each line that has letters of output, by its number.
    missing : tuple of str
        Channels and letters that are not written.
    """

    columns: dict[str, np.ndarray]
    units: dict[str, str]
    lines: dict[int, dict[str, np.ndarray]]
    missing: tuple[str, ...]


def outputs(deck: Deck, run: Run) -> Outputs:
    """Return the columns that a MoorDyn file asks for, of a run of its scene or of its scene on a platform.

    Parameters
    ----------
    deck : Deck
    run : Run
    """
    columns, missing = {}, []
    for name in dict.fromkeys(deck.channels):
        column = _channel(name.upper(), deck, run)
        if column is None:
            missing.append(name)
        else:
            columns[name] = column
    lines = {number: _line_columns(run, deck.lines[number], letters) for number, letters in deck.line_outputs.items()}
    for number, letters in deck.line_outputs.items():
        missing += [f"{letter} of line {number}" for letter in dict.fromkeys(letters) if letter not in LETTERS]
    return Outputs(columns, {name: _unit(name.upper()) for name in columns}, lines, tuple(missing))


def write_outputs(deck: Deck, run: Run, folder: str | PathLike[str], stem: str) -> Outputs:
    """Write `stem.out` with the channels and `stem.LineN.out` of each line that has letters of output, in MoorDyn's form.

    Parameters
    ----------
    deck : Deck
    run : Run
    folder : str or pathlib.Path
    stem : str

    Returns
    -------
    Outputs, what is written
    """
    found = outputs(deck, run)
    if found.columns:
        _write(pathlib.Path(folder, f"{stem}.out"), run.t, found.columns, found.units)
    for number, columns in found.lines.items():
        if columns:
            units = {name: _unit_of_line(name) for name in columns}
            _write(pathlib.Path(folder, f"{stem}.Line{number}.out"), run.t, columns, units)
    return found


def write_asked(source: str | PathLike[str], run: Run, folder: str | PathLike[str]) -> None:
    """Write what a MoorDyn file wants written of a run of it; nothing of a scene from elsewhere.

    Warns of what it wants and is not written.

    Parameters
    ----------
    source : str or pathlib.Path
        What the scene was loaded from.
    run : Run
    folder : str or pathlib.Path
    """
    path = pathlib.Path(source)
    if path.suffix.lower() not in MOORDYN:
        return
    deck = deck_from_text(read_text(path, "A MoorDyn file", errors="replace"), path.name, folder=path.parent)
    found = write_outputs(deck, run, folder, path.stem)
    if found.missing:
        warnings.warn(f"{path.name}: what it wants written and is not: {', '.join(found.missing)}.", DeckWarning, stacklevel=2)


def _write(path: pathlib.Path, t: np.ndarray, columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> None:
    lines = [
        "Time".rjust(TIME_WIDTH) + "".join(name.rjust(WIDTH) for name in columns),
        "(s)".rjust(TIME_WIDTH) + "".join(f"({units[name]})".rjust(WIDTH) for name in columns),
    ]
    for time, row in zip(t.tolist(), np.column_stack(list(columns.values())).tolist(), strict=True):
        lines.append(f"{time:{TIME_WIDTH}.4f}" + "".join(f"{x:{WIDTH}.7e}" for x in row))
    write_text(path, "\n".join(lines) + "\n", "A file of channels")


def _unit(name: str) -> str:
    found = POINT.fullmatch(name) or NODE.fullmatch(name)
    return UNITS[found.groups()[-1][0]] if found else "N"


def _unit_of_line(name: str) -> str:
    return {"p": "m", "v": "m/s", "T": "N", "S": "-"}[re.sub(r"^(Node|Seg)\d+", "", name)[0]]


def _channel(name: str, deck: Deck, run: Run) -> np.ndarray | None:
    """Column of a channel; None if there is none."""
    if end := END.fullmatch(name):
        which, number, line, letter = end.groups()
        cable = deck.lines.get(int(number or line))
        at = 0 if which == "ANCHTEN" or letter == "A" else -1
        return None if cable is None else np.linalg.norm(_end_forces(run, cable)[:, at], axis=1)
    if found := POINT.fullmatch(name):
        point = deck.points.get(int(found[1]))
        return None if point is None else _of_point(found[2], point, run)
    if found := NODE.fullmatch(name):
        return _of_line_node(int(found[1]), found[2], found[3], deck, run)
    return None


def _of_line_node(number: int, node: str, what: str, deck: Deck, run: Run) -> np.ndarray | None:
    cable = deck.lines.get(number)
    count = 0 if cable is None else run.scene.cable(cable).segments
    i = 0 if node == "A" else count if node == "B" else int(node)
    if cable is None or i > count:
        return None
    if what[0] in "FT" and i in (0, count):
        force = _end_forces(run, cable)[:, 0 if i == 0 else -1]
        return np.linalg.norm(force, axis=1) if what[0] == "T" else force[:, "XYZ".index(what[1])]
    if what[0] == "T":
        pulls = _pulls(run, cable)
        return np.linalg.norm(0.5 * (pulls[:, i - 1] + pulls[:, i]), axis=1)
    return _of_node(what, run, run.model.nodes(cable)[i])


def _of_point(what: str, point: str, run: Run) -> np.ndarray:
    """Column of a point. On one that does not move freely, or is on a body, acts what its cables bring."""
    kind = run.scene.point(point)
    if what[0] in "PV" or (isinstance(kind, Free) and not isinstance(kind, OnBody)):
        return _of_node(what, run, run.model.node(point))
    force = np.zeros((len(run.t), 3))
    for cable in run.scene.cables:
        for at, end in ((0, cable.start), (1, cable.end)):
            if end == point:
                force += _end_forces(run, cable.name)[:, at]
    return np.linalg.norm(force, axis=1) if what[0] == "T" else force[:, "XYZ".index(what[1])]


def _of_node(what: str, run: Run, node: int) -> np.ndarray:
    if what[0] == "T":
        return np.linalg.norm(_net_forces(run)[:, node], axis=1)
    quantity: Callable[[], np.ndarray] = {"P": lambda: run.q, "V": lambda: run.v, "F": lambda: _net_forces(run)}[what[0]]
    return quantity()[:, node, "XYZ".index(what[1])]


def _line_columns(run: Run, cable: str, letters: str) -> dict[str, np.ndarray]:
    """Columns of a line, in the order of its letters."""
    found: dict[str, np.ndarray] = {}
    whole = run.scene.cable(cable)
    L0 = np.broadcast_to(run.rest_lengths.get(cable, whole.length), run.t.shape)[:, None] / whole.segments
    for letter in dict.fromkeys(letters):
        if letter in "pv":
            rows = run.shape(cable) if letter == "p" else run.v[:, run.model.nodes(cable)]
            found |= {f"Node{i}{letter}{'xyz'[x]}": rows[:, i, x] for i in range(rows.shape[1]) for x in range(3)}
        elif letter in "ts":
            rows = run.tension(cable) if letter == "t" else np.linalg.norm(np.diff(run.shape(cable), axis=1), axis=2) / L0 - 1.0
            found |= {f"Seg{s + 1}{'Te' if letter == 't' else 'St'}": rows[:, s] for s in range(rows.shape[1])}
    return found


def _pulls(run: Run, cable: str) -> np.ndarray:
    """Tension of each segment of a cable as a vector from its start to its end, (k, segments, 3) [N]."""
    d = np.diff(run.shape(cable), axis=1)
    return run.tension(cable)[:, :, None] * d / np.maximum(np.linalg.norm(d, axis=2), 1e-300)[:, :, None]


@lru_cache(maxsize=1)
def _net_forces(run: Run) -> np.ndarray:
    """Force of cables and effects on each node, (k, n, 3) [N]."""
    total = _effect_forces(run.scene, run.model, run.t, run.q, run.v)
    for cable in run.scene.cables:
        nodes, pulls = run.model.nodes(cable.name), _pulls(run, cable.name)
        total[:, nodes[:-1]] += pulls  # a cable passes no node twice
        total[:, nodes[1:]] -= pulls
    return total


def _end_forces(run: Run, name: str) -> np.ndarray:
    """Force of a cable alone on its first and its last node, of tension and of what acts on the half segment, (k, 2, 3) [N]."""
    cable, parts = run.scene.cable(name), rows_of_run(run)
    forces = [[end_force(rows, run.scene, name, end, inertia=False) for rows in parts] for end in (cable.start, cable.end)]
    return np.stack([np.concatenate(of_end) for of_end in forces], axis=1)


def _effect_forces(scene: Scene, model: Any, t: np.ndarray, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Force of all effects of a scene on each node, (k, n, 3) [N]."""
    total = np.zeros_like(q)
    for effect in scene.effects:
        force = effect.kernels().get("force")
        if force is None:
            continue
        index, params = effect.table(model)
        for k, time in enumerate(t.tolist()):
            force(time, np.ascontiguousarray(q[k]), np.ascontiguousarray(v[k]), index, params, total[k])
    return total
