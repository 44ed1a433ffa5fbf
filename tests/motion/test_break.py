"""Cables that break: at which load, when, what is lost in it, and what the rest does."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from systems import four_cables, nets, scatter

from anet_lumped import Cable, Driven, Fixed, Free, PayloadChange, Scene, SceneError, State, equilibrium, load_run, simulate
from anet_lumped.effects import Bending, Gravity, Ground, Load, ViscousDamping
from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.model.remainder import SCATTER, remainder
from anet_lumped.prescribed.paths import line
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.results.events import BREAK, Event, broken
from studies.shown.summary import run_summary

G, MU, EA = 9.81, 0.1, 1e4


WEIGHT = (Gravity(G),)


def hanging(limit, *, effects=WEIGHT, segments=10, payload=0.0, events=(), **kwargs):
    """A metre of cable under a support."""
    made = dict(length=1.0, mass_per_length=MU, EA=EA, zeta=0.05, segments=segments, breaking_tension=limit) | kwargs
    return Scene([Fixed("a", (0, 0, 0)), Free("b", payload)], [Cable("a", "b", **made)], effects, events)


def breaks(run):
    return [event for event in run.events if event.kind == BREAK]


# --- when -----------------------------------------------------------------------------------------------------------------


WAYS = {
    "edmc": ("edmc", {"dt": 2e-3}, 2e-6),
    "edmc, coarse": ("edmc", {"dt": 0.02}, 1e-3),  # steps longer than the axial period of 13 ms
    "edmc, adaptive": ("edmc", {"rtol": 1e-6}, 1e-2),  # of 50 ms
    "backward_euler": ("backward_euler", {"dt": 0.02}, 2e-6),
    "sdirk2": ("sdirk2", {"dt": 0.02}, 0.01),  # whose tensions are the mean over a step
    "generalised_alpha": ("generalised_alpha", {"dt": 0.02}, 2e-6),
    "verlet": ("verlet", {"dt": 1e-4}, 2e-6),
    "rk4": ("rk4", {"dt": 1e-4}, 2e-6),
    "symplectic_euler": ("symplectic_euler", {"dt": 1e-4}, 2e-6),
    "dop853": ("dop853", {}, 2e-6),
    "Radau": ("Radau", {}, 2e-5),  # which holds the mean of its error to 1e-6
}
"""Method, step, and the error of the time of a break [s]."""


@pytest.mark.parametrize("way", [pytest.param(way, marks=pytest.mark.slow if way == "Radau" else ()) for way in WAYS])
def test_at_its_load(way):
    """A load that grows in 2 s breaks the first segment when it carries its limit: (mu g + p(t)) (L - L0/2) = T.

    Quasi-static: the lowest axial frequency is 497 rad/s, so that inertia takes up to 6/(2 s)^2/omega^2 = 6e-6 of the load's
    4 N, which at its rate of 3.5 N/s is 7 us; where the load grows steadily it is less.
    """
    method, settings, within = WAYS[way]
    limit, p = 3.0, 4.0
    scene = hanging(limit, effects=(Gravity(G), Load((0.0, 0.0, -p), ramp=2.0)))
    run = simulate(scene, 1.5, method=method, start=equilibrium(hanging(None)), **settings)
    first = breaks(run)[0]
    grown = (limit / 0.95 - MU * G) / p
    expected = 2.0 * brentq(lambda s: s**3 * (s * (6 * s - 15) + 10) - grown, 0.0, 1.0)
    assert (first.where, first.segment) == ("a-b", 0)
    assert first.tension == pytest.approx(limit, rel=5e-8)  # to which the time is found
    assert first.t == pytest.approx(expected, abs=within)
    # of the spring alone: the damper's part of the tension is 2e-5; and that of places, which a mean of tensions is not
    assert first.lost == pytest.approx(limit**2 * 0.1 / (2.0 * EA), rel=0.02 if way == "sdirk2" else 1e-4)
    assert np.all(run.tension("a-b")[run.t > first.t, 0] == 0.0)
    assert np.all(run.tension("a-b")[run.t < first.t, 0] > 0.9 * MU * G)


def test_just_below_nothing_happens():
    still = equilibrium(hanging(None)).tension("a-b").max()
    assert simulate(hanging(1.0001 * still), 0.3).events == ()
    assert len(breaks(simulate(hanging(0.9999 * still), 0.3))) == 1


@pytest.mark.parametrize("method", ["edmc", "rk4"])
def test_found_within_a_step(method):
    """A mass on a spring, from its unstretched length: T = M g (1 - cos(omega t)), whatever steps it takes."""
    k, M = 500.0, 1.05
    omega = math.sqrt(k / M)
    scene = hanging(15.0, segments=1, payload=1.0, EA=k, zeta=0.0)
    still = np.zeros((2, 3))
    start = State(build(scene), 0.0, np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 0.0]]), still, np.zeros(1))
    expected = math.acos(1.0 - 15.0 / (M * G)) / omega
    errors = []
    for dt in (8e-3, 4e-3, 2e-3, 1e-3):
        run = simulate(scene, 0.2, method=method, dt=dt, start=start)
        (event,) = run.events
        errors.append(abs(event.t - expected))
    order = {"edmc": 2.0, "rk4": 4.0}[method]
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(slopes, order, atol=0.15)
    assert errors[-1] < 1e-5


# --- what becomes of the rest ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("method", "dt"), [
    ("edmc", 0.01), ("edmc", 0.1), ("rk4", 1e-4), ("backward_euler", 0.01), ("dop853", None),
])  # fmt: skip
def test_what_falls_falls_freely(method, dt):
    """The lower part of two cables under each other, of which the lower one fails at the start: -g t^2/2, all momenta kept."""
    points = [Fixed("a", (0, 0, 0)), Free("m", 0.1), Free("b", 0.2)]
    made = dict(length=1.0, mass_per_length=MU, EA=EA, zeta=0.05, segments=8)
    scene = Scene(points, [Cable("a", "m", **made), Cable("m", "b", breaking_tension=2.8, **made)], [Gravity(G)])
    run = simulate(scene, 0.4, method=method, dt=dt)
    (event,) = run.events
    assert (event.t, event.where, event.segment) == (0.0, "m-b", 0)
    mass, nodes = run.model.mass, run.model.nodes("m-b")[1:]
    fallen = (run.q[:, nodes, 2] @ mass[nodes]) / mass[nodes].sum()
    g_t2 = 0.5 * G * run.t**2 if method != "backward_euler" else 0.5 * G * run.t * (run.t + dt)  # its own, exactly
    np.testing.assert_allclose(fallen[0] - fallen, g_t2, rtol=0, atol=1e-8)  # Newton's tolerance
    assert np.abs(run.position("m")[:, 2] + 1.0).max() < 0.01  # what hangs on hangs on


def test_halves_of_a_span():
    """Broken in the middle, both halves hang down from their ends at last."""
    cable = Cable("a", "b", length=1.2, mass_per_length=MU, EA=EA, zeta=0.5, segments=12)
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable], [Gravity(G)])
    rest = equilibrium(scene)
    after = replace(rest, events=(Event(0.0, BREAK, "a-b", 0.0, segment=6, tension=1.0),))
    run = simulate(replace(scene, effects=(Gravity(G), ViscousDamping(10.0))), 15.0, start=after)
    ends = run.shape("a-b")[-1]
    for of, segments in ((ends[:7], 6), (ends[:6:-1], 5)):
        below = of[:, 2] - of[0, 2]
        np.testing.assert_allclose(of[:, 0], of[0, 0], atol=1e-3)  # e^-5/2 t of a swing of a metre: 1e-5 and more
        np.testing.assert_allclose(-below, np.arange(segments + 1) * 0.1, atol=1e-4)
    assert run.events == after.events


def test_the_last_segment():
    """A cable of one segment that fails leaves a mass alone: no cable at all."""
    scene = hanging(10.0, segments=1, payload=2.0)
    for method in ("edmc", "verlet", "dop853", "Radau"):
        run = simulate(scene, 0.5, method=method, dt=1e-2 if method in ("edmc", "verlet") else None)
        drop = run.position("b")[:, 2] - run.position("b")[0, 2]
        np.testing.assert_allclose(drop, -0.5 * G * run.t**2, rtol=0, atol=1e-8)  # rounding; the tolerance of Radau
        assert np.all(run.tension("a-b")[1:] == 0.0) and error_of_steps(run) < 1e-6


def test_payload_that_lost_its_cable_changes():
    """Events go on in what is left."""
    scene = hanging(10.0, segments=1, payload=2.0, events=(PayloadChange("b", 0.1, 4.0),))
    run = simulate(scene, 0.2, method="rk4", dt=1e-3)
    M = 2.0 + 0.5 * MU
    assert [event.kind for event in run.events] == [BREAK, "payload changed"]
    assert run.velocity("b")[-1, 2] == pytest.approx(-G * (0.1 * M / (M + 2.0) + 0.1), rel=1e-12)


@pytest.mark.each_once
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("net", nets())
def test_remainder_has_the_forces_of_the_rest(net, seed):
    """Whatever breaks of whatever net: masses stay, and forces are those of the whole less those of the broken segments."""
    rng = np.random.default_rng((seed, len(net)))
    model = build(nets(zeta=0.3, effects=[Gravity(G)])[net])
    gone = {}
    for cable in model.scene.cables:
        failed = np.flatnonzero(rng.random(cable.segments) < 0.4)
        if len(failed):
            gone[cable.name] = tuple(map(int, failed))
    left = remainder(model, {}, gone)
    q, v = scatter(model, rng), rng.normal(size=(model.n, 3))
    v[model.n_free :] = 0.0
    np.testing.assert_array_equal(np.sort(left.node), np.arange(model.n))
    moving = slice(0, model.n_free)  # what a support weighs is nothing to anyone
    np.testing.assert_allclose(left.model.mass[moving], model.mass[left.node[moving]], rtol=1e-12)
    whole, part, power = np.zeros((model.n, 3)), np.zeros((model.n, 3)), np.zeros(3)
    of_whole, of_left = fresh_net(model), fresh_net(left.model)  # which must outlive the use of their addresses
    system(model).force(0.0, q, v, of_whole.address, whole, power)
    system(left.model).force(0.0, q[left.node], v[left.node], of_left.address, part, power)
    expected = whole[left.node]
    place = np.argsort(left.node)
    for name, failed in gone.items():
        cable, nodes = model.scene.cable(name), model.nodes(name)
        for s in failed:
            a, b = nodes[s], nodes[s + 1]
            d = q[b] - q[a]
            l = np.linalg.norm(d)
            rate = d @ (v[b] - v[a]) / l
            T = max(0.0, cable.stiffness * (l - cable.L0) + cable.dashpot * rate) if l > cable.L0 else 0.0
            expected[place[a]] -= T * d / l
            expected[place[b]] += T * d / l
    np.testing.assert_allclose(part, expected, rtol=0, atol=1e-10 * np.abs(whole).max())  # sums of rounded forces


# --- nets ---------------------------------------------------------------------------------------------------------------------


def loaded_net(limits, **kwargs):
    """The net of four cables with a payload whose weight grows to 5 N on its cables, some of which may break."""
    net = four_cables(**kwargs)
    cables = [replace(cable, breaking_tension=limit) for cable, limit in zip(net.cables, limits, strict=True)]
    return replace(net, cables=cables, effects=(Gravity(G), Load((0.0, 0.0, -5.0), ramp=1.0)))


def test_one_of_four_cables():
    """The default method stays stable, its account of energy closes, and the audit passes: the other three hold."""
    scene = loaded_net([4.0, None, None, None])
    run = simulate(scene, 0.54, audit=True)
    assert run.ok, run.message
    assert run.method == "edmc" and run.audit.passed and run.audit.imbalance < 1e-6
    longer = simulate(scene, 1.5)  # the loose part whips and breaks again, at times and places that no step resolves
    assert longer.ok and longer.energy_balance.imbalance < 1e-6
    assert not longer.kept
    (event,) = run.events
    assert (event.where, event.segment) == ("s0-p0", 0)
    assert 0.3 < event.t < 0.9 and event.tension == pytest.approx(4.0, rel=1e-5)
    begun = longer.events[0].t
    assert begun == pytest.approx(event.t, abs=1e-3)
    soon = (longer.t > begun + 0.1) & (longer.t < begun + 0.14)
    before, after = run.position("p0")[run.t < event.t], longer.position("p0")[soon]
    assert np.abs(before[:, :2]).max() < 1e-3 and after[:, :2].min() > 0.0  # away from the corner that let go
    assert longer.tension("s2-p0")[soon].max() > run.tension("s2-p0")[run.t < event.t].max()


@pytest.mark.parametrize("dt", [None, 0.05])
def test_four_of_four_cables(dt):
    """All at once, as nothing tells them apart; p0 with what hangs on it falls straight down."""
    run = simulate(loaded_net([4.0] * 4), 1.0, method="edmc", dt=dt)
    first = run.events[:4]
    assert sorted(event.where for event in first) == [f"s{i}-p0" for i in range(4)]
    assert np.ptp([event.t for event in first]) < 1e-6  # to which the time of one is found
    assert run.ok and error_of_steps(run) < 1e-6
    assert np.abs(run.position("p0")[:, :2]).max() < 1e-6
    assert run.position("p0")[-1, 2] < run.position("p0")[0, 2] - 0.3


@pytest.mark.parametrize(("method", "dt"), [("edmc", 1e-3), ("verlet", 2e-5), ("dop853", None)])
def test_a_weightless_cable_does_not_shatter(method, dt):
    """All segments carry the same: one fails, as `SCATTER` keeps the rest whole until they are unloaded.

    Pulled at 20 um/s its tension grows by 0.2 N/s; unloading takes 3 ms to run along it.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, zeta=0.02, segments=20, breaking_tension=2.0)
    T = 1.999
    away = Driven("b", line((0.0, 0.0, -1.0 - T / EA), (0.0, 0.0, -2e-5), 0.0))
    scene = Scene([Fixed("a", (0, 0, 0)), away], [cable])
    model = build(scene)
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    along = np.linspace(0.0, 1.0, 21)
    q[model.nodes("a-b"), 2], v[model.nodes("a-b"), 2] = -along * (1.0 + T / EA), -2e-5 * along
    assert 0.2 * 3e-3 < SCATTER * 2.0
    run = simulate(scene, 0.05, method=method, dt=dt, start=State(model, 0.0, q, v, np.full(20, T)))
    assert run.ok and len(run.events) == 1
    # sooner by the damper's part of the tension, BA 2e-5/s over 0.2 N/s: 3 us; and dop853's tolerance, 1e-6 of a metre
    assert run.events[0].t == pytest.approx(5e-3 - 3.2e-6, abs=2e-5 if method == "dop853" else 1e-7)


