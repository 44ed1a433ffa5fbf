"""What does it cost to integrate a cable that does not stretch, and is it the limit of stiffer and stiffer ones?

`links` takes tensions from the constraint on accelerations and steps by accuracy alone; `edmc` solves for them in each step. Both
run the same motions of cables with EA = inf, whose segments push as they pull. Errors are those of the position of one point, the
largest over the saved times, against links at a far smaller tolerance. Elastic cables, run by another method, say whether that is
the right motion.
"""

import warnings

import numpy as np
import pandas as pd

from anet_lumped import simulate
from anet_lumped.views.palette import look
from studies.accuracy_cost.equal_error import time_at
from studies.accuracy_cost.motions import carried, dropped, loose, stopped
from studies.accuracy_cost.paired_timing import take_turns
from studies.accuracy_cost.references import largest_distance
from studies.shown.sentences import between, listed, power
from studies.shown.show import as_text
from studies.study import Drawing, Part, Record

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.COST,
    first_look="two motions in place of four, six steps in place of eight, cables of up to 320 "
    "segments in place of 25,000, and all is timed in 2 turns in place of 9.",
    compares_times=True,
)
TABLES = {
    "runs": "A line for each motion, method and setting: error of the point that is judged, and the median of its times.",
    "elastic": "A line for each stiffness: how far elastic cables are from ones that do not stretch.",
    "growth": "A line for each number of nodes: what a stage of a step of links costs.",
}

RTOL, REFERENCE_RTOL = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8), 1e-12
STEPS = (40e-3, 20e-3, 10e-3, 5e-3, 2.5e-3, 1.25e-3, 0.625e-3, 0.3125e-3)  # [s] of edmc and of links of order 5
QUICK_STEPS = STEPS[:6]
STIFFNESSES = (1e3, 1e4, 1e5)  # [N] of elastic cables
ELASTIC_END, ELASTIC_RTOL = 0.5, 1e-9  # [s] before the whip, after which axial waves make two motions of one
SEGMENTS = (20, 80, 320, 2500, 25_000)  # of each of the net's four cables
GROWTH_STEPS, GROWTH_STEP = 5, 40e-3  # steps of 20 segments [s]; of more they are as much shorter
TURNS, QUICK_TURNS = 9, 2
TARGETS_MM = (1.0, 0.1, 0.001)
LINKS, ORDER_5, EDMC = "links", "links5", "edmc"
WHIP, NET = "loose cable, law linear", "carried net"


def motions(quick=False):
    """The motions, each of cables that do not stretch and that push as they pull."""
    made = [loose(np.inf, law="linear"), carried(np.inf)]
    return [motion.with_law("linear") for motion in (made if quick else [*made, stopped(np.inf), dropped(np.inf)])]


def settings_of(motion, quick=False):
    """Methods with their settings, coarse to fine."""
    steps = [dt for dt in (QUICK_STEPS if quick else STEPS) if abs(motion.save_every / dt - round(motion.save_every / dt)) < 1e-9]
    by_step = [{"dt": dt} for dt in steps]
    return {LINKS: [{"rtol": rtol} for rtol in RTOL], ORDER_5: by_step, EDMC: by_step}


def _run(motion, method, setting):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of steps beyond a limit, which are tried all the same
        return simulate(motion.scene, motion.t_end, method=method, start=motion.start, save_every=motion.save_every, **setting)


def raced(motion, turns, quick=False):
    """A row for each method and setting of a motion; all of them take turns, after a run of each that its errors are of."""
    exact = _run(motion, LINKS, {"rtol": REFERENCE_RTOL}).position(motion.point)
    entries = [(method, setting) for method, own in settings_of(motion, quick).items() for setting in own]
    runs = [_run(motion, *entry) for entry in entries]
    times = take_turns({k: lambda k=k: _run(motion, *entries[k]).wall_time for k in range(len(entries))}, turns, warm_up=0)
    rows = []
    for k, ((method, setting), run) in enumerate(zip(entries, runs, strict=True)):
        done = run.status == "done"
        rows.append(
            {
                "motion": motion.name, "method": method, "rtol": setting.get("rtol"), "step_s": setting.get("dt"),
                "error_mm": 1e3 * largest_distance(run.position(motion.point), exact) if done else np.nan,
                "wall_s": float(np.median(times[k])), "steps": run.work.steps, "least_tension_N": run.segment_tension.min(),
                "status": run.status,
            }
        )  # fmt: skip
    return rows


def elastic():
    """How far elastic cables are from ones that do not stretch, before the whip."""
    rows, rigid = [], loose(np.inf, law="linear")
    exact = simulate(rigid.scene, ELASTIC_END, method=LINKS, start="straight", rtol=REFERENCE_RTOL, save_every=rigid.save_every)
    for EA in STIFFNESSES:
        scene = loose(EA, law="linear").scene
        run = simulate(scene, ELASTIC_END, method="dop853", start="straight", rtol=ELASTIC_RTOL, save_every=rigid.save_every)
        rows.append({"EA_N": EA, "apart_mm": 1e3 * largest_distance(run.position("tip"), exact.position("tip"))})
    return pd.DataFrame(rows)


