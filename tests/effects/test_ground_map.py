"""A ground by a height map: its heights, the energy of a step across edges, slopes beside `Ground` and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, State, equilibrium, simulate
from anet_lumped.effects import Gravity, Ground, GroundMap, ground_map
from anet_lumped.model.build import build
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

G, D, TILT = 9.81, 0.01, 0.3  # [m/s2], diameter [m], slope dH/dx
COS = 1.0 / math.hypot(1.0, TILT)
X, Y = (-1.0, -0.2, 0.1, 0.6, 1.0), (-0.5, 0.0, 0.4)
HILLS = GroundMap(X, Y, 0.1 * np.random.default_rng(7).normal(size=(5, 3)), 1e5, 1e3, 0.7)


def slope(**numbers):
    """A map of a plane that rises along x, over three cells of different sizes."""
    x = (-30.0, -1.0, 2.0, 30.0)
    return GroundMap(x, (-9.0, 9.0), [(TILT * at,) * 2 for at in x], **numbers)


def lying(effect, points=None, segments=4, mu=0.1):
    cable = Cable("a", "b", length=1.0, mass_per_length=mu, EA=1e4, zeta=0.5, segments=segments, diameter=D)
    points = points or [Free("a", at=(0, 0, 0)), Free("b", at=(1, 0, 0))]
    return Scene(points, [cable], [Gravity(G), effect])


def along_the_slope(scene, deep=0.0):
    """State with the cable on the slope, along it, at rest; below it by ``deep`` [m] along z."""
    model = build(scene)
    q, s = np.zeros((model.n, 3)), COS * np.linspace(0.0, 1.0, 5)
    q[model.nodes("a-b")] = np.column_stack([s, 0.0 * s, TILT * s - deep])
    return State(model, 0.0, q, np.zeros_like(q), np.zeros(model.n_segments))


def test_heights_are_bilinear_and_those_of_the_edge_beyond():
    """But within a hundredth of an interval of the edges, where they are the mean over a fiftieth."""
    other = RegularGridInterpolator((X, Y), np.array(HILLS.heights))

    def bilinear(x, y):
        return other(np.column_stack([np.clip(x, X[0], X[-1]), np.clip(y, Y[0], Y[-1])]))

    for x, y in np.random.default_rng(1).uniform(-1.5, 1.5, (40, 2)):
        if min(np.abs(np.subtract(X, x)).min(), np.abs(np.subtract(Y, y)).min()) > 0.01:
            assert HILLS.height_at(x, y) == pytest.approx(bilinear([x], [y])[0], abs=1e-14)
    width = 0.02 * 0.3  # of the smaller interval beside x = 0.1
    for x in (0.1 - 0.4 * width, 0.1, 0.1 + 0.2 * width):
        window = x + width * ((np.arange(2000) + 0.5) / 2000 - 0.5)
        assert HILLS.height_at(x, 0.2) == pytest.approx(bilinear(window, 0.2 + 0.0 * window).mean(), abs=1e-8)


def scattered(seed, effect=HILLS):
    scene, rng = lying(effect), np.random.default_rng(seed)
    model = build(scene)
    places = rng.uniform(-1.2, 1.2, (model.n, 3))
    places[:, 2] = [effect.height_at(x, y) for x, y, _ in places] + 0.03 * rng.normal(size=model.n)
    return model, *effect.table(model), places, rng


@pytest.mark.parametrize("size", [1.0, 0.02])  # across cells, and mostly within one
@pytest.mark.parametrize("damper", [0.0, 0.5])
@pytest.mark.parametrize("seed", range(4))
def test_step_gives_back_no_more_than_the_energy(seed, damper, size):
    model, index, params, base, rng = scattered(seed)
    q, h, near = base + size * rng.normal(size=base.shape) * (1.0, 1.0, 0.02), 0.01, np.zeros((0, 2, 3, 3))
    f, K = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
    taken, by_method = ground_map.whole_step(0.0, h, damper, base, q, index, params, f, K, near, near)
    rise = ground_map.energy(0.0, q, index, params) - ground_map.energy(0.0, base, index, params)
    lost = taken + by_method
    assert taken >= 0.0 and by_method >= 0.0 and np.abs(f).max() > 0.0
    assert rise == pytest.approx(-np.sum(f * (q - base)) - lost, rel=1e-9, abs=1e-11 * lost)


@pytest.mark.parametrize(("effect", "size"), [(replace(HILLS, friction=0.0), 0.5), (slope(stiffness=1e5, friction=0.7), 0.02)])
@pytest.mark.parametrize("seed", range(3))
def test_derivatives(seed, effect, size):
    """Taylor's remainder is of order 2; with friction on a plane alone, where the normal does not turn."""
    model, index, params, base, rng = scattered(seed, effect)
    q, near = base + size * rng.normal(size=base.shape) * (1.0, 1.0, 0.02), np.zeros((0, 2, 3, 3))
    d, v = rng.normal(size=q.shape), rng.normal(size=q.shape)

    def of_step(at):
        f, K = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
        ground_map.whole_step(0.0, 0.01, 0.5, base, at, index, params, f, K, near, near)
        return f, K

    def at_once(at):
        f, K = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
        ground_map.force(0.0, at, v, index, params, f)
        ground_map.tangent(0.0, at, v, index, params, 1.0, 0.0, K, near, near)
        return f, K

    for act in (of_step, at_once):
        f, K = act(q)
        steps, off = 10.0 ** -np.arange(4.5, 6.1, 0.5), []
        for x in steps:
            off.append(np.linalg.norm(act(q + x * d)[0] - f + x * np.einsum("ixy,iy->ix", K, d)))
        assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1) or off[0] < 1e-9


