"""Figures of the study `nets`."""

from matplotlib.figure import Figure

from anet_lumped.views.palette import look
from studies.study import Drawing


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "sizes": Drawing(
            _plot_sizes(rows["solves"], rows["rests"]),
            "Left: the processor's time of one solve of a square net's junctions by the number of its points that move, by this "
            "library's fronts and by SuperLU. Right: that of its rest, hung by its corners in air and in a current.",
        ),
        "motions": Drawing(
            _plot_motions(rows["motions"]),
            "Processor time of a net's motion over the largest error of its points, a mark for each setting of a method.",
        ),
    }


def _plot_sizes(solves, rests):
    figure = Figure(figsize=(8.0, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for i, (name, line) in enumerate(solves.groupby("solver", sort=False)):
        left.loglog(line["points"], 1e3 * line["solve_s"], ms=5, label=name, **look(i))
    for i, (name, line) in enumerate(rests.groupby("around", sort=False)):
        right.loglog(line["side"] ** 2, line["rest_s"], ms=5, label=name, **look(i))
    left.set(xlabel="points that move", ylabel="one solve [ms]")
    right.set(xlabel="points", ylabel="one rest [s]")
    for axes in (left, right):
        axes.legend(frameon=False, fontsize=8)
    return figure


def _plot_motions(motions):
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.subplots()
    done = motions[motions["status"] == "done"]
    for i, ((engine, method), line) in enumerate(done.groupby(["engine", "method"], sort=False)):
        axes.loglog(line["error_mm"], line["cpu_s"], ms=6, label=f"{engine}, {method}", **look(i))
    axes.set(xlabel="largest error [mm]", ylabel="processor time [s]")
    axes.legend(frameon=False, fontsize=8)
    return figure
