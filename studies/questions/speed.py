"""What does a step cost, does its cost grow with the size of the net, and how fast is the carried net?"""

import time

import numpy as np
import pandas as pd

from anet_lumped import equilibrium, simulate
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.views.palette import look
from integrators.stage import LAW_BETWEEN, Stage
from studies.accuracy_cost.motions import net
from studies.accuracy_cost.paired_timing import in_words, ratio, seconds_of, take_turns
from studies.shown.sentences import between, counted, listed, power, stiffness
from studies.shown.show import as_text
from studies.study import Drawing, Part, Record

STUDY = Record(
    question=__doc__,
    part=Part.CURE,
    first_look="the net has up to 800 segments in place of 100,000 and three stiffnesses in place of five, and all is "
    "timed in 6 turns in place of 12.",
    compares_times=True,
)
TABLES = {
    "costs": "A line for each number of nodes and each thing that costs: the median of its times.",
    "turns": "A line for each number of nodes and each turn in which all of them were timed, in s.",
    "paces": "A line for each stiffness and step of edmc on the carried net: error of p0, and how fast it is.",
}

SEGMENTS = (20, 60, 200, 2000, 25_000)  # of each of the net's four cables
STIFFNESSES = (1e4, 1e5, 1e6, 1e7, 1e8)  # [N]
STEPS = (40e-3, 20e-3, 10e-3, 5e-3)  # [s]
REFERENCE = 0.5e-3  # [s] step of generalised-alpha, another method, that places are compared with
T_END = 4.0  # [s]
REPEATS, QUICK_REPEATS = 12, 6  # turns in which everything is timed
TARGET_MM = 0.1  # error of p0 at which paces are compared
TIMED = ("symplectic_euler", "verlet")  # a step of these
EXPLICIT_STEP = "{}, a step"
STEP, ITERATION, ACCOUNT = "edmc, a step", "edmc, a Newton iteration", "edmc, energy account and calming of a step"


def seconds(function, *arguments, times):
    """Time of one of a number of repetitions inside a compiled function [s]."""
    function(*arguments, 1)
    began = time.perf_counter()
    function(*arguments, times)
    return (time.perf_counter() - began) / times


def run_seconds(start, method, dt, steps):
    """Time of a step of a run that saves its end only [s]."""
    run = simulate(start.scene, steps * dt, method=method, dt=dt, start=start, save_every=steps * dt)
    return run.wall_time / run.work.steps


