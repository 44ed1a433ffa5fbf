"""Commands with words, numbers, folders and files that nobody can mean: one line of at most 300 characters, and exit status 2."""

import os
from pathlib import Path

import pytest
from program import OLD_RUN, call

from anet_lumped import Cable, Fixed, Free, Scene, save_scene
from anet_lumped.effects import Gravity

LONGEST = 300  # characters of a line
DIGITS = "9" * 400
SHORT = ["simulate", "net_held", "--t-end", "10ms"]
SWEEP = ["sweep", "net_held", "--vary"]
WORDS = ["", " ", "x", "\x1b[31m", "two\nlines", "a\0b", "\udcff", "é" * 5000, "[" * 2000, "{}"]
NUMBERS = ["nan", "inf", "-inf", "1e400", "1 parsec", "²", "0x10", "1,2", DIGITS, "9" * 5000]


def refused(capsys, *arguments):
    """The one line with which a command is refused."""
    assert call(*arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    (line,) = said.err.splitlines()
    assert len(line) <= LONGEST and line.isprintable() and line.startswith("anet-lumped: ")
    return line


@pytest.mark.parametrize("text", [*WORDS, *NUMBERS])
def test_quantities(text, capsys):
    assert "must be a time such as" in refused(capsys, "simulate", "net_held", "--t-end", text)
    assert "must be a time such as" in refused(capsys, *SHORT, "--dt", text)
    assert "must be a time such as" in refused(capsys, *SHORT, "--save-every", text)
    assert "must be a length such as" in refused(capsys, "ropes", "--diameter", text)
    assert "must be a length such as" in refused(capsys, "effects", "net_held", "--water-level", text)
    assert "must be a force such as" in refused(capsys, "effects", "net_held", "--error", text, "--tension", "s0-p0")


@pytest.mark.parametrize("command", ["recommend", "effects"])
def test_an_error_in_newtons_needs_the_cable_whose_tension_it_is(command, capsys):
    said = refused(capsys, command, "net_held", "--error", "1N")
    assert "'--error': must be a length such as 1mm, or a force together with --tension CABLE, but it is \"1N\"" in said


@pytest.mark.parametrize("number", ["nan", "inf", "-1", "x", "", DIGITS])
def test_pure_numbers(number, capsys):
    for option in ("--rtol", "--tension-error"):
        refused(capsys, *SHORT, option, number)
    refused(capsys, "recommend", "net_held", "--error", "1mm", "--realtime", number)


@pytest.mark.parametrize("dt", ["0", "-1ms", "1e-400"])
def test_steps_that_are_no_steps(dt, capsys):
    assert "must be positive and finite" in refused(capsys, "check", "net_held", "--dt", dt)
    assert "must be positive and finite" in refused(capsys, *SHORT, "--dt", dt)
    assert "must be positive and finite" in refused(capsys, *SWEEP, "EA=1", "--t-end", "1", "--dt", dt, "--out", ".")


@pytest.mark.parametrize("word", WORDS)
def test_names(word, capsys, tmp_path):
    refused(capsys, word)
    refused(capsys, "check", word)
    refused(capsys, "study", word, "--out", tmp_path)
    refused(capsys, "convert", "net_held", word)
    refused(capsys, "view", word)
    refused(capsys, "view", OLD_RUN, "--out", word)
    refused(capsys, "convert", OLD_RUN, word)
    refused(capsys, "recommend", "net_held", "--error", "1mm", "--at", word)
    refused(capsys, "effects", "net_held", "--at", word)
    refused(capsys, "effects", "net_held", "--error", "1N", "--tension", word)
    for option in ("--method", "--start"):
        refused(capsys, *SHORT, option, word)
        refused(capsys, *SWEEP, "EA=1", "--t-end", "10ms", option, word, "--out", tmp_path)
    refused(capsys, *SWEEP, "EA=1", "--measure", word, "--out", tmp_path)


@pytest.mark.parametrize(
    "spec",
    [*WORDS, "EA", "=1", "EA=:", "EA=::", "EA=1:2:0", "EA=1:2:-3", "EA=1:2:1e18", "EA=nan", "EA=1e400", f"EA=1:2:{'9' * 5000}",
     "EA=inf:1:3", "EA=nan:1:3", "EA=-1e308:1e308:3", "EA=1e-308:1e308:3log", "EA=-1:1:3log", "a.b." * 2000 + "=1"],
    ids=lambda spec: repr(spec[:20]),
)  # fmt: skip
def test_what_cannot_vary(spec, capsys, tmp_path):
    refused(capsys, *SWEEP, spec, "--out", tmp_path)
    refused(capsys, *SHORT, "--set", spec)


@pytest.mark.parametrize(
    ("vary", "count"),
    [(["EA=1:2:1000000000"], "1e+09"), ([f"EA=1:2:{DIGITS}"], "1e+308"), (["EA=1:2:10000", "p0.mass=1:2:10000"], "1e+08")],
)
def test_rows_are_counted_before_they_are_made(vary, count, capsys, tmp_path):
    line = refused(capsys, "sweep", "net_held", *(word for spec in vary for word in ("--vary", spec)), "--out", tmp_path)
    assert f"would take {count} rows, but must not take more than 1e+06" in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("workers", ["1000000", "0", "-1", "1.5", "x", DIGITS])
def test_workers_that_no_machine_has(workers, capsys, tmp_path):
    refused(capsys, *SWEEP, "EA=1:2:100000", "--workers", workers, "--out", tmp_path)


@pytest.mark.parametrize("value", ["x", "-1", "\x1b[31m", DIGITS, "1.5", "[" * 3000])
def test_values_that_a_scene_refuses(value, capsys):
    refused(capsys, *SHORT, "--set", f"segments={value}")


@pytest.mark.parametrize("folder", ["x" * 300, "/dev/null", "/dev/null/x"])
@pytest.mark.parametrize("command", [["equilibrium", "net_held"], [*SWEEP, "EA=1"], ["study", "order"], ["report"], SHORT])
def test_folders(folder, command, capsys):
    assert "must be a folder that can be written" in refused(capsys, *command, "--out", folder)


def test_a_file_that_cannot_be_written(capsys, tmp_path):
    assert "to a folder that is there, but" in refused(capsys, "convert", "net_held", tmp_path / "nowhere" / "net.toml")
    refused(capsys, "convert", "net_held", "a\0b.toml")


def scenes():
    """Scenes that cannot hang at rest, for a reason that a user can mend."""
    line = {"length": 1.0, "mass_per_length": 0.1, "EA": 1e4, "segments": 4}
    held, near, far, loose = Fixed("a", (0, 0, 0)), Fixed("b", (0, 0, 0.5)), Fixed("b", (2, 0, 0)), Free("b", at=(1, 0, 0))

    def scene(start, end, *effects, **changes):
        return Scene([start, end], [Cable("a", "b", **line | changes)], effects)

    return {
        "nothing holds": scene(Free("a", at=(0, 0, 0)), loose, Gravity()),
        "Nothing loads": scene(held, near),
        "would push": scene(held, near, Gravity(), compression="linear", segments=5),
        "must be longer than": scene(held, far, Gravity(), EA=float("inf")),
    }


@pytest.mark.parametrize("reason", scenes())
def test_a_scene_that_cannot_rest_is_an_input(reason, capsys, tmp_path):
    save_scene(scenes()[reason], tmp_path / "scene.toml")
    assert call("equilibrium", tmp_path / "scene.toml") == 2
    line = capsys.readouterr().err.splitlines()[-1]
    assert reason in line and len(line) <= LONGEST


def test_memory_that_is_not_there_is_one_line_and_no_fault_of_the_input(monkeypatch, capsys):
    def too_large(*arguments, **settings):
        raise MemoryError("Unable to allocate 1.77 TiB")

    monkeypatch.setattr("anet_lumped.statics.equilibrium.equilibrium", too_large)
    assert call("equilibrium", "net_held") == 1
    assert "The memory of this machine does not hold what this takes. Unable to allocate" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "status", "sentence"),
    [
        (OSError(12, "Cannot allocate memory"), 1, "The system refused what this takes: Cannot allocate memory."),
        (PermissionError(13, "Permission denied", "a\nfile"), 2, r"a\nfile: Permission denied."),
    ],
)
def test_what_the_system_refuses(error, status, sentence, monkeypatch, capsys):
    def refused(*arguments, **settings):
        raise error

    monkeypatch.setattr("anet_lumped.statics.equilibrium.equilibrium", refused)
    assert call("equilibrium", "net_held") == status
    assert capsys.readouterr().err == f"anet-lumped: {sentence}\n"


