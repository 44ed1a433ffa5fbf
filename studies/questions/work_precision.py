"""What does accuracy cost: error against wall time of every method here and of other engines, on the same motions?

Each method runs at several steps or tolerances, coarse to fine, in one process; all take turns, and of runs that are cheap
the median of several counts. Errors are those of one point's position, largest over the saved times, against another method at
a far smaller step (`references`). Where cables slacken, the law of a slack segment decides about the motion: there all cables
are "damped", the law that other engines have too, and a setting of an engine that has only two-way springs is judged by the
motion of such springs.
"""

import time
from functools import partial

import numpy as np
import pandas as pd

from anet_lumped import simulate
from anet_lumped.motion.energy_gain import GAINED
from anet_lumped.motion.stability import predict
from studies.accuracy_cost import contestants, total_error
from studies.accuracy_cost.comparisons import equal_errors, own_choices, paired
from studies.accuracy_cost.motions import SHARED_LAW, carried, dropped, loose, stopped
from studies.accuracy_cost.references import Reference, largest_distance, reference, track
from studies.accuracy_cost.work_precision_answer import answer
from studies.accuracy_cost.work_precision_figures import plot
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.COST,
    first_look="two motions in place of twelve, five of the methods here and none of other engines.",
)
TABLES = {
    "equal_error": "A line for each motion and error: the best method here and the best other engine at that error.",
    "own_choice": "A line for each motion: what the library chooses by itself, and its best method at the same error.",
    "pairs": "A line for each comparison of two times, from runs that took turns: the median of their ratios, and its interval.",
    "references": "A line for each motion: the two methods that judge all others, and how far they are apart.",
    "runs": "A line for each method and setting on each motion: its error and its time.",
    "total_error": "A line for each run of the carried net: its error against the continuous inextensible net, in parts.",
    "growth": "A line for each number of nodes: time and error of edmc at one step, and what verlet would need.",
    "first_calls": "A line for each method: what its first run in a process takes beside the run itself.",
    "refused": "A line for each motion and engine that does not take it, and why.",
}

STIFFNESSES = (1e4, 1e6, 1e8, np.inf)  # EA of the carried net [N]; infinite for cables that do not stretch
LOOSE_STIFFNESSES = (1e4, 1e6)  # [N]
SHOCK_EA = 1e6  # of the net that is stopped, and of that which drops its load [N]
FINE_EA, FINE_SEGMENTS = 1e6, (80, 320)
LONGEST = 0.8  # [s] of wall time: after a run that took longer a method's finer settings are left out
CHEAP, REPEATS = 0.1, 3  # [s] and runs of what takes less
SOFT, COARSE = 1e4, 20  # [N] and segments, up to which solvers of other packages are run
PILOT = 0.125  # of the time between two saves: a run to predict the cost of a whole one by
LONG_PILOT = 0.1  # of the whole time, for solvers of other packages, whose steps differ much
GROWTH_SEGMENTS = (20, 80, 320, 2500, 25_000)  # of each of the net's four cables, up to 1e5 nodes
GROWTH_EA, GROWTH_END, GROWTH_STEP = 1e6, 1.0, 10e-3  # [N], [s], [s]
GROWTH_REFERENCE = (4e-3, 2e-3)  # [s] steps of generalised-alpha, extrapolated


def all_motions(quick=False):
    """The motions, cheapest family first."""
    if quick:
        return [loose(LOOSE_STIFFNESSES[0]), carried(STIFFNESSES[0], t_end=1.0)]
    found = [loose(EA) for EA in LOOSE_STIFFNESSES] + [loose(LOOSE_STIFFNESSES[-1], law="none")]
    found += [loose(FINE_EA, segments) for segments in FINE_SEGMENTS] + [loose(np.inf, law="linear")]
    found += [carried(EA) for EA in STIFFNESSES] + [carried(FINE_EA, segments) for segments in FINE_SEGMENTS]
    return [*found, stopped(SHOCK_EA), dropped(SHOCK_EA)]


def compute(quick=False, executor=None, out=None):
    """All runs, one process and one core: timings in parallel would measure each other."""
    only = ("edmc", "verlet", contestants.ADAPTIVE, contestants.EXTRAPOLATED, contestants.OWN_CHOICE) if quick else None
    motions = all_motions(quick)
    first = first_calls(motions[0], only)
    judges = {motion: reference(motion) for motion in motions}
    same = {
        motion: not quick and (judges[motion].taut or motion.law == SHARED_LAW) for motion in motions
    }  # other engines solve it too
    raced = [race(motion, judges[motion], only, same[motion]) for motion in motions]
    runs = pd.concat([table for table, _ in raced], ignore_index=True)
    entries = [entry for _, of_motion in raced for entry in of_motion]
    equal, own = equal_errors(runs), own_choices(runs)
    refused = [(motion, *said) for motion in motions if same[motion] for said in contestants.refusals(motion).items()]
    return {
        "equal_error": equal,
        "own_choice": own,
        "pairs": paired(runs, entries, equal, own),
        "references": pd.DataFrame([_about(motion, judges[motion]) for motion in motions]),
        "runs": runs,
        "total_error": total_error.compute(quick),
        "growth": pd.DataFrame([growth(segments) for segments in GROWTH_SEGMENTS[: 2 if quick else None]]),
        "first_calls": first,
        "refused": pd.DataFrame(
            [{**_names(motion), "engine": engine, "reason": reason} for motion, engine, reason in refused],
            columns=["motion", "EA_N", "segments", "engine", "reason"],
        ),
    }


# Runs ---------------------------------------------------------------------------------------------------------------


