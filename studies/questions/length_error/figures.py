"""Figures of the study `length_error`."""

from anet_lumped.views.palette import BLACK, BLUE, DASHES, GREEN, MARKS, ORANGE, SKY, VERMILION
from studies.questions.length_error.stretch import SCHEMES, THESIS_SEGMENTS, THESIS_STRETCH, shown_segments
from studies.shown.scheme_styles import style
from studies.study import Drawing
from studies.thesis_cable import CORD_EA, LENGTH

LOOKS = {  # colour, mark and dashes of an arrangement
    "hung": (BLACK, "o", "-"), "0.5 m apart": (SKY, "s", "--"), "0.8 m apart": (BLUE, "D", "-."), "1.0 m apart": (GREEN, "^", ":"),
    "two cables": (VERMILION, "v", (0, (5, 1))),
}  # fmt: skip
STEP_COLOURS = {1e-2: (VERMILION, ORANGE), 1e-3: (BLUE, SKY)}  # by step [s], a shade for each of SCHEMES


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "stretch_over_stiffness": Drawing(
            _plot_stretch(rows["shape"], rows["springs"]),
            f"Stretch of the cable at rest over its stiffness, by arrangement. Marks: lumped, {shown_segments(rows['shape'])} "
            "segments; lines: elastic catenary; stars: the springs that make it 1.1 m long, as the thesis's cable was.",
        ),
        "distance_from_both_catenaries": Drawing(
            _plot_distance(rows["shape"]),
            "Distance (RMSE) of the lumped nodes from the catenary that does not stretch and from the elastic one, between "
            "supports 0.8 m apart, by number of segments.",
        ),
        "error_over_segments": Drawing(
            _plot_refinement(rows["refinement"]),
            "What the number of segments alone makes of the sag and of the first frequency of small swings.",
        ),
        "stretch_floor_and_its_cure": Drawing(
            _plot_floor(rows["floor"], rows["cure"]),
            "The least stretch that an explicit step leaves possible, and the stretch of the same cable with edmc. Left: lines "
            "predicted, marks measured, of the hung cable. Right: the largest stretch of its swing over its stiffness.",
        ),
    }


def _plot_stretch(table, springs):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4.4), layout="constrained")
    axes = figure.subplots()
    for name, group in table[table["segments"].isin((shown_segments(table), THESIS_SEGMENTS))].groupby("arrangement", sort=False):
        color, mark, dashes = LOOKS[name]
        axes.loglog(group["EA_N"], 100 * group["stretch_catenary"], color=color, lw=1, ls=dashes)
        axes.loglog(group["EA_N"], 100 * group["stretch"], mark, ms=5, color=color, mfc="w", label=name)
    axes.plot(springs["EA_N"], [100 * THESIS_STRETCH] * len(springs), "*", ms=11, mfc="w", mec="k", label="makes 1.1 m")
    axes.axhline(100 * THESIS_STRETCH, color="0.4", lw=1, ls="--", zorder=0)
    axes.text(9e5, 115 * THESIS_STRETCH, "1.1 m, the thesis", ha="right", va="bottom", color="0.3")
    axes.axvline(CORD_EA, color="0.4", lw=1, ls=":")
    axes.text(0.9 * CORD_EA, 3e-5, "3 mm nylon", color="0.3", ha="right")
    axes.set(xlabel="axial stiffness EA [N]", ylabel="stretch of the cable [%]")
    top = axes.secondary_xaxis("top", functions=(_spring_of, _stiffness_of))
    top.set_xlabel(f"spring of one of {THESIS_SEGMENTS} segments [N/m]")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside right center", frameon=False)
    return figure


def _spring_of(EA):
    return EA * THESIS_SEGMENTS / LENGTH


def _stiffness_of(k):
    return k * LENGTH / THESIS_SEGMENTS


def _plot_distance(table):
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    between = table[table["arrangement"] == "0.8 m apart"]
    for axes, column, title in zip(
        panels,
        ("rmse_inextensible_mm", "rmse_elastic_mm"),
        ("from the catenary that does not stretch", "from the elastic catenary"),
        strict=True,
    ):
        for i, (n, group) in enumerate(between.groupby("segments")):
            color = colormaps["viridis"](i / (between["segments"].nunique() - 0.7))
            axes.loglog(group["EA_N"], group[column], marker=MARKS[i], ls=DASHES[i % len(DASHES)], ms=4, color=color, label=f"{n}")
        axes.axvline(CORD_EA, color="0.5", lw=1, ls=":")
        axes.set(xlabel="axial stiffness EA [N]", title=title)
    panels[0].set_ylabel("RMSE of the nodes [mm]")
    panels[0].text(1.15 * CORD_EA, 60, "3 mm nylon", color="0.3")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right center", title="segments", frameon=False)
    return figure


