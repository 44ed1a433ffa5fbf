"""A run as a film: an animated GIF, or an MP4 where the program ffmpeg is there."""

import os
import pathlib
from os import PathLike
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, printable, shown
from anet_lumped.regular_files import check_target, whole_file

from . import colours
from .boxes import box_edges
from .motion import Motion, kind_of, motion_of
from .outlines import outline
from .surroundings import surroundings

GIF, MP4 = ".gif", ".mp4"
RATE = {GIF: 12.5, MP4: 25.0}  # pictures a second; a GIF counts in hundredths of one
SECONDS = (2.0, 12.0)  # that a film lasts: a shorter motion is shown slower, a longer one faster
NAMED = 12  # points, up to which their names are written
INCHES, DPI = (5.4, 4.0), 100
NOTHING = np.full((1, 2, 3), np.nan)  # a segment that is not seen: matplotlib takes no empty collection of them


def write_film(run: Any, path: str | PathLike[str]) -> pathlib.Path:
    """Write a run as an animated picture, at its own pace if it lasts some seconds.

    Parameters
    ----------
    run : Run
    path : str or pathlib.Path, that ends in .gif or .mp4

    Returns
    -------
    path : pathlib.Path

    Raises
    ------
    InputError : another ending, no such path, or an MP4 where ffmpeg is missing
    """
    check_target(path, "A film")
    file = pathlib.Path(os.fsdecode(path))
    ending = file.suffix.lower()
    if ending not in RATE:
        raise InputError(f"A film must end in {GIF} or {MP4}, but it is {shown(str(file))}.")
    from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter

    if ending == MP4 and not FFMpegWriter.isAvailable():
        raise InputError(f"An MP4 needs the program ffmpeg, which was not found; a {GIF} needs none.")
    motion = motion_of(run)
    rows, rate = pictures(motion.t, RATE[ending])
    figure, moving, draw = _drawing(run, motion)
    _draw_once(figure, moving)
    writer: Any = PillowWriter if ending == GIF else FFMpegWriter
    with whole_file(file, "A film") as half:
        FuncAnimation(figure, draw, frames=rows, init_func=lambda: None).save(half, writer(fps=rate))
    return file


def pictures(t: np.ndarray, rate: float) -> tuple[np.ndarray, float]:
    """Return the numbers of the states that a film shows, evenly in time, and how many of them a second.

    Parameters
    ----------
    t : (k,) float64 [s], of the saved states
    rate : float [1/s], the most pictures a second
    """
    span = float(t[-1] - t[0])
    seconds = min(max(span, SECONDS[0]), SECONDS[1])
    times = np.linspace(t[0], t[-1], max(2, round(seconds * rate) + 1))
    after = np.clip(np.searchsorted(t, times), 1, max(len(t) - 1, 1))
    nearest = np.where(times - t[after - 1] <= t[np.minimum(after, len(t) - 1)] - times, after - 1, np.minimum(after, len(t) - 1))
    rows = np.unique(nearest)
    return rows, max(1.0, min(rate, len(rows) / seconds))


def _draw_once(figure: Any, moving: list[Any]) -> None:
    """Put a picture of all that does not move in its place, so that it is not drawn again for every picture of the film."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    for artist in moving:
        artist.set_visible(False)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    still = np.array(canvas.buffer_rgba())
    for artist in figure.axes[0].get_children():
        artist.set_visible(False)
    figure.axes[0].set_axis_off()
    for axes in figure.axes[1:]:
        axes.set_visible(False)
    for artist in moving:
        artist.set_visible(True)
    figure.figimage(still, zorder=-1)


def _drawing(run: Any, motion: Motion) -> tuple[Any, list[Any], Any]:
    """The figure, what moves in it, and a function that draws a state."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    figure = Figure(figsize=INCHES, dpi=DPI)
    axes: Any = figure.add_axes((0.0, 0.04, 0.82, 0.92), projection="3d", computed_zorder=False)
    scale = ScalarMappable(Normalize(0.0, motion.full_scale), LinearSegmentedColormap.from_list("tension", colours.TENSION))
    figure.colorbar(scale, cax=figure.add_axes((0.86, 0.22, 0.022, 0.56)), label="tension [N]").ax.tick_params(labelsize=7)
    box, origin = _set_box(axes, motion)
    _draw_surroundings(axes, run, motion, box)
    ends, least = run.model.ends, 1e-6 * motion.full_scale
    cables = Line3DCollection(motion.q[0][ends] if len(ends) else NOTHING, linewidths=2.2, zorder=3)
    axes.add_collection3d(cables, autolim=False)
    edges = box_edges(run, motion.t, motion.q) if run.scene.bodies else None
    bodies = Line3DCollection(NOTHING, linewidths=1.2, colors=colours.BODY, zorder=3)
    axes.add_collection3d(bodies, autolim=False)
    nodes = [(point, run.model.node(point.name)) for point in run.scene.points]
    spots: list[Any] = [
        axes.plot([], [], [], "s" if kind_of(point) == "fixed" else "o", ms=5, color=colours.POINTS[kind_of(point)], zorder=4)[0]
        for point, _ in nodes
    ]
    named = nodes if len(nodes) <= NAMED else []
    names: list[Any] = [axes.text(0, 0, 0, f"  {printable(p.name)}", fontsize=8, zorder=5, parse_math=False) for p, _ in named]
    free = [node for point, node in nodes if kind_of(point) == "free"]
    traces: list[Any] = [axes.plot([], [], [], lw=0.8, alpha=0.7, color=colours.POINTS["free"], zorder=2)[0] for _ in free]

    time = figure.text(0.03, 0.93, "", fontsize=11)

    def draw(k: int) -> None:
        q = motion.q - origin(k)  # the whole past as one who goes along sees it now
        holds = motion.t[k] <= motion.broken_at
        tension, pulls = motion.tension[k][holds], motion.tension[k][holds] > least
        cables.set_segments(q[k][ends[holds]] if holds.any() else NOTHING)
        cables.set_color([scale.to_rgba(T) if pull else colours.SLACK for T, pull in zip(tension, pulls, strict=True)])
        cables.set_linestyle(["-" if pull else ":" for pull in pulls])
        if edges is not None:
            bodies.set_segments(edges[k] - origin(k))
        for spot, (_, node) in zip(spots, nodes, strict=True):
            spot.set_data_3d(*q[k, node][:, None])
        for name, (_, node) in zip(names, named, strict=True):
            name.set_position_3d(q[k, node])
        for trace, node in zip(traces, free, strict=True):
            past = q[: k + 1, node]
            trace.set_data_3d(*past[((past >= box[0]) & (past <= box[1])).all(axis=1)].T)
        time.set_text(f"t = {motion.t[k]:.{2 if np.ptp(motion.t) < 100 else 0}f} s")

    return figure, [cables, bodies, time, *spots, *names, *traces], draw


