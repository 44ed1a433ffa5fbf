"""The command `fly`: flights of bundled scenes and of a user's own, and what it refuses."""

import json

import pytest
from program import call

from anet_lumped import load_run, load_scene, save_scene


def test_a_bundled_flight_is_saved_as_a_run(tmp_path, capsys):
    assert call("fly", "quadrotor_hover", "--by", "0,50cm,0", "--within", "1s", "--t-end", "3s", "--out", str(tmp_path)) == 0
    printed = capsys.readouterr().out
    assert "status: done" in printed and "bodies at the end" in printed
    run = load_run(tmp_path / "run.nc")
    assert run.t[-1] == pytest.approx(3.0) and run.position("quad0")[-1] == pytest.approx((0.0, 0.5, 0.0), abs=0.03)
    assert {file.name for file in tmp_path.iterdir()} == {"run.nc", "run.json", "run.png"}
    assert json.loads((tmp_path / "run.json").read_text())["status"] == "done"


def test_a_scene_of_ones_own_is_flown(tmp_path, capsys):
    save_scene(load_scene("quadrotors_net"), tmp_path / "mine.toml")
    assert call("fly", str(tmp_path / "mine.toml"), "--t-end", "0.4", "--dt", "20ms", "--save-every", "0.1", "--json") == 0
    assert json.loads(capsys.readouterr().out)["dt"] == 0.02


@pytest.mark.parametrize(
    "words, sentence",
    [
        (("net_held", "--t-end", "1"), "A flight needs a scene with quadrotors, but no body of this one moves freely."),
        (("quadrotors_net", "--controller", "nett"), 'There is no controller "nett", did you mean "net"?'),
        (("quadrotors_net", "--by", "0,1"), 'must be three lengths such as 0,10,0 or 0,50cm,0, but it is "0,1"'),
        (("quadrotors_net", "--dt", "9s"), "Argument `dt` must not exceed t_end=7 s"),
        (("quadrotors_net", "--set", "quad0.mass=2"), 'but body "quad0" of 2 kg has not'),
    ],
)
def test_what_cannot_be_flown_is_one_sentence_and_exit_2(words, sentence, capsys):
    assert call("fly", *words) == 2
    said = capsys.readouterr().err
    assert sentence in said and len(said.strip().splitlines()) == 1


def test_a_flight_is_audited(tmp_path, capsys):
    words = ("fly", "quadrotors_net", "--t-end", "0.4", "--dt", "20ms", "--audit", "--out", str(tmp_path))
    assert call(*words) == 0 and load_run(tmp_path / "run.nc").audit.passed
    assert call("fly", "quadrotors_break", "--t-end", "3", "--dt", "20ms", "--audit") == 1
    assert "audit failed" in capsys.readouterr().out
