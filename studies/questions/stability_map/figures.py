"""Figures of the study `stability_map`: what the energy says of each cell, under the border predicted before any run."""

import numpy as np

from anet_lumped.motion.stability import step_limit, top_modes
from anet_lumped.views.palette import GREEN
from integrators import schemes
from studies.questions.stability_map.planes import (
    DAMPERS,
    RISES,
    STABLE,
    STEPS,
    UNSTABLE,
    survived,
    verdict,
)  # fmt: skip
from studies.study import Drawing
from studies.thesis_cable import (
    CORD_EA,
    FOUND_EA,
    FOUND_K,
    LENGTH,
    SEGMENT_MASS,
    SEGMENTS,
    explicit_schemes,
    hung,
    implicit_schemes,
    label,
)  # fmt: skip

COLOURS = {STABLE: "#d6e6f4", RISES: "#E69F00", UNSTABLE: "#5b2a6e"}  # light, middle and dark, for readers who see no colours


def plot(rows):
    """Drawings of the study, by name."""
    cells = rows["planes"].dropna(subset="dt_s")
    told = (
        "A white dot marks a cell that fails although its run reached its end. The line is the predicted border; for explicit "
        "Euler, which lets swings grow at any step, it is that of axial motion alone."
    )
    return {
        "step_and_stiffness": Drawing(
            _plot_plane(cells[cells["plane"] == "stiffness"], "EA_N", rows["thesis"]),
            f"What the energy of the thesis's cable does at each step and stiffness, by scheme. {told}",
        ),
        "step_and_damper": Drawing(
            _plot_plane(cells[cells["plane"] == "damper"], "damper_Ns_per_m", rows["thesis"]),
            f"What the energy of the thesis's cable does at each step and damper, by scheme; its springs are {FOUND_K:.0f} N/m. "
            f"{told}",
        ),
    }


def _plot_plane(cells, ordinate, thesis):
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    figure = Figure(figsize=(13, 5.6), layout="constrained")
    lines = explicit_schemes(), implicit_schemes()
    panels = figure.subplots(2, max(map(len, lines)), sharex=True, sharey=True)
    cells = cells.assign(verdict=verdict(cells))
    drawn = []
    for row, line in zip(panels, lines, strict=True):
        drawn += zip(row, line, strict=False)
        for axes in row[len(line) :]:
            axes.remove()
    for axes, scheme in drawn:
        here = cells[cells["scheme"] == scheme]
        grid = here.pivot(index=ordinate, columns="dt_s", values="verdict")
        steps, ordinates = 1e3 * grid.columns.to_numpy(float), grid.index.to_numpy(float)
        colours = ListedColormap(list(COLOURS.values()))
        shade = {"cmap": colours, "vmin": 0, "vmax": 2, "edgecolors": "face", "linewidth": 0.2}
        axes.pcolormesh(_edges(steps), _edges(ordinates), grid, **shade)
        alive = here[survived(here)]
        axes.plot(1e3 * alive["dt_s"], alive[ordinate], ".", ms=3, color="w")
        axes.set(xscale="log", yscale="log", title=label(scheme))
        axes.minorticks_off()  # of so many small panels they take half of the time in which these are drawn
        limits = axes.get_xlim(), axes.get_ylim()
        _draw_border(axes, scheme, ordinate, limits[1])
        _draw_thesis(axes, scheme, ordinate, thesis)
        axes.set(xlim=limits[0], ylim=limits[1])
    if ordinate == "EA_N":
        for axes in figure.axes:
            axes.axhline(CORD_EA, color="k", lw=0.8, ls=":")
        panels[1, 0].text(STEPS[-1] * 1e3, 1.3 * CORD_EA, "3 mm nylon ", ha="right", fontsize=8)
    panels[1, 3].set_xlabel("step [ms]", fontsize=11)
    name = "axial stiffness EA [N]" if ordinate == "EA_N" else "damper c of a segment [N·s/m]"
    figure.supylabel(name, fontsize=11)
    handles = [
        Patch(color=COLOURS[STABLE], label="energy does not rise"),
        Patch(color=COLOURS[RISES], label="rises in the whip or at the very start"),
        Patch(color=COLOURS[UNSTABLE], label="small motions about rest grow without end"),
        Line2D([], [], marker="o", ls="", ms=5, mfc="w", mec="0.4", label="fails, yet its run reached its end"),
        Line2D([], [], color="k", lw=2, label="predicted border"),
        Line2D([], [], color="k", lw=1.5, ls="--", label="predicted border of axial motion alone"),
        Line2D([], [], marker="*", ls="", ms=11, mfc="w", mec="k", label="the thesis's cable: 1.1 m, no damper"),
        Line2D([], [], marker="^", ls="-", color=GREEN, label="what the thesis tried"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return figure


def _edges(centres):
    """Borders of cells whose centres lie evenly in the logarithm."""
    ratio = np.sqrt(centres[1] / centres[0])
    return np.append(centres / ratio, centres[-1] * ratio)


def _draw_border(axes, scheme, ordinate, limits):
    """Predicted step over stiffness or damper; for explicit Euler, which no swing survives, that of axial modes."""
    if not schemes.scheme(scheme).explicit:
        return
    values = np.geomspace(*limits, 300)
    EA, c = (values, 0.0 * values) if ordinate == "EA_N" else (np.full(300, FOUND_EA), values)
    (mode,) = top_modes(hung(1.0)).values()
    omega = mode.omega * np.sqrt(EA)
    steps = step_limit(scheme, omega, c * LENGTH / SEGMENTS / EA * omega / 2)
    style = {"lw": 2} if schemes.scheme(scheme).stable_undamped else {"ls": "--", "lw": 1.5}
    axes.plot(1e3 * np.where(steps > 0, steps, np.nan), values, color="k", **style)


def _draw_thesis(axes, scheme, ordinate, thesis):
    """The thesis's cable and what was tried next, at the step that the thesis's table has for the scheme."""
    steps = thesis.groupby("scheme")["dt_s"].first()
    step = 1e3 * steps.get(scheme, steps["edmc"])
    if ordinate == "EA_N":
        low, high = FOUND_EA, 10 * FOUND_EA
    else:
        low, high = DAMPERS[0], 10 * SEGMENT_MASS / (step / 1e3)
    axes.plot([step, step], [low, high], color=GREEN, lw=1.5)
    axes.plot(step, high, "^", color=GREEN, ms=6)
    axes.plot(step, low, "*", ms=11, mfc="w", mec="k", clip_on=False)
