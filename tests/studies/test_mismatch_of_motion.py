"""The command `mismatch` with tensions and tracks over time."""

import json

import numpy as np
import pytest

from anet_lumped import load_scene, simulate
from studies.command_line import main

CLOCK, FROM = 40.0, 0.15  # [s] of the first sample: on the clock of the measurement, and in the run


def call(*arguments):
    """Exit status of the program, called in this process."""
    with pytest.raises(SystemExit) as ended:
        main(list(map(str, arguments)))
    return ended.value.code


@pytest.fixture
def measured(tmp_path):
    """Files of tensions and of tracks of the carried net, with 3 % more tension and noise of 2 mm and 0.02 N."""
    run = simulate(load_scene("net_carried"), 2.0, dt=5e-3, save_every=5e-3)
    t, noise = np.arange(0.0, 1.6, 0.01), np.random.default_rng(1).standard_normal
    pulls = np.interp(t + FROM, run.t, run.tension("s0-p0")[:, -1])
    places = np.column_stack([np.interp(t + FROM, run.t, axis) for axis in run.position("p0").T]) + 2e-3 * noise((len(t), 3))
    tensions = np.column_stack([CLOCK + t, 1.03 * pulls + 0.02 * noise(len(t))])
    np.savetxt(tmp_path / "tension.csv", tensions, delimiter=",", header="t,s0-p0", comments="")
    np.savez(tmp_path / "track.npz", t=CLOCK + t, p0=places)
    return tmp_path


def test_a_motion_is_compared_and_drawn(measured, capsys):
    files = ["--tension", measured / "tension.csv", "--markers", measured / "track.npz"]
    assert call("mismatch", "net_carried", *files, "--out", measured, "--json") == 0
    found = json.loads((measured / "mismatch.json").read_text())
    assert found["status"] == "done" and found["shift_is"] == "found by least squares"
    assert found["shift_s"] == pytest.approx(FROM, abs=0.01)  # half of a sample's interval and the noise
    (tension,), (marker,) = found["tensions"], found["markers"]
    assert tension["name"] == "s0-p0" and 0.015 < tension["rmse_N"] < 0.035
    assert marker["rmse_m"] == pytest.approx(2e-3 * np.sqrt(3.0), rel=0.15)  # of three noises; 160 samples
    assert (measured / "mismatch.png").stat().st_size > 10_000


def test_a_given_shift_and_one_without_a_motion(measured, capsys):
    assert call("mismatch", "net_carried", "--markers", measured / "track.npz", "--shift", "150ms") == 0
    assert "shift is: given" in capsys.readouterr().out
    assert call("mismatch", "net_held", "--shift", "150ms") == 2
    assert "A --shift is for a motion, but neither tensions nor tracks over time are given." in capsys.readouterr().err


def test_a_tension_of_no_cable_is_one_sentence(measured, capsys):
    assert call("mismatch", "loose_cable", "--tension", measured / "tension.csv") == 2
    assert 'none called "s0-p0"' in capsys.readouterr().err
