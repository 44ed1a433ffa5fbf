"""diffrax's solvers: the net in JAX against the compiled one, closed forms, agreement, energy, counts, corners, failures.

JAX compiles once for a method and the shapes of a net, so tests share scenes of few shapes.
"""

import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from systems import nets, scatter

from anet_lumped import Cable, Driven, Fixed, Free, InputError, Scene, simulate
from anet_lumped.effects import AxialDamping, Gravity, ViscousDamping
from anet_lumped.effects.laws.axial import SWITCHES
from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.jacobian import sparse_jacobian
from anet_lumped.model.build import build
from anet_lumped.motion.simulate import RunError
from anet_lumped.prescribed.paths import harmonic, line, samples
from integrators import schemes
from integrators.schemes.record import Origin
from integrators.system import DIVERGED, DONE, FACTORISATIONS, FORCES, NEWTON, REJECTED, STEPS

pytest.importorskip("diffrax")

import equinox as eqx
import jax
import jax.numpy as jnp

from anet_lumped.motion.jax.net import jax_net
from anet_lumped.motion.jax.paths import Paths
from anet_lumped.results.energy_balance import error_of_steps
from integrators.adapters import diffrax_adapter
from integrators.adapters.outcome import Task

DIFFRAX = schemes.names(origin=Origin.DIFFRAX)

# --- the net in JAX -----------------------------------------------------------------------------------------------------

LATE = 1e9  # a stop that no test reaches


@eqx.filter_jit
def forced_and_solved(net, t, q, v, tau, r):
    f, power = net.force(t, LATE, q, v)
    return f, power, net.solve(net.factor(t, LATE, q, v, tau), r)


CURVE = {"EA": None, "tension_strain": ((0.2, 200.0), (0.5, 350.0))}  # [N], half as stiff beyond 20 %


