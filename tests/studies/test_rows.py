"""The engine under every study: rows in parallel, kept on disk as they come, whatever dies."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas
import pytest

from studies.sweeping.rows import RowsError, RowsInterrupt, run_rows
from studies.sweeping.same_process import SameProcess
from studies.sweeping.workers import WorkerError


def square(row):
    return {"square": np.float64(row["x"] ** 2), "half": row["x"] // 2}


def odd(row):
    """A result, an exception, a bad status, a dead worker: one of each."""
    match row["x"]:
        case 1:
            raise ValueError("x must not be 1")
        case 2:
            return {"status": "diverged", "reason": "at t=0.1 s", "square": float("inf")}
        case 3:
            os.kill(os.getpid(), signal.SIGKILL)
    return square(row)


def slow(row):
    time.sleep(row["seconds"])
    return {"pid": os.getpid()}


def rows_of(n):
    return [{"x": x} for x in range(n)]


def test_rows_come_back_in_order_with_inputs_results_and_status():
    table = run_rows(square, rows_of(7), workers=2)
    assert list(table) == ["x", "square", "half", "status", "reason"]
    assert table["square"].tolist() == [x**2 for x in range(7)]
    assert set(table["status"]) == {"done"} and set(table["reason"]) == {""}


@pytest.mark.slow
def test_sweeps_in_threads_leave_each_other_alone():
    """One that ends ends its own workers; the script that workers must not import is swapped by one thread at a time."""
    script = sys.modules["__main__"]
    long, short = [{"seconds": 0.4 + 0.01 * x} for x in range(5)], [[{"seconds": 0.01 * x}] for x in range(6)]
    with ThreadPoolExecutor(3) as threads:
        other = threads.submit(run_rows, slow, long, workers=1)
        tables = list(threads.map(lambda rows: run_rows(slow, rows, workers=1), short))
    assert [table["status"].tolist() for table in tables] == [["done"]] * 6
    assert other.result()["status"].tolist() == ["done"] * 5 and other.result()["pid"].nunique() == 1
    assert sys.modules["__main__"] is script


def test_a_failure_is_a_row_and_a_dead_worker_loses_no_other_row(tmp_path):
    table = run_rows(odd, rows_of(8), workers=2, out=tmp_path)
    assert table["status"].tolist() == ["done", "failed", "diverged", "crashed", *["done"] * 4]
    assert table["reason"][1] == "ValueError: x must not be 1"
    assert table["reason"][3].startswith("the worker process died")
    assert table["square"][7] == 49
    kept = pandas.read_parquet(tmp_path / "rows.parquet")
    pandas.testing.assert_frame_equal(kept, table)
    assert len(pandas.read_csv(tmp_path / "rows.csv")) == 8


@pytest.mark.parametrize("pool", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_any_executor_will_do(pool):
    with pool(2) as executor:
        table = run_rows(square, rows_of(5), executor=executor)
    assert table["square"].tolist() == [0, 1, 4, 9, 16]


def test_an_executor_that_breaks_is_an_error_that_says_what_is_done_and_holds_it(tmp_path):
    """Rows that it was never given are no crashed ones."""
    told = "The executor broke while rows were to do: .*; 3 of 6 rows are done, which are in "
    for out, where in ((None, "the `found` of this error"), (tmp_path, "rows.jsonl")):
        with ProcessPoolExecutor(1) as executor, pytest.raises(WorkerError, match=f"{told}.*{where}") as raised:
            run_rows(odd, rows_of(6), executor=executor, out=out)
        assert raised.value.found["status"].tolist() == ["done", "failed", "diverged"]
    again = run_rows(square, rows_of(6), out=tmp_path, resume=True, workers=1)
    assert again["status"].tolist() == ["done", "failed", "diverged", "done", "done", "done"]


def stopped_at_3(row):
    if row["x"] == 3:
        raise KeyboardInterrupt
    return square(row)


def test_ctrl_c_without_a_folder_holds_what_is_done():
    with pytest.raises(RowsInterrupt, match="Stopped after 3 of 6 rows") as raised:
        run_rows(stopped_at_3, rows_of(6), executor=SameProcess())
    assert raised.value.found["square"].tolist() == [0, 1, 4]


def test_resume_does_the_rest_and_forgets_a_torn_line(tmp_path):
    first = run_rows(slow, [{"seconds": s} for s in (0.0, 0.001)], workers=1, out=tmp_path)
    log = tmp_path / "rows.jsonl"
    log.write_bytes(log.read_bytes() + b'{"seconds": 0.002, "pi')
    again = run_rows(slow, [{"seconds": s} for s in (0.002, 0.001, 0.0)], workers=1, out=tmp_path, resume=True)
    assert again["pid"].tolist()[:0:-1] == first["pid"].tolist()
    assert again["pid"][0] not in first["pid"].tolist()
    assert [json.loads(line)["seconds"] for line in log.read_text().splitlines()] == [0.0, 0.001, 0.002]


def test_rows_of_something_else_are_not_mixed(tmp_path):
    run_rows(square, rows_of(3), workers=1, out=tmp_path, identity={"scene": "net"})
    with pytest.raises(RowsError, match=r"rows\.jsonl holds 3 rows already: resume them"):
        run_rows(square, rows_of(3), out=tmp_path, identity={"scene": "net"})
    with pytest.raises(RowsError, match="is of another sweep: scene"):
        run_rows(square, rows_of(3), out=tmp_path, identity={"scene": "cable"}, resume=True)
    with pytest.raises(RowsError, match=r"holds 1 rows that are not asked for now, the first with {'x': 2}"):
        run_rows(square, rows_of(2), out=tmp_path, identity={"scene": "net"}, resume=True)


def test_what_cannot_run_is_said_before_any_row():
    with pytest.raises(RowsError, match="2 of 4 are repeated"):
        run_rows(square, [*rows_of(2), *rows_of(2)])
    with pytest.raises(TypeError, match="must be picklable"):
        run_rows(lambda row: row, rows_of(2))


def test_a_column_of_numbers_and_words_reaches_the_disk(tmp_path):
    table = run_rows(type_name, [{"x": 1}, {"x": "auto"}, {"x": None}], workers=1, out=tmp_path)
    assert table["type"].tolist() == ["int", "str", "NoneType"]
    assert pandas.read_parquet(tmp_path / "rows.parquet")["x"].tolist()[:2] == ["1", "auto"]


def type_name(row):
    return {"type": type(row["x"]).__name__}


SCRIPT = """
import sys
from tests.studies.test_rows import run_rows, slow
if __name__ == "__main__":
    run_rows(slow, [{"seconds": 0.2 + x / 1e3} for x in range(40)], workers=2, out=sys.argv[1])
