"""What becomes of input that cannot be: files changed at random, arguments of any type, sizes of any scale, strange commands?"""

import json

import pandas as pd

from anet_lumped.views.palette import look
from studies.catalogue.hostile_outcomes import ACCEPTED, BAD, LONGEST_LINE, LONGEST_TIME, OUTCOMES, REFUSED, SAID
from studies.shown.sentences import counted, listed
from studies.study import Drawing, Part, Record
from studies.sweeping.rows import run_rows

STUDY = Record(question=__doc__, part=Part.CURE, first_look="56 cases in place of 10,000.")
TABLES = {
    "counts": "A line for each kind of case and each way in which cases of it ended: how many.",
    "bad": "A line for each case that ended as none may, with what was said; none, it is hoped.",
}

CASES = {
    "scene file": 2000, "MoorDyn file": 2000, "saved run": 2500, "argument": 1500, "state": 500, "extreme sizes": 1000,
    "command": 500,
}  # fmt: skip
QUICK_CASES = 8  # of each kind
BATCH = 20  # cases that a worker tries at a time
SEED = 5


def attempt_batch(row):
    """What became of some cases."""
    from studies.catalogue.hostile_trials import try_many  # with the kernels of effects

    found = try_many(row["kind"], SEED, row["first"], row["cases"])
    return {"found": json.dumps(found)}


def compute(quick=False, executor=None, out=None):
    """What became of all cases."""
    rows = []
    for kind, all_cases in CASES.items():
        cases = QUICK_CASES if quick else all_cases
        rows += [{"kind": kind, "first": first, "cases": min(BATCH, cases - first)} for first in range(0, cases, BATCH)]
    found = run_rows(attempt_batch, rows, executor=executor, out=out and out / "batches")
    cases = []
    for batch in found.itertuples():
        if batch.status == "done":
            cases += json.loads(batch.found)
        else:
            lost = {"kind": batch.kind, "outcome": f"worker {batch.status}", "said": batch.reason}
            cases += [lost | {"number": batch.first + k} for k in range(batch.cases)]
    cases = pd.DataFrame(cases)
    counts = cases.groupby(["kind", "outcome"], sort=False).size().rename("cases").reset_index()
    return {"counts": counts, "bad": cases[~cases.outcome.isin([outcome for outcome in OUTCOMES if outcome not in BAD])]}


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "outcomes": Drawing(
            _plot(rows["counts"]),
            "How cases of each kind ended: as a result, as one line that refuses them, or as a search or a run that says why it "
            "ended.",
        )
    }


def _plot(counts):
    from matplotlib.figure import Figure

    table = counts.pivot(index="kind", columns="outcome", values="cases").fillna(0.0)
    table = table.reindex([kind for kind in CASES if kind in table.index])
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    panel, left = figure.subplots(), 0.0 * table.iloc[:, 0]
    for k, outcome in enumerate([*(one for one in OUTCOMES if one in table), *(one for one in table if one not in OUTCOMES)]):
        panel.barh(table.index, table[outcome], left=left, label=outcome, height=0.7, color=look(k)["color"])
        left = left + table[outcome]
    panel.invert_yaxis()
    panel.set_xlabel("cases [-]")
    figure.legend(loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    return figure


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    counts, bad = rows["counts"], rows["bad"]
    total = int(counts.cases.sum())
    by_outcome = counts.groupby("outcome").cases.sum()
    ends = [f"{int(by_outcome[outcome])} were {outcome}" for outcome in (ACCEPTED, REFUSED) if outcome in by_outcome]
    if SAID in by_outcome:
        ends.append(f"{int(by_outcome[SAID])} {SAID}, such as a rest that was not found")
    of_kind = counts.groupby("kind", sort=False).cases.sum()
    alike = f"There are {of_kind.iloc[0]} of each kind: {listed(of_kind.index)}."
    kinds = alike if of_kind.nunique() == 1 else f"By kinds: {listed(f'{kind} {cases}' for kind, cases in of_kind.items())}."
    if len(bad):
        ways = [f"{int(number)} {way}" for way, number in bad.outcome.value_counts().items()]
        first = f"Of {counted(total, 'case')}, {len(bad)} ended as none may: {listed(ways)}."
    else:
        first = (
            f"Of {counted(total, 'case')}, none ended in a traceback, took longer than {LONGEST_TIME:g} s, said a line of more "
            f"than {LONGEST_LINE} characters, or came to other numbers than were saved or to what is no number."
        )
    second = f"{listed(ends)}. {kinds}"
    second = second[0].upper() + second[1:]
    third = (
        "Left out: laws of one's own, which are code, and what only a hostile system does: full disks, processes that are killed, "
        "threads; these have tests of their own."
    )
    return "\n\n".join([first, second, third])
