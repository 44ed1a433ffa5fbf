"""Measured marker positions against the lumped model: read, sequence along the cables, fit, report.

A motion-capture file holds a cloud of points: rows in any order, some of them reflections that belong to nothing, some
markers hidden. The model's own resting shape is what puts them in order: each marker belongs to the cable it is nearest
to, at the arc length of its nearest point. Where the cables' lengths are wrong the order is right long before the shape
is, so that lengths can be fitted and the markers sequenced anew until nothing changes.

The markers must be in the scene's frame (same axes, z up): a turned one cannot be told from the cloud, since nets are
symmetric. `MarkerFit.offset` shows a shifted one.
"""

import csv
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from anet_lumped.checks import InputError, shown
from anet_lumped.files.measured_series import OF_MOTION, capture_of, holds_tracks, read_tracks
from anet_lumped.limits import BYTES, check_most
from anet_lumped.regular_files import read_text
from anet_lumped.results.sag import below_chord
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene, check_scene
from anet_lumped.statics.equilibrium import EquilibriumError, equilibrium

from .compare import project, r_squared, rmse

MEDIAN_OF_RAYLEIGH = math.sqrt(2 * math.log(2))  # median distance from a curve over the deviation of one coordinate
CUT = 5.0  # a true marker lies beyond 5 sigma once in 270,000 (Rayleigh), with sigma a tenth too small once in 25,000
FAR = 0.15  # of the longest cable: no sequence means anything with markers so far off
LARGEST = 1e9  # [m or mm], beyond which no marker is and no square of a distance loses the others
DISTANCES = 120  # bytes for each marker and segment, of the distances between them
LEAST_MARKERS = 3  # fewer cannot show a curve's length


class MarkerError(InputError):
    """A marker file that cannot be read, or markers that do not belong to the scene."""


@dataclass(frozen=True)
class Markers:
    """Measured points.

    Attributes
    ----------
    xyz : (m, 3) float64 [m]
    unit : the unit that the file was taken to be in
    empty_rows : int, rows without a position
    names : (m,) of str, those of the file, or the number of each one's line
    spread : (m,) float64 [m] or None
        Of tracks, of which `xyz` are the medians over time: root mean square distance from these.
    """

    xyz: np.ndarray
    unit: str
    empty_rows: int = 0
    names: tuple[str, ...] = ()
    spread: np.ndarray | None = None


@dataclass(frozen=True)
class Sequence:
    """Where each marker sits on the cables.

    Attributes
    ----------
    cable : (m,) int
        Index into `scene.cables` of the nearest cable, -1 for an outlier.
    arc : (m,) float64 [m]
        Unstretched arc length from the cable's start to the nearest point.
    nearest : (m, 3) float64 [m]
        That point of the model.
    distance : (m,) float64 [m]
    sigma : float [m]
        Robust standard deviation of one coordinate.
    """

    cable: np.ndarray
    arc: np.ndarray
    nearest: np.ndarray
    distance: np.ndarray
    sigma: float

    def along(self, cable: int) -> np.ndarray:
        """Row numbers of the cable's markers in the order of arc length."""
        rows = np.flatnonzero(self.cable == cable)
        return rows[np.argsort(self.arc[rows])]


@dataclass(frozen=True)
class CableMatch:
    """One cable of the model against its markers, before and after the fit; lengths in metres, tensions in newtons.

    `rmse` is over the distance to the cable. Y of `r_squared` is one coordinate (x, y, z in turn), its mean that of the
    measured values; NaN where the markers do not spread in it. `length` is unstretched. `covered` is the arc from the
    first to the last marker. `missing` counts the gaps in a regular spacing, None where there is none.
    """

    cable: str
    markers: int
    missing: int | None
    covered: tuple[float, float]
    largest_gap: float
    rmse_before: float
    rmse_after: float
    r_squared_before: tuple[float, ...]
    r_squared_after: tuple[float, ...]
    length_before: float
    length_after: float
    length_standard_error: float
    sag_measured: float
    sag_before: float
    sag_after: float
    tension_before: float
    tension_after: float


