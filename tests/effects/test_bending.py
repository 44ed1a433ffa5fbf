"""Bending: derivatives, the discrete gradient, closed forms of beams and the elastica, statics and motion."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from anet_lumped import Cable, Driven, Fixed, Free, Scene, SceneError, State, equilibrium, simulate
from anet_lumped.effects import Bending, Gravity, bending
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from anet_lumped.results.energy_balance import error_of_steps

EI, MU = 2e-3, 0.1  # [N m2], [kg/m]


def cantilever(segments=20, EA=1e5, force=0.0, payload=0.0, effects=None, **kwargs):
    """A metre that leaves its support along x; ``force`` [N] pulls its end down through a payload's weight."""
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, EI=EI, segments=segments, **kwargs)
    effects = effects or [Bending({"a": (1, 0, 0)})] + ([Gravity(force / payload)] if payload else [])
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass=payload, at=(1, 0, 0))], [cable], effects)


def bent_net(compression="none"):
    """Cables of every kind of end: clamped, free, a junction; two and one segments; flipped."""
    made = dict(length=1.0, mass_per_length=MU, EA=1e3, EI=EI, compression=compression)
    points = [Fixed("a", (0, 0, 0)), Fixed("c", (1, 1, 0)), Free("x", 0.01), Free("y", 0.01), Free("z")]
    cables = [
        Cable("x", "a", segments=4, **made), Cable("x", "y", segments=5, **made), Cable("y", "z", segments=2, **made),
        Cable("c", "y", segments=1, **made),
    ]  # fmt: skip
    return Scene(points, cables, [Bending((("a", (1, 2, 0)), ("c", (0, 0, -1)))), Gravity()])


def random_places(model, seed):
    rng = np.random.default_rng(seed)
    q = np.zeros((model.n, 3))
    for cable in model.scene.cables:
        q[model.nodes(cable.name)] = np.cumsum(rng.uniform(-0.3, 0.3, (cable.segments + 1, 3)), axis=0)
    return q + 0.1 * rng.normal(size=q.shape)


def arrays(model):
    net = fresh_net(model)
    effect = next(e for e in model.scene.effects if isinstance(e, Bending))
    index, params = effect.table(model)
    return (
        index,
        params,
        np.zeros((model.n, 3)),
        np.zeros_like(net.diagonal),
        np.zeros_like(net.near_blocks),
        np.zeros_like(net.far_blocks),
    )


def matrix(model, D, near, far):
    """(3 n_free, 3 n_free) of the blocks."""
    n, K = model.n_free, np.zeros((3 * model.n, 3 * model.n))
    pairs = [(i, i, D[i]) for i in range(n)]
    for s, (i, j) in enumerate(model.ends):
        pairs += [(i, j, near[s, 0]), (j, i, near[s, 1])]
        if s + 1 < model.n_segments and model.cable_of[s] == model.cable_of[s + 1]:
            k = model.ends[s + 1, 1]
            pairs += [(i, k, far[s, 0]), (k, i, far[s, 1])]
    for i, j, block in pairs:
        K[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] += block
    return K[: 3 * n, : 3 * n]


