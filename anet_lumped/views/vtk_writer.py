"""Run → files of VTK's XML, which ParaView opens: a `.vtp` (PolyData) for each saved state, and a `.pvd` that gives their times.

Each segment that holds is a line of two nodes, with its tension, strain, cable and segment as cell data; each point of the scene
is a vertex, whose tension and strain are NaN and whose cable and segment are -1. Nodes have velocities, and the number of their
point or -1. The names of cables and points are field data. Numbers are base64 of their bytes.

Source: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import base64
import os
import pathlib
from os import PathLike
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from anet_lumped.checks import NAMED, InputError, one_line, shown
from anet_lumped.regular_files import check_target, write_text

from .motion import broken_at, strain

NAME = "run.pvd"
KINDS = {"f8": "Float64", "i8": "Int64"}
HEAD = '<?xml version="1.0"?>\n<VTKFile type="{}" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'


def save_vtk(run: Any, folder: str | PathLike[str]) -> pathlib.Path:
    """Write a run as `run.pvd` and its states into a folder, which is made if there is none; return the `.pvd`.

    Raises
    ------
    InputError : no path of a folder
    """
    if not isinstance(folder, str | PathLike) or not os.fspath(folder):
        raise InputError(f"A VTK series must be given the path of a folder, but it is {shown(folder)}.")
    if os.path.exists(folder) and not os.path.isdir(folder):
        named = one_line(os.fsdecode(folder), NAMED)
        raise InputError(f"A VTK series must be written to a folder, but {named} is a file.")
    return write_pvd(run, pathlib.Path(os.fsdecode(folder)) / NAME)


def write_pvd(run: Any, path: str | PathLike[str]) -> pathlib.Path:
    """Write a run as a `.pvd`, and its states into the folder beside it that has its name; return the `.pvd`.

    States that are not finite, of a run that diverged, are left out.

    Raises
    ------
    InputError : another ending than .pvd, or no file can be there
    """
    check_target(path, "A VTK series")
    file = pathlib.Path(os.fsdecode(path))
    if file.suffix.lower() != ".pvd":
        raise InputError(f"A VTK series must be written to a file that ends in .pvd, but it is {shown(str(file))}.")
    states = file.with_suffix("")
    states.mkdir(parents=True, exist_ok=True)
    rows = [k for k in range(len(run.t)) if np.isfinite(run.q[k]).all()]
    lines, broke = [], broken_at(run)
    for k in rows:
        state = states / f"{file.stem}_{k:0{len(str(rows[-1]))}}.vtp"
        write_text(state, vtp_text(run, k, broke >= run.t[k]), "A state")
        lines.append(f'<DataSet timestep="{float(run.t[k])!r}" part="0" file={quoteattr(f"{states.name}/{state.name}")}/>\n')
    # The list comes last, so that no reader finds a state in it that is not there yet.
    write_text(file, f"{HEAD.format('Collection')}<Collection>\n{''.join(lines)}</Collection>\n</VTKFile>\n", "A VTK series")
    return file


def vtp_text(run: Any, k: int, holds: np.ndarray) -> str:
    """Return the text of the `.vtp` of one saved state.

    Parameters
    ----------
    run : Run
    k : number of the state
    holds : (n_segments,) bool, segments that have not broken
    """
    model, scene = run.model, run.scene
    ends, points = model.ends[holds], [model.node(point.name) for point in scene.points]
    segment = np.empty(model.n_segments, np.int64)
    for cable in scene.cables:
        segment[model.segments(cable.name)] = np.arange(cable.segments)
    point_of = np.full(model.n, -1)
    point_of[points] = np.arange(len(points))
    none, vertices = np.full(len(points), np.nan), np.full(len(points), -1)
    cells = {
        "tension": np.r_[none, run.segment_tension[k][holds]],
        "strain": np.r_[none, strain(run, k)[holds]],
        "cable": np.r_[vertices, model.cable_of[holds]],
        "segment": np.r_[vertices, segment[holds]],
    }
    nodes = {"velocity": run.v[k], "point": point_of}
    fields = [_array("TimeValue", np.array([run.t[k]]), tuples=1)]
    fields += [_names("cables", scene.cables), _names("points", scene.points)]
    return "".join(
        (
            HEAD.format("PolyData"),
            "<PolyData>\n",
            f"<FieldData>\n{''.join(fields)}</FieldData>\n",
            f'<Piece NumberOfPoints="{model.n}" NumberOfVerts="{len(points)}" NumberOfLines="{len(ends)}" NumberOfStrips="0" '
            'NumberOfPolys="0">\n',
            f'<PointData Vectors="velocity">\n{"".join(_array(*one) for one in nodes.items())}</PointData>\n',
            f'<CellData Scalars="tension">\n{"".join(_array(*one) for one in cells.items())}</CellData>\n',
            f"<Points>\n{_array('Points', run.q[k])}</Points>\n",
            _cells("Verts", np.array(points, np.int64).reshape(-1, 1)),
            _cells("Lines", ends),
            "</Piece>\n</PolyData>\n</VTKFile>\n",
        )
    )


def _cells(name: str, nodes: np.ndarray) -> str:
    """Cells (m, nodes of each) as their nodes one after the other, and where each cell ends."""
    offsets = nodes.shape[1] * np.arange(1, len(nodes) + 1)
    return f"<{name}>\n{_array('connectivity', nodes.ravel())}{_array('offsets', offsets)}</{name}>\n"


def _array(name: str, values: np.ndarray, tuples: int | None = None) -> str:
    """An array as base64 of its size in bytes and its bytes; fields say how many tuples they have."""
    values = np.ascontiguousarray(values, "<f8" if values.dtype.kind == "f" else "<i8")
    content = base64.b64encode(np.array([values.nbytes], "<u8").tobytes() + values.tobytes()).decode()
    size = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    size += "" if tuples is None else f' NumberOfTuples="{tuples}"'
    return f'<DataArray type="{KINDS[values.dtype.str[1:]]}" Name="{name}"{size} format="binary">{content}</DataArray>\n'


def _names(name: str, named: Any) -> str:
    """Names of points or cables as VTK writes strings: the bytes of each, and a zero."""
    content = " ".join(str(byte) for one in named for byte in (*one.name.encode(), 0))
    return f'<Array type="String" Name="{name}" NumberOfTuples="{len(named)}" format="ascii">{content}</Array>\n'
