"""Nodes that fly: which do, what their flight makes of the error of a velocity, and what runs tell of it beside finer ones."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, Scene, State, equilibrium, paths, simulate
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.model.build import build
from anet_lumped.results.free_flight import MULTIPLIED, first_loose, flight_errors, goes_loose, loose
from anet_lumped.results.node_pass import OF_SECOND_DIFFERENCE
from anet_lumped.results.state import segment_tensions
from studies.catalogue.random_motions import random_motion

G = 9.81


def hanging(segments=4, compression="none", more=()):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=segments, compression=compression)
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.1)], [cable], [Gravity(G), *more])


def made_up(scene, taut, v):
    """A run at eleven times, 0.1 s apart, with tensions of one newton where segments are taut (11, segments), and velocities."""
    run = simulate(scene, 1.0, method="edmc", dt=0.1)
    assert len(run.t) == 11
    return replace(run, segment_tension=np.where(taut, 1.0, 0.0), v=np.broadcast_to(v, run.v.shape).copy())


def test_a_flight_keeps_what_its_velocity_is_off_by():
    """A jump of 0.2 m/s where the segments beside a node go slack, for four tenths of a second; then they are taut again."""
    scene = hanging()
    taut = np.ones((11, 4), bool)
    taut[4:8, 1:3] = False
    v = np.zeros((11, 1, 1)) + np.where(np.arange(11) < 4, 1.0, 1.2)[:, None, None] * np.array([1.0, 0.0, 0.0])
    run = made_up(scene, taut, v)
    flies = loose(run)
    node = run.model.nodes("a-b")[2]
    assert flies[4:8, node].all() and flies.sum() == 4 and goes_loose(run)
    grown = OF_SECOND_DIFFERENCE * 0.2 * 0.1 * np.array([0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4])
    np.testing.assert_allclose(flight_errors(run), grown, atol=1e-15)


@pytest.mark.parametrize(
    "scene",
    [hanging(segments=1), hanging(compression="linear"), hanging(more=(ViscousDamping(1.0),))],
    ids=["one segment", "segments push", "something slows it"],
)
def test_what_does_not_fly(scene):
    segments = scene.cables[0].segments
    taut = np.ones((11, segments), bool)
    taut[4:8] = False
    run = made_up(scene, taut, np.where(np.arange(11) < 4, 1.0, 2.0)[:, None, None])
    assert not flight_errors(run).any()


def test_what_lies_slack_from_the_start_has_no_error_of_flight():
    run = made_up(hanging(), np.zeros((11, 4), bool), np.linspace(0.0, 1.0, 11)[:, None, None] ** 2)
    assert loose(run).all() and not flight_errors(run).any()


@pytest.mark.parametrize("dt", [0.016, 0.008, 0.004, 0.002])
def test_a_hanging_cable_is_let_go(dt):
    """It contracts and flies; what the steps leave out of places themselves is a fiftieth of the truth."""
    rest = equilibrium(hanging(segments=20))
    scene = replace(hanging(segments=20), points=(Free("a", mass=1.0), Free("b", mass=0.1)))
    model = build(scene)
    q = np.zeros((model.n, 3))
    q[model.nodes("a-b")] = rest.shape("a-b")
    begin = State(model, 0.0, q, 0.0 * q, segment_tensions(model, q, 0.0 * q))
    run = simulate(scene, 0.4, method="edmc", dt=dt, save_every=dt, start=begin)
    fine = simulate(scene, 0.4, method="edmc", dt=dt / 64, save_every=dt, start=begin, extrapolate=True)
    off = np.linalg.norm(run.q - fine.q, axis=2).max()
    assert run.error_growth[-1] < 0.05 * off
    assert 0.25 < run.error_estimate / off < 4.0


@pytest.mark.parametrize("dt", [0.04, 0.02, 0.01])
def test_a_weight_that_the_method_stops(dt):
    """It should fly up again for ever, and lies still at the end of its cable: off by all of its way."""
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-3, EA=1e6, zeta=0.0, segments=1)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1.0, at=(0.0, 0.0, -0.5))], [cable], [Gravity(G)])
    run = simulate(scene, 4.0, method="edmc", dt=dt, start="straight")
    assert run.energy_balance.lost_to_method > 0.99 * run.energy_balance.in_play
    assert run.error_estimate == pytest.approx(0.5, rel=0.02)  # in truth its top and its bottom are half a metre apart


@pytest.mark.parametrize("frequency, most", [(0.1, 2.0), (3.0, 300.0)])
def test_a_weight_below_a_support_that_shakes(frequency, most):
    """It moves along, or stays behind. Sums of what is left out of a motion that goes to and fro are too large there.

    At 3 Hz, six times as fast as it swings, they were more than a thousand times too large when only what moves along was right.
    """
    path = paths.harmonic((0.0, 0.0, 0.0), (0.05, 0.0, 0.0), frequency, ramp=1.0)
    cable = Cable("a", "b", length=1.0, mass_per_length=0.01, EA=1e4, zeta=0.05, segments=1)
    scene = Scene([Driven("a", path), Free("b", mass=0.1, at=(0.0, 0.0, -1.0))], [cable], [Gravity(G)])
    run = simulate(scene, 4.0, method="edmc", dt=0.01, save_every=0.04)
    fine = simulate(scene, 4.0, method="edmc", dt=0.01 / 16, save_every=0.04, extrapolate=True)
    assert 0.5 < run.error_estimate / np.linalg.norm(run.q - fine.q, axis=2).max() < most


def dropped(dt=0.01, t_end=1.0, **options):
    """A cable without dampers, let go from horizontal: it whips."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=10)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", at=(1.0, 0.0, 0.0))], [cable], [Gravity(G)])
    return simulate(scene, t_end, start="straight", method="edmc", dt=dt, **options)


