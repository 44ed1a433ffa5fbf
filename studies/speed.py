"""What does a step cost, how does the cost grow, and how much faster than real time is the carried net?"""
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from anet_lumped import equilibrium, load_scene, simulate

QUESTION = "What does a step cost, does its cost grow with the size of the net, and how fast is the carried net?"

SCENES = Path(__file__).parent / "scenes"
SEGMENTS = (20, 60, 200, 2000, 25_000)  # of each of the net's four cables
STIFFNESSES = (1e4, 1e5, 1e6, 1e7, 1e8)  # [N]
STEPS = (40e-3, 20e-3, 10e-3, 5e-3)  # [s]
REFERENCE = 0.5e-3  # [s] step of generalised-alpha, another method, that places are compared with
T_END = 4.0  # [s]
REPEATS = 5
METHODS = ("symplectic_euler", "verlet", "edmc")


def net(name, **changes):
    """A bundled scene with all its cables changed."""
    scene = load_scene(SCENES / f"{name}.toml")
    return replace(scene, cables=tuple(replace(cable, **changes) for cable in scene.cables))


def costs(segments, repeats):
    """Nanoseconds a node of an explicit step and of a Newton iteration, and milliseconds of an equilibrium."""
    scene = net("net_carried", segments=segments)
    start, nodes = equilibrium(scene), 4 * segments
    rows = []
    for method in METHODS:
        implicit = method == "edmc"
        dt = 0.01 if implicit else 1e-5 * 20 / segments
        steps = max(10, int((4e5 if implicit else 2e6) / nodes))
        cost = []
        for _ in range(repeats + 1):
            run = simulate(scene, steps * dt, method=method, dt=dt, start=start, save_every=steps * dt)
            cost.append(1e9 * run.wall_time / (run.work.newton_iterations if implicit else steps) / nodes)
        name = "edmc, a Newton iteration" if implicit else f"{method}, a step"
        rows.append({"what": name, "nodes": nodes, "cost_a_node_ns": float(np.median(cost[1:])), "status": run.status})
    held, took = net("net_held", segments=segments), []
    for _ in range(repeats + 1):
        began = time.perf_counter()
        equilibrium(held)
        took.append(time.perf_counter() - began)
    took = float(np.median(took[1:]))
    rows.append({"what": "equilibrium, the whole", "nodes": nodes, "cost_a_node_ns": 1e9 * took / nodes, "status": "done"})
    return rows


def pace(EA, steps, repeats):
    """Times real time of edmc on the carried net, and the error of p0 against another method at a far smaller step."""
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
    """Costs and paces, one process and one core: timings in parallel would measure each other.

    Returns
    -------
    dict of DataFrame : "costs", "paces"
    """
    sizes, stiffnesses, repeats = (SEGMENTS[:2], STIFFNESSES[:1], 2) if quick else (SEGMENTS, STIFFNESSES, REPEATS)
    return {
        "costs": pd.DataFrame([row for segments in sizes for row in costs(segments, repeats)]),
        "paces": pd.DataFrame([row for EA in stiffnesses for row in pace(EA, STEPS, repeats)]),
    }


def plot(rows):
    """Cost a node against size; error of p0 against speed."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 3.8), layout="constrained")
    size, speed = figure.subplots(1, 2)
    for i, (what, part) in enumerate(rows["costs"].groupby("what", sort=False)):
        size.loglog(part.nodes, part.cost_a_node_ns, marker="osv^"[i], ms=4, label=what)
    size.set(xlabel="nodes", ylabel="cost a node [ns]")
    size.legend(frameon=False, fontsize=8)
    for i, (EA, part) in enumerate(rows["paces"].groupby("EA_N")):
        speed.loglog(part.times_real_time, part.p0_error_mm, marker="osv^D"[i], ms=4, label=f"EA = 1e{np.log10(EA):.0f} N")
    speed.axhline(0.1, color="0.6", lw=0.8, ls=":")
    speed.axvline(300, color="0.6", lw=0.8, ls=":")
    speed.set(xlabel="times real time, one core", ylabel="largest error of p0 [mm]", title="edmc at 40, 20, 10 and 5 ms")
    speed.legend(frameon=False, fontsize=8)
    return {"speed": figure}


def answer(rows):
    """Costs a node and the pace of the carried net, with the numbers asked for beside them."""
    costs_of = rows["costs"].pivot(index="nodes", columns="what", values="cost_a_node_ns")
    large, small = costs_of.iloc[-1], costs_of.iloc[0]
    paces = rows["paces"]
    good = paces[paces.p0_error_mm <= 0.1].sort_values("times_real_time").groupby("EA_N").tail(1)
    rest = 1e-6 * small["equilibrium, the whole"] * costs_of.index[0]
    words = [
        f"With p0 within 0.1 mm the carried net runs {good.times_real_time.min():.0f} to {good.times_real_time.max():.0f} times "
        f"faster than real time at EA = {good.EA_N.min():.0e} to {good.EA_N.max():.0e} N, on one core, with edmc at "
        f"{1e3 * good.step_s.min():.0f} ms.",
        f"A step of verlet costs {large['verlet, a step']:.0f} ns a node at {costs_of.index[-1]} nodes and "
        f"{small['verlet, a step']:.0f} ns at {costs_of.index[0]}, where what a step costs apart from its nodes shows; a Newton "
        f"iteration, with its share of the rest of the step, {large['edmc, a Newton iteration']:.0f} and "
        f"{small['edmc, a Newton iteration']:.0f} ns. One Newton iteration is worth "
        f"{large['edmc, a Newton iteration'] / large['verlet, a step']:.1f} explicit steps.",
        f"The held net's equilibrium takes {rest:.2f} ms.",
        "Left out: compile time, which is paid once for a machine and kept; more than one core.",
    ]
    return "\n\n".join(words)
