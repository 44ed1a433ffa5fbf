"""Rows of the study: every model on every net, one after the other in this process, and the root finders."""

import time

import numpy as np
import pandas as pd

from anet_lumped.motion.simulate import simulate
from anet_lumped.motion.stability import predict
from anet_lumped.results.energy_balance import ELASTIC, POTENTIAL
from anet_lumped.statics.equilibrium import equilibrium
from studies.accuracy_cost.paired_timing import seconds_of, take_turns
from studies.accuracy_cost.references import largest_distance
from studies.questions.three_models import energy_method, root_finders, twin
from studies.questions.three_models.cases import (
    BOTTLE,
    FLOWN,
    FOUR,
    MOTIONS,
    QUICK_MOTIONS,
    QUICK_SEGMENTS,
    REFERENCE_SEGMENTS,
    SAVE_EVERY,
    SUPPORTS,
    TWO,
    balanced,
    first_guess,
    net,
    reference,
)

SAMPLED, DESCENDED, BALANCED = "energy, sampled", "energy, by gradient", "energy, by force balance"
LUMPED, LUMPED_DEFAULT = "lumped, edmc at 10 ms", "lumped, default method"
EQUILIBRIUM = "lumped, equilibrium"
TWIN, TWIN_MOCAP = "rigid links", "rigid links, supports as mocap bodies"
EDMC_STEP = 0.01  # [s], the thesis's order of magnitude
POSES_A_SECOND = 100
POSES = {SAMPLED: 2, DESCENDED: 20, BALANCED: 20}  # that are timed, of the energy method
QUICK_POSES = {SAMPLED: 1, DESCENDED: 3, BALANCED: 5}
REPEATS = 3  # of what takes milliseconds: the median counts
PAIRS, TURN = 7, 0.2  # turns that count, and the motion of the links in each [s]
TWIN_REST, QUICK_REST = 1.0, 0.4  # [s] for which the links are left alone
EXPLICIT = ("verlet", "rk4", "dop853")
TWIN_STEPS = (0.004, 0.002, 0.001)  # [s]


def compute(quick=False, executor=None, out=None):
    """The tables; everything that is timed runs one by one in this process."""
    motions, steps, turns = [], [], []
    for motion in QUICK_MOTIONS if quick else MOTIONS:
        p0, t = reference(motion, QUICK_SEGMENTS if quick else REFERENCE_SEGMENTS)
        motions += _motion(motion, t, p0, quick)
        if motion == QUICK_MOTIONS[-1]:
            steps = _steps(motion, t, p0)
            turns = _turns(motion, TWIN_STEPS[0 if quick else -1])
    return {
        "rest": pd.DataFrame([row for name in (TWO, FOUR) for load in (0.0, BOTTLE) for row in _rest(name, load, quick)]),
        "motions": pd.DataFrame(motions),
        "turns": pd.DataFrame(turns),
        "steps": pd.DataFrame(steps),
        "roots": pd.DataFrame(_roots(quick)),
        "starts": pd.DataFrame(_starts()),
    }


def timed(function, repeats=REPEATS):
    """What a function returns, and the median of its times [s]; it is called once before, to compile."""
    result, taken = function(), []
    for _ in range(repeats):
        began = time.perf_counter()
        result = function()
        taken.append(time.perf_counter() - began)
    return result, float(np.median(taken))


def once(function):
    """What a function returns, and the time of the one call [s]."""
    began = time.perf_counter()
    result = function()
    return result, time.perf_counter() - began


# At rest ------------------------------------------------------------------------------------------------------------


def _rest(name, load, quick):
    exact = balanced(name, load)
    ways = {
        SAMPLED: lambda: once(lambda: energy_method.sampled_rest(name, load)),
        DESCENDED: lambda: once(lambda: energy_method.descended_rest(name, load)),
        BALANCED: lambda: timed(lambda: balanced(name, load, elastic=False)),
        EQUILIBRIUM: lambda: timed(lambda: equilibrium(net(name, load)).position("p0")),
    }
    rows = []
    for model, find in ways.items():
        p0, taken = find()
        rows.append(_rest_row(name, load, model, p0, exact, 0.0, taken))
    if twin.installed():
        run = twin.run_twin(net(name, load), QUICK_REST if quick else TWIN_REST, dt=TWIN_STEPS[0])
        rows.append(_rest_row(name, load, TWIN, run.p0[-1], exact, run.setup_s, run.run_s, run.status))
    return rows