def test_does_not_stretch():
    """A cable of EA = inf breaks too, and has no energy to lose."""
    run = simulate(hanging(2.0, effects=(Gravity(G), Load((0.0, 0.0, -4.0), ramp=1.0)), EA=math.inf, zeta=0.0), 1.0)
    (event,) = run.events
    assert event.segment == 0 and event.tension == pytest.approx(2.0, rel=1e-5)
    assert abs(event.lost) < 1e-30  # [J], rounding of the kinetic energy
    assert run.ok and error_of_steps(run) < 1e-6


# --- with effects that name cables and points ---------------------------------------------------------------------------------


def test_effects_of_what_is_left():
    """A load of a broken cable acts on its pieces; a clamp that holds nothing any more is gone, and so is bending at last."""
    cables = [Cable(a, "p", length=1.0, mass_per_length=MU, EA=EA, segments=4, EI=0.1) for a in "ab"]
    effects = (Load((0.0, 1.0, 0.0), cables=("a-p",)), Bending({"a": (1, 0, 0), "b": (-1, 0, 0)}))
    model = build(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0)), Free("p")], cables, effects))
    load, bending = remainder(model, {}, {"a-p": (1,)}).model.scene.effects
    assert load.cables == ("a-p[0:1]", "a-p[2:4]") and bending == effects[1]
    load, bending = remainder(model, {}, {"a-p": (0, 3)}).model.scene.effects
    assert load.cables == ("a-p[1:3]",) and bending == Bending({"b": (-1, 0, 0)})
    every = tuple(range(4))
    assert remainder(model, {}, {"a-p": every, "b-p": every}).model.scene.effects == ()
    (load,) = remainder(model, {}, {"b-p": every}).model.scene.effects[:1]
    assert load == effects[0]


