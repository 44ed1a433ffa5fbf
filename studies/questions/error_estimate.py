"""How wrong can it be: what do runs say of their own errors beside the truth, and what does the default keep?"""

import itertools
import json
import math
import warnings

import numpy as np
import pandas as pd

from anet_lumped import EquilibriumError, simulate
from anet_lumped.motion.choice import SHARE_OF_TIME_SCALE, time_scale
from anet_lumped.motion.known_errors import ERROR_OF_LENGTH, ERROR_OF_MOTION, TENSION_ERROR, Wanted
from anet_lumped.views.palette import look
from studies.catalogue.random_motions import random_motion
from studies.shown.sentences import counted, percent
from studies.study import Drawing, Part, Record
from studies.sweeping.rows import run_rows

STUDY = Record(
    question=__doc__,
    part=Part.COST,
    first_look="up to a fifth of 10 random motions of every kind in place of 200, and of 2 hard cases.",
)
TABLES = {
    "runs": "A line for each run: what it tells of its largest error of a place and of its largest tension, and the truth.",
    "cases": "The same of the hard cases of the catalogue.",
    "defaults": "A line for each motion with neither method nor step given: what was kept, what the run says, and the truth.",
}

MOTIONS = 200
QUICK_MOTIONS = (0, 3, 4, 5, 6, 9, 15, 16, 35, 48)  # of each kind, those whose references are short
STEPS = (4.0, 2.0, 1.0, 0.5)  # of a 32nd of the motion's time scale
MOST_STEPS, QUICK_MOST_STEPS = 3000, 600  # of the second of these
FINER = (8, 16, 32)  # times as short as the shortest are the steps of the three references, extrapolated
RESOLVED = 0.1  # of an error: what the finest reference may be off by where it is judged
SLOWEST = 0.95  # of the difference of the first two references: what the other two differ by at most, in the sum of a series
MOST_NODE_STEPS = 3e5  # segments times steps of the first of these, of hard cases
QUICK_CASES = ("swing, EA 1e+04 N", "quadrotors drop a net")
UNDAMPED = 1.0  # rho_inf of the references of tensions: a numerical damper would take vibrations that are there, at any step alike
FACTOR, FAR = 4.0, 10.0  # between an estimate and the truth
SEEN = 1e-3  # of the largest tension: errors of it that are judged
SMALL = 1e-9  # of the length: round-off


