"""What happens in the cases that are hard, with every method?

Each case of `studies.catalogue` carries the physical statements that must hold: a closed form, a bound that energy or momentum
sets, the rest that statics knows. A (case, method) is held, refused by the library with a reason, or failed: the run ended as
done and a statement does not hold. The default method may not refuse anything.
"""

import json
import textwrap

import pandas as pd

from integrators import schemes
from integrators.schemes.record import Origin
from studies.catalogue.case import BOUNDED_RISE, ENERGY, NO_RISE, promises_no_energy_gain
from studies.catalogue.outcome import (
    DEFAULT,
    FAILED,
    GAINED,
    HELD,
    NODE_EVALUATIONS,
    NODE_STEPS,
    NODES,
    REFUSED,
    STEPS,
    WORK,
    extrapolations,
    methods_tried,
    node_tries,
    try_case,
)  # fmt: skip
from studies.shown.sentences import counted, listed, power, share
from studies.study import Drawing, Part, Record
from studies.sweeping.rows import run_rows

QUICK_CASES = ("swing, EA 1e+09 N", "span, near-taut by 1e-9", "yanked at 1 m/s", "cable in free flight")
QUICK_METHODS = (DEFAULT, "explicit_euler", "verlet", "edmc", "backward_euler", "midpoint", "RK45")
SEED, TRIALS, QUICK_TRIALS, BATCH = 7, 600, 50, 25  # random trials, and how many make a row

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.CURE,
    first_look=f"{len(QUICK_CASES)} cases and {len(QUICK_METHODS)} methods in place of all, and {QUICK_TRIALS} random trials in "
    f"place of {TRIALS}, without air, water, ground and bending.",
)
TABLES = {
    "outcomes": "A line for each case and a column for each method: held, refused or failed.",
    "by_method": "A line for each method: how many cases it held, refused and failed.",
    "failed": "A line for each case and method that failed: which statement is broken and by how much, and what an audit says.",
    "runs": "A line for each case and method: outcome, reason, and what the run took.",
    "statements": "A line for each statement: the number that was measured and its bounds.",
    "random_trials": "A line for each method: how many random trials had each outcome.",
    "random_failures": "A line for each random trial that failed or gained energy.",
}


def compute(quick=False, executor=None, out=None):
    """The tables."""
    from studies.catalogue.cases import CASES  # with all effects, whose kernels are compiled or read as they are imported

    cases, methods = (QUICK_CASES, QUICK_METHODS) if quick else (tuple(CASES), methods_tried())
    rows = [{"case": case, "method": method} for case in cases for method in methods]
    runs = run_rows(one, rows, executor=executor, out=out and out / "runs")
    trials = QUICK_TRIALS if quick else TRIALS
    batches = [
        {"seed": SEED, "first": first, "trials": BATCH, "surroundings": not quick} for first in range(0, trials, BATCH)
    ]  # fmt: skip
    random = run_rows(batch, batches, executor=executor, out=out and out / "random")
    statements = pd.DataFrame(
        {"case": run.case, "method": run.method, **one} for run in runs.itertuples() for one in json.loads(run.statements or "[]")
    )
    runs = runs.drop(columns="statements")
    found = pd.DataFrame(trial for row in random["found"] for trial in json.loads(row))
    return {
        "outcomes": runs.pivot(index="case", columns="method", values="outcome").loc[list(cases), list(methods)].reset_index(),
        "by_method": by_method(runs),
        "failed": runs[runs["outcome"] == FAILED][["case", "method", "why", "audit"]],
        "runs": runs,
        "statements": statements,
        "random_trials": found.pivot_table(index="method", columns="outcome", aggfunc="size", fill_value=0).reset_index(),
        "random_failures": found[found["outcome"].isin((FAILED, GAINED))],
    }


def one(row):
    """One case with one method: its outcome, why, what was measured, and what it took."""
    from studies.catalogue.cases import CASES

    found = try_case(CASES[row["case"]](), row["method"])
    statements = [
        {"kind": s.kind, "what": s.what, "value": s.value, "least": s.least, "most": s.most, "unit": s.unit, "holds": s.holds}
        for s in found.statements
    ]
    return {
        "outcome": found.outcome,
        "why": found.reason,
        "cause": found.cause,
        "method_taken": found.method,
        "step_ms": 1e3 * found.dt,
        "steps": found.steps,
        "seconds": found.seconds,
        "audit": found.audit,
        "statements": json.dumps(statements),
    }


