"""Figures of the study `work_precision`: error against wall time, the parts of the error, the front, the growth."""

import numpy as np
import pandas as pd

from anet_lumped.views.palette import BLUE, COLOURS, GREEN, ORANGE, PURPLE, SKY, VERMILION, look
from studies.accuracy_cost.contestants import ADAPTIVE, EXTRAPOLATED, OURS, OWN_CHOICE, RIGID
from studies.shown.scheme_styles import style
from studies.shown.sentences import power, stiffness
from studies.study import Drawing

VARIANTS = {ADAPTIVE: ("edmc", "*"), EXTRAPOLATED: ("edmc", "4")}  # of our methods: the scheme whose colour they have, and a mark
CHOSEN = (VERMILION, "$A$")  # colour and mark of the library's own choice
PEER_COLOURS = (VERMILION, GREEN, ORANGE, PURPLE, SKY)  # with dashes and empty marks
SEEN = 1e-7  # [mm] that smaller errors are drawn at
LOST = 1e3  # [mm] as far as the axes go: whoever is a metre off is lost
MOTION = ["motion", "EA_N", "segments"]  # columns
MARKS = "osv^D"
COLUMNS = 4
FEW = 8  # curves of a panel that a reader can tell apart
FIRST = ("edmc", OWN_CHOICE)  # of our methods, those that every panel shows, and those that fill a panel up
FILLING = ("verlet", ADAPTIVE, EXTRAPOLATED)
LINES = {ADAPTIVE: ":", EXTRAPOLATED: "-."}
DOUBT = "both references differ by this"
FILLS = ("none", "left", "full")  # of marks, by stiffness


def plot(rows):
    """Drawings of the study, by name."""
    runs = rows["runs"]
    few = pd.concat([_few(part, rows["equal_error"]) for _, part in runs.groupby(MOTION, sort=False)])
    what = (
        f"Largest error of p0 or of the tip over the time of the run, one panel a motion; errors below {power(SEEN)} mm are "
        "drawn there. In the grey band the two references differ by more than the error, so that nothing is said of it."
    )
    shown = " Of each motion the library's own choice, edmc, and what is cheapest at some error." if len(few) < len(runs) else ""
    everything = {"all_methods": Drawing(_races(runs), f"{what} All methods and engines.", on_demand=True)} if shown else {}
    return {
        "work_against_precision": Drawing(_races(few), what + shown),
        **everything,
        "parts_of_the_error": Drawing(
            _parts(rows["total_error"]),
            "Parts of the error of p0 in 4 s of the carried net over the number of segments, one panel a stiffness.",
        ),
        "front_of_total_error": Drawing(
            _front(rows["total_error"]),
            "Total error of p0 against the continuous inextensible net, over the time of the run. Nothing is faster and closer "
            "than the runs on the line. Colours tell the number of segments, marks the method, fillings the stiffness.",
        ),
        "cost_of_refinement": Drawing(
            _growth(rows["growth"]),
            "Time of 1 s of motion over the number of nodes of the carried net: edmc at 10 ms, and verlet at its limit, by the "
            "pace of a few steps.",
        ),
    }


def own_look(method):
    """Colour and mark of one of our methods."""
    if method == OWN_CHOICE:
        return CHOSEN
    scheme, mark = VARIANTS.get(method, (method.removesuffix(RIGID), None))
    return style(scheme).color, mark or style(scheme).marker


def _figure(width, height):
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def _few(part, equal):
    """The runs of one motion of at most `FEW` methods: `FIRST`, those that are cheapest at some error, and `FILLING`."""
    names = (part["engine"].where(part["engine"] != OURS, "") + " " + part["method"]).str.strip()
    best = equal[(equal[MOTION] == part[MOTION].iloc[0]).all(axis=1)]
    wanted = [*FIRST, *best["best_ours"], *best["best_peer"], *FILLING]
    drawn = set(names[part["error_mm"] < LOST])
    return part[names.isin([name for name in dict.fromkeys(wanted) if name in drawn][:FEW])]


