"""Measured tensions and marker positions over time, from CSV, NPZ, TRC and C3D files.

* CSV: a header with `t`, and columns over it. Tensions [N]: a column for each cable. Markers [m]: `NAME.x`, `NAME.y`, `NAME.z`. An
  empty cell or NaN is a sample that is missing.
* NPZ (`numpy.savez`): an array `t` (k,), and one for each cable (k,) or marker (k, 3), by its name.
* TRC, the text of motion capture: markers only, in the unit that its third line says; its axes are those of the scene, unless
  ``up`` says that its y points up.
* C3D, of motion capture too: markers only, in the unit that it says, from t = 0 on; read by the package c3d, the extra `c3d`.
* CSV as OptiTrack's Motive and Vicon's Nexus export it, see `motion_capture`.
"""

import csv
import io
import math
import warnings
import zipfile
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from anet_lumped.checks import InputError, quoted, shown
from anet_lumped.limits import BYTES, check_most
from anet_lumped.regular_files import read_bytes, read_text

from .motion_capture import METRES, Capture, SeriesError, is_capture, read_capture, z_up

TIME = "t"
AXES = ".x", ".y", ".z"
TRC_HEAD = 5  # lines above the numbers
ENDINGS = ".csv", ".npz", ".trc", ".c3d"
OF_MOTION = ".npz", ".trc", ".c3d"


@dataclass(frozen=True)
class Series:
    """Samples of channels over time.

    Parameters
    ----------
    t : (k,) float64 [s], which grows
    channels : by name (k, d) float64, NaN where a sample is missing; d = 1 for a tension [N], 3 for a marker [m]
    """

    t: np.ndarray
    channels: dict[str, np.ndarray]


def read_tensions(path: str | PathLike[str]) -> Series:
    """Read measured tensions over time; see the module.

    Raises
    ------
    SeriesError : no such file, no time, no channel, times that do not grow, or what is not a number
    """
    what, ending = "A file of tensions", _ending(path, (".csv", ".npz"), "A file of tensions")
    t, columns = _csv(path, what) if ending == ".csv" else _npz(path, what)
    wide = [name for name, values in columns.items() if values.ndim != 1]
    if wide:
        raise SeriesError(f"A tension must be one number a sample, but {path} has {quoted(wide[0])} of {columns[wide[0]].shape}.")
    return _series(t, {name: values[:, None] for name, values in columns.items()}, path, what)


def read_tracks(path: str | PathLike[str], up: str | None = None) -> Series:
    """Read measured marker positions over time; see the module.

    Parameters
    ----------
    path : str or pathlib.Path
    up : "y", "z" or None, the axis of the file that points up; None: y of a Motive export, z of all others

    Raises
    ------
    SeriesError : as `read_tensions`
    """
    what, ending = "A file of marker tracks", _ending(path, ENDINGS, "A file of marker tracks")
    capture = capture_of(path, up)
    if capture is not None:
        return _series(capture.t, capture.markers | capture.bodies, path, what)
    if ending in (".trc", ".c3d"):
        t, channels = _trc(path, what) if ending == ".trc" else _c3d(path, what)
    elif ending == ".npz":
        t, channels = _npz(path, what)
        flat = [name for name, values in channels.items() if values.ndim != 2 or values.shape[1] != 3]
        if flat:
            raise SeriesError(
                f"A marker must have x, y and z a sample, but {path} has {quoted(flat[0])} of {channels[flat[0]].shape}."
            )
    else:
        t, columns = _csv(path, what)
        names = list(dict.fromkeys(column[:-2] for column in columns if column.endswith(AXES)))
        lone = [f"has {quoted(column)}" for column in columns if not column.endswith(AXES)]
        lone += [f"lacks {quoted(name + axis)}" for name in names for axis in AXES if name + axis not in columns]
        if lone:
            raise SeriesError(f"A marker must have columns NAME.x, NAME.y and NAME.z [m], but {path} {lone[0]}.")
        channels = {name: np.column_stack([columns[name + axis] for axis in AXES]) for name in names}
    channels = {name: np.asarray(xyz, float) for name, xyz in channels.items()}
    return _series(t, {name: z_up(xyz, up or "z") for name, xyz in channels.items()}, path, what)


