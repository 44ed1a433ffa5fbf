"""The command `mismatch` with tensions and tracks over time."""

import json

import numpy as np
import pytest
from program import call

from anet_lumped import equilibrium, load_scene, simulate

CLOCK, FROM = 40.0, 0.15  # [s] of the first sample: on the clock of the measurement, and in the run


@pytest.fixture
def measured(tmp_path):
    """Files of tensions and of tracks of the carried net, with 3 % more tension and noise of 2 mm and 0.02 N."""
    run = simulate(load_scene("net_carried"), 2.0, dt=5e-3, save_every=5e-3)
    t, noise = np.arange(0.0, 1.6, 0.01), np.random.default_rng(1).standard_normal
    pulls = np.interp(t + FROM, run.t, run.end_tension("s0-p0", "p0"))
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
    (said,) = (text for text in found["warning"] if "measured" in text)
    assert said.startswith(f"The last {found['shift_s']:.3g} s that were measured are after the run, which ends at t = 1.59 s, and")
    assert found["compared_s"] == pytest.approx(1.59 - found["shift_s"], abs=0.01)  # of a sample's interval
    (tension,), (marker,) = found["tensions"], found["markers"]
    assert tension["name"] == "s0-p0" and 0.015 < tension["rmse_N"] < 0.035
    assert marker["rmse_m"] == pytest.approx(2e-3 * np.sqrt(3.0), rel=0.15)  # of three noises; 160 samples
    assert (measured / "mismatch.png").stat().st_size > 10_000


def test_an_export_of_motive_over_time_and_of_one_shape(measured, capsys):
    """The track of p0 as Motive has it, y up, beside a marker of another name; then markers of a net that hangs still."""
    with np.load(measured / "track.npz") as track:
        t, (x, y, z) = track["t"], track["p0"].T
    heads = ["Format Version,1.23,Length Units,Meters", ",Type" + ",Marker" * 6, ",Name,Net:p0,Net:p0,Net:p0,Lamp,Lamp,Lamp"]
    heads += [",," + ",".join(["Position"] * 6), "Frame,Time (Seconds),X,Y,Z,X,Y,Z"]
    rows = [f"{k},{t[k]:.6f},{x[k]:.6f},{z[k]:.6f},{-y[k]:.6f},9,9,9" for k in range(len(t))]
    (measured / "take.csv").write_text("\n".join(heads + rows) + "\n", encoding="utf-8")
    assert call("mismatch", "net_carried", "--markers", measured / "take.csv", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["left_out"] == "Lamp" and found["markers"][0]["rmse_m"] == pytest.approx(2e-3 * np.sqrt(3.0), rel=0.15)

    shape = equilibrium(load_scene("net_held")).shape("s0-p0")[1:-1]
    names = [f"Net:{k}" for k in range(len(shape))]
    heads[1:4] = [line + ",".join(each for each in words for _ in "xyz") for line, words in (
        (",Type,", ["Marker"] * len(shape)), (",Name,", names), (",,", ["Position"] * len(shape)))]  # fmt: skip
    heads[4] = "Frame,Time (Seconds)" + ",X,Y,Z" * len(shape)
    rows = [f"{k},{k / 100}," + ",".join(f"{x:.6f},{z:.6f},{-y:.6f}" for x, y, z in shape) for k in range(3)]
    (measured / "still.csv").write_text("\n".join(heads + rows) + "\n", encoding="utf-8")
    assert call("mismatch", "net_held", "--markers", measured / "still.csv", "--out", measured / "still", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["markers"] == len(shape) and found["farthest_markers"][0]["distance_mm"] < 0.01
    assert load_scene(measured / "still" / "fitted.toml").cable("s0-p0").length == pytest.approx(1.0, abs=1e-4)
    assert len((measured / "still" / "markers.csv").read_text().splitlines()) == len(shape) + 1
    assert (measured / "still" / "mismatch.png").stat().st_size > 10_000


def test_a_given_shift_and_one_without_a_motion(measured, capsys):
    assert call("mismatch", "net_carried", "--markers", measured / "track.npz", "--shift", "150ms") == 0
    said = capsys.readouterr().out
    assert "shift is: given" in said and "not compared" not in said
    assert call("mismatch", "net_carried", "--markers", measured / "track.npz", "--shift=-150ms") == 0
    assert "The first 0.15 s that were measured are before the run and are not compared" in capsys.readouterr().out
    assert call("mismatch", "net_held", "--shift", "150ms") == 2
    assert "A --shift is for a motion, but neither tensions nor tracks over time are given." in capsys.readouterr().err


def test_a_tension_of_no_cable_is_one_sentence(measured, capsys):
    assert call("mismatch", "loose_cable", "--tension", measured / "tension.csv") == 2
    assert 'none called "s0-p0"' in capsys.readouterr().err


def write_track(folder, t, name, places):
    table = np.column_stack([t, places])
    np.savetxt(folder / "track.csv", table, delimiter=",", header=f"t,{name}.x,{name}.y,{name}.z", comments="")
    return folder / "track.csv"


def test_a_track_in_millimetres_is_warned_of(measured, capsys):
    with np.load(measured / "track.npz") as track:
        file = write_track(measured, track["t"], "p0", 1e3 * track["p0"])
    assert call("mismatch", "net_carried", "--markers", file, "--json") == 0
    warning = " ".join(json.loads(capsys.readouterr().out)["warning"])
    assert 'Marker "p0" is ' in warning and "times the longest cable: places must be in m, along the axes of the scene" in warning


def test_a_track_that_began_too_late_is_warned_of(measured, capsys):
    """The run moves 2.4 s before the recording does, of 1.6 s: the largest shift that is tried, 0.4 s, is the best of them."""
    run = simulate(load_scene("net_carried"), 4.0, dt=5e-3, save_every=5e-3)
    t = np.arange(0.0, 1.6, 0.01)
    file = write_track(measured, t, "p0", np.column_stack([np.interp(t + 2.4, run.t, axis) for axis in run.position("p0").T]))
    assert call("mismatch", "net_carried", "--markers", file, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["shift_s"] == pytest.approx(0.4, abs=0.01)
    assert any("The shift found is the largest that is tried" in warning for warning in found["warning"])


def test_a_track_that_stands_still_tells_no_shift_and_no_peak(measured, capsys):
    file = write_track(measured, np.arange(0.0, 1.6, 0.01), "p0", np.tile([0.1, 0.2, -0.6], (160, 1)))
    assert call("mismatch", "net_carried", "--markers", file, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["markers"][0]["peak_error_percent"] is None
    assert any("hardly tells the shift" in warning for warning in found["warning"])


def test_a_track_of_another_name_says_that_it_is_taken_for_a_shape(measured, capsys):
    file = write_track(measured, np.arange(0.0, 1.6, 0.01), "bottle", np.tile([0.1, 0.2, -0.6], (160, 1)))
    assert call("mismatch", "net_carried", "--markers", file) == 2
    said = capsys.readouterr().err
    assert 'No track, as "bottle", has the name of a point or of a place on a cable, "CABLE@ARC"' in said and said.count("\n") == 1