@dataclass(frozen=True)
class MarkerFit:
    """A scene fitted to markers.

    Attributes
    ----------
    scene : Scene
        With the fitted lengths.
    before, after : State
        The model at rest, as given and as fitted.
    sequence : Sequence
        Of the markers on the fitted model.
    cables : list of CableMatch
    outliers : int
    offset : (3,) float64 [m]
        The common shift of the markers that would fit them best, together with the lengths; it is not taken off. Far
        from zero if the markers' frame is not the scene's.
    xyz : (m, 3) float64 [m]
        The markers.
    """

    scene: Scene
    before: State
    after: State
    sequence: Sequence
    cables: list[CableMatch]
    outliers: int
    offset: np.ndarray
    xyz: np.ndarray

    @property
    def residuals(self) -> np.ndarray:
        """Each marker's place less the nearest point of the fitted model, (m, 3) [m]."""
        return self.xyz - self.sequence.nearest

    def plot(self) -> Any:
        """Figure of the model before and after the fit with the markers, and of their distances along each cable."""
        from anet_lumped.views.marker_figure import plot_markers

        return plot_markers(self)


def read_markers(path: str | Path, scene: Scene, unit: str | None = None, up: str | None = None) -> Markers:
    """Read a CSV file of marker positions, or tracks of markers that stand still.

    A header names the columns x, y and z, in any order; other columns are left alone, rows may come in any order, and
    a row with an empty or NaN coordinate counts as a hidden marker. Without `unit`, the size of the cloud beside that
    of the scene tells metres from millimetres. Of tracks (`files.measured_series`: Motive, Nexus, TRC, NPZ) the median over time
    of each marker is taken, in the unit that the file says.

    Parameters
    ----------
    path : str or Path
    scene : Scene
        In metres.
    unit : "m", "mm" or None
    up : "y", "z" or None, the axis of a file of tracks that points up; None: y of a Motive export, z of all others

    Returns
    -------
    Markers

    Raises
    ------
    MarkerError
        No regular file of CSV in UTF-8; no header with x, y and z, a cell that is not a number or is beyond 1e9, no markers, or a
        cloud of neither size.
    """
    if unit not in (None, "m", "mm"):
        raise MarkerError(f'The unit of markers must be "m" or "mm", but unit={shown(unit)} was given.')
    packed = Path(str(path)).suffix.lower() in OF_MOTION
    text = "" if packed else read_text(path, "A marker file", MarkerError)
    if packed or holds_tracks(path):
        return _standing(path, up)
    rows = csv.reader(text.splitlines(keepends=True))
    try:
        header = [name.strip().lower() for name in next(rows, [])]
        if any(header.count(name) != 1 for name in "xyz"):
            raise MarkerError(
                "A marker file must have a first line, with commas, of one x, one y and one z, or over time of t, NAME.x, NAME.y "
                f"and NAME.z, but {path} has {shown(header)}."
            )
        columns = [header.index(name) for name in "xyz"]
        cells = [_row(row, columns, f"{path}, line {rows.line_num}") for row in rows if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise MarkerError(f"A marker file must be a table in CSV, but {path}, line {rows.line_num}, is not: {error}.") from None
    xyz = np.array(cells, dtype=float).reshape(-1, 3)
    seen = np.isfinite(xyz).all(axis=1)
    if not seen.any():
        raise MarkerError(f"A marker file needs at least one row with x, y and z, but {path} has none.")
    xyz, unit = _in_metres(xyz[seen], scene, unit, path)
    return Markers(xyz, unit, int((~seen).sum()), tuple(f"row {k + 1}" for k in np.flatnonzero(seen)))


def _standing(path: str | Path, up: str | None) -> Markers:
    """Markers at the medians of their tracks."""
    capture = capture_of(path, up)
    tracks = read_tracks(path, up).channels if capture is None else capture.markers
    xyz = np.array([np.nanmedian(track, axis=0) for track in tracks.values()])
    spread = [math.sqrt(np.nanmean(((track - place) ** 2).sum(axis=1))) for track, place in zip(tracks.values(), xyz, strict=True)]
    return Markers(xyz, "m" if capture is None else capture.unit, 0, tuple(tracks), np.array(spread))


def _row(row: list[str], columns: list[int], where: str) -> list[float]:
    cells = [row[column].strip() if column < len(row) else "" for column in columns]
    try:
        numbers = [float(cell) if cell else math.nan for cell in cells]
    except ValueError:
        raise MarkerError(f"A marker's x, y and z must be numbers, but {where} has {shown(cells)}.") from None
    if any(abs(number) > LARGEST for number in numbers):
        raise MarkerError(f"A marker's x, y and z must not be beyond {LARGEST:g}, but {where} has {shown(cells)}.")
    return numbers


def _in_metres(xyz: np.ndarray, scene: Scene, unit: str | None, path: str | Path) -> tuple[np.ndarray, str]:
    if unit is None:
        # Medians, because one stray point must not decide the unit.
        cloud = np.median(np.linalg.norm(xyz - np.median(xyz, axis=0), axis=1))
        size = scene.longest
        if 0.02 * size <= cloud <= 20 * size:
            unit = "m"
        elif 20 * size < cloud <= 20e3 * size:
            unit = "mm"
        else:
            raise MarkerError(
                f"The markers must be in metres or millimetres, but those of {path} lie {cloud:.3g} from their middle, "
                f'and the longest cable is {size:.3g} m: give unit="m" or unit="mm".'
            )
    return xyz * {"m": 1.0, "mm": 1e-3}[unit], unit


def sequence(xyz: np.ndarray, state: State) -> Sequence:
    """Sequence markers: to the nearest cable, in the order of arc length, outliers set apart.

    The distance of a marker from its curve has two independent coordinates, so that sigma = median / sqrt(2 ln 2),
    which up to half of the markers cannot spoil. An outlier is a marker beyond 5 sigma and the rise of a smooth curve
    over the model's straight segments.

    Parameters
    ----------
    xyz : (m, 3) float64 [m]
    state : State
        The model at rest.

    Returns
    -------
    Sequence
    """
    shapes = [state.shape(cable.name) for cable in state.scene.cables]
    on = [project(xyz, shape) for shape in shapes]
    distance = np.array([distance for distance, _, _ in on])
    cable = distance.argmin(axis=0)
    rows = np.arange(len(xyz))
    spacing = np.array([cable.length / cable.segments for cable in state.scene.cables])
    arc = np.array([place for _, place, _ in on])[cable, rows] * spacing[cable]
    nearest = np.array([nearest for _, _, nearest in on])[cable, rows]
    distance = distance[cable, rows]
    # Numbers written with nine digits need no finer scale.
    sigma = max(float(np.median(distance)) / MEDIAN_OF_RAYLEIGH, 1e-9 * np.abs(xyz).max())
    rise = [np.linalg.norm(np.diff(shape, 2, axis=0), axis=1).max(initial=0.0) / 8 for shape in shapes]
    return Sequence(np.where(distance > CUT * sigma + max(rise), -1, cable), arc, nearest, distance, sigma)


def fit_markers(xyz: ArrayLike, scene: Scene) -> MarkerFit:
    """Fit the length of each cable to measured markers, and compare the model with them before and after.

    Minimises over the lengths the sum of |x_i - c_i|^2 over the markers that are no outliers, c_i the nearest point of
    the marker's cable in equilibrium; then the markers are sequenced anew on the fitted model, outliers included, until
    none changes its cable or its side of the cut. Supports are taken as given: moving one along its cable cannot be
    told from a change of length. A cable with fewer than three markers keeps its length.

    Parameters
    ----------
    xyz : (m, 3) float64 [m]
        In the scene's frame, in any order, with outliers.
    scene : Scene
        As built: its lengths are where the fit starts.

    Returns
    -------
    MarkerFit

    Raises
    ------
    MarkerError
        Fewer than three markers on every cable, or markers that lie far from all cables.
    """
    check_scene(scene)
    xyz = np.asarray(xyz, dtype=float)
    segments = max(cable.segments for cable in scene.cables)
    check_most(BYTES, float(DISTANCES * len(xyz) * segments), f"A fit of {segments} segments to {len(xyz)} markers")
    before = equilibrium(scene)
    state, order = before, sequence(xyz, before)
    met = set()
    while order.cable.tobytes() not in met:  # a marker on the edge of the cut may come and go for ever
        met.add(order.cable.tobytes())
        fitted = [i for i in range(len(scene.cables)) if (order.cable == i).sum() >= LEAST_MARKERS]
        if not fitted:
            raise MarkerError(
                f"A fit needs at least three markers on one cable, but of the {len(xyz)} given the fullest has "
                f"{max((order.cable == i).sum() for i in range(len(scene.cables)))}."
            )
        state, errors, _ = _fit_lengths(xyz, state, order, fitted)
        order = sequence(xyz, state)
    longest = scene.longest
    if order.sigma > FAR * longest:
        raise MarkerError(
            f"Markers must lie along the cables (longest {longest:.3g} m), but after the fit half are more than "
            f"{order.sigma * MEDIAN_OF_RAYLEIGH:.3g} m away: are they in the scene's frame?"
        )
    fitted = [i for i in fitted if (order.cable == i).any()]
    *_, offset = _fit_lengths(xyz, state, order, fitted, shifted=True)
    return MarkerFit(
        state.scene,
        before,
        state,
        order,
        [_match(xyz, before, state, order, i, errors.get(i, math.nan)) for i in range(len(scene.cables))],
        int((order.cable < 0).sum()),
        offset,
        xyz,
    )


def _fit_lengths(
    xyz: np.ndarray, state: State, order: Sequence, fitted: list[int], shifted: bool = False
) -> tuple[State, dict[int, float], np.ndarray]:
    """Fitted state, standard error of each fitted length [m] by cable, and the shift (3,) [m] if that is fitted too."""
    scene = state.scene
    start = np.array([scene.cables[i].length for i in fitted])
    n, size = len(start), start.max()
    rows = [(cable, order.along(i)) for i, cable in enumerate(scene.cables)]

    def residual(unknowns: np.ndarray) -> np.ndarray:
        shape = _rest(_with_lengths(scene, fitted, start * unknowns[:n]))
        if shape is None:
            return np.full(3 * sum(len(row) for _, row in rows), 1e3 * order.sigma)
        seen = xyz - size * (unknowns[n:] - 1) if shifted else xyz
        return np.concatenate([seen[row] - project(seen[row], shape.shape(cable.name))[2] for cable, row in rows]).ravel()

    # Steps of 1e-5 stand far above what a force residual of 1e-10 leaves open in the positions.
    found = least_squares(residual, np.ones(n + 3 * shifted), bounds=(0.5, 2.0), diff_step=1e-5, xtol=1e-7)
    errors = dict(zip(fitted, start * _standard_errors(found)[:n], strict=True))
    return equilibrium(_with_lengths(scene, fitted, start * found.x[:n])), errors, size * (found.x[n:] - 1)


def _standard_errors(found: Any) -> np.ndarray:
    """sqrt of the diagonal of s^2 (J^T J)^-1, with s^2 the mean square over the two free coordinates of each marker."""
    degrees = 2 * len(found.fun) // 3 - len(found.x)
    if degrees <= 0:
        return np.full(len(found.x), math.nan)
    variance = found.fun @ found.fun / degrees
    return np.sqrt(variance * np.diag(np.linalg.pinv(found.jac.T @ found.jac)))


def _rest(scene: Scene) -> State | None:
    try:
        return equilibrium(scene)
    except EquilibriumError:
        return None


def _with_lengths(scene: Scene, which: list[int], lengths: np.ndarray) -> Scene:
    cables = list(scene.cables)
    for i, length in zip(which, lengths, strict=True):
        cables[i] = replace(cables[i], length=float(length))
    return replace(scene, cables=tuple(cables))


def _match(xyz: np.ndarray, before: State, after: State, order: Sequence, i: int, error: float) -> CableMatch:
    cable = after.scene.cables[i]
    rows = order.along(i)
    seen, arc = xyz[rows], order.arc[rows]
    shapes = [state.shape(cable.name) for state in (before, after)]
    ends = [shape[[0, -1]] for shape in shapes]
    model = [project(seen, shape)[2] for shape in shapes]
    up = -after.scene.gravity / np.linalg.norm(after.scene.gravity)
    gaps = np.diff(np.concatenate(([0.0], arc, [cable.length])))
    return CableMatch(
        cable.name,
        markers=len(rows),
        missing=_missing(gaps[1:-1]),
        covered=(float(arc[0]), float(arc[-1])) if len(rows) else (math.nan, math.nan),
        largest_gap=float(gaps.max()),
        rmse_before=rmse(seen, model[0]),
        rmse_after=rmse(seen, model[1]),
        r_squared_before=tuple(r_squared(seen[:, j], model[0][:, j]) for j in range(3)),
        r_squared_after=tuple(r_squared(seen[:, j], model[1][:, j]) for j in range(3)),
        length_before=before.scene.cables[i].length,
        length_after=cable.length,
        length_standard_error=error,
        sag_measured=float(below_chord(seen, ends[1][0], ends[1][1], up).max()) if len(rows) else math.nan,
        sag_before=float(below_chord(shapes[0], ends[0][0], ends[0][1], up).max()),
        sag_after=float(below_chord(shapes[1], ends[1][0], ends[1][1], up).max()),
        tension_before=float(before.tension(cable.name).max()),
        tension_after=float(after.tension(cable.name).max()),
    )


def _missing(gaps: np.ndarray) -> int | None:
    """Markers hidden between the first and the last, from gaps that are whole multiples of a spacing; else None."""
    if len(gaps) < 4:
        return None
    spacing = float(np.median(gaps))
    if spacing <= 0:  # markers on one another
        return None
    counts = np.rint(gaps / spacing)
    if np.median(np.abs(gaps / spacing - counts)) > 0.15:
        return None
    return int(np.maximum(counts - 1, 0).sum())