def costs(segments, repeats):
    """A row for each thing that costs, in nanoseconds a node, and a row for each turn in which all of them were timed."""
    from studies.accuracy_cost.compiled_loops import accounts, newton_iterations

    held = net("net_held", segments=segments)
    rest = equilibrium(held)
    start, nodes, h = equilibrium(net("net_carried", segments=segments)), rest.model.n, 0.01
    arrays, q, v, energy = fresh_net(rest.model), rest.q.copy(), np.zeros_like(rest.q), np.zeros(4)
    arrays.tension[:] = rest.segment_tension
    stage = Stage(LAW_BETWEEN, 0.5 * h, 2.0 / h**2, 0.5, h, 0.5)
    steps, iterations = max(10, int(2e6 / nodes)), max(5, int(1e6 / nodes))
    timed = {EXPLICIT_STEP.format(method): lambda name=method: run_seconds(start, name, 2e-4 / segments, steps) for method in TIMED}
    timed |= {
        STEP: lambda: run_seconds(start, "edmc", h, max(10, steps // 10)),
        ITERATION: lambda: seconds(newton_iterations, stage, rest.q, rest.q, q, arrays.address, times=iterations),
        ACCOUNT: lambda: seconds(accounts, stage, rest.q, q, v, arrays.address, energy, times=iterations),
        "equilibrium": lambda: seconds_of(lambda: equilibrium(held)),
    }
    turns = pd.DataFrame(take_turns(timed, repeats))
    found = [
        {"what": what, "nodes": nodes, "cost_a_node_ns": 1e9 * s / nodes, "total_ms": 1e3 * s} for what, s in turns.median().items()
    ]
    turns.insert(0, "nodes", nodes)
    return found, turns


def pace(EA, steps, repeats):
    """How many times faster than real time edmc carries the net, and p0's error against another method at a far smaller step."""
    scene = net("net_carried", EA=EA)
    reference = simulate(scene, T_END, method="generalised_alpha", dt=REFERENCE, save_every=0.04).position("p0")
    rows = []
    for dt in steps:
        runs = [simulate(scene, T_END, method="edmc", dt=dt, save_every=0.04) for _ in range(repeats + 1)][1:]
        error = np.linalg.norm(runs[0].position("p0") - reference, axis=1).max()
        wall = float(np.median([run.wall_time for run in runs]))
        work = runs[0].work
        rows.append(
            {
                "EA_N": EA, "step_s": dt, "p0_error_mm": 1e3 * error, "times_real_time": T_END / wall,
                "newton_per_step": work.newton_iterations / work.steps, "imbalance": runs[0].energy_balance.imbalance,
                "status": runs[0].status,
            }
        )  # fmt: skip
    return rows


def compute(quick=False, executor=None, out=None):
    """The tables, one process and one core: timings in parallel would measure each other."""
    sizes, stiffnesses, repeats = (SEGMENTS[:3], STIFFNESSES[::2], QUICK_REPEATS) if quick else (SEGMENTS, STIFFNESSES, REPEATS)
    found = [costs(segments, repeats) for segments in sizes]
    return {
        "costs": pd.DataFrame([row for rows, _ in found for row in rows]),
        "turns": pd.concat([turns for _, turns in found], ignore_index=True),
        "paces": pd.DataFrame([row for EA in stiffnesses for row in pace(EA, STEPS, repeats // 3)]),
    }


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "speed": Drawing(
            _plot_speed(rows["costs"], rows["paces"]),
            "Left: what a step, a Newton iteration and statics cost a node over the number of nodes, on one core. Right: error of "
            "p0 in 4 s of the carried net over how many times faster than real time edmc runs, at steps of 40, 20, 10 and 5 ms.",
        )
    }


def _plot_speed(costs_of, paces):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.4), layout="constrained")
    size, speed = figure.subplots(1, 2)
    for i, (what, part) in enumerate(costs_of.groupby("what", sort=False)):
        size.loglog(part.nodes, part.cost_a_node_ns, ms=4, label=what, **look(i))
    size.set(xlabel="nodes", ylabel="cost a node [ns]")
    for i, (EA, part) in enumerate(paces.groupby("EA_N")):
        speed.loglog(part.times_real_time, part.p0_error_mm, ms=4, label=stiffness(EA), **look(i))
    speed.axhline(TARGET_MM, color="0.6", lw=0.8, ls=":")
    speed.set(xlabel="times faster than real time, one core", ylabel="largest error of p0 [mm]")
    for axes in (size, speed):
        axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    return figure


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    table = rows["costs"].pivot(index="nodes", columns="what", values="cost_a_node_ns")
    held = rows["costs"][rows["costs"].what == "equilibrium"].iloc[0]
    return "\n\n".join(
        [
            _finding(rows["paces"]),
            _growth(table),
            _ratios(rows["turns"]),
            f"The held net's equilibrium takes {as_text(held.total_ms, 2)} ms with {held.nodes} nodes.",
            "Left out: compile time, which a machine spends once and keeps on its disk; more than one core.",
        ]
    )


def _finding(paces):
    good = paces[(paces.p0_error_mm <= TARGET_MM) & (paces.status == "done")].sort_values("times_real_time").groupby("EA_N").tail(1)
    if not len(good):
        return f"With none of the steps tried does the carried net keep p0 within {TARGET_MM:g} mm."
    missed = sorted(set(paces.EA_N) - set(good.EA_N))
    words = (
        f"With p0 within {TARGET_MM:g} mm the carried net runs {between(good.times_real_time, 'times', 2)} faster than real time "
        f"at EA = {between_stiffnesses(good.EA_N)}, on one core, with edmc at {between(1e3 * good.step_s, 'ms')}."
    )
    return words + (f" At {listed(map(stiffness, missed))} no step tried is as accurate." if missed else "")


def between_stiffnesses(values):
    """ "1e4 N", or "1e4 to 1e8 N"."""
    low, high = power(min(values)), power(max(values))
    return f"{low} N" if low == high else f"{low} to {high} N"


def _growth(table):
    """What a node costs, and whether that grows with the net."""
    words = []
    for what in (*(EXPLICIT_STEP.format(method) for method in TIMED), STEP, ITERATION):
        slope = np.polyfit(np.log(table.index), np.log(table[what]), 1)[0]
        words.append(f"{between(table[what], 'ns', 2)} ({what}; nodes to the power {slope:+.2f})")
    return (
        f"A node costs {listed(words)}, over {table.index[0]} to {table.index[-1]} nodes. Where the power is 0 the cost grows in "
        "proportion to the net."
    )


def _ratios(turns):
    verlet, words = EXPLICIT_STEP.format("verlet"), []
    for nodes, part in turns.groupby("nodes"):
        words.append(
            f"with {nodes} nodes {in_words(ratio(part[STEP], part[verlet]), 2)} and {in_words(ratio(part[ACCOUNT], part[STEP]), 2)}"
        )
    return (
        "Timed in turns, with the interval in which the median lies: the time of a step of edmc over that of verlet, and that of "
        f"the energy balance and the calming of velocities over that of the whole step of edmc: {'; '.join(words)}. That is by "
        f"{counted(len(turns) // turns['nodes'].nunique(), 'pair')} each. An explicit step has its balance from the force at two "
        "additions a segment."
    )