def _plot_refinement(table):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    n = table["segments"].to_numpy(float)
    left.loglog(n, table["sag_error_mm"], "o-", color=BLUE, label="lumped, EA = 1e9 N")
    left.loglog(n, 0.5 * table["sag_error_mm"].iloc[0] * (n / n[0]) ** -2, "k--", lw=1, label="slope −2")
    left.set(ylabel="error of the sag [mm]", title="rest between supports 0.8 m apart")
    for name, color, marker, words in (("half", BLUE, "o", "half a segment"), ("full", VERMILION, "s", "a segment")):
        column = f"swing_error_{name}_end_mass_percent"
        right.loglog(n, table[column], marker + "-", color=color, label=f"loose end: the mass of {words}")
    right.loglog(n, 0.5 * table["swing_error_half_end_mass_percent"].iloc[0] * (n / n[0]) ** -2, "k--", lw=1,
                 label="slope −2")  # fmt: skip
    start = table["swing_error_full_end_mass_percent"].iloc[0]
    right.loglog(n, 2 * start * n[0] / n, "k:", lw=1, label="slope −1")
    right.set(ylabel="error of the first frequency [%]", title="small swings of the hung cable")
    for axes in (left, right):
        axes.set_xlabel("segments")
        axes.set_xticks(n, [f"{k:.0f}" for k in n])
        axes.minorticks_off()
    for axes in (left, right):
        axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=2)
    return figure


def _plot_floor(floors, cure):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.3), layout="constrained")
    left, right = figure.subplots(1, 2)
    hung = floors[floors["arrangement"] == "hung"]
    lines = ((scheme, dt, shade) for dt, shades in STEP_COLOURS.items() for scheme, shade in zip(SCHEMES, shades, strict=True))
    for scheme, dt, color in lines:
        name, _, marker, _ = style(scheme)
        line = hung[(hung["scheme"] == scheme) & (hung["dt_s"] == dt)].sort_values("segments")
        left.loglog(line["segments"], 100 * line["floor_closed_form"], "-" if scheme == "rk4" else "--", color=color, lw=1)
        label = f"{name}, {1e3 * dt:g} ms"
        left.loglog(line["segments"], 100 * line["floor_measured"], marker, ms=6, mfc="w", color=color, label=label)
    left.axhline(100 * THESIS_STRETCH, color="0.4", lw=1, ls="--")
    left.text(5, 115 * THESIS_STRETCH, "1.1 m", color="0.3", va="bottom")
    ticks = sorted(hung["segments"].unique())
    left.set_xticks(ticks, ticks)
    left.minorticks_off()
    left.set(xlabel="segments", ylabel="least stretch that the step permits [%]",
             title="hung cable")  # fmt: skip

    rest = cure[cure["scheme"] == "edmc"].drop_duplicates("EA_N").sort_values("EA_N")
    right.loglog(rest["EA_N"], 100 * rest["stretch_at_rest"], "-", color="0.5", lw=1, label="at rest, m g/2EA")
    for dt, marker, size in ((1e-2, "o", 9), (1e-3, ".", 7)):
        edmc = cure[(cure["scheme"] == "edmc") & (cure["dt_s"] == dt) & (cure["ended"] == "done")]
        right.loglog(edmc["EA_N"], 100 * edmc["largest_stretch"], marker, ms=size, mfc="w" if marker == "o" else None,
                     color=GREEN, label=f"edmc, {1e3 * dt:g} ms: largest of a swing")  # fmt: skip
        floor_here = hung[(hung["scheme"] == "rk4") & (hung["dt_s"] == dt)]
        floor_here = floor_here[floor_here["segments"] == min(THESIS_SEGMENTS, floor_here["segments"].max())]
        right.axhline(100 * floor_here["floor_measured"].iloc[0], color="k", lw=1)
        right.text(0.98, 115 * floor_here["floor_measured"].iloc[0], f"floor of RK4, {1e3 * dt:g} ms", ha="right",
                   va="bottom", fontsize=9, color="0.2", transform=right.get_yaxis_transform())  # fmt: skip
    right.set_ylim(top=3 * right.get_ylim()[1])
    right.set(xlabel="axial stiffness EA [N]", ylabel="stretch [%]", title=f"hung cable of {THESIS_SEGMENTS} segments")
    for axes in (left, right):
        axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    return figure
