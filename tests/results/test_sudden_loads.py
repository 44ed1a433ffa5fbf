"""Loads that are put on at once, beside the closed forms of what they set off."""

import math

import pytest

from anet_lumped import Cable, Driven, Fixed, Free, PayloadChange, Scene, load_scene, simulate
from anet_lumped.effects import Gravity
from anet_lumped.prescribed import paths
from anet_lumped.results.sudden_loads import sudden_load_tension
from anet_lumped.results.tension_error import lowest_axial_mode

G, L, EA = 9.81, 1.0, 1e5


def hung(segments=1, mass=1.0, mass_per_length=1e-4, BA=None, events=()):
    """A weight at the end of a cable that is not stretched yet."""
    cable = Cable("a", "b", length=L, mass_per_length=mass_per_length, EA=EA, BA=BA, segments=segments)
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=mass, at=(0.0, 0.0, -L))], [cable], [Gravity(G)], events=events)


def run_of(scene, dt, t_end, start="straight", **more):
    return simulate(scene, t_end, method="edmc", dt=dt, save_every=dt, start=start, **more)


def told(run):
    """The largest tension that a run may have had, as it tells it [N]."""
    return float(run.segment_tension.max()) / (1.0 - run.tension_error)


@pytest.mark.parametrize("dt", [3e-3, 0.1])
def test_a_weight_that_is_let_go(dt):
    """omega dt of 1 and 32: the tension goes up to twice the weight, and steps show 1.8 and 1.0 of it."""
    run = run_of(hung(), dt, 50.0 * dt)
    assert run.segment_tension.max() < 1.9 * G
    assert sudden_load_tension(run, lowest_axial_mode) == pytest.approx(2.0 * G, rel=0.03)  # alternating tensions have a mean
    assert told(run) == pytest.approx(2.0 * G, rel=0.03)


def test_a_first_swing_that_is_over_at_the_next_saved_state():
    """A pendulum let go at an angle, unstretched: up to twice m g cos(angle) at first, and less than that in its swing.

    Dampers take half of that vibration before the next state is saved, five of its periods later; steps show nothing of it.
    """
    cable = Cable("a", "b", length=2.0, mass_per_length=0.063, EA=3e6, zeta=0.02, segments=1)
    angle = 0.58
    scene = Scene(
        [Fixed("a", (0.0, 0.0, 0.0)), Free("b", at=(2.0 * math.sin(angle), 0.0, -2.0 * math.cos(angle)))], [cable], [Gravity(G)]
    )
    run = simulate(scene, 3.6, method="edmc", dt=4.8e-4, save_every=7.2e-3, start="straight")
    first = 0.063 * G * math.cos(angle) * (1.0 + math.exp(-math.pi * 0.02 / math.sqrt(1.0 - 0.02**2)))
    assert run.peak_tension() < 0.9 * first
    assert 0.25 < run.tension_error / (1.0 - run.peak_tension() / first) < 4.0


@pytest.mark.parametrize("dt", [1e-3, 0.1])
def test_a_cable_that_is_let_go(dt):
    """Its own weight, twice at its upper end: a wave that comes back; 10 nodes and steps tell nine tenths of that."""
    run = run_of(hung(10, 0.0, 0.1), dt, max(50.0 * dt, 0.1))
    assert run.segment_tension.max() < 1.3 * 0.1 * G
    assert sudden_load_tension(run, lowest_axial_mode) == pytest.approx(2.0 * 0.1 * G, rel=0.15)


@pytest.mark.parametrize("compression", ["none", "linear"])
def test_a_swing_whose_tension_comes_back_to_nothing_goes_on(compression):
    """A cable let go at an angle: its axial vibration meets the largest pull of its swing, later, after many times without tension.

    The method has taken a third of that vibration by then, and each time without tension ended what was told of it.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=0.17, EA=8e3, zeta=0.1, segments=10, compression=compression)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", at=(0.695, 0.0, -0.719))], [cable], [Gravity(G)])
    run, fine = (run_of(scene, dt, 0.6) for dt in (8e-4, 1e-4))
    missing = 1.0 - run.segment_tension.max() / fine.segment_tension.max()
    assert missing > 0.05 and 0.25 < run.tension_error / missing < 4.0


def test_a_payload_that_becomes_heavier():
    """From M to 3 M: M + 2 (3 M - M) = 5 M."""
    run = run_of(hung(events=[PayloadChange("b", t=1.0, mass=3.0)]), 0.1, 3.0, start="equilibrium")
    assert run.segment_tension.max() < 3.1 * G and told(run) == pytest.approx(5.0 * G, rel=0.03)


def test_what_is_set_off_goes_with_a_swing():
    """Let go 1 rad aside: mg cos(1) more, all along, than mg (3 - 2 cos(1)) at the lowest point of the swing."""
    angle = 1.0
    scene = hung()
    aside = Free("b", mass=1.0, at=(L * math.sin(angle), 0.0, -L * math.cos(angle)))
    run = run_of(Scene([scene.points[0], aside], scene.cables, scene.effects), 2e-2, 2.0)
    assert run.segment_tension.max() == pytest.approx(G * (3.0 - 2.0 * math.cos(angle)), rel=0.01)
    assert told(run) == pytest.approx(G * (3.0 - math.cos(angle)), rel=0.03)


def test_dampers_take_what_is_set_off():
    """Of exp(-zeta omega t) a hundredth is left at the lowest point of the swing with zeta = 0.03, BA = 2 zeta EA/omega."""
    angle = 1.0
    scene = hung(BA=2.0 * 0.03 * math.sqrt(EA * 1.0 * L))
    aside = Free("b", mass=1.0, at=(L * math.sin(angle), 0.0, -L * math.cos(angle)))
    run = run_of(Scene([scene.points[0], aside], scene.cables, scene.effects), 2e-2, 2.0)
    assert sudden_load_tension(run, lowest_axial_mode) < 1.05 * run.segment_tension.max()


@pytest.mark.parametrize("method", ["edmc", "verlet"])
def test_what_begins_smoothly_or_is_resolved_sets_off_nothing(method):
    carried = simulate(load_scene("net_carried"), 2.0, method="edmc", dt=8e-3, save_every=8e-3)
    assert sudden_load_tension(carried, lowest_axial_mode) <= 1.01 * carried.segment_tension.max()
    run = simulate(hung(), 0.1, method=method, dt=1e-4, save_every=1e-4, start="straight")
    assert sudden_load_tension(run, lowest_axial_mode) <= 1.01 * run.segment_tension.max()


@pytest.mark.parametrize("ramp", [0.02, 0.05])
def test_what_takes_longer_than_half_a_period_is_not_put_on_at_once(ramp):
    """The support of a weight starts within one and 2.5 periods, whose mean tension grows as if a load had been put on."""
    points = [Driven("a", paths.line((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), ramp=ramp)), Free("b", mass=1.0)]
    scene = Scene(points, [Cable("a", "b", length=L, mass_per_length=1e-4, EA=EA, segments=1)], [Gravity(G)])
    run = run_of(scene, 2e-3, 0.3, start="equilibrium")
    quarter = 1 + round(0.5 * math.pi / lowest_axial_mode(scene, scene.cables[0]).omega / run.dt)
    assert run.segment_tension[:quarter].max() < 0.5 * (run.segment_tension[0, 0] + run.segment_tension[: 4 * quarter].max())
    assert sudden_load_tension(run, lowest_axial_mode) == 0.0
