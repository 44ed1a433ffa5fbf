"""A run as a picture: its shapes at some times, its tensions and energies over time, and above them how the run ended.

A figure of a run that is not "done", or whose audit failed, says so in red: `mark_failures` is for any figure.
"""

import textwrap
from typing import Any

import numpy as np

from .motion import broken_at
from .palette import look, width
from .planes import along_with, draw_around, draw_bodies, draw_cables, label, planes_of
from .tension_figure import draw_over_time, most_loaded
from .verdict import verdict

SHOWN = 5  # times at which the net is drawn
WIDE = 150  # characters of a line above the figure
BAD = "#c1121f"
OF_ENERGY = ("kinetic", "elastic", "potential", "work put in", "taken by dampers", "taken by effects", "taken by the method")
UNDIVIDED = (*OF_ENERGY[:4], "dissipated")  # of a run saved by version 0.1


def mark_failures(figure: Any, *runs: Any) -> None:
    """Write what is wrong with the runs that a figure shows in red above it, and frame it; nothing if all are "done"."""
    wrong = dict.fromkeys(verdict(run) for run in runs if not run.ok)
    if wrong:
        _above(figure, " ".join(wrong), BAD)
        figure.patch.set(edgecolor=BAD, linewidth=6)


def plot_run(run: Any) -> Any:
    """Figure of a run: its shapes in the plane in which they reach furthest and in another, tensions and energies over time.

    Parameters
    ----------
    run : Run

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    finite = np.flatnonzero(np.isfinite(run.q).all(axis=(1, 2)))
    rows = finite[np.unique(np.linspace(0, len(finite) - 1, SHOWN).round().astype(int))]
    q, travels = along_with(run.q[finite])
    planes = planes_of(q)
    figure = Figure(figsize=(10, 6.6), layout="constrained")
    names: Any = [["side"] * 2, ["tension", "energy"]] if len(planes) == 1 else [["side", "end"], ["tension", "energy"]]
    panels = figure.subplot_mosaic(names, height_ratios=(1.2, 1))
    for name, plane in zip(("side", "end"), planes, strict=False):
        _shapes(panels[name], run, rows, q[np.searchsorted(finite, rows)], plane, travels)
    panels["side"].legend(frameon=False, fontsize=8, ncols=SHOWN, loc="lower left", bbox_to_anchor=(0.0, 1.0), columnspacing=1.0)
    draw_over_time(panels["tension"], run, most_loaded(run))
    _energies(panels["energy"], run)
    for panel in panels.values():
        panel.spines[["top", "right"]].set_visible(False)
    if run.ok:
        _above(figure, verdict(run), "0.25")
    mark_failures(figure, run)
    return figure


def _above(figure: Any, words: str, color: str) -> None:
    figure.suptitle(textwrap.fill(words, WIDE), color=color, fontsize=9, ha="left", x=0.01, parse_math=False)  # names may hold $


def _shapes(axes: Any, run: Any, rows: np.ndarray, q: np.ndarray, plane: tuple[int, int], travels: bool) -> None:
    breaks = broken_at(run)
    for at, row in zip(q, rows, strict=True):
        grey = f"{0.85 - 0.85 * row / max(rows[-1], 1):.2f}"
        holds = run.t[row] <= breaks
        draw_cables(axes, at, run.model.ends[holds], plane, colors=grey, linewidths=1.0, label=f"t = {run.t[row]:.3g} s")
        draw_bodies(axes, run.model, at, plane, grey)
        axes.plot(*at[np.unique(run.model.ends)][:, plane].T, ".", color=grey, ms=2)
    if not travels:
        draw_around(axes, run.scene, q, plane)
    axes.set(xlabel=label(plane[0], travels), ylabel=label(plane[1], travels))
    axes.set_aspect("equal", adjustable="datalim")


def _energies(axes: Any, run: Any) -> None:
    curves = {}
    for i, name in enumerate(OF_ENERGY if run.energy.shape[1] == len(OF_ENERGY) else UNDIVIDED):
        rows = run.energy[:, i] - (run.energy[0, i] if name == "potential" else 0.0)
        if np.any(rows):
            curves[name] = (rows, look(i))
    for k, (name, (rows, own)) in enumerate(curves.items()):
        axes.plot(run.t, rows, lw=width(k, len(curves)), label=name, color=own["color"], ls=own["linestyle"])
    for event in run.events:
        axes.axvline(event.t, color="0.8", lw=1, zorder=0)
    total = run.energy[:, :3].sum(axis=1) - run.energy[:, 3] + run.energy[:, 4:].sum(axis=1)
    axes.plot(run.t, total - total[0], color="k", ls=(0, (1, 3)), lw=1.5, label="not accounted for")
    axes.set(xlabel="t [s]", ylabel="energy [J]")
    axes.legend(frameon=False, fontsize=8, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