def test_a_run_that_goes_loose_says_that_it_may_multiply_errors():
    """Where it matters: times 50, what a short step leaves out is below a hundredth of the length."""
    run = dropped()
    since = first_loose(run)
    (text,) = [text for text in run.warnings if "multiply errors" in text]
    assert f"loose from t={since:.4g} s on" in text and f"may be up to {MULTIPLIED:g} times what run.error_estimate tells" in text
    assert 4.0 < run.multiplies <= MULTIPLIED and not loose(run)[1 : np.searchsorted(run.t, since)].any()
    assert not any("multiply" in text for text in dropped(dt=5e-5, t_end=0.6).warnings)
    for compared in (dropped(audit=10.0), dropped(extrapolate=True)):
        assert compared.multiplies == 1.0 and not any("multiply" in text for text in compared.warnings)
    held = simulate(hanging(), 1.0, method="edmc", dt=0.1)
    assert held.multiplies == 1.0 and first_loose(held) is None


def test_a_weight_that_two_slack_segments_catch_says_that_it_may_multiply_errors():
    """A sway of a weight between two supports, each with a cable of one segment: it told a 23rd of its error without a word."""
    motion = random_motion(36, 7301)
    step = motion.t_end / 512
    run, fine = (
        simulate(motion.scene, motion.t_end, method="edmc", dt=step / parts, save_every=step, start=motion.start)
        for parts in (1, 16)
    )  # fmt: skip
    off = np.linalg.norm(run.q - fine.q, axis=2).max()
    assert off > 10.0 * run.error_estimate and 1.0 < run.multiplies * run.error_estimate / off < 4.0
    assert all(cable.segments == 1 for cable in motion.scene.cables) and first_loose(run) < 0.5 * motion.t_end


def test_tensions_that_swing_faster_than_saved_states_show_may_multiply_errors():
    """A net whose corners are driven 60 m away: its error of 282 mm is told as 11, and with five times as many states as 300."""
    corners = [(-5.0, -5.0, 0.0), (5.0, -5.0, 0.0), (5.0, 5.0, 0.0), (-5.0, 5.0, 0.0)]
    points = [Driven(f"s{i}", paths.line(at, velocity=(3.0, 0.0, 0.0), ramp=0.1)) for i, at in enumerate(corners)]
    cables = [Cable(f"s{i}", "p0", length=10.0, mass_per_length=0.337, EA=7.8e6, zeta=0.1, segments=20) for i in range(4)]
    scene = Scene([*points, Free("p0", mass=0.036)], cables, [Gravity(G)])
    seldom, often = (simulate(scene, 20.0, method="edmc", dt=3.125e-3, save_every=n * 3.125e-3) for n in (16, 4))
    said = [any("tensions swing faster than saved states show" in text for text in run.warnings) for run in (seldom, often)]
    assert said == [True, False] and seldom.multiplies > 10.0 and often.multiplies == 1.0
    assert often.error_estimate > 10.0 * seldom.error_estimate