# no free point; shorter cables beside longer ones and single segments; every cable between two free points; a bent spring
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "elastic"),
    [
        pytest.param("between supports", {}, marks=pytest.mark.slow),
        ("parallel", {}),
        pytest.param("wheel", {}, marks=pytest.mark.slow),
        pytest.param("parallel", CURVE, id="parallel, by a curve", marks=pytest.mark.slow),
    ],
)
def test_force_and_structured_solve(name, elastic):
    """Against the compiled force, and against a dense solve with the analytic Jacobian; slack and taut segments."""
    for compression in SWITCHES:
        scene = nets(compression=compression, effects=[Gravity(3.0, (1, -2, 2)), ViscousDamping(0.7)], **elastic)[name]
        model, rng, tau, t = build(scene), np.random.default_rng(5), 0.01, 0.3
        n, compiled, net = model.n_free, system(model), fresh_net(model)
        q, v, r = scatter(model, rng), rng.normal(size=(model.n, 3)), rng.normal(size=(n, 3))
        for point in scene.points:
            if isinstance(point, Fixed):
                q[model.node(point.name)], v[model.node(point.name)] = point.at, 0.0
        f, power = np.zeros((model.n, 3)), np.zeros(3)
        compiled.force(t, q, v, net.address, f, power)
        traced, traced_power, x = forced_and_solved(jax_net(model), t, q[:n], v[:n], tau, r)
        # sums of rounded forces of up to 1e4 N
        np.testing.assert_allclose(traced, f[:n], rtol=0, atol=1e-11)
        np.testing.assert_allclose(traced_power, power, rtol=1e-12)
        J, m = sparse_jacobian(model, net)(t, q, v).toarray(), np.repeat(model.mass[:n], 3)
        K, C = m[:, None] * J[3 * n :, : 3 * n], m[:, None] * J[3 * n :, 3 * n :]
        expected = np.linalg.solve(np.diag(m) - tau * C - tau**2 * K, r.ravel()).reshape(n, 3)
        # condition below 1e3, but two-way springs in compression leave pivots small
        np.testing.assert_allclose(x, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


@pytest.mark.slow
def test_paths():
    rng = np.random.default_rng(2)
    paths = [
        line((0, 0, 1), (0.2, 0.1, 0.0), 1.0), line((1, 0, 0), (0.0, 0.0, 0.3), 0.0),
        samples(np.r_[0.5, 0.5 + np.cumsum(rng.uniform(0.1, 0.5, 6))], rng.normal(size=(7, 3))),
        harmonic((0, 1, 0), (0.1, 0.2, 0.0), 2.0, 0.4, 0.7), harmonic((0, 1, 0), (0.0, 0.2, 0.1), 1.5, 0.2),
    ]  # fmt: skip
    at = eqx.filter_jit(Paths.of(paths).at)
    for t in (-0.3, 0.0, 0.2, 0.5, 0.69, 0.93, 1.7, 2.5, 9.0):
        q, v = at(jnp.asarray(t), LATE)
        np.testing.assert_allclose(q, [path.at(t)[0] for path in paths], rtol=1e-13, atol=1e-14, err_msg=f"{t}")
        np.testing.assert_allclose(v, [path.at(t)[1] for path in paths], rtol=1e-12, atol=1e-13, err_msg=f"{t}")
    jerk = line((0, 0, 0), (2.0, 0, 0), 0.0)  # up to a stop, and for a stage beyond it, a path goes on as it was
    rest = eqx.filter_jit(Paths.of([jerk]).at)
    for t in (0.0, 0.1):
        np.testing.assert_array_equal(rest(jnp.asarray(t), 0.0), np.zeros((2, 1, 3)))
    np.testing.assert_array_equal(Paths.of([]).at(0.5, 1.0), np.zeros((2, 0, 3)))


def test_an_effect_that_joins_nodes_is_refused():
    model = build(nets()["between supports"])
    pairs = AxialDamping(0.5)
    stand_in = SimpleNamespace(scene=SimpleNamespace(effects=(pairs,)), mass=model.mass, n_free=model.n_free)
    with pytest.raises(ValueError, match=r"need effects that JAX can trace, .*, but AxialDamping is none"):
        jax_net(stand_in)


# --- a spring, not a cable in sight -------------------------------------------------------------------------------------

M, OMEGA, LOSS = 2.0, 5.0, 0.4
STAGES = {"Kvaerno3": 3, "Kvaerno5": 6}  # implicit ones of a step


class Spring(eqx.Module):
    """A mass between x and a wall driven as 0.1 sin t; its force is lost after ``lost``."""

    lost: jax.Array
    k: jax.Array
    mass: jax.Array

    def force(self, t, stop, q, v):
        wall, moving = 0.1 * jnp.sin(t), 0.1 * jnp.cos(t)
        pull = self.k * (jnp.array([wall, 0.0, 0.0]) - q[0])
        f = (pull - M * LOSS * v[0])[None]
        return jnp.where(t > self.lost, jnp.nan, f), jnp.stack([M * LOSS * jnp.sum(v**2), 0.0, pull[0] * moving])

    def factor(self, t, stop, q, v, tau):
        return M * (1.0 + tau * LOSS) + tau**2 * self.k

    def solve(self, factor, r):
        return r / factor


def spring_march(method, lost=np.inf, k=M * OMEGA**2, t_end=2.0):
    motion = Spring(jnp.asarray(lost), jnp.asarray(k), jnp.array([M]))
    q, times = np.array([[0.3, 0.0, 0.0]]), np.linspace(0.0, t_end, 9)
    task = Task(method, 0.0, t_end, np.array([1.0]), q, np.zeros((1, 3)), times, 1e-3, rtol=1e-8, atol=1e-10)
    return diffrax_adapter.march(motion, task)


def spring_solution(t):
    """x'' + loss x' + omega^2 (x - 0.1 sin t) = 0 from x = 0.3 at rest: forced part by undetermined coefficients."""
    a, b = np.linalg.solve([[OMEGA**2 - 1.0, -LOSS], [LOSS, OMEGA**2 - 1.0]], [0.1 * OMEGA**2, 0.0])
    nu, p = np.sqrt(OMEGA**2 - LOSS**2 / 4), 0.3 - b
    r = (-a + LOSS / 2 * p) / nu
    return a * np.sin(t) + b * np.cos(t) + np.exp(-LOSS / 2 * t) * (p * np.cos(nu * t) + r * np.sin(nu * t))


@pytest.mark.parametrize("method", [pytest.param(m, marks=() if m == "Kvaerno5" else pytest.mark.slow) for m in DIFFRAX])
def test_closed_form_and_how_a_lost_force_ends_it(method):
    out = spring_march(method)
    assert out.status == DONE and out.node == -1 and out.reason == ""
    np.testing.assert_array_equal(out.t, np.linspace(0.0, 2.0, 9))
    # some hundred steps of 1e-8 each
    np.testing.assert_allclose(out.q[:, 0, 0], spring_solution(out.t), rtol=0, atol=2e-7)
    energy = 0.5 * M * (out.v[:, 0, 0] ** 2 + OMEGA**2 * (out.q[:, 0, 0] - 0.1 * np.sin(out.t)) ** 2)
    off = energy - out.put_in + out.dissipated
    np.testing.assert_allclose(off[-1], off[0], rtol=0, atol=3e-7 * energy[0])
    np.testing.assert_allclose(off, off[0], rtol=0, atol=5e-6 * energy[0])  # a cubic between steps of 30 ms
    assert out.dissipated[-1] > 0.1 * energy[0]
    if method == "Tsit5":  # six stages a step, and one more and the rates at both starts
        assert out.counts[FORCES] == 6 * (out.counts[STEPS] + out.counts[REJECTED]) + 4
        assert out.counts[NEWTON] == out.counts[FACTORISATIONS] == 0
    else:  # linear, so one iteration solves a stage and one finds it solved; each of two stretches' explicit first stage takes one
        assert out.counts[FACTORISATIONS] == out.counts[STEPS] + out.counts[REJECTED]
        iterations, stages = out.counts[NEWTON], STAGES[method] * out.counts[FACTORISATIONS]
        assert 1.5 * stages < iterations <= 2 * stages + 2
    lost = spring_march(method, lost=0.6)
    assert lost.status == DIVERGED and lost.node == 0
    assert 0.55 < lost.t[-1] <= 0.6 and np.isfinite(lost.q).all() and lost.counts[REJECTED] > 3
    away = spring_march(method, k=-100.0, t_end=20.0)  # x grows by exp(6.87 t), until its velocity is 1e12
    assert (away.status, away.reason) == (DIVERGED, "places or velocities are beyond any sense")
    assert away.t[-1] == pytest.approx(np.log(1e12 / (0.15 * 6.87)) / 6.87, rel=0.1)
    nothing = spring_march(method, lost=-1.0)
    assert nothing.reason == "the force at the start is not finite" and nothing.t.tolist() == [0.0]


# --- runs ---------------------------------------------------------------------------------------------------------------


def uneven_net():
    """Three corners carried along x, a cable of a single segment, a loose one, and cables of several lengths."""
    corners = ((-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.0, 0.5, 0.0))
    points = [*(Driven(f"s{i}", line(at, (0.2, 0.0, 0.0), 0.5)) for i, at in enumerate(corners)), Free("p", 0.036), Free("x", 0.01)]
    links = [("s0", "p", 6, 1.0), ("s1", "p", 4, 0.8), ("s2", "p", 1, 0.7), ("p", "x", 3, 0.4)]
    cables = [Cable(a, b, length=L, mass_per_length=0.1, EA=1e3, zeta=0.05, segments=n) for a, b, n, L in links]
    return Scene(points, cables, [Gravity(9.81), ViscousDamping(0.2)])


T_END = 0.3


@pytest.mark.parametrize("method", DIFFRAX)
def test_a_method_is_marched_by_its_name(method, monkeypatch):
    """Kvaerno3 is but another table of coefficients than Kvaerno5, so that JAX compiles it for the spring above alone."""

    def march(*arguments):
        raise InterruptedError(repr(arguments))

    monkeypatch.setattr(diffrax_adapter, "march", march)
    with pytest.raises(InterruptedError, match=f"['\"]{method}['\"]"):
        simulate(uneven_net(), T_END, method=method)


@pytest.fixture(scope="module")
def carried():
    return {
        method: simulate(uneven_net(), T_END, method=method, rtol=1e-8, atol=1e-11, save_every=0.05)
        for method in ("Tsit5", "Kvaerno5", "DOP853")
    }


@pytest.mark.slow
@pytest.mark.parametrize("method", ["Tsit5", "Kvaerno5"])
def test_methods_agree_on_a_carried_net(carried, method):
    run, other = carried[method], carried["DOP853"]
    assert run.ok and run.message == "" and run.method == method and run.reason.startswith(f"{method}: asked for")
    np.testing.assert_array_equal(run.t, other.t)
    # some hundred steps of 1e-8 of 0.6 m each, and cubic interpolation between them
    np.testing.assert_allclose(run.q, other.q, rtol=0, atol=1e-7)
    np.testing.assert_allclose(run.q[-1], other.q[-1], rtol=0, atol=2e-8)
    assert np.ptp(run.position("p")[:, 0]) > 4e-3
    balance = run.energy_balance
    assert balance.imbalance < 1e-5 and balance.work > 1e-3 and balance.dissipated > 1e-5


@pytest.mark.slow
def test_work_is_that_of_the_methods(carried):
    work = {method: run.work for method, run in carried.items()}
    tries = {method: w.steps + w.rejected for method, w in work.items()}
    assert work["Tsit5"].force_evaluations == 6 * tries["Tsit5"] + 2  # one start: the ramp's end is no corner
    assert work["Kvaerno5"].factorisations == tries["Kvaerno5"] and work["Kvaerno5"].rejected < 0.3 * tries["Kvaerno5"]
    # measured 2.0 iterations a stage; a wrong Jacobian still converges, but slowly
    assert work["Kvaerno5"].newton_iterations < 3.0 * STAGES["Kvaerno5"] * tries["Kvaerno5"]
    assert work["Kvaerno5"].force_evaluations > work["Kvaerno5"].newton_iterations
    assert work["Kvaerno5"].steps < 0.5 * work["Tsit5"].steps


def hung(x=None, compression="none", zeta=0.05, EA=1e3):
    """A cable held at one end, which may jerk: x holds its places along x at 8 samples within a second [m]."""
    x = np.zeros(8) if x is None else np.asarray(x)
    path = samples(np.linspace(0.1, 0.8, 8), np.c_[x, 0 * x, 0 * x])
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=EA, zeta=zeta, segments=8, compression=compression)
    return Scene([Driven("a", path), Free("b", at=(0.97, 0.0, 0.0))], [cable], [Gravity(9.81)])


