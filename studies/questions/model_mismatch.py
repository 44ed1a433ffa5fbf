"""How far is the lumped net from the catenary in the thesis's three cases, and what do the thesis's own tables say?

Cases I to III of chapter 4: level supports, one corner high, loaded at p0 with 7, 9 and 36 g. The thesis measured two
crossed cables of 1.76 m with markers on them; its marker positions and supports are not given, so that its numbers
stand beside these and only what follows from them alone is drawn.
"""

import numpy as np
import pandas as pd

from anet_lumped.advice.compare import compare, r_squared
from anet_lumped.advice.markers import fit_markers
from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary_net import catenary_net
from anet_lumped.statics.equilibrium import equilibrium
from anet_lumped.views.palette import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, look
from studies.shown.sentences import between, listed, power, share
from studies.shown.show import as_text
from studies.study import Drawing, Part, Record
from studies.sweeping.rows import run_rows

STUDY = Record(question=__doc__.splitlines()[0], part=Part.FOUND)
TABLES = {
    "mismatch": "A line for each case, number of segments and cable: the lumped net at rest against the continuous one.",
    "shapes": "A line for each node of 5 segments, and for each of 101 points of the catenary, along the diagonal from s0 to s2.",
    "thesis": "A line for each branch in the thesis's tables 4.2 to 4.6, and what follows from its two numbers alone.",
    "origin": "A line for each height of the supports above the frame's origin: R² of one and the same misfit.",
    "markers": "A line for each cable of a net whose made-up markers were put in order: lengths before and after the fit.",
    "cloud": "A line for each of those markers: the cable that it was made on, and the one that it was given to (-1 for strays).",
}

LENGTH = 0.88  # of a branch: half of 1.76 m
MASS_PER_LENGTH = 0.083 / (4 * LENGTH)  # 83 g for both cables: the thesis gives 7 g as 8.4 % "of the cables"
EA = 1e4  # [N], about 3 mm nylon
SIDE = 0.8  # of the square of supports [m], chosen
RAISED = 0.2  # of one corner in case II [m], chosen
CASES = {"I level": 0.0, "II one corner high": 0.0, "III sheet 7 g": 7.0, "III cube 9 g": 9.0, "III bottle 36 g": 36.0}
SEGMENTS = (5, 10, 20, 40)
THESIS = {  # RMSE (no unit given) and R squared of catenary 1 to 4, tables 4.2 to 4.6
    "I level": ((0.0335, 0.9972), (0.0332, 0.9967), (0.0404, 0.9947), (0.0191, 0.9991)),
    "II one corner high": ((0.0587, 0.9938), (0.0850, 0.9848), (0.0024, 1.0), (0.0012, 1.0)),
    "III sheet 7 g": ((0.0128, 0.9995), (0.0328, 0.9960), (0.0187, 0.9986), (0.0277, 0.9979)),
    "III cube 9 g": ((0.0174, 0.9991), (0.0513, 0.9903), (0.0326, 0.9957), (0.0483, 0.9935)),
    "III bottle 36 g": ((0.0579, 0.9898), (0.0632, 0.9855), (0.0475, 0.9910), (0.0659, 0.9878)),
}
MOST_SPREAD = LENGTH / 2  # standard deviation of one coordinate if half of a branch's points sit at either end
NOISE, OUTLIERS, HIDDEN, SPACING = 0.002, 0.10, 0.20, 0.04  # of the made-up markers [m], -, -, [m]
MADE_LENGTHS = (0.90, 0.87, 0.86, 0.89)  # of the net that they are made from [m]
SEED = 1


