"""How much longer than its cord is the lumped cable, how far is it from the catenary, and why was the thesis's 1.1 m long?

The static shape of a cable of 1 m and 0.1 kg against the inextensible and the elastic catenary, over stiffness and
number of segments; the springs that make it 1.1 m long; and the least stretch that an explicit step leaves possible,
predicted and measured.
"""

from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.optimize import brentq
from scipy.special import jn_zeros

from anet_lumped.advice.compare import compare, rmse
from anet_lumped.effects import Gravity
from anet_lumped.motion.stability import frequency_limit, hanging_stretch_floor, step_limit, top_modes
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary_net import catenary_net
from anet_lumped.statics.equilibrium import equilibrium
from studies.questions.stability_map import CORD_EA, GRAVITY, LENGTH, MASS, REST_GROWTH, energy_rise, quietly, rest_growth
from studies.shown.scheme_styles import style
from studies.sweeping.rows import run_rows

QUESTION = __doc__.splitlines()[0]

SPANS = {"0.5 m apart": 0.5, "0.8 m apart": 0.8, "1.0 m apart": 1.0}  # of the supports [m]
ARRANGEMENTS = ("hung", *SPANS, "two cables")
STIFFNESSES = np.geomspace(1.0, 1e6, 13)  # EA [N]
SEGMENTS = (5, 10, 20, 40, 80, 160)
THESIS_SEGMENTS, THESIS_STRETCH = 20, 0.10
REFINED = (4, 10, 20, 40, 80, 160)  # segments at which the sag's error is taken, even for a node at the lowest point
INEXTENSIBLE = 1e9  # EA that stands for it [N]
STEPS = (1e-3, 1e-2)  # [s]
SCHEMES = ("symplectic_euler", "rk4")
FLOOR_STEPS, FLOOR_RESOLUTION = 2000, 2e-3
CURED = (1e1, 1e2, 1e4, 1e6, 1e9)  # EA [N]
SWING_RATE, SWING_TIME = 1.0, 2.0  # [rad/s], [s]


def arrangement(name, EA, segments, *, full_ends=False):
    """The thesis's cable of 1 m and 0.1 kg in one of its arrangements.

    Parameters
    ----------
    name : one of ARRANGEMENTS
        "hung" from one end, between two supports at the same height, or two cables from supports 1 m apart to p0.
    EA : float [N]
    segments : int
    full_ends : bool
        The loose end carries the mass of a whole segment instead of a half.

    Returns
    -------
    Scene
        All that is asked of it is asked of its first cable, the others being alike.
    """
    extra = MASS / segments / 2 if full_ends else 0.0
    if name == "hung":
        points = [Fixed("s0", (0.0, 0.0, 0.0)), Free("tip", mass=extra)]
        ends = [("s0", "tip")]
    elif name == "two cables":
        points = [Fixed("s0", (0.0, 0.0, 0.0)), Fixed("s1", (1.0, 0.0, 0.0)), Free("p0", mass=extra)]
        ends = [("s0", "p0"), ("s1", "p0")]
    else:
        points = [Fixed("s0", (0.0, 0.0, 0.0)), Fixed("s1", (SPANS[name], 0.0, 0.0))]
        ends = [("s0", "s1")]
    material = {"length": LENGTH, "mass_per_length": MASS / LENGTH, "EA": EA, "segments": segments}
    return Scene(points=points, cables=[Cable(*pair, **material) for pair in ends], effects=[Gravity(GRAVITY)])


def stretch(scene):
    """Mean stretch of the first cable at rest."""
    return equilibrium(scene).length(scene.cables[0].name) / LENGTH - 1


def exact(scene, elastic=True):
    """First cable of the continuous net, a catenary."""
    places = {point.name: point.at or (0.5, 0.0, -0.5) for point in scene.points}
    return catenary_net(scene, places, elastic=elastic).cables[scene.cables[0].name]


# The study ----------------------------------------------------------------------------------------------------------