def compare(row):
    """Runs of one motion with some steps, and by default, beside the reference."""
    motion = random_motion(row["number"])
    scene, start = motion.scene, motion.start
    length = scene.longest
    found = {"kind": motion.kind, "runs": "[]", "default": "{}"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            default = simulate(scene, motion.t_end, start=start)
        except EquilibriumError:
            return found
        dt = min(SHARE_OF_TIME_SCALE * time_scale(scene, default.state(0).least_tension), motion.t_end / 100.0)
        found["runs"] = json.dumps(_some_steps(scene, start, motion.t_end, dt, row["most_steps"]))
        found["default"] = json.dumps(_default(motion, default, length))
    return found


def compare_case(row):
    """Runs of one hard case with some steps beside the reference."""
    from studies.catalogue.cases import CASES

    case = CASES[row["case"]]()
    scene, start = case.scene, case.start_state()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        first = simulate(scene, 1e-3 * case.t_end, start=start, method="edmc", dt=1e-3 * case.t_end).state(0)
        dt = case.dt or min(SHARE_OF_TIME_SCALE * time_scale(scene, first.least_tension), case.t_end / 100.0)
        work = min(case.t_end / dt, row["most_steps"]) * sum(cable.segments for cable in scene.cables)
        breaks = any(cable.breaking_tension is not None for cable in scene.cables)  # two runs of it break at two times
        runs = [] if breaks or work > MOST_NODE_STEPS else _some_steps(scene, start, case.t_end, dt, row["most_steps"])
    return {"kind": row["case"], "runs": json.dumps(runs)}


def _some_steps(scene, start, t_end, dt, most):
    """What the runs with `STEPS` times a step tell and what is true, a line for each; none where a reference fails.

    ``most`` is how many of the steps dt [s] they go at most.
    """
    length = scene.longest
    t_end = min(t_end, most * dt)
    longest = t_end / math.ceil(t_end / (max(STEPS) * dt))
    shortest = longest * min(STEPS) / max(STEPS)
    references = [_run(scene, t_end, start, shortest / finer, longest, extrapolate=True) for finer in FINER]
    if not all(one.ok for one in references):
        return []
    fine = references[-1]
    apart = [float(np.linalg.norm(b.q - a.q, axis=2).max()) for a, b in itertools.pairwise(references)]
    peaks = [_peak(_run(scene, t_end, start, step, step, rho_inf=UNDAMPED)) for step in (shortest / n for n in FINER)]
    lines = []
    for share in STEPS:
        step = longest * share / max(STEPS)
        run = _run(scene, t_end, start, step, step)
        rows = np.arange(0, len(run.t), round(max(STEPS) / share))
        if run.ok and len(rows) == len(fine.t):
            off = float(np.linalg.norm(run.q[rows] - fine.q, axis=2).max())
            lines.append(_line(run, off, known_to(*apart), peaks, length) | {"step_share": share})
    return lines


def known_to(first, second):
    """What the finest of three references is off by at most, of what each differs by from the next: the sum of a series.

    Where the differences hardly become smaller, or grow, nothing says that the references tend to one motion, however near to each
    other two of them are.
    """
    return second / (1.0 - min(second / max(first, 1e-300), SLOWEST))


def _run(scene, t_end, start, dt, save_every, **more):
    return simulate(scene, t_end, start=start, method="edmc", dt=dt, save_every=save_every, **more)


def _peak(run):
    """Largest tension of a run at any step [N]; NaN if it did not reach its end."""
    return run.peak_tension() if run.ok else math.nan


def _between(tension, other):
    """Difference of two tensions over the larger one, as runs tell it; 0 where none is taut, NaN where one is not known."""
    larger = float(np.maximum(tension, other))
    return 0.0 if larger == 0.0 else abs(tension - other) / larger


def _line(run, off, places_known_to, peaks, length):
    """What a run tells and what is true; ``peaks`` are the largest tensions of the references, from the coarsest on [N]."""
    true_tension = _between(run.peak_tension(), peaks[-1])
    tension_known_to = known_to(*(_between(a, b) for a, b in itertools.pairwise(peaks)))
    return {
        "step_s": run.dt, "told_m": run.error_estimate, "true_m": off, "known_to_m": places_known_to,
        "judged": places_known_to < RESOLVED * off and off > SMALL * length,
        "told_tension": run.tension_error, "true_tension": true_tension, "tension_known_to": tension_known_to,
        "judged_tension": tension_known_to < RESOLVED * true_tension and true_tension > SEEN,
    }  # fmt: skip


def _default(motion, run, length):
    """What the default run of a motion kept."""
    if not run.ok:
        return {"status": run.status, "steps": run.work.steps, "reason": run.message}
    every = run.t[1] - run.t[0]
    line = {
        "status": run.status, "steps": run.work.steps, "step_s": run.dt, "kept": run.kept, "reason": run.reason,
        "allowed_m": Wanted(None, TENSION_ERROR).of_places(run), "told_m": run.error_estimate, "told_tension": run.tension_error,
    }  # fmt: skip
    if run.work.steps * FINER[0] > 1e6:
        return line
    references = [_run(motion.scene, motion.t_end, motion.start, run.dt / n, every, extrapolate=True) for n in (2, 4, 8)]
    if not all(one.ok and len(one.t) == len(run.t) for one in references):
        return line
    first, second, off = (
        float(np.linalg.norm(one.q - other.q, axis=2).max())
        for one, other in (*itertools.pairwise(references), (run, references[-1]))
    )  # fmt: skip
    peaks = [one.peak_tension() for one in references]
    return line | _line(run, off, known_to(first, second), peaks, length)


def compute(quick=False, executor=None, out=None):
    """What the runs of random motions tell of their errors, and the truth."""
    from studies.catalogue.cases import CASES  # with all effects, whose kernels are compiled or read as they are imported

    most = {"most_steps": QUICK_MOST_STEPS if quick else MOST_STEPS}
    rows = [{"number": number} | most for number in (QUICK_MOTIONS if quick else range(MOTIONS))]
    found = run_rows(compare, rows, executor=executor, out=out and out / "motions")
    cases = [{"case": case} | most for case in (QUICK_CASES if quick else CASES)]
    hard = run_rows(compare_case, cases, executor=executor, out=out and out / "cases")
    hard = hard[hard["status"] == "done"]
    done = found[found["status"] == "done"]
    head = [{"number": one.number, "kind": one.kind} for one in done.itertuples()]
    runs = [known | line for known, one in zip(head, done.itertuples(), strict=True) for line in json.loads(one.runs)]
    defaults = [known | json.loads(one.default) for known, one in zip(head, done.itertuples(), strict=True)]
    lines = [{"kind": one.kind} | line for one in hard.itertuples() for line in json.loads(one.runs)]
    return {
        "runs": pd.DataFrame(runs),
        "cases": pd.DataFrame(lines),
        "defaults": pd.DataFrame(line for line in defaults if "status" in line),
    }


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "told": Drawing(
            _plot(rows["runs"]),
            "Left: the error of places that a run of edmc tells beside the true one, for random motions at four steps each; "
            f"between the lines the two are within a factor of {FACTOR:g}. Right: the same of the largest tension.",
        )
    }