def thesis_net(case, segments=20, lengths=(LENGTH,) * 4):
    """The thesis's net in one of its cases.

    Parameters
    ----------
    case : key of CASES
    segments : int, of each branch
    lengths : (4,) [m]

    Returns
    -------
    Scene
    """
    half = SIDE / 2
    corners = [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]]
    if case.startswith("II "):
        corners[0][2] = RAISED
    return Scene(
        points=[Fixed(f"s{i}", at) for i, at in enumerate(corners)] + [Free("p0", mass=CASES[case] / 1e3)],
        cables=[
            Cable(f"s{i}", "p0", length=length, mass_per_length=MASS_PER_LENGTH, EA=EA, segments=segments)
            for i, length in enumerate(lengths)
        ],
        effects=[Gravity(9.81)],
    )


def exact_net(scene):
    """The continuous net of a scene, from below the middle of its supports."""
    places = {point.name: point.at or (0.0, 0.0, -0.5) for point in scene.points}
    return catenary_net(scene, places)


def mismatch(row):
    """Columns of one row of the table: a case, a number of segments, a cable."""
    state = equilibrium(thesis_net(row["case"], row["segments"]))
    against, own_ends = compare(state), compare(state, reference="ends")
    (cable,), (own,) = ([c for c in found.cables if c.cable == row["cable"]] for found in (against, own_ends))
    return {
        "rmse_mm": 1e3 * cable.rmse,
        "rmse_height_mm": 1e3 * cable.rmse_height,
        "rmse_to_curve_mm": 1e3 * cable.rmse_curve,
        "rmse_own_ends_mm": 1e3 * own.rmse,
        "r_squared_vertical": cable.r_squared_vertical,
        "r_squared_pooled": cable.r_squared_pooled,
        "stretch": cable.stretch,
        "length_error_mm": 1e3 * cable.length_error,
        "sag_error_mm": 1e3 * cable.sag_error,
        "tension_error_percent": 100 * cable.tension_error / cable.tension_reference,
        "end_force_error_percent": 100 * cable.end_force_error / cable.tension_reference,
        "p0_error_mm": 1e3 * float(np.linalg.norm(against.points["p0"])),
    }


def compute(quick=False, executor=None, out=None):
    """The tables."""
    segments = SEGMENTS[:2] if quick else SEGMENTS
    rows = [{"case": c, "segments": n, "cable": f"s{i}-p0"} for c in CASES for n in segments for i in range(4)]
    markers, cloud = _markers()
    return {
        "mismatch": run_rows(mismatch, rows, executor=executor, out=out and out / "mismatch"),
        "shapes": pd.concat([_shapes(case) for case in ("I level", "II one corner high", "III bottle 36 g")]),
        "thesis": _thesis(),
        "origin": _origin(),
        "markers": markers,
        "cloud": cloud,
    }


def _shapes(case):
    """Nodes of 5 segments and the exact curves of the diagonal s0 to s2, in its vertical plane."""
    nodes, curves = equilibrium(thesis_net(case, 5)), exact_net(thesis_net(case))
    rows = []
    for cable in ("s0-p0", "s2-p0"):
        curve = curves.cables[cable].point(np.linspace(0, LENGTH, 101))
        for kind, line in (("lumped", nodes.shape(cable)), ("catenary", curve)):
            along = (line[:, 0] + line[:, 1]) / np.sqrt(2)
            rows.append(pd.DataFrame({"case": case, "cable": cable, "kind": kind, "along_m": along, "z_m": line[:, 2]}))
    return pd.concat(rows)


def _thesis():
    rows = []
    for case, branches in THESIS.items():
        for number, (error, r2) in enumerate(branches, 1):
            spread = error / np.sqrt(1 - r2) if r2 < 1 else np.nan
            rows.append(
                {
                    "case": case,
                    "catenary": number,
                    "rmse_m": error,
                    "r_squared": r2,
                    "spread_of_Y_m": spread,
                    "spread_over_most": spread / MOST_SPREAD,
                    "supports_above_origin_m": _height_for(spread) if r2 < 1 else np.nan,
                    "r_squared_if_height": 1 - (error / _spreads(0.0)[2]) ** 2,
                }
            )
    return pd.DataFrame(rows)