def growth(segments, turns):
    """What a node and stage costs in a few steps of the carried net."""
    motion = carried(np.inf, segments)
    t_end = GROWTH_STEPS * GROWTH_STEP * SEGMENTS[0] / segments
    found = []
    for _ in range(turns + 1):
        run = simulate(motion.scene, t_end, method=LINKS, start=motion.start, rtol=1e-4, save_every=t_end)
        found.append(run.wall_time / run.work.force_evaluations / motion.nodes)
    return {"segments": segments, "nodes": motion.nodes, "stage_of_node_ns": 1e9 * float(np.median(found[1:]))}


def compute(quick=False, executor=None, out=None):
    """The tables, one process and one core: timings in parallel would measure each other."""
    turns = QUICK_TURNS if quick else TURNS
    return {
        "runs": pd.DataFrame([row for motion in motions(quick) for row in raced(motion, turns, quick)]),
        "elastic": elastic(),
        "growth": pd.DataFrame([growth(segments, turns) for segments in SEGMENTS[: 3 if quick else None]]),
    }


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "cost": Drawing(
            _plot_cost(rows["runs"]),
            "Error of the tip of the loose cable up to 1 s, past its whip, and of the middle of three nets, over the time of the "
            "run on one core, all with EA = inf: links of order 8 by tolerance, of order 5 and edmc by step.",
        )
    }


def _plot_cost(runs):
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(runs["motion"]))
    figure = Figure(figsize=(10, 3.4), layout="constrained")
    for axes, name in zip(figure.subplots(1, len(names), sharey=True), names, strict=True):
        done = runs[(runs["motion"] == name) & (runs["status"] == "done")]
        for i, (method, line) in enumerate(done.groupby("method", sort=False)):
            axes.loglog(1e3 * line["wall_s"], line["error_mm"], ms=4, label=method, **look(i))
        axes.set(xlabel="time of the run [ms]", title=name.removesuffix(", law linear"))
    figure.axes[0].set(ylabel="largest error [mm]")
    figure.axes[0].legend(frameon=False, fontsize=8)
    return figure


def answer(rows):
    """The answer in words, every number and claim from the rows."""
    names = dict.fromkeys(rows["runs"]["motion"])
    words = [_finding(rows["runs"]), *(_costs(rows["runs"], name) for name in names if name != WHIP)]
    words += [_limit(rows["elastic"]), _growth(rows["growth"]), _left_out(rows["runs"])]
    return "\n\n".join(text for text in words if text)


def _times(runs, name, target):
    """Least time of each method within an error on a motion [s], NaN if it has none."""
    part = runs[(runs["motion"] == name) & (runs["status"] == "done")]
    return {method: time_at(line["error_mm"], line["wall_s"], target)[0] for method, line in part.groupby("method", sort=False)}


def _finding(runs):
    words = []
    for target in TARGETS_MM:
        took = _times(runs, WHIP, target)
        if np.isfinite(took.get(LINKS, np.nan)):
            other = took.get(EDMC, np.nan)
            beside = f", {as_text(other / took[LINKS], 2)} times as fast as edmc" if np.isfinite(other) else ""
            words.append(f"{target:g} mm in {as_text(1e3 * took[LINKS], 2)} ms{beside}")
    if not words:
        return "With none of the tolerances tried do links follow the loose cable past its whip."
    found = "; ".join(words)
    return f"A cable that does not stretch, let go from the horizontal, is followed past its whip by links within {found}."


def _costs(runs, name):
    words = []
    for target in TARGETS_MM:
        took = {method: time for method, time in _times(runs, name, target).items() if np.isfinite(time)}
        if took:
            best = min(took, key=took.get)
            each = listed(f"{method} {as_text(1e3 * time, 2)} ms" for method, time in took.items())
            words.append(f"{best} within {target:g} mm ({each})")
    return f"Cheapest on the {name} is {'; '.join(words)}." if words else ""


def _limit(table):
    slope = np.polyfit(np.log(table["EA_N"]), np.log(table["apart_mm"]), 1)[0]
    apart = between(table["apart_mm"], "mm", 2)
    return (
        f"Elastic cables tend to that motion: up to {ELASTIC_END:g} s their tip is {apart} from it at "
        f"EA of {power(table['EA_N'].max())} down to {power(table['EA_N'].min())} N, by dop853, as EA to the power {slope:.2f}."
    )


def _growth(table):
    return (
        f"A stage of a step costs {between(table['stage_of_node_ns'], 'ns', 2)} a node, with {table['nodes'].min()} to "
        f"{table['nodes'].max()} nodes."
    )


def _left_out(runs):
    ended = runs[runs["status"] != "done"]
    text = "Left out: compile time; cables that cannot push and go slack, which links leave to edmc"
    if len(ended):
        text += f"; the errors of {len(ended)} runs whose step is beyond what transverse waves allow, which ended before their time"
    return text + "."