def batch(row):
    """A batch of random trials."""
    from studies.catalogue.random_trials import try_many

    return {"found": json.dumps(try_many(row["seed"], row["first"], row["trials"], row["surroundings"]))}


def by_method(runs):
    """How many cases each method held, refused and failed."""
    counts = runs.pivot_table(index="method", columns="outcome", aggfunc="size", fill_value=0)
    order = [method for method in methods_tried() if method in counts.index]
    return counts.reindex(index=order, columns=[HELD, REFUSED, FAILED], fill_value=0).reset_index()


# Figures and words --------------------------------------------------------------------------------------------------

COLORS = {HELD: "#d6e6f4", REFUSED: "#bbbbbb", FAILED: "#d55e00"}
FOR_WORK = (STEPS, NODES, WORK)  # causes of refusals for the work alone


def label(run, statements):
    """A word for a cell of the figure: why the library refused, or the kind of statement that is broken, with a star if an audit
    of the run fails."""
    if run.outcome == REFUSED:
        return run.cause
    if run.outcome == FAILED:
        own = statements[
            (statements["case"] == run.case) & (statements["method"] == run.method) & ~statements["holds"].astype(bool)
        ]
        kind = ENERGY if ENERGY in set(own["kind"]) else next(iter(own["kind"]), "failed")
        return kind + ("*" if run.audit not in ("", "done") else "")
    return ""


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "outcomes": Drawing(
            _plot_outcomes(rows["runs"], rows["statements"]),
            "What becomes of each case with each method. A word says why the library refuses, or which kind of statement is "
            "broken; a star marks a failure that an audit of the run finds.",
        )
    }


