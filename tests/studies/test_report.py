"""The page and the studies on it: one file that needs no other, failed studies said so, numbers readable."""

import json
import re
import types

import numpy as np
import pandas
import pytest

from studies import study
from studies.shown import report
from studies.shown.show import as_text, column_head
from studies.study import StudyError, run_study


def fake_study(monkeypatch, name, **changes):
    """Put a module that keeps the protocol of a study in place of `studies.questions.name`."""
    import sys

    from matplotlib import pyplot

    module = types.ModuleType(f"studies.questions.{name}")
    module.QUESTION = "How far does a <cable> stretch?"
    module.SEED = 3

    def compute(quick=False, executor=None, out=None):
        out.mkdir(parents=True)
        (out / "rows.jsonl").write_text("")
        return {
            "all_runs": pandas.DataFrame({"EA_N": [1.0, 1e4], "stretch": [0.1, np.nan], "status": ["done", "bad"]}),
            "best": pandas.DataFrame({"dt_s": np.linspace(0, 1, 60), "status": "done", "reason": ""}),
        }

    def plot(rows):
        figure, axes = pyplot.subplots()
        axes.plot(rows["best"]["dt_s"])
        return {"step": figure}

    module.compute, module.plot = compute, plot
    module.answer = lambda rows: f"It stretches\nby {rows['all_runs']['stretch'][0]:.0%}.\n\nThe rest\nis <long>."
    vars(module).update(changes)
    monkeypatch.setitem(sys.modules, module.__name__, module)


def broken(quick=False, executor=None, out=None):
    raise ArithmeticError("no rows & no hope")


def test_a_study_leaves_tables_figures_answer_and_meta(monkeypatch, tmp_path):
    fake_study(monkeypatch, "order")
    found = run_study("order", tmp_path, quick=True)
    assert found.answer == ["It stretches by 10%.", "The rest is <long>."]
    names = {"all_runs.parquet", "all_runs.csv", "best.parquet", "best.csv", "step.svg", "answer.txt", "meta.json"}
    assert {file.name for file in tmp_path.iterdir()} == names
    meta = json.loads((tmp_path / "meta.json").read_text())
    assert meta["parameters"] == {"SEED": 3} and meta["quick"] is True and "numpy" in meta["versions"]
    pandas.testing.assert_frame_equal(pandas.read_parquet(tmp_path / "best.parquet"), found.tables["best"])


def test_a_heavy_figure_becomes_a_picture_of_pixels(monkeypatch, tmp_path):
    monkeypatch.setattr(study, "HEAVY", 100)
    fake_study(monkeypatch, "order")
    assert run_study("order", tmp_path).figures["step"].read_bytes().startswith(b"\x89PNG")
    assert not (tmp_path / "step.svg").exists()


def test_an_unknown_study_names_the_nearest():
    with pytest.raises(StudyError, match=r'no study "ordr", did you mean "order"\?'):
        run_study("ordr", "nowhere")


def test_the_page_stands_alone_and_tells_a_failure(monkeypatch, tmp_path):
    fake_study(monkeypatch, "order")
    fake_study(monkeypatch, "speed", compute=broken)
    lines = []
    failed = report.write_report(tmp_path, parts={"Found": ["order"], "Cure": ["speed"]}, tell=lines.append)
    page = (tmp_path / "report.html").read_text()
    assert failed == ["speed"] and len(lines) == 2 and "failed, ArithmeticError" in lines[1]
    assert page.count("It stretches by 10%.") == 2  # in the summary and in its section
    assert "How far does a &lt;cable&gt; stretch?" in page and "The rest is &lt;long&gt;." in page
    assert "ArithmeticError: no rows &amp; no hope" in page and "No finding" in page
    assert re.findall(r'(?:src|href)="(?!data:|#|order/)', page) == []
    for link in re.findall(r'href="(order/[^"]*)"', page):
        assert (tmp_path / link).exists()
    assert "the first 40 of 60 rows" in page
    assert page.count("<th>status</th>") == 1  # the table that is "done" throughout does not show it


def test_the_unit_of_a_column_stands_in_brackets():
    names = ["sag_error_mm", "share_percent", "status", "EA_N", "m", "energy_rise_J"]
    heads = ["sag error [mm]", "share [%]", "status", "EA [N]", "m", "energy rise [J]"]
    assert list(map(column_head, names)) == heads


@pytest.mark.parametrize(
    "value, text",
    [
        (np.float64(12345.6), "12346"), (0.1, "0.1"), (1e-5, "1e-5"), (1.23456e-9, "1.235e-9"), (float("nan"), "–"),
        (1e9, "1e9"), (float("-inf"), "-∞"), (np.int64(160), "160"), (1000.0, "1000"), (True, "True"), ("edmc", "edmc"),
        (None, ""), (0.0, "0"), (3.14159, "3.142"), (99999.7, "100000"),
    ],
)  # fmt: skip
def test_numbers_on_the_page_keep_four_digits(value, text):
    assert as_text(value) == text
