"""Payloads that change in mid-run: momentum and energy in closed form, exact times, and one run whatever happened in it."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numba import njit
from systems import four_cables, oscillator

from anet_lumped import Cable, Fixed, Free, PayloadChange, Scene, SceneError, State, equilibrium, load_run, simulate
from anet_lumped.effects import REGISTRY, Effect, Gravity, Water
from anet_lumped.effects.signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, INERTIA_SIGNATURE, TANGENT_SIGNATURE
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.model.build import build
from anet_lumped.model.remainder import remainder
from anet_lumped.motion import legs
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.results.events import PAYLOAD, Event
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

G = 9.81
WAYS = {
    "edmc": {"dt": 0.03},
    "edmc, adaptive": {"method": "edmc", "rtol": 1e-6},
    "backward_euler": {"dt": 0.03},
    "generalised_alpha": {"dt": 0.03},
    "sdirk2": {"dt": 0.03},
    "verlet": {"dt": 0.03},
    "verlet, adaptive": {"method": "verlet", "rtol": 1e-6},
    "rk4": {"dt": 0.03},
    "dop853": {},
    "Radau": {},
}  # of which none has a step that ends where something happens


@pytest.fixture(params=WAYS)
def way(request):
    return {"method": request.param} | WAYS[request.param]


# --- a slack pair in flight: every scheme is exact, so that all that is off is off by rounding and by Newton's tolerance -----

EXACT = 1e-11  # [m], [m/s]


def flying(*events, effects=()):
    """Two masses in flight on a cable that stays slack, and the State in which they fly with different velocities."""
    cable = Cable("a", "b", length=3.0, mass_per_length=0.02, EA=100.0, segments=1)
    scene = Scene([Free("a", 1.0), Free("b", 2.0)], [cable], effects, events)
    model = build(scene)
    q, v = np.zeros((2, 3)), np.zeros((2, 3))
    q[model.node("b")] = 1.0, 0.0, 0.0
    v[model.node("a")], v[model.node("b")] = (0.0, 0.4, 0.0), (0.1, 0.5, 0.2)
    return scene, State(model, 0.0, q, v, np.zeros(1))


def test_momentum_of_the_joint_body(way):
    """(M V + m u)/(M + m) from 0.2 s on, exactly: another time would show in the place."""
    M, m, t, V, u = 2.0 + 0.03, 3.0, 0.2001, np.array([0.1, 0.5, 0.2]), np.array([-1.0, 0.0, 2.0])
    scene, start = flying(PayloadChange("b", t, 2.0 + m, u))
    run = simulate(scene, 0.5, start=start, **way)
    after = (M * V + m * u) / (M + m)
    np.testing.assert_allclose(run.velocity("b")[-1], after, rtol=0, atol=EXACT)
    np.testing.assert_allclose(run.position("b")[-1], (1.0, 0, 0) + V * t + after * (0.5 - t), rtol=0, atol=EXACT)
    np.testing.assert_allclose(run.velocity("a")[-1], (0.0, 0.4, 0.0), rtol=0, atol=EXACT)
    lost = 0.5 * M * m / (M + m) * np.sum((V - u) ** 2)
    assert run.events == (Event(t, PAYLOAD, "b", pytest.approx(lost, rel=1e-12), mass=5.0),)
    balance = run.energy_balance
    assert balance.dissipated == pytest.approx(lost, rel=1e-12) and balance.work == pytest.approx(0.5 * m * (u @ u), rel=1e-12)
    assert balance.kinetic == pytest.approx(0.5 * ((M + m) * after @ after - M * V @ V), rel=1e-12)
    assert balance.imbalance < 1e-12


def test_what_is_dropped_leaves_with_its_velocity(way):
    """The point goes on as if nothing had been; the energy that goes is that of the mass that does."""
    scene, start = flying(PayloadChange("b", 0.2001, 0.5))
    run = simulate(scene, 0.5, start=start, **way)
    np.testing.assert_allclose(run.position("b")[-1], (1.05, 0.25, 0.1), rtol=0, atol=EXACT)
    balance = run.energy_balance
    assert balance.kinetic == pytest.approx(balance.work, rel=1e-12) == -0.5 * 1.5 * 0.3
    assert run.events[0].lost == balance.by_dampers == balance.by_effects == 0.0
    assert abs(balance.by_method) < 1e-14  # rounding of energies of 0.4 J


def test_changes_in_order(way):
    """Given in any order, two at once and one at the start."""
    changes = [PayloadChange("b", 0.2, 4.0), PayloadChange("a", 0.2, 2.0), PayloadChange("b", 0.0, 3.0, (0.1, 0.5, 0.2))]
    scene, start = flying(*changes)
    run = simulate(scene, 0.4, start=start, **way)
    assert [(event.t, event.where, event.mass) for event in run.events] == [(0.0, "b", 3.0), (0.2, "b", 4.0), (0.2, "a", 2.0)]
    assert np.all(run.t[1:] > run.t[:-1]) and (run.t[0], run.t[-1]) == (0.0, 0.4)
    np.testing.assert_allclose(run.velocity("b")[-1], np.array([0.1, 0.5, 0.2]) * 3.03 / 4.03, atol=EXACT)
    np.testing.assert_allclose(run.velocity("a")[-1], np.array([0.0, 0.4, 0.0]) * 1.03 / 2.03, atol=EXACT)
    assert error_of_steps(run) < 1e-12


@dataclass(frozen=True)
class Heavier(Effect):
    """Added mass A on every moving node, and no force."""

    A: tuple[float, float, float] = (1.0, 2.0, 3.0)

    def table(self, model):
        return np.empty(0, np.int64), np.array(self.A)

    def kernels(self):
        return {"force": still, "tangent": no_slope, "energy": none, "inertia": heavier}


@njit(FORCE_SIGNATURE)
def still(t, q, v, index, params, f):
    return 0.0


@njit(TANGENT_SIGNATURE)
def no_slope(t, q, v, index, params, c_q, c_v, D, near, far):
    pass


@njit(ENERGY_SIGNATURE)
def none(t, q, index, params):
    return 0.0


@njit(INERTIA_SIGNATURE)
def heavier(t, q, index, params, A):
    for i in range(A.shape[0]):
        for x in range(3):
            A[i, x, x] += params[x]


def test_fluid_takes_part(monkeypatch):
    """(M + m + A) v = (M + A) V + m u; what the water gets is lost to the cable."""
    monkeypatch.setitem(REGISTRY.classes, "heavier", Heavier)
    M, m, A, V, u = 2.03, 3.0, np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.5, 0.2]), np.array([-1.0, 0.0, 2.0])
    scene, start = flying(PayloadChange("b", 0.2001, 2.0 + m, u), effects=(Heavier(),))
    run = simulate(scene, 0.5, method="rk4", dt=1e-2, start=start)
    after = ((M + A) * V + m * u) / (M + m + A)
    np.testing.assert_allclose(run.velocity("b")[-1], after, rtol=0, atol=EXACT)
    lost = 0.5 * (M * V @ V + m * u @ u - (M + m) * after @ after)
    assert run.events[0].lost == pytest.approx(lost, rel=1e-12) and error_of_steps(run) < 1e-12


# --- a load that hangs ----------------------------------------------------------------------------------------------------


def hanging(*events, z=0.0, segments=1, payload=2.0, zeta=0.0):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.2, EA=500.0, zeta=zeta, segments=segments)
    return Scene([Fixed("a", (0, 0, z)), Free("b", mass=payload)], [cable], [Gravity(G)], events)


@pytest.mark.parametrize(("method", "dt", "within"), [("rk4", 1e-3, 1e-9), ("edmc", 1e-4, 3e-6), ("dop853", None, 1e-8)])
def test_drop_from_an_elastic_cable(method, dt, within):
    """About the new rest, with the amplitude (M0 - M1) g/k and the frequency sqrt(k/M1); M counts half of the cable."""
    k, M0, M1, t = 500.0, 2.1, 1.6, 0.1003
    scene = hanging(PayloadChange("b", t, 1.5))
    run = simulate(scene, 1.0, method=method, dt=dt, rtol=None if dt else 1e-11)
    rest, omega = -1.0 - M1 * G / k, np.sqrt(k / M1)
    x, v = oscillator(np.maximum(run.t - t, 0.0), omega, 0.0, -(M0 - M1) * G / k, 0.0)
    # order 4; order 2: (omega h)^2/12 of a phase of 26; the tolerance, over 4 swings
    np.testing.assert_allclose(run.position("b")[:, 2], rest + x, rtol=0, atol=within)
    np.testing.assert_allclose(run.velocity("b")[:, 2], v, rtol=0, atol=omega * within)
    assert run.events[0].lost == 0.0 and error_of_steps(run) < 1e-8


@pytest.mark.parametrize("segments", [1, 8])
def test_account_of_energy_in_swing(segments):
    """Whatever the height that heights are counted from."""
    scene = hanging(PayloadChange("b", 0.3017, 3.0, (1.0, 0.5, 0.0)), PayloadChange("b", 0.8, 0.1), segments=segments, zeta=0.1)
    rest = equilibrium(scene)
    start = State(rest.model, 0.0, rest.q, rest.q[:, ::-1] * (-0.5, 0.0, 0.0), rest.segment_tension)
    run = simulate(scene, 1.2, method="edmc", dt=0.01, start=start)
    assert run.ok and error_of_steps(run) < 1e-7  # Newton's tolerance
    high = hanging(*scene.events, z=1e3, segments=segments, zeta=0.1)
    lifted = State(build(high), 0.0, rest.q + np.array([0, 0, 1e3]), start.v, rest.segment_tension)
    above = simulate(high, 1.2, method="edmc", dt=0.01, start=lifted)
    np.testing.assert_allclose(above.energy - above.energy[0], run.energy - run.energy[0], atol=1e-6)  # of 14 J, at 1000 m
    assert above.energy_balance.imbalance < 1e-6


# --- one run --------------------------------------------------------------------------------------------------------------


def test_saved_times_are_those_of_the_run(way):
    """Every row but those at an event are where they would be without it; the row at its time shows the state before."""
    changes = PayloadChange("b", 0.06, 1.0, (9.0, 0, 0)), PayloadChange("b", 0.1111, 5.0, (9.0, 0, 0))
    settings = {"save_every": 0.06, "start": flying()[1]}
    with_events, without = (simulate(flying(*events)[0], 0.3, **settings, **way) for events in (changes, ()))
    np.testing.assert_array_equal(with_events.t, without.t)
    np.testing.assert_allclose(with_events.q[:2], without.q[:2], rtol=0, atol=EXACT)
    assert with_events.velocity("b")[1] == pytest.approx((0.1, 0.5, 0.2)) and with_events.velocity("b")[2][0] > 5.0


def test_two_runs_are_one():
    """Stopped at the very time of a change, and gone on with: the change is the second run's."""
    scene = hanging(PayloadChange("b", 0.2, 0.5), PayloadChange("b", 0.4, 1.0), segments=5)
    whole = simulate(scene, 0.6, method="rk4", dt=1e-4, save_every=0.05)
    first = simulate(scene, 0.2, method="rk4", dt=1e-4)
    second = simulate(scene, 0.2, method="rk4", dt=1e-4, start=first.final)
    third = simulate(scene, 0.2, method="rk4", dt=1e-4, start=second.final)
    assert (first.events, second.events) == ((), whole.events[:1])
    assert [event.t for event in third.events] == [event.t for event in whole.events] == [0.2, 0.4]
    np.testing.assert_allclose(third.q[-1], whole.q[-1], rtol=0, atol=1e-12)  # steps end on roundings of the same times
    at = int(np.flatnonzero(whole.t == 0.2)[0])  # a row that shows the state before what happens then
    assert whole.state(at).events == () and whole.state(at + 1).events == whole.events[:1]
    assert whole.final.events == whole.events


