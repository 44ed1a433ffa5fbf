"""Figures of the study `three_models`."""

import numpy as np
from matplotlib.figure import Figure

from anet_lumped.views.palette import look
from studies.questions.three_models.cases import CARRIED, FLOWN
from studies.questions.three_models.root_finders import BISECTION, FALSE_POSITION, OURS
from studies.study import Drawing


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "cost_and_error": Drawing(
            _plot_models(rows["rest"], rows["motions"]),
            "Error of p0 over the time that the answer takes, a mark for each net, load and step: at rest against elastic "
            "catenaries, in motion the largest one against a reference of finer cables.",
        ),
        "root_finders": Drawing(
            _plot_roots(rows["roots"]),
            "Iterations to the catenary number of four cables: the thesis's two root finders from one bracket, and this library's, "
            "which takes none. Marked none: the finder ended without a root.",
        ),
    }


def _plot_models(rest, motions):
    figure = Figure(figsize=(10, 4.4), layout="constrained")
    panels = [("at rest", rest.rename(columns={"time_ms": "time"}))]
    panels += [
        (name, motions[motions["motion"] == name].rename(columns={"time_of_a_second_ms": "time"})) for name in (CARRIED, FLOWN)
    ]
    looks = {model: look(k) | {"linestyle": ""} for k, model in enumerate(dict.fromkeys([*rest["model"], *motions["model"]]))}
    shown = {}
    for axes, (title, table) in zip(figure.subplots(1, len(panels)), panels, strict=True):
        for model, line in table[table["status"] == "done"].groupby("model", sort=False):
            (shown[model],) = axes.loglog(line["time"], line["error_mm"], ms=6, **looks[model])
        axes.set(title=title, xlabel="time of the answer [ms]" if title == "at rest" else "time of a second of motion [ms]")
    figure.axes[0].set(ylabel="error of p0 [mm]")
    figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return figure


def _plot_roots(roots):
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    axes = figure.subplots()
    widest = roots[roots["method"] == BISECTION][["from_m", "to_m"]].iloc[0]
    same = roots[(roots["from_m"].isna()) | ((roots["from_m"] == widest.from_m) & (roots["to_m"] == widest.to_m))]
    cables = list(dict.fromkeys(same["cable"]))
    for k, (method, hatch) in enumerate(((BISECTION, ""), (FALSE_POSITION, "//"), (OURS, ".."))):
        line = same[same["method"] == method].set_index("cable").loc[cables]
        done = line["status"] == "done"
        places = np.arange(len(cables)) + 0.28 * (k - 1)
        heights = line["iterations"].where(line["iterations"] > 0, 1)
        bars = axes.bar(places, heights, 0.26, label=method, color=look(k)["color"], hatch=hatch, edgecolor="w", lw=0)
        labels = [f"{n:.0f}" if good else f"{n:.0f}: none" for n, good in zip(line["iterations"], done, strict=True)]
        axes.bar_label(bars, labels=labels, fontsize=7, padding=1)
    axes.set_xticks(range(len(cables)), cables)
    axes.set(yscale="log", ylabel="iterations", ylim=(1, 1e6))
    axes.legend(frameon=False, ncols=3, loc="upper left", fontsize=8)
    return figure
