"""Commands that run many scenes: sweeps, stopped and resumed; studies; the report."""

import json
import os
import signal

import pandas
import pytest
from program import PROGRAM, call
from test_report import fake_study
from test_rows import start_and_wait_for_rows, wait_for_end_of

from studies.study import NAMES, module_of


def test_measures_lists_what_a_sweep_can_measure(capsys):
    assert call("measures") == 0
    said = capsys.readouterr().out
    assert "newton_per_step" in said and "cable or point" in said


def test_a_sweep_is_a_table_and_a_failed_row_exits_with_1(tmp_path, capsys):
    grid = ["--vary", "EA=1e3:1e4:2log", "--vary", "segments=5,10", "--measure", "height:p0"]
    assert call("sweep", "net_held", *grid, "--out", tmp_path / "good", "--json") == 0
    said = capsys.readouterr()
    assert [row["segments"] for row in json.loads(said.out)["rows"]] == [5, 10, 5, 10]
    assert "4 rows in" in said.err
    assert len(pandas.read_parquet(tmp_path / "good" / "rows.parquet")) == 4
    assert call("sweep", "net_held", "--vary", "EA=-1,1e4", "--out", tmp_path / "bad") == 1
    said = capsys.readouterr()
    assert "2 rows in" in said.err and "1 of them not done" in said.err and "must be positive" in said.out


SLOW = [
    "sweep", "net_carried", "--vary", "EA=1000:2000:8", "--method", "verlet", "--dt", "1e-4", "--t-end", "8",
    "--measure", "end_x:p0",
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_a_stopped_sweep_is_resumed(tmp_path, capsys, how, ctrl_c):
    process = start_and_wait_for_rows(tmp_path, *PROGRAM, *SLOW, "--out", str(tmp_path))
    if how == signal.SIGINT:  # as a terminal does it: to the whole group
        os.killpg(process.pid, how)
    else:
        process.send_signal(how)
    said = process.communicate(timeout=30)[1]
    if how == signal.SIGINT:
        assert process.returncode == 130
        assert f"which are in {tmp_path}/rows.jsonl. The same command with --resume does the rest." in said
        assert "Traceback" not in said
    assert wait_for_end_of(process.pid)
    kept = (tmp_path / "rows.jsonl").read_text().splitlines(keepends=True)
    whole = [line for line in kept if line.endswith("\n")]
    assert 2 <= len(whole) < 8
    assert call(*SLOW, "--out", tmp_path) == 2
    assert "rows already: resume them" in capsys.readouterr().err
    assert call(*SLOW, "--out", tmp_path, "--resume") == 0
    lines = (tmp_path / "rows.jsonl").read_text().splitlines(keepends=True)
    assert len(lines) == 8 and lines[: len(whole)] == whole
    assert pandas.read_parquet(tmp_path / "rows.parquet")["EA"].is_monotonic_increasing


def test_study_lists_and_runs(monkeypatch, tmp_path, capsys):
    assert call("study") == 0
    listed = [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines()]
    assert listed == [[name, module_of(name).STUDY.question] for name in NAMES]
    fake_study(monkeypatch, "order")
    assert call("study", "order", "--quick", "--out", tmp_path) == 0
    assert "It stretches by 10%." in capsys.readouterr().out
    assert (tmp_path / "step.svg").exists()


def test_report_writes_the_page_and_exits_with_1_if_a_study_failed(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("studies.report.available_cores", lambda: 1)
    monkeypatch.setattr("studies.report.run_study", lambda name, *_, **__: {}[name])
    assert call("report", "--out", tmp_path) == 1
    said = capsys.readouterr()
    assert said.out == f"{tmp_path / 'report.html'}\n"
    assert f"1 of {len(NAMES)}, thesis_tables ..." in said.err and "order: failed, KeyError" in said.err
    assert "No finding" in (tmp_path / "report.html").read_text()


def test_a_stopped_report_keeps_its_page_and_exits_with_130(monkeypatch, tmp_path, capsys):
    def stopped(name, *_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("studies.report.available_cores", lambda: 1)
    monkeypatch.setattr("studies.report.run_study", stopped)
    assert call("report", "--out", tmp_path) == 130
    assert f"stopped after 0 of {len(NAMES)} studies, while thesis_tables ran; " in capsys.readouterr().err
    assert "The report was stopped" in (tmp_path / "report.html").read_text()
