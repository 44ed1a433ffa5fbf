"""Measures over time: of a point whose path is known, and of a weight that falls into its cable, in closed form."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, Scene, simulate, working_curves
from anet_lumped.effects import Gravity
from anet_lumped.prescribed import paths
from studies.sweeping import over_time
from studies.sweeping.measures import MEASURES, Measure, Source, Target, read_measure
from studies.sweeping.sweep import sweep
from studies.sweeping.vary import VaryError

G, K, M, DROP, END = 9.81, 1e4, 1.0, 0.5, 1.2
AMPLITUDE, FREQUENCY = 0.05, 10.0


@pytest.fixture(scope="module")
def falling():
    """A weight on one segment of next to no mass, let go `DROP` above where it is taut; and a shaken one that is taut."""
    cables = [
        Cable("top", "bob", length=1.0, mass_per_length=1e-9, EA=K, segments=1),
        Cable("shaken", "load", length=1.0, mass_per_length=1e-9, EA=100.0, segments=1),
    ]
    shaken = Driven("shaken", paths.harmonic((3.0, 0.0, 0.0), (0.0, 0.0, AMPLITUDE), FREQUENCY))
    points = [Fixed("top", (0, 0, 0)), Free("bob", mass=M, at=(0, 0, DROP - 1.0)), shaken, Free("load", mass=M, at=(3.0, 0, -1.1))]
    return Scene(points, cables, [Gravity(G)])


@pytest.fixture(scope="module")
def run(falling):
    return simulate(falling, END, method="verlet", dt=1e-4, save_every=1e-3, start="straight")


def measured(run, text, since=None):
    measure, target = read_measure(text, run.scene)
    return measure.function(run, *target, since)


def test_statistics_of_a_sinusoid(run):
    """Over whole periods, of which 100 samples each leave the sums of squares exact and the largest value within 0.05 %."""
    for since in (None, 0.5):
        assert measured(run, "mean_height:shaken", since) == pytest.approx(0.0, abs=1e-12)
        assert measured(run, "deviation_height:shaken", since) == pytest.approx(AMPLITUDE / math.sqrt(2.0), rel=1e-9)
        assert measured(run, "range_height:shaken", since) == pytest.approx(2 * AMPLITUDE, rel=2e-3)
        assert measured(run, "least_height:shaken", since) == pytest.approx(-AMPLITUDE, rel=1e-4)
        assert measured(run, "peak_height:shaken", since) == pytest.approx(AMPLITUDE, rel=1e-4)
    assert measured(run, "deviation_x:shaken") == 0.0


def test_uneven_times_weigh_as_long_as_they_last():
    t, x = np.array([0.0, 0.1, 0.2, 1.2]), np.array([[0.0], [0.0], [1.0], [1.0]])
    assert over_time.mean(t, x) == pytest.approx(1.05 / 1.2, rel=1e-15)  # the trapezoidal rule
    assert over_time.deviation(t, x) == pytest.approx(math.sqrt(1.05 * 0.15) / 1.2, rel=1e-12)


def test_the_mean_tension_of_a_weight_that_swings_up_and_down(run):
    """m g plus the mean of m a, which is the change of velocity over the time: what impulse and momentum say."""
    z = run.velocity("load")[:, 2]
    for since, first in ((None, 0), (0.4, 400)):
        impulse = M * (z[-1] - z[first]) / (END - run.t[first])
        assert measured(run, "mean_tension:shaken-load", since) == pytest.approx(M * G + impulse, rel=1e-4)
        ends = measured(run, "mean_tension:load", since), measured(run, "mean_tension:shaken-load", since)
        assert ends[0] == pytest.approx(ends[1], rel=1e-6)  # a cable of no mass
    assert measured(run, "least_tension") == 0.0 and measured(run, "least_tension:shaken-load") > 0.0


def test_slack_times_and_snaps_are_those_of_the_fall(run):
    fall, omega = math.sqrt(2 * DROP / G), math.sqrt(K / M)
    taut = (math.pi + 2 * math.atan(G / omega**2 * omega / math.sqrt(2 * G * DROP))) / omega
    assert 3 * fall + 2 * taut < END
    assert measured(run, "slack_time:top-bob") == pytest.approx(END - 2 * taut, abs=4e-3)  # saved every millisecond
    assert measured(run, "slack_time", since=0.5) == pytest.approx(0.7 - taut, abs=2e-3)
    assert measured(run, "slack_time:shaken-load") == 0.0
    assert [measured(run, text, since) for text in ("snaps", "snaps:top-bob") for since in (None, 0.5)] == [2, 1, 2, 1]
    assert measured(run, "snaps:shaken-load") == 0


def test_the_largest_displacement_is_from_where_it_started(run):
    assert measured(run, "peak_displacement:bob") == pytest.approx(DROP + math.sqrt(2 * G * DROP * M / K), rel=1e-2)
    begin, z = 1.1, run.position("bob")[:, 2]  # on its way up
    assert measured(run, "peak_displacement:bob", begin) == pytest.approx(DROP - 1.0 - z[1100], rel=1e-12)


def test_peaks_look_at_the_same_part(run):
    snap = max(run.snaps, key=lambda snap: snap.t)
    assert measured(run, "peak_tension:top-bob", since=snap.t + 0.1) == 0.0
    assert measured(run, "peak_tension:top-bob") == run.peak_tension() >= run.tension("top-bob").max()


def raise_an_error(run):
    raise ValueError("no number")


def test_a_sweep_looks_from_a_time_on_and_a_measure_that_fails_leaves_the_others(falling, tmp_path, monkeypatch):
    monkeypatch.setitem(MEASURES, "broken", Measure(raise_an_error, Source.RUN, Target.NONE, "-", "what cannot be measured"))
    asked = ["peak_height:shaken", "broken", "peak_tension"]
    settings = {"t_end": 0.05, "method": "verlet", "dt": 1e-4, "start": "straight"}
    with ThreadPoolExecutor(1) as executor:
        table = sweep(falling, {"bob.mass": "1,2"}, asked, **settings, since=0.03, executor=executor, out=tmp_path)
    assert table["status"].tolist() == ["failed", "failed"] and table["peak_height:shaken"].notna().all()
    assert table["reason"][0] == "measure broken: ValueError: no number"
    falls = AMPLITUDE * math.sin(2 * math.pi * FREQUENCY * 0.03)  # the peak of the period is over by then
    assert table["peak_height:shaken"].tolist() == pytest.approx([falls] * 2, rel=1e-9)
    assert table["peak_tension"].notna().all()


def test_a_run_that_ends_before_says_so(run):
    with pytest.raises(over_time.WindowError, match=r"must have two saved times from t=1.2 s on, but it ends at t=1.2 s"):
        measured(run, "mean_height:shaken", since=1.2)


@pytest.mark.parametrize(
    "asked, since, message",
    [
        (["steps"], 0.1, r"`since` \[s\] is for measures over time, but none was asked for; they are peak_stretch, least_tension"),
        (["snaps"], 0.5, r"`since` \[s\] must be before the end of every run, but it is 0.5 and one ends at 0.2"),
    ],
)
def test_a_time_that_no_measure_or_run_has_is_refused(falling, asked, since, message):
    with pytest.raises(VaryError, match=message):
        sweep(falling, {"t_end": [1.0, 0.2]}, asked, since=since)


def test_largest_tensions_held_from_a_time_on():
    """A rope with a working curve; its largest tensions go with the other states."""
    rope = Cable(
        "a", "b", length=1.0, mass_per_length=1.0, segments=2, tension_strain=[(0.1, 1e4)], EA_dynamic=3e5, BA_creep=1e5,
        working_curve=working_curves.Linear(permanent=0.1),
    )  # fmt: skip
    run = simulate(
        Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0, 0, -1.05))], [rope], [Gravity(G)]), t_end=0.1, dt=0.01, method="edmc"
    )
    late = over_time.window(run, 0.05)
    assert np.array_equal(late.T_max, run.T_max[-len(late.t) :]) and 2 <= len(late.t) < len(run.t)
