"""A run beside measured series: what a shifted, scaled and delayed copy of itself tells."""

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Free, Scene, paths, simulate
from anet_lumped.advice.motion_mismatch import compare_motion
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity
from anet_lumped.files.measured_series import Series


@pytest.fixture(scope="module")
def run():
    """Two cords that carry a payload, their upper ends shaken once."""
    points = [Driven(f"s{i}", paths.line((x, 0, 0), (0.3, 0.0, 0.0), ramp=0.2)) for i, x in enumerate((-0.3, 0.3))]
    cables = [Cable(f"s{i}", "p0", length=0.5, mass_per_length=0.01, EA=1e3, zeta=0.5, segments=4) for i in range(2)]
    scene = Scene([*points, Free("p0", mass=0.05)], cables, [Gravity(9.81)])
    return simulate(scene, 2.0, method="edmc", dt=2e-3, save_every=2e-3)


def copy(run, name, values, lead=0.0, begin=100.0):
    """Series that a clock with another zero measured: the first sample at the run's 0.25 s, plus what it leads the run by."""
    t = np.arange(0.0, 1.5, 4e-3)
    model = np.column_stack([np.interp(t + 0.25 + lead, run.t, column) for column in values.reshape(len(run.t), -1).T])
    return Series(begin + t, {name: model})


def test_the_shift_of_a_copy_is_found(run):
    tensions, tracks = copy(run, "s0-p0", run.end_tension("s0-p0", "p0")), copy(run, "p0", run.position("p0"))
    found = compare_motion(run, tensions, tracks)
    assert (
        found.found and found.sure and found.shift == pytest.approx(0.25, abs=2e-5)
    )  # 1e-4 of a step of 3.7 ms, and straight lines
    (tension,), (marker,) = found.tensions, found.markers
    assert tension.rmse < 1e-4 * tension.measured_peak and marker.rmse < 1e-5
    assert tension.peak_error == pytest.approx(0.0, abs=1e-3) and abs(marker.phase_error) < 1e-4
    t, measured, model = found.curves["p0"]
    assert measured.shape == model.shape == (len(t), 3) and found.overlap == pytest.approx(1.496)


def test_what_is_known_to_differ_is_told(run):
    """10 % more tension, a marker 3 mm to the side, and one that the run is late behind by 20 ms."""
    tensions = Series(*vars(copy(run, "s0-p0", 1.1 * run.end_tension("s0-p0", "p0"))).values())
    off = copy(run, "p0", run.position("p0") + np.array([0.0, 0.003, 0.0]))
    early = copy(run, "s1-p0@0.25", run.shape("s1-p0")[:, 2], lead=0.02)
    found = compare_motion(run, tensions, Series(off.t, off.channels | early.channels), shift=0.25)
    assert not found.found and found.tensions[0].peak_error == pytest.approx(1 / 1.1 - 1, abs=1e-4)
    aside, late = found.markers
    assert aside.rmse == pytest.approx(0.003, abs=1e-6) == aside.largest
    assert late.phase_error == pytest.approx(0.02, abs=1e-4) and aside.phase_error == pytest.approx(0.0, abs=1e-3)


def test_of_a_periodic_motion_the_smallest_shift(run):
    """A sine of 0.25 s fits at every period: the shift is that within half of one."""
    wave = np.column_stack([np.sin(8.0 * np.pi * run.t), 0.0 * run.t, 0.0 * run.t])
    again = type("Run", (), {"t": run.t, "scene": run.scene, "model": run.model, "position": lambda self, name: wave})()
    found = compare_motion(again, tracks=copy(run, "p0", wave, lead=-0.19))  # 0.06 s, and as well -0.19 and 0.31
    assert found.shift == pytest.approx(0.06, abs=1e-3)


def test_missing_samples_are_left_out_and_what_stands_still_has_no_phase(run):
    tracks = copy(run, "s1-p0@0", run.shape("s1-p0")[:, 0])
    still = Series(tracks.t, {"s0-p0": np.full((len(tracks.t), 1), 0.4)})
    still.channels["s0-p0"][5] = np.nan
    found = compare_motion(run, still, tracks, shift=0.25)
    assert found.tensions[0].samples == len(tracks.t) - 1 and np.isnan(found.tensions[0].phase_error)
    assert found.tensions[0].measured_peak == 0.4 and found.markers[0].rmse < 1e-5


@pytest.mark.parametrize(
    "name, sentence",
    [
        ("s0-p1", r'the name of a cable, but the scene has none called "s0-p1", did you mean "s0-p0"'),
        ("s0-p0.middle", r"the name of a cable"),
    ],
)
def test_tensions_of_no_cable(run, name, sentence):
    with pytest.raises(InputError, match=sentence):
        compare_motion(run, copy(run, name, run.end_tension("s0-p0", "p0")))


@pytest.mark.parametrize(
    "name, sentence",
    [
        ("p9", r'the name of a point, or of a cable and an arc .* "p9", did you mean "p0"'),
        ("s0-p0@0.6", "The arc of a marker must be between 0 and 0.5 m"),
        ("s0-p0@1e", "The arc of a marker must be between"),
        ("q-r@0.1", "the name of a point"),
    ],
)
def test_markers_of_nothing(run, name, sentence):
    with pytest.raises(InputError, match=sentence):
        compare_motion(run, tracks=copy(run, name, run.position("p0")))


def test_times_that_do_not_meet(run):
    with pytest.raises(InputError, match=r"must be compared with tensions or with tracks, but neither is given"):
        compare_motion(run)
    long = Series(np.array([0.0, 50.0, 100.0]), {"p0": np.zeros((3, 3))})
    with pytest.raises(InputError, match=r"ends at 2 s, but at no shift does half of them"):
        compare_motion(run, tracks=long)
    with pytest.raises(InputError, match=r'ends at 2 s, but those of "p0" do not'):
        compare_motion(run, tracks=long, shift=10.0)


def test_ends_of_a_cable(run):
    found = compare_motion(run, copy(run, "s0-p0.start", run.end_tension("s0-p0", "s0")), shift=0.25)
    assert found.tensions[0].rmse < 1e-3 * found.tensions[0].measured_peak


def test_noise_tells_no_shift(run):
    """Of noise every shift is as good as another, and a channel that stands still has the shift 0."""
    t, noise = np.arange(0.0, 1.5, 4e-3), np.random.default_rng(0)
    found = compare_motion(run, tracks=Series(t, {"p0": noise.standard_normal((len(t), 3))}))
    assert not found.sure and np.isnan(found.markers[0].phase_error)
    pull = type("Run", (), {"t": run.t, "scene": run.scene, "end_tension": lambda self, name, point: np.full(len(run.t), 0.3)})()
    found = compare_motion(pull, Series(t, {"s0-p0": np.full((len(t), 1), 0.3)}))
    assert found.shift == 0.0 and not found.sure and found.tensions[0].rmse == 0.0
