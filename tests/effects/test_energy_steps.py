"""Whole steps of a user's energies: the work that the energy says, exact derivatives, stiff contacts that neither gain nor ring."""

import math

import naive
import numpy as np
import pytest
from slow import slow
from systems import nets, scatter

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity, Ground, node_energy, node_force, segment_energy
from anet_lumped.model.build import build
from integrators.schemes.record import EnergyPromise

G = 9.81
EPS = np.finfo(float).eps


@node_energy
def step_contact(t, q, k, R, level=0.0, beat=0.0):
    """A contact that begins at a cylinder along y, or, if ``level`` is 1, at the plane z = R; its stiffness may swing in time."""
    p = R - q[2] if level > 0.0 else R - math.hypot(q[0], q[2])
    return 0.5 * k * (1.0 + 0.5 * math.sin(beat * t)) * p * p if p > 0.0 else 0.0 * p


@node_energy
def step_well(t, q, a, beat=0.0):
    """Neither convex nor a power: what no quadrature of the gradient integrates, and a strength that may swing in time."""
    return a * (1.0 + 0.5 * math.sin(beat * t)) * (math.sin(7.0 * q[0]) + q[1] ** 4 - q[0] * q[2] ** 3)


@segment_energy
def step_spring(t, q0, q1, L0, k):
    x, y, z = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
    return 0.5 * k * (math.sqrt(x * x + y * y + z * z) - L0) ** 2


@segment_energy
def step_sling(t, q0, q1, k, R):
    """A segment whose middle touches a cylinder: an energy that is not that of a length."""
    x, z = 0.5 * (q0[0] + q1[0]), 0.5 * (q0[2] + q1[2])
    p = R - math.hypot(x, z)
    return 0.5 * k * p * p * p if p > 0.0 else 0.0 * p


LAWS = {
    "contact": step_contact(k=1e4, R=1.5),
    "beating contact": step_contact(k=1e4, R=1.5, beat=40.0),
    "well": step_well(a=3.0),
    "beating well": step_well(a=3.0, beat=40.0),
    "spring": step_spring(k=1e3),
    "sling": step_sling(k=1e4, R=1.5),
}
TRIED = ["contact", "beating contact", "spring", *slow("well", "beating well", "sling")]  # each function is compiled


def acting(effect, model, t, h, base, damper):
    """Function of the positions that a step ends at -> force (n, 3), matrix (n_free, 3, n_free, 3), taken, by the method."""
    index, params = effect.table(model)

    def act(q):
        f, D, near = np.zeros((model.n, 3)), np.zeros((model.n_free, 3, 3)), np.zeros((model.n_segments, 2, 3, 3))
        taken, by_method = effect.kernels()["whole_step"](t, h, damper, base, q, index, params, f, D, near, np.zeros_like(near))
        return f, naive.matrix_of_blocks(model, D, near), taken, by_method

    return act, lambda time, q: effect.kernels()["energy"](time, q, index, params)


@pytest.mark.each_once
@pytest.mark.parametrize("damper", [0.0, 0.5])
@pytest.mark.parametrize("law", TRIED)
@pytest.mark.parametrize("seed", range(3))
def test_it_does_the_work_of_the_energy_and_its_derivative_is_exact(law, damper, seed):
    """The energy falls by the work of the force, what the damper takes and what the law's own time takes; Taylor's remainder."""
    model, rng, t, h = build(list(nets().values())[seed]), np.random.default_rng(seed), 0.3, 0.05
    base = scatter(model, rng)
    q, move = base + 0.05 * rng.normal(size=base.shape), rng.normal(size=(model.n_free, 3))
    act, energy = acting(LAWS[law], model, t, h, base, damper)
    f, K, taken, by_method = act(q)
    rise = energy(t + 0.5 * h, q) - energy(t - 0.5 * h, base)
    # rounding of the energies, and what is left to the gradients where only rounding tells how they differ
    assert rise == pytest.approx(-np.sum(f * (q - base)) - taken - by_method, abs=1e4 * EPS * (abs(energy(t, q)) + 1.0))
    if law == "spring":  # a law of the difference of both nodes
        np.testing.assert_allclose(np.sum(f, axis=0), 0.0, atol=1e-12 * np.abs(f).max())
    assert np.abs(f).max() > 0.0 and by_method >= -1e4 * EPS and (by_method > 0.0) <= (damper > 0.0 or by_method < 1e-10)
    assert (taken != 0.0) == law.startswith("beating")
    steps, off = 10.0 ** -np.arange(4.0, 6.1, 0.5), []
    for x in steps:
        moved = q.copy()
        moved[: model.n_free] += x * move
        off.append(np.linalg.norm((act(moved)[0] - f)[: model.n_free] - x * np.tensordot(K, move)))
    # a node within 1e-4 m of where a contact begins would spoil it, and none is
    assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("law", TRIED)
