"""What the program prints of names with line ends, escape characters and formulas in them, and of input that is wrong."""

import json
import re

import pytest

from anet_lumped import Cable, Fixed, Free, Scene, save_scene
from anet_lumped.checks import LONGEST
from anet_lumped.effects import Gravity
from studies import telling
from studies.command_line import main

STRANGE = "b\x1b[31m\n\u202e$\\frac{$[red]"
SEEN = r"b\x1b[31m\n\u202e$\frac{$[red]"


@pytest.fixture
def scene_file(tmp_path):
    points = [Fixed("a", (0, 0, 0)), Free(STRANGE, mass=0.1, at=(1, 0, 0))]
    cable = Cable("a", STRANGE, length=1.0, mass_per_length=0.1, EA=1e3, segments=2)
    save_scene(Scene(points, [cable], [Gravity()]), tmp_path / "scene.toml")
    return tmp_path / "scene.toml"


def call(*arguments):
    with pytest.raises(SystemExit) as ended:
        main(list(map(str, arguments)))
    return ended.value.code


def test_a_strange_name_is_escaped_in_tables(scene_file, capsys):
    assert call("equilibrium", scene_file) == 0
    said = capsys.readouterr().out
    assert said.replace("\n", "").isprintable() and f"a-{SEEN}" in said
    assert call("equilibrium", scene_file, "--json") == 0
    assert json.loads(capsys.readouterr().out)["cables"][0]["cable"] == f"a-{STRANGE}"


def test_a_strange_name_is_escaped_in_warnings_and_no_formula_of_a_figure(scene_file, tmp_path, capsys):
    """The step is far beyond the stable one, and the message of the run names a node, in red above its picture."""
    out = tmp_path / "run"
    assert (
        call("simulate", scene_file, "--t-end", "1", "--start", "straight", "--method", "verlet", "--dt", "0.2", "--out", out) == 1
    )
    said = capsys.readouterr().err
    assert said.replace("\n", "").isprintable() and SEEN in said
    assert all(len(line) <= 300 for line in said.splitlines()) and (out / "run.png").exists()


@pytest.mark.parametrize("text", ["9" * 10**4 + "x", "1\x1b[31m"])
def test_a_quantity_that_is_none_is_shown_in_short(text, capsys):
    assert call("simulate", "net_held", "--t-end", text) == 2
    said = capsys.readouterr().err
    assert said.replace("\n", "").isprintable() and all(len(line) <= 300 for line in said.splitlines())


def test_what_is_told_is_one_line(scene_file, capsys):
    telling.tell("y" * 1000 + "\x1b\n")
    assert re.fullmatch(r"anet-lumped: y+ \.\.\. y+\\x1b\\n", capsys.readouterr().err.rstrip("\n"))
    scene_file.write_text(scene_file.read_text() + f"\n[{'z' * 10**5}]\n")
    assert call("equilibrium", scene_file) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("anet-lumped: scene.toml: unknown key `zzz") and len(line) <= LONGEST + len("anet-lumped: ") <= 300