def _points_of_a_branch():
    return exact_net(thesis_net("I level")).cables["s0-p0"].point(np.linspace(0, LENGTH, 201))


def _spreads(height):
    """Standard deviation of x, y, z and of the three pooled [m], supports at `height` above a frame's origin."""
    points = _points_of_a_branch() + np.array([0.0, 0.0, height])
    return (*points.std(axis=0), points.std())


def _height_for(spread):
    """Height of the supports [m] above an origin below the middle of their square at which pooled Y has this spread."""
    heights = np.linspace(0.7, 4.0, 331)
    points = _points_of_a_branch()
    pooled = [(points + np.array([0.0, 0.0, height])).std() for height in heights]
    return float(np.interp(spread, pooled, heights))


def _origin():
    """R squared of one and the same misfit, the thesis's median RMSE, over the frame's origin."""
    error = float(np.median([error for branches in THESIS.values() for error, _ in branches]))
    rng = np.random.default_rng(SEED)
    points = _points_of_a_branch()
    misfit = rng.normal(size=points.shape)
    misfit *= error / np.sqrt((misfit**2).mean(axis=0))
    rows = []
    for height in np.linspace(0.0, 3.0, 61):
        seen = points + np.array([0.0, 0.0, height])
        rows.append(
            {
                "supports_above_origin_m": height,
                "rmse_m": error,
                "r_squared_pooled": r_squared(seen, seen + misfit),
                "r_squared_vertical": r_squared(seen[:, 2], seen[:, 2] + misfit[:, 2]),
                "spread_pooled_m": float(seen.std()),
            }
        )
    return pd.DataFrame(rows)


def _markers():
    """Markers as a motion-capture file holds them, of a net whose lengths differ from the model's, and the fit."""
    rng = np.random.default_rng(SEED)
    truth = thesis_net("II one corner high", lengths=MADE_LENGTHS)
    exact = exact_net(truth)
    arcs = [np.arange(SPACING / 2, length - SPACING / 4, SPACING) for length in MADE_LENGTHS]
    xyz = np.concatenate([exact.cables[f"s{i}-p0"].point(arc) for i, arc in enumerate(arcs)])
    cable = np.repeat(np.arange(4), [len(arc) for arc in arcs])
    seen = rng.random(len(xyz)) >= HIDDEN
    xyz, cable, made = xyz[seen] + rng.normal(0, NOISE, (seen.sum(), 3)), cable[seen], np.bincount(cable)
    strays = rng.uniform((-0.5, -0.5, -0.8), (0.5, 0.5, 0.3), (round(OUTLIERS * len(xyz)), 3))
    xyz, cable = np.concatenate([xyz, strays]), np.concatenate([cable, np.full(len(strays), -1)])
    shuffled = rng.permutation(len(xyz))
    xyz, cable = xyz[shuffled], cable[shuffled]
    fit = fit_markers(xyz, thesis_net("II one corner high"))
    rows = [
        {
            "cable": match.cable,
            "markers": match.markers,
            "hidden": made[i] - int((cable == i).sum()),
            "hidden_found": match.missing,
            "length_true_m": MADE_LENGTHS[i],
            "length_model_m": match.length_before,
            "length_fitted_m": match.length_after,
            "length_standard_error_m": match.length_standard_error,
            "rmse_before_mm": 1e3 * match.rmse_before,
            "rmse_after_mm": 1e3 * match.rmse_after,
            **{f"r_squared_{axis}_after": r2 for axis, r2 in zip("xyz", match.r_squared_after, strict=True)},
        }
        for i, match in enumerate(fit.cables)
    ]
    cloud = pd.DataFrame(xyz, columns=["x_m", "y_m", "z_m"])
    return pd.DataFrame(rows), cloud.assign(made_as=cable, sequenced_as=fit.sequence.cable, arc_m=fit.sequence.arc)


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "shapes_in_the_plane_of_a_diagonal": Drawing(
            _plot_shapes(rows["shapes"]),
            "The net at rest in the upright plane of a diagonal: nodes of 5 segments a branch on the exact catenaries.",
        ),
        "error_over_segments": Drawing(
            _plot_refinement(rows["mismatch"]),
            "Error of the lumped net against the continuous one over the number of segments, the worst of the four branches of "
            "each case.",
        ),
        "spread_behind_the_tables_of_the_thesis": Drawing(
            _plot_thesis(rows["thesis"], rows["origin"]),
            "What the thesis's RMSE and R² say together. Left: the spread of Y that each branch of its tables implies, above what "
            "one coordinate of a branch can have. Right: R² of one and the same misfit over the height of the supports above the "
            "frame's origin; in the grey range it gives the spreads on the left.",
        ),
        "unordered_markers_put_in_order": Drawing(
            _plot_markers(rows["cloud"]),
            "Made-up markers of a net seen from the side. Left: by the cable that they were made on. Right: by the cable and the "
            "order that the fit gave them.",
        ),
    }


