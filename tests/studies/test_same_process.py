"""Rows in the process that asks for them."""

import os

import pytest

from studies.sweeping.rows import run_rows
from studies.sweeping.same_process import SameProcess


def row(one):
    if one["n"] == 1:
        raise ValueError("no")
    return {"process": os.getpid()}


def test_rows_run_here_and_one_that_raises_is_a_failed_one(tmp_path):
    table = run_rows(row, [{"n": n} for n in range(3)], executor=SameProcess(), out=tmp_path)
    assert table["status"].tolist() == ["done", "failed", "done"] and table["reason"][1] == "ValueError: no"
    assert table["process"][[0, 2]].tolist() == [os.getpid()] * 2


def interrupted(one):
    raise KeyboardInterrupt


def test_an_interrupt_is_not_kept_as_a_result():
    with pytest.raises(KeyboardInterrupt):
        run_rows(interrupted, [{"n": 0}], executor=SameProcess())
