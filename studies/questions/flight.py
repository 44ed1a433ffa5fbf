"""How far can the step of a flight of quadrotors be believed, and what does it cost?

The bundled scenes are flown with their own controllers at steps of 20 to 1 ms. Position control acts 100 times a second, attitude
control 500 times, but neither more than once a step. In "sway" the quadrotors of the net stop after 10 m, and the net is left to
swing below them. A load on a cord of 1 g and on the thesis's cable of 100 g is brought to a place by model-predictive control, with
the weights of the thesis before and after its tuning.
"""

import importlib.util
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
import pandas as pd

from anet_lumped import load_scene
from anet_lumped.flight.fly import fly
from anet_lumped.flight.scenarios import HOLD, SCENARIOS, Scenario, carried_point, controller_for, point_at_hover, way_from
from anet_lumped.views.palette import look
from studies.shown.sentences import between, listed
from studies.shown.show import as_text
from studies.study import Drawing, Part, Record

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.COST,
    first_look="no flight in a gust, steps of 20 and 4 ms, and of 2 ms on one flight alone; of model-predictive control the cord "
    "and the way of 1 m.",
    compares_times=True,
)
TABLES = {
    "flights": "A line for each flight and step: peak tension, errors of p0 and of the shape, sway, energy, and times real time.",
    "loads": "A line for each cable, way and weights of model-predictive control: settling, overshoot, swing, cost of a plan.",
    "loads_in_time": "A line for each of these and each time: how far the load has come along its way.",
}

SWAY, NET, GUST = "sway", "quadrotors_net", "quadrotors_gust"
STEPS, QUICK_STEPS, QUICK_SHORTEST = (20e-3, 10e-3, 4e-3, 1e-3), (20e-3, 4e-3), 2e-3  # [s]
SAVE_EVERY = 20e-3  # [s]
STOPPED = 4.0  # [s] when the quadrotors of "sway" have stopped
SETTLED = 0.05  # [m] from its place, within which a load has settled
CORD, CABLE = "cord of 1 g", "cable of 100 g"
ONE_METRE, TEN_METRES = "1 m at once", "10 m in 4 s"
LOADS_END, QUICK_END = 8.0, 3.6  # [s]
CLOSE = 0.01  # what steps may differ by


class Flight(NamedTuple):
    """A flight of the study: its name, scene and scenario."""

    name: str
    scene: object
    scenario: Scenario


def flights():
    """The bundled flights of nets, and the net that is left to sway."""
    made = [Flight(name, load_scene(name), scenario) for name, scenario in SCENARIOS.items() if name != "quadrotor_hover"]
    swaying = Scenario(HOLD, 8.0, [(0.0, (0.0, 0.0, 0.0)), (STOPPED, (0.0, 10.0, 0.0))])
    return [*made, Flight(SWAY, load_scene(NET), swaying)]


def measured(flight, controller, wanted, dt):
    """A row: what a flight at a step tells; ``wanted`` is the way that p0 was to go."""
    scene = flight.scene
    run = fly(scene, controller, flight.scenario.t_end, dt=dt, save_every=SAVE_EVERY)
    point = carried_point(scene)
    off = np.linalg.norm(run.position(point) - [wanted.at(t)[0] for t in run.t], axis=1)
    sides = [np.linalg.norm(run.position(a.name) - run.position(b.name), axis=1) for a, b in combinations(scene.bodies, 2)]
    shape = max(float(np.abs(side - side[0]).max()) for side in sides)
    energy = run.energy_balance
    return {
        "flight": flight.name, "step_ms": 1e3 * dt, "peak_tension_N": max(run.tension(c.name).max() for c in scene.cables),
        "p0_error_mm": 1e3 * off.max(), "p0_error_at_end_mm": 1e3 * off[-1], "shape_error_mm": 1e3 * shape,
        "sway_period_s": sway_period(run, point) if flight.name == SWAY else np.nan,
        "taken_by_method_J": energy.by_method, "imbalance": energy.imbalance,
        "times_real_time": run.t[-1] / run.wall_time, "status": run.status,
    }  # fmt: skip


def sway_period(run, point):
    """Mean period [s] in which the point sways along y below the middle of the quadrotors, once these have stopped."""
    middle = np.mean([run.position(body.name)[:, 1] for body in run.scene.bodies], axis=0)
    later = run.t > STOPPED + 0.5
    y, t = (run.position(point)[:, 1] - middle)[later], run.t[later]
    k = np.flatnonzero(np.diff(np.sign(y)) != 0)
    crossings = t[k] - y[k] * (t[k + 1] - t[k]) / (y[k + 1] - y[k])
    return 2.0 * float(np.diff(crossings).mean()) if len(crossings) > 1 else np.nan


