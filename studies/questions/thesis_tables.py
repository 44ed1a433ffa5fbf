"""What put the thesis's p0 centimetres off, and what does p0 cost by force balance instead of sampling?

Section 5.1 of the thesis samples p0, draws the catenaries, adds up the potential energy of their points (Eq. 5.1) and
keeps the least. Here Table 5.1 is made again by that method, the cause of its errors is shown, and p0 is found by the
balance of forces, for the table's two cables and for the motion of section 5.1.5.
"""

import math
import time
from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.optimize import minimize_scalar

from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary import catenary
from anet_lumped.statics.catenary_net import catenary_net
from anet_lumped.statics.equilibrium import equilibrium

QUESTION = __doc__.splitlines()[0]

LENGTH = 1.0  # of each cable [m]
SUPPORTS = np.array([(0.0, 1.0), (1.0, 1.0)])  # thesis, section 5.1.3: p1 and p2, (x, z) [m]
REFERENCE = 0.2036  # height of p0 that Table 5.1 is measured against, as the thesis rounds it [m]
LOWEST = 1 - math.sqrt(3) / 2  # both cables straight: the lower end of the search line [m]
TABLE_5_1 = [  # samples of p0, points per cable, computation time [s], error in z [cm]
    (10, 10, 2.5, 3.0),
    (100, 10, 7.0, -2.59),
    (100, 50, 19.0, -0.84),
    (100, 100, 40.0, -0.04),
    (200, 100, 70.0, -0.43),
    (200, 500, 310.0, 0.0),
]
MOTION_S = 4.0  # section 5.1.5
SPEED = 0.2  # [m/s]
MOTION = {"two cables": 14.5 * 60, "four cables": 30 * 60}  # stated computation time [s], the second "more than"


# The thesis's method ------------------------------------------------------------------------------------------------


def point_heights(z0, points):
    """Heights of the points of one cable for one p0 = (1/2, z0).

    Parameters
    ----------
    z0 : float [m]
    points : int
        Equal in arc length, both ends included.

    Returns
    -------
    (points,) float64 [m], from the support to p0
    """
    arc = np.linspace(0.0, LENGTH, points)
    p0 = np.array([0.5, z0])
    if math.dist(SUPPORTS[0], p0) >= LENGTH * (1 - 1e-12):  # the lowest sample of all: straight
        return SUPPORTS[0][1] + (z0 - SUPPORTS[0][1]) * arc / LENGTH
    return catenary(SUPPORTS[0], p0, LENGTH).point(arc)[:, 1]


def mean_height(z0, points, weights="equal"):
    """Potential energy of Eq. 5.1 over the weight; by symmetry both cables have the same.

    Parameters
    ----------
    z0 : float [m]
    points : int
    weights : "equal" or "trapezoid"
        Every point with the same mass, or the two end points with half of it.

    Returns
    -------
    float [m]
    """
    mass = np.ones(points)
    if weights == "trapezoid":
        mass[[0, -1]] = 0.5
    return float(mass @ point_heights(z0, points) / mass.sum())


def sample_p0(samples, points, weights="equal"):
    """Height of p0 by the thesis's method: the sample of least energy.

    Parameters
    ----------
    samples, points : int
        Samples of p0 on the symmetry line, points per cable.
    weights : "equal" or "trapezoid"

    Returns
    -------
    float [m]
    """
    line = np.linspace(LOWEST, SUPPORTS[0][1], samples)
    return float(line[np.argmin([mean_height(z0, points, weights) for z0 in line])])


def least_energy_p0(points, weights):
    """The same without the samples' grid: what the weights alone make of p0 [m]."""
    found = minimize_scalar(mean_height, bounds=(LOWEST, 0.9), args=(points, weights), method="bounded", options={"xatol": 1e-10})
    return float(found.x)


# The balance of forces ----------------------------------------------------------------------------------------------


def hanging_scene(supports, *, payload=0.0, segments=20, EA=1e9):
    """Cables of 1 m from each support to p0; stiff enough that p0 is the inextensible one's to a nanometre.

    Parameters
    ----------
    supports : (n, 3) [m]
    payload : float
        Mass at p0 over the mass of one cable.
    segments : int
    EA : float [N]

    Returns
    -------
    Scene
    """
    start = np.mean(supports, axis=0) - (0.0, 0.0, 0.5)
    return Scene(
        points=[Fixed(f"s{i}", at) for i, at in enumerate(supports)] + [Free("p0", 0.1 * payload, tuple(start))],
        cables=[Cable(f"s{i}", "p0", length=LENGTH, mass_per_length=0.1, EA=EA, segments=segments) for i in range(len(supports))],
        effects=[Gravity(9.81)],
    )


