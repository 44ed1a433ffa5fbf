"""Links that cannot push: who marches where they would, against `edmc` alone, and starts from which links cannot go."""

import math
from dataclasses import replace

import numpy as np
import pytest
from slow import slow
from systems import four_cables, loose_cable, nets

from anet_lumped import Cable, Driven, Fixed, Free, InputError, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity, LineChange
from anet_lumped.model.build import build
from anet_lumped.motion.link_legs import slack_time
from anet_lumped.prescribed import paths, signals
from anet_lumped.results.events import BLOW, PAYLOAD, SLACK, TAUT
from anet_lumped.scene.payload_change import PayloadChange

INF = math.inf


def kinds(run):
    return [event.kind for event in run.events if event.kind in (SLACK, TAUT)]


def no_energy_gained(run, allowed=1e-6):
    """Energy less work never rises, but by the tolerance of steps over the energy in play."""
    own = run.energy[:, :3].sum(axis=1) - run.energy[:, 3]
    return (own - np.minimum.accumulate(own)).max() < allowed * run.energy_balance.in_play


def pulls_alone(run):
    """No segment pushes, and none is longer than it is."""
    for cable in run.scene.cables:
        links = np.linalg.norm(np.diff(run.shape(cable.name), axis=1), axis=2)
        assert links.max() < cable.L0 * (1 + 1e-6)
    return run.segment_tension.min() > -1e-6 * run.segment_tension.max()