def _rest_row(name, load, model, p0, exact, setup, taken, status="done"):
    error = 1e3 * float(np.linalg.norm(p0 - exact))
    return {
        "net": name, "load_g": 1e3 * load, "model": model, "p0_height_m": p0[2], "error_mm": error,
        "setup_ms": 1e3 * setup, "time_ms": 1e3 * taken, "status": status,
    }  # fmt: skip


# In motion ----------------------------------------------------------------------------------------------------------


def _motion(motion, t, p0, quick):
    """Rows of a motion, for each model; errors are those against p0 (k, 3) [m] of the reference at times t (k,) [s]."""
    shift = motion.shift(t)

    def row(model, position, setup, taken, step=np.nan, energy=np.nan, status="done"):
        error = 1e3 * largest_distance(position, p0) if status == "done" else np.nan
        return {
            "motion": motion.name, "net": motion.net, "load_g": 1e3 * motion.load, "model": model, "step_ms": 1e3 * step,
            "error_mm": error, "setup_ms": 1e3 * setup, "time_of_a_second_ms": 1e3 * taken, "energy_change_percent": 100.0 * energy,
            "status": status,
        }  # fmt: skip

    rows = []
    for model, poses in (QUICK_POSES if quick else POSES).items():
        place, pose, setup = _poses(motion, model, poses)
        found = row(model, shift + place, setup, POSES_A_SECOND * pose, step=1.0 / POSES_A_SECOND)
        rows.append(found | {"poses": poses})
    for model, settings in ((LUMPED, {"method": "edmc", "dt": EDMC_STEP}), (LUMPED_DEFAULT, {})):
        (scene, rest), setup = timed(lambda: _lumped_ready(motion))
        run, taken = timed(
            lambda scene=scene, rest=rest, settings=settings: simulate(
                scene, motion.flight.t_end, start=rest, save_every=SAVE_EVERY, **settings
            )
        )
        taken /= motion.flight.t_end
        rows.append(row(model, run.position("p0"), setup, taken, run.dt, _kept(_energy(motion, run)), run.status))
    if twin.installed():
        rows += [row(*found) for found in _twins(motion, quick)]
    return rows


def _lumped_ready(motion):
    scene = motion.scene()
    return scene, equilibrium(scene)


def _poses(motion, model, poses):
    """p0 less the shift of the supports (3,) [m] after some poses at the start; the time of a pose and that of the first p0 [s].

    The sampled cube is about the last p0, carried along with the supports; the other ways start from a first guess in each pose.
    """
    supports, name, load = np.array(SUPPORTS[motion.net]), motion.net, motion.load
    solve = {
        SAMPLED: lambda shift, last: energy_method.sampled_pose(supports + shift, last + shift, load) - shift,
        DESCENDED: lambda shift, _: energy_method.descended(supports + shift, first_guess(name) + shift, load) - shift,
        BALANCED: lambda shift, _: balanced(name, load, elastic=False, shift=shift) - shift,
    }[model]
    first = energy_method.sampled_rest if model == SAMPLED else lambda name, load: solve(np.zeros(3), None)
    place, setup = once(lambda: first(name, load))
    shifts = motion.shift(np.arange(1, poses + 1) / POSES_A_SECOND)
    began = time.perf_counter()
    for shift in shifts:
        place = solve(shift, place)
    return place, (time.perf_counter() - began) / poses, setup


def _energy(motion, run):
    """Energies relative to the supports at the start, after the ramp and at the end of a run, (3,) [J]."""
    found = []
    for k in (0, round(motion.flight.ramp / SAVE_EVERY), len(run.t) - 1):
        mass, n = run.model.mass, run.model.n_free
        carried = np.array(motion.flight.velocity) if k else np.zeros(3)
        kinetic = 0.5 * float((mass[:n, None] * (run.v[k, :n] - carried) ** 2).sum())
        found.append(kinetic + float(run.energy[k, ELASTIC : POTENTIAL + 1].sum()))
    return np.array(found)


