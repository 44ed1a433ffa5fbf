"""Thermal strain: closed forms in statics and in every scheme, the energy it puts in, scene files."""

import dataclasses

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, equilibrium, simulate
from anet_lumped.effects import AxialDamping, Gravity, Temperature
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.model.build import build
from anet_lumped.model.remainder import remainder
from anet_lumped.prescribed import signals
from anet_lumped.results.energy_balance import error_of_steps
from integrators import schemes

ALPHA, EA, BA = 1.2e-5, 1e4, 0.2
STABLE = schemes.names(own=True, stable_undamped=True)


def clamped(change, span=1.01, segments=10, **kwargs):
    """A metre of cable stretched between two points."""
    made = dict(length=1.0, mass_per_length=0.1, EA=EA, BA=BA, segments=segments) | kwargs
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (span, 0, 0))]
    return Scene(points, [Cable("a", "b", **made)], [Temperature(ALPHA, change)])


def hanging(change, mass=0.5):
    cable = Cable("a", "b", length=2.0, mass_per_length=0.1, EA=EA, segments=10)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass)], [cable], [Gravity(), Temperature(ALPHA, change)])


@pytest.mark.parametrize("change", [-50.0, 200.0])
def test_at_rest(change):
    """A clamped cable loses EA alpha dT of its tension; a hanging one lengthens by alpha dT L, and EA/L0 stays."""
    T = equilibrium(clamped(change)).tension("a-b")
    np.testing.assert_allclose(T, EA * (0.01 - ALPHA * change), rtol=1e-9)  # lengths near 1 to 1e-14, over strains of 1e-2
    cold, warm = (equilibrium(hanging(dT)) for dT in (0.0, change))
    grown = cold.position("b")[2] - warm.position("b")[2]
    assert grown == pytest.approx(ALPHA * change * 2.0, rel=1e-9)
    np.testing.assert_allclose(warm.tension("a-b"), cold.tension("a-b"), rtol=1e-12)


def test_cables_that_are_not_named_stay():
    two = [Cable(*ends, length=1.0, mass_per_length=0.1, EA=EA, segments=5) for ends in ("am", "mb")]
    points = [Fixed("a", (0, 0, 0)), Free("m"), Fixed("b", (2.02, 0, 0))]
    rest = equilibrium(Scene(points, two, [Temperature({"m-b": ALPHA}, 100.0)]))
    np.testing.assert_allclose(rest.tension("a-m"), EA * (0.02 - ALPHA * 100.0) / 2.0, rtol=1e-9)


@pytest.mark.parametrize("method", STABLE)
def test_clamped_in_time(method):
    """T = EA (eps - alpha dT) - BA alpha dT'/dt, and -T dL0/dt is put in: all its strain energy EA eps^2/2 L and dissipation."""
    rate, ramp, t = 200.0, 0.5, 1.5
    dt = {} if schemes.scheme(method).explicit else {"dt": 0.01}
    run = simulate(clamped(signals.line(0.0, rate, ramp)), t, method=method, **dt)
    assert run.ok, run.message
    hot = rate * (t - ramp / 2.0)
    # what a ramp leaves of motion is below 1e-8 of the tension; these two tell of the mean of a step that resolves no stretching
    late = 0.5 * 0.01 * EA * ALPHA * rate if method in ("midpoint", "sdirk2") else 0.0
    np.testing.assert_allclose(run.tension("a-b")[-1], EA * (0.01 - ALPHA * hot) - BA * ALPHA * rate + late, rtol=1e-5)
    assert run.energy_balance.elastic == pytest.approx(0.5 * EA * ((0.01 - ALPHA * hot) ** 2 - 0.01**2), rel=1e-6)
    # of schemes with stages each takes the power of its own time: work that grows like a ramp is off by the step
    bound = {"edmc": 1e-9} | dict.fromkeys(("backward_euler", "midpoint", "sdirk2"), 1e-2)
    assert error_of_steps(run) < bound.get(method, 1e-6)


