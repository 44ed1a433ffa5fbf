"""Rows that many processes share: parts that are whole or not there, and a table that is that of one process."""

import os
import signal
import threading
import time
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pandas
import pytest

from anet_lumped.checks import InputError
from studies.sweeping import parts, workers
from studies.sweeping.parts import NUMBER, PartTask, Shard, VersionError, read_part, read_shard
from studies.sweeping.row_log import RowsError, read_log
from studies.sweeping.rows import gather, run_rows
from studies.sweeping.workers import WorkerError

ROWS = [{"x": x, "word": "a" if x % 3 else 0.5} for x in range(30)]
SETTINGS = {"identity": {"scene": "net"}, "columns": ["square"]}


def square(row):
    """Numbers, words and failures, so that columns are of all kinds."""
    if row["x"] == 7:
        raise ValueError("x must not be 7")
    return {"square": row["x"] ** 2, "kind": row["word"], "half": row["x"] / 2 if row["x"] > 3 else None}


def noted(row, folder, killed_at=None):
    """`square`, of which a file notes each call; once, at a row, its process kills itself."""
    marker = Path(folder) / f"killed-{killed_at}"
    if row["x"] == killed_at and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    with (Path(folder) / f"calls-{os.getpid()}").open("a") as file:
        file.write(f"{row['x']}\n")
    time.sleep(0.01)
    return square(row)


def calls(folder):
    return sorted(int(x) for path in folder.glob("calls-*") for x in path.read_text().split())


@pytest.fixture(scope="module")
def one_process():
    with ThreadPoolExecutor(1) as executor:
        return run_rows(square, ROWS, executor=executor, **SETTINGS)


def is_table(found, expected):
    pandas.testing.assert_frame_equal(found, expected, check_exact=True)
    return True


def do_shard(out, number, count, function=square):
    with ThreadPoolExecutor(1) as executor:  # which counts as many workers, as a cluster has
        return run_rows(function, ROWS, executor=executor, workers=1000, out=out, shard=Shard(number, count), **SETTINGS)


def in_own_pool(out, shard):
    return run_rows(square, ROWS, out=out, workers=1, shard=shard, **SETTINGS)


def test_two_shards_side_by_side_make_the_table_of_one_process(tmp_path, one_process):
    with ThreadPoolExecutor(2) as threads:
        shares = list(threads.map(lambda number: in_own_pool(tmp_path, Shard(number, 2)), (1, 2)))
    assert [share["x"].tolist() for share in shares] == [list(range(0, 30, 2)), list(range(1, 30, 2))]
    table, missing, torn = gather(tmp_path)
    assert (missing, torn) == ([], []) and is_table(table, one_process)
    kept = pandas.read_parquet(tmp_path / "rows.parquet")
    assert kept["square"].dropna().tolist() == one_process["square"].dropna().tolist()


def test_the_gathered_file_has_units_as_that_of_one_process(tmp_path):
    run = partial(run_rows, square, ROWS, workers=1, heads={"half": "half [m]"}, **SETTINGS)
    run(out=tmp_path / "one")
    for number in (1, 2):
        run(out=tmp_path / "many", shard=Shard(number, 2))
    gather(tmp_path / "many")
    one, many = ((tmp_path / name / "rows.csv").read_text() for name in ("one", "many"))
    assert one == many and "half [m]" in one.splitlines()[0]


def test_threads_that_write_the_same_file_at_once_leave_it_whole(tmp_path):
    """They had one half-written file between them, which the quicker one took away: two shards in threads failed now and then."""
    barrier = threading.Barrier(4)

    def write(k):
        barrier.wait()
        return parts._write_first(tmp_path / f"{k}.json", "whole")

    with ThreadPoolExecutor(4) as threads:
        for k in range(100):
            assert all(threads.map(write, [k] * 4))
    assert {path.read_text() for path in tmp_path.iterdir()} == {"whole"} and len(list(tmp_path.iterdir())) == 100


def test_rows_that_are_there_are_not_done_again(tmp_path, one_process):
    do_shard(tmp_path, 1, 3, partial(noted, folder=tmp_path))
    before = calls(tmp_path)
    assert before == list(range(0, 30, 3))
    do_shard(tmp_path, 1, 3, partial(noted, folder=tmp_path))
    assert calls(tmp_path) == before
    table, missing, _ = gather(tmp_path)
    assert len(table) == 10 and missing == [x for x in range(30) if x % 3]
    assert is_table(do_shard(tmp_path, 1, 1, partial(noted, folder=tmp_path)), one_process)  # any other count goes on with them
    assert calls(tmp_path) == list(range(30))


