"""Slack and snaps: a weight that falls into its cable and bounces, in closed form."""

import math

import pytest

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity

G, K, M, DROP = 9.81, 1e4, 1.0, 0.5


@pytest.fixture(scope="module")
def bounce():
    """A weight on one segment of next to no mass, let go `DROP` above where the segment is taut."""
    cable = Cable("top", "bob", length=1.0, mass_per_length=1e-9, EA=K, segments=1)
    scene = Scene([Fixed("top", (0, 0, 0)), Free("bob", mass=M, at=(0, 0, DROP - 1.0))], [cable], [Gravity(G)])
    return simulate(scene, 1.2, method="verlet", dt=1e-4, save_every=1e-3, start="straight")


def test_slack_until_it_has_fallen(bounce):
    fall = math.sqrt(2 * DROP / G)
    first, second, *_ = bounce.slack
    assert (first.cable, first.start, first.ends_with_run) == ("top-bob", 0.0, False)
    assert first.end == pytest.approx(fall, abs=1.5e-3)  # saved every millisecond
    speed, omega = math.sqrt(2 * G * DROP), math.sqrt(K / M)
    rest = G / omega**2
    taut = (math.pi + 2 * math.atan(rest * omega / speed)) / omega  # of the sinusoid about the rest, from no stretch to none
    assert second.start == pytest.approx(fall + taut, abs=2e-3)
    assert second.end - second.start == pytest.approx(2 * fall, abs=3e-3)


def test_a_snap_has_the_tension_that_its_energy_gives(bounce):
    weight = M * G
    peak = weight + math.sqrt(weight**2 + 2 * G * DROP * K * M)
    assert [snap.cable for snap in bounce.snaps] == ["top-bob"] * len(bounce.snaps) and len(bounce.snaps) == 2
    for snap in bounce.snaps:
        assert snap.tension == pytest.approx(peak, rel=2e-3) and snap.segment == 0  # half a millisecond beside the peak
    in_time = sorted(bounce.snaps, key=lambda snap: snap.t)
    assert in_time[1].slack_for == pytest.approx(2 * math.sqrt(2 * DROP / G), abs=4e-3)


def test_a_cable_that_is_slack_at_the_end_says_so(bounce):
    assert bounce.slack[-1].ends_with_run == (bounce.t[-1] - bounce.slack[-1].end < 1e-9)


def test_what_is_taut_has_neither():
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))],
        [Cable("a", "b", length=1.1, mass_per_length=0.1, EA=1e4, segments=4)],
        [Gravity(G)],
    )
    run = simulate(scene, 0.05, method="verlet", dt=1e-5, save_every=0.01)
    assert run.slack == [] and run.snaps == []