@pytest.mark.parametrize("seed", range(3))
def test_force_and_tangent_are_the_derivatives_of_the_energy(seed):
    model = build(bent_net())
    q, index, params, f, D, near, far = random_places(model, seed), *arrays(model)
    bending.force(0.0, q, q, index, params, f)
    bending.tangent(0.0, q, q, index, params, 1.0, 0.0, D, near, far)
    assert np.abs(f.sum(axis=0) - f[model.n_free :].sum(axis=0) - f[: model.n_free].sum(axis=0)).max() < 1e-14
    K, d = matrix(model, D, near, far), np.random.default_rng(seed).normal(size=(model.n_free, 3))
    h = 10.0 ** -np.arange(2.0, 4.1, 0.5)
    of_energy, of_force, E = [], [], bending.energy(0.0, q, index, params)
    for x in h:
        moved, g = q.copy(), np.zeros_like(f)
        moved[: model.n_free] += x * d
        bending.force(0.0, moved, q, index, params, g)
        of_energy.append(abs(bending.energy(0.0, moved, index, params) - E + x * np.sum(f[: model.n_free] * d)))
        of_force.append(np.linalg.norm((g - f)[: model.n_free].ravel() + x * K @ d.ravel()))
    for remainders in (of_energy, of_force):  # Taylor: second order
        assert np.polyfit(np.log(h), np.log(remainders), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("h", [1e-5, 1e-2])
@pytest.mark.parametrize("seed", range(3))
def test_step_gives_the_energy_back_but_for_what_it_dissipates(seed, h):
    model = build(bent_net())
    base, q, index, params, f, D, near, far = random_places(model, seed), random_places(model, seed + 50), *arrays(model)
    base[model.n_free :] = q[model.n_free :]
    taken, lost = bending.whole_step(0.0, h, 0.5, base, q, index, params, f, D, near, far)
    rise = bending.energy(0.0, q, index, params) - bending.energy(0.0, base, index, params)
    assert lost >= 0.0 and taken == 0.0  # its damper is numerical
    assert rise == pytest.approx(-np.sum(f * (q - base)) - lost, abs=1e-13)  # rounding of energies of some 0.1 J
    K, d = matrix(model, D, near, far), np.random.default_rng(seed).normal(size=(model.n_free, 3))
    steps, remainders = 10.0 ** -np.arange(2.0, 4.1, 0.5), []
    for x in steps:
        moved, g = q.copy(), np.zeros_like(f)
        moved[: model.n_free] += x * d
        bending.whole_step(0.0, h, 0.5, base, moved, index, params, g, D, near, far)
        remainders.append(np.linalg.norm((g - f)[: model.n_free].ravel() + x * K @ d.ravel()))
    assert np.polyfit(np.log(steps), np.log(remainders), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_energy_of_a_circle():
    """EI/2 kappa^2 L, to second order in the segments."""
    off = []
    for n in (10, 20, 40):
        model = build(cantilever(n))
        s = np.linspace(0.0, 1.0, n + 1)
        q = np.zeros((model.n, 3))
        q[model.nodes("a-b")] = np.column_stack([np.sin(s), 0 * s, 1.0 - np.cos(s)])
        index, params = Bending({"a": (1, 0, 0)}).table(model)
        # without the last half segment, which bends nowhere: the moment at a free end is zero
        off.append(bending.energy(0.0, q, index, params) / (0.5 * EI * (1.0 - 0.5 / n)) - 1.0)
    assert np.abs(off[-1]) < 1e-3 and np.polyfit(np.log([10, 20, 40]), np.log(np.abs(off)), 1)[0] == pytest.approx(-2, abs=0.1)


def elastica(load):
    """Tip (x, z) of a cantilever of unit length under a dead load F down at its end, load = F L^2/EI, as a boundary problem."""

    def end(moment):
        return solve_ivp(lambda s, y: [y[1], load * math.cos(y[0]), math.cos(y[0]), math.sin(y[0])], (0, 1),
                         [0.0, moment, 0.0, 0.0], rtol=1e-11, atol=1e-12).y[:, -1]  # fmt: skip

    moment = brentq(lambda m: end(m)[1], -2.0 * load, 0.0)
    _, _, x, z = end(moment)
    return x, z


def test_elastica_against_published_numbers():
    """Bisshopp & Drucker, Q. Appl. Math. 3 (1945) 272, as tabulated by Mattiasson (1981): F L^2/EI = 1 and 10."""
    assert np.allclose(elastica(1.0), (1 - 0.05643, -0.30172), atol=2e-5)
    assert np.allclose(elastica(10.0), (1 - 0.55500, -0.81061), atol=2e-5)


@pytest.mark.parametrize("load", [0.01, 1.0, 10.0])
def test_cantilever_at_rest(load):
    """Weightless but for its payload: F L^3/(3 EI) when small, the elastica when large; of second order in the segments."""
    off = []
    for n in (10, 20, 40):
        cable = Cable("a", "b", length=1.0, mass_per_length=1e-12, EA=1e3, EI=EI, segments=n, compression="linear")
        effects = [Gravity(9.81), Bending({"a": (1, 0, 0)})]
        scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=load * EI / 9.81)], [cable], effects)
        tip = equilibrium(scene).position("b")
        x, z = elastica(load)
        off.append(math.hypot(tip[0] - x, tip[2] - z))
    assert off[-1] < 1e-3 * abs(z) + 2e-7
    assert np.polyfit(np.log([10, 20, 40]), np.log(off), 1)[0] == pytest.approx(-2.0, abs=0.25)