def _plot_shapes(shapes):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.2), layout="constrained")
    panels = figure.subplots(1, 3, sharey=True)
    styles = {"catenary": {"color": "k", "lw": 1}, "lumped": {"color": VERMILION, "marker": "o", "ms": 4, "lw": 0.8, "ls": "--"}}
    for axes, (case, group) in zip(panels, shapes.groupby("case", sort=False), strict=True):
        for (_, kind), line in group.groupby(["cable", "kind"]):
            axes.plot(line["along_m"], line["z_m"], **styles[kind])
        axes.set(title=case, xlabel="along the diagonal s0–s2 [m]", aspect="equal")
    panels[0].set_ylabel("z [m]")
    handles = [panels[0].lines[1], panels[0].lines[0]]
    names = ["lumped, 5 segments a branch", "catenary"]
    figure.legend(handles, names, loc="outside lower center", ncols=2, frameon=False)
    return figure


def _plot_refinement(table):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 6), layout="constrained")
    panels = figure.subplots(2, 2)
    for axes, (column, label) in zip(
        panels.flat,
        (
            ("rmse_mm", "RMSE, equal arc length [mm]"),
            ("p0_error_mm", "distance of p0 [mm]"),
            ("length_error_mm", "|length error| [mm]"),
            ("tension_error_percent", "|tension error| [%]"),
        ),
        strict=True,
    ):
        worst = table.assign(error=table[column].abs()).groupby(["case", "segments"], sort=False)["error"].max()
        for i, case in enumerate(CASES):
            axes.loglog(worst[case].index, worst[case], ms=5, lw=1, label=case, **look(i))
        n = worst[case].index.to_numpy(dtype=float)
        axes.loglog(
            n, 0.5 * worst.groupby("segments").min().iloc[0] * (n / n[0]) ** -2, "k", ls=(0, (1, 1)), lw=1, label="slope −2"
        )
        axes.set(xlabel="segments of a branch", ylabel=label)
        axes.set_xticks(n, [f"{k:.0f}" for k in n], minor=False)
        axes.minorticks_off()
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    return figure