"""


def start_and_wait_for_rows(out, *command):
    """Start a process that writes rows to `out`; return it once two of them are on disk."""
    here = Path(__file__).parents[2]
    process = subprocess.Popen([sys.executable, *command], cwd=here, stderr=subprocess.PIPE, text=True, start_new_session=True)
    log = out / "rows.jsonl"
    for _ in range(3000):  # 150 s: on a clean checkout the workers compile first
        if log.exists() and log.read_bytes().count(b"\n") >= 2:
            return process
        time.sleep(0.05)
    raise AssertionError(f"no rows in 150 s: {process.communicate()}")


def wait_for_end_of(session):
    """Wait until no process of the session lives, and say whether that came about in 30 s."""
    for _ in range(300):
        alive = subprocess.run(["ps", "-o", "stat=", "-s", str(session)], capture_output=True, text=True).stdout.split()
        if all(state.startswith("Z") for state in alive):
            return True
        time.sleep(0.1)
    return False


def test_kill_9_loses_only_what_was_running_and_leaves_no_process(tmp_path):
    process = start_and_wait_for_rows(tmp_path, "-c", SCRIPT, str(tmp_path))
    process.kill()
    process.wait()
    kept = (tmp_path / "rows.jsonl").read_text().splitlines()
    assert len(kept) >= 2
    assert wait_for_end_of(process.pid)
    table = run_rows(slow, [{"seconds": 0.2 + x / 1e3} for x in range(10)], workers=2, out=tmp_path, resume=True)
    pids = {json.loads(line)["pid"] for line in kept}
    assert sum(pid in pids for pid in table["pid"]) == len(kept)
