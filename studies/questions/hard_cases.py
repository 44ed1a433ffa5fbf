"""What happens in the cases that are hard, with every method?

Each case of `studies.catalogue` carries the physical statement that must hold: a closed form, a bound that energy or momentum
sets, the rest that statics knows. A (case, method) is held, refused by the library with a reason, or failed: the run ended as
done and the statement does not hold. The default method may not refuse anything.
"""

import json
import textwrap

import pandas as pd

from integrators import schemes
from integrators.schemes.record import Origin
from studies.catalogue import CASES
from studies.catalogue.case import ENERGY
from studies.catalogue.outcome import (
    DEFAULT,
    FAILED,
    HELD,
    NODE_EVALUATIONS,
    NODE_STEPS,
    NODES,
    REFUSED,
    STEPS,
    WORK,
    meet,
    node_tries,
    ways,
)
from studies.fuzz import try_many
from studies.sweeping.rows import run_rows

QUESTION = __doc__.splitlines()[0]

QUICK_CASES = ("swing, EA 1e+09 N", "span, near-taut by 1e-9", "yanked at 1 m/s", "cable in free flight")
QUICK_WAYS = (DEFAULT, "explicit_euler", "verlet", "edmc", "backward_euler", "midpoint", "RK45")
SEED, TRIALS, BATCH = 7, 600, 50  # random trials, and how many make a row; `python -m studies.fuzz` tries 2,000


def compute(quick=False, executor=None, out=None):
    """Tables of the study.

    Returns
    -------
    dict of pandas.DataFrame
        "outcomes" (a line a case, a column a method), "by_method" (counts), "failed" (which statement, by how much), "runs" (a
        line a case and method), "statements" (a line a statement: the number measured and its bounds), "random_trials" (counts
        by method), "random_failures".
    """
    cases, tried = (QUICK_CASES, QUICK_WAYS) if quick else (tuple(CASES), ways())
    rows = [{"case": case, "way": way} for case in cases for way in tried]
    runs = run_rows(one, rows, executor=executor, out=out and out / "runs")
    batches = [{"seed": SEED, "first": first, "trials": BATCH} for first in range(0, 2 * BATCH if quick else TRIALS, BATCH)]
    random = run_rows(batch, batches, executor=executor, out=out and out / "random")
    statements = pd.DataFrame(
        {"case": run.case, "way": run.way, **one} for run in runs.itertuples() for one in json.loads(run.statements or "[]")
    )
    runs = runs.drop(columns="statements")
    trials = pd.DataFrame(trial for found in random["found"] for trial in json.loads(found))
    return {
        "outcomes": runs.pivot(index="case", columns="way", values="outcome").loc[list(cases), list(tried)].reset_index(),
        "by_method": by_method(runs),
        "failed": runs[runs["outcome"] == FAILED][["case", "way", "why", "audit"]],
        "runs": runs,
        "statements": statements,
        "random_trials": trials.pivot_table(index="way", columns="outcome", aggfunc="size", fill_value=0).reset_index(),
        "random_failures": trials[trials["outcome"].isin(("failed", "gained"))],
    }


def one(row):
    """One case with one method: its outcome, why, what was measured, and what it took."""
    found = meet(CASES[row["case"]](), row["way"])
    statements = [
        {"kind": s.kind, "what": s.what, "value": s.value, "least": s.least, "most": s.most, "unit": s.unit, "holds": s.holds}
        for s in found.statements
    ]
    return {
        "outcome": found.outcome,
        "why": found.reason,
        "cause": found.cause,
        "method": found.method,
        "step_ms": 1e3 * found.dt,
        "steps": found.steps,
        "seconds": found.seconds,
        "audit": found.audit,
        "statements": json.dumps(statements),
    }


def batch(row):
    """A batch of random trials."""
    return {"found": json.dumps(try_many(row["seed"], row["first"], row["trials"]))}


def by_method(runs):
    """How many cases each method held, refused and failed."""
    counts = runs.pivot_table(index="way", columns="outcome", aggfunc="size", fill_value=0)
    order = [way for way in ways() if way in counts.index]
    return counts.reindex(index=order, columns=[HELD, REFUSED, FAILED], fill_value=0).reset_index()


# Figures and words --------------------------------------------------------------------------------------------------

COLORS = {HELD: "#d6e6f4", REFUSED: "#dddddd", FAILED: "#d55e00"}
WORKED = (STEPS, NODES, WORK)  # causes of what is refused for its work alone


def label(run, statements):
    """A word for a cell of the figure: how the library refused, or the kind of what is broken, with a star if an audit fails."""
    if run.outcome == REFUSED:
        return run.cause
    if run.outcome == FAILED:
        own = statements[(statements["case"] == run.case) & (statements["way"] == run.way) & ~statements["holds"].astype(bool)]
        kind = ENERGY if ENERGY in set(own["kind"]) else next(iter(own["kind"]), "failed")
        return kind + ("*" if run.audit not in ("", "done") else "")
    return ""