@pytest.mark.parametrize("method", ["edmc", "verlet", "backward_euler"])
def test_first_frequency_of_a_cantilever(method):
    """omega_1 = 1.8751^2 sqrt(EI/mu)/L^2 without gravity; counted by the zeros of the tip's height."""
    omega = 1.8751041**2 * math.sqrt(EI / MU)
    scene, model = cantilever(20, EA=200.0, zeta=0.2), build(cantilever(20, EA=200.0, zeta=0.2))
    s = np.linspace(0.0, 1.0, 21)
    b = 1.8751041
    shape = np.cosh(b * s) - np.cos(b * s) - 0.7340955 * (np.sinh(b * s) - np.sin(b * s))
    q = np.zeros((model.n, 3))
    q[model.nodes("a-b")] = np.column_stack([s, 0 * s, 1e-4 * shape])
    start = State(model, 0.0, q, np.zeros_like(q), np.zeros(model.n_segments))
    dt = {"edmc": 0.02, "verlet": 2e-4, "backward_euler": 1e-3}[method]
    run = simulate(scene, 4.5 * 2 * math.pi / omega, method=method, dt=dt, save_every=0.02, start=start)
    assert run.ok
    z, t = run.position("b")[:, 2], run.t
    change = np.flatnonzero(np.diff(np.sign(z)))
    zeros = t[change] - z[change] * np.diff(t)[change] / np.diff(z)[change]
    measured = math.pi / np.diff(zeros).mean()
    # 20 segments and 4 % of a radian a step: some 1e-3 each
    assert measured == pytest.approx(omega, rel=4e-3)


@pytest.mark.each_once
@pytest.mark.parametrize("EI_", [1e-2, 1e2, 1e5])
@pytest.mark.parametrize("dt", [1e-3, 1e-2, 0.1])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_energy_never_rises_however_stiff(EI_, dt, seed):
    """From a crumple, undamped, with bending that dominates: edmc's statement.

    The stretching stiffness is at least that of a round section 8 cm thick, EI/EA = d^2/16.
    """
    EA = max(1e3, EI_ / 4e-4)
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, EI=EI_, segments=10, compression="linear")
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable], [Gravity(), Bending({"a": (0, 0, -1)})])
    model = build(scene)
    q = np.zeros((model.n, 3))
    q[model.nodes("a-b")][1:] = 0.0
    turn = np.random.default_rng(seed).normal(size=(10, 3))
    q[model.nodes("a-b")[1:]] = np.cumsum(0.1 * turn / np.linalg.norm(turn, axis=1)[:, None], axis=0)
    start = State(model, 0.0, q, np.zeros_like(q), np.zeros(10))
    run = simulate(scene, 20 * dt, method="edmc", dt=dt, save_every=dt, start=start)
    assert run.ok
    energy = run.energy[:, :3].sum(axis=1)
    assert np.diff(energy).max() < 1e-6 * np.ptp(energy) + 1e-9 * energy[0]
    assert error_of_steps(run) < 1e-5


@pytest.mark.parametrize(("EA", "EI_"), [(1e5, 0.5), (1e6, 0.05)])
def test_a_cable_let_go_stretched_goes_slack_and_on(EA, EI_):
    """By a fifth, at the default step: slack segments turn right over within one."""
    cable = Cable("a", "b", length=0.5, mass_per_length=MU, EA=EA, EI=EI_, segments=8)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 0.01, at=(0.6, 0, 0))], [cable], [Gravity(), Bending()])
    assert simulate(scene, 0.2, start="straight").ok


def test_moving_clamp_and_two_clamps():
    """A beam clamped at both ends under its weight: mu g L^4/(384 EI); one end may be driven."""
    stiff = 10.0
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=1e7, EI=stiff, segments=40)
    points = [Fixed("a", (0, 0, 0)), Driven("b", paths.line((1, 0, 0), (0, 0, 0), ramp=1.0))]
    rest = equilibrium(Scene(points, [cable], [Gravity(9.81), Bending({"a": (1, 0, 0), "b": (-1, 0, 0)})]))
    sag = -rest.shape("a-b")[:, 2].min()
    assert sag == pytest.approx(MU * 9.81 / (384 * stiff), rel=5e-3)  # second order: (pi/40)^2/6 and the like


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Bending({"a": (0, 0, 0)}), r'`clamped` must not be zero, but effect Bending at point "a" has'),
        (lambda: build(cantilever(effects=[Bending({"b": (1, 0, 0)})])), 'fixed or driven point, but .* clamps free point "b"'),
        (lambda: build(cantilever(effects=[Bending({"q": (1, 0, 0)})])), 'no point "q"'),
        (
            lambda: build(Scene([Fixed("a", (0, 0, 0)), Free("b")],
                                [Cable("a", "b", length=1, mass_per_length=1, EA=1, segments=2)], [Bending()])),
            "needs cables with an `EI`",
        ),
    ],
)  # fmt: skip
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()
