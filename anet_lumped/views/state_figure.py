"""A state as a picture: its shape in one or two planes, coloured by tension."""

from typing import Any

import numpy as np

from anet_lumped.checks import printable

from . import colours
from .motion import broken_at, kind_of
from .planes import MANY, draw_around, draw_bodies, draw_cables, label, planes_of

NAMED = 12  # points, up to which their names are written
ROUNDING = 1e-14  # of EA: what a tension is that rounding of places alone makes


def plot_state(state: Any) -> Any:
    """Figure of a state: cables coloured by tension, dashed where slack, in the plane in which they reach furthest and in another.

    Parameters
    ----------
    state : State

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize
    from matplotlib.figure import Figure

    planes = planes_of(state.q)
    holds = broken_at(state) == np.inf
    T, ends = state.segment_tension[holds], state.model.ends[holds]
    largest = float(T.max(initial=0.0)) or 1.0
    scale = ScalarMappable(Normalize(0.0, largest), LinearSegmentedColormap.from_list("tension", colours.TENSION))
    stiffest = max((cable.EA for cable in state.scene.cables if not cable.inextensible), default=0.0)
    pulls = T > max(1e-6 * largest, ROUNDING * stiffest)
    figure = Figure(figsize=(10 if len(planes) == 2 else 6.4, 4.2), layout="constrained")
    panels = figure.subplots(1, len(planes), squeeze=False)[0]
    for axes, plane in zip(panels, planes, strict=True):
        draw_cables(axes, state.q, ends[pulls], plane, colors=scale.to_rgba(T[pulls]), linewidths=2.0)
        draw_cables(axes, state.q, ends[~pulls], plane, colors=colours.SLACK, linewidths=1.5, linestyles=":")
        draw_bodies(axes, state.model, state.q, plane, "0.4")
        draw_around(axes, state.scene, state.q, plane)
        _points(axes, state, plane)
        axes.set(xlabel=label(plane[0], False), ylabel=label(plane[1], False))
        axes.set_aspect("equal", adjustable="datalim")
        axes.spines[["top", "right"]].set_visible(False)
    figure.colorbar(scale, ax=panels[-1], label="tension [N]", shrink=0.8)
    return figure


def _points(axes: Any, state: Any, plane: tuple[int, int]) -> None:
    names: dict[tuple[float, ...], list[str]] = {}  # of the points at one spot of the picture
    few = len(state.scene.points) <= NAMED
    for kind, mark in (("fixed", "s"), ("driven", "s"), ("free", "o")):
        points = [point for point in state.scene.points if kind_of(point) == kind]
        at = np.array([state.position(point.name)[list(plane)] for point in points]).reshape(-1, 2)
        if len(points):
            look = {"color": colours.POINTS[kind], "ms": 5 if len(points) <= NAMED else 2, "rasterized": len(points) > MANY}
            axes.plot(*at.T, mark, label=kind, zorder=3, **look)
        for point, where in zip(points, at, strict=True) if few else ():
            names.setdefault(tuple(np.round(where, 3 - round(np.log10(np.ptp(state.q) or 1.0)))), []).append(printable(point.name))
    if few:
        for spot, those in names.items():
            axes.annotate("  " + ", ".join(those), spot, fontsize=8, parse_math=False)