def _kept(energy):
    """Change of energy from the end of the ramp to the end, over what the ramp put in, from energies (3,) [J]."""
    start, after_ramp, end = energy
    return float((end - after_ramp) / (after_ramp - start))


def _twins(motion, quick):
    """Arguments of `row` for the rigid links: by each step, and with their supports as mocap bodies."""
    runs = [(TWIN, twin.FRAME, dt) for dt in (TWIN_STEPS[:1] if quick else TWIN_STEPS)]
    if motion.name == FLOWN or not quick:
        runs.append((TWIN_MOCAP, twin.MOCAP, TWIN_STEPS[0]))
    for model, way, dt in runs:
        run = twin.run_twin(motion.scene(), motion.flight.t_end, flight=motion.flight, way=way, dt=dt)
        kept = _kept(run.energy) if way == twin.FRAME else np.nan
        yield model, run.p0[:: round(SAVE_EVERY / dt)], run.setup_s, run.run_s / motion.flight.t_end, dt, kept, run.status


def _turns(motion, dt):
    """Times of a second of motion of edmc and of the links at steps of dt [s], which take turns."""
    if not twin.installed():
        return []
    scene, rest = _lumped_ready(motion)

    def edmc():
        march = seconds_of(lambda: simulate(scene, motion.flight.t_end, start=rest, method="edmc", dt=EDMC_STEP))
        return march / motion.flight.t_end

    def links():
        return twin.run_twin(scene, TURN, flight=motion.flight, dt=dt).run_s / TURN

    times = take_turns({"edmc_s": edmc, "links_s": links}, PAIRS)
    return [
        {"edmc_s": ours, "links_s": theirs, "links_step_ms": 1e3 * dt}
        for ours, theirs in zip(times["edmc_s"], times["links_s"], strict=True)
    ]


def _steps(motion, t, p0):
    """Largest stable steps of the methods on a motion."""
    limits = predict(motion.scene(), schemes=(*EXPLICIT, "edmc")).limits
    rows = [
        {"net": motion.net, "model": "lumped", "method": name, "largest_step_ms": 1e3 * limits[name].step, "known": "predicted"}
        for name in limits
    ]
    if twin.installed():
        step = twin.largest_step(motion, t, p0, TWIN_STEPS[0])
        rows.append(
            {
                "net": motion.net,
                "model": TWIN,
                "method": "implicitfast",
                "largest_step_ms": 1e3 * step,
                "known": "found by doubling",
            }
        )
    return rows


# Root finders -------------------------------------------------------------------------------------------------------


def _roots(quick):
    rows = []
    for span in root_finders.SPANS:
        brackets = root_finders.QUICK_BRACKETS if quick else root_finders.BRACKETS
        for bracket in brackets if not quick or span is root_finders.SPANS[0] else brackets[:1]:
            for method in (root_finders.BISECTION, root_finders.FALSE_POSITION):
                found = root_finders.bracketed(span, bracket, method)
                rows.append(_root_row(span, method, found) | {"from_m": bracket[0], "to_m": bracket[1]})
        rows.append(_root_row(span, root_finders.OURS, root_finders.ours(span)))
    return rows


def _root_row(span, method, found):
    exact = root_finders.ours(span).root
    return {
        "cable": span.name, "method": method, "from_m": np.nan, "to_m": np.nan, "iterations": found.iterations, "a_m": found.root,
        "error_m": abs(abs(found.root) - exact), "status": found.status,
    }  # fmt: skip


def _starts():
    rows = []
    for span in root_finders.SPANS:
        for start in root_finders.STARTS:
            root, evaluations, status = root_finders.unbracketed(span, start)
            rows.append({"cable": span.name, "start_m": start, "evaluations": evaluations, "a_m": root, "status": status})
    return rows