def two_supports():
    """Supports of Table 5.1 in 3-D, (2, 3) [m]."""
    return np.insert(SUPPORTS, 1, 0.0, axis=1)


def four_supports():
    """Supports of the four-cable net, which the thesis does not state: a square of 1 m at the same height."""
    return np.array([(-0.5, -0.5, 1.0), (0.5, -0.5, 1.0), (0.5, 0.5, 1.0), (-0.5, 0.5, 1.0)])


def balance_p0(scene):
    """p0 of the continuous net by Newton's method on the forces, from the scene's own place of it, (3,) [m]."""
    return catenary_net(scene, {point.name: point.at for point in scene.points}).points["p0"]


def moved(scene, x):
    """The scene moved by x [m] along the first axis."""
    return replace(scene, points=tuple(replace(point, at=(point.at[0] + x, *point.at[1:])) for point in scene.points))


# The study ----------------------------------------------------------------------------------------------------------


def compute(quick=False, executor=None, out=None):
    """Tables of the study; everything that is timed runs one by one in this process.

    Returns
    -------
    dict of pandas.DataFrame
        "table_5_1", "bias" (what the weights alone make of p0), "energy" (over p0), "force_balance", "motion".
    """
    exact = balance_p0(hanging_scene(two_supports()))[2]
    return {
        "table_5_1": _table_5_1(exact),
        "bias": _bias(exact, (10, 20, 50, 100) if quick else (5, 10, 20, 50, 100, 200, 500)),
        "energy": _energy(),
        "force_balance": _force_balance(exact, repeats=3 if quick else 15),
        "motion": _motion(poses=20 if quick else 400),
    }


def _table_5_1(exact):
    rows = []
    for samples, points, thesis_time, thesis_error in TABLE_5_1:
        begin = time.perf_counter()
        z0 = sample_p0(samples, points)
        taken = time.perf_counter() - begin
        rows.append(
            {
                "samples": samples,
                "points": points,
                "thesis_error_cm": thesis_error,
                "error_cm": 100 * (z0 - REFERENCE),
                "half_end_masses_error_cm": 100 * (sample_p0(samples, points, "trapezoid") - REFERENCE),
                "no_grid_error_cm": 100 * (least_energy_p0(points, "equal") - exact),
                "grid_cm": 100 * (SUPPORTS[0][1] - LOWEST) / (samples - 1),
                "thesis_time_s": thesis_time,
                "time_s": taken,
            }
        )
    return pd.DataFrame(rows)


def _bias(exact, numbers):
    """Equal masses at n points are the cable's own mass and a payload at p0 of 1/(n - 1) of a cable's."""
    return pd.DataFrame(
        {
            "points": n,
            "equal_masses_mm": 1e3 * (least_energy_p0(n, "equal") - exact),
            "half_end_masses_mm": 1e3 * (least_energy_p0(n, "trapezoid") - exact),
            "payload_mm": 1e3 * (balance_p0(hanging_scene(two_supports(), payload=1 / (n - 1)))[2] - exact),
        }
        for n in numbers
    )


def _energy():
    line = np.linspace(LOWEST, 0.42, 160)
    return pd.DataFrame(
        {
            "z0": z0,
            "equal_masses": mean_height(z0, 10, "equal"),
            "half_end_masses": mean_height(z0, 10, "trapezoid"),
            "cable": mean_height(z0, 2001, "trapezoid"),
        }
        for z0 in line
    )


def _force_balance(exact, repeats):
    scenes = {segments: hanging_scene(two_supports(), segments=segments) for segments in (20, 160)}
    methods = {"catenaries, Newton in Python": lambda: balance_p0(scenes[20])}
    for segments, scene in scenes.items():
        methods[f"lumped, 2 × {segments} segments"] = lambda scene=scene: equilibrium(scene).position("p0")
    rows = []
    for method, find in methods.items():
        z0 = find()[2]  # compiles
        rows.append({"method": method, "error_mm": 1e3 * (z0 - exact), "time_ms": 1e3 * _median_time(find, repeats)})
    return pd.DataFrame(rows)