def plot(rows):
    """Figures of the study, {name: matplotlib Figure}."""
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    runs, statements = rows["runs"], rows["statements"]
    cases, tried = list(dict.fromkeys(runs["case"])), list(dict.fromkeys(runs["way"]))
    number = {outcome: i for i, outcome in enumerate(COLORS)}
    grid = runs.pivot(index="case", columns="way", values="outcome").loc[cases, tried].map(number.get).to_numpy(float)
    figure = Figure(figsize=(2.2 + 0.66 * len(tried), 1.6 + 0.235 * len(cases)), layout="constrained")
    axes = figure.subplots()
    axes.pcolormesh(grid, cmap=ListedColormap(list(COLORS.values())), vmin=0, vmax=2, edgecolor="w", linewidth=0.8)
    for run in runs.itertuples():
        words = label(run, statements)
        color = "w" if run.outcome == FAILED else "0.35"
        where = tried.index(run.way) + 0.5, cases.index(run.case) + 0.5
        axes.text(*where, words, ha="center", va="center", fontsize=6, color=color)
    axes.set_yticks([i + 0.5 for i in range(len(cases))], cases, fontsize=8)
    axes.set_xticks([i + 0.5 for i in range(len(tried))], [way.replace("_", " ") for way in tried], fontsize=8, rotation=45,
                    ha="left", rotation_mode="anchor")  # fmt: skip
    axes.xaxis.tick_top()
    axes.invert_yaxis()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    names = {HELD: "held", REFUSED: "refused, with the reason", FAILED: "failed: done, a statement is broken (* an audit fails)"}
    handles = [Patch(color=color, label=names[outcome]) for outcome, color in COLORS.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return {"outcomes": figure}


def answer(rows):
    """The answer in words, with the numbers of `rows`."""
    runs, statements = rows["runs"], rows["statements"]
    counts = rows["by_method"].set_index("way")
    cases = runs["case"].nunique()
    default = counts.loc[DEFAULT]
    broken = runs[(runs["way"] == DEFAULT) & (runs["outcome"] == FAILED)]
    names = f": {'; '.join(broken['case'])}" if len(broken) else ""
    lines = [f"{run.case}: {textwrap.shorten(run.why, 200, placeholder=' ...')}." for run in broken.itertuples()]
    details = "What the default method fails by. " + " ".join(lines) if lines else "The default method fails in none."
    own = statements[statements["what"] == "rise of energy over the energy in play"]
    rises = own[own["way"] != DEFAULT].groupby("way", sort=False)["value"].max()
    quiet = ", ".join(f"{way} {rises[way]:.1g}" for way in ("edmc", "backward_euler") if way in rises)
    loud = ", ".join(f"{way} {rise:.2g}" for way, rise in rises.items() if rise > 0.1)
    table = "; ".join(f"{way} {line[HELD]}, {line[REFUSED]}, {line[FAILED]}" for way, line in counts.drop(DEFAULT).iterrows())
    never = [way for way, line in counts.drop(DEFAULT).iterrows() if line[FAILED] == 0]
    dear = sum(run.cause in WORKED for run in runs[runs["outcome"] == REFUSED].itertuples())
    missed = rows["failed"][rows["failed"]["audit"] == "done"]
    seen = len(rows["failed"]) - len(missed)
    unseen = ", ".join(f"{way} {n}" for way, n in missed["way"].value_counts(sort=False).items()) or "none"
    trials = rows["random_trials"].set_index("way")
    total = int(trials.to_numpy().sum())
    failed = rows["random_failures"]
    wrong = failed[failed["outcome"] == "failed"]
    gained = failed[failed["outcome"] == "gained"]
    tries = [node_tries(schemes.scheme(name)) for name in schemes.names(origin=Origin.DIFFRAX)]
    gainers = ", ".join(f"{way} {n}" for way, n in gained["way"].value_counts().items()) or "none"
    return f"""
Of {cases} hard cases the default method holds {default[HELD]} and fails in {default[FAILED]}{names}. Of the methods that are
asked for by name, {", ".join(never) or "none"} are never silently wrong: each statement of physics holds, or the library says
why the method does not serve.

{details}

Held, refused and failed by the methods that were asked for by name: {table}. A refusal is
a status with advice (a run that gained energy has one too), a warning before the run, a warning of the completed run where that
is what is broken (energy lost in its steps, a cable longer than its tension can hold it), or, {dear} times, more work
than is spent here: {NODE_STEPS:.0e} nodes times steps (explicit methods), {NODE_EVALUATIONS[True]:.0e} nodes times force
evaluations (scipy's explicit solvers) or {NODE_EVALUATIONS[False]:.0e} (its
stiff ones), {min(tries):.0e} to {max(tries):.0e} nodes times steps (diffrax's).

An audit of the run (`audit=True`) finds {seen} of the {len(rows["failed"])} failures and ends as "audit failed" (a star in the
figure); it misses, by method: {unseen}.

Energy without input, largest rise over the energy in play of runs that ended as done: {quiet or "not measured"}, which is
Newton's tolerance and rounding; {loud or "none"} of the others by more than a tenth.

Random trials: {total} random nets, stiffnesses, dampers, starts, driven points, methods and steps. {len(wrong)} failed: not
finite yet done, an error that is not the library's own, or energy out of nothing with a method that promises none. Of methods
that make no such promise, runs that ended as done and had gained more than a tenth of the energy in play: {gainers}.

Explicit methods run at half of their predicted limit, verlet and symplectic Euler at an eighth where a cable may go slack
undamped. Backward Euler is not asked for accuracy nor spin, which its own note
denies. Left out: how accurate a method is at equal cost, which is the study `speed`'s.
"""


if __name__ == "__main__":
    from studies.command_line import main

    main(["study", "hard_cases"])
