"""Commands with a scene that has a rigid body."""

import json

import pytest
from typer.testing import CliRunner

from anet_lumped import Body, Cable, Fixed, Scene, save_scene
from anet_lumped.effects import Gravity
from studies.command_line import app

CORNERS = {"nw": (-0.2, 0.15), "ne": (0.2, 0.15), "se": (0.2, -0.15), "sw": (-0.2, -0.15)}


@pytest.fixture
def file(tmp_path):
    eyes = {name: (x, y, 0.05) for name, (x, y) in CORNERS.items()}
    crate = Body("crate", mass=1.5, inertia=(0.02, 0.03, 0.045), at=(0.0, 0.0, -0.9), attachments=eyes)
    points = [Fixed(name, (2 * x, 2 * y, 0.0)) for name, (x, y) in CORNERS.items()]
    rope = dict(length=0.9, mass_per_length=0.02, EA=1e4, zeta=0.05, segments=4)
    scene = Scene(points, [Cable(name, f"crate.{name}", **rope) for name in CORNERS], [Gravity()], bodies=[crate])
    save_scene(scene, tmp_path / "crate.toml")
    return str(tmp_path / "crate.toml")


def said(*words):
    result = CliRunner().invoke(app, list(words))
    assert result.exit_code == 0, result.output
    return result.stdout


def test_places_and_rotations_are_told(file):
    (body,) = json.loads(said("equilibrium", file, "--json"))["bodies"]
    assert body["body"] == "crate" and abs(body["quaternion_wxyz"][0] - 1.0) < 1e-6 and body["z"] < -0.7
    (body,) = json.loads(said("simulate", file, "--t-end", "0.1", "--json"))["bodies_at_the_end"]
    assert body["body"] == "crate"


def test_numbers_of_a_body_are_varied(file, tmp_path):
    vary = "--vary", "crate.mass=1,2", "--vary", "crate.at.x=0,0.1"
    said("sweep", file, *vary, "--measure", "tension", "--out", str(tmp_path / "s"))
    rows = (tmp_path / "s" / "rows.csv").read_text().splitlines()
    assert len(rows) == 5 and rows[0] == "crate.mass [kg],crate.at.x [m],tension [N],status,reason"


def test_the_catenary_of_each_cable_is_that_between_its_ends_at_rest(file):
    found = json.loads(said("mismatch", file, "--json"))
    assert len(found["cables"]) == 4 and all(abs(cable["rmse"]) < 1e-4 for cable in found["cables"])


def test_it_is_written_for_moordyn(file, tmp_path):
    said("convert", file, str(tmp_path / "crate.txt"))
    assert "BODIES" in (tmp_path / "crate.txt").read_text()


@pytest.mark.parametrize("ending", ["xml", "sdf"])
def test_what_cannot_be_written_is_refused_in_a_sentence(file, tmp_path, ending):
    result = CliRunner().invoke(app, ["convert", file, str(tmp_path / f"crate.{ending}")])
    assert result.exit_code != 0 and "bodies" in str(result.exception)