def test_a_step_of_next_to_nothing_has_the_force_of_the_place(law):
    """Ever shorter steps, down to rounding: the force tends to that at one place, without noise of energies over lengths."""
    model, rng = build(nets()["junction"]), np.random.default_rng(3)
    base, move, t = scatter(model, rng), rng.normal(size=(model.n, 3)), 0.3
    act, _ = acting(LAWS[law], model, t, 1e-6, base, 0.5)
    index, params = LAWS[law].table(model)
    still = np.zeros((model.n, 3))
    LAWS[law].kernels()["force"](t, base, still.copy(), index, params, still)
    stiff = 1e5  # [N/m] or less are the second derivatives of these laws at the places
    for size in 10.0 ** -np.arange(6.0, 17.0):
        f, K, _, _ = act(base + size * move)
        assert np.abs(f - still).max() < stiff * size * np.abs(move).max() + 1e-11 * np.abs(still).max()
        assert np.all(np.isfinite(K)) and np.abs(K).max() < 100.0 * stiff  # differences of gradients over lengths are left of it


def dropped(effect, dt, at=(0.0, 0.0, 0.05), t_end=3.0, **options):
    """A kilogram that falls, on a line of 2 m that it draws taut where it misses what is below."""
    line = Cable("s", "b", length=2.0, mass_per_length=1e-3, EA=1e3, segments=1, diameter=0.01)
    scene = Scene([Fixed("s", (0, 0, 0.5)), Free("b", mass=1.0, at=at)], [line], [Gravity(G), effect])
    return simulate(scene, t_end, method="edmc", dt=dt, start="straight", save_every=dt, **options)


STIFFNESSES, STEPS = (1e1, 1e3, 1e5, 1e6, 1e8), (1e-3, 1e-2, 5e-2)


@pytest.mark.each_once
@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("k", STIFFNESSES)
@pytest.mark.parametrize("kind", ["own", "ground", "cylinder"])
def test_a_contact_neither_gains_nor_rings(kind, k, dt):
    """Whatever its stiffness and the step: the energy never rises, Newton's method ends, and what rests is at rest."""
    effect = {
        "own": lambda: step_contact(k=k, R=0.0, level=1.0, points=["b"]),
        "ground": lambda: Ground(0.0, stiffness=k / (0.01 * 1.0), damping=0.0),
        "cylinder": lambda: step_contact(k=k, R=0.2, points=["b"]),
    }[kind]()
    run = dropped(effect, dt, **({"at": (0.05, 0.0, 0.3)} if kind == "cylinder" else {}))
    assert run.ok, run.message
    assert run.energy_promise is EnergyPromise.NEVER_RISES
    own, in_play = run.energy[:, :3].sum(axis=1), run.energy_balance.in_play
    assert np.diff(own).max() < 2e-6 * in_play and run.energy_balance.imbalance < 2e-6  # Newton's tolerance of 1e-6 of the forces
    # from deep inside, Newton's method halves the depth of a contact that begins; a curved one is not convex
    assert run.work.newton_iterations < (30 if kind == "cylinder" else 5) * run.work.steps
    if kind != "cylinder" and 0.5 * dt * math.sqrt(k) > 30.0:  # far stiffer than the step resolves
        late = run.t > 2.0
        assert np.abs(run.v[late, 0, 2]).max() < 0.01 * G * dt + 1e-9  # swings by less than a hundredth of a step's fall
        np.testing.assert_allclose(run.position("b")[late, 2], -G / k, rtol=0.2)  # the weight on the spring


def test_a_contact_that_the_step_resolves_is_not_damped():
    """Bounces of 40 steps each: the damper takes less than 1e-3 of the energy in as many bounces, and none with rho_inf = 1."""
    k = 1e3
    run = dropped(step_contact(k=k, R=0.0, level=1.0, points=["b"]), 2.5e-3, t_end=4.0)
    assert 0.5 * 2.5e-3 * math.sqrt(k) < 0.05
    assert 0.0 < run.energy_balance.by_method < 1e-3 * run.energy_balance.in_play
    kept = dropped(step_contact(k=k, R=0.0, level=1.0, points=["b"]), 2.5e-3, t_end=4.0, rho_inf=1.0)
    assert abs(kept.energy_balance.by_method) < 1e-9