def _median_time(function, repeats):
    taken = []
    for _ in range(repeats):
        begin = time.perf_counter()
        function()
        taken.append(time.perf_counter() - begin)
    return float(np.median(taken))


def _motion(poses):
    """One balance for each pose of the 4 s, each from scratch; `poses` fewer than 400 are scaled up."""
    rows = []
    for net, supports in (("two cables", two_supports()), ("four cables", four_supports())):
        still = hanging_scene(supports)
        for method, find in (("catenaries", balance_p0), ("lumped", lambda s: equilibrium(s).position("p0"))):
            scenes = [moved(still, SPEED * t) for t in np.linspace(0.0, MOTION_S, poses)]
            find(scenes[0])  # compiles
            begin = time.perf_counter()
            path = np.array([find(scene) for scene in scenes])
            taken = time.perf_counter() - begin
            off = path - path[0]
            off[:, 0] -= SPEED * np.linspace(0.0, MOTION_S, poses)
            rows.append(
                {
                    "net": net,
                    "method": method,
                    "poses": 400,
                    "time_a_pose_ms": 1e3 * taken / poses,
                    "time_s": taken / poses * 400,
                    "thesis_time_s": MOTION[net],
                    "largest_departure_m": float(np.linalg.norm(off, axis=1).max()),
                }
            )
    return pd.DataFrame(rows)