@pytest.mark.slow
@pytest.mark.parametrize("compression", SWITCHES)
def test_a_cable_dropped_slack(compression):
    """From slack to taut and swinging, against edmc at 40 microseconds, whose own error is of second order."""
    scene, options = hung(compression=compression, zeta=0.5), dict(start="straight", save_every=0.1)
    run = simulate(scene, 0.4, method="Kvaerno5", rtol=1e-7, atol=1e-10, **options)
    fine, finer = (simulate(scene, 0.4, method="edmc", dt=dt, **options) for dt in (8e-5, 4e-5))
    assert run.ok and run.position("b")[-1, 2] < -0.6
    off, left = np.abs(run.q[-1] - finer.q[-1]).max(), np.abs(fine.q[-1] - finer.q[-1]).max()
    assert off < left + 1e-6 < 1e-4  # what is left of edmc's error is a third of its last change
    assert error_of_steps(run) < 1e-4 and run.energy_balance.dissipated > 1e-3


@pytest.mark.slow
def test_corners_are_landed_on_and_a_jerk_is_not_stepped_over():
    """Hanging at rest, steps grow without bound; the recording sets out at a stop."""
    jerk = hung(0.02 * np.array([0, 1, 0, 0, 0, 0, 0, 1.0]))
    still, moved = (simulate(scene, 1.0, method="Kvaerno5", rtol=1e-5, save_every=0.25) for scene in (hung(), jerk))
    assert still.ok and still.work.steps < 40 and np.abs(still.v).max() < 1e-6
    assert moved.ok and moved.energy_balance.work > 1e-3
    exact = simulate(jerk, 1.0, method="DOP853", rtol=1e-9, atol=1e-12, save_every=0.25)
    np.testing.assert_allclose(moved.q[-1], exact.q[-1], rtol=0, atol=2e-4)  # hundreds of steps of 1e-5
    np.testing.assert_array_equal(moved.t, exact.t)