def test_stubs_stay_with_their_nodes():
    """Mass, volume and drag across of the two halves of a segment, with what a point carries of its own."""
    made = dict(length=1.0, mass_per_length=MU, EA=EA, segments=4, diameter=0.02, Cdn=1.1, Can=0.9)
    points = [Fixed("a", (0, 0, 0)), Free("b", 0.5, CdA=0.3, volume=1e-4, Ca=0.5)]
    scene = remainder(build(Scene(points, [Cable("a", "b", **made)])), {"b": {"mass": 0.7}}, {"a-b": (2, 3)}).model.scene
    volume = math.pi * 0.01**2 * 0.125
    loose, alone, end = (scene.point(name) for name in ("a-b[2]", "a-b[3]", "b"))
    assert (loose.mass, loose.CdA, loose.volume, loose.Ca) == pytest.approx((0.0125, 0.00275, volume, 0.9))
    assert (alone.mass, alone.volume, alone.Ca) == pytest.approx((0.025, 2 * volume, 0.9))
    assert (end.mass, end.CdA, end.volume) == pytest.approx((0.7125, 0.30275, 1e-4 + volume))
    assert end.Ca * end.volume == pytest.approx(0.5e-4 + 0.9 * volume)
    assert [cable.name for cable in scene.cables] == ["a-b[0:2]"] and scene.point("a") == points[0]


