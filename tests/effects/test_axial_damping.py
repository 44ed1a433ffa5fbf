"""Rayleigh damping of axial motion: the damping ratios of modes, the derivative, the power."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, State, simulate
from anet_lumped.effects import AxialDamping, Gravity, axial_damping
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.model.build import build
from anet_lumped.results.energy_balance import error_of_steps

MU, EA, N, LENGTH = 0.1, 1e3, 20, 1.0


def taut(rate, b=0.0):
    cable = Cable("a", "b", length=LENGTH, mass_per_length=MU, EA=EA, BA=b * EA, segments=N)
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1.1, 0, 0))], [cable], [AxialDamping(rate)])


def moved(scene, mode, amplitude=1e-3, axis=0):
    """The taut cable in its n-th axial mode, at rest."""
    model = build(scene)
    q = np.zeros((model.n, 3))
    s = np.arange(N + 1) / N
    nodes = model.nodes("a-b")
    q[nodes, 0] = 1.1 * s
    q[nodes, axis] += amplitude * np.sin(mode * math.pi * s)
    return State(model, 0.0, q, np.zeros_like(q), np.full(N, 0.1 * EA))


def frequency(mode):
    """2 sqrt(k/m) sin(n pi/2N) of the lumped chain between fixed ends."""
    L0 = LENGTH / N
    return 2.0 / L0 * math.sqrt(EA / MU) * math.sin(mode * math.pi / (2 * N))


@pytest.mark.each_once
@pytest.mark.parametrize("mode", [1, 2, 3])
@pytest.mark.parametrize(("a", "b"), [(30.0, 0.0), (0.0, 2e-4), (30.0, 2e-4)])
def test_damping_ratio_of_modes(mode, a, b):
    """x(t) = exp(-zeta omega t)(cos + zeta/sqrt(1 - zeta^2) sin) with zeta = a/(2 omega) + b omega/2."""
    omega = frequency(mode)
    zeta = a / (2.0 * omega) + b * omega / 2.0
    scene = taut(a, b)
    run = simulate(scene, 4.0 * math.pi / omega, method="dop853", rtol=1e-10, atol=1e-13, start=moved(scene, mode))
    nodes = run.model.nodes("a-b")
    x = run.q[:, nodes, 0] - 1.1 * np.arange(N + 1) / N
    shape = np.sin(mode * math.pi * np.arange(N + 1) / N)
    own = math.sqrt(1.0 - zeta**2)
    at = omega * own * run.t
    exact = 1e-3 * np.exp(-zeta * omega * run.t) * (np.cos(at) + zeta / own * np.sin(at))
    np.testing.assert_allclose(x, exact[:, None] * shape, atol=1e-9)  # linear: the solver's tolerance, some hundred steps of it
    assert error_of_steps(run) < 1e-7


@pytest.mark.parametrize("method", ["edmc", "verlet", "rk4"])
def test_schemes(method):
    omega, scene = frequency(1), taut(30.0, 2e-4)
    zeta = 30.0 / (2.0 * omega) + 1e-4 * omega
    period = 2.0 * math.pi / (omega * math.sqrt(1.0 - zeta**2))
    run = simulate(scene, period, method=method, dt=period / 1000, start=moved(scene, 1))
    assert run.ok
    x = run.q[-1, run.model.nodes("a-b")[N // 2], 0] - 0.55
    # x = exp(-zeta omega T) after a period, where it is at rest: the phase counts to second order; a step is 1e-3 of the period
    assert x == pytest.approx(1e-3 * math.exp(-zeta * omega * period), rel=1e-3)
    assert error_of_steps(run) < 1e-4


def test_across_the_cable_nothing_acts():
    """The power of a transverse velocity is zero, and the energy of a transverse swing stays but for its turn of the tangent."""
    scene = taut(1e3)
    start = moved(scene, 1, amplitude=0.0)
    effect = scene.effects[0]
    v, f = np.zeros_like(start.q), np.zeros_like(start.q)
    v[:, 1] = 2.0
    index, params = effect.table(start.model)
    assert axial_damping.force(0.0, start.q, v, index, params, f) == 0.0 and not f.any()
    v[:, 0] = 3.0
    half = 0.5 * 1e3 * MU * LENGTH / N
    assert axial_damping.force(0.0, start.q, v, index, params, f) == pytest.approx(2 * N * half * 9.0, rel=1e-12)
    assert f[start.model.nodes("a-b")[1], 0] == pytest.approx(-2 * half * 3.0, rel=1e-12)


def test_tangent():
    """Taylor remainders of slope 2, in places and in velocities, on cables of which one alone is damped."""
    cables = [Cable(*ends, length=1.0, mass_per_length=MU, EA=EA, segments=4) for ends in ("ab", "bc")]
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b"), Free("c")], cables, [AxialDamping({"b-c": 3.0})])
    model, rng = build(scene), np.random.default_rng(0)
    index, params = scene.effects[0].table(model)
    assert len(params) == 2 * 4
    q, v, d = rng.normal(size=(3, model.n, 3))
    d[model.n_free :] = 0.0
    for c_q, c_v in ((1.0, 0.0), (0.0, 1.0), (0.7, 0.4)):
        D, near = np.zeros((model.n_free, 3, 3)), np.zeros((model.n_segments, 2, 3, 3))
        axial_damping.tangent(0.0, q, v, index, params, c_q, c_v, D, near, np.zeros((0, 2, 3, 3)))
        linear = np.zeros((model.n, 3))
        linear[: model.n_free] = np.einsum("ixy,iy->ix", D, d[: model.n_free])
        for s, (i, j) in enumerate(model.ends):
            linear[i] += near[s, 0] @ d[j]
            linear[j] += near[s, 1] @ d[i]
        first, off, steps = np.zeros_like(q), [], 10.0 ** -np.arange(2.0, 4.1, 0.5)
        axial_damping.force(0.0, q, v, index, params, first)
        for x in steps:
            f = np.zeros_like(q)
            axial_damping.force(0.0, q + c_q * x * d, v + c_v * x * d, index, params, f)
            off.append(np.linalg.norm((f - first + x * linear)[: model.n_free]))
        if c_q == 0.0:
            assert max(off) < 1e-13  # linear in the velocity
        else:
            assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_scene_file(tmp_path):
    for rate in (2.0, {"a-b": 3.0}):
        scene = taut(rate)
        save_scene(scene, tmp_path / "scene.toml")
        assert load_scene(tmp_path / "scene.toml") == scene


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: AxialDamping(-1.0), r"`rate` must be non-negative and finite \[1/s\], but effect AxialDamping has rate=-1.0"),
        (lambda: AxialDamping({"a-b": -1.0}), 'but effect AxialDamping of cable "a-b" has rate=-1.0'),
        (lambda: build(taut({"x": 1.0})), 'The scene has no cable "x"'),
    ],
)
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_hanging_cable_comes_to_rest():
    """edmc with its tangent: a bouncing payload on a damped cable settles, and Newton does not need more than without."""

    def scene(effects):
        cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, segments=10)
        return Scene([Fixed("a", (0, 0, 0)), Free("b", 0.5, at=(0, 0, -1))], [cable], effects)

    free, damped = (
        simulate(scene([Gravity(), *more]), 2.0, method="edmc", dt=0.005, start="straight") for more in ((), [AxialDamping(50.0)])
    )
    assert damped.ok and damped.work.newton_iterations <= 1.2 * free.work.newton_iterations + 100
    assert damped.energy_balance.imbalance < 1e-8
    assert np.ptp(damped.position("b")[-20:, 2]) < 0.7 * np.ptp(free.position("b")[-20:, 2])
