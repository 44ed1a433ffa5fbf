"""The ground: derivatives, the energy of a step, rest, fall, friction."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, State, equilibrium, simulate
from anet_lumped.effects import Gravity, Ground, ground
from anet_lumped.model.build import build
from anet_lumped.results.energy_balance import error_of_steps

G, D = 9.81, 0.01  # [m/s2], diameter [m]


def lying(effect, segments=10, mu=0.1, compression="none", EA=1e4, zeta=0.5, gravity=None, points=None):
    """A metre of cable that nothing holds."""
    made = dict(mass_per_length=mu, EA=EA, zeta=zeta, segments=segments, diameter=D, compression=compression)
    cable = Cable("a", "b", length=1.0, **made)
    points = points or [Free("a", at=(0, 0, 0)), Free("b", at=(1, 0, 0))]
    return Scene(points, [cable], [gravity or Gravity(G), effect])


def state(scene, places, v=0.0):
    model = build(scene)
    q = np.zeros((model.n, 3))
    q[model.nodes("a-b")] = places
    return State(model, 0.0, q, np.broadcast_to(v, q.shape).copy(), np.zeros(model.n_segments))


def level(height=0.0, segments=10):
    s = np.linspace(0.0, 1.0, segments + 1)
    return np.column_stack([s, 0 * s, 0 * s + height])


@pytest.mark.parametrize("h", [1e-3, 1e-1])
@pytest.mark.parametrize("damper", [0.0, 0.5])
@pytest.mark.parametrize("seed", range(4))
def test_step_gives_back_no_more_than_the_energy(seed, damper, h):
    scene = lying(Ground(0.1, 1e5, 1e3, 0.7, normal=(0.3, 0.0, 1.0)))
    model, effect, rng = build(scene), scene.effects[1], np.random.default_rng(seed)
    index, params = effect.table(model)
    base, q = 0.08 + 0.02 * rng.normal(size=(2, model.n, 3))
    n, blocks = model.n_free, (np.zeros((0, 2, 3, 3)), np.zeros((0, 2, 3, 3)))

    def act(at):
        f, K = np.zeros_like(q), np.zeros((n, 3, 3))
        return f, K, ground.whole_step(0.0, h, damper, base, at, index, params, f, K, *blocks)

    f, K, (taken, by_method) = act(q)
    lost = taken + by_method
    rise = ground.energy(0.0, q, index, params) - ground.energy(0.0, base, index, params)
    assert taken >= 0.0 and (by_method > 0.0 if damper else by_method == 0.0) and np.abs(f).max() > 0.0
    assert rise == pytest.approx(-np.sum(f * (q - base)) - lost, rel=1e-9, abs=1e-12 * lost)
    d, off, steps = rng.normal(size=(n, 3)), [], 10.0 ** -np.arange(4.0, 6.1, 0.5)
    for x in steps:
        moved = q.copy()
        moved[:n] += x * d
        off.append(np.linalg.norm((act(moved)[0] - f)[:n] + x * np.einsum("ixy,iy->ix", K, d)))
    # Taylor; a node within 1e-4 m of a kink would spoil it, and none is
    assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_lying_at_rest():
    """The ground carries the weight: a node sinks in by m g/k, k = stiffness d L0."""
    effect = Ground(0.0, 1e5, 1e3)
    scene = lying(effect)
    run = simulate(scene, 3.0, method="edmc", dt=0.01, start=state(scene, level()))
    assert run.ok
    load = effect.force_on(run.final)
    assert load[:, 2].sum() == pytest.approx(-0.1 * G, rel=1e-6) and np.abs(load[:, :2]).max() < 1e-9
    # a loose end has half the mass and half the area
    np.testing.assert_allclose(run.final.q[:, 2], -0.1 * G / (1e5 * D), rtol=1e-6)


def test_touchdown():
    """A cable lifted at one end: H = T - mu g z at the ground, and the lifted arc s = sqrt(z^2 + 2 z H/(mu g)) of a catenary."""
    height, segments = 0.2, 100
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (0.85, 0, height))]
    scene = lying(Ground(0.0, 1e7), segments, points=points, EA=1e5)
    rest = equilibrium(scene)
    T = rest.tension("a-b")
    H = T[0]
    assert T[-1] - H == pytest.approx(0.1 * G * height, rel=0.03)  # of which half a segment's weight is 2.5 %
    arc = math.sqrt(height**2 + 2.0 * height * H / (0.1 * G))
    carried = -scene.effects[1].force_on(rest)[:, 2].sum()
    # what the ground does not carry is the lifted arc and half a segment at the fixed ends
    assert 0.1 * G * (1.0 - arc) == pytest.approx(carried, abs=0.1 * G * 0.02)


def test_a_chain_falls_onto_the_ground():
    """While it falls the ground bears three times the weight that has landed: its weight and the momentum mu v^2 = 2 mu g s."""
    segments, mu = 100, 0.1
    effect = Ground(0.0, 1e6, 3e4)
    scene = lying(effect, segments, mu, EA=1e3, zeta=0.5)
    s = np.linspace(0.0, 1.0, segments + 1)
    start = state(scene, np.column_stack([0 * s, 0 * s, s]))
    end = math.sqrt(2.0 / G)
    run = simulate(scene, 0.9 * end, method="edmc", dt=2.5e-4, save_every=2.5e-4, start=start)
    assert run.ok
    m = run.model.mass[:, None]
    impulse = (m * run.v).sum(axis=1)[:, 2] + mu * G * run.t  # that the ground has given
    # integral of 3 mu g (g t^2/2)
    expected = 0.5 * mu * G**2 * run.t**3
    late = run.t > 0.4 * end
    np.testing.assert_allclose(impulse[late], expected[late], rtol=0.06)  # lumps of a hundredth of the weight, and the first gap


@pytest.mark.parametrize("method", ["edmc", "verlet"])
def test_sliding_to_rest(method):
    """v^2/(2 mu g), and the account has all that it moved with as the friction's."""
    effect = Ground(0.0, 1e5, 1e3, friction=0.5)
    scene = lying(effect)
    start = state(scene, level(-0.1 * G / (1e5 * D)), (1.0, 0.0, 0.0))
    run = simulate(scene, 0.4, method=method, dt=1e-3 if method == "edmc" else 1e-4, start=start)
    assert run.ok
    way = run.q[-1, :, 0] - run.q[0, :, 0]
    # beside it the creep of friction that is regularised, below 1 mm/s
    np.testing.assert_allclose(way, 1.0 / (2 * 0.5 * G), rtol=0.02)
    moved = 0.5 * 0.1 * 1.0**2  # [J]
    assert run.energy_balance.by_effects == pytest.approx(moved, rel=5e-3) and abs(run.energy_balance.by_method) < 5e-3 * moved