def test_results_that_a_full_disk_refuses_are_named_by_their_folder(monkeypatch, capsys, tmp_path):
    def full(*arguments, **settings):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("studies.shown.summary.write_nodes", full)
    assert call("equilibrium", "net_held", "--out", tmp_path) == 2
    assert f"{tmp_path}: No space left on device." in capsys.readouterr().err


def test_names_in_tables_are_on_one_line_and_command_no_terminal(capsys, tmp_path):
    points = [Fixed("a\x1b[31m", (0, 0, 0)), Free("b\n:smile: [red]")]
    cable = Cable(points[0].name, points[1].name, length=1.0, mass_per_length=0.1, EA=1e4, segments=4)
    save_scene(Scene(points, [cable], [Gravity()]), tmp_path / "scene.toml")
    assert call("equilibrium", tmp_path / "scene.toml") == 0
    said = capsys.readouterr().out
    assert r"a\x1b[31m-b\n:smile: [red]" in said and "\x1b" not in said


def test_a_fault_of_the_program_is_no_message(monkeypatch):
    def faulty(*arguments, **settings):
        raise ValueError("a mistake in the code")

    monkeypatch.setattr("anet_lumped.statics.equilibrium.equilibrium", faulty)
    with pytest.raises(ValueError, match="a mistake in the code"):
        call("equilibrium", "net_held")


def test_without_a_command_there_is_help(capsys):
    assert call() == 0
    assert "Usage: anet-lumped" in capsys.readouterr().out


@pytest.mark.parametrize("columns", ["1", "0", "-5", "x"])
def test_a_terminal_of_any_width(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setenv("TERM", "dumb")
    for command in (["equilibrium", "net_held"], ["measures"], ["check", "--help"]):
        assert call(*command) == 0
        assert capsys.readouterr().out


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no device without an end")
@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_markers_that_are_no_file(kind, capsys, tmp_path):
    path = tmp_path / "markers.csv"
    {"pipe": lambda: os.mkfifo(path), "device": lambda: path.symlink_to("/dev/zero"), "folder": path.mkdir}[kind]()
    assert "A marker file must be " in refused(capsys, "mismatch", "net_held", "--markers", path)