def capture_of(path: str | PathLike[str], up: str | None = None) -> Capture | None:
    """What a motion-capture program exported as CSV; None if the file is no such export.

    Raises
    ------
    SeriesError : as `motion_capture.read_capture`
    """
    if Path(path).suffix.lower() != ".csv":
        return None
    text = read_text(path, "A marker file", SeriesError)
    return read_capture(text, path, up) if is_capture(text) else None


def holds_tracks(path: str | PathLike[str]) -> bool:
    """Whether a file of markers holds positions over time, and not one cloud of points with columns x, y and z."""
    if Path(path).suffix.lower() in OF_MOTION:
        return True
    text = read_text(path, "A marker file", SeriesError)
    if is_capture(text):
        return True
    header = {name.strip().lower() for name in text.split("\n", 1)[0].split(",")}
    return TIME in header and not {"x", "y", "z"} & header


def _ending(path: str | PathLike[str], known: tuple[str, ...], what: str) -> str:
    ending = Path(path).suffix.lower()
    if ending not in known:
        raise SeriesError(f"{what} must end in {', '.join(known)}, but it is {path}.")
    return ending


def _series(t: np.ndarray, channels: dict[str, np.ndarray], path: str | PathLike[str], what: str) -> Series:
    """The series of what was read, if it is one."""
    if not channels:
        raise SeriesError(f"{what} must hold at least one channel besides the time, but {path} has none.")
    if len(t) < 2:
        raise SeriesError(f"{what} must have two samples or more, but {path} has {len(t)}.")
    if not np.isfinite(t).all():
        raise SeriesError(f"Times must be finite numbers, but sample {int(np.isfinite(t).argmin()) + 1} of {path} has none.")
    if (np.diff(t) <= 0.0).any():
        k = int((np.diff(t) <= 0.0).argmax())
        raise SeriesError(f"Times must grow, but in {path} sample {k + 2}, t={t[k + 1]:.10g}, follows t={t[k]:.10g}.")
    for name, values in channels.items():
        if len(values) != len(t):
            raise SeriesError(
                f"A channel must have a sample for each time, but {path} has {len(values)} of {quoted(name)} for {len(t)}."
            )
        if not np.isfinite(values).all(axis=1).any() or np.isinf(values).any():
            raise SeriesError(f"A channel must have finite samples, but {quoted(name)} of {path} has none or infinite ones.")
    return Series(np.asarray(t, float), {name: np.asarray(values, float) for name, values in channels.items()})