def test_order():
    """A hanging cable that is heated and cooled: edmc tends to the tight answer of dop853 with the square of its step."""
    scene = hanging(signals.harmonic(0.0, 500.0, 1.0, ramp=1.0), mass=50.0)
    exact = simulate(scene, 1.0, method="dop853", rtol=1e-10, atol=1e-13, save_every=0.1)
    off = []
    for dt in (0.01, 0.005, 0.0025, 0.00125, 0.000625):
        run = simulate(scene, 1.0, method="edmc", dt=dt, rho_inf=1.0, save_every=0.1)
        off.append(np.abs(run.q - exact.q).max())
    slopes = np.diff(np.log(off)) / np.log(0.5)
    np.testing.assert_allclose(slopes, 2.0, atol=0.15)


def test_goes_slack_and_taut_again():
    """Heated until the cable hangs slack; the energy is accounted for, and it comes back to its tension."""
    scene = clamped(signals.samples((0.0, 0.5, 1.5, 2.0), (0.0, 2000.0, 2000.0, 0.0)), zeta=0.2, BA=None)
    scene = Scene(scene.points, scene.cables, [*scene.effects, Gravity()])
    run = simulate(scene, 2.5, audit=0.05)  # of a sag of 7 cm that it drops into
    assert run.ok, run.message
    assert error_of_steps(run) < 1e-3  # of verlet, which is the default here: its energy swings about one that it keeps
    assert run.tension("a-b").min() < 0.1 * run.tension("a-b")[0].min()


def test_what_is_left_of_a_broken_cable_keeps_its_temperature():
    """Both pieces of a named cable that snaps are as warm as it was, and as damped."""
    two = [Cable(*ends, length=1.0, mass_per_length=0.1, EA=EA, segments=4) for ends in ("am", "mb")]
    cables = [two[0], dataclasses.replace(two[1], breaking_tension=1.0)]
    points = [Fixed("a", (0, 0, 0)), Free("m"), Fixed("b", (2.02, 0, 0))]
    scene = Scene(points, cables, [Temperature({"m-b": ALPHA}, 100.0), AxialDamping({"m-b": 1.0}), Gravity()])
    left = remainder(build(scene), {}, {"m-b": (1,)}).model.scene
    pieces = [cable.name for cable in left.cables if cable.name != "a-m"]
    assert len(pieces) == 2
    assert left.effects[:2] == (Temperature({name: ALPHA for name in pieces}, 100.0), AxialDamping({name: 1.0 for name in pieces}))


def test_a_scene_without_it_has_nothing_of_it():
    model = equilibrium(Scene(hanging(0.0).points, hanging(0.0).cables, [Gravity()])).model
    assert len(model.lengths.cable) == 0 and len(model.lengths.mass_node) == 0


def test_scene_file(tmp_path):
    for change in (20.0, signals.line(0.0, 3.0, 1.0), signals.samples((0, 1, 2), (0, 4, 1)), signals.harmonic(1.0, 2.0, 3.0, 0.5)):
        for expansion in (ALPHA, {"a-b": ALPHA}):
            scene = Scene(clamped(0.0).points, clamped(0.0).cables, [Temperature(expansion, change)])
            save_scene(scene, tmp_path / "scene.toml")
            assert load_scene(tmp_path / "scene.toml") == scene


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Temperature("1e-5", 1.0), r"`expansion` must be a finite number \[1/K\], but effect Temperature has"),
        (lambda: Temperature({"a-b": np.inf}, 1.0), 'but effect Temperature of cable "a-b" has expansion=inf'),
        (
            lambda: Temperature(1e-5, "hot"),
            r"`change` must be a finite number \[K\] or a signal of .*, but effect Temp",
        ),
        (lambda: equilibrium(clamped(-1e5)), 'A cable must keep at least 0.001 of its length, but of cable "a-b" with length=1 m'),
        (lambda: Temperature({"x": 1e-5}, 1.0).length_changes(clamped(0.0)), 'The scene has no cable "x"'),
        (lambda: simulate(clamped(1.0), 1.0, method="Radau"), "Lengths that change in time need a method of this package, .*Radau"),
    ],
)
def test_messages(make, message):
    with pytest.raises((SceneError, ValueError), match=message):
        make()
