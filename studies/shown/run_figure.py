"""A run as a picture: the net at some times, its energy over time, and above them how the run ended.

A figure of a run that is not "done", or whose audit failed, says so in red: `mark_failures` is for any figure.
"""

import textwrap

import numpy as np

from anet_lumped.views.verdict import verdict
from studies.shown.palette import look

SHOWN = 5  # times at which the net is drawn
WIDE = 150  # characters of a line above the figure
BAD = "#c1121f"
OF_ENERGY = ("kinetic", "elastic", "potential", "work put in", "taken by dampers", "taken by effects", "taken by the method")
UNDIVIDED = (*OF_ENERGY[:4], "dissipated")  # of a run saved by version 0.1


def mark_failures(figure, *runs) -> None:
    """Write what is wrong with the runs that a figure shows in red above it, and frame it; nothing if all are "done"."""
    wrong = dict.fromkeys(verdict(run) for run in runs if not run.ok)
    if wrong:
        _above(figure, " ".join(wrong), BAD)
        figure.patch.set(edgecolor=BAD, linewidth=6)


def plot(run):
    """Figure of a run: its shapes in the upright plane in which they reach furthest, and its energies.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.2), layout="constrained")
    side, energy = figure.subplots(1, 2, width_ratios=(1.3, 1))
    _shapes(side, run)
    _energies(energy, run)
    for panel in (side, energy):
        panel.spines[["top", "right"]].set_visible(False)
    if run.ok:
        _above(figure, verdict(run), "0.25")
    mark_failures(figure, run)
    return figure


def _above(figure, words, color):
    figure.suptitle(textwrap.fill(words, WIDE), color=color, fontsize=9, ha="left", x=0.01, parse_math=False)  # names may hold $


def _shapes(axes, run):
    finite = np.isfinite(run.q).all(axis=(1, 2))
    across = int(np.ptp(run.q[finite][:, :, 1]) > np.ptp(run.q[finite][:, :, 0]))
    last = np.flatnonzero(finite)[-1]
    for k in np.unique(np.linspace(0, last, SHOWN).round().astype(int)):
        color = f"{0.85 - 0.85 * k / max(last, 1):.2f}"
        for i, cable in enumerate(run.scene.cables):
            shape = run.pieces(cable.name, k)
            axes.plot(shape[:, across], shape[:, 2], ".-", color=color, ms=2, lw=1, label="" if i else f"t = {run.t[k]:.3g} s")
    axes.set(xlabel=f"{'xy'[across]} [m]", ylabel="z [m]")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(frameon=False, fontsize=8, ncols=SHOWN, loc="lower center", bbox_to_anchor=(0.5, 1.0), columnspacing=1.0)


def _energies(axes, run):
    for i, name in enumerate(OF_ENERGY if run.energy.shape[1] == len(OF_ENERGY) else UNDIVIDED):
        rows = run.energy[:, i] - (run.energy[0, i] if name == "potential" else 0.0)
        if np.any(rows):
            own = look(i)
            axes.plot(run.t, rows, lw=1.2, label=name, color=own["color"], ls=own["linestyle"])
    for event in run.events:
        axes.axvline(event.t, color="0.8", lw=1, zorder=0)
    total = run.energy[:, :3].sum(axis=1) - run.energy[:, 3] + run.energy[:, 4:].sum(axis=1)
    axes.plot(run.t, total - total[0], color="k", ls=(0, (1, 3)), lw=1.5, label="not accounted for")
    axes.set(xlabel="t [s]", ylabel="energy [J]")
    axes.legend(frameon=False, fontsize=8, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))


def save_run(run, folder) -> None:
    """Write a run as run.nc, and its picture as run.png, into a folder."""
    run.save(folder / "run.nc")
    plot(run).savefig(folder / "run.png", dpi=110)
