"""The page and the studies on it: one file that needs no other, written after every study, failures and what is to come said so."""

import importlib
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
import types
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas
import pytest

from studies import report, study
from studies.report import PAGE, ReportInterrupt, write_report
from studies.shown import figure_file
from studies.shown.page import State
from studies.shown.show import as_text, column_head
from studies.study import NAMES, Drawing, Part, Record, StudyError, module_of, run_study
from studies.sweeping.rows import run_rows

QUESTIONS = Path(study.__file__).parent / "questions"


def fake_study(monkeypatch, name, part=Part.FOUND, first_look="", **changes):
    """Put a module that keeps the protocol of a study in place of `studies.questions.name`."""
    from matplotlib import pyplot

    module = types.ModuleType(f"studies.questions.{name}")
    module.STUDY = Record("How far does a <cable> stretch?", part, first_look)
    module.TABLES = {"all_runs": "A line for each run.", "best": "A line for each step."}
    module.SEED = 3
    module.asked_quick = []

    def compute(quick=False, executor=None, out=None):
        module.asked_quick.append(quick)
        out.mkdir(parents=True)
        (out / "rows.jsonl").write_text("")
        return {
            "all_runs": pandas.DataFrame({"EA_N": [1.0, 1e4], "stretch": [0.1, np.nan], "status": ["done", "bad"]}),
            "best": pandas.DataFrame({"dt_s": np.linspace(0, 1, 60), "status": "done", "reason": ""}),
        }

    def plot(rows):
        figure, axes = pyplot.subplots()
        axes.loglog(rows["best"]["dt_s"].iloc[1:] ** 5)
        return {"step": Drawing(figure, "Steps of the best run. They grow.")}

    module.compute, module.plot = compute, plot
    module.answer = lambda rows: f"It stretches\nby {rows['all_runs']['stretch'][0]:.0%}.\n\nThe rest\nis <long>."
    vars(module).update(changes)
    monkeypatch.setitem(sys.modules, module.__name__, module)
    if name not in NAMES:
        monkeypatch.setattr(study, "NAMES", (*study.NAMES, name))
    return module


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


def test_parameters_of_a_study_in_a_folder_are_those_of_all_its_modules():
    assert {"SUPPORTS", "TABLE_5_1", "LAST_DIGIT"} <= set(study._parameters(module_of("thesis_tables")))


def test_a_heavy_figure_becomes_a_picture_of_pixels(monkeypatch, tmp_path):
    monkeypatch.setattr(figure_file, "HEAVY", 100)
    fake_study(monkeypatch, "order")
    picture = run_study("order", tmp_path).pictures["step"]
    assert picture.file.read_bytes().startswith(b"\x89PNG") and not (tmp_path / "step.svg").exists()


def test_axes_write_powers_of_ten_as_tables_do(monkeypatch, tmp_path):
    fake_study(monkeypatch, "order")
    svg = run_study("order", tmp_path).pictures["step"].file.read_text()
    assert "<!-- 1e-6 -->" in svg and "mathdefault" not in svg


def test_an_unknown_study_names_the_nearest():
    with pytest.raises(StudyError, match=r'no study "ordr", did you mean "order"\?'):
        run_study("ordr", "nowhere")


# --- one record a study -------------------------------------------------------------------------------------------------


def test_a_new_study_is_one_file_and_one_line(monkeypatch, tmp_path):
    """`fake_study` adds a module of `studies.questions` and its name in NAMES: the program lists, runs and shows it."""
    fake_study(monkeypatch, "knots", part=Part.COST)
    assert run_study("knots", tmp_path / "alone").record.part is Part.COST
    assert write_report(tmp_path, names=["knots"]) == []
    page = (tmp_path / PAGE).read_text()
    assert page.index("<h2>What accuracy costs</h2>") < page.index('<section id="knots">')


def test_every_study_has_a_file_a_line_and_a_record():
    files = {file.stem for file in QUESTIONS.iterdir() if not file.name.startswith("_")}
    assert files == set(NAMES) and len(NAMES) == len(files)
    for name in NAMES:
        module = module_of(name)
        assert module.STUDY.question.endswith("?") and module.STUDY.part in Part
        assert not module.STUDY.first_look or module.STUDY.first_look.endswith(".")
        assert module.TABLES and all(about.endswith(".") and "`" not in about for about in module.TABLES.values())


