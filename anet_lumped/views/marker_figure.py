"""A model fitted to markers as a picture: both shapes with the markers, and how far each marker is from its cable."""

from typing import Any

import numpy as np

from .palette import BLACK, GREY, VERMILION, look
from .planes import draw_cables, label, planes_of

NAMED = 8  # cables, up to which the legend names them


def plot_markers(fit: Any) -> Any:
    """Figure of a fit: the model as given and as fitted with the markers in one or two planes, and distances along the cables.

    Parameters
    ----------
    fit : MarkerFit

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    on = fit.sequence.cable >= 0
    planes = planes_of(np.concatenate([fit.after.q, fit.xyz[on]]))
    figure = Figure(figsize=(10, 7.0), layout="constrained")
    names: Any = [["side"] * 2, ["along"] * 2] if len(planes) == 1 else [["side", "end"], ["along"] * 2]
    panels = figure.subplot_mosaic(names, height_ratios=(1.4, 1))
    for name, plane in zip(("side", "end"), planes, strict=False):
        _shapes(panels[name], fit, on, plane)
    handles, words = panels["side"].get_legend_handles_labels()
    figure.legend(handles, words, loc="outside upper left", ncols=len(words), frameon=False, fontsize=9)
    _distances(panels["along"], fit)
    for panel in panels.values():
        panel.spines[["top", "right"]].set_visible(False)
    return figure


def _shapes(axes: Any, fit: Any, on: np.ndarray, plane: tuple[int, int]) -> None:
    for state, fitted in ((fit.before, False), (fit.after, True)):
        style = {"colors": BLACK, "linewidths": 1.6} if fitted else {"colors": GREY, "linewidths": 1.2, "linestyles": "--"}
        draw_cables(axes, state.q, state.model.ends, plane, label="model, fitted" if fitted else "model, as given", **style)
    axes.plot(*fit.xyz[on][:, plane].T, "o", color=VERMILION, ms=3.5, mfc="none", label="markers", zorder=3)
    low, high = fit.after.q.min(axis=0), fit.after.q.max(axis=0)
    near = ~on & (np.abs(fit.xyz - (low + high) / 2) < 0.75 * np.ptp(fit.after.q)).all(axis=1)
    if near.any():
        axes.plot(*fit.xyz[near][:, plane].T, "x", color=BLACK, ms=4, mew=0.8, label="left out")
    axes.set(xlabel=label(plane[0], False), ylabel=label(plane[1], False))
    axes.set_aspect("equal", adjustable="datalim")


def _distances(axes: Any, fit: Any) -> None:
    cables = fit.scene.cables
    for i, cable in enumerate(cables):
        rows = fit.sequence.along(i)
        own = look(i)
        axes.plot(
            fit.sequence.arc[rows], 1e3 * fit.sequence.distance[rows], own["marker"], color=own["color"], ms=4,
            label=cable.name if len(cables) <= NAMED else None,
        )  # fmt: skip
    axes.set(xlabel="length along the cable, not stretched [m]", ylabel="marker to fitted cable [mm]", ylim=(0, None))
    if len(cables) <= NAMED:
        axes.legend(frameon=False, fontsize=8, ncols=4, loc="lower right", bbox_to_anchor=(1.0, 1.0))