def compute(quick=False, executor=None, out=None):
    """Tables of the study.

    Returns
    -------
    dict of pandas.DataFrame
        "shape" (stretch and distance from both catenaries), "springs" (that make 1.1 m), "refinement" (over segments),
        "floor" (least stretch of an explicit step, predicted and measured), "cure" (the same steps with `edmc`).
    """
    segments = SEGMENTS[:3] if quick else SEGMENTS
    every = 3 if quick else 1
    shapes = [
        {"arrangement": name, "EA_N": EA, "segments": n}
        for name in ARRANGEMENTS
        for n in (segments if name in ("hung", "0.8 m apart") else (THESIS_SEGMENTS,))
        for EA in STIFFNESSES[::every]
    ]
    floors = [
        {"arrangement": name, "scheme": scheme, "dt_s": dt, "segments": n}
        for name in (("hung", "two cables") if quick else ARRANGEMENTS)
        for n in (segments if name == "hung" else (THESIS_SEGMENTS,))
        for scheme in SCHEMES
        for dt in STEPS
    ]
    cures = [
        {"scheme": scheme, "dt_s": dt, "EA_N": EA}
        for scheme in ("rk4", "edmc")
        for dt in STEPS
        for EA in (CURED[1::2] if quick else CURED)
    ]
    return {
        "shape": run_rows(shape, shapes, executor=executor, out=out and out / "shape"),
        "springs": pd.DataFrame([springs(name) for name in ARRANGEMENTS]),
        "refinement": pd.DataFrame([refinement(n) for n in (REFINED[:4] if quick else REFINED)]),
        "floor": run_rows(floor, floors, executor=executor, out=out and out / "floor"),
        "cure": run_rows(cure, cures, executor=executor, out=out and out / "cure"),
    }


def shape(row):
    """Stretch, and distance of the nodes from both catenaries at the same unstretched arc length."""
    scene = arrangement(row["arrangement"], row["EA_N"], row["segments"])
    nodes = equilibrium(scene).shape(scene.cables[0].name)
    arc = np.linspace(0.0, LENGTH, row["segments"] + 1)
    elastic = exact(scene)
    found = {
        "stretch": stretch(scene),
        "stretch_catenary": elastic.length / LENGTH - 1,
        "rmse_elastic_mm": 1e3 * rmse(elastic.point(arc), nodes),
        "rmse_inextensible_mm": np.nan,
    }
    if row["arrangement"] != "1.0 m apart":  # where a cable that does not stretch would be a straight line
        found["rmse_inextensible_mm"] = 1e3 * rmse(exact(scene, elastic=False).point(arc), nodes)
    return found


def springs(name):
    """Spring of a segment that makes the cable 1.1 m long, and the steps that it permits."""

    def find(of):
        return np.exp(brentq(lambda log_EA: of(np.exp(log_EA)) - THESIS_STRETCH, 0.0, 5.0, xtol=1e-12))

    def lumped(EA, **ends):
        return arrangement(name, EA, THESIS_SEGMENTS, **ends)

    EA = find(lambda EA: stretch(lumped(EA)))
    per_segment = THESIS_SEGMENTS / LENGTH
    omega = max(mode.omega for mode in top_modes(lumped(EA)).values())
    joined = name in ("hung", "two cables")  # to a free point, whose mass counts
    full = find(lambda EA: stretch(lumped(EA, full_ends=True))) if joined else np.nan
    return {
        "arrangement": name,
        "spring_N_per_m": EA * per_segment,
        "spring_full_end_mass_N_per_m": full * per_segment,
        "EA_N": EA,
        "catenary_EA_N": find(lambda EA: exact(lumped(EA)).length / LENGTH - 1),
        "cord_is_stiffer_by": CORD_EA / EA,
        **{f"{scheme}_step_ms": 1e3 * float(step_limit(scheme, omega)) for scheme in SCHEMES},
    }


def refinement(segments):
    """Errors of the discretisation alone, of a cable that hardly stretches."""
    between = compare(equilibrium(arrangement("0.8 m apart", INEXTENSIBLE, segments)), elastic=False).cables[0]
    bessel = jn_zeros(0, 1)[0] / 2 * np.sqrt(GRAVITY / LENGTH)
    row = {"segments": segments, "sag_error_mm": 1e3 * abs(between.sag_error)}
    for full in (False, True):
        name = "full" if full else "half"
        row[f"swing_error_{name}_end_mass_percent"] = 100 * abs(slowest_swing(segments, full) / bessel - 1)
    return row


