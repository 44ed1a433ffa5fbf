"""What does a step cost, how does the cost grow, and how much faster than real time is the carried net?"""

import time

import numpy as np
import pandas as pd
from numba import njit

from anet_lumped import equilibrium, simulate
from anet_lumped.mechanics import newton_step, residual, settle
from anet_lumped.mechanics.fresh_net import fresh_net
from integrators.stage import LAW_BETWEEN, Stage
from studies.accuracy_cost.cases import net

QUESTION = "What does a step cost, does its cost grow with the size of the net, and how fast is the carried net?"

SEGMENTS = (20, 60, 200, 2000, 25_000)  # of each of the net's four cables
STIFFNESSES = (1e4, 1e5, 1e6, 1e7, 1e8)  # [N]
STEPS = (40e-3, 20e-3, 10e-3, 5e-3)  # [s]
REFERENCE = 0.5e-3  # [s] step of generalised-alpha, another method, that places are compared with
T_END = 4.0  # [s]
REPEATS = 5
TIMED = ("symplectic_euler", "verlet")  # a step of these
ITERATION, ACCOUNT = "edmc, a Newton iteration", "edmc, energy account and calming of a step"


@njit(cache=True)
def newton_iterations(stage, base, target, q, place, times):
    """What Newton's method does in an iteration, again and again at one place."""
    for _ in range(times):
        residual.residual(stage, base, target, q, place)
        newton_step.direction(stage, place)
        newton_step.correct(place, 0.0, q)


@njit(cache=True)
def accounts(stage, base, q, v, place, energy, times):
    """What the energy balance adds to a step of edmc, and what calms its velocities."""
    for _ in range(times):
        settle.settle(stage, base, q, v, place, energy)


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
    """A row for each thing that costs, in nanoseconds a node; the repeats take turns, so that all see the same machine."""
    held = net("net_held", segments=segments)
    rest = equilibrium(held)
    start, nodes, h = equilibrium(net("net_carried", segments=segments)), rest.model.n, 0.01
    arrays, q, v, energy = fresh_net(rest.model), rest.q.copy(), np.zeros_like(rest.q), np.zeros(4)
    arrays.tension[:] = rest.segment_tension
    stage = Stage(LAW_BETWEEN, 0.5 * h, 2.0 / h**2, 0.5, h, 0.5)
    steps, iterations = max(10, int(2e6 / nodes)), max(5, int(1e6 / nodes))
    found = []
    for _ in range(repeats + 1):
        row = {f"{method}, a step": run_seconds(start, method, 2e-4 / segments, steps) for method in TIMED}
        row["edmc, a step"] = run_seconds(start, "edmc", h, max(10, steps // 10))
        row[ITERATION] = seconds(newton_iterations, stage, rest.q, rest.q, q, arrays.address, times=iterations)
        row[ACCOUNT] = seconds(accounts, stage, rest.q, q, v, arrays.address, energy, times=iterations)
        began = time.perf_counter()
        equilibrium(held)
        found.append(row | {"equilibrium": time.perf_counter() - began})
    medians = pd.DataFrame(found[1:]).median().items()
    return [{"what": what, "nodes": nodes, "cost_a_node_ns": 1e9 * s / nodes, "total_ms": 1e3 * s} for what, s in medians]


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
        size.loglog(part.nodes, part.cost_a_node_ns, marker="osv^DP"[i], ms=4, label=what)
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
    held = rows["costs"][rows["costs"].what == "equilibrium"].iloc[0]
    paces = rows["paces"]
    good = paces[paces.p0_error_mm <= 0.1].sort_values("times_real_time").groupby("EA_N").tail(1)

    def between(what):
        return f"{costs_of[what].min():.0f} to {costs_of[what].max():.0f} ns"

    words = [
        f"With p0 within 0.1 mm the carried net runs {good.times_real_time.min():.0f} to {good.times_real_time.max():.0f} times "
        f"faster than real time at EA = {good.EA_N.min():.0e} to {good.EA_N.max():.0e} N, on one core, with edmc at "
        f"{1e3 * good.step_s.min():.0f} ms.",
        f"A node costs {between('symplectic_euler, a step')} in a step of symplectic Euler, {between('verlet, a step')} in one of "
        f"verlet and {between(ITERATION)} in a Newton iteration, over {costs_of.index[0]} to {costs_of.index[-1]} nodes; the "
        f"largest explicit ones at {costs_of['verlet, a step'].idxmax()} nodes. A whole step of edmc costs as much as "
        f"{(costs_of['edmc, a step'] / costs_of['verlet, a step']).median():.0f} steps of verlet.",
        f"The energy balance and the calming of velocities take {100 * (costs_of[ACCOUNT] / costs_of['edmc, a step']).max():.1f} % "
        "of a step of edmc at most; "
        "an explicit step has it from the force at two additions a segment.",
        f"The held net's equilibrium takes {held.total_ms:.2f} ms.",
        "Left out: compile time, which is paid once for a machine and kept; more than one core.",
    ]
    return "\n\n".join(words)
