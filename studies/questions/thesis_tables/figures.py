"""Figures of the study `thesis_tables`."""

import numpy as np
from matplotlib.figure import Figure

from studies.questions.thesis_tables.words import in_units
from studies.study import Drawing


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "errors_of_table_5_1": Drawing(
            _plot_errors(rows["table_5_1"]),
            "Errors of p0's height in the thesis's Table 5.1, and those of the same method made again. Grey: as the thesis states "
            "them; orange: all masses equal, as in the thesis; blue: half a mass at the ends of each cable.",
        ),
        "cause_of_the_bias": Drawing(
            _plot_bias(rows["energy"], rows["bias"]),
            "Why equal masses pull p0 down. Left: the energy that the thesis minimises, with its least marked. Right: what the "
            "masses alone make of p0, beside a balance of forces that carries the extra mass as a payload.",
        ),
        "computation_times": Drawing(
            _plot_times(rows["table_5_1"], rows["force_balance"], rows["motion"]),
            "Computation times, as the thesis states them and as measured here. The thesis's computer is not known, so that its "
            "bars and the others do not compare methods.",
        ),
    }


def _plot_errors(table):
    figure = Figure(figsize=(8, 4.2), layout="constrained")
    axes = figure.subplots()
    middle = np.arange(len(table))
    for shift, column, label, color, hatch in (
        (-0.27, "thesis_error_cm", "thesis, Table 5.1", "0.7", ""),
        (0.0, "error_cm", "the same method here: all masses equal", "#D55E00", "//"),
        (0.27, "half_end_masses_error_cm", "half a mass at the ends", "#0072B2", ""),
    ):
        bars = axes.bar(middle + shift, table[column], 0.25, label=label, color=color, hatch=hatch, edgecolor="w", lw=0)
        axes.bar_label(bars, fmt="%+.2f", fontsize=7, padding=1)
    axes.axhline(0, color="k", lw=0.8)
    axes.set_xticks(middle, [f"{r.samples} samples\n{r.points} points" for r in table.itertuples()])
    axes.set(ylabel="error of p0's height [cm]", ylim=(-3.3, 3.6))
    figure.legend(loc="outside upper center", ncols=3, frameon=False)
    return figure


def _plot_bias(energy, bias):
    figure = Figure(figsize=(9, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for column, label, color, dashes in (
        ("equal_masses_m", "10 equal masses a cable", "#D55E00", "-"),
        ("half_end_masses_m", "10 masses, half of one at the ends", "#0072B2", "-."),
        ("cable_m", "the cable itself", "k", ":"),
    ):
        above = 100 * (energy[column] - energy[column].min())
        left.plot(100 * energy["p0_height_m"], above, color=color, label=label, ls=dashes)
        left.plot(100 * energy["p0_height_m"][above.idxmin()], 0, "v", color=color, clip_on=False)
    left.set(xlabel="height of p0 [cm]", ylabel="mean height of the points, above its least [cm]")
    left.set(xlim=(13, 40), ylim=(0, 2.2), title="the energy that the thesis minimises")
    right.loglog(bias["points"], -bias["equal_masses_mm"], "o-", color="#D55E00", label="equal masses")
    label = "balance of forces, p0 loaded\nwith 1/(n − 1) of a cable"
    right.loglog(bias["points"], -bias["payload_mm"], "kx", ms=8, label=label)
    right.loglog(bias["points"], np.abs(bias["half_end_masses_mm"]), "s-.", color="#0072B2", label="half a mass at the ends")
    right.set(xlabel="points n of a cable", ylabel="|error of p0's height| [mm]", title="the error without the grid of samples")
    for axes in (left, right):
        axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.18), fontsize=9)
    return figure


def _plot_times(table, balance, motion):
    figure = Figure(figsize=(8, 3.8), layout="constrained")
    axes = figure.subplots()
    last = table.iloc[-1]
    thesis, sampled, balanced = ("0.7", ""), ("#D55E00", "//"), ("#0072B2", "")
    bars = [
        ("p0, 200 × 500 sampling: thesis", last.thesis_time_s, thesis),
        ("p0, 200 × 500 sampling: here", last.time_s, sampled),
        *((f"p0, {r.method}", r.time_ms / 1e3, balanced) for r in balance.itertuples()),
    ]
    for net, group in motion.groupby("net", sort=False):
        bars.append((f"4 s of motion, {net}: thesis", group.thesis_time_s.iloc[0], thesis))
        bars += [(f"4 s of motion, {net}, 400 poses: {r.method}", r.time_s, balanced) for r in group.itertuples()]
    names, seconds, looks = zip(*bars, strict=True)
    colors, hatches = zip(*looks, strict=True)
    drawn = axes.barh(range(len(bars)), seconds, color=colors, hatch=hatches, edgecolor="w", lw=0)
    labels = ["> " * (name == "4 s of motion, four cables: thesis") + in_units(s) for name, s, _ in bars]
    axes.bar_label(drawn, labels=labels, padding=3, fontsize=8)
    axes.set_yticks(range(len(bars)), names, fontsize=8)
    axes.invert_yaxis()
    axes.set(xscale="log", xlabel="computation time [s]", xlim=(min(seconds) / 3, max(seconds) * 30))
    return figure