def flown(quick=False):
    """The table of flights, with the difference of each from the same at its shortest step."""
    rows = []
    for flight in flights():
        if quick and flight.name == GUST:
            continue
        controller = controller_for(flight.scene, flight.scenario)
        steps = STEPS if not quick else (*QUICK_STEPS, QUICK_SHORTEST) if flight.name == NET else QUICK_STEPS
        fly(flight.scene, controller, 0.1, dt=steps[0])  # what has to be compiled or loaded
        wanted = way_from(point_at_hover(flight.scene, carried_point(flight.scene)), flight.scenario.stops)
        rows += [measured(flight, controller, wanted, dt) for dt in steps]
    table = pd.DataFrame(rows)
    for column in ("peak_tension_N", "sway_period_s"):
        finest = table.loc[table.groupby("flight")["step_ms"].transform("idxmin"), column].to_numpy()
        table[column.rsplit("_", 1)[0] + "_differs_percent"] = 100.0 * (table[column] / finest - 1.0)
    return table


def load_cases(quick=False):
    """Triples of a cable, a way and weights, by name."""
    cables, ways = ((CORD,), (ONE_METRE,)) if quick else ((CORD, CABLE), (ONE_METRE, TEN_METRES))
    return [(cable, way, weights) for cable in cables for way in ways for weights in ("untuned", "tuned")]


def brought(cable, way, weights, t_end):
    """A row on a load that is brought to its place, and its lines in time."""
    from anet_lumped.flight.predictive import TUNED, UNTUNED, predictive

    scene = load_scene("quadrotor_hover")
    if cable == CORD:
        scene = replace(scene, cables=[replace(scene.cables[0], mass_per_length=0.001, segments=10)])
    point, far = carried_point(scene), 1.0 if way == ONE_METRE else 10.0
    start = point_at_hover(scene, point)
    place = np.add(start, (0.0, far, 0.0))
    goal = place if way == ONE_METRE else way_from(start, [(0.0, (0.0, 0.0, 0.0)), (4.0, (0.0, far, 0.0))])
    controller = predictive(scene, goal, weights={"untuned": UNTUNED, "tuned": TUNED}[weights])
    run = fly(scene, controller, t_end, save_every=SAVE_EVERY)
    load, solves = run.position(point), controller.position.controller.solves
    hangs = load - run.position(scene.bodies[0].name)
    late = np.flatnonzero(np.linalg.norm(load - place, axis=1) > SETTLED)
    along = load[:, 1] - start[1]
    named = {"cable": cable, "way": way, "weights": weights}
    row = named | {
        "settled_s": run.t[late[-1] + 1] if late[-1] + 1 < len(run.t) else np.nan,
        "overshoot_mm": 1e3 * (along.max() - far), "half_way_s": float(run.t[np.argmax(along >= 0.5 * far)]),
        "swing_degrees": float(np.degrees(np.arccos(-hangs[:, 2] / np.linalg.norm(hangs, axis=1))).max()),
        "plan_ms": 1e3 * float(np.median([one.wall_time for one in solves])), "plans": len(solves),
        "iterations": float(np.median([one.iterations for one in solves])), "status": run.status,
    }  # fmt: skip
    return row, [named | {"t_s": t, "along_m": y} for t, y in zip(run.t, along, strict=True)]


def compute(quick=False, executor=None, out=None):
    """The tables, one process and one core: timings in parallel would measure each other."""
    rows, lines = [], []
    if importlib.util.find_spec("casadi") is not None:
        for case in load_cases(quick):
            row, in_time = brought(*case, QUICK_END if quick else LOADS_END)
            rows.append(row)
            lines += in_time
    return {"flights": flown(quick), "loads": pd.DataFrame(rows), "loads_in_time": pd.DataFrame(lines)}


def plot(rows):
    """Drawings of the study, by name."""
    drawings = {
        "steps": Drawing(
            _plot_steps(rows["flights"]),
            "Difference of the largest tension of each flight from that at its shortest step, and how many times faster than real "
            "time it ran, over the step.",
        )
    }
    if len(rows["loads_in_time"]):
        drawings["tuning"] = Drawing(
            _plot_loads(rows["loads_in_time"]),
            "A load that model-predictive control brings 1 m to the side at once, with the thesis's weights before and after its "
            "tuning.",
        )
    return drawings


def _plot_steps(table):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for k, (name, line) in enumerate(table.groupby("flight", sort=False)):
        apart = line[line["peak_tension_differs_percent"] != 0.0]
        left.loglog(apart["step_ms"], apart["peak_tension_differs_percent"].abs(), ms=5, label=name, **look(k))
        right.loglog(line["step_ms"], line["times_real_time"], ms=5, **look(k))
    left.axhline(100.0 * CLOSE, color="0.6", lw=0.8)
    left.set(xlabel="step [ms]", ylabel="largest tension differs [%]")
    right.set(xlabel="step [ms]", ylabel="times real time")
    figure.legend(loc="outside lower center", ncols=5, frameon=False, fontsize=8)
    return figure


