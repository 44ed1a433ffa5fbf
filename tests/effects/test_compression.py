"""A spring that pushes less than it pulls: its law between two lengths in exact arithmetic, a bounce, scene files."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, State, simulate
from anet_lumped.effects.laws import axial
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.model.build import build
from anet_lumped.results.energy_balance import error_of_steps
from integrators import schemes

EPS = np.finfo(float).eps
EA, M = 100.0, 0.5
STRETCHES = st.floats(-0.9, 3.0).map(lambda x: round(x * 2**40) / 2**40)
STABLE = schemes.names(own=True, stable_undamped=True)


def bouncer(part, zeta=0.0, segments=1, mass_per_length=1e-9):
    cable = Cable(
        "a", "b", length=1.0, mass_per_length=mass_per_length, EA=EA, BA=zeta, segments=segments, compression="damped",
        EA_compression=part * EA,
    )  # fmt: skip
    return Scene([Fixed("a", (0, 0, 0)), Free("b", M)], [cable])


def pushed(scene, speed):
    model = build(scene)
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    nodes = model.nodes("a-b")
    q[nodes, 0] = np.linspace(0.0, 1.0, len(nodes))
    v[model.node("b"), 0] = speed
    return State(model, 0.0, q, v, np.zeros(model.n_segments))


@tried(300)
@given(a=STRETCHES, b=STRETCHES, part=st.floats(0.0, 1.0), near=st.booleans())
def test_secant(a, b, part, near):
    """The secant of the energy k/2 x^2 times 1 or the part, and its slope in b."""
    b = a + 1e-9 * b if near else b
    k, A, B, r = Fraction(37), Fraction(a), Fraction(b), Fraction(part)
    T, slope = axial.secant_tension(a, b, 37.0, part)

    def psi(x):
        return k * x * x / 2 * (1 if x > 0 else r)

    exact = (psi(B) - psi(A)) / (B - A) if A != B else k * A * (1 if A > 0 else r)
    assert T == pytest.approx(float(exact), abs=16 * EPS * 37.0 * (abs(a) + abs(b)))
    assert axial.spring_energy(a, 37.0, part) == pytest.approx(float(psi(A)), rel=4 * EPS)
    if abs(B - A) > 1e-3 and min(abs(a), abs(b)) > 1e-6:
        step = Fraction(1, 2**30)
        of_b = [(psi(x) - psi(A)) / (x - A) for x in (B - step, B + step)]
        # the central difference is off by the third derivative, below k/(b - a)^2, times step^2
        assert slope == pytest.approx(float((of_b[1] - of_b[0]) / (2 * step)), abs=1e-9 * 37.0)


@pytest.mark.parametrize("part", [0.0, 1.0])
def test_ends_of_its_range_are_the_other_laws(part):
    scene = bouncer(part, zeta=0.3)
    law = {0.0: "damped", 1.0: "linear"}[part]
    other = Cable("a", "b", length=1.0, mass_per_length=1e-9, EA=EA, BA=0.3, segments=1, compression=law)
    np.testing.assert_array_equal(build(scene).axial, build(Scene(scene.points, [other])).axial)


@pytest.mark.parametrize("method", STABLE)
def test_bounce(method):
    """Half a swing on each side of L0: pi sqrt(m/k) when taut, pi sqrt(m/(r k)) when short, and v again at the end."""
    part, speed = 0.25, 0.3
    scene = bouncer(part)
    omega = math.sqrt(EA / M)
    period = math.pi / omega * (1.0 + 1.0 / math.sqrt(part))
    options = {"rho_inf": 1.0} if "rho_inf" in schemes.scheme(method).options else {}
    run = simulate(scene, period, method=method, dt=period / 2400, start=pushed(scene, speed), save_every=period / 240, **options)
    # a step is 1/2400 of the period, and both extremes, at 1/6 and 2/3 of it, are saved
    x, v = run.position("b")[:, 0] - 1.0, run.velocity("b")[:, 0]
    first = 4e-2 if method == "backward_euler" else 2e-3 if schemes.scheme(method).order == 1 else 1e-4  # a step of 1/2000 period
    assert x.max() == pytest.approx(speed / omega, rel=first)
    assert x.min() == pytest.approx(-speed / omega / math.sqrt(part), rel=first)
    assert v[-1] == pytest.approx(speed, rel=first) and abs(x[-1]) < first * speed / omega
    if method == "edmc":
        energy = run.energy[:, :2].sum(axis=1)
        np.testing.assert_allclose(energy, energy[0], rtol=1e-9)  # exact but for Newton's tolerance, over 2400 steps


def test_energy_never_rises_and_newton_finds_every_step():
    """A chain struck along itself buckles and snaps, with steps that resolve none of it."""
    scene = bouncer(0.1, zeta=0.5, segments=8, mass_per_length=0.1)
    start = pushed(scene, -2.0)
    start.q[: start.model.n_free, 1] += 1e-3 * np.random.default_rng(2).normal(size=start.model.n_free)
    run = simulate(scene, 2.0, method="edmc", dt=0.01, start=start, save_every=0.01)
    assert run.ok and run.work.halvings == 0
    energy = run.energy[:, :2].sum(axis=1)
    # Newton leaves 1e-10 of a step's energy at most, in 200 steps
    assert np.diff(energy).max() < 1e-9 * energy[0] and error_of_steps(run) < 1e-7
    assert run.tension("a-b").min() < 0.0 < run.tension("a-b").max()


def test_scene_file(tmp_path):
    save_scene(bouncer(0.25), tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == bouncer(0.25)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"EA_compression": -1.0}, r"`EA_compression` must be non-negative and finite \[N\]"),
        ({"EA_compression": 2e3}, 'must not exceed a finite EA and needs compression="damped", but cable "a-b" has EA_compr'),
        ({"EA_compression": 5.0, "compression": "none"}, "EA_compression=5.0, EA=1000.0 and compression='none'"),
        ({"EA_compression": 5.0, "compression": "linear"}, "compression='linear'"),
        ({"EA_compression": 5.0, "EA": math.inf}, "EA=inf"),
    ],
)
def test_messages(given, message):
    made = dict(length=1.0, mass_per_length=0.1, EA=1e3, segments=2, compression="damped") | given
    with pytest.raises(SceneError, match=message):
        Cable("a", "b", **made)