def _set_box(axes: Any, motion: Motion) -> tuple[np.ndarray, Any]:
    """Limits of the axes (2, 3) [m], around the whole motion or around a structure that travels, and their origin at a state."""
    from matplotlib.ticker import MaxNLocator

    if motion.drifts:
        middles = motion.q.mean(axis=1)
        own = motion.q - middles[:, None]
        box, origin = np.array([own.min(axis=(0, 1)), own.max(axis=(0, 1))]), lambda k: middles[k]
    else:
        box, origin = motion.box + motion.middle, lambda k: -motion.middle
    widest = np.ptp(box, axis=0).max() or 1.0
    extent = np.maximum(np.ptp(box, axis=0), 0.3 * widest)
    box = box.mean(axis=0) + np.array([[-0.52], [0.52]]) * extent
    about = " - mean" if motion.drifts else ""
    for name in "xyz":
        getattr(axes, f"set_{name}label")(f"{name}{about} [m]", labelpad=-2, fontsize=8)
    for axis, name, low, high in zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz", *box, strict=True):
        axis.set_major_locator(MaxNLocator(5 if high - low > 0.5 * widest else 2))
        axis.set_tick_params(labelsize=7, pad=-1)
        getattr(axes, f"set_{name}lim")(low, high)
    tall = extent[2] > 1.5 * extent[:2].max()  # then the labels of x and y are at the very bottom of the picture
    axes.set_box_aspect(extent, zoom=0.8 if tall else 0.9)
    axes.view_init(elev=18, azim=-20 if extent[1] > 1.5 * extent[0] else -65)
    return box, origin


def _draw_surroundings(axes: Any, run: Any, motion: Motion, box: np.ndarray) -> None:
    """Ground and still water where they cross the box, obstacles in it, and arrows of winds."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    around = surroundings(run.scene, np.zeros(3))
    corners = box[[0, 1, 1, 0], 0], box[[0, 0, 1, 1], 1]
    for plane, colour in ((around.ground, colours.GROUND), (around.water, colours.WATER)):
        if plane is None or abs(plane.normal[2]) < 0.1 or motion.drifts:
            continue
        z = (plane.height - plane.normal[0] * corners[0] - plane.normal[1] * corners[1]) / plane.normal[2]
        if ((z >= box[0, 2] - 0.1 * np.ptp(box[:, 2])) & (z <= box[1, 2] + 0.1 * np.ptp(box[:, 2]))).all():
            axes.add_collection3d(Poly3DCollection([np.column_stack([*corners, z])], color=colour, alpha=0.25, zorder=1))
    for solid in () if motion.drifts else around.obstacles:
        for line in outline(solid, box):
            axes.plot(*line.T, color=colours.OBSTACLE, lw=1, zorder=1)
    long = 0.25 * np.ptp(box, axis=0).max()
    for name, velocity, z in (("wind", around.wind, box[1, 2]), ("current", around.current, box[0, 2])):
        if velocity is not None:
            speed = float(np.linalg.norm(velocity))
            colour = colours.WIND if name == "wind" else colours.CURRENT
            axes.quiver(*box[0, :2], z, *(long * velocity / speed), color=colour, lw=2, zorder=4)
            axes.text(*box[0, :2], z + 0.03 * long / 0.25, f"{name} {speed:.3g} m/s", fontsize=8, color=colour, zorder=5)
