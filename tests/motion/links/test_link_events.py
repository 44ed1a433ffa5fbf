"""Runs of links through breaks and payload changes, from a state of theirs, saved and loaded, and seen from elsewhere."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from systems import four_cables, loose_cable, mesh

from anet_lumped import Cable, Driven, Fixed, Free, Scene, State, equilibrium, load_run, simulate
from anet_lumped.effects import Gravity, LineChange
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths, signals
from anet_lumped.results.events import BLOW, BREAK, PAYLOAD, SLACK, TAUT
from anet_lumped.scene.payload_change import PayloadChange

INF, G = math.inf, 9.81
BOTH = [dict(rtol=1e-10), dict(dt=0.001)]


def pendulum(segments=1, **kwargs):
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-9, EA=INF, segments=segments, **kwargs)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", 1.0, at=(1, 0, 0))], [cable], [Gravity(G)])


@pytest.mark.parametrize("options", BOTH)
def test_a_pendulum_breaks_where_its_tension_says(options):
    """From level T = 3 m g cos x: at 2 m g it is at cos x = 2/3, and flies on with v^2 = 2 g cos x; nothing is lost."""
    run = simulate(pendulum(breaking_tension=2 * G), 0.8, method="links", start="straight", save_every=0.05, **options)
    (event,) = run.events
    assert event.kind == BREAK and event.segment == 0 and event.tension == pytest.approx(2 * G, rel=1e-7) and event.lost == 0.0
    # integral of dx/sqrt(2 g cos x) from level, by the same run without a break
    whole = simulate(pendulum(), 0.8, method="links", start="straight", rtol=1e-12, save_every=1e-4)
    height = np.interp(event.t, whole.t, whole.position("b")[:, 2])
    assert -height == pytest.approx(2 / 3, abs=1e-6)
    x, v = math.acos(2 / 3), math.sqrt(2 * G * 2 / 3)
    after = run.t > event.t
    tau = run.t[after] - event.t
    exact = np.stack(
        [math.sin(x) - v * math.cos(x) * tau, 0 * tau, -math.cos(x) - v * math.sin(x) * tau - 0.5 * G * tau**2], axis=1
    )
    np.testing.assert_allclose(run.position("b")[after], exact, atol=1e-6)
    assert not run.tension("a-b")[after].any() and run.energy_balance.imbalance < 1e-8


@pytest.mark.parametrize("options", BOTH)
def test_one_of_two_cables_breaks(options):
    """A load is hung at rest on two cables, one weak: they straighten until its tension is 3 N; edmc finds the same time."""
    made = dict(length=1.0, mass_per_length=0.01, EA=INF, segments=3)
    cables = [Cable("a", "b", breaking_tension=3.0, name="weak", **made), Cable("c", "b", name="strong", **made)]
    growing = [PayloadChange("b", t=0.1, mass=0.5)]
    scene = Scene([Fixed("a", (-0.3, 0, 0)), Fixed("c", (0.3, 0, 0)), Free("b", 0.01)], cables, [Gravity(G)], growing)
    run = simulate(scene, 0.2, method="links", save_every=0.01, **options)
    fine = simulate(scene, 0.2, method="edmc", dt=1e-4, save_every=0.01)
    mine, theirs = ([(e.kind, e.where) for e in one.events if e.kind in (BREAK, PAYLOAD)][:2] for one in (run, fine))
    assert run.ok and mine == theirs and (BREAK, "weak") in mine
    broke = [next(e for e in one.events if e.kind == BREAK) for one in (run, fine)]
    assert broke[0].t == pytest.approx(broke[1].t, abs=1e-3) and broke[0].tension == pytest.approx(3.0, rel=1e-6)


@pytest.mark.parametrize("options", BOTH)
def test_restart_in_the_middle(options):
    """A run from a state of another one is that run's rest, to the tolerance of its steps; so is one from a saved file's."""
    scene = four_cables(INF, 0.0, segments=6, carried=True)
    whole = simulate(scene, 1.0, method="links", save_every=0.1, **options)
    half = simulate(scene, 0.5, method="links", save_every=0.1, **options)
    rest = simulate(scene, 0.5, method="links", start=half.final, save_every=0.1, **options)
    np.testing.assert_allclose(rest.t, whole.t[5:], atol=1e-12)
    allowed = 1e-12 if "dt" in options else 1e-8  # the same steps; others of the same tolerance
    np.testing.assert_allclose(rest.q, whole.q[5:], atol=allowed)
    np.testing.assert_allclose(rest.segment_tension, whole.segment_tension[5:], atol=1e4 * allowed)
    assert rest.events == ()


def test_restart_while_a_cable_is_slack():
    """Its events go on, and slack and taut take turns in the state's history, too."""
    scene = loose_cable(INF, 0.0, segments=8)
    whole = simulate(scene, 1.5, method="links", dt=5e-4, start="straight", save_every=0.05)
    first = next(e.t for e in whole.events if e.kind == SLACK)
    k = int(np.searchsorted(whole.t, first)) + 1
    rest = simulate(scene, 1.5 - whole.t[k], method="links", dt=5e-4, start=whole.state(k), save_every=0.05)
    assert rest.ok and rest.events[0].kind == SLACK and rest.events[0].t == first
    own = rest.energy[:, :3].sum(axis=1)
    assert (own - np.minimum.accumulate(own)).max() < 1e-5 * rest.energy_balance.in_play


