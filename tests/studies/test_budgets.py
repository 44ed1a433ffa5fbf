"""Time budgets of rows: which are over theirs, which are done again, and which of several lines of a row counts."""

import logging
import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from test_parts import ROWS, do_shard, is_table, square

from anet_lumped.checks import InputError
from anet_lumped.files.scene_file import load_scene
from anet_lumped.motion.simulate import simulate
from anet_lumped.results.run import RunInterrupt
from integrators.deadline import time_left
from studies.sweeping import parts
from studies.sweeping.batch import BatchRunner
from studies.sweeping.parts import NUMBER, PartTask, Shard
from studies.sweeping.rows import gather, read_rows, run_rows


def long_run(row):
    return {"end": simulate(load_scene("net_carried"), 4e3, method="edmc", dt=1e-4, save_every=1e3).t[-1]}  # of minutes


@pytest.mark.parametrize("in_main_thread", [True, False])
def test_a_run_that_takes_longer_than_its_budget_says_so(in_main_thread):
    began = time.monotonic()
    if in_main_thread:
        table = run_rows(long_run, [{"x": 0}], workers=1, budget=0.5)
    else:
        with ThreadPoolExecutor(1) as executor:
            table = run_rows(long_run, [{"x": 0}], executor=executor, budget=0.5)
    assert table["status"].tolist() == ["over budget"], table["reason"][0]
    assert table["reason"][0].startswith("It took longer than its budget of 0.5 s: the run had reached t=")
    assert time.monotonic() - began < 100  # of minutes: where everything compiles first, too


def first_of_a_process(row):
    """Imports take 0.6 s the first time, then a march takes no time."""
    if not SLEPT:
        SLEPT.append(row["x"])
        time.sleep(0.6)
    run = simulate(load_scene("net_carried"), 0.01, method="edmc", dt=1e-3)
    return {"end": run.t[-1]}


SLEPT = []


def test_the_first_row_of_a_process_is_not_over_its_budget_by_its_imports():
    table = run_rows(first_of_a_process, [{"x": 0}, {"x": 1}], workers=1, budget=0.5)
    assert table["status"].tolist() == ["done", "done"], table["reason"].tolist()


def test_a_budget_is_a_time():
    with pytest.raises(InputError, match="Argument `budget` must be positive and finite"):
        run_rows(square, ROWS, budget=0.0)


def needs_a_minute(row, folder):
    """Odd rows are over any budget of less than a minute, of which they use all."""
    (Path(folder) / f"call-{row['x']}").touch()
    left = time_left()
    if row["x"] % 2 and left < 60.0:
        time.sleep(left)
        raise RunInterrupt(SimpleNamespace(message="stopped", t=[left]))
    return {"square": row["x"] ** 2}


def with_budget(how, folder, budget):
    """Table of four rows, and which of them were done now."""
    for path in folder.glob("call-*"):
        path.unlink()
    function, shared = (
        partial(needs_a_minute, folder=folder),
        {"budget": budget, "out": folder / "out", "identity": {"vary": {"x": [], "word": []}}},
    )
    with ThreadPoolExecutor(1) as executor:
        given = {
            "one process": {"executor": executor, "resume": True},
            "a shard": {"workers": 1, "shard": Shard()},
            "an executor": {"executor": executor, "workers": 1, "shard": Shard()},
        }[how]
        table = run_rows(function, ROWS[:4], **given, **shared)
    assert "row_budget" not in table
    shown = read_rows(folder / "out")[0].sort_values("x", ignore_index=True)
    assert is_table(shown, table) and (how == "one process" or is_table(gather(folder / "out")[0], table))
    return table, sorted(int(path.name.removeprefix("call-")) for path in folder.glob("call-*"))


