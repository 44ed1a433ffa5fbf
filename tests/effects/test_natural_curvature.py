"""Natural curvature: derivatives, energy, the circle at which an arc rests, and what straightens it."""

import math

import numpy as np
import pytest
from test_bending import bent_net, matrix, random_places

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, equilibrium, simulate
from anet_lumped.effects import Bending, Gravity, NaturalCurvature, natural_curvature
from anet_lumped.model.build import build

KAPPA, SEGMENTS = 1.5, 10


def arc(start="a", end="b", effects=(), segments=SEGMENTS):
    """A metre that turns about -y, up from x, clamped along its first segment; from either end."""
    half = 0.5 * KAPPA / segments
    made = dict(length=1.0, mass_per_length=0.1, EA=1e5, EI=1.0, segments=segments, compression="linear", zeta=0.02, name="arc")
    turns = (0.0, -KAPPA if start == "a" else KAPPA, 0.0)
    clamp = Bending({"a": (math.cos(half), 0.0, math.sin(half))})
    points = [Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))]
    return Scene(points, [Cable(start, end, **made)], [clamp, NaturalCurvature({"arc": turns}), *effects])


def curved_net():
    net = bent_net()
    bends = NaturalCurvature({name: (0.3, -1.0, 2.0) for name in ("x-a", "x-y")})
    return Scene(net.points, net.cables, [bends])


def arrays(model):
    (effect,) = model.scene.effects
    shape = (model.n_segments, 2, 3, 3)
    return *effect.table(model), np.zeros((model.n, 3)), np.zeros((model.n_free, 3, 3)), np.zeros(shape), np.zeros(shape)


@pytest.mark.parametrize("seed", range(2))
def test_force_and_tangent_are_the_derivatives_of_the_energy(seed):
    model = build(curved_net())
    q, index, params, f, D, near, far = random_places(model, seed), *arrays(model)
    natural_curvature.force(0.0, q, q, index, params, f)
    natural_curvature.tangent(0.0, q, q, index, params, 1.0, 0.0, D, near, far)
    K, d = matrix(model, D, near, far), np.random.default_rng(seed).normal(size=(model.n_free, 3))
    E, h = natural_curvature.energy(0.0, q, index, params), 10.0 ** -np.arange(2.5, 4.6, 0.5)
    of_energy, of_force = [], []
    for x in h:
        moved, g = q.copy(), np.zeros_like(f)
        moved[: model.n_free] += x * d
        natural_curvature.force(0.0, moved, q, index, params, g)
        rise = natural_curvature.energy(0.0, moved, index, params) - E
        of_energy.append(abs(rise + x * np.sum(f[: model.n_free] * d)))
        of_force.append(np.linalg.norm((g - f)[: model.n_free].ravel() + x * K @ d.ravel()))
    for remainders in (of_energy, of_force):  # Taylor: second order
        assert np.polyfit(np.log(h), np.log(remainders), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_a_step_gives_its_energy_back():
    model = build(curved_net())
    base, q, index, params, f, D, near, far = random_places(model, 1), random_places(model, 51), *arrays(model)
    assert natural_curvature.whole_step(0.0, 0.01, 0.5, base, q, index, params, f, D, near, far) == (0.0, 0.0)
    rise = natural_curvature.energy(0.0, q, index, params) - natural_curvature.energy(0.0, base, index, params)
    assert abs(rise) > 1e-4 and rise == pytest.approx(-np.sum(f * (q - base)), abs=1e-14)
    K, d = matrix(model, D, near, far), np.random.default_rng(1).normal(size=(model.n_free, 3))
    steps, remainders = 10.0 ** -np.arange(2.0, 4.1, 0.5), []
    for x in steps:
        moved, g = q.copy(), np.zeros_like(f)
        moved[: model.n_free] += x * d
        natural_curvature.whole_step(0.0, 0.01, 0.5, base, moved, index, params, g, D, near, far)
        remainders.append(np.linalg.norm((g - f)[: model.n_free].ravel() + x * K @ d.ravel()))
    assert np.polyfit(np.log(steps), np.log(remainders), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("start, end", [("a", "b"), ("b", "a")])
def test_an_arc_rests_as_a_circle(start, end):
    """Its nodes lie on the circle in which chords of L0 turn by kappa L0: of the radius L0/(2 sin(kappa L0/2))."""
    rest = equilibrium(arc(start, end))
    angles = KAPPA / SEGMENTS * np.arange(SEGMENTS + 1)
    radius = 0.5 / SEGMENTS / math.sin(0.5 * KAPPA / SEGMENTS)
    circle = radius * np.column_stack([np.sin(angles), 0.0 * angles, 1.0 - np.cos(angles)])
    assert rest.shape("arc")[:: 1 if start == "a" else -1] == pytest.approx(circle, abs=1e-8)
    assert np.abs(rest.tension("arc")).max() < 1e-6 and rest.stable


def test_a_moment_straightens_it():
    """A level arc with a weight at its end that bends it back: slope kappa - M/EI, in linear theory w = kappa/2 - F/(3 EI)."""
    small, force = 0.02, 0.05
    half = 0.5 * small / 40
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-6, EA=1e6, EI=1.0, segments=40, compression="linear")
    points = [Fixed("a", (0, 0, 0)), Free("b", force / 9.81, at=(1, 0, 0))]
    effects = [Gravity(9.81), Bending({"a": (1.0, 0.0, half)}), NaturalCurvature({"a-b": (0, -small, 0)})]
    end = equilibrium(Scene(points, [cable], effects)).position("b")[2]
    assert end == pytest.approx(0.5 * small - force / 3.0, abs=2e-5)  # of second order in the segments and in the angles


def test_a_straight_rod_springs_into_its_arc_and_keeps_its_energy():
    run = simulate(arc(), 0.3, start="straight", method="edmc", dt=0.002)
    assert run.ok and run.energy_balance.imbalance < 1e-6
    kappa_energy = 1.0 * SEGMENTS * (1.0 - math.cos(KAPPA / SEGMENTS)) * (SEGMENTS - 1)
    assert run.energy[0, 2] == pytest.approx(kappa_energy + 2.0 * SEGMENTS * (1.0 - math.cos(0.5 * KAPPA / SEGMENTS)))
    assert run.energy[:, 0].max() > 0.3 * run.energy[0, 2]


def test_it_needs_a_cable_that_bends():
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [Cable("a", "b", length=1.0, mass_per_length=1.0, EA=1.0, segments=2)],
                  [NaturalCurvature({"a-b": (0, 1, 0)})])  # fmt: skip
    with pytest.raises(SceneError, match=r'A cable with a natural curvature needs an `EI` \[N m2\], but cable "a-b" has none'):
        build(scene)