def slowest_swing(segments, full_ends):
    """Frequency of the first small swing of the hanging chain that does not stretch [rad/s]."""
    mass = np.full(segments, MASS / segments)
    mass[-1] *= 1.0 if full_ends else 0.5
    per_length = np.cumsum(mass[::-1])[::-1] * GRAVITY / (LENGTH / segments)  # tension over length, from the top
    stiffness = np.diag(per_length + np.append(per_length[1:], 0.0))
    stiffness -= np.diag(per_length[1:], 1) + np.diag(per_length[1:], -1)
    return float(np.sqrt(np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(mass, mass)))[0]))


def floor(row):
    """Stretch at the largest EA that a step permits, as predicted and by bisection over runs from rest."""
    name, scheme, dt, segments = row["arrangement"], row["scheme"], row["dt_s"], row["segments"]
    omega = max(mode.omega for mode in top_modes(arrangement(name, 1.0, segments)).values())
    predicted = (frequency_limit(scheme, dt) / omega) ** 2  # omega^2 grows as EA
    low, high = predicted / 4, predicted * 4
    while high / low > 1 + FLOOR_RESOLUTION:
        middle = np.sqrt(low * high)
        stable = rest_growth(arrangement(name, middle, segments), scheme, dt, FLOOR_STEPS)[0] <= REST_GROWTH
        low, high = (middle, high) if stable else (low, middle)
    found = {
        "EA_predicted_N": predicted,
        "EA_measured_N": low,
        "floor_predicted": stretch(arrangement(name, predicted, segments)),
        "floor_measured": stretch(arrangement(name, low, segments)),
    }
    if name == "hung":
        found["floor_closed_form"] = float(hanging_stretch_floor(scheme, dt, LENGTH, segments, GRAVITY))
    return found


def cure(row):
    """The hung cable swings: how far it stretches, and what its energy does."""
    scene = arrangement("hung", row["EA_N"], THESIS_SEGMENTS)
    rest = equilibrium(scene)
    v = np.zeros_like(rest.q)
    v[:, 0] = SWING_RATE * (rest.q[:, 2] - rest.position("s0")[2])
    run = quietly(scene, SWING_TIME, method=row["scheme"], dt=row["dt_s"], start=replace(rest, v=v))
    length = run.length("s0-tip")
    return {
        "stretch_at_rest": rest.length("s0-tip") / LENGTH - 1,
        "largest_stretch": length.max() / LENGTH - 1 if run.reached_end else np.inf,
        "energy_rise": energy_rise(run) / run.energy[0, 0],
        "newton_per_step": run.work.newton_iterations / run.work.steps,
        "ended": run.status,
    }


# Figures and words --------------------------------------------------------------------------------------------------

COLORS = {"hung": "#000000", "0.5 m apart": "#56B4E9", "0.8 m apart": "#0072B2", "1.0 m apart": "#009E73",
          "two cables": "#D55E00"}  # fmt: skip
STEP_COLORS = {1e-2: ("#D55E00", "#E69F00"), 1e-3: ("#0072B2", "#56B4E9")}  # by step [s], a shade for each of SCHEMES


def plot(rows):
    """Figures of the study, {name: matplotlib Figure}."""
    return {
        "stretch_over_stiffness": _plot_stretch(rows["shape"], rows["springs"]),
        "distance_from_both_catenaries": _plot_distance(rows["shape"]),
        "error_over_segments": _plot_refinement(rows["refinement"]),
        "stretch_floor_and_its_cure": _plot_floor(rows["floor"], rows["cure"]),
    }