def test_saved_and_loaded(tmp_path):
    """With its events, which have words of their own, its method and its warnings."""
    scene = replace(loose_cable(INF, 0.0, segments=8), events=[PayloadChange("b", t=0.2, mass=0.05)])
    run = simulate(scene, 1.2, method="links", rtol=1e-7, start="straight")
    run.save(tmp_path / "run.nc")
    back = load_run(tmp_path / "run.nc")
    assert back.events == run.events and back.method == "links" and back.warnings == run.warnings and back.status == run.status
    assert {event.kind for event in back.events} >= {PAYLOAD, SLACK}
    for name in ("t", "q", "v", "energy", "segment_tension"):
        np.testing.assert_array_equal(getattr(back, name), getattr(run, name))
    words = [str(event) for event in run.events]
    assert any('cable "a-b" went slack' in text for text in words)
    assert all("taut again" in text for text, event in zip(words, run.events, strict=True) if event.kind == TAUT)
    again = simulate(back.scene, 0.1, method="links", rtol=1e-7, start=back.final)
    assert again.ok and again.events[: len(run.events)] == run.events


@pytest.mark.parametrize("every", [0.37, 0.001, 0.9])
def test_saves_do_not_change_a_run(every):
    """Rows between steps keep all lengths and their rates, and the end is the same whatever was saved."""
    scene = four_cables(INF, 0.0, segments=5, carried=True)
    run = simulate(scene, 0.9, method="links", rtol=1e-9, save_every=every)
    other = simulate(scene, 0.9, method="links", rtol=1e-9)
    np.testing.assert_array_equal(run.q[-1], other.q[-1])
    for cable in scene.cables:
        d, v = np.diff(run.shape(cable.name), axis=1), np.diff(run.v[:, run.model.nodes(cable.name)], axis=1)
        assert np.abs(np.linalg.norm(d, axis=2) - cable.L0).max() < 1e-14
        assert np.abs((d * v).sum(axis=2)).max() < 1e-14


def test_a_winch_starts_and_stops_at_once():
    """A hanging load is hoisted from 0 on; its cable feels mu L'^2 and no bounce, and the account balances."""
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-9, EA=INF, segments=3)
    hoist = LineChange({"a-b": signals.line(0.0, -0.3, 0.0)})
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 0.5)], [cable], [Gravity(G), hoist])
    run = simulate(scene, 1.0, method="links")
    np.testing.assert_allclose(run.position("b")[:, 2], -1.0 + 0.3 * run.t, atol=1e-9)
    np.testing.assert_allclose(run.tension("a-b")[1:], 0.5 * G, rtol=1e-6)
    assert [(event.kind, event.t) for event in run.events] == [(BLOW, 0.0)] and run.energy_balance.imbalance < 1e-9
    assert run.energy[-1, 3] == pytest.approx(0.5 * (G * 0.3 + 0.5 * 0.3**2), rel=1e-6)  # the blow's included


def test_a_swing_that_is_hoisted():
    """L' and L'' against the pendulum of changing length: (L^2 x')' = -g L sin x, by scipy."""
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-9, EA=INF, segments=1, compression="linear")
    change = signals.harmonic(0.0, 0.2, 0.9)
    points = [Fixed("a", (0, 0, 0)), Free("b", 1.0, at=(math.sin(0.5), 0, -math.cos(0.5)))]
    scene = Scene(points, [cable], [Gravity(G), LineChange({"a-b": change})])
    model = build(scene)
    rate = change.at(0.0)[1]
    q, v = np.zeros((2, 2, 3))
    q[model.node("b")] = points[1].at
    v[model.node("b")] = rate * q[model.node("b")]
    run = simulate(scene, 2.0, method="links", rtol=1e-11, start=State(model, 0.0, q, v, np.zeros(1)), save_every=0.1)

    def rates(t, y):
        paid, paid_rate = change.at(t)
        L = 1.0 + paid
        return [y[1], -(2 * paid_rate * y[1] + G * math.sin(y[0])) / L]

    known = solve_ivp(rates, (0, 2.0), [0.5, 0.0], method="DOP853", rtol=1e-12, atol=1e-13, t_eval=run.t)
    L = np.array([1.0 + change.at(t)[0] for t in run.t])
    exact = L[:, None] * np.stack([np.sin(known.y[0]), 0 * L, -np.cos(known.y[0])], axis=1)
    np.testing.assert_allclose(run.position("b"), exact, atol=1e-8)
    assert run.energy_balance.imbalance < 1e-9