def _races(runs):
    from matplotlib.ticker import NullFormatter

    motions = list(runs.groupby(MOTION, sort=False))
    columns = min(COLUMNS, len(motions))
    lines = -(-len(motions) // columns)
    figure = _figure(3.4 * columns + 0.6, 3.1 * lines + 1.4)
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    engines = [engine for engine in runs["engine"].unique() if engine != OURS]
    handles, ours = {}, set()
    for panel, ((motion, EA, segments), part) in zip(panels, motions, strict=False):
        done = part.dropna(subset=["error_mm"])
        done = done[done["error_mm"] < LOST]
        floor = part["reference_mm"].iloc[0]
        for (engine, method), line in done.groupby(["engine", "method"], sort=False):
            if engine == OURS:
                colour, mark = own_look(method)
                ours.add(method)
                drawn = {
                    "color": colour,
                    "marker": mark,
                    "lw": 1.8 if method == "edmc" else 0.9,
                    "ms": 5,
                    "ls": LINES.get(method, "-"),
                }
                label = method
            else:
                mark = MARKS[list(done[done["engine"] == engine]["method"].unique()).index(method)]
                colour = PEER_COLOURS[engines.index(engine)]
                drawn = {"color": colour, "marker": mark, "ls": "--", "lw": 1.2, "ms": 4, "mfc": "none"}
                label = f"{engine} {method}".strip()
            handles.setdefault(label, panel.loglog(line["wall_s"], line["error_mm"].clip(lower=SEEN), **drawn)[0])
        panel.set_ylim(max(done["error_mm"].min(), SEEN) / 2, LOST)
        panel.set_xlim(10 ** np.floor(np.log10(done["wall_s"].min())), 10 ** np.ceil(np.log10(done["wall_s"].max())))
        panel.axhspan(1e-12, floor, color="0.9", lw=0)
        panel.set_title(f"{motion}, {stiffness(EA)}, {segments} segments", fontsize=8)
        panel.grid(color="0.9", lw=0.5)
        panel.tick_params(labelsize=8)
        panel.xaxis.set_minor_formatter(NullFormatter())
    for panel in panels[max(0, len(motions) - columns) : len(motions)]:
        panel.set_xlabel("wall time [s]", fontsize=9)
    for panel in panels[len(motions) :]:
        panel.axis("off")
    figure.supylabel("largest error of p0 or of the tip [mm]", fontsize=10)
    handles[DOUBT] = panels[0].fill_between([], [], color="0.9")
    order = sorted(handles, key=lambda name: (name not in ours, name == DOUBT))
    figure.legend([handles[name] for name in order], order, loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    return figure


def _parts(table):
    stiffnesses = table["EA_N"].unique()
    figure = _figure(2.5 * len(stiffnesses) + 0.4, 3.9)
    panels = figure.subplots(1, len(stiffnesses), sharey=True, squeeze=False)[0]
    for panel, EA in zip(panels, stiffnesses, strict=True):
        part = table[(table["EA_N"] == EA) & (table["method"] == "edmc")]
        one = part.groupby("segments").first()
        panel.loglog(one.index, one["discretisation_mm"], "k-o", ms=4, label="discretisation: segments instead of a continuum")
        model = one["model_mm"].where(one["model_mm"] > 0)
        panel.loglog(one.index, model, color=GREEN, ls="-.", lw=1.5, label="model: stretches instead of being inextensible")
        for i, (step, line) in enumerate(part.groupby("step_ms", sort=False)):
            own = look(i)
            panel.loglog(line["segments"], line["time_mm"], lw=1.2, ms=4, label=f"time: edmc at {step:g} ms", **own)
            total = own | {"linestyle": "none", "mfc": "none"}
            panel.loglog(line["segments"], line["total_mm"], ms=8, label=f"total at {step:g} ms", **total)
        panel.set(title=stiffness(EA), xlabel="segments of a cable")
        panel.set_xticks(one.index, [str(n) for n in one.index])
        panel.minorticks_off()
        panel.grid(color="0.9", lw=0.5)
    panels[0].set_ylabel("largest error of p0 [mm]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    return figure


def _front(table):
    from matplotlib.lines import Line2D

    raced = table[table["EA_N"].isin(table.loc[table["on_front"], "EA_N"].unique()) & table["total_mm"].lt(LOST)]
    figure = _figure(8.6, 4.8)
    axes = figure.subplots()
    segments, stiffnesses = list(raced["segments"].unique()), list(raced["EA_N"].unique())
    for (method, N, EA), part in raced.groupby(["method", "segments", "EA_N"], sort=False):
        colour = COLOURS[segments.index(N)]
        fill = FILLS[stiffnesses.index(EA)]
        mark = own_look(method)[1]
        axes.loglog(part["wall_s"], part["total_mm"], ls="none", marker=mark, color=colour, fillstyle=fill, ms=5, alpha=0.8)
    front = table[table["on_front"]].sort_values("wall_s")
    axes.loglog(front["wall_s"], front["total_mm"], "k-", lw=1.2, drawstyle="steps-post", zorder=0)
    axes.set(xlabel="wall time of 4 s of motion [s]", ylabel="total error of p0 against\nthe continuous inextensible cable [mm]")
    axes.grid(color="0.9", lw=0.5)
    methods = list(raced["method"].unique())
    keys = [Line2D([], [], color=COLOURS[i], marker="o", ls="none", label=f"{N} segments") for i, N in enumerate(segments)]
    keys += [Line2D([], [], color="0.3", marker=own_look(name)[1], ls="none", label=name) for name in methods]
    keys += [
        Line2D([], [], color="0.3", marker="o", ls="none", fillstyle=fill, label=stiffness(EA))
        for fill, EA in zip(FILLS, stiffnesses, strict=False)
    ]
    keys.append(Line2D([], [], color="k", label="front: nothing is faster and closer"))
    figure.legend(handles=keys, loc="outside right upper", frameon=False, fontsize=8)
    return figure


def _growth(table):
    figure = _figure(6.0, 3.9)
    axes = figure.subplots()
    axes.loglog(table["nodes"], table["wall_s"], "-o", color=BLUE, label="edmc at 10 ms")
    axes.loglog(table["nodes"], table["verlet_predicted_s"], "k--v", label="verlet at its limit, by the pace of a few steps")
    axes.loglog(table["nodes"], table["wall_s"].iloc[0] * table["nodes"] / table["nodes"].iloc[0], color="0.6", lw=0.8, ls=":",
                label="in proportion to the nodes")  # fmt: skip
    axes.set(xlabel="nodes of the carried net", ylabel="wall time of 1 s of motion [s]")
    axes.grid(color="0.9", lw=0.5)
    figure.legend(*axes.get_legend_handles_labels(), frameon=False, fontsize=8, loc="outside lower center", ncols=2)
    return figure