@pytest.mark.parametrize("how", ["one process", "a shard", "an executor"])
def test_rows_over_a_budget_are_done_again_with_a_larger_one_alone(tmp_path, how, caplog):
    caplog.set_level(logging.INFO, "studies")
    for budget, now, told in [
        (0.04, [0, 1, 2, 3], None),
        (0.04, [], None),
        (0.02, [], None),
        (None, [], None),
        (0.06, [1, 3], 0.06),
    ]:
        caplog.clear()
        table, done = with_budget(how, tmp_path, budget)
        assert done == now
        assert table["status"].tolist() == ["done", "over budget"] * 2
        assert all(f"budget of {told or 0.04} s" in reason for reason in table["reason"][1::2])
        assert ("rows that were over a smaller budget and are done again: 2" in caplog.messages) == (told is not None)
    table, done = with_budget(how, tmp_path, 1000.0)
    assert done == [1, 3] and table["square"].tolist() == [0, 1, 4, 9] and set(table["status"]) == {"done"}
    assert with_budget(how, tmp_path, 0.02)[1] == []


def dies_with_much_time(row):
    """An odd row is over a budget of less than a minute; with more its process dies, and so it does where it has none."""
    left = time_left()
    if row["x"] % 2 and (left is None or left > 60.0):
        os.kill(os.getpid(), signal.SIGKILL)
    if row["x"] % 2:
        time.sleep(left)
        raise RunInterrupt(SimpleNamespace(message="stopped", t=[left]))
    return {"square": row["x"] ** 2}


@pytest.mark.parametrize("shard", [None, Shard()])
@pytest.mark.parametrize(
    ("budgets", "statuses"),
    [((0.04, 100.0), ("over budget", "crashed")), ((None, 0.04), ("crashed", "over budget"))],
)
def test_a_row_that_was_over_a_budget_and_one_that_crashed_are_the_same_in_the_table_and_on_the_disk(
    tmp_path, shard, budgets, statuses
):
    """They were crashed in the table and over budget where the folder was read."""
    for budget, status in zip(budgets, statuses, strict=True):
        given = {"budget": budget, "out": tmp_path, "shard": shard, "resume": True, "identity": {"vary": {"x": [], "word": []}}}
        table = run_rows(dies_with_much_time, ROWS[:2], workers=1, **given)
        assert table["status"].tolist() == ["done", status]
        assert is_table(read_rows(tmp_path)[0].sort_values("x", ignore_index=True), table)
        assert shard is None or is_table(gather(tmp_path)[0], table)


@pytest.mark.parametrize("first", [0, 1])
def test_of_two_lines_of_a_row_that_with_the_larger_budget_counts_wherever_it_is(tmp_path, first):
    """As two shells of different counts and budgets leave them."""
    do_shard(tmp_path, 1, 30)
    lines = [
        {NUMBER: 1, **ROWS[1], "status": "crashed", "reason": ""},
        {NUMBER: 1, **ROWS[1], "status": "over budget", "reason": "1 s", "row_budget": 1.0},
        {NUMBER: 1, **ROWS[1], "status": "over budget", "reason": "2 s", "row_budget": 2.0},
    ]
    for k, line in enumerate(lines[first:] + lines[:first]):
        parts.write_part(tmp_path / "parts" / f"1-of-{2 + k // 2}" / f"{k}.jsonl", [line], 1.0)
    table, missing, _ = gather(tmp_path)
    assert table["reason"].tolist() == ["", "2 s"] and missing == list(range(2, 30)) and "row_budget" not in table


def test_a_task_whose_part_is_of_a_smaller_budget_does_it_again(tmp_path):
    line = {NUMBER: 0, **ROWS[0], "status": "over budget", "reason": "", "row_budget": 1.0}
    do_shard(tmp_path, 2, 2)
    parts.write_part(parts.part_file(tmp_path, Shard(), 0), [line], 1.0)
    for budget, status in [(1.0, "over budget"), (2.0, "done")]:
        task = PartTask(BatchRunner(square, budget), tmp_path, Shard(), parts.library())
        assert task([{NUMBER: 0, **ROWS[0]}])[0][0].get("status", "done") == status


def pressed(row):
    raise RunInterrupt(SimpleNamespace(message="stopped"))


def test_ctrl_c_within_a_budget_is_no_budget_that_is_over():
    with pytest.raises(RunInterrupt):
        BatchRunner(pressed, 60.0)([{}])