def _plot_stretch(table, springs):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4.4), layout="constrained")
    axes = figure.subplots()
    shown = min(THESIS_SEGMENTS, table["segments"].max())
    for name, group in table[table["segments"].isin((shown, THESIS_SEGMENTS))].groupby("arrangement", sort=False):
        axes.loglog(group["EA_N"], 100 * group["stretch_catenary"], color=COLORS[name], lw=1)
        axes.loglog(group["EA_N"], 100 * group["stretch"], "o", ms=4, color=COLORS[name], label=name)
    axes.plot(springs["EA_N"], [100 * THESIS_STRETCH] * len(springs), "*", ms=11, mfc="w", mec="k", label="makes 1.1 m")
    axes.axhline(100 * THESIS_STRETCH, color="0.4", lw=1, ls="--", zorder=0)
    axes.text(9e5, 115 * THESIS_STRETCH, "1.1 m, the thesis", ha="right", va="bottom", color="0.3")
    axes.axvline(CORD_EA, color="0.4", lw=1, ls=":")
    axes.text(0.9 * CORD_EA, 3e-5, "3 mm nylon", color="0.3", ha="right")
    axes.set(xlabel="axial stiffness EA [N]", ylabel="stretch of the cable [%]")
    top = axes.secondary_xaxis("top", functions=(_spring_of, _stiffness_of))
    top.set_xlabel(f"spring of one of {THESIS_SEGMENTS} segments [N/m]")
    title = f"marks: lumped, {shown} segments\nlines: elastic catenary"
    figure.legend(*axes.get_legend_handles_labels(), loc="outside right center", title=title, frameon=False)
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
            axes.loglog(group["EA_N"], group[column], ".-", color=color, label=f"{n}")
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
    left.loglog(n, table["sag_error_mm"], "o-", color="#0072B2", label="lumped, EA = 1e9 N")
    left.loglog(n, 0.5 * table["sag_error_mm"].iloc[0] * (n / n[0]) ** -2, "k--", lw=1, label="slope −2")
    left.set(ylabel="error of the sag [mm]", title="rest between supports 0.8 m apart")
    for name, color, marker, words in (("half", "#0072B2", "o", "half a segment"), ("full", "#D55E00", "s", "a segment")):
        column = f"swing_error_{name}_end_mass_percent"
        right.loglog(n, table[column], marker + "-", color=color, label=f"loose end with the mass of {words}")
    right.loglog(n, 0.5 * table["swing_error_half_end_mass_percent"].iloc[0] * (n / n[0]) ** -2, "k--", lw=1,
                 label="slope −2")  # fmt: skip
    start = table["swing_error_full_end_mass_percent"].iloc[0]
    right.loglog(n, 2 * start * n[0] / n, "k:", lw=1, label="slope −1")
    right.set(ylabel="error of the first frequency [%]", title="small swings of the hung cable")
    for axes in (left, right):
        axes.set_xlabel("segments")
        axes.set_xticks(n, [f"{k:.0f}" for k in n])
        axes.minorticks_off()
    left.legend(frameon=False)
    right.legend(frameon=False, fontsize=8, loc="lower left")
    return figure


def _plot_floor(floors, cure):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.3), layout="constrained")
    left, right = figure.subplots(1, 2)
    hung = floors[floors["arrangement"] == "hung"]
    lines = ((scheme, dt, shade) for dt, shades in STEP_COLORS.items() for scheme, shade in zip(SCHEMES, shades, strict=True))
    for scheme, dt, color in lines:
        name, _, marker, _ = style(scheme)
        line = hung[(hung["scheme"] == scheme) & (hung["dt_s"] == dt)].sort_values("segments")
        left.loglog(line["segments"], 100 * line["floor_closed_form"], "-", color=color, lw=1)
        label = f"{name}, {1e3 * dt:g} ms"
        left.loglog(line["segments"], 100 * line["floor_measured"], marker, ms=6, mfc="w", color=color, label=label)
    left.axhline(100 * THESIS_STRETCH, color="0.4", lw=1, ls="--")
    left.text(5, 115 * THESIS_STRETCH, "1.1 m", color="0.3", va="bottom")
    ticks = sorted(hung["segments"].unique())
    left.set_xticks(ticks, ticks)
    left.minorticks_off()
    left.set(xlabel="segments", ylabel="least stretch that the step permits [%]",
             title="hung cable: lines predicted, marks measured")  # fmt: skip
    left.legend(frameon=False, fontsize=9)

    rest = cure[cure["scheme"] == "edmc"].drop_duplicates("EA_N").sort_values("EA_N")
    right.loglog(rest["EA_N"], 100 * rest["stretch_at_rest"], "-", color="0.5", lw=1, label="at rest, m g/2EA")
    for dt, marker, size in ((1e-2, "o", 9), (1e-3, ".", 7)):
        edmc = cure[(cure["scheme"] == "edmc") & (cure["dt_s"] == dt) & (cure["ended"] == "done")]
        right.loglog(edmc["EA_N"], 100 * edmc["largest_stretch"], marker, ms=size, mfc="w" if marker == "o" else None,
                     color="#009E73", label=f"edmc, {1e3 * dt:g} ms: largest of a swing")  # fmt: skip
        floor_here = hung[(hung["scheme"] == "rk4") & (hung["dt_s"] == dt)]
        floor_here = floor_here[floor_here["segments"] == min(THESIS_SEGMENTS, floor_here["segments"].max())]
        right.axhline(100 * floor_here["floor_measured"].iloc[0], color="k", lw=1)
        right.text(1e9, 115 * floor_here["floor_measured"].iloc[0], f"floor of RK4, {1e3 * dt:g} ms", ha="right",
                   va="bottom", fontsize=9, color="0.2")  # fmt: skip
    right.set(xlabel="axial stiffness EA [N]", ylabel="stretch [%]", title=f"{THESIS_SEGMENTS} segments: no floor with edmc")
    right.legend(frameon=False, fontsize=9, loc="lower left")
    return figure