def test_onto_the_ground():
    """With everything on: a bent, loaded cable that breaks and falls on the ground, and rests there."""
    cable = Cable(
        "a", "b", length=1.2, mass_per_length=MU, EA=1e3, zeta=0.3, segments=12, EI=1e-4, diameter=0.01, compression="linear",
        breaking_tension=4.0,
    )  # fmt: skip
    effects = (Gravity(G), Load((0.0, 0.0, -6.0), ramp=0.5), Bending(), Ground(height=-0.6, friction=0.6))
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable], effects)
    run = simulate(scene, 3.0, method="edmc", dt=2e-3, start=equilibrium(replace(scene, effects=effects[:1])))
    assert run.ok and len(breaks(run)) >= 1
    assert run.q[-1, :, 2].min() > -0.61 and run.energy[-1, 0] < 1e-3
    assert error_of_steps(run) < 1e-4


# --- one run ------------------------------------------------------------------------------------------------------------------


def broken_net():
    return simulate(loaded_net([4.0, None, None, None], segments=5), 0.65, method="edmc", dt=0.01)


def test_saved_times_are_those_of_the_run():
    run = broken_net()
    np.testing.assert_allclose(run.t, np.arange(66) * 0.01, rtol=0, atol=1e-15)
    held = run.holds("s0-p0")
    assert held[run.t < run.events[0].t].all() and not held[run.t > run.events[0].t, 0].any() and held[:, 1:].all()
    assert run.length("s0-p0")[-1] == pytest.approx(0.8, rel=1e-2)  # its other four segments
    assert run.final.length("s0-p0") == run.length("s0-p0")[-1]
    assert run.length("s0-p0")[0] > 1.0