def _plot_thesis(thesis, origin):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.5, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
    for i, (_, group) in enumerate(thesis.groupby("case", sort=False)):
        left.plot(np.linspace(-0.25, 0.25, 4) + i, group["spread_of_Y_m"], "o", color="0.3")
    left.axhspan(MOST_SPREAD, 0.8, color=VERMILION, alpha=0.1, lw=0)
    left.axhline(MOST_SPREAD, color=VERMILION)
    left.text(4.45, MOST_SPREAD - 0.01, f"the most that one coordinate of\na branch can have: {MOST_SPREAD:.2f} m",
              color=VERMILION, va="top", ha="right", fontsize=8)  # fmt: skip
    for spread, name, color, dashes in zip(_spreads(0.0)[1:3], ("x or y", "z"), (BLUE, GREEN), (":", "-."), strict=True):
        left.axhline(spread, color=color, ls=dashes)
        left.text(-0.45, spread + 0.01, f"{name} of the catenary, case I", color=color, fontsize=8)
    left.set_xticks(range(len(CASES)), [case.replace(" ", "\n", 1) for case in CASES], fontsize=8)
    left.set(ylim=(0, 0.8), xlim=(-0.5, 4.5), ylabel="spread of Y behind the thesis's tables,\nRMSE/√(1 − R²) [m]")
    heights = origin["supports_above_origin_m"]
    right.plot(heights, origin["r_squared_pooled"], color=VERMILION, label="Y pools x, y and z")
    right.plot(heights, origin["r_squared_vertical"], color=GREEN, ls="-.", label="Y is the height z")
    right.axvspan(thesis["supports_above_origin_m"].min(), thesis["supports_above_origin_m"].max(), color="0.9")
    right.set(
        xlabel="height of the supports above the frame's origin [m]", ylim=(0.94, 1.002), xlim=(0, 3),
        ylabel=f"R² of one and the same misfit, RMSE {origin['rmse_m'].iloc[0]:.3f} m",
    )  # fmt: skip
    figure.legend(*right.get_legend_handles_labels(), frameon=False, loc="outside lower right", ncols=2)
    return figure