def _plot_outcomes(runs, statements):
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    cases, methods = list(dict.fromkeys(runs["case"])), list(dict.fromkeys(runs["method"]))
    number = {outcome: i for i, outcome in enumerate(COLORS)}
    grid = runs.pivot(index="case", columns="method", values="outcome").loc[cases, methods].map(number.get).to_numpy(float)
    figure = Figure(figsize=(2.2 + 0.66 * len(methods), 1.6 + 0.235 * len(cases)), layout="constrained")
    axes = figure.subplots()
    axes.pcolormesh(grid, cmap=ListedColormap(list(COLORS.values())), vmin=0, vmax=2, edgecolor="w", linewidth=0.8)
    for run in runs.itertuples():
        words = label(run, statements)
        color = "w" if run.outcome == FAILED else "0.35"
        where = methods.index(run.method) + 0.5, cases.index(run.case) + 0.5
        axes.text(*where, words, ha="center", va="center", fontsize=6, color=color)
    axes.set_yticks([i + 0.5 for i in range(len(cases))], cases, fontsize=8)
    names = [method.replace("_", " ") for method in methods]
    axes.set_xticks([i + 0.5 for i in range(len(methods))], names, fontsize=8, rotation=45, ha="left", rotation_mode="anchor")
    axes.xaxis.tick_top()
    axes.invert_yaxis()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    names = {HELD: "held", REFUSED: "refused, with the reason", FAILED: "failed: done, yet a statement is broken"}
    handles = [Patch(color=color, label=names[outcome]) for outcome, color in COLORS.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return figure


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    parts = _default(rows), _counts(rows), _audits(rows["failed"]), _energy(rows["statements"]), _random(rows)
    return "\n\n".join([_finding(rows), *parts, LEFT_OUT])


def _finding(rows):
    counts, cases = rows["by_method"].set_index("method"), rows["runs"]["case"].nunique()
    default = counts.loc[DEFAULT]
    others = counts.drop(DEFAULT)
    silent = others[others[FAILED] > 0]
    words = f"The default method holds {share(default[HELD], cases)} hard cases"
    words += f" and fails in {default[FAILED]}." if default[FAILED] else "."
    if not len(others):
        return words
    clean = f"{share(len(others) - len(silent), len(others))} methods that are asked for by name are never silently wrong"
    words += f" {clean[0].upper()}{clean[1:]}: each statement of physics holds, or the library says why the method does not serve."
    if len(silent):
        words += f" Wrong without a word are {listed(f'{method} in {line[FAILED]}' for method, line in silent.iterrows())}."
    return words


def _default(rows):
    broken = rows["runs"][(rows["runs"]["method"] == DEFAULT) & (rows["runs"]["outcome"] == FAILED)]
    lines = [f"{run.case}: {textwrap.shorten(run.why, 200, placeholder=' ...')}." for run in broken.itertuples()]
    return "What the default method fails by. " + " ".join(lines) if lines else "The default method fails in no case."


def _counts(rows):
    counts, runs = rows["by_method"].set_index("method").drop(DEFAULT), rows["runs"]
    table = "; ".join(f"{method} {line[HELD]}, {line[REFUSED]}, {line[FAILED]}" for method, line in counts.iterrows())
    refused = runs[runs["outcome"] == REFUSED]
    dear, tries = (
        refused["cause"].isin(FOR_WORK).sum(),
        [node_tries(schemes.scheme(name)) for name in schemes.names(origin=Origin.DIFFRAX)],
    )
    return (
        f"Cases held, refused and failed by the methods that were asked for by name: {table}. A method is refused by a status with "
        "advice (a run that gained energy has one too), by a warning before the run, or by a warning of the run itself where that "
        f"names what is broken (energy lost in its steps, a cable longer than its tension stretches it). {dear} of "
        f"{counted(len(refused), 'refusal')} are for more work than is spent here: {power(NODE_STEPS)} nodes times steps (explicit "
        f"methods), {power(NODE_EVALUATIONS[True])} nodes times force evaluations (scipy's explicit solvers), "
        f"{power(NODE_EVALUATIONS[False])} (its stiff ones), {power(min(tries))} to {power(max(tries))} nodes "
        "times steps (diffrax's)."
    )


def _audits(failed):
    if not len(failed):
        return "There is no failure for an audit of the run (audit=True) to find."
    missed = failed[failed["audit"] == "done"]
    unseen = listed(f"{method} {number}" for method, number in missed["method"].value_counts(sort=False).items())
    words = f"An audit of the run (audit=True) finds {share(len(failed) - len(missed), len(failed))} failures"
    return words + (f"; it misses, by method: {unseen}." if len(missed) else ".")


def _energy(statements):
    own = statements[statements["what"] == "rise of energy over the energy in play"]
    rises = own[own["method"] != DEFAULT].groupby("method", sort=False)["value"].max()
    named = [method for method in rises.index if method not in extrapolations() and promises_no_energy_gain(method)]
    promised = rises[named]
    others = rises.drop(promised.index)
    loud = others[others > BOUNDED_RISE]
    words = "Largest rise of energy over the energy in play, without input, of runs that ended as done"
    if len(promised):
        words += f": {listed(f'{method} {power(max(rise, 0.0), 1)}' for method, rise in promised.items())}"
        words += ", which is Newton's tolerance and round-off" if promised.max() <= NO_RISE else ", which breaks their promise"
    over = listed(f"{method} {power(rise, 2)}" for method, rise in loud.items())
    return words + f"; of the others {f'by more than a tenth {over}' if len(loud) else 'none by more than a tenth'}."


def _random(rows):
    trials, failures = rows["random_trials"].set_index("method"), rows["random_failures"]
    total = int(trials.to_numpy().sum())
    wrong, gained = failures[failures["outcome"] == FAILED], failures[failures["outcome"] == GAINED]
    gainers = listed(f"{method} {number}" for method, number in gained["method"].value_counts().items())
    return (
        f"Of {total} random nets, stiffnesses, dampers, starts, driven points, methods and steps {len(wrong) or 'none'} failed: "
        "not finite yet done, an error that is not the library's own, or energy out of nothing with a method that promises none. "
        "Of methods that promise nothing, runs that ended as done and had gained more than a tenth of the energy in play: "
        f"{gainers if len(gained) else 'none'}."
    )


LEFT_OUT = (
    "Explicit methods run at half of their predicted limit, verlet and symplectic Euler at an eighth where a cable may go slack "
    "undamped. Backward Euler is judged neither by accuracy nor by angular momentum, which its own note denies. Left out: how "
    "accurate a method is at equal cost, which the study work_precision measures."
)