@pytest.mark.slow
def test_records_are_read_without_the_kernels_of_effects():
    """So that the page is there before anything is compiled."""
    import subprocess

    code = (
        "import sys; from studies.study import NAMES, module_of\n"
        "for name in NAMES: module_of(name)\n"
        "print([name for name in ('air', 'bending', 'water', 'ground') if f'anet_lumped.effects.{name}' in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=QUESTIONS.parents[1])
    assert out.stdout.strip() == "[]"


# --- the page -----------------------------------------------------------------------------------------------------------


def test_the_page_stands_alone_and_tells_a_failure(monkeypatch, tmp_path):
    fake_study(monkeypatch, "order")
    fake_study(monkeypatch, "speed", part=Part.CURE, compute=broken)
    told = []
    failed = write_report(tmp_path, names=["order", "speed"], tell=told.append)
    page = (tmp_path / PAGE).read_text()
    assert failed == ["speed"]
    assert [(one.number, one.name, one.state) for one in told] == [
        (1, "order", State.RUNNING), (1, "order", State.DONE), (2, "speed", State.RUNNING), (2, "speed", State.FAILED),
    ]  # fmt: skip
    assert told[-1].reason == "ArithmeticError: no rows & no hope" and all(one.total == 2 for one in told)
    assert page.count("It stretches by 10%.") == 2  # in the summary and in its section
    assert "How far does a &lt;cable&gt; stretch?" in page and "The rest is &lt;long&gt;." in page
    assert "ArithmeticError: no rows &amp; no hope" in page and "No finding" in page
    assert re.findall(r'(?:src|href)="(?!data:|#|order/)', page) == []
    for link in re.findall(r'href="(order/[^"]*)"', page):
        assert (tmp_path / link).exists()
    assert "(the first 40 of 60 rows)" in page and "A line for each run." in page
    assert page.count("<th>status</th>") == 1  # the table that is "done" throughout does not show it
    assert '<img src="data:image/svg+xml' in page and 'alt="Steps of the best run."' in page
    assert "<figcaption>Steps of the best run. They grow.</figcaption>" in page
    assert "still being made" not in page and "to come" not in page


def test_equations_and_units_are_not_torn_apart():
    from studies.shown.page import _prose

    text = "at EA = 1e4 N and 10 ms it is 98 % of 3 months"
    assert _prose(text).replace("\u00a0", "~") == "at EA~=~1e4~N and 10~ms it is 98~% of 3 months"


def test_the_page_is_there_from_the_start_and_grows(monkeypatch, tmp_path):
    seen = []
    for name in ("order", "speed"):
        fake_study(monkeypatch, name)
    write_report(tmp_path, names=["order", "speed"], tell=lambda now: seen.append((tmp_path / PAGE).read_text()))
    assert [page.count("It stretches by 10%.") for page in seen] == [0, 2, 2, 4]  # on disk when the study's end is told
    assert "This page is still being made: 2 studies are" in seen[0] and "1 study is" in seen[2]
    assert "It is running." in seen[0] and "It is still to come." in seen[0]


def test_long_studies_take_a_first_look_and_say_what_it_is(monkeypatch, tmp_path):
    short, long = fake_study(monkeypatch, "order"), fake_study(monkeypatch, "speed", first_look="two of twelve motions.")
    write_report(tmp_path, names=["order", "speed"])
    page = (tmp_path / PAGE).read_text()
    assert page.count("A first look: two of twelve motions.") == 1 and "anet-lumped study speed" in page
    write_report(tmp_path, names=["order", "speed"], full=True)
    assert "A first look" not in (tmp_path / PAGE).read_text()
    assert short.asked_quick == [False, False] and long.asked_quick == [True, False]


def test_ctrl_c_leaves_the_page_with_what_is_done(monkeypatch, tmp_path):
    def stopped(**settings):
        raise KeyboardInterrupt

    fake_study(monkeypatch, "order")
    fake_study(monkeypatch, "speed", compute=stopped)
    with pytest.raises(
        ReportInterrupt, match=r"stopped after 1 of 2 studies, while speed ran; .*report\.html holds those that are done"
    ):
        write_report(tmp_path, names=["order", "speed"])
    page = (tmp_path / PAGE).read_text()
    assert "The report was stopped after 1 of 2 studies, while speed ran; the others are still to come." in page
    assert page.count("It stretches by 10%.") == 2 and "still being made" not in page and "It is running." not in page


# --- two at once --------------------------------------------------------------------------------------------------------


def quick_entry(entry, out, executor=None):
    """In the place of `report.run_entry`, which other processes find by its name: how a study ends, its name says."""
    seen = out.parent / "running"
    seen.mkdir(exist_ok=True)
    (seen / entry.name).touch()
    if entry.name == "energy_rise":
        os._exit(3)
    began = time.monotonic()
    while entry.name in ("order", "length_error") and len(list(seen.iterdir())) < 2:  # until the other runs too
        assert time.monotonic() < began + 60.0
        time.sleep(0.01)
    about = f"{os.getpid()} {sorted(file.name for file in seen.iterdir())}"
    (seen / entry.name).unlink()
    if entry.name == "stability_map":
        return replace(entry, state=State.FAILED, reason="no hope")
    return replace(entry, state=State.FAILED, reason=about)


def quick_entry_on(cores, *arguments):
    """In the place of `report.run_on`."""
    return quick_entry(*arguments)


def entry_with_cores(cores, entry, out, executor=None):
    """In the place of `report.run_on`: a study that ends when as many have begun as its name says, and tells its cores."""
    (out.parent / "began").mkdir(exist_ok=True)
    (out.parent / "began" / entry.name).touch()
    wanted, limit = {"thesis_tables": 2, "order": 3, "speed": 4}.get(entry.name, 0), time.monotonic() + 60.0
    while len(list((out.parent / "began").iterdir())) < wanted:
        assert time.monotonic() < limit
        time.sleep(0.01)
    return replace(entry, state=State.FAILED, reason=f"{os.getpid()} {cores}")


@pytest.mark.slow
@pytest.mark.skipif(not report.ALL_CORES or len(report.ALL_CORES) < 2, reason="it takes two cores")
def test_in_a_first_look_one_study_that_compares_times_has_a_core_of_its_own(monkeypatch, tmp_path):
    """Beside it runs one that does not, on the others; two that compare times never run at once."""
    monkeypatch.setattr(report, "compile_ahead", lambda halves: None)
    monkeypatch.setattr(report, "run_on", entry_with_cores)
    names, told = ["thesis_tables", "speed", "order", "length_error"], []
    write_report(tmp_path, names=names, at_once=2, tell=told.append)
    assert [one.name for one in told if one.state is State.RUNNING] == ["thesis_tables", "order", "speed", "length_error"]
    first, *others = sorted(report.ALL_CORES)
    reasons = {one.name: one.reason.split(" ", 1) for one in told if one.state is State.FAILED}
    assert str(os.getpid()) not in {pid for pid, _ in reasons.values()}
    assert reasons["thesis_tables"][1] == reasons["speed"][1] == str({first})
    assert reasons["order"][1] == reasons["length_error"][1] == str(set(others))


@pytest.mark.skipif(not report.ALL_CORES, reason="this system gives no process cores of its own")
def test_a_study_runs_on_the_cores_that_it_is_given_and_so_do_its_rows(monkeypatch, tmp_path):
    def entry(entry, out, executor):
        return (
            run_rows(where_row_runs, [{"n": n} for n in range(2)], executor=executor).loc[:, ["cores", "process"]].values.tolist()
        )

    monkeypatch.setattr(report, "run_entry", entry)
    last = max(report.ALL_CORES)
    try:
        assert report.run_on({last}, "order", tmp_path) == [[str({last}), os.getpid()]] * 2  # where no other has a core
        cores, processes = zip(*report.run_on(None, "order", tmp_path), strict=True)
        assert set(cores) == {str(report.ALL_CORES)} and os.getpid() not in processes
    finally:
        os.sched_setaffinity(0, report.ALL_CORES)


def where_row_runs(row):
    """The cores that a row may use, and its process."""
    return {"cores": str(os.sched_getaffinity(0)), "process": os.getpid()}


@pytest.mark.slow
def test_studies_run_two_at_once_and_those_that_compare_times_alone(monkeypatch, tmp_path):
    """One that fails and one whose process dies take no other with them; that of times runs here, when nothing else does."""
    ahead = []
    monkeypatch.setattr(report, "compile_ahead", lambda halves: ahead.append((tmp_path / PAGE).exists()))
    monkeypatch.setattr(report, "run_entry", quick_entry)
    monkeypatch.setattr(report, "run_on", quick_entry_on)
    names, told = ["order", "speed", "length_error", "stability_map", "energy_rise", "model_mismatch"], []
    assert [module_of(name).STUDY.compares_times for name in names] == [False, True, False, False, False, False]
    write_report(tmp_path, names=names, at_once=2, full=True, tell=told.append)
    assert ahead == [True]  # once, with a page to look at
    starts = [one.name for one in told if one.state is State.RUNNING]
    assert starts == ["order", "length_error", "stability_map", "energy_rise", "model_mismatch", "speed"]
    assert [one.number for one in told if one.state is State.RUNNING] == [1, 2, 3, 4, 5, 6]
    reasons = {one.name: one.reason for one in told if one.state is State.FAILED}
    assert "['length_error', 'order']" in reasons["order"] + reasons["length_error"]
    assert reasons["energy_rise"].startswith("ProcessDiedError: the process died")
    assert reasons["stability_map"] == "no hope" and "model_mismatch" in reasons["model_mismatch"]
    pid, _, seen = reasons["speed"].partition(" ")
    assert int(pid) == os.getpid() and seen == "['energy_rise', 'speed']"  # the former's, which it could not take away
    assert not reasons["model_mismatch"].startswith(str(os.getpid()))


def endless_entry(entry, out, executor=None):
    """In the place of `report.run_entry`: a study that begins another process and never ends."""
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    try:
        (out.parent / entry.name).with_suffix(".pid").write_text(f"{os.getpid()}")
        time.sleep(600)
    finally:  # in order
        child.kill()
        (out.parent / entry.name).with_suffix(".ended").touch()


def endless_entry_on(cores, *arguments):
    """In the place of `report.run_on`."""
    return endless_entry(*arguments)


@pytest.mark.slow
def test_ctrl_c_ends_both_studies_in_order(monkeypatch, tmp_path):
    monkeypatch.setattr(report, "compile_ahead", lambda halves: None)
    monkeypatch.setattr(report, "run_on", endless_entry_on)

    def stop():
        while len(list(tmp_path.glob("*.pid"))) < 2:
            time.sleep(0.05)
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Thread(target=stop, daemon=True).start()
    try:
        with pytest.raises(ReportInterrupt, match=r"stopped after 0 of 3 studies, while order and length_error ran; "):
            write_report(tmp_path, names=["order", "length_error", "stability_map"], at_once=2)
    finally:
        signal.signal(signal.SIGINT, before)
    assert {file.name for file in tmp_path.glob("*.ended")} == {"order.ended", "length_error.ended"}
    for file in tmp_path.glob("*.pid"):
        with pytest.raises(ProcessLookupError):
            os.kill(int(file.read_text()), 0)
    assert "It is running." not in (tmp_path / PAGE).read_text()


@pytest.mark.parametrize("name", NAMES)
def test_a_study_that_looks_at_clocks_says_that_it_compares_times(name):
    module = QUESTIONS / name
    files = module.rglob("*.py") if module.is_dir() else [module.with_suffix(".py")]
    clocks = re.compile(r"\bperf_counter\b|\bprocess_time\b|\bwall_time\b|\btake_turns\b|\btimes_real_time\b")
    looks = any(clocks.search(file.read_text(encoding="utf-8")) for file in files)
    assert looks == module_of(name).STUDY.compares_times


# --- numbers ------------------------------------------------------------------------------------------------------------


def test_the_unit_of_a_column_stands_in_brackets():
    names = ["sag_error_mm", "share_percent", "status", "EA_N", "m", "energy_rise_J", "damper_Ns_per_m", "environment_per_s"]
    heads = ["sag error [mm]", "share [%]", "status", "EA [N]", "m", "energy rise [J]", "damper [N·s/m]", "environment [1/s]"]
    assert list(map(column_head, names)) == heads


@pytest.mark.parametrize(
    "value, text",
    [
        (np.float64(12345.6), "12346"), (0.1, "0.1"), (1e-5, "1e-5"), (1.23456e-9, "1.235e-9"), (float("nan"), "–"),
        (1e9, "1e9"), (float("-inf"), "-∞"), (np.int64(160), "160"), (1000.0, "1000"), (True, "True"), ("edmc", "edmc"),
        (None, ""), (0.0, "0"), (3.14159, "3.142"), (99999.7, "1e5"), (25000.0, "2.5e4"), (1e4, "1e4"), (0.00099999, "0.001"),
    ],
)  # fmt: skip
def test_numbers_on_the_page_keep_four_digits(value, text):
    assert as_text(value) == text


@pytest.mark.parametrize("name", NAMES)
def test_heads_of_a_study_tell_their_units(name):
    """No caption, question or note holds a literal backtick, which a page does not render."""
    module = importlib.import_module(f"studies.questions.{name}")
    for text in (module.STUDY.question, module.STUDY.first_look, *module.TABLES.values()):
        assert "`" not in text
    assert report.PAGE.endswith(".html")