def race(motion, judge, only=None, with_peers=True):
    """Every contestant at every setting of one motion, a row each; and for each row what runs it again, or None.

    Settings run from coarse to fine until one takes longer than LONGEST or would by the pace of a short run before it;
    then those that are cheap run again, in turns.
    """
    field = contestants.ours(motion, only) + (contestants.peers(motion) if with_peers else [])
    judges = {motion.law: judge}
    rows, again, entries = [], [], []
    for one in field:
        too_long = _too_long(motion, one)
        for setting in one.settings:
            row = {**_names(motion), "engine": one.engine, "method": one.method, "setting": contestants.setting_in_words(setting)}
            rows.append(row | {"step_ms": 1e3 * setting.get("dt", np.nan)})
            entries.append(None if too_long else partial(_wall, one, motion.t_end, setting))
            if too_long:
                finer = " and finer" if setting is not one.settings[-1] else ""
                rows[-1] |= {"status": "left out", "reason": too_long, "repeats": 0, "setting": row["setting"] + finer}
                break
            attempt = one.run(motion.t_end, setting)
            rows[-1] |= {"wall_s": attempt.wall, "setup_s": attempt.setup, "status": attempt.status}
            rows[-1] |= {"reason": attempt.reason, "repeats": 1}
            if attempt.status == "refused":
                break
            if attempt.status in ("done", GAINED):
                rows[-1]["error_mm"] = 1e3 * _judge(motion, judges, one).error(one.method, attempt.position)
                if attempt.wall < CHEAP:
                    again.append((rows[-1], one, setting, [attempt.wall]))
            if attempt.wall > LONGEST:
                too_long = f"the setting before took {attempt.wall:.1f} s, and {LONGEST:g} s are the bound"
    for _ in range(REPEATS - 1):
        for _, one, setting, walls in again:
            walls.append(one.run(motion.t_end, setting).wall)
    for row, _, _, walls in again:
        row |= {"wall_s": float(np.median(walls)), "repeats": len(walls)}
    names = [*_names(motion), "engine", "method", "setting", "step_ms", "error_mm", "wall_s", "times_real_time", "setup_s"]
    table = pd.DataFrame(rows).reindex(columns=[*names, "repeats", "reference_mm", "status", "reason"])
    table["times_real_time"], table["reference_mm"] = motion.t_end / table["wall_s"], 1e3 * judge.difference
    return table, entries


def _wall(one, t_end, setting):
    """Time of the march of a run [s]."""
    return one.run(t_end, setting).wall


def _names(motion):
    return {"motion": motion.name, "EA_N": motion.EA, "segments": motion.segments}


def _too_long(motion, one):
    """Why even the coarsest setting is left out, by the pace of a short run; empty if it is not."""
    own = one.engine == contestants.OURS
    elsewhere = own and contestants.of_another_package(one.method)
    if elsewhere and (motion.EA > SOFT or motion.segments > COARSE):
        return f"solvers of other packages are run to EA = {SOFT:g} N and {COARSE} segments only"
    setting, expected = one.settings[0], np.inf
    duration = min(motion.save_every, max(PILOT * motion.save_every, setting.get("dt", motion.save_every)))
    duration = LONG_PILOT * motion.t_end if elsewhere else duration
    for _ in range(2 if own else 1):  # the first may compile
        if expected > LONGEST:
            expected = one.run(duration, setting).wall * motion.t_end / duration
    return f"it would take about {expected:.2g} s, and {LONGEST:g} s are the bound" if expected > 2.0 * LONGEST else ""


def _judge(motion, judges, one):
    """Reference of the law by which a contestant moves cables; one for all laws where a smooth motion leaves all taut."""
    law = motion.law if judges[motion.law].taut and motion.law != SHARED_LAW else one.law
    if law not in judges:
        judges[law] = reference(motion.with_law(law))
    return judges[law]


def _about(motion, judge: Reference):
    first, second = judge.tracks
    return {
        **_names(motion), "nodes": motion.nodes, "law": motion.law, "duration_s": motion.t_end, "judge": first,
        "checked_by": second, "difference_mm": 1e3 * judge.difference, "taut_when_saved": judge.taut,
    }  # fmt: skip


def first_calls(motion, only=None):
    """Seconds of a method's first run in this process, less its second: kernels compiled, or loaded from the disk."""
    found = []
    for one in contestants.ours(motion, only):
        took = []
        for _ in range(2):
            began = time.perf_counter()
            one.run(motion.save_every, one.settings[0])
            took.append(time.perf_counter() - began)
        found.append({"method": one.method, "first_minus_second_s": took[0] - took[1]})
    return pd.DataFrame(found)


def growth(segments):
    """Cost and error of one step of edmc as the carried net is divided, and what verlet at its limit would cost."""
    motion = carried(GROWTH_EA, segments, GROWTH_END)
    exact = track(motion, "generalised_alpha", GROWTH_REFERENCE)
    walls = []
    while len(walls) < 2 or (len(walls) < REPEATS and sum(walls) < CHEAP):
        run = simulate(
            motion.scene, GROWTH_END, method="edmc", dt=GROWTH_STEP, start=motion.start, save_every=motion.save_every, check=True
        )
        walls.append(run.wall_time)
    limit = predict(motion.scene, schemes=("verlet",)).limits["verlet"].step
    few = 2 + int(2e5 / motion.nodes)
    explicit = simulate(motion.scene, few * limit, method="verlet", dt=limit, start=motion.start, save_every=few * limit)
    return {
        "segments": segments, "nodes": motion.nodes, "error_mm": 1e3 * largest_distance(run.position(motion.point), exact.position),
        "wall_s": float(np.median(walls)), "newton_per_step": run.work.newton_iterations / run.work.steps,
        "verlet_step_s": limit, "verlet_predicted_s": explicit.wall_time / few * GROWTH_END / limit,
    }  # fmt: skip