def _slope(x, y):
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def answer(rows):
    """The answer in words, with the numbers of `rows`."""
    shapes, springs_found, refined, floors, cured = (rows[name] for name in ("shape", "springs", "refinement", "floor", "cure"))
    by_name = springs_found.set_index("arrangement")
    hung, two = by_name.loc["hung"], by_name.loc["two cables"]
    between = ", ".join(f"{by_name.loc[name, 'spring_N_per_m']:.1f}" for name in SPANS)
    sag = ", ".join(f"{r.sag_error_mm:.3g} mm at N = {r.segments:.0f}" for r in refined.itertuples())
    sag_slope = _slope(refined["segments"], refined["sag_error_mm"])
    half, full = (_slope(refined["segments"], refined[f"swing_error_{e}_end_mass_percent"]) for e in ("half", "full"))
    shape_8 = shapes[shapes["arrangement"] == "0.8 m apart"]
    stiffest = shape_8[shape_8["EA_N"] == shape_8["EA_N"].max()]
    softest = shape_8[shape_8["EA_N"] == shape_8["EA_N"].min()]
    floor_hung = floors[floors["arrangement"] == "hung"]
    off = (floor_hung["floor_measured"] / floor_hung["floor_closed_form"] - 1).abs().groupby(floor_hung["segments"]).max()
    other = (floors["floor_measured"] / floors["floor_predicted"] - 1).abs().max()
    joined = floors[(floors["arrangement"] == "two cables") & (floors["scheme"] == "rk4")].set_index("dt_s")
    at_20 = {
        (r.scheme, r.dt_s): 100 * r.floor_measured
        for r in floor_hung[floor_hung["segments"] == min(THESIS_SEGMENTS, floor_hung["segments"].max())].itertuples()
    }
    edmc = cured[cured["scheme"] == "edmc"]
    stiff = edmc[edmc["EA_N"] == edmc["EA_N"].max()]
    rk4 = cured[cured["scheme"] == "rk4"]
    below = 100 * rk4["stretch_at_rest"] < rk4["dt_s"].map(lambda dt: at_20["rk4", dt])
    ms10 = springs_found["rk4_step_ms"]
    return f"""
The lumped model does not make a cable long: at the stiffness of a cord it stretches by
{100 * MASS * GRAVITY / (2 * CORD_EA):.2g} %. The thesis's 1.1 m is that of springs {hung.cord_is_stiffer_by:,.0f} times
too soft, and such springs are what an explicit step of about 10 ms enforces: with {THESIS_SEGMENTS} segments it leaves no
stretch below {at_20["rk4", 1e-2]:.1f} % (RK4) or {at_20["symplectic_euler", 1e-2]:.1f} % (symplectic Euler), whatever the
cable is made of. The implicit `edmc` has no such floor.

Which springs make 1.1 m (20 segments, 100 g): {hung.spring_N_per_m:.1f} N/m hung from one end, {between} N/m between
supports 0.5, 0.8 and 1.0 m apart, {two.spring_N_per_m:.1f} N/m for two cables that meet: EA = {by_name["EA_N"].min():.1f}
to {by_name["EA_N"].max():.1f} N. If the loose end carries the mass of a whole segment instead of a half, as twenty equal
masses have it, it is {hung.spring_full_end_mass_N_per_m:.1f} N/m hung and {two.spring_full_end_mass_N_per_m:.1f} for
the two cables. The elastic catenary needs the same EA within
{100 * (by_name["catenary_EA_N"] / by_name["EA_N"] - 1).abs().max():.2g} %, so that the length is the spring's, not the
discretisation's. RK4 is stable with these springs up to {ms10.min():.1f} to {ms10.max():.1f} ms, symplectic Euler up to
{springs_found["symplectic_euler_step_ms"].min():.1f} to {springs_found["symplectic_euler_step_ms"].max():.1f} ms.

Shape: between supports 0.8 m apart the nodes are {stiffest["rmse_elastic_mm"].iloc[0]:.2g} mm (RMSE,
{stiffest["segments"].iloc[0]} segments) to {stiffest["rmse_elastic_mm"].iloc[-1]:.2g} mm
({stiffest["segments"].iloc[-1]}) from the elastic catenary, and hardly further at EA = 1 N
({softest["rmse_elastic_mm"].iloc[0]:.2g} and {softest["rmse_elastic_mm"].iloc[-1]:.2g} mm). From the catenary that does
not stretch they are as far as the stretch takes them, until EA is so large that the segments are all that is left. The
error of the sag is {sag}; it falls as N^{sag_slope:.2f}. The stretch of a cable that hangs from one end is exact at any
N. All this needs half a segment's mass at a loose end: the first frequency of the hung cable then converges as
N^{half:.2f}, with a full one as N^{full:.2f}.

The floor: an explicit step dt is stable while h·omega ≤ S, so that EA cannot exceed a bound, and the mean stretch of a
hung cable cannot fall below eps = 2 g N² dt²/(S² L), S = 2 (symplectic Euler) or 2.83 (RK4); mass and material have
dropped out. It was measured by raising EA until the energy of a disturbance of 1e-10 of m g L grew a thousandfold
within {FLOOR_STEPS} steps. The closed form, which takes the top frequency as that of an endless chain, is right within
{100 * off.iloc[0]:.1f} % at N = {off.index[0]} and {100 * off.iloc[-1]:.2g} % at N = {off.index[-1]}; with the exact
frequency, and for cables between supports too, prediction and measurement agree within {100 * other:.1f} %. It grows as
N², as the error of the shape falls: what refinement gains in one it loses in the other. At 20 segments and 1 ms it is
{at_20["rk4", 1e-3]:.3f} % (RK4) and {at_20["symplectic_euler", 1e-3]:.3f} %; for the two cables that meet, at 10 ms with
RK4, {100 * joined.loc[1e-2, "floor_measured"]:.1f} %.

The cure: `edmc` swung the same cable (1 rad/s at first, 2 s) at both steps with EA up to {edmc["EA_N"].max():.0e} N,
where it stretches by {100 * stiff["largest_stretch"].max():.1e} % at most, with {edmc["newton_per_step"].max():.1f}
Newton iterations a step or fewer; the largest rise of its energy is {edmc["energy_rise"].max():.1g} of that of the swing.
Of RK4's {len(rk4)} runs at the same steps and stiffnesses {int(below.sum())} are below its floor; of them
{int((rk4["ended"][below] == "diverged").sum())} diverged, of the others {int((rk4["ended"][~below] == "diverged").sum())}.

Left out: the thesis states neither its solver nor its step, so that the floor is an inference from three symptoms that it
does state. Its rigid links are another matter: twenty joints of 5 mm between links of 5 cm make 1.10 m as well. The sag's
error is given at even N, where a node is at the lowest point. Bending, and cords whose EA changes with tension, are not
in the model.
"""


if __name__ == "__main__":
    from studies.command_line import main

    main(["study", "length_error"])
