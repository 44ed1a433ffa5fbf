"""The program as its user meets it: what it prints where, its exit status, and how a sweep is stopped and resumed."""

import csv
import inspect
import json
import os
import re
import subprocess
import sys
import typing
from pathlib import Path

import pytest
import typer
from program import OLD_RUN, PROGRAM, call

from anet_lumped import equilibrium, load_run, load_scene, simulate
from anet_lumped.files.scene_file import SCENES
from integrators.compiling import NOTICE
from studies import command_line
from studies.quantities import metres, newtons, seconds
from studies.sweeping.measures import MEASURES

COMMANDS = [
    "equilibrium",
    "simulate",
    "fly",
    "check",
    "sweep",
    "gather",
    "show",
    "measures",
    "study",
    "mismatch",
    "report",
    "convert",
    "ropes",
    "effects",
    "view",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_an_example(command, capsys):
    assert call(command, "--help") == 0
    said = capsys.readouterr().out
    assert f"Usage: anet-lumped {command}" in said
    assert "Example: anet-lumped" in said or command == "measures"


def test_a_run_tells_what_speaks_against_it(capsys):
    assert call("simulate", "loose_cable", "--t-end", 1.2, "--start", "straight", "--method", "backward_euler", "--dt", 0.01) == 0
    assert "warning: backward_euler: 0.33 of the energy in play were lost in its steps" in capsys.readouterr().out


@pytest.mark.parametrize(
    "words, more", [(["--help"], ["pydantic", "integrators"]), (["simulate", "net_held", "--t-ende", "3"], [])]
)
def test_help_and_a_misspelt_option_load_nothing_heavy(words, more):
    heavy = [*"numpy numba scipy pandas matplotlib jinja2 xarray jax anet_lumped".split(), *more]
    code = (
        "import sys; from studies.command_line import main\n"
        f"try: main({words})\n"
        f"except SystemExit: print('LOADED', [name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=Path(__file__).parents[2])
    assert done.stdout.endswith("LOADED []\n"), done.stdout + done.stderr


def test_equilibrium_loads_no_tables_and_no_plots(tmp_path):
    heavy = "pandas matplotlib xarray jax jinja2".split()
    code = (
        "import sys; from studies.command_line import main\n"
        "try: main(['equilibrium', 'net_held'])\n"
        f"except SystemExit as end: print('LOADED', end.code, [name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=Path(__file__).parents[2])
    assert done.stdout.endswith("LOADED 0 []\n"), done.stdout + done.stderr


def test_equilibrium_prints_tables_and_writes_its_numbers(tmp_path, capsys):
    assert call("equilibrium", "net_held", "--out", tmp_path) == 0
    said = capsys.readouterr().out
    assert "sag [m]" in said and "s0-p0" in said and "segment tension [N]" in said
    found = json.loads((tmp_path / "equilibrium.json").read_text())
    assert len(found["cables"]) == 4 and found["residual"] < 1e-9
    with (tmp_path / "nodes.csv").open() as file:
        nodes = list(csv.DictReader(file))
    assert len(nodes) == 4 * 21
    assert float(nodes[20]["z"]) == found["points"][0]["z"]


def test_the_largest_tension_is_that_of_segments_in_tables_as_in_sweeps(capsys):
    """At its start a cable pulls with half a segment more, which the table tells apart."""
    assert call("equilibrium", "net_held", "--json") == 0
    row = json.loads(capsys.readouterr().out)["cables"][0]
    rest = equilibrium(load_scene("net_held"))
    assert row["segment_tension"] == rest.tension("s0-p0").max() == MEASURES["tension"].function(rest, "s0-p0")
    assert row["start_tension"] == pytest.approx(rest.end_tension("s0-p0", "s0"), rel=1e-12)
    assert row["start_tension"] > row["segment_tension"]
    assert call("simulate", "net_carried", "--t-end", 0.5, "--dt", 0.01, "--json") == 0
    row = json.loads(capsys.readouterr().out)["cables"][0]
    run = simulate(load_scene("net_carried"), 0.5, dt=0.01)
    assert row["peak_segment_tension"] == run.peak_tension("s0-p0") < row["peak_start_tension"]


def test_simulate_says_what_ran_and_saves_it(tmp_path, capsys):
    assert call("simulate", "net_carried", "--t-end", 0.2, "--method", "edmc", "--dt", 0.01, "--out", tmp_path) == 0
    assert "method: edmc" in capsys.readouterr().out
    assert json.loads((tmp_path / "run.json").read_text())["status"] == "done"
    assert (tmp_path / "run.nc").exists() and (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_simulate_tells_what_happened(tmp_path, capsys):
    file = tmp_path / "scene.toml"
    file.write_text("""
        points = [{name = "a", kind = "fixed", at = [0, 0, 0]}, {name = "b", kind = "free", mass = 0.1}]
        effects = {gravity = {g = 9.81}}
        events = [{kind = "payload_change", point = "b", t = 0.1, mass = 1.0}]
        [[cables]]
        start = "a"
        end = "b"
        length = 1.0
        mass_per_length = 0.1
        EA = 1e4
        zeta = 0.3
        segments = 5
        breaking_tension = 8.0
    """)
    assert call("simulate", file, "--t-end", 0.3, "--out", tmp_path / "run") == 0
    said = capsys.readouterr().out
    assert "payload changed" in said and "broke" in said
    happened = json.loads((tmp_path / "run" / "run.json").read_text())["events"]
    assert [(event["event"], event["where"]) for event in happened[:2]] == [("payload changed", "b"), ("broke", "a-b")]
    assert happened[0]["t_s"] == 0.1 and 0.1 < happened[1]["t_s"] < 0.15 and happened[1]["tension"] == pytest.approx(8.0, rel=1e-6)
    assert (tmp_path / "run" / "run.png").stat().st_size > 1000


def test_an_audit_that_fails_is_in_the_status_the_files_and_the_exit_status(tmp_path, capsys):

    loose = ["simulate", "loose_cable", "--start", "straight", "--method", "edmc", "--audit", "--out", tmp_path]
    assert call(*loose, "--t-end", 2.5, "--dt", 0.02) == 1
    said = capsys.readouterr().out
    assert "status: audit failed" in said and "message: The audit failed: " in said and "error [m]" in said
    found = json.loads((tmp_path / "run.json").read_text())
    assert found["status"] == "audit failed" and not found["audit"][0]["passed"]
    back = load_run(tmp_path / "run.nc")
    assert not back.ok and back.audit.error == found["audit"][0]["error_m"] > back.audit.allowed
    assert back.message == found["message"] and not back.audit.passed
    assert call(*loose, "--t-end", 0.3, "--dt", 0.002) == 0
    said = capsys.readouterr().out
    assert "status: done" in said and "error [m]" in said and "True" in said
    assert load_run(tmp_path / "run.nc").audit.passed


def test_energy_out_of_nothing_exits_with_1(capsys):
    assert call("simulate", "loose_cable", "--start", "straight", "--t-end", 2, "--method", "midpoint", "--dt", 0.01) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "status: energy gained" in said and 'try method="edmc"' in said


SAVING = {
    ("equilibrium", "net_held"): ["equilibrium.json", "nodes.csv", "rest.png"],
    ("simulate", "net_carried", "--t-end", "20ms"): ["run.json", "run.nc", "run.png"],
    ("mismatch", "net_held"): ["mismatch.json", "mismatch.png"],
    ("sweep", "net_held", "--vary", "segments=5"): ["meta.json", "rows.csv", "rows.jsonl", "rows.parquet", "sweep.png"],
}


@pytest.mark.parametrize(
    ("how", "command"),
    [
        *(pytest.param("closed", command, marks=pytest.mark.slow) for command in SAVING),
        ("full", ("equilibrium", "net_held")),
    ],
    ids=lambda given: given if isinstance(given, str) else given[0],
)
def test_what_is_not_printed_is_saved_all_the_same(how, command, tmp_path):
    """On a pipe that nobody reads, and on a device that is full. Python is told to write at once, as to a screen."""
    if how == "full":
        stdout = open("/dev/full", "w") if Path("/dev/full").exists() else pytest.skip("no device that is full")
    else:
        reading, writing = os.pipe()
        os.close(reading)
        stdout = open(writing, "w")
    with stdout:
        call = [sys.executable, "-u", *PROGRAM, *command, "--out", str(tmp_path)]
        ended = subprocess.run(call, stdout=stdout, stderr=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2])
    assert ended.returncode == 1 and "Traceback" not in ended.stderr
    assert sorted(file.name for file in tmp_path.iterdir()) == SAVING[command]
    if how == "full":
        assert "What is printed could not be written: No space left on device." in ended.stderr


@pytest.mark.parametrize("command", ["equilibrium", "simulate", "effects", "sweep", "mismatch", "study", "report"])
def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_computed(command, tmp_path, capsys):
    (tmp_path / "taken").write_text("a file")
    needed = {"simulate": ["--t-end", "1"], "sweep": ["--vary", "EA=1"], "study": ["order"], "report": []}
    what = [] if command in ("study", "report") else ["net_held"]
    assert call(command, *what, *needed.get(command, []), "--out", tmp_path / "taken") == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "Invalid value for '--out': must be a folder that can be written, but" in said and "File exists" in said


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder that nobody can write")
def test_a_folder_that_is_there_and_cannot_be_written_is_refused(capsys):
    assert call("equilibrium", "net_held", "--out", "/proc/self") == 2
    assert "must be a folder that can be written" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("texts", "quantity", "value"),
    [
        (["10ms", "0.01", " 10 ms ", "1e-2s"], seconds, 0.01),
        (["2min", "120"], seconds, 120.0),
        (["24mm", "0.024", "2.4 cm", "24000um"], metres, 0.024),
        (["2kN", "2000", "2000 N"], newtons, 2000.0),
    ],
)
def test_quantities_take_units(texts, quantity, value):
    assert [quantity(text) for text in texts] == pytest.approx([value] * len(texts), rel=1e-15)


@pytest.mark.parametrize(("text", "quantity"), [("10mm", seconds), ("10s", metres), ("1m", newtons), ("ms", seconds), ("", metres)])
def test_a_quantity_of_another_kind_is_refused(text, quantity):
    with pytest.raises(typer.BadParameter, match=f'must be a (time|length|force) such as .*, but it is "{text}"'):
        quantity(text)


def test_every_option_that_is_a_quantity_takes_a_unit():
    """A float without a parser is a pure number."""
    options = {
        option.name: option.annotation
        for command in command_line.app.registered_commands
        for option in inspect.signature(command.callback).parameters.values()
    }
    floats = {name: kind for name, kind in options.items() if typing.get_args(kind)[0] in (float, float | None)}
    assert {name for name, kind in floats.items() if kind.__metadata__[0].parser is None} == {"rtol", "realtime", "tension_error"}
    assert {"t_end", "dt", "save_every", "diameter", "water_level"} < set(floats)


def test_a_run_that_fails_says_so_and_exits_with_1(capsys):
    assert call("simulate", "net_carried", "--t-end", 1, "--method", "verlet", "--dt", 0.01, "--json") == 1
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert found["status"] == "diverged" and found["message"]
    assert "warning: " in said.err and "dt=0.01" in said.err


def test_check_compares_before_any_run(capsys):
    assert call("check", "net_held", "--dt", 0.01, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    methods = {row["method"]: row for row in found["methods"]}
    assert methods["edmc"]["stable"] == "yes" and methods["edmc"]["largest_step"] is None
    assert methods["rk4"]["stable"] == "no" and 1e-4 < methods["rk4"]["largest_step"] < 1e-3
    assert methods["rk4"]["stretch_floor"] > 0.01
    unstable = [name for name, row in methods.items() if row["stable"] == "no"]
    (line,) = found["warning"]
    assert line.startswith(f"A step of 0.01 s is beyond the largest stable step of {', '.join(unstable)}; ") and "rk4" in unstable
    assert found["stretch_floor_is"].startswith("smallest stretch at rest")
    assert {row["cable"] for row in found["cables"]} == {f"s{i}-p0" for i in range(4)}
    assert call("check", "net_held") == 0
    assert "stretch floor" not in capsys.readouterr().out


def test_check_warns_of_soft_cables_and_of_scenes_without_rest(tmp_path, capsys):
    from anet_lumped.files.scene_file import load_scene, save_scene
    from studies.sweeping.vary import apply

    net = load_scene("net_held")
    save_scene(apply(net, {"EA": 5.0})[0], tmp_path / "soft.toml")
    save_scene(apply(net, {"g": 0.0})[0], tmp_path / "weightless.toml")
    assert call("check", tmp_path / "soft.toml") == 0
    assert "longer at rest than unstretched, more than 1%: EA = 5 N carries" in capsys.readouterr().out
    assert call("check", tmp_path / "weightless.toml") == 0
    assert "No static stretch, and so no stretch floor, is known: " in capsys.readouterr().out


def test_mismatch_compares_with_the_catenary(tmp_path, capsys):
    assert call("mismatch", "net_held", "--out", tmp_path) == 0
    assert "rmse [m]" in capsys.readouterr().out
    assert all(row["rmse"] < 0.1 for row in json.loads((tmp_path / "mismatch.json").read_text())["cables"])


def test_mismatch_with_markers_fits_them(tmp_path, capsys):
    assert call("equilibrium", "net_held", "--out", tmp_path) == 0
    assert call("mismatch", "net_held", "--markers", tmp_path / "nodes.csv", "--json") == 0
    found = json.loads(capsys.readouterr().out.partition("residual")[2].partition("\n")[2])
    assert found["unit"] == "m" and found["markers"] == 84 and found["outliers"] == 0
    assert all(row["rmse_after"] < 1e-4 for row in found["cables"])


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        (["check", "net_hel"], 'There is no scene and no file "net_hel", did you mean "net_held"?'),
        (["check", "qqqq"], "the scenes that come with this are loose_cable, mooring, net_carried"),
        (["check", "nowhere.toml"], "A scene file must be readable, but nowhere.toml"),
        (["sweep", "net_held", "--vary", "Ea=1"], "Nothing called `Ea` can be varied here, did you mean `EA`?"),
        (["sweep", "net_held", "--vary", "EA=1:2"], "A range must be a:b:n"),
        (["sweep", "net_held", "--vary", "EA=1", "--measure", "sagg"], "did you mean `sag`?"),
        (["simulate", "net_held", "--t-end", "-1"], "t_end"),
        (["simulate", "net_held", "--t-end", "1", "--method", "edcm"], "edmc"),
        (["simulate", "net_held"], "Missing option '--t-end'"),
        (["simulate", "net_held", "--t-end", "4m"], 'must be a time such as 10ms, 0.01s or 0.01, but it is "4m"'),
        (["convert", "net_held", "nowhere/net.toml"], "A scene must be written to a folder that is there, but nowhere is none."),
        (["study", "ordr"], 'There is no study "ordr", did you mean "order"?'),
        (["mismatch", "net_held", "--markers", "nowhere.csv"], "nowhere.csv"),
        (["land"], "No such command 'land'"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_2(arguments, sentence, capsys):
    assert call(*arguments) == 2
    said = capsys.readouterr()
    assert sentence in said.err and said.out == ""


def test_what_an_effect_lacks_is_told_with_the_file(tmp_path, capsys):
    scene = tmp_path / "windy.toml"
    scene.write_text((SCENES / "net_held.toml").read_text() + "\n[effects.air]\n")
    assert call("equilibrium", scene) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"anet-lumped: {scene}: ") and "`diameter`" in said


def test_a_rest_that_is_not_found_is_one_sentence_and_exit_1(monkeypatch, capsys):
    """What a scene cannot have is a wrong input and exits with 2, see `test_hostile_commands`."""
    monkeypatch.setattr("anet_lumped.statics.hanging_chains.solve", lambda *arguments: (1.0, 1.0, 0.0, 7))
    assert call("equilibrium", "net_held") == 1
    assert "No equilibrium was found in 7 iterations" in capsys.readouterr().err


def test_no_rest_is_one_sentence_and_exit_2(tmp_path, capsys):
    from anet_lumped.files.scene_file import load_scene, save_scene
    from studies.sweeping.vary import apply

    net = load_scene("net_held")
    save_scene(apply(net, {"g": 0.0})[0], tmp_path / "weightless.toml")
    assert call("equilibrium", tmp_path / "weightless.toml") == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_each_command_says_how_long_its_own_compiling_takes(monkeypatch, capsys):
    monkeypatch.setattr(NOTICE, "_line", None)
    monkeypatch.setattr(NOTICE, "tell", None)
    assert call("ropes", "--help") == 0 and call("fly", "no_scene") == 2
    capsys.readouterr()
    NOTICE.give()
    assert "up to about 50 s" in capsys.readouterr().err


def test_every_command_that_takes_a_scene_changes_it_first(tmp_path, capsys):
    """A net with p0 as heavy as its cables hangs lower; the recommended command has the change in it."""

    def said(*words):
        assert call(*words) == 0
        return capsys.readouterr().out

    change = ("--set", "p0.mass=0.4")
    for words in (("equilibrium", "net_held"), ("check", "net_held"), ("mismatch", "net_held")):
        assert said(*words, "--json", *change) != said(*words, "--json")
    assert said("convert", "net_held", tmp_path / "net.toml", *change) and "mass = 0.4" in (tmp_path / "net.toml").read_text()
    swept = ("sweep", "net_held", "--vary", "segments=5", "--measure", "height:p0", "--out", tmp_path, "--json")
    table = json.loads(said(*swept, *change))
    (point,) = json.loads(said("equilibrium", "net_held", "--set", "segments=5", "--json", *change))["points"]
    assert table["rows"][0]["height:p0"] == pytest.approx(point["z"], abs=1e-9)
    recommended = said("recommend", "net_carried", "--error", "5mm", "--t-end", 1, *change, "--set", "segments=30")
    assert re.search(r"command: .* --set p0.mass=0.4 --set segments=\d+\n", recommended)
    assert call("convert", OLD_RUN, tmp_path / "run.pvd", *change) == 2
    assert "A saved run is written as it is; --set and --effect change a scene, but" in capsys.readouterr().err