def test_step_is_chosen_for_the_lightest_payload():
    """A net that drops its payload: an explicit step that was stable with it must be so without it."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.2, EA=1e5, segments=1, zeta=0.05)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 50.0)], [cable], [Gravity(G)], [PayloadChange("b", 0.1, 0.0)])
    run = simulate(scene, 0.5, method="verlet")
    assert run.ok and run.dt < 2.0 / np.sqrt(1e5 / 0.1)  # with the payload 0.04 s are stable


def test_default_method_and_audit():
    net = four_cables()
    scene = Scene(net.points, net.cables, net.effects, [PayloadChange("p0", 0.25, 0.2), PayloadChange("p0", 0.7, 0.0)])
    run = simulate(scene, 1.0, audit=True)
    # the net rings axially after the drop, which the steps do not resolve: the run says so, and the audit finds it
    assert run.audit.error < 1e-3 and len(run.events) == 2 and (run.audit.passed or not run.kept)
    assert run.audit.imbalance < 1e-6


def test_extrapolated():
    """Order 4 across a change."""
    scene, errors = hanging(PayloadChange("b", 0.2, 1.5)), []
    exact = simulate(scene, 0.4, method="rk4", dt=1e-4).position("b")[-1]
    for dt in (8e-3, 4e-3):
        run = simulate(scene, 0.4, method="edmc", dt=dt, extrapolate=True, rho_inf=1.0)
        errors.append(np.abs(run.position("b")[-1] - exact).max())
    assert 3.8 < np.log2(errors[0] / errors[1]) < 4.2


def test_saved_and_loaded(tmp_path):
    run = simulate(hanging(PayloadChange("b", 0.2, 0.5)), 0.4)
    run.save(tmp_path / "run.nc")
    back = load_run(tmp_path / "run.nc")
    assert back.events == run.events and back.scene == run.scene
    assert str(back.events[0]) == 't=0.2 s: the payload at point "b" became 0.5 kg'


def test_scene_file(tmp_path):
    scene = hanging(PayloadChange("b", 0.2, 0.5), PayloadChange("b", 0.3, 1.5, (1.0, 0.0, 0.0)))
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene
    entries = scene_to_dict(scene)
    assert entries["events"][0] == {
        "kind": "payload_change", "point": "b", "t": 0.2, "mass": 0.5, "velocity": [0.0, 0.0, 0.0]
    }  # fmt: skip
    assert "events" not in scene_to_dict(hanging())
    entries["events"][0]["kind"] = "payload_chang"
    with pytest.raises(SceneError, match=r'events\[0\]: unknown kind of event .*did you mean "payload_change"'):
        scene_from_dict(entries)


@pytest.mark.parametrize(("events", "message"), [
    ([PayloadChange("a", 0.1, 1.0)], 'must be at a free point, but one is to change at "a", which is none'),
    ([PayloadChange("x", 0.1, 1.0)], 'The scene has no point "x"'),
    ([PayloadChange("b", 0.1, mass) for mass in (1, 2)], 'may change once at a time, but that of "b" does twice at 0.1 s'),
    ([Gravity()], "must hold PayloadChange, CableCut or Release, but holds Gravity"),
    (Gravity(), "Argument `events` of a scene must be a sequence"),
])  # fmt: skip
def test_scene_refuses(events, message):
    with pytest.raises(SceneError, match=message):
        Scene(hanging().points, hanging().cables, (), events)


@pytest.mark.parametrize(("arguments", "message"), [
    (("b", -0.1, 1.0), r'`t` must be non-negative and finite \[s\], but the change of payload at point "b" has t=-0.1'),
    (("b", 0.1, -1.0), r"`mass` must be non-negative and finite \[kg\]"),
    (("b", 0.1, 1.0, (1.0, 2.0)), r"`velocity` must be three finite numbers"),
    (("", 0.1, 1.0), "name of a point"),
])  # fmt: skip
def test_change_refuses(arguments, message):
    with pytest.raises(SceneError, match=message):
        PayloadChange(*arguments)
    with pytest.raises(SceneError, match=r'`volume` must be non-negative and finite \[m³\], but the change .* "b" has volume=-1.0'):
        PayloadChange("b", 0.1, 1.0, volume=-1.0)


# --- a payload with a volume, in water ------------------------------------------------------------------------------------

RHO = 1000.0


@pytest.mark.parametrize(("mass", "volume"), [(5.0, 3e-3), (5.0, 1e-4), (1.0, 3e-3), (1.0, 0.0)])
def test_fluid_comes_and_goes_with_a_volume(mass, volume):
    """What comes brings its added mass at its velocity, what leaves takes its own along: in one step after that nothing slows it.

    Picked up, swapped for more mass of less volume, for less mass of more volume, and dropped.
    """
    cable = Cable("a", "b", length=3.0, mass_per_length=0.02, EA=100.0, segments=1, diameter=1e-4)
    change, u = PayloadChange("b", 1e-4, mass, (-1.0, 0.0, 2.0), volume=volume), np.array([-1.0, 0.0, 2.0])
    points = [Free("a", 1.0), Free("b", 2.0, volume=1e-3, Ca=0.5)]
    scene = Scene(points, [cable], [Gravity(0.0), Water(density=RHO, level=9.0)], [change])
    start = replace(flying()[1], model=build(scene))
    V, A = (
        start.velocity("b"),
        RHO * 0.25 * np.pi * 1e-8 * 1.5 + 0.5 * RHO * 1e-3,
    )  # of half the cable, which lies along x, and the point
    run = simulate(scene, 2e-4, method="rk4", dt=1e-5, start=start)
    kept, new, dA = min(2.0, mass) + 0.03, max(0.0, mass - 2.0), 0.5 * RHO * (volume - 1e-3)
    after = ((kept + A + min(dA, 0.0)) * V + (new + max(dA, 0.0)) * u) / (kept + new + A + dA)
    np.testing.assert_allclose(run.velocity("b")[-1], after, rtol=1e-4)  # across the cable; along it carries no fluid: 1e-5 of it
    lost = 0.5 * (kept * V @ V + new * u @ u - (kept + new) * after @ after)
    assert run.events[0].lost == pytest.approx(lost, rel=1e-3, abs=1e-6) and error_of_steps(run) < 1e-9


def test_litter_with_a_volume_is_lighter_in_water():
    """A load at rest under water takes up litter: pulls, reactions and restarts are of weight less buoyancy."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.2, EA=500.0, zeta=1.0, segments=1, diameter=0.004)
    change = PayloadChange("b", 0.2, 2.5, volume=6e-4, CdA=0.3)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 2.0, volume=1e-4, CdA=0.2)], [cable], [Gravity(G), Water(RHO, 0.5)], [change])
    run = simulate(scene, 8.0, dt=0.01)
    weight = G * (2.5 + 0.1 - RHO * (6e-4 + 0.5 * 0.25 * np.pi * 0.004**2))
    assert run.final.tension("a-b")[0] == pytest.approx(weight, rel=1e-4)
    assert run.final.end_tension("a-b", "b") == pytest.approx(G * (2.5 - RHO * 6e-4), rel=1e-4)
    assert run.energy_balance.imbalance < 1e-9
    assert str(run.events[0]) == 't=0.2 s: the payload at point "b" became 2.5 kg of 0.0006 m³'
    again = simulate(scene, 1.0, dt=0.01, start=run.final)
    np.testing.assert_allclose(again.final.q, run.final.q, atol=1e-6)
    later = replace(scene, events=[change, PayloadChange("b", 8.5, 2.1)])  # its volume stays
    run = simulate(later, 8.0, dt=0.01, start=run.final)
    assert run.final.tension("a-b")[0] == pytest.approx(weight - 0.4 * G, rel=1e-4)


