"""Friction along and across cables on a height map, from the equation, in closed form on a slope, and level as `CableFriction`."""

import numpy as np
import pytest

from anet_lumped import Cable, Free, Scene, SceneError, State, simulate
from anet_lumped.effects import CableFriction, CableFrictionMap, Gravity, GroundMap, cable_friction, cable_friction_map
from anet_lumped.model.build import build

MU, g, D, N_SEGMENTS, STIFFNESS, SLOPE = 2.0, 9.81, 0.05, 4, 1e5, 0.15
GRID = {"x": (-10.0, 10.0), "y": (-10.0, 10.0)}
ALONG, ACROSS, U = 0.3, 0.7, 1e-3


def floor(slope):
    return GRID | {"heights": ((-10.0 * slope,) * 2, (10.0 * slope,) * 2), "stiffness": STIFFNESS}


def friction(slope=SLOPE):
    return CableFrictionMap(ALONG, ACROSS, **floor(slope), slip_speed=U)


def lying(way, slope=SLOPE):
    """Two metres of cable that lie on the slope along a direction in its plane, pressed in by their weight."""
    cos = 1.0 / np.hypot(1.0, slope)
    sunk = np.array((0.0, 0.0, MU * g * cos**2 / (STIFFNESS * D)))  # N/cos = k s/cos^2 carries w cos
    cable = Cable("a", "b", length=2.0, mass_per_length=MU, EA=1e5, zeta=0.3, segments=N_SEGMENTS, diameter=D, compression="linear")
    points = [Free("a", at=-sunk), Free("b", at=2.0 * np.array(way) - sunk)]
    effects = [Gravity(g), GroundMap(**floor(slope), damping=1e3, friction=0.0), friction(slope)]
    return Scene(points, [cable], effects)


def scattered(seed, slope=SLOPE):
    model, rng = build(lying((1.0, 0.0, slope), slope)), np.random.default_rng(seed)
    q = 0.01 * rng.normal(size=(model.n, 3))
    q[model.nodes("a-b"), 0] += np.linspace(0.0, 2.0, N_SEGMENTS + 1)
    q[:, 2] += slope * q[:, 0]
    return model, q, 3e-3 * rng.normal(size=(model.n, 3))


def naive(model, q, v):
    f, n = np.zeros_like(q), np.array((-SLOPE, 0.0, 1.0)) / np.hypot(1.0, SLOPE)
    for i, j in model.ends:
        e = (q[j] - q[i]) - ((q[j] - q[i]) @ n) * n
        e /= np.linalg.norm(e)
        for node in (i, j):
            N = max(0.0, SLOPE * q[node, 0] - q[node, 2]) * STIFFNESS * D * 2.0 / N_SEGMENTS / 2 / n[2]
            for mu, axis in ((ALONG, e), (ACROSS, np.cross(n, e))):
                speed = v[node] @ axis
                f[node] -= mu * N * speed / np.hypot(speed, U) * axis
    return f


@pytest.mark.parametrize("seed", range(3))
def test_law_and_slopes(seed):
    """The slopes in velocities and by the depth, but for the turning of segments: nodes are moved along z alone."""
    model, q, v = scattered(seed)
    index, params = friction().table(model)
    f = np.zeros_like(q)
    power = cable_friction_map.force(0.0, q, v, index, params, f)
    np.testing.assert_allclose(f, naive(model, q, v), rtol=1e-11, atol=1e-13)
    assert power == pytest.approx(-np.sum(f * v), rel=1e-12) and power > 0.0
    rng, h, none = np.random.default_rng(seed), 1e-7, np.zeros((0, 2, 3, 3))
    w, blocks = rng.normal(size=q.shape), np.zeros((model.n_free, 3, 3))
    cable_friction_map.tangent(0.0, q, v, index, params, 0.0, 2.0, blocks, none, none)
    expected = 2.0 * (naive(model, q, v + h * w) - naive(model, q, v - h * w)) / (2 * h)
    np.testing.assert_allclose(-np.einsum("nxy,ny->nx", blocks, w), expected, atol=1e-5 * np.abs(expected).max())
    moved = np.zeros_like(q)
    moved[:, 2] = 1.0  # all alike, so that no segment turns
    blocks[:] = 0.0
    cable_friction_map.tangent(0.0, q, v, index, params, 0.5, 0.0, blocks, none, none)
    expected = 0.5 * (naive(model, q + h * moved, v) - naive(model, q - h * moved, v)) / (2 * h)
    np.testing.assert_allclose(-np.einsum("nxy,ny->nx", blocks, moved), expected, atol=1e-5 * np.abs(expected).max())


def test_level_it_is_cable_friction():
    model, q, v = scattered(5, slope=0.0)
    own, flat = friction(0.0), CableFriction(ALONG, ACROSS, stiffness=STIFFNESS, slip_speed=U)
    forces = np.zeros((2, *q.shape))
    cable_friction_map.force(0.0, q, v, *own.table(model), forces[0])
    cable_friction.force(0.0, q, v, *flat.table(model), forces[1])
    np.testing.assert_allclose(forces[0], forces[1], rtol=1e-12, atol=1e-14)
    steps = [np.zeros_like(q), np.zeros_like(q), np.zeros((model.n_free, 3, 3)), np.zeros((model.n_free, 3, 3))]
    none, taken = np.zeros((0, 2, 3, 3)), []
    for k, (module, effect) in enumerate(((cable_friction_map, own), (cable_friction, flat))):
        taken.append(module.whole_step(0.0, 0.01, 0.5, q - 0.01 * v, q, *effect.table(model), steps[k], steps[2 + k], none, none))
    np.testing.assert_allclose(steps[0], steps[1], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(steps[2], steps[3], rtol=1e-9, atol=1e-9)
    assert taken[0] == pytest.approx(taken[1], rel=1e-12) and taken[0][0] > 0.0


DOWN = np.array((-1.0, 0.0, -SLOPE)) / np.hypot(1.0, SLOPE)
LEVEL = np.array((0.0, 1.0, 0.0))


@pytest.mark.parametrize(("way", "mu"), [(-DOWN, ALONG), (LEVEL, ACROSS)], ids=["along", "across"])
def test_a_cable_that_slides_down_a_slope_stops(way, mu):
    """At 0.5 m/s, after v^2/2g(mu cos - sin); the slip speed of 1 mm/s takes some 1e-3 of the way, and lets it creep on."""
    scene, cos = lying(way), 1.0 / np.hypot(1.0, SLOPE)
    start = State.of(scene, velocities=dict.fromkeys(("a-b", "a", "b"), 0.5 * DOWN))
    slower = g * cos * (mu - SLOPE)
    run = simulate(scene, 0.5 / slower * 1.2, method="edmc", dt=5e-4, start=start)
    moved = run.position("a")[-1] - run.position("a")[0]
    assert run.ok and run.energy_balance.imbalance < 1e-6
    assert moved @ DOWN == pytest.approx(0.25 / (2 * slower), rel=6e-3)


def test_what_is_refused():
    cable = Cable("a", "b", length=2.0, mass_per_length=MU, EA=1e5, segments=2)
    with pytest.raises(SceneError, match=r'CableFrictionMap needs the `diameter` .* but cable "a-b" has none'):
        build(Scene([Free("a", at=(0, 0, 0)), Free("b", at=(2, 0, 0))], [cable], [friction()]))
    with pytest.raises(SceneError, match=r"Argument `x` must be two or more places"):
        CableFrictionMap(0.1, 0.2, (1.0,), (0.0, 1.0), ((0.0, 0.0),))