@pytest.mark.slow
def test_runs_that_fail_say_when_and_why(monkeypatch):
    scene = hung()
    with monkeypatch.context() as short:
        short.setattr(diffrax_adapter, "MOST_WORK", 1)
        with pytest.raises(RunError) as failed:
            simulate(hung(zeta=0.0, EA=1e5), 100.0, method="Kvaerno5", start="straight", save_every=25.0, rtol=1e-7, check=True)
    run = failed.value.run
    assert run.status == "unconverged" and len(run.t) == 2 and 0.0 < run.t[-1] < 25.0
    assert re.fullmatch(
        rf"Kvaerno5 with rtol=1e-07, atol=0 m gave up at t={run.t[-1]:.4g} s: 1 steps tried were not enough; "
        r'try other tolerances or method="edmc"\.',
        run.message,
    )
    assert error_of_steps(run) < 1e-3
    start = simulate(scene, 1e-3, method="edmc", dt=1e-3, start="straight").state(0)
    start.q[3, 0] = 1e200
    with pytest.raises(InputError, match=r"must start within 1e\+06 m of each other"):
        simulate(scene, 1.0, method="Kvaerno5", start=start, save_every=0.25)


def test_the_import_is_asked_for_in_words():
    code = (
        "import sys; sys.modules['diffrax'] = None\n"
        "from anet_lumped import Cable, Fixed, Free, Scene, simulate\n"
        "cable = Cable('a', 'b', length=1, mass_per_length=1, EA=1e3, segments=2)\n"
        "scene = Scene([Fixed('a', (0, 0, 0)), Free('b', at=(1, 0, 0))], [cable])\n"
        "simulate(scene, 0.1, method='Kvaerno5', start='straight')"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert 'Method "Kvaerno5" needs the packages jax and diffrax, but there is no diffrax;' in out.stderr
