"""Tables of the study `nets`."""

import time

import numpy as np
import pandas as pd

from anet_lumped import Scene, equilibrium, nets, simulate, wind
from anet_lumped.effects import Gravity
from studies.peers import exudyn, mujoco, mujoco_flex
from studies.questions.nets.junctions import solve_rows

SIZES = (10, 20, 30, 60, 100)  # points along each side
LARGE = 60  # points along a side, from which on a rest is timed once
SIDE, CABLE = 3.0, {"mass_per_length": 0.01, "EA": 1e3, "zeta": 0.05, "diameter": 2e-3, "compression": "damped"}  # [m]
SLACK, KNOT = 0.02, 1e-3  # share by which cables are longer than their meshes; mass of a knot that moves [kg]
CURRENT = (0.3, 0.0, 0.0)  # [m/s]
AIR, STREAM = "air", "current"
TILT = (0.3, 0.0, -1.0)  # direction of the gravity in whose rest the motion starts
MOVED, QUICK_MOVED, T_END, SAVED = 30, 10, 0.2, 0.05  # points along a side; [s], [s]
REPEATS, QUICK_REPEATS = 5, 3
SETTINGS = 1  # that a peer is given of each of its methods, the coarsest
TURNS = 3  # in each of which every setting runs once; medians count
BRIEF = 1e-4  # [s] of a run, or else one step, whose time is that of what comes before a march and after it
PAIRS = 5  # of such runs and whole ones, of which the median difference counts: what comes before an explicit march takes as long
CLOCK = 1e-5  # [s] that a difference of two times of the processor is known to at best
SLOWEST = 2e-3  # [s] of MuJoCo's implicit steps: at longer ones the net sways itself apart
REFERENCE = {"method": "dop853", "rtol": 1e-9}
OWN = "this library"
OWN_SETTINGS = [{"method": "edmc", "dt": SAVED / n} for n in (2, 4, 8, 16, 32)] + [{"method": "verlet"}]
PEERS = (mujoco, mujoco_flex, exudyn)
TARGETS_MM = (1.0, 0.1)


def hung(points, *, deep=False, slack=SLACK, knot_mass=0.0):
    """A square net of so many points along each side that hangs by its corners, in air or in a current."""
    z = -1.0 if deep else 0.0
    corners = [(0, 0, z), (SIDE, 0, z), (SIDE, SIDE, z), (0, SIDE, z)]
    parts = nets.grid((points - 1, points - 1), corners, cable=CABLE, slack=slack, knot_mass=knot_mass)
    if not deep:
        return Scene(parts.points, parts.cables, [Gravity()])
    from anet_lumped.effects import Water  # a list of the studies does without its kernels

    return Scene(parts.points, parts.cables, [Gravity(), Water(current=wind.Uniform(CURRENT))])


def compute(quick=False, executor=None, out=None):
    """The tables, one process and one core: timings in parallel would measure each other."""
    sizes, repeats = (SIZES[:2], QUICK_REPEATS) if quick else (SIZES, REPEATS)
    solves, rests = [], []
    for points in sizes:
        for around, deep in ((AIR, False), (STREAM, True)):
            scene = hung(points, deep=deep)
            rest, seconds = equilibrium(scene), []  # compiled, and cut, before it is timed
            for _ in range(3 if points < LARGE else 1):
                began = time.process_time()
                equilibrium(scene)
                seconds.append(time.process_time() - began)
            rests.append({"around": around, "side": points, "cables": len(scene.cables), "rest_s": float(np.median(seconds))})
            if not deep:
                solves += [{"side": points} | row for row in solve_rows(rest, repeats)]
    return {"solves": pd.DataFrame(solves), "rests": pd.DataFrame(rests), "motions": pd.DataFrame(motions(quick))}


def motions(quick):
    """A row for each engine and setting on one motion."""
    scene = hung(QUICK_MOVED if quick else MOVED, slack=0.0, knot_mass=KNOT)
    tilted = Scene(scene.points, scene.cables, [Gravity(direction=TILT)])
    start, names = equilibrium(tilted), [point.name for point in scene.points]

    def timed(t_end, save_every, setting):
        began = time.process_time()
        run = simulate(scene, t_end, start=start, save_every=save_every, **setting)
        return run, time.process_time() - began

    def own(**setting):
        brief = setting.get("dt", BRIEF)
        pairs = [(timed(T_END, SAVED, setting), timed(brief, brief, setting)) for _ in range(PAIRS)]
        march = float(np.median([whole - around for (_, whole), (_, around) in pairs]))
        run = pairs[0][0][0]
        return run.status, max(march, CLOCK) * T_END / (T_END - brief), run.position

    def of_peer(engine, setting):
        outcome = engine.run(scene, T_END, SAVED, start, **setting)
        return outcome.status, outcome.cpu_time, outcome.position.__getitem__

    def all_points(position):
        return np.stack([position(name) for name in names])

    exact = all_points(timed(T_END, SAVED, REFERENCE)[0].position)
    for setting in OWN_SETTINGS:  # compiles what it needs
        own(**setting)
    contests = [(OWN, setting, lambda setting=setting: own(**setting)) for setting in OWN_SETTINGS]
    for engine in PEERS:
        if engine.version() is not None and engine.refuses(scene) is None:
            contests += [
                (engine.NAME, one, lambda engine=engine, one=one: of_peer(engine, one)) for one in _settings(engine, scene)
            ]
    taken = [[contest() for *_, contest in contests] for _ in range(1 if quick else TURNS)]
    rows = []
    for (engine, setting, _), turns in zip(contests, zip(*taken, strict=True), strict=True):
        status, _, position = turns[0]
        seconds = float(np.median([cpu for _, cpu, _ in turns]))
        error = float(np.linalg.norm(all_points(position) - exact, axis=2).max()) if status == "done" else np.nan
        rows.append(
            {
                "engine": engine, "setting": ", ".join(f"{key}={_short(value)}" for key, value in setting.items()),
                "method": setting.get("method", setting.get("integrator", setting.get("solver"))), "error_mm": 1e3 * error,
                "cpu_s": seconds, "status": status,
            }
        )  # fmt: skip
    return rows


def _settings(engine, scene):
    """The coarsest settings of each method of a peer."""
    found = {}
    for setting in engine.settings(scene):
        method = setting.get("integrator", setting.get("solver"))
        if not (method == "discrete" and setting["dt"] > SLOWEST):
            found.setdefault(method, []).append(setting)
    return [setting for own in found.values() for setting in own[:SETTINGS]]


def _short(value):
    return f"{value:.3g}" if isinstance(value, float) else value