def _plot_markers(cloud):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 4), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    marks = (("o", BLUE), ("s", ORANGE), ("^", PURPLE), ("D", SKY))
    for axes, column, title in ((panels[0], "made_as", "as made"), (panels[1], "sequenced_as", "as put in order")):
        for cable in range(-1, 4):
            part = cloud[cloud[column] == cable]
            if cable < 0:
                axes.plot(part["x_m"], part["z_m"], "x", color="0.5", label="strays")
            else:
                part = part.sort_values("arc_m")
                mark, color = marks[cable]
                axes.plot(part["x_m"], part["z_m"], mark + "-" * (column == "sequenced_as"), ms=4, lw=1, color=color,
                          label=f"s{cable}-p0")  # fmt: skip
        axes.set(title=title, xlabel="x [m]", aspect="equal")
    panels[0].set_ylabel("z [m]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    return figure


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    table, thesis, origin, markers, cloud = (rows[k] for k in ("mismatch", "thesis", "origin", "markers", "cloud"))
    return "\n\n".join([
        _finding(table, thesis, origin), _refined(table), _of_the_thesis(thesis, origin), _ordered(markers, cloud), LEFT_OUT,
    ])  # fmt: skip


def _worst(table):
    return table.groupby("segments")[["rmse_mm", "p0_error_mm", "tension_error_percent"]].agg(lambda column: column.abs().max())


def _finding(table, thesis, origin):
    worst, misfit = _worst(table), 1e3 * thesis["rmse_m"].median()
    finest, coarsest = worst.iloc[-1], worst.iloc[0]
    times = misfit / coarsest.rmse_mm
    pooled = origin["r_squared_pooled"]
    moves = pooled.max() - pooled.min() > 10 * (1.0 - pooled.max())
    return (
        f"With {worst.index[-1]} segments a branch the lumped net is within {as_text(finest.rmse_mm, 2)} mm (RMSE) of the "
        f"continuous one in all of the thesis's cases. The thesis's own misfit, catenary against measurement, is {misfit:.0f} mm "
        f"in the median, {as_text(times, 2)} times that of {worst.index[0]} segments: "
        f"{'the segments do not explain it' if times > 2.0 else 'the segments may explain it'}. "
        + (
            "Its R² of 0.99 says little, because it pools coordinates around one mean: the same misfit has "
            f"R² = {pooled.min():.4f} or {pooled.max():.4f}, depending on where the frame's origin is."
            if moves
            else f"Its R² of pooled coordinates hardly depends on the frame's origin: {pooled.min():.4f} to {pooled.max():.4f}."
        )
    )


def _refined(table):
    worst = _worst(table)
    n, finest = worst.index.to_numpy(dtype=float), worst.iloc[-1]
    by_n = listed(f"{as_text(row.rmse_mm, 2)} mm with {segments}" for segments, row in worst.iterrows())
    slope = np.polyfit(np.log(n), np.log(worst["rmse_mm"]), 1)[0]
    return (
        f"The worst RMSE of a branch at equal arc length is {by_n} segments; it falls as N to the power {slope:.2f}. With "
        f"{n[-1]:.0f} segments p0 is off by {as_text(finest.p0_error_mm, 2)} mm and the tension by "
        f"{as_text(finest.tension_error_percent, 2)} %. R² of the height is {table['r_squared_vertical'].min():.5f} or more, and "
        f"no branch is stretched by more than {power(table['stretch'].max(), 2)} at EA = {power(EA)} N. The error of the sag jumps "
        "with N, as the lowest point of a branch is a node or lies between two."
    )


def _of_the_thesis(thesis, origin):
    finite = thesis.dropna()
    too_wide = (finite["spread_of_Y_m"] > MOST_SPREAD).sum()
    low, high = (origin.iloc[(origin["supports_above_origin_m"] - height).abs().argmin()] for height in (0.5, 2.0))
    contradicted = thesis[thesis["case"].str.startswith("II ")]["r_squared"].min()
    words = (
        f"RMSE/√(1 − R²), the spread of Y, is {between(finite['spread_of_Y_m'], 'm', 2)} in the {len(finite)} rows of the thesis's "
        f"tables whose R² is below 1 (RMSE read in metres, no unit is given). No coordinate of a branch of {LENGTH} m can spread "
        f"by more than {MOST_SPREAD:.2f} m, and {share(too_wide, len(finite))} rows exceed it. Of pooled coordinates, a "
        f"misfit of {1e3 * origin['rmse_m'].iloc[0]:.0f} mm has R² = {low.r_squared_pooled:.4f} with the supports 0.5 m above the "
        f"origin and {high.r_squared_pooled:.4f} at 2 m; the height alone has {low.r_squared_vertical:.3f} and "
        f"{high.r_squared_vertical:.3f}. An origin {between(finite['supports_above_origin_m'], 'm', 2)} below the supports, such "
        f"as the floor, would give each row its spread (an inference, from a square of {SIDE} m)."
    )
    if contradicted < 0.998:
        words += f" The text's 99.8 % for all four cables of case II is contradicted by its table, which has {contradicted}."
    return words


def _ordered(markers, cloud):
    right = (cloud["made_as"] == cloud["sequenced_as"]).mean()
    miss = (markers["length_fitted_m"] - markers["length_true_m"]).abs().max()
    return (
        f"The model can put unordered markers in order: of {len(cloud)} made-up ones with {NOISE * 1e3:.0f} mm of noise, "
        f"{100 * OUTLIERS:.0f} % strays and {100 * HIDDEN:.0f} % hidden, {100 * right:.1f} % are given to the right cable or "
        f"rightly thrown out, and the fitted lengths are within {as_text(miss * 1e3, 2)} mm of the true ones. The largest RMSE of "
        f"a cable is {as_text(markers['rmse_before_mm'].max(), 2)} mm before the fit and "
        f"{as_text(markers['rmse_after_mm'].max(), 2)} mm after."
    )


LEFT_OUT = f"""Left out: the thesis's rows themselves cannot be computed again, because neither supports nor markers are given, nor
which coordinate Y is. The square of {SIDE} m and the corner raised by {RAISED} m are chosen. 83 g is read as the mass of both
cables together, as the thesis's 8.4 % for 7 g implies; were it that of each, only tensions would change in cases I and II, and
the loads of case III would weigh half as much against the cables. Bending stiffness, which real cords have, is in neither model."""
