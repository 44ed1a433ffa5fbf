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
    with ThreadPoolExecutor(1) as executor:  # in this process: no workers to start
        return hard_cases.compute(quick=True, executor=executor, out=tmp_path_factory.mktemp("hard_cases"))


def test_every_pair_has_an_outcome(rows):
    runs = rows["runs"]
    assert len(runs) == len(hard_cases.QUICK_CASES) * len(hard_cases.QUICK_METHODS)
    assert {HELD, REFUSED} <= set(runs["outcome"]) <= {HELD, REFUSED, FAILED}
    assert (runs["status"] == "done").all() and not runs.loc[runs["outcome"] != HELD, "why"].eq("").any()
    table = rows["outcomes"].set_index("case")
    for run in runs.itertuples():
        assert table.loc[run.case, run.way] == run.outcome
    counts = rows["by_method"].set_index("way")
    assert (counts.sum(axis=1) == len(hard_cases.QUICK_CASES)).all()
    assert counts[FAILED].sum() == len(rows["failed"])


def test_a_failure_that_an_audit_finds_has_a_star():
    """Made up: the quick cases hold or are refused."""
    run = {"outcome": FAILED, "case": "one", "way": "midpoint", "why": "", "audit": "audit failed"}
    statements = pandas.DataFrame([{"case": "one", "way": "midpoint", "kind": "load", "holds": False}])
    assert hard_cases.label(SimpleNamespace(**run), statements) == "load*"
    assert hard_cases.label(SimpleNamespace(**(run | {"audit": "done"})), statements) == "load"
    gained = SimpleNamespace(**(run | {"outcome": REFUSED, "why": "midpoint reached t=1 s, but its energy rose by 1 of"}))
    assert hard_cases.label(gained, statements) == "energy"


def test_what_failed_has_a_statement_that_does_not_hold(rows):
    statements = rows["statements"]
    for run in rows["failed"].itertuples():
        own = statements[(statements["case"] == run.case) & (statements["way"] == run.way)]
        assert not own["holds"].all()
    held = rows["runs"][rows["runs"]["outcome"] == HELD][["case", "way"]]
    assert statements.merge(held)["holds"].all()


def test_figure_and_answer(rows):
    (figure,) = hard_cases.plot(rows).values()
    axes = figure.axes[0]
    labels = [text.get_text() for text in axes.texts]
    assert len(labels) == len(rows["runs"])
    for text, run in zip(labels, rows["runs"].itertuples(), strict=True):
        assert bool(text) == (run.outcome != HELD) and text != "refused"
    pyplot.close(figure)
    words = " ".join(hard_cases.answer(rows).split())
    default = rows["by_method"].set_index("way").loc[DEFAULT]
    assert f"Of 4 hard cases the default method holds {default[HELD]} and fails in {default[FAILED]}" in words
    assert "0 failed: not finite yet done" in words and "nan" not in words.lower()