def plot(rows):
    """Figures of the study, {name: matplotlib Figure}."""
    from matplotlib.figure import Figure

    figures = {}
    table, energy, bias = rows["table_5_1"], rows["energy"], rows["bias"]

    figure = figures["errors_of_table_5_1"] = Figure(figsize=(8, 3.8), layout="constrained")
    axes = figure.subplots()
    place = np.arange(len(table))
    for shift, column, label, color in (
        (-0.27, "thesis_error_cm", "thesis, Table 5.1", "0.6"),
        (0.0, "error_cm", "the same method here: equal masses, both ends full", "C3"),
        (0.27, "half_end_masses_error_cm", "end points with half a mass", "C0"),
    ):
        bars = axes.bar(place + shift, table[column], 0.25, label=label, color=color)
        axes.bar_label(bars, fmt="%+.2f", fontsize=7, padding=1)
    axes.axhline(0, color="k", lw=0.8)
    axes.set_xticks(place, [f"{r.samples} samples\n{r.points} points" for r in table.itertuples()])
    axes.set(ylabel="error of p0's height [cm]", ylim=(-3.3, 5.2), title="Table 5.1 again, by its own method")
    axes.legend(loc="upper right", frameon=False)

    figure = figures["cause_of_the_bias"] = Figure(figsize=(9, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for column, label, color in (
        ("equal_masses", "10 equal masses a cable", "C3"),
        ("half_end_masses", "10 masses, the ends halved", "C0"),
        ("cable", "the cable itself", "k"),
    ):
        above = 100 * (energy[column] - energy[column].min())
        left.plot(100 * energy["z0"], above, color=color, label=label, ls="--" if column == "cable" else "-")
        left.plot(100 * energy["z0"][above.idxmin()], 0, "v", color=color, clip_on=False)
    left.set(xlabel="height of p0 [cm]", ylabel="mean height of the points, above its least [cm]")
    left.set(xlim=(13, 40), ylim=(0, 2.2))
    left.legend(frameon=False, loc="upper left")
    left.set_title("the energy that the thesis minimises")
    right.loglog(bias["points"], -bias["equal_masses_mm"], "o-", color="C3", label="equal masses")
    label = "balance of forces with a payload\nof 1/(n−1) cable at p0"
    right.loglog(bias["points"], -bias["payload_mm"], "kx", ms=8, label=label)
    right.loglog(bias["points"], np.abs(bias["half_end_masses_mm"]), "s-", color="C0", label="end points halved")
    right.set(xlabel="points per cable n", ylabel="|error of p0's height| [mm]", title="bias without the samples' grid")
    right.legend(frameon=False, loc="lower left")

    figure = figures["computation_times"] = Figure(figsize=(8, 3.6), layout="constrained")
    axes = figure.subplots()
    last, balance, motion = table.iloc[-1], rows["force_balance"], rows["motion"]
    bars = [
        ("p0, 200 × 500 sampling: thesis", last.thesis_time_s, "0.6"),
        ("p0, 200 × 500 sampling: here", last.time_s, "C3"),
        *((f"p0, {r.method}", r.time_ms / 1e3, "C0") for r in balance.itertuples()),
    ]
    for net, group in motion.groupby("net", sort=False):
        bars.append((f"4 s of motion, {net}: thesis", group.thesis_time_s.iloc[0], "0.6"))
        bars += [(f"4 s of motion, {net}, 400 poses: {r.method}", r.time_s, "C0") for r in group.itertuples()]
    names, seconds, colors = zip(*bars, strict=True)
    drawn = axes.barh(range(len(bars)), seconds, color=colors)
    labels = ["> " * (name == "4 s of motion, four cables: thesis") + _seconds(s) for name, s, _ in bars]
    axes.bar_label(drawn, labels=labels, padding=3, fontsize=8)
    axes.set_yticks(range(len(bars)), names, fontsize=8)
    axes.invert_yaxis()
    axes.set(xscale="log", xlabel="computation time [s]", xlim=(min(seconds) / 3, max(seconds) * 30))
    figure.suptitle("grey: sampling, as the thesis states it; red: sampling here; blue: balance of forces", fontsize=10)
    return figures


def _seconds(s):
    return f"{s * 1e3:.2g} ms" if s < 0.1 else f"{s:.2g} s" if s < 100 else f"{s:.0f} s"


def answer(rows):
    """The answer in words, with the numbers of `rows`."""
    table, bias, balance, motion = (rows[name] for name in ("table_5_1", "bias", "force_balance", "motion"))
    errors = ", ".join(f"({r.samples}, {r.points}) {r.error_cm:+.3f} for {r.thesis_error_cm:+g}" for r in table.itertuples())
    ten, most = bias[bias.points == 10].iloc[0], bias.iloc[-1]
    last, quickest = table.iloc[-1], balance.sort_values("time_ms").iloc[0]
    two, four = (motion[(motion.net == net) & (motion.method == "lumped")].iloc[0] for net in MOTION)
    times = 1e3 * last.time_s / quickest.time_ms
    return f"""
Table 5.1 comes out of its own method to the last digit but one sign, and its errors are the method's: a grid of p0 and,
at each end of a cable, a point with a full mass where half a mass belongs. A balance of forces has neither and finds p0
in {quickest.time_ms:.2g} ms instead of 310 s.

With p0 on {LOWEST:.4f} … 1 m, points equal in arc length with both ends included, and all masses equal, the errors of
p0's height in cm, here for the thesis's, are {errors}. The thesis rounds the first and has the other sign in the
(100, 100) row. The grid is {table.grid_cm.max():.1f} cm wide at 10 samples and {table.grid_cm.min():.2f} cm at 200.

The cause of the bias: a full mass at each end point is a payload at p0 of 1/(n − 1) of a cable. At n = 10 it pulls p0
down by {-ten.equal_masses_mm:.1f} mm; a balance of forces with that payload says {-ten.payload_mm:.1f} mm, and at n =
{most.points:.0f} they say {-most.equal_masses_mm:.3g} and {-most.payload_mm:.3g} mm. With half a mass at the ends (the
trapezoid rule) {abs(ten.half_end_masses_mm):.1f} mm are left at n = 10 and {abs(most.half_end_masses_mm):.2g} mm at n =
{most.points:.0f}, falling as n⁻². So the thesis's conclusion that n matters more than the samples of p0 is an artefact
of its weights.

Side by side in this program, the last row's sampling takes {last.time_s:.2g} s, {times:.0f} times the balance of forces
({quickest.method}; its p0 is {abs(quickest.error_mm):.2g} mm from the cable's). The 4 s of motion at
0.2 m/s, 400 poses each from scratch, take {two.time_s:.2g} s for two cables (thesis: 14.5 min) and
{four.time_s:.2g} s for four (thesis: more than 30 min).

Left out: the thesis's computer, program and sampling cube are not known, so that its times stand beside these and prove
nothing alone. A net that moves as one body rests in the same shape at every pose, so that these poses say nothing about
its swing.
"""


if __name__ == "__main__":
    from studies.command_line import main

    main(["study", "thesis_tables"])