def _plot(runs):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.5, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    seen = runs[runs.judged]
    _scatter(left, seen.true_m, seen.told_m, seen.kind, "true error of places [m]", "told error of places [m]")
    seen = runs[runs.judged_tension]
    _scatter(
        right, seen.true_tension, seen.told_tension, seen.kind, "true error of the largest tension [-]",
        "told error of the largest tension [-]",
    )  # fmt: skip
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=7, fontsize=8, frameon=False)
    return figure


def _scatter(panel, true, told, kinds, x, y):
    low, high = float(true.min()) / 2.0, float(true.max()) * 2.0
    for k, kind in enumerate(sorted(set(kinds))):
        of_kind = kinds == kind
        points = look(k) | {"linestyle": "", "label": kind, "ms": 3.5, "alpha": 0.7}
        panel.loglog(true[of_kind], told[of_kind].clip(lower=low / 30.0), **points)
    for factor, style in ((1.0, "-"), (FACTOR, ":"), (1.0 / FACTOR, ":")):
        panel.loglog([low, high], [factor * low, factor * high], color="0.4", lw=0.8, ls=style)
    panel.set(xlabel=x, ylabel=y, xlim=(low, high))


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    runs, cases, defaults = rows["runs"], rows["cases"], rows["defaults"]
    judged, tense = runs[runs.judged], runs[runs.judged_tension]
    first = f"Random motions, {_told(judged, tense)}\n\nThe catalogue of hard cases, {_told(*_judged(cases))}"
    done = defaults[defaults["status"] == "done"]
    kept = done[done.kept.astype(bool)]
    second = (
        f"With neither method nor step given, {len(kept)} of {len(done)} runs say that they keep {percent(ERROR_OF_LENGTH)} of the "
        f"longest cable, {percent(ERROR_OF_MOTION)} of the motion and {percent(TENSION_ERROR)} of the largest tension; the others "
        "say what they do not keep."
    )
    known = kept[kept.judged.fillna(False).astype(bool)]
    if len(known):
        over = known.true_m / known.allowed_m
        second += (
            f" Of {counted(len(known), 'run')} that say so and can be judged, {percent((over <= 1.0).mean())} keep it, "
            f"{percent((over <= 2.0).mean())} within a factor of two, and the worst is off by {over.max():.2g} times as much."
        )
    tense = kept[kept.tension_known_to < RESOLVED * TENSION_ERROR]
    if len(tense):
        over = tense.true_tension / TENSION_ERROR
        second += (
            f" Of {counted(len(tense), 'largest tension')} that references know to {percent(RESOLVED * TENSION_ERROR)}, "
            f"{percent((over <= 1.0).mean())} are kept, {percent((over <= 2.0).mean())} within a factor of two, and the worst is "
            f"off by {over.max():.2g} times as much."
        )
    everything = pd.concat([runs, cases])
    unknown = (everything.true_tension > SEEN) & ~everything.judged_tension
    third = (
        f"Left out: {counted(int((~everything.judged).sum()), 'run')} whose reference is not known to {percent(RESOLVED)} of the "
        f"error, such as those past a whip or a crumple, and {counted(int(unknown.sum()), 'run')} of which the same is true of the "
        "largest tension. Each reference has half the step of the one before it, and what the finest is off by is the sum of the "
        "series of which the two differences are the first terms: where they hardly become smaller, the references need not tend "
        "to one motion, and the case says nothing. "
        "The references of tensions are runs of edmc without its numerical damper (rho_inf = 1). With it, references of two steps "
        "may agree although both have lost a vibration that nothing damps."
    )
    return "\n\n".join([first, second, third])


def _judged(runs):
    """Runs whose error of places is judged, and those of which that of the largest tension is."""
    return runs[runs.judged], runs[runs.judged_tension]


def _told(judged, tense):
    """What runs tell beside the truth, in words."""
    far = (judged.told_m < judged.true_m / FAR).mean(), (tense.told_tension < tense.true_tension / FAR).mean()
    far = [percent(part) if part else "none" for part in far]
    return (
        f"{counted(len(judged), 'run')} of edmc at a given step: {percent(_within(judged.told_m / judged.true_m))} tell their "
        f"error of places within a factor of {FACTOR:g}, and {far[0]} tell less than a tenth of it. Of "
        f"{counted(len(tense), 'error')} of the largest tension beyond {percent(SEEN)} of it, "
        f"{percent(_within(tense.told_tension / tense.true_tension))} are told within that factor, and {far[1]} are ten "
        "times as large as told."
    )


def _within(ratio):
    return ((ratio < FACTOR) & (ratio > 1.0 / FACTOR)).mean()