def test_a_plane_is_that_of_ground():
    """Of the stiffness k cos^2 of a plane that is measured along its normal; without a damper, whose depth is another."""
    of_map = lying(slope(stiffness=1e5 * COS**2, damping=0.0, friction=0.2))
    of_plane = lying(Ground(0.0, 1e5, 0.0, 0.2, normal=(-TILT, 0.0, 1.0)))
    start = along_the_slope(of_map, 0.1 * G / (1e5 * D))  # where the ground carries the cable
    ends = [simulate(scene, 0.3, method="edmc", dt=0.005, start=start).final.q for scene in (of_map, of_plane)]
    np.testing.assert_allclose(*ends, atol=1e-8)  # Newton's tolerance; it slides by 4 cm
    assert np.abs(ends[0] - start.q).max() > 0.03


@pytest.mark.parametrize("friction", [0.1, 0.6])
def test_sliding_and_sticking(friction):
    """A cable slides down with g (sin - mu cos), across the edges of cells; with mu above the slope it creeps at the slip speed."""
    scene = lying(slope(friction=friction, slip_speed=1e-4))
    pressed = 0.1 * G / (3e6 * D)  # m g/k along z, where N carries the weight times cos^2
    run = simulate(scene, 0.8, method="edmc", dt=0.004, start=along_the_slope(scene, pressed * COS**2))
    down = (run.q[0] - run.q[-1]) @ np.array([COS, 0.0, TILT * COS])
    if friction < TILT:
        np.testing.assert_allclose(down, 0.5 * G * COS * (TILT - friction) * 0.8**2, rtol=2e-3)  # starts at u, not at once
        assert down.min() > 0.5
    else:
        assert 0.0 < down.max() < 0.8 * 1e-4
    assert run.ok and run.energy_balance.imbalance < 1e-6 and np.diff(run.energy[:, :3].sum(axis=1)).max() < 1e-12


def test_statics_on_a_slope():
    """It lies on the slope and hangs from its upper end: T = mu g s sin, and each node sinks in by m g cos^2/k along z."""
    top = Fixed("b", (COS, 0.0, TILT * COS - 0.1 * G * COS**2 / (3e6 * D)))
    rest = equilibrium(lying(slope(), [Free("a", at=(0.1, 0.0, 0.1)), top]))
    expected = 0.1 * G * TILT * COS * (np.arange(4) + 0.5) / 4.0
    np.testing.assert_allclose(rest.tension("a-b"), expected, rtol=1e-6)
    assert rest.stable and rest.residual < 1e-9
    x, _, z = rest.shape("a-b")[1:-1].T
    np.testing.assert_allclose(TILT * x - z, 0.1 * G * COS**2 / (3e6 * D), rtol=1e-3)


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_chain_falls_into_a_valley(friction):
    """With an edge at its bottom: the energy never rises, and friction brings it to rest there."""
    heights = ((0.8, 0.8), (0.0, 0.0), (0.8, 0.8))
    valley = GroundMap((-2.0, 0.0, 2.0), (-1.0, 1.0), heights, 1e5, 1e3, friction)
    scene = lying(valley, [Free("a", at=(-0.3, 0, 0.3)), Free("b", at=(0.7, 0, 0.4))])
    run = simulate(scene, 2.0, method="edmc", dt=0.004, start="straight")
    assert run.ok and np.diff(run.energy[:, :3].sum(axis=1)).max() < 1e-12 and run.energy_balance.imbalance < 1e-5
    assert run.work.halvings == 0 and run.work.newton_iterations < 5 * run.work.steps
    assert (run.energy[-1, 0] < 1e-5) == (friction > 0.0)


def test_files_and_origins():
    scene = lying(HILLS)
    assert scene_from_dict(scene_to_dict(scene)) == scene
    moved = HILLS.seen_from((2.0, 3.0, -1.0), None)
    assert moved.height_at(-1.7, -2.9) == pytest.approx(HILLS.height_at(0.3, 0.1) + 1.0)
    assert HILLS.at_rest().friction == 0.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"x": (0.0,)}, r"Argument `x` must be two or more places \[m\] that grow, but effect GroundMap has \(0.0,\)"),
        ({"y": (0.0, 1.0, 1.0)}, r"Argument `y` must be two or more places"),
        ({"x": 3.0}, r"Argument `x` must be two or more places"),
        (
            {"heights": ((0.0, 1.0),)},
            r"`heights` must have a row for each of the 5 places x, with a number \[m\] for each of the 3 ",
        ),
        ({"heights": 1.0}, r"`heights` must have a row for each"),
        ({"stiffness": -1.0}, r"Argument `stiffness` must be non-negative"),
    ],
)
def test_what_a_map_cannot_be(change, says):
    with pytest.raises(SceneError, match=says):
        replace(HILLS, **change)


def test_a_cable_without_a_diameter_is_refused():
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=2)
    with pytest.raises(SceneError, match=r'GroundMap needs the `diameter` \[m\] of every cable, but cable "a-b" has none'):
        build(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable], [HILLS]))