def test_goes_on_from_a_state():
    """Two runs are one: the second knows what the first one broke."""
    scene = loaded_net([4.0, None, None, None], segments=5)
    whole = simulate(scene, 0.65, method="rk4", dt=2e-4)
    first = simulate(scene, 0.6, method="rk4", dt=2e-4)
    second = simulate(scene, 0.05, method="rk4", dt=2e-4, start=first.final)
    assert second.events == first.events == whole.events
    np.testing.assert_allclose(second.q[-1], whole.q[-1], rtol=0, atol=1e-9)  # a whip between two roundings
    assert np.all(second.tension("s0-p0")[:, 0] == 0.0)


def test_saved_loaded_and_shown(tmp_path):
    run = broken_net()
    run.save(tmp_path / "run.nc")
    back = load_run(tmp_path / "run.nc")
    assert back.events == run.events and back.scene == run.scene
    np.testing.assert_array_equal(back.length("s0-p0"), run.length("s0-p0"))
    (event,) = run.events
    assert str(event) == f't={event.t:.6g} s: segment 0 of cable "s0-p0" broke at 4 N'
    (row,) = json.loads(json.dumps(run_summary(run)["events"], default=float))
    assert (row["event"], row["where"], row["segment"]) == ("broke", "s0-p0", 0) and row["tension"] == pytest.approx(4.0, rel=1e-5)
    drawn = [len(lines.get_segments()) for lines in run.plot().axes[0].collections]
    assert drawn[0] == run.model.n_segments and drawn[-1] == run.model.n_segments - 1


def test_broken_by_cable():
    assert broken(broken_net().events) == {"s0-p0": (0,)}


# --- what is refused ----------------------------------------------------------------------------------------------------------


def test_refuses():
    with pytest.raises(SceneError, match=r"`breaking_tension` must be positive and finite \[N\], but cable \"a-b\" has"):
        hanging(0.0)
    with pytest.raises(ValueError, match='one run, but cable "a-b" has one and `extrapolate` is set'):
        simulate(hanging(5.0), 0.1, method="edmc", extrapolate=True)
    with pytest.raises(ValueError, match=r'other than Tsit5, .*but cable "a-b" has one and the method is Kvaerno3'):
        simulate(hanging(5.0), 0.1, method="Kvaerno3")