@pytest.mark.parametrize("angle", [20.0, 35.0])
def test_inclined_plane_holds_what_its_friction_allows(angle):
    """It slides if tan(angle) > mu = 0.5, with a = g (sin - mu cos); else it creeps below the speed of slip."""
    a = math.radians(angle)
    scene = lying(Ground(0.0, 1e5, 1e3, friction=0.5), gravity=Gravity(G, (math.sin(a), 0.0, -math.cos(a))))
    run = simulate(scene, 0.5, method="edmc", dt=5e-3, start=state(scene, level(-0.1 * G / (1e5 * D))))
    speed = run.v[-1, :, 0].mean()
    if math.tan(a) < 0.5:
        assert abs(speed) < 2e-3
    else:
        assert speed == pytest.approx(0.5 * G * (math.sin(a) - 0.5 * math.cos(a)), rel=0.02)


@pytest.mark.parametrize("dt", [1e-3, 2e-2])
def test_energy_never_rises(dt):
    """A crumple dropped on a hard ground, undamped."""
    scene = lying(Ground(0.0, 1e8, 0.0), zeta=0.0)
    turn = np.random.default_rng(1).normal(size=(11, 3))
    places = np.cumsum(0.05 * turn / np.linalg.norm(turn, axis=1)[:, None], axis=0)
    places[:, 2] += 0.3 - places[:, 2].min()
    run = simulate(scene, 60 * dt if dt > 0.01 else 0.5, method="edmc", dt=dt, save_every=dt, start=state(scene, places))
    assert run.ok and error_of_steps(run) < 1e-5
    energy = run.energy[:, :3].sum(axis=1)
    assert np.diff(energy).max() < 1e-6 * np.ptp(run.energy[:, 2])
    assert run.q[:, :, 2].min() > -0.05


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Ground(stiffness=-1.0), "`stiffness` must be non-negative and finite .Pa/m., but effect Ground has stiffness=-1"),
        (lambda: Ground(normal=(0, 0, 0)), "`normal` must not be zero"),
        (
            lambda: build(Scene([Fixed("a", (0, 0, 0)), Free("b")],
                                [Cable("a", "b", length=1, mass_per_length=1, EA=1, segments=2)], [Ground()])),
            'Ground needs the `diameter` .m. of every cable, but cable "a-b" has none',
        ),
    ],
)  # fmt: skip
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()