def _plot_loads(lines):
    from matplotlib.figure import Figure

    part = lines[lines["way"] == ONE_METRE]
    figure = Figure(figsize=(10, 3.2), layout="constrained")
    cables = list(dict.fromkeys(part["cable"]))
    for axes, cable in zip(np.atleast_1d(figure.subplots(1, len(cables), sharey=True)), cables, strict=True):
        for k, (weights, line) in enumerate(part[part["cable"] == cable].groupby("weights", sort=False)):
            axes.plot(line["t_s"], line["along_m"], label=weights, **(look(k) | {"marker": ""}))
        axes.axhline(1.0, color="0.6", lw=0.8)
        axes.set(xlabel="t [s]", title=cable)
    figure.axes[0].set(ylabel="load along its way [m]")
    figure.axes[0].legend(frameon=False)
    return figure


def answer(rows):
    """The answer in words, every number and claim from the rows."""
    words = [_finding(rows["flights"]), _sway(rows["flights"]), _errors(rows["flights"]), _cost(rows["flights"])]
    words += [_tuning(rows["loads"]), _left_out(rows["loads"])]
    return "\n\n".join(text for text in words if text)


def _finding(table):
    far = 100.0 * CLOSE
    off = table.groupby("flight", sort=False)["peak_tension_differs_percent"].agg(lambda x: float(x.abs().max()))
    good, bad = off[off <= far], off[off > far]
    flown = table[table["flight"].isin(good.index)].groupby("flight")["step_ms"]
    steps = listed(sorted({between(line, "ms") for _, line in flown}))
    text = (
        f"The largest tension of {listed(good.index)} is the same within {far:g} % at all their steps, {steps}" if len(good) else ""
    )
    of = "that" if text else "the largest tension"
    worse = "; ".join(f"{of} of {name} differs by up to {as_text(value, 2)} %" for name, value in bad.items())
    whole = "; ".join(part for part in (text, worse) if part)
    return f"{whole[0].upper()}{whole[1:]}." + (
        " There a cable breaks, and the others recoil." if "quadrotors_break" in bad.index else ""
    )


def _sway(table):
    part = table[table["flight"] == SWAY].dropna(subset="sway_period_s")
    if len(part) < 2:
        return ""
    worst = part["sway_period_differs_percent"].abs().max()
    verdict = "within" if worst <= 100.0 * CLOSE else "not within"
    return (
        f"Below quadrotors that have stopped, p0 sways in {between(part['sway_period_s'], 's', 4)}: {verdict} {100 * CLOSE:g} %, "
        f"by {as_text(worst, 2)} % at most."
    )


def _errors(table):
    words = []
    for name, line in table.groupby("flight", sort=False):
        if name != SWAY:
            words.append(
                f"{name} {between(line['p0_error_mm'], 'mm', 2)}, in the end {between(line['p0_error_at_end_mm'], 'mm', 2)}, the "
                f"shape {between(line['shape_error_mm'], 'mm', 2)}"
            )
    unaccounted = as_text(table["imbalance"].max(), 2)
    return f"p0 is away from its way by at most: {'; '.join(words)}. Of no energy more than {unaccounted} is unaccounted for."


def _cost(table):
    words = [f"{step:g} ms {between(line['times_real_time'], digits=2)}" for step, line in table.groupby("step_ms", sort=True)]
    return f"With controllers in Python, a flight is as many times faster than real time at steps of {'; '.join(words)}."


def _tuning(table):
    words = []
    for (cable, way), pair in table.groupby(["cable", "way"], sort=False) if len(table) else ():
        before, after = (pair[pair["weights"] == name].iloc[0] for name in ("untuned", "tuned"))
        words.append(
            f"{cable}, {way}: within {1e3 * SETTLED:g} mm after {_seconds(before.settled_s)}, tuned {_seconds(after.settled_s)}; "
            f"half way after {before.half_way_s:.1f} and {after.half_way_s:.1f} s; {before.overshoot_mm:.0f} and "
            f"{after.overshoot_mm:.0f} mm too far; swinging by up to {before.swing_degrees:.0f} and {after.swing_degrees:.0f}°"
        )
    if not words:
        return ""
    return (
        f"Model-predictive control with the thesis's weights before and after tuning: {'. '.join(words)}. A plan of 2 s takes "
        f"{between(table['plan_ms'], 'ms', 2)}."
    )


def _seconds(value):
    return f"{value:.1f} s" if np.isfinite(value) else "no time flown"


def _left_out(loads):
    text = "Left out: the air that rotors push down, noise and delay of what is seen, and time to make a controller"
    return text + ("" if len(loads) else "; model-predictive control, for CasADi is not installed") + "."