def test_a_worker_that_is_killed_loses_its_part_alone_and_the_table_is_that_of_one_process(tmp_path, one_process):
    function = partial(noted, folder=tmp_path, killed_at=20)
    with ProcessPoolExecutor(1) as executor, pytest.raises(WorkerError, match="The executor broke while rows were to do"):
        run_rows(function, ROWS, executor=executor, out=tmp_path, shard=Shard(), **SETTINGS)
    there = {line[NUMBER] for path in (tmp_path / "parts" / "1-of-1").glob("*.jsonl") for line in read_part(path)[0]}
    assert 0 < len(there) < 30
    with ProcessPoolExecutor(1) as executor:
        table = run_rows(function, ROWS, executor=executor, out=tmp_path, shard=Shard(), **SETTINGS)
    assert is_table(table, one_process) and is_table(gather(tmp_path)[0], one_process)
    done = calls(tmp_path)
    assert set(done) == set(range(30)) and all(done.count(x) == 1 for x in there)


def test_a_task_that_is_given_out_again_after_its_part_was_written_does_nothing(tmp_path):
    do_shard(tmp_path, 1, 1, partial(noted, folder=tmp_path))
    task = PartTask(parts.BatchRunner(partial(noted, folder=tmp_path)), tmp_path, Shard(), parts.library())
    again, _ = task([{NUMBER: 0, **ROWS[0]}])
    assert calls(tmp_path) == list(range(30)) and again[0]["square"] == 0


