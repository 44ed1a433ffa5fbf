"""One folder takes one run at a time, of any process and any thread, and is free again however that ends."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event, Thread

import pytest
from test_report import fake_study

from studies.report import write_report
from studies.study import run_study
from studies.sweeping import folder_lock
from studies.sweeping.folder_lock import LOCK, FolderInUseError, locked
from studies.sweeping.rows import run_rows

ROOT = Path(__file__).parents[2]
IN_USE = r"Results must go to a folder of their own, but .* is in use by process \d+"


def square(row):
    return {"square": row["x"] ** 2}


def test_a_folder_is_made_held_and_left_without_a_trace(tmp_path):
    folder = tmp_path / "a" / "b"
    with locked(folder):
        assert (folder / LOCK).read_text() == str(os.getpid())
        with (
            pytest.raises(FolderInUseError, match=rf"but {folder} is in use by process {os.getpid()}; choose another one"),
            locked(folder),
        ):
            pass
        with locked(tmp_path / "other"):
            pass
    assert list(folder.iterdir()) == []
    with locked(folder):
        pass
    with locked(None):
        pass


def test_of_two_threads_one_is_refused_and_rows_are_not_mixed(tmp_path):
    runs, may_end = Event(), Event()

    def slow(row):
        runs.set()
        assert may_end.wait(60)
        return square(row)

    def first():
        with ThreadPoolExecutor(1) as executor:
            run_rows(slow, [{"x": x} for x in range(3)], executor=executor, out=tmp_path)

    thread = Thread(target=first)
    thread.start()
    assert runs.wait(60)
    with ThreadPoolExecutor(1) as executor:
        for resume in (False, True):
            with pytest.raises(FolderInUseError, match=IN_USE):
                run_rows(square, [{"x": x} for x in range(3)], executor=executor, out=tmp_path, resume=resume)
    may_end.set()
    thread.join()
    assert (tmp_path / "rows.jsonl").read_text().count("\n") == 3


@pytest.mark.parametrize("write", [run_study, lambda name, out: write_report(out, names=[name])], ids=["study", "report"])
def test_studies_and_reports_hold_their_folder(write, monkeypatch, tmp_path):
    fake_study(monkeypatch, "order")
    with locked(tmp_path), pytest.raises(FolderInUseError, match=IN_USE):
        write("order", tmp_path)
    write("order", tmp_path)


def test_a_kill_frees_the_folder(tmp_path):
    code = (
        "import pathlib, sys, time; from studies.sweeping.folder_lock import locked\n"
        "with locked(pathlib.Path(sys.argv[1])): print('held', flush=True); time.sleep(100)"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout.readline() == "held\n"
    with pytest.raises(FolderInUseError, match=f"in use by process {process.pid}"), locked(tmp_path):
        pass
    process.kill()
    process.communicate()
    assert (tmp_path / LOCK).exists()
    with locked(tmp_path):
        pass


def test_a_holder_that_does_not_say_who_it_is_is_another_process(tmp_path):
    with locked(tmp_path):
        (tmp_path / LOCK).write_text("nobody")
        with pytest.raises(FolderInUseError, match="in use by another process"), locked(tmp_path):
            pass


def test_a_file_that_was_taken_away_between_is_no_lock(monkeypatch, tmp_path):
    """As when the run that had the folder ends after this one has opened its file and before it has locked it."""
    lock, opened = folder_lock._lock, []

    def taken_away(file):
        opened.append(file)
        if len(opened) == 1:
            (tmp_path / LOCK).unlink()
        return lock(file)

    monkeypatch.setattr(folder_lock, "_lock", taken_away)
    with locked(tmp_path):
        assert (tmp_path / LOCK).exists() and len(opened) == 2
