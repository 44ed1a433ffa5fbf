"""Points and edges of mesh files: sides of their surfaces and their lines, each once."""

import contextlib
import io
from collections import Counter
from os import PathLike, fspath
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from anet_lumped.checks import SceneError, quoted

__all__ = ["FileMesh", "read_mesh"]

# Nodes around a cell, by the kinds of meshio; those of second order have nodes in the middle of sides behind the corners.
AROUND = {
    "triangle": (0, 1, 2), "quad": (0, 1, 2, 3), "triangle6": (0, 3, 1, 4, 2, 5),
    "quad8": (0, 4, 1, 5, 2, 6, 3, 7), "quad9": (0, 4, 1, 5, 2, 6, 3, 7),
}  # fmt: skip
ALONG = {"line": (0, 1), "line3": (0, 2, 1)}
SAME = 1e-6  # of the size of a mesh: points nearer to each other are one. CAD programs write corners once for each surface.


class FileMesh(NamedTuple):
    """Points and edges of a mesh file.

    Attributes
    ----------
    places : (n, 3) float64, in units of the file
    one_of : (n,) int64, of each point the first one that is at its place
    edges : list of (a, b), each once, of first points
    rim : list of (a, b), the edges of one surface alone
    """

    places: np.ndarray
    one_of: np.ndarray
    edges: list[tuple[int, int]]
    rim: list[tuple[int, int]]


def read_mesh(path: str | PathLike[str]) -> FileMesh:
    """Read a mesh file: .obj files here, with lines and polygons, which meshio leaves out, and others by meshio.

    Raises
    ------
    ImportError : meshio is not installed, and the file is no .obj file
    SceneError : no such file, one that cannot be read, one without lines and surfaces, one with cells that are neither
    """
    name = fspath(path)
    places, rings, lines = _of_obj(name) if Path(name).suffix.lower() == ".obj" else _of_meshio(name)
    if not np.isfinite(places).all():
        raise SceneError(f"Points of a mesh file must be finite, but {quoted(name)} has others.")
    one_of = _first_at(places)
    sides = Counter(edge for ring in rings for edge in _joined(one_of[[*ring, ring[0]]]))
    edges = dict.fromkeys(sides) | dict.fromkeys(edge for line in lines for edge in _joined(one_of[list(line)]))
    return FileMesh(places, one_of, list(edges), [edge for edge, count in sides.items() if count == 1])


def _joined(points: np.ndarray) -> set[tuple[int, int]]:
    """Edges from each point to the next; points that are the same have none."""
    return {(min(a, b), max(a, b)) for a, b in zip(points[:-1].tolist(), points[1:].tolist(), strict=True) if a != b}


def _first_at(places: np.ndarray) -> np.ndarray:
    """Of each point the first one at its place, (n,) int64."""
    near = cKDTree(places).query_pairs(SAME * float(np.ptp(places, axis=0).max()), output_type="ndarray")
    count = len(places)
    joined = coo_array((np.ones(len(near)), (near[:, 0], near[:, 1])), shape=(count, count))
    group = connected_components(joined, directed=False)[1]
    return np.unique(group, return_index=True)[1][group]


def _of_meshio(name: str) -> tuple[np.ndarray, list, list]:
    """Places, rings of points around surfaces, and lines of points of a file that meshio reads."""
    import meshio

    said = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(said),
            contextlib.redirect_stderr(said),
        ):  # some of its readers print what is wrong, and exit
            mesh = meshio.read(name)
    except (Exception, SystemExit) as error:  # of readers of some thirty formats
        why = " ".join(said.getvalue().split()) or str(error)
        raise SceneError(f"A mesh file must be one that meshio reads, but of {quoted(name)} it says: {why}") from None
    rings: list = []
    lines: list = []
    strange: list[str] = []
    for block in mesh.cells:
        if block.type in AROUND or block.type == "polygon":
            around = AROUND.get(block.type, slice(None))
            rings += [np.asarray(cell)[list(around) if isinstance(around, tuple) else around].tolist() for cell in block.data]
        elif block.type in ALONG:
            lines += block.data[:, list(ALONG[block.type])].tolist()
        elif block.type != "vertex":
            strange.append(block.type)
    _check(rings, lines, strange or sorted({block.type for block in mesh.cells}), bool(strange), name)
    places = np.zeros((len(mesh.points), 3))
    places[:, : mesh.points.shape[1]] = mesh.points  # those of a plane have two numbers
    return places, rings, lines


def _of_obj(name: str) -> tuple[np.ndarray, list, list]:
    """Places, rings and lines of a Wavefront file: ``v``, ``f`` and ``l``; its numbers count from 1, or back from the last."""
    try:
        text = Path(name).read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise SceneError(f"A mesh file must be one that can be read, but of {quoted(name)} it says: {error.strerror}.") from None
    places: list[list[float]] = []
    cells: dict[str, list] = {"f": [], "l": []}
    for number, line in enumerate(text.replace("\\\n", " ").splitlines(), 1):
        word, *rest = line.split("#")[0].split() or [""]
        right = word != "v" and word not in cells
        with contextlib.suppress(ValueError):  # what is no number is not right
            if word == "v":
                places.append([float(x) for x in rest[:3]])
                right = len(rest) >= 3
            elif word in cells:
                given = [int(item.split("/")[0]) for item in rest]
                cell = [k - 1 if k > 0 else len(places) + k for k in given]
                right = len(cell) > 1 and 0 not in given and all(0 <= k < len(places) for k in cell)
                cells[word].append(cell)
        if not right:
            what = f"Line {number} of {quoted(name)}"
            raise SceneError(f"{what} must be a point, a face or a line, but is {quoted(line.strip())}.")
    _check(cells["f"], cells["l"], ["points alone"] if places else ["none"], False, name)
    return np.array(places), cells["f"], cells["l"]


def _check(rings: list, lines: list, kinds: list[str], strange: bool, name: str) -> None:
    """Refuse files of which no net can be made, or not all of one."""
    if strange or not (rings or lines):
        wanted = "lines, triangles, quadrilaterals or polygons"
        raise SceneError(f"A mesh file must have {wanted}, but {quoted(name)} has {', '.join(kinds) or 'none'}.")