@pytest.mark.parametrize("damage", [lambda text: text[: len(text) // 2], lambda text: text.replace(b"16", b"17"), lambda text: b""])
def test_a_part_that_is_torn_is_told_and_its_rows_are_done_again(tmp_path, one_process, damage):
    do_shard(tmp_path, 1, 2)
    do_shard(tmp_path, 2, 2)
    part = min((tmp_path / "parts" / "1-of-2").glob("*.jsonl"), key=lambda path: b'"x": 4,' not in path.read_bytes())
    lost = [line[NUMBER] for line in read_part(part)[0]]
    part.write_bytes(damage(part.read_bytes()))
    table, missing, torn = gather(tmp_path)
    assert (missing, torn) == (lost, [part]) and len(table) == 30 - len(lost)
    with pytest.warns(UserWarning, match=rf"The part {part} was torn: its rows are done again"):
        do_shard(tmp_path, 1, 2)
    assert is_table(gather(tmp_path)[0], one_process)


def test_a_crashed_row_is_in_the_table_and_is_done_again(tmp_path, one_process):
    """In a pool of its own a process survives a worker that dies, again and again."""
    table = run_rows(kills, ROWS[:6], out=tmp_path, workers=1, shard=Shard(), **SETTINGS)
    assert table["status"].tolist() == ["done", "done", "crashed", "done", "done", "done"]
    assert gather(tmp_path)[0]["status"].tolist() == table["status"].tolist()
    again = do_shard_of(tmp_path, ROWS[:6])
    assert again["square"].tolist() == [x**2 for x in range(6)] and is_table(gather(tmp_path)[0], again)


def do_shard_of(out, rows):
    with ThreadPoolExecutor(1) as executor:
        return run_rows(square, rows, executor=executor, out=out, shard=Shard(), **SETTINGS)


def kills(row):
    if row["x"] == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return square(row)


def test_another_version_of_the_library_is_a_clear_word(tmp_path, monkeypatch):
    do_shard(tmp_path, 1, 2)
    made_with = parts.library()
    other = made_with | {"numba": "0.1"}
    monkeypatch.setattr(parts, "library", lambda: other)
    with pytest.raises(
        VersionError, match=r"same versions, but the rows of .* were begun with numba 0\.\d+.*, and \S+ has numba 0\.1\."
    ):
        do_shard(tmp_path, 2, 2)
    with pytest.raises(VersionError, match=r"same versions, but the rows were begun with numba 0\.\d+"):
        PartTask(parts.BatchRunner(square), tmp_path, Shard(), made_with)([{NUMBER: 0, **ROWS[0]}])


def test_a_worker_that_does_not_see_the_folder_is_a_clear_word(tmp_path):
    task = PartTask(parts.BatchRunner(square), tmp_path / "elsewhere", Shard(), parts.library())
    with pytest.raises(WorkerError, match=r"All workers must see the folder of the rows, but .* does not see .*elsewhere"):
        task([{NUMBER: 0, **ROWS[0]}])


def test_a_worker_that_cannot_write_ends_the_sweep(tmp_path, monkeypatch):
    def refuse(*arguments):
        raise OSError(28, "No space left on device", "part")

    monkeypatch.setattr(parts, "write_part", refuse)
    with pytest.raises(WorkerError, match=r"A worker could not do its rows: OSError: .*No space left on device"):
        do_shard(tmp_path, 1, 1)


def test_what_is_mixed_is_refused(tmp_path):
    do_shard(tmp_path / "parts-first", 1, 2)
    with pytest.raises(RowsError, match="holds parts of a sweep that many processes share"):
        run_rows(square, ROWS, out=tmp_path / "parts-first", resume=True, **SETTINGS)
    with pytest.raises(RowsError, match="is of another sweep: scene"):
        run_rows(square, ROWS, out=tmp_path / "parts-first", shard=Shard(1, 2), identity={"scene": "cable"})
    with pytest.raises(RowsError, match=r"meta\.json is not of these rows"):
        run_rows(square, ROWS[:5], out=tmp_path / "parts-first", shard=Shard(1, 2), **SETTINGS)
    run_rows(square, ROWS[:2], out=tmp_path / "one-first", workers=1, **SETTINGS)
    with pytest.raises(RowsError, match="holds rows of a sweep in one process"):
        do_shard(tmp_path / "one-first", 1, 2)
    with pytest.raises(RowsError, match=r"must hold the parts of a sweep, but .* holds none"):
        gather(tmp_path / "one-first")
    part = next((tmp_path / "parts-first" / "parts").glob("*/*.jsonl"))
    parts.write_part(part.with_name("000000999.jsonl"), [{NUMBER: 999, "status": "done", "reason": "", **ROWS[0]}], 1.0)
    with pytest.raises(RowsError, match="holds a row of number 999, which this sweep of 30 rows has not"):
        gather(tmp_path / "parts-first")


@pytest.mark.parametrize("through", [None, 1000])
def test_parts_of_another_sweep_are_refused_and_what_differs_is_named(tmp_path, through):
    """A folder whose meta.json was replaced, or into which parts of another one were copied."""
    other = {"identity": {"scene": {"cables": "x" * 100, "g": 9.81}, "settings": {"t_end": 2.0}}, "columns": ["square"]}
    mine = {"identity": {"scene": {"cables": "y" * 100, "g": 9.81}, "settings": {"t_end": 4.0}}, "columns": ["square"]}
    told = r"must be of one sweep, but .* is of another: scene.cables differs, settings.t_end was 2.0 and is 4.0;"
    with ThreadPoolExecutor(1) as executor:
        given = (
            {"workers": 1, "shard": Shard()} if through is None else {"workers": through, "shard": Shard(), "executor": executor}
        )
        run_rows(square, ROWS, out=tmp_path, **given, **other)
        (tmp_path / "meta.json").unlink()
        with pytest.raises(RowsError, match=told):
            run_rows(square, ROWS, out=tmp_path, **given, **mine)
    with pytest.raises(RowsError, match=told):
        gather(tmp_path)


def test_a_shard_is_done_by_one_process_at_a_time(tmp_path):
    inside = []

    def second(row):
        if not inside:
            inside.append(row)
            with pytest.raises(
                InputError, match=r"One process must do a share of the rows, but this one of .* is in use by process"
            ):
                do_shard(tmp_path, 1, 2)
            do_shard(tmp_path, 2, 2)
        return square(row)

    do_shard(tmp_path, 1, 2, second)
    assert gather(tmp_path)[1] == []


@pytest.mark.parametrize("text", ["0/2", "3/2", "1", "1/", "a/b", "-1/2", "1/2/3", ""])
def test_a_shard_is_one_of_so_many(text):
    with pytest.raises(InputError, match="A shard must be i/n with i from 1 to n, as in 2/4"):
        read_shard(text)
    assert read_shard("2/4") == Shard(2, 4)


def test_the_table_is_read_by_what_reads_parquet(tmp_path, one_process):
    do_shard(tmp_path, 1, 1)
    gather(tmp_path)
    file = tmp_path / "rows.parquet"
    polars, duckdb = pytest.importorskip("polars"), pytest.importorskip("duckdb")
    assert polars.read_parquet(file)["square"].sum() == one_process["square"].sum()
    assert duckdb.sql(f"select sum(square) from '{file}'").fetchall()[0][0] == one_process["square"].sum()


class Refusing(Executor):
    """Takes some rows and raises, or cancels, or never does them."""

    def __init__(self, how):
        self.how = how

    def submit(self, function, /, *arguments):
        future = Future()
        if arguments[0][0][NUMBER] == 0:
            future.set_result(function(arguments[0][:1]))
        elif self.how == "raises":
            raise OSError("no licence")
        elif self.how == "breaks":
            raise BrokenExecutor("all nodes are gone")
        elif self.how == "cancels":
            future.cancel()
        return future


@pytest.mark.parametrize(
    ("how", "told"),
    [
        ("raises", "The executor must take rows, but it raised OSError: no licence"),
        ("breaks", "The executor broke while rows were to do: all nodes are gone"),
        ("cancels", "The executor must do its rows, but it cancelled"),
    ],
)
def test_an_executor_that_fails_says_how_and_what_is_done_is_kept(tmp_path, one_process, how, told):
    with pytest.raises(WorkerError, match=told):
        run_rows(square, ROWS, executor=Refusing(how), workers=1, out=tmp_path, shard=Shard(), **SETTINGS)
    assert 0 in gather(tmp_path)[0]["x"].tolist()
    assert is_table(run_rows(square, ROWS, workers=1, out=tmp_path, shard=Shard(), **SETTINGS), one_process)


class Cancelling(Executor):
    """Cancels the first row that it is given, and does the others."""

    def submit(self, function, /, *arguments):
        future = Future()
        if arguments[0][0]["x"] == 0:
            future.cancel()
        else:
            future.set_result(function(*arguments))
        return future


def test_rows_that_come_back_beside_one_that_is_cancelled_are_kept():
    """They were dropped, where no folder held them."""
    with pytest.raises(WorkerError, match=r"it cancelled some of them; 29 of 30 rows are done") as raised:
        run_rows(square, ROWS, executor=Cancelling(), **SETTINGS)
    assert raised.value.found["x"].tolist() == list(range(1, 30))


def test_an_executor_that_gives_nothing_back_is_told(monkeypatch, caplog):
    executor = Refusing("never")
    monkeypatch.setattr(workers, "LOOKED_EVERY", 0.01)
    monkeypatch.setattr(workers, "TOLD_AFTER", 0.02)

    class Told(Exception):
        pass

    def told(*given):
        raise Told(given[0] % given[1:])

    monkeypatch.setattr(workers.LOG, "warning", told)
    rows = {1: {NUMBER: 1, "x": 2}}
    with pytest.raises(Told, match=r"no row has come back for .* the first of row 1, .*Ctrl-C keeps what is done"):
        list(workers.through_executor(executor, square, rows, [1]))


def interrupted(row, folder):
    if row["x"] == 5 and not (folder / "was").exists():
        (folder / "was").touch()
        raise KeyboardInterrupt
    return square(row)


def test_ctrl_c_in_a_worker_keeps_what_it_has_done(tmp_path, one_process):
    out = tmp_path / "out"
    function = partial(interrupted, folder=tmp_path)
    with ThreadPoolExecutor(1) as executor:
        run = partial(run_rows, function, ROWS, executor=executor, workers=1, out=out, shard=Shard(), **SETTINGS)
        with pytest.raises(KeyboardInterrupt, match="Stopped after"):
            run()
        assert gather(out)[0]["x"].tolist()[:5] == [0, 1, 2, 3, 4]
        assert is_table(run(), one_process)


class Together(Executor):
    """Does all its rows before any of them is read; of one of them a worker's Ctrl-C comes back."""

    def submit(self, function, /, *arguments):
        future = Future()
        try:
            future.set_result(function(*arguments))
        except KeyboardInterrupt as error:
            future.set_exception(error)
        return future


def test_ctrl_c_in_a_worker_without_parts_keeps_the_rows_that_have_come_back(tmp_path):
    run = partial(run_rows, partial(interrupted, folder=tmp_path), ROWS, out=tmp_path, **SETTINGS)
    with pytest.raises(KeyboardInterrupt, match="Stopped after 29 of 30 rows"):
        run(executor=Together())
    assert sorted(line["x"] for line in read_log(tmp_path / "rows.jsonl")) == [x for x in range(30) if x != 5]
