"""In which planes a structure is drawn: upright ones, first the one in which it reaches furthest."""

from typing import Any

import numpy as np

from .motion import DRIFTS

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

    lines = LineCollection(q[ends][:, :, list(plane)], **look)
    axes.add_collection(lines, autolim=True)
    axes.autoscale_view()
    return lines
