"""Input that cannot be: some of each kind end as they may, and each way in which none may end is seen."""

import logging
import time
import warnings

import pandas as pd
import pytest
from drawn import Drawn
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import InputError
from studies.catalogue import hostile_trials
from studies.catalogue.hostile_outcomes import (
    ACCEPTED,
    BAD,
    HANG,
    LONG_LINE,
    NOT_A_NUMBER,
    OTHER_NUMBERS,
    REFUSED,
    SAID,
    TRACEBACK,
)
from studies.catalogue.hostile_trials import KINDS, Outcome, attempt, try_many
from studies.questions import hostile_input


@pytest.fixture(scope="module", autouse=True)
def compiled(tmp_path_factory):
    hostile_trials._compile(tmp_path_factory.mktemp("compiled"))


@pytest.mark.parametrize("kind", KINDS)
@tried(40, suppress_health_check=list(HealthCheck), database=None)
@given(st.data())
def test_no_case_ends_as_none_may(kind, tmp_path, data):
    outcome, said = attempt(kind, Drawn(data), tmp_path)
    assert outcome not in BAD, said


def test_cases_are_the_same_again():
    first, again = (try_many("scene file", 3, 4, 5) for _ in range(2))
    assert [(one["number"], one["outcome"]) for one in first] == [(one["number"], one["outcome"]) for one in again]


def raising(error):
    def case():
        raise error

    return case


@pytest.mark.parametrize(
    ("case", "outcome"),
    [
        (raising(KeyError("name")), TRACEBACK),
        (raising(MemoryError()), TRACEBACK),
        (raising(InputError("It must be so, but is not.")), REFUSED),
        (lambda: Outcome(SAID, "y" * 301), LONG_LINE),
        (lambda: Outcome(ACCEPTED, "one\x1b[31m"), LONG_LINE),
        (lambda: Outcome(ACCEPTED, "one\ntwo"), ACCEPTED),
        (lambda: time.sleep(0.5) or Outcome(ACCEPTED), HANG),
    ],
)
def test_what_must_not_be_is_seen(case, outcome, tmp_path, monkeypatch):
    monkeypatch.setattr(hostile_trials, "LONGEST_TIME", 0.2)
    monkeypatch.setitem(KINDS, "made up", lambda pick, folder: case)
    assert attempt("made up", None, tmp_path).outcome == outcome


def test_numbers_that_are_none_are_seen(monkeypatch):
    rest = hostile_trials.equilibrium(hostile_trials._hanging())
    rest.q[0] = float("nan")
    monkeypatch.setattr(hostile_trials, "equilibrium", lambda scene: rest)
    assert hostile_trials._used(rest.scene).outcome == NOT_A_NUMBER


def test_a_run_with_other_numbers_is_seen(monkeypatch, tmp_path):
    run = hostile_trials.simulate(hostile_trials._hanging(), 0.1, method="edmc", dt=0.01)
    run.q[1] += 1e-9
    monkeypatch.setattr(hostile_trials, "load_run", lambda file: run)
    assert attempt("saved run", FirstOfAll(), tmp_path).outcome == OTHER_NUMBERS


class FirstOfAll:
    """The first of all that may be drawn."""

    def integer(self, low, high):
        return low

    def one_of(self, choices):
        return choices[0]


def test_the_study_tries_all_kinds():
    assert list(hostile_input.CASES) == list(KINDS) and sum(hostile_input.CASES.values()) == 10_000


def test_the_study_counts_and_names_what_is_bad():
    rows = {
        "counts": pd.DataFrame(
            {"kind": ["state", "state", "command"], "outcome": [ACCEPTED, REFUSED, TRACEBACK], "cases": [30, 60, 10]}
        ),
        "bad": pd.DataFrame({"kind": 10 * ["command"], "outcome": 10 * [TRACEBACK]}),
    }
    text = hostile_input.answer(rows)
    assert "Of 100 cases, 10 ended as none may: 10 traceback." in text and "30 were accepted and 60 were refused" in text
    rows = {"counts": rows["counts"][:2], "bad": rows["bad"][:0]}
    assert "Of 90 cases, none ended in a traceback" in hostile_input.answer(rows)
    assert set(hostile_input.plot(rows)) == {"outcomes"}


def test_after_commands_this_process_tells_as_before():
    """A command has what is logged told on stderr; studies that this process runs later must not."""
    log = logging.getLogger("anet_lumped")
    before = log.handlers, log.level, warnings.showwarning
    try_many("command", 5, 0, 3)
    assert (log.handlers, log.level, warnings.showwarning) == before
