"""In which planes a structure is drawn: upright ones, first the one in which it reaches furthest."""

from typing import Any

import numpy as np

from . import colours
from .motion import DRIFTS
from .outlines import outline
from .surroundings import surroundings

MANY = 1000  # lines or points, above which they are a bitmap within a vector graphic, which else takes seconds and megabytes
FLAT = 0.02  # of the widest extent: what a second view must show at least


def planes_of(q: np.ndarray) -> list[tuple[int, int]]:
    """Return the axes of one or two pictures: upright ones, or the level plane first where all heights are nearly the same.

    Parameters
    ----------
    q : (..., 3) float64 [m], all that is drawn

    Returns
    -------
    planes : list of (across, up), each 0, 1 or 2 for x, y or z
    """
    extent = np.ptp(q.reshape(-1, 3), axis=0)
    wide, narrow = (0, 1) if extent[0] >= extent[1] else (1, 0)
    if extent[2] < FLAT * extent[wide]:
        return [(0, 1)]
    return [(wide, 2), (narrow, 2)] if extent[narrow] > FLAT * max(extent[wide], extent[2]) else [(wide, 2)]


def along_with(q: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return places about the mean of each state where a structure travels many times its own size, so that it is not small.

    Parameters
    ----------
    q : (k, n, 3) float64 [m]

    Returns
    -------
    q : (k, n, 3) float64 [m]
    travels : bool
    """
    own = float(np.ptp(q[0], axis=0).max()) or 1.0
    travels = float(np.ptp(q, axis=(0, 1)).max()) > DRIFTS * own
    return (q - q.mean(axis=1, keepdims=True) if travels else q), travels


def label(axis: int, travels: bool) -> str:
    """Text at an axis: "x [m]", or "x - mean [m]" of places about the mean of each state."""
    return f"{'xyz'[axis]}{' - mean' if travels else ''} [m]"


def draw_cables(axes: Any, q: np.ndarray, ends: np.ndarray, plane: tuple[int, int], **look: Any) -> Any:
    """Draw segments with their nodes in a plane.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    q : (n, 3) float64 [m]
    ends : (m, 2) int64, the nodes of each segment that is drawn
    plane : (across, up)
    look : of the lines, as `matplotlib.collections.LineCollection` takes it

    Returns
    -------
    matplotlib.collections.LineCollection
    """
    from matplotlib.collections import LineCollection

    lines = LineCollection(q[ends][:, :, list(plane)], rasterized=len(ends) > MANY, **look)
    axes.add_collection(lines, autolim=True)
    axes.autoscale_view()
    return lines


def draw_around(axes: Any, scene: Any, q: np.ndarray, plane: tuple[int, int]) -> None:
    """Draw obstacles, a level ground and the still surface of water, as far as they lie where a structure is.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    scene : Scene
    q : (..., 3) float64 [m], places of the structure
    plane : (across, up)
    """
    around = surroundings(scene, np.zeros(3))
    places = q.reshape(-1, 3)
    box = np.array([places.min(axis=0), places.max(axis=0)]) + np.array([[-0.5], [0.5]]) * 0.1 * np.ptp(places)
    for solid in around.obstacles:
        for line in outline(solid, box):
            axes.plot(*line[:, list(plane)].T, color=colours.OBSTACLE, lw=0.8, zorder=0)
    for level, colour in ((around.ground, colours.GROUND), (around.water, colours.WATER)):
        if plane[1] == 2 and level is not None and level.normal[2] == 1.0 and box[0, 2] <= level.height <= box[1, 2]:
            axes.axhline(level.height, color=colour, lw=1.2, zorder=0)


def draw_bodies(axes: Any, model: Any, q: np.ndarray, plane: tuple[int, int], colour: Any) -> None:
    """Draw each rigid body as lines from its origin to its attachments, q (n, 3) [m]; without cables all that moves as dots too."""
    scene = model.scene
    if not scene.cables:
        alone = [model.node(one.name) for one in (*scene.free_points, *scene.bodies)]
        axes.plot(*q[alone][:, plane].T, "o", color=colour, ms=4)
    arms = [
        (model.node(body.name), model.node(point.name))
        for body in model.scene.bodies
        for point in body.points
        if point.name.startswith(f"{body.name}.")
    ]
    if arms:
        draw_cables(axes, q, np.array(arms), plane, colors=colour, linewidths=3.0)