@pytest.mark.parametrize("effect", [*slow(step_well(a=0.3, points=["b"])), step_spring(k=300.0)], ids=["node", "segment"])
def test_order(effect):
    """Without the numerical damper, errors of positions and velocities fall with the square of the step."""
    cable = Cable("s", "b", length=1.0, mass_per_length=0.1, EA=200.0, segments=2, zeta=0.2, compression="linear")
    scene = Scene([Fixed("s", (0, 0, 0)), Free("b", mass=0.2, at=(0.6, 0.2, -0.8))], [cable], [Gravity(G), effect])
    options = dict(start="straight", save_every=0.1)
    exact = simulate(scene, 0.5, method="dop853", rtol=1e-11, atol=1e-13, **options)
    off = []
    for dt in (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4):
        run = simulate(scene, 0.5, method="edmc", dt=dt, rho_inf=1.0, **options)
        off.append([np.abs(run.q - exact.q).max(), np.abs(run.v - exact.v).max()])
    slopes = np.diff(np.log(off), axis=0) / math.log(0.5)
    np.testing.assert_allclose(slopes[1:], 2.0, atol=0.15)


def rope_over_pulley():
    """1 kg, 3 m of rope on a cylinder of 0.2 m radius without friction, 1.2 kg: what it starts from, and the scene."""
    R, L, N = 0.2, 3.0, 60
    side = 0.5 * (L - math.pi * R)

    def place(s):
        if s < side:
            return -R, 0.0, s - side
        if s < side + math.pi * R:
            return -R * math.cos((s - side) / R), 0.0, R * math.sin((s - side) / R)
        return R, 0.0, side + math.pi * R - s

    q = np.array([place(s) for s in np.linspace(0.0, L, N + 1)])
    ends = [Free("m1", mass=1.0, at=tuple(q[0])), Free("m2", mass=1.2, at=tuple(q[-1]))]
    rope = Cable("m1", "m2", length=L, mass_per_length=0.1, EA=1e4, segments=N, zeta=0.3)
    return Scene(ends, [rope], [Gravity(G), step_contact(k=2e5, R=R)]), q


@pytest.mark.parametrize("dt", [2e-3, 5e-4])
def test_a_rope_over_a_pulley(dt):
    """The heavier side sinks by 67.6 mm in 0.4 s (DOP853, the same 60 segments); with the force at the middle it gained 24 J."""
    scene, places = rope_over_pulley()
    model = build(scene)
    q = np.zeros((model.n, 3))
    q[model.nodes("m1-m2")] = places
    from anet_lumped import State

    start = State(model, 0.0, q, np.zeros_like(q), np.zeros(model.n_segments))
    run = simulate(scene, 0.4, method="edmc", dt=dt, start=start, save_every=dt)
    assert run.ok, run.message
    assert np.diff(run.energy[:, :3].sum(axis=1)).max() < 1e-6 * run.energy_balance.in_play
    sank = run.position("m2")[0, 2] - run.position("m2")[-1, 2]
    assert sank == pytest.approx(0.0676, rel=5e-3)
    assert run.energy[-1, 0] == pytest.approx(0.137, rel=0.03)
    assert run.work.newton_iterations < 8 * run.work.steps


def test_a_force_promises_nothing():
    @node_force
    def step_pushed(t, q, v, k):
        p = -q[2]
        return 0.0, 0.0, k * p if p > 0.0 else 0.0 * p

    run = dropped(step_pushed(k=1e3, points=["b"]), 1e-3, t_end=0.1)
    assert run.energy_promise is EnergyPromise.NONE
    assert dropped(step_contact(k=1e3, R=0.0, level=1.0, points=["b"]), 1e-3, t_end=0.1).energy_promise is EnergyPromise.NEVER_RISES


def test_a_hill_whose_foot_is_far_away():
    """Of exp(-z^2/w^2): 20 w away its slope is 1e-172, of which the square is less than a float holds, and the fall ended there.

    The damper of a contact that steps of a tenth of a metre do not resolve takes 3 mJ of 24 J on the hill.
    """

    @node_energy
    def step_hill(t, q, top, w):
        return top * math.exp(-((q[2] / w) ** 2))

    scene = Scene([Free("b", mass=1.0, at=(0, 0, 1.0))], [], [Gravity(G), step_hill(top=2.0, w=0.02)])
    run = simulate(scene, 0.7, start="straight", method="edmc", dt=0.01)
    assert run.ok, run.message
    fallen = 1.0 - run.position("b")[-1, 2]
    assert fallen > 1.5 and run.velocity("b")[-1, 2] ** 2 == pytest.approx(2.0 * G * fallen, rel=1e-3)
