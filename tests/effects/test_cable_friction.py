"""Friction along and across cables, from the equation and in closed form."""

import numpy as np
import pytest

from anet_lumped import Cable, Free, Scene, SceneError, State, simulate
from anet_lumped.effects import CableFriction, Gravity, Ground, cable_friction
from anet_lumped.model.build import build

MU, g, D, N_SEGMENTS, STIFFNESS = 2.0, 9.81, 0.05, 4, 1e5
FRICTION = CableFriction(0.2, 0.7, stiffness=STIFFNESS, slip_speed=1e-3)


def lying(angle=0.0, friction=FRICTION):
    """Two metres of cable on the ground, which nothing holds; pressed in by its weight."""
    c, s = np.cos(angle), np.sin(angle)
    z = -MU * g / (STIFFNESS * D)
    cable = Cable("a", "b", length=2.0, mass_per_length=MU, EA=1e5, zeta=0.3, segments=N_SEGMENTS, diameter=D, compression="linear")
    points = [Free("a", at=(0, 0, z)), Free("b", at=(2 * c, 2 * s, z))]
    return Scene(points, [cable], [Gravity(g), Ground(stiffness=STIFFNESS, damping=1e3, friction=0.0), friction])


def scattered(seed):
    model, rng = build(lying()), np.random.default_rng(seed)
    q = 0.01 * rng.normal(size=(model.n, 3))
    q[model.nodes("a-b"), 0] += np.linspace(0.0, 2.0, N_SEGMENTS + 1)
    return model, *FRICTION.table(model), q, 3e-3 * rng.normal(size=(model.n, 3))


def naive(model, q, v):
    f, u = np.zeros_like(q), FRICTION.slip_speed
    for i, j in model.ends:
        e = (q[j] - q[i]) * (1, 1, 0)
        e /= np.linalg.norm(e)
        n = np.cross((0, 0, 1), e)
        for node in (i, j):
            N = max(0.0, -q[node, 2]) * STIFFNESS * D * 2.0 / N_SEGMENTS / 2
            for mu, axis in ((0.2, e), (0.7, n)):
                speed = v[node] @ axis
                f[node] -= mu * N * speed / np.hypot(speed, u) * axis
    return f


@pytest.mark.parametrize("seed", range(3))
def test_law_and_slopes(seed):
    """The slope in velocities and in z, but for the turning of segments: only z and velocities are moved."""
    model, index, params, q, v = scattered(seed)
    f = np.zeros_like(q)
    power = cable_friction.force(0.0, q, v, index, params, f)
    np.testing.assert_allclose(f, naive(model, q, v), rtol=1e-12, atol=1e-14)
    assert power == pytest.approx(-np.sum(f * v), rel=1e-12) and power > 0.0
    rng, c_q, c_v, h = np.random.default_rng(seed), 0.5, 2.0, 1e-7
    d, w = np.zeros_like(q), rng.normal(size=q.shape)
    d[:, 2] = rng.normal(size=model.n)
    blocks, none = np.zeros((model.n_free, 3, 3)), np.zeros((0, 2, 3, 3))
    cable_friction.tangent(0.0, q, v, index, params, c_q, 0.0, blocks, none, none)
    found = -np.einsum("nxy,ny->nx", blocks, d)
    expected = c_q * (naive(model, q + h * d, v) - naive(model, q - h * d, v)) / (2 * h)
    np.testing.assert_allclose(found, expected, atol=1e-5 * np.abs(expected).max())
    blocks[:] = 0.0
    cable_friction.tangent(0.0, q, v, index, params, 0.0, c_v, blocks, none, none)
    expected = c_v * (naive(model, q, v + h * w) - naive(model, q, v - h * w)) / (2 * h)
    np.testing.assert_allclose(-np.einsum("nxy,ny->nx", blocks, w), expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("h", [1e-3, 1e-1])
def test_a_step_only_takes(h):
    model, index, params, q, v = scattered(7)
    base, f, D_, none = q - h * v, np.zeros_like(q), np.zeros((model.n_free, 3, 3)), np.zeros((0, 2, 3, 3))
    taken, by_method = cable_friction.whole_step(0.0, h, 0.5, base, q, index, params, f, D_, none, none)
    assert by_method == 0.0 and taken == pytest.approx(-np.sum(f * (q - base)), rel=1e-12) and taken > 0.0
    d = np.zeros_like(q)
    d[:, 2] = np.random.default_rng(1).normal(size=model.n)
    ends = []
    for x in (1e-8, -1e-8):
        g_ = np.zeros_like(q)
        cable_friction.whole_step(0.0, h, 0.5, base, q + x * d, index, params, g_, np.zeros_like(D_), none, none)
        ends.append(g_)
    expected = (ends[0] - ends[1]) / 2e-8
    np.testing.assert_allclose(-np.einsum("nxy,ny->nx", D_, d), expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("angle", [0.0, 0.6])
@pytest.mark.parametrize(("across", "mu"), [(False, 0.2), (True, 0.7)], ids=["along", "across"])
def test_a_cable_that_slides_stops_after_v2_over_2_mu_g(angle, across, mu):
    """At 0.5 m/s along itself or across itself; the slip speed of 1 mm/s is 2e-3 of that, and takes some 1e-3 of the way."""
    scene = lying(angle)
    e = np.array([np.cos(angle), np.sin(angle), 0.0])
    direction = np.array([-e[1], e[0], 0.0]) if across else e
    start = State.of(scene, shapes={}, velocities=dict.fromkeys(("a-b", "a", "b"), 0.5 * direction))
    run = simulate(scene, 0.5 / (mu * g) * 1.5, method="edmc", dt=5e-4, start=start)
    moved = run.position("a")[-1] - run.position("a")[0]
    assert run.ok and run.energy_balance.imbalance < 1e-6
    assert moved @ direction == pytest.approx(0.25 / (2 * mu * g), rel=5e-3)
    assert np.linalg.norm(np.cross(moved, direction)) < 1e-3 * (moved @ direction)


def test_no_diameter():
    cable = Cable("a", "b", length=2.0, mass_per_length=MU, EA=1e5, segments=2)
    with pytest.raises(SceneError, match=r'CableFriction needs the `diameter` .* but cable "a-b" has none'):
        build(Scene([Free("a", at=(0, 0, 0)), Free("b", at=(2, 0, 0))], [cable], [FRICTION]))