@pytest.mark.slow
def test_a_solver_of_another_package():
    """diffrax starts afresh with what is left, as all do."""
    pytest.importorskip("diffrax")
    scene, start = flying(PayloadChange("b", 0.25, 5.0, (-1.0, 0.0, 2.0)))
    # both stretches save as many states, so that JAX compiles once for both
    run, ours = (simulate(scene, 0.5, start=start, method=method, save_every=0.05) for method in ("Tsit5", "dop853"))
    np.testing.assert_allclose(run.q[-1], ours.q[-1], rtol=0, atol=EXACT)
    np.testing.assert_allclose(run.energy[-1], ours.energy[-1], rtol=1e-12)


def test_payloads_that_change_together_are_taken_together(monkeypatch):
    """What is left was cut anew for each of them: a net of 400 knots took 12 s at the moment, and one of 900 minutes."""
    looks = []
    monkeypatch.setattr(legs, "remainder", lambda *given: looks.append(1) or remainder(*given))
    names = [f"p{i}" for i in range(8)]
    points = [Fixed("a", (0, 0, 0)), *(Free(name, 0.1) for name in names)]
    cables = [
        Cable(a, b, length=1.0, mass_per_length=0.02, EA=1e4, segments=1) for a, b in zip(["a", *names[:-1]], names, strict=True)
    ]
    changes = [PayloadChange(name, 0.1, 0.1 + 0.05 * i, (0.0, 0.0, -0.1 * i)) for i, name in enumerate(names)]
    run = simulate(Scene(points, cables, [Gravity(G)], changes), 0.2, dt=0.01)
    assert len(looks) <= 3 and [event.where for event in run.events] == names
    gained, brought = np.arange(8) * 0.05, np.arange(8) * 0.1
    mass = 0.1 + 0.02 * np.where(np.arange(8) < 7, 1.0, 0.5)  # [kg], before
    lost = 0.5 * mass * gained / (mass + gained) * brought**2  # of what was at rest
    np.testing.assert_allclose([event.lost for event in run.events], lost, rtol=1e-9)
    assert run.energy_balance.imbalance < 1e-9