def _csv(path: str | PathLike[str], what: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    rows = csv.reader(read_text(path, what, SeriesError).splitlines(keepends=True))
    try:
        header = [name.strip() for name in next(rows, [])]
        if header.count(TIME) != 1 or len(set(header)) < len(header):
            raise SeriesError(f"{what} must have a header with one t and no name twice, but {path} has {shown(header)}.")
        table = [_numbers(row, len(header), f"{path}, line {rows.line_num}") for row in rows if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise SeriesError(f"{what} must be a table in CSV, but {path}, line {rows.line_num}, is not: {error}.") from None
    columns = dict(zip(header, np.array(table, float).reshape(-1, len(header)).T, strict=True))
    return columns.pop(TIME), columns


def _numbers(cells: list[str], width: int, where: str) -> list[float]:
    """Numbers of a row, NaN for an empty cell; cells that are left out at its end are empty."""
    if len(cells) > width:
        raise SeriesError(f"A row must have {width} cells at most, as the header has, but {where} has {len(cells)}.")
    try:
        found = [float(cell) if cell.strip() else math.nan for cell in cells]
    except ValueError:
        raise SeriesError(f"Samples must be numbers, but {where} has {shown(cells)}.") from None
    return found + [math.nan] * (width - len(cells))


def _npz(path: str | PathLike[str], what: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    content = io.BytesIO(read_bytes(path, what, BYTES, SeriesError))
    try:
        with zipfile.ZipFile(content) as packed:
            check_most(BYTES, float(sum(one.file_size for one in packed.infolist())), f"{what}, {path},")
        with np.load(content, allow_pickle=False) as arrays:
            found = {name: np.asarray(arrays[name], float) for name in arrays.files}
    except (zipfile.BadZipFile, ValueError, OSError, EOFError, KeyError) as error:
        if isinstance(error, InputError):
            raise
        raise SeriesError(f"{what} must be an NPZ file of plain numbers, but {path} is not: {error}.") from None
    if TIME not in found or any(values.ndim == 0 for values in found.values()) or found[TIME].ndim != 1:
        raise SeriesError(f"{what} must hold an array t (k,) and arrays of as many samples, but {path} has {shown(sorted(found))}.")
    return found.pop(TIME), found


def _trc(path: str | PathLike[str], what: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    lines = read_text(path, what, SeriesError).split("\n")
    if len(lines) <= TRC_HEAD or not lines[0].startswith("PathFileType"):
        raise SeriesError(f"{what} must begin with PathFileType, as TRC does, and hold rows below five lines, but {path} does not.")
    about = dict(zip(lines[1].split("\t"), lines[2].split("\t"), strict=False))
    unit = about.get("Units", "").strip().lower()
    if unit not in METRES:
        raise SeriesError(f"A TRC file must have Units of m, cm or mm in its third line, but {path} has {quoted(unit)}.")
    names = [name.strip() for name in lines[3].split("\t")[2:] if name.strip()]
    width = 2 + 3 * len(names)
    rows = []
    for number, line in enumerate(lines[TRC_HEAD:], TRC_HEAD + 1):
        cells = line.rstrip().split("\t")
        if any(cells):
            rows.append(_numbers(cells, width, f"{path}, line {number}"))
    table = np.array(rows, float).reshape(-1, width)
    places = METRES[unit] * table[:, 2:].reshape(len(table), -1, 3)
    return table[:, 1], {name: places[:, k] for k, name in enumerate(names)}


def _c3d(path: str | PathLike[str], what: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    try:
        import c3d
    except ImportError:
        raise SeriesError("C3D files are read by the package c3d: pip install 'anet-lumped[c3d]', or export TRC or CSV.") from None
    content = io.BytesIO(read_bytes(path, what, BYTES, SeriesError))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that a file of markers has no analog channels
            reader = c3d.Reader(content)
            names, rate, units = (
                [label.strip() for label in reader.point_labels],
                float(reader.point_rate),
                reader.get("POINT:UNITS"),
            )
            unit = units.string_value.strip(" \0").lower() if units else ""
            frames = np.array([points[:, :4] for _, points, _ in reader.read_frames()], float)
    except Exception as error:  # whatever the package meets in a file that is damaged
        raise SeriesError(f"{what} must be a C3D file, but {path} cannot be read: {type(error).__name__}: {error}.") from None
    if unit not in METRES:
        raise SeriesError(f"A C3D file must have POINT:UNITS of m, cm or mm, but {path} has {quoted(unit)}.")
    if not rate > 0.0 or len(set(names)) < len(names) or frames.ndim != 3 or frames.shape[1] < len(names):
        raise SeriesError(f"A C3D file must have a rate, and a name of its own for each marker, but {path} has {shown(names)}.")
    places = np.where(frames[:, :, 3:] < 0.0, math.nan, METRES[unit] * frames[:, :, :3])  # a residual below 0 is a marker not seen
    return np.arange(len(frames)) / rate, {name: places[:, k] for k, name in enumerate(names) if name}
