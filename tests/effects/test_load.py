"""A distributed load: statics against catenary and parabola, its growth, its energy."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, equilibrium, load_scene, save_scene, simulate
from anet_lumped.effects import Gravity, Load
from anet_lumped.model.build import build
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.statics.catenary import catenary

G, MU = 9.81, 0.2
SIDE = (0.0, 3.0, 0.0)  # [N/m]


def span(*effects, segments=40, length=1.2, EA=2e3, **kwargs):
    cable = Cable("a", "b", length=length, mass_per_length=MU, EA=EA, segments=segments, **kwargs)
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable], effects)


def test_weight_by_another_name():
    """A load of mu g is the weight, bit by bit but for the order of products."""
    loaded, heavy = (equilibrium(span(effect)) for effect in (Load((0.0, 0.0, -MU * G)), Gravity(G)))
    np.testing.assert_allclose(loaded.q, heavy.q, rtol=0, atol=1e-13)


def test_catenary_of_weight_and_load_together():
    """In the plane that the two span together the cable is the elastic catenary of |mu g + p|, with an error of n^-2."""
    errors = []
    whole = math.hypot(MU * G, SIDE[1])
    truth = catenary((0, 0), (1, 0), length=1.2, EA=2e3, mass_per_length=whole / G, gravity=G)
    for n in (20, 40, 80):
        rest = equilibrium(span(Gravity(G), Load(SIDE), segments=n))
        middle = rest.shape("a-b")[n // 2]
        assert middle[1] / middle[2] == pytest.approx(-SIDE[1] / (MU * G), rel=1e-10)  # statics are solved to rounding
        depth = -float(truth.point(0.6)[1])
        errors.append(abs(math.hypot(*middle[1:]) - depth))
    assert errors[-1] < 1e-3
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(slopes, 2.0, atol=0.1)


def test_parabola_of_a_taut_cable():
    """A level span of a metre and small sag f: H = p/(8 f) with p over the span, and the cable is longer by 8 f^2/3."""
    p, H, EA = 3.0, 600.0, 2e5
    f = p / (8.0 * H)
    length = (1.0 + 8.0 * f * f / 3.0) / (1.0 + H / EA)
    rest = equilibrium(span(Load((0.0, p / length, 0.0)), length=length, EA=EA, segments=200))
    # terms of f^2 beside one and n^-2; the length makes the strain of 3e-3, which is some hundred times more sensitive
    assert rest.tension("a-b")[100] == pytest.approx(H, rel=1e-3)
    assert rest.shape("a-b")[100, 1] == pytest.approx(p / (8.0 * rest.tension("a-b")[100]), rel=1e-4)


def test_only_cables_named():
    cables = [Cable(a, "p", length=1.0, mass_per_length=MU, EA=1e3, segments=4) for a in "ab"]
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0)), Free("p")], cables, [Load(SIDE, cables=("b-p",))])
    model = build(scene)
    _, params = scene.effects[0].table(model)
    f = np.zeros((model.n, 3))
    f[: model.n_free] = params[1:].reshape(-1, 3)
    np.testing.assert_array_equal(f[model.nodes("a-p")[:-1]], 0.0)
    np.testing.assert_allclose(f[model.nodes("b-p")[1:-1]], np.outer([1, 1, 1], SIDE) / 4)
    np.testing.assert_allclose(f[model.node("p")], np.array(SIDE) / 8)  # half a segment ends there


@pytest.mark.each_once
@pytest.mark.parametrize("ramp", [0.0, 0.3])
@pytest.mark.parametrize(("method", "within"), [("edmc", 1e-6), ("rk4", 1e-4), ("dop853", 1e-6), ("Radau", 1e-6)])
def test_account_of_energy(ramp, method, within):
    """Potential energy of a constant load, energy that a growing one gives: both close, to the scheme's own error."""
    scene = span(Gravity(G), Load((0.0, 3.0, 1.0), ramp=ramp), segments=5, EA=100.0, zeta=0.1)
    still = equilibrium(span(Gravity(G), segments=5, EA=100.0, zeta=0.1))
    run = simulate(scene, 0.6, method=method, dt=None if method in ("dop853", "Radau") else 1e-3, start=still)
    assert run.ok and error_of_steps(run) < within
    given = run.energy[-1, 5] if ramp else 0.0
    assert given < 0.0 if ramp else run.energy[-1, 2] < run.energy[0, 2] - 0.1


@pytest.mark.parametrize("method", ["edmc", "rk4"])
def test_growth(method):
    """Of a free mass: m v = p L0/2 integral of s^3 (6 s^2 - 15 s + 10), which is t_ramp (s^6 - 3 s^5 + 5/2 s^4)."""
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=100.0, segments=1)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 1.0, at=(0.1, 0, 0))], [cable], [Load((0.0, 4.0, 0.0), ramp=0.5)])
    run = simulate(scene, 0.6, method=method, dt=1e-3, start="straight", save_every=0.1)
    s = np.minimum(run.t / 0.5, 1.0)
    impulse = 0.5 * (s**6 - 3.0 * s**5 + 2.5 * s**4) + np.maximum(run.t - 0.5, 0.0)
    # the midpoint rule on a smooth force: h^2/24 of the difference of its slopes, 1e-7
    np.testing.assert_allclose(run.velocity("b")[:, 1], 2.0 * impulse / (1.0 + 0.5 * MU), rtol=0, atol=1e-6)


def test_starts_from_rest_without_it():
    """Statics at t = 0 know nothing of a load that grows from there."""
    grown, never = span(Gravity(G), Load(SIDE, ramp=1.0)), span(Gravity(G))
    np.testing.assert_allclose(equilibrium(grown).q, equilibrium(never).q, rtol=0, atol=1e-8)  # relaxed against exact


def test_scene_file(tmp_path):
    scene = span(Load(SIDE, cables=("a-b",), ramp=2.0))
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene


@pytest.mark.parametrize(("arguments", "message"), [
    ({"per_length": (1.0, 2.0)}, r"`per_length` must be three finite numbers"),
    ({"per_length": SIDE, "ramp": -1.0}, r"`ramp` must be non-negative and finite \[s\], but effect Load has ramp=-1.0"),
    ({"per_length": SIDE, "cables": "a-b"}, "sequence of names, or None for all, but effect Load has cables='a-b'"),
    ({"per_length": SIDE, "cables": ()}, "`cables` must be a sequence of names"),
    ({"per_length": SIDE, "cables": (3,)}, "names, or None for all, but effect Load has cables=\\(3,\\)"),
])  # fmt: skip
def test_refuses(arguments, message):
    with pytest.raises(SceneError, match=message):
        Load(**arguments)


def test_unknown_cable():
    with pytest.raises(SceneError, match='no cable "a-c", did you mean "a-b"'):
        build(span(Load(SIDE, cables=("a-c",))))


def test_diffrax_refuses_by_name():
    pytest.importorskip("diffrax")
    with pytest.raises(
        ValueError,
        match=r"that JAX can trace, .*, but Load is none .*; take a method of this package or",
    ):
        simulate(span(Gravity(G), Load(SIDE), segments=3), 0.1, method="Tsit5")
