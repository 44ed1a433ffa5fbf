"""Figures of the study `measured`."""

import json

import numpy as np
from matplotlib.figure import Figure

from anet_lumped.views.palette import BLACK, BLUE, GREY, VERMILION
from studies.questions.measured import flights, lindahl
from studies.questions.measured.tables import GIVEN
from studies.study import Drawing


def plot(rows):
    """Drawings of the study, by name."""
    drawn = {
        "chain": Drawing(
            _plot_chain(rows["folded"]),
            "Tension at the driven end of a chain in a tank, folded on the period: measured by Lindahl (1984), with its scatter "
            "from cycle to cycle, and of the lumped chain with the coefficients given and with two numbers fitted at 3.5 s.",
        ),
        "sensitivity": Drawing(
            _plot_sensitivity(rows["sensitivity"], rows["chain"]),
            "What each number does to the rms error of the tension when it is changed alone, to the values beside its name "
            "(SI units). The upright line is the chain as it is given.",
        ),
    }
    if len(rows["flights"]):
        drawn["flights"] = Drawing(
            _plot_flights(rows["flights"]),
            "Rms distance of the payload from where it was measured: of the model, driven by the measured places of the drones, "
            "and of a guess that has it rest at each moment. Hatched: the flights to which the one number is fitted.",
        )
    return drawn


def _plot_chain(folded):
    figure = Figure(figsize=(9.5, 3.8), layout="constrained")
    panels = figure.subplots(1, len(lindahl.PERIODS))
    for panel, period in zip(panels, lindahl.PERIODS, strict=True):
        part = folded[folded["period_s"] == period]
        low, high = (part["measured_N"] + side * lindahl.SCATTER[period] for side in (-1.0, 1.0))
        panel.fill_between(part["phase"], low, high, color=GREY, alpha=0.4, lw=0, label="scatter of the experiment")
        panel.plot(part["phase"], part["measured_N"], "o", color=BLACK, ms=3.5, label="measured")
        panel.plot(part["phase"], part["as_given_N"], color=BLUE, lw=1.4, label="as given")
        panel.plot(part["phase"], part["fitted_N"], color=VERMILION, lw=1.4, ls="--", label="fitted at 3.5 s")
        panel.set(title=f"period {period:g} s", xlabel="phase of the period [-]", ylim=(-3.0, 76.0))
        panel.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("tension at the driven end [N]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return figure


def _plot_sensitivity(sensitivity, chain):
    names = list(dict.fromkeys(sensitivity["number"]))[::-1]
    figure = Figure(figsize=(9.5, 1.8 + 0.26 * len(names)), layout="constrained")
    panels = figure.subplots(1, len(lindahl.PERIODS), sharey=True)
    for panel, period in zip(panels, lindahl.PERIODS, strict=True):
        given = chain[(chain["setting"] == GIVEN) & (chain["period_s"] == period)]["rms_N"].iloc[0]
        panel.axvline(given, color=GREY, lw=1)
        part = sensitivity[sensitivity["period_s"] == period]
        for height, name in enumerate(names):
            errors = part.loc[part["number"] == name, "rms_N"].to_numpy()
            panel.plot([given, *errors], [height] * (1 + len(errors)), color=GREY, lw=1)
            for k, error in enumerate(errors[:2]):
                panel.plot(error, height, "os"[k], color=(BLUE, VERMILION)[k], ms=5, label=("first value", "second value")[k])
        panel.set(title=f"period {period:g} s", xlabel="rms error of the tension [N]")
        panel.spines[["top", "right"]].set_visible(False)
    values = sensitivity[sensitivity["period_s"] == lindahl.PERIODS[0]].groupby("number")["value"]
    named = {name: ", ".join(_short(value) for value in of_name) for name, of_name in values}
    panels[0].set_yticks(np.arange(len(names)), [f"{name.replace('_', ' ')}: {named[name]}" for name in names], fontsize=8)
    handles, labels = panels[0].get_legend_handles_labels()
    if "second value" in labels:
        both = [labels.index("first value"), labels.index("second value")]
        figure.legend([handles[k] for k in both], [labels[k] for k in both], loc="outside lower center", ncols=2, frameon=False)
    return figure


def _short(value):
    """A value of JSON as a tick says it: 1e+05 for 100000.0, linear for "linear"."""
    found = json.loads(value)
    return found if isinstance(found, str) else f"{found:.5g}"


def _plot_flights(table):
    figure = Figure(figsize=(9.0, 3.4), layout="constrained")
    axes = figure.subplots()
    for k, line in enumerate(table.itertuples()):
        hatch = "//" if line.half == flights.FITTED else ""
        labels = ("model", "guess at rest") if k == 0 else (None, None)
        axes.bar(k - 0.2, line.model_rms_mm, 0.38, color=BLUE, hatch=hatch, edgecolor="w", lw=0, label=labels[0])
        axes.bar(k + 0.2, line.guess_rms_mm, 0.38, color=GREY, label=labels[1])
    axes.set_xticks(range(len(table)), [name.replace("_", " ") for name in table["flight"]])
    axes.set_ylabel("rms distance of the payload [mm]")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=9)
    return figure
