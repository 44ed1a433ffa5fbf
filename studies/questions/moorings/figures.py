"""Figures of the study `moorings`."""

from matplotlib.figure import Figure

from anet_lumped.views.palette import BLUE, VERMILION
from studies.questions.moorings.prices import OTHER, OWN
from studies.study import Drawing


def plot(rows):
    """Drawings of the study, by name."""
    drawn = {
        "cost": Drawing(
            _plot_cost(rows["cost"]),
            "Processor time over the error of the tension, a point for each setting: of this library and, where installed, of "
            "MoorDyn, each against a fine run of its own.",
        )
    }
    if rows["decks"]["statics_error"].notna().any():
        drawn["errors"] = Drawing(
            _plot_errors(rows["decks"]),
            "Largest difference of end tensions from MoorDyn's: at rest, over the largest tension, and moved, over the mean one.",
        )
    return drawn


def _plot_cost(cost):
    names = list(dict.fromkeys(cost["deck"]))
    columns = min(4, len(names))
    lines = -(-len(names) // columns)
    figure = Figure(figsize=(2.6 * columns + 1.0, 2.4 * lines + 0.8), layout="constrained")
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    for panel, name in zip(panels, names, strict=False):
        for code, color, mark in ((OWN, BLUE, "o"), (OTHER, VERMILION, "s")):
            part = cost[(cost["deck"] == name) & (cost["code"] == code)]
            if len(part):
                panel.loglog(part["error_over_range"], part["cpu_s"], mark, color=color, ms=4, label=code)
        panel.set_title(name[:34], fontsize=7)
        panel.set(xlabel="error over range [-]", ylabel="processor time [s]")
    for panel in panels[len(names) :]:
        panel.remove()
    panels[0].legend(frameon=False, fontsize=8)
    return figure


def _plot_errors(decks):
    part = decks[decks["statics_error"].notna()]
    figure = Figure(figsize=(8.0, 1.2 + 0.22 * len(part)), layout="constrained")
    axes = figure.subplots()
    axes.semilogx(part["statics_error"], range(len(part)), "o", color=BLUE, label="at rest")
    axes.semilogx(part["motion_error"], range(len(part)), "s", color=VERMILION, label="moved")
    axes.set_yticks(range(len(part)), part["deck"], fontsize=7)
    axes.set_xlabel("difference of tensions from MoorDyn's [-]")
    axes.legend(frameon=False, fontsize=8)
    return figure