@pytest.mark.parametrize("law", ["none", "damped"])
@pytest.mark.parametrize("options", [dict(rtol=1e-8), dict(dt=5e-4)])
def test_a_loose_cable_whips(law, options):
    """It goes slack after its whip and comes back; events take turns; before them, no step of edmc is needed."""
    run = simulate(loose_cable(INF, 0.0, compression=law), 1.2, method="links", start="straight", save_every=0.005, **options)
    assert run.ok and run.method in ("links", "links5")
    found = kinds(run)
    assert found and found == [SLACK, TAUT] * (len(found) // 2) + [SLACK] * (len(found) % 2)
    assert 0.5 < run.events[0].t < 0.6 and run.events[0].where == "a-b"
    assert all(event.lost >= -1e-9 for event in run.events)
    assert pulls_alone(run) and no_energy_gained(run, 1e-5)
    assert 0.0 < slack_time(run) < 0.7


def test_slack_against_edmc():
    """Up to 50 ms after the cable goes slack both agree to the error of edmc at a small step: 5 ms leave 2 mm, 0.1 ms 1 µm."""
    scene = loose_cable(INF, 0.0)
    run = simulate(scene, 0.58, method="links", rtol=1e-9, start="straight", save_every=0.02)
    fine = simulate(scene, 0.58, method="edmc", dt=1e-4, start="straight", save_every=0.02)
    assert kinds(run)[0] == SLACK
    assert np.abs(run.q - fine.q).max() < 2e-4


@pytest.mark.each_once
@pytest.mark.parametrize("load", [0.0, 0.5])
@pytest.mark.parametrize("velocity", [(0, 0, 0), (0.5, 0, 0), (0, 0, 2.0), (0, 0, -2.0)])
def test_loads_that_are_caught_and_dropped(load, velocity):
    """A net of four cables whose payload changes at 0.3 s, with a blow sideways, upwards and downwards; p0 as edmc has it.

    Downwards the cables take the blow; otherwise some go slack. 0.1 s later both methods agree to the error of edmc's step.
    """
    events = [PayloadChange("p0", t=0.3, mass=load, velocity=velocity)]
    scene = replace(four_cables(INF, 0.0, segments=6), events=events)
    run = simulate(scene, 0.4, method="links", rtol=1e-8, save_every=0.02)
    fine = simulate(scene, 0.4, method="edmc", dt=1e-4, save_every=0.02)
    assert run.ok and run.events[0].kind == PAYLOAD
    upset = load > 0.0 and (velocity[0] > 0.0 or velocity[2] > 0.0)
    assert (SLACK in kinds(run)) == upset
    assert no_energy_gained(run, 1e-5) and pulls_alone(run)
    if not upset:  # blows without bounce; those that edmc takes apart in its springs are tests of its own
        assert kinds(run) == []
    if velocity[2] >= 0.0:
        assert np.abs(run.position("p0") - fine.position("p0")).max() < 1e-3


@pytest.mark.each_once
@pytest.mark.parametrize("begins", [0.0, -0.1])
@pytest.mark.parametrize("law, pushes", [("none", False), ("damped", False), ("linear", True)])
def test_a_point_that_sets_off_towards_its_cable(law, pushes, begins):
    """A hanging load whose support falls away at 1 m/s, at the start of a run and in its middle: free fall from rest until the
    line is straight, unless links push it.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=INF, segments=10, compression=law)
    scene = Scene([Driven("a", paths.line((0, 0, 0), (0, 0, -1.0), 0.0)), Free("b", 0.5)], [cable], [Gravity()])
    begin = replace(equilibrium(scene), t=begins)
    run = simulate(scene, 0.15 - begins, method="links", start=begin, save_every=0.05)
    t = np.maximum(run.t, 0.0)
    fallen = 1.0 * t if pushes else 0.5 * 9.81 * t**2
    np.testing.assert_allclose(run.position("b")[:, 2], -1.0 - fallen, atol=1e-6)
    assert [(event.kind, event.t) for event in run.events] == [(BLOW if pushes else SLACK, 0.0)]


def test_a_length_that_is_paid_out_at_once():
    """As above, by a winch: the load falls freely."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=INF, segments=10)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 0.5)], [cable], [Gravity(), LineChange({"a-b": signals.line(0.0, 1.0, 0.0)})])
    run = simulate(scene, 0.15, method="links", save_every=0.05)
    np.testing.assert_allclose(run.position("b")[:, 2], -1.0 - 0.5 * 9.81 * run.t**2, atol=1e-5)
    assert kinds(run) == [SLACK]


@pytest.mark.parametrize("t", [-0.5, 0.0])
def test_a_point_that_sets_off_sideways(t):
    """At the start and in the middle of a run: the load swings as in the frame of its support, with the amplitude of v sqrt(L/g).

    The work of the blow is that of the first link's half mass alone, which is on the support.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-6, EA=INF, segments=1)
    scene = Scene([Driven("a", paths.line((0, 0, 0), (0.01, 0, 0), 0.0)), Free("b", 1.0)], [cable], [Gravity()])
    rest = equilibrium(scene)
    begin = replace(rest, t=t)
    run = simulate(scene, 1.0 - t, method="links", rtol=1e-11, start=begin, save_every=0.05)
    after = run.t >= 0.0
    assert run.ok and run.events == () and np.abs(run.position("b")[~after] - rest.position("b")).max(initial=0.0) < 1e-12
    x, omega = run.position("b")[after, 0] - 0.01 * run.t[after], math.sqrt(9.81)
    np.testing.assert_allclose(x, -0.01 / omega * np.sin(omega * run.t[after]), atol=2e-8)  # of third order in 0.003 rad
    assert run.energy_balance.imbalance < 1e-9


def test_a_support_that_stops():
    """A net that is carried sideways and stopped by its path goes on swinging, as edmc has it."""
    t = np.linspace(0.0, 0.6, 7)
    way = np.stack([0.15 * (1 - np.cos(np.pi * np.minimum(t, 0.3) / 0.3)), 0 * t, 0 * t], axis=1)
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    points = [Driven(f"s{i}", paths.samples(t, way + at)) for i, at in enumerate(corners)]
    made = dict(length=1.0, mass_per_length=0.1, EA=INF, segments=5)
    scene = Scene([*points, Free("p0", mass=0.036)], [Cable(f"s{i}", "p0", **made) for i in range(4)], [Gravity()])
    run = simulate(scene, 0.5, method="links", rtol=1e-8, save_every=0.02)
    fine = simulate(scene, 0.5, method="edmc", dt=2e-4, save_every=0.02)
    assert run.ok and np.abs(run.position("p0") - fine.position("p0")).max() < 2e-3
    assert no_energy_gained(run, 1e-4) and pulls_alone(run)


@pytest.mark.parametrize("name", ["loose end", "junction", "parallel", "loop"])
def test_crumpled_starts(name):
    """Nets thrown together, every cable folded up: they fall, straighten and are caught, and no energy comes in."""
    scene = nets(EA=INF, zeta=0.0)[name]
    model, rng, start = build(scene), np.random.default_rng(2), {}
    place = {p.name: np.zeros(3) if isinstance(p, Fixed) else 0.02 * rng.normal(size=3) for p in scene.points}
    for cable in scene.cables:
        inner = place[cable.start] + 0.01 * rng.normal(size=(cable.segments - 1, 3))
        start[cable.name] = np.vstack([place[cable.start], inner, place[cable.end]])
    run = simulate(scene, 1.0, method="links", dt=1e-3, start=start, save_every=0.01)
    assert run.ok and kinds(run)[0] == SLACK and run.events[0].t == 0.0 and len(run.q[0]) == model.n
    assert no_energy_gained(run, 1e-5) and pulls_alone(run)


@pytest.mark.parametrize("options", [dict(dt=0.002), *slow({})])
def test_a_cable_that_is_slack_now_and_pulled_straight_later(options):
    """It goes on through every span of edmc, until there is no room left; and says which method was asked for."""
    path = paths.line((0.2, 0, 0), (0.4, 0, 0), 0.2)
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=INF, segments=6)
    scene = Scene([Fixed("a", (0, 0, 0)), Driven("b", path)], [cable], [Gravity()])
    run = simulate(scene, 5.0, method="links", start="straight", **options)
    assert run.events[0].kind == SLACK and run.status == "unconverged" and run.method == ("links5" if options else "links")
    assert 2.05 < run.t[-1] <= 2.1 + 1e-9 and "must be longer than the distance between its ends" in run.message


OFF = 'must have their length at the start, but segment {} of cable "a-b" is 0.5 m long, and its nodes are {} m apart at t=0 s'


@pytest.mark.parametrize(
    "law, middle, message",
    [
        ("linear", 0.4, OFF.format("[01]", "0.[46]")),
        ("linear", 0.50001, 'which can push, is 2e-05 of its length too .*; start from a rest or take compression="none"'),
        ("none", 0.51, OFF.format(0, 0.51) + "; start from a rest, give EA to let it stretch[.]"),
        ("damped", 0.501, OFF.format(0, 0.501) + "; start from a rest, give EA to let it stretch[.]"),
    ],
)
def test_starts_of_another_length(law, middle, message):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=INF, segments=2, compression=law)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", at=(1.0, 0, 0))], [cable], [Gravity()])
    with pytest.raises(InputError, match=message):
        simulate(scene, 0.1, method="links", start={"a-b": [(0, 0, 0), (middle, 0, 0), (1, 0, 0)]})
