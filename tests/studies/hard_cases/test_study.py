"""The study `hard_cases` end to end with less work: every line has an outcome, the figure and the answer say the same."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pandas
import pytest
from matplotlib import pyplot

from studies.catalogue.outcome import DEFAULT, FAILED, HELD, REFUSED
from studies.questions import hard_cases


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    with ThreadPoolExecutor(1) as executor, pytest.MonkeyPatch.context() as patch:  # in this process: no workers to start
        patch.setattr(hard_cases, "BATCH", 15)  # random trials, of which `test_random_trials` tries more
        patch.setattr(hard_cases, "QUICK_TRIALS", 30)
        return hard_cases.compute(quick=True, executor=executor, out=tmp_path_factory.mktemp("hard_cases"))


@pytest.mark.slow
def test_every_pair_has_an_outcome(rows):
    runs = rows["runs"]
    assert len(runs) == len(hard_cases.QUICK_CASES) * len(hard_cases.QUICK_METHODS)
    assert {HELD, REFUSED} <= set(runs["outcome"]) <= {HELD, REFUSED, FAILED}
    assert (runs["status"] == "done").all() and not runs.loc[runs["outcome"] != HELD, "why"].eq("").any()
    table = rows["outcomes"].set_index("case")
    for run in runs.itertuples():
        assert table.loc[run.case, run.method] == run.outcome
    counts = rows["by_method"].set_index("method")
    assert (counts.sum(axis=1) == len(hard_cases.QUICK_CASES)).all()
    assert counts[FAILED].sum() == len(rows["failed"])


def test_a_failure_that_an_audit_finds_has_a_star():
    """Made up: the quick cases hold or are refused."""
    run = {"outcome": FAILED, "case": "one", "method": "midpoint", "cause": "", "audit": "audit failed"}
    statements = pandas.DataFrame([{"case": "one", "method": "midpoint", "kind": "load", "holds": False}])
    assert hard_cases.label(SimpleNamespace(**run), statements) == "load*"
    assert hard_cases.label(SimpleNamespace(**(run | {"audit": "done"})), statements) == "load"
    assert hard_cases.label(SimpleNamespace(**(run | {"outcome": REFUSED, "cause": "energy"})), statements) == "energy"


@pytest.mark.slow
def test_what_failed_has_a_statement_that_does_not_hold(rows):
    statements = rows["statements"]
    for run in rows["failed"].itertuples():
        own = statements[(statements["case"] == run.case) & (statements["method"] == run.method)]
        assert not own["holds"].all()
    held = rows["runs"][rows["runs"]["outcome"] == HELD][["case", "method"]]
    assert statements.merge(held)["holds"].all()


@pytest.mark.slow
def test_figure_and_answer(rows):
    (drawing,) = hard_cases.plot(rows).values()
    labels = [text.get_text() for text in drawing.figure.axes[0].texts]
    assert len(labels) == len(rows["runs"])
    for text, run in zip(labels, rows["runs"].itertuples(), strict=True):
        assert bool(text) == (run.outcome != HELD) and text != "refused"
    pyplot.close(drawing.figure)
    words = " ".join(hard_cases.answer(rows).split())
    assert "The default method holds all 4 hard cases. All 6 methods" in words
    assert "methods and steps none failed: not finite yet done" in words and "nan" not in words.lower()
    assert "There is no failure for an audit of the run" in words


@pytest.mark.slow
def test_the_answer_of_failures_names_them(rows):
    """Made up: the default fails in one case, verlet and midpoint in one each, of which an audit finds one; edmc gains energy."""
    runs, statements = rows["runs"].copy(), rows["statements"].copy()
    case = hard_cases.QUICK_CASES[0]
    broken = (runs["case"] == case) & runs["method"].isin([DEFAULT, "verlet", "midpoint"])
    runs.loc[broken, ["outcome", "why", "audit"]] = FAILED, "length is 2 m and must be at most 1 m", "done"
    runs.loc[broken & (runs["method"] == "midpoint"), "audit"] = "audit failed"
    rises = statements["what"] == "rise of energy over the energy in play"
    statements.loc[rises & (statements["method"] == "edmc"), "value"] = 0.01
    statements.loc[rises & (statements["method"] == "midpoint"), "value"] = 3.0
    failures = pandas.DataFrame([{"method": "edmc", "outcome": FAILED}, {"method": "midpoint", "outcome": "gained"}])
    made_up = rows | {
        "runs": runs, "statements": statements, "by_method": hard_cases.by_method(runs), "random_failures": failures,
        "failed": runs[runs["outcome"] == FAILED][["case", "method", "why", "audit"]],
    }  # fmt: skip
    words = " ".join(hard_cases.answer(made_up).split())
    assert "The default method holds 3 of 4 hard cases and fails in 1. 4 of 6 methods" in words
    assert "Wrong without a word are verlet in 1 and midpoint in 1." in words
    assert f"What the default method fails by. {case}: length is 2 m and must be at most 1 m." in words
    assert "finds 1 of 3 failures; it misses, by method: default 1 and verlet 1." in words
    assert "edmc 0.01 and backward_euler 0, which breaks their promise; of the others by more than a tenth midpoint 3." in words
    assert "methods and steps 1 failed" in words and words.count("midpoint 1.") == 1