def turned(scene, rotation, shift):
    """The scene turned and moved."""

    def moved(point):
        if isinstance(point, Driven):
            made = dict(point.path.parameters)
            return Driven(point.name, paths.line(rotation @ made["start"] + shift, rotation @ made["velocity"], made["ramp"]))
        return point if point.at is None else replace(point, at=tuple(rotation @ point.at + shift))

    return replace(scene, points=[moved(p) for p in scene.points], effects=[Gravity(G, tuple(rotation @ [0, 0, -1.0]))])


def test_seen_from_elsewhere():
    """Turned, moved, with points in another order and cables turned about: the same motion to the tolerance."""
    scene = four_cables(INF, 0.0, segments=5, carried=True)
    run = simulate(scene, 1.5, method="links", rtol=1e-11, save_every=0.1)
    rotation = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    shift = np.array([3.0, -2.0, 5.0])
    other = simulate(turned(scene, rotation, shift), 1.5, method="links", rtol=1e-11, save_every=0.1)
    np.testing.assert_allclose(other.position("p0"), run.position("p0") @ rotation.T + shift, atol=1e-8)
    flipped = [replace(c, start=c.end, end=c.start, name=c.name) if i % 2 else c for i, c in enumerate(scene.cables)]
    mixed = replace(scene, points=scene.points[::-1], cables=flipped[::-1])
    other = simulate(mixed, 1.5, method="links", rtol=1e-11, save_every=0.1)
    np.testing.assert_allclose(other.position("p0"), run.position("p0"), atol=1e-9)
    for i, cable in enumerate(scene.cables):
        there = other.tension(cable.name)[:, ::-1] if i % 2 else other.tension(cable.name)
        np.testing.assert_allclose(there, run.tension(cable.name), atol=1e-6)


def test_order_of_a_mesh_does_not_count():
    """A mesh whose points and cables are listed the other way round."""
    made = mesh(2, 3, 2)
    spread = {f"s{k}": (float(i), float(j), 0.0) for k, (i, j) in enumerate([(0, 0), (0, 2), (1, 0), (1, 2)])}
    points = [Fixed(p.name, spread[p.name]) if isinstance(p, Fixed) else p for p in made.points]
    scene = Scene(points, [replace(c, EA=INF, zeta=0.0, length=1.3) for c in made.cables], [Gravity(G)])
    events = [PayloadChange("0,1", t=0.1, mass=0.3, velocity=(0, 0, 0))]
    runs = []
    for step in (1, -1):
        listed = Scene(scene.points[::step], scene.cables[::step], scene.effects, events)
        runs.append(simulate(listed, 0.4, method="links", rtol=1e-10, start=equilibrium(listed), save_every=0.1))
        assert [event.kind for event in runs[-1].events] == [PAYLOAD]
    for name in ("0,1", "1,2"):
        np.testing.assert_allclose(runs[0].position(name), runs[1].position(name), atol=1e-7)


@pytest.mark.parametrize("ends", [("a", "b"), ("b", "a")])
def test_a_support_that_jumps_works_as_much_as_it_moves(ends):
    """Pulled up at 1.5 m/s from a standstill, 2 kg have m v^2/2 at once, which is the impulse m v at the mean velocity v/2."""
    cable = Cable(*ends, length=1.0, mass_per_length=1e-9, EA=INF, segments=1)
    scene = Scene([Driven("a", paths.line((0, 0, 0), (0, 0, 1.5), ramp=0.0)), Free("b", 2.0)], [cable], [Gravity(G)])
    run = simulate(scene, 0.1, method="links", dt=0.01)
    assert run.energy[0, [0, 3]] == pytest.approx([2.25, 2.25], rel=1e-6)
    assert run.energy[-1, 3] == pytest.approx(2.25 + 2.0 * G * 0.15, rel=1e-6)
