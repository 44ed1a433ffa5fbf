"""scipy's solvers on a closed form and on the carried net: agreement, energy, counts, corners, and how a run fails."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.sparse import csc_array

from anet_lumped.effects import Gravity
from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.jacobian import sparse_jacobian
from anet_lumped.model.build import build
from anet_lumped.motion.choice import Choice
from anet_lumped.motion.legs import Settings, Start
from anet_lumped.motion.scipy_methods import march
from anet_lumped.motion.simulate import straight
from anet_lumped.motion.times import Leg, stops
from anet_lumped.prescribed.paths import line, samples
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, Scene
from anet_lumped.statics.equilibrium import equilibrium
from integrators import schemes
from integrators.adapters import scipy_adapter
from integrators.adapters.outcome import Task
from integrators.adapters.scipy_adapter import Motion
from integrators.schemes.record import Origin
from integrators.system import DIVERGED, DONE

METHODS = schemes.names(origin=Origin.SCIPY)
CORNERS = ((-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0))


def run(scene, method, t_end, *, q=None, dt=1e-3, save_every=None, tolerances=(1e-6, 1e-9)):
    model = build(scene)
    q = equilibrium(scene).q.copy() if q is None else q
    choice = Choice(method, dt, "asked for", np.inf, ())
    start = Start(q, np.zeros_like(q), np.zeros(model.n_segments))
    return march(model, choice, Leg(0.0, t_end, 0.0, t_end, save_every), start, Settings(True, tolerances, None))


def carried_net():
    return Scene(
        [Driven(f"s{i}", line(at, (0.2, 0.0, 0.0), 1.0)) for i, at in enumerate(CORNERS)] + [Free("p0", mass=0.036)],
        [
            Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=20)
            for i in range(4)
        ],
        [Gravity(9.81)],
    )  # fmt: skip


def loose_cable(compression="none", zeta=0.05, reach=1.0):
    return Scene(
        [Fixed("a", (0, 0, 0)), Free("b", at=(reach, 0, 0))],
        [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=10, zeta=zeta, compression=compression)],
        [Gravity(9.81)],
    )


@pytest.fixture(scope="module")
def carried():
    return {method: run(carried_net(), method, 0.3, tolerances=(1e-9, 1e-12), save_every=0.05) for method in METHODS}


def spring(omega=5.0, loss=0.4, fails_at=np.inf):
    """A mass of 2 kg on a spring between x and a wall driven as 0.1 sin t: plain Python, not a cable in sight."""
    m, k, c = 2.0, 2.0 * omega**2, 2.0 * loss

    def prescribe(t, q, v):
        q[1], v[1] = (0.1 * np.sin(t), 0.0, 0.0), (0.1 * np.cos(t), 0.0, 0.0)

    def force(t, q, v, f, power):
        f[0] = k * (q[1] - q[0]) - c * v[0] if t <= fails_at else np.nan
        f[1] = k * (q[0] - q[1])
        power[:] = c * np.sum(v[0] ** 2), 0.0, -np.sum(f[1] * v[1])

    def jacobian(t, q, v):
        eye = np.eye(3)
        return csc_array(np.block([[0.0 * eye, eye], [-k / m * eye, -c / m * eye]]))

    return Motion(prescribe, force, jacobian, np.array([m]))


def spring_march(method, motion, t_end=2.0, rtol=1e-9, atol=1e-11):
    q, v = np.array([[0.3, 0.0, 0.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
    times = np.linspace(0.0, t_end, 9)
    return scipy_adapter.march(motion, Task(method, 0.0, t_end, np.array([1.0]), q, v, times, 1e-3, rtol=rtol, atol=atol))


def spring_solution(t, omega=5.0, loss=0.4):
    """x'' + loss x' + omega^2 (x - 0.1 sin t) = 0 from x = 0.3 at rest: forced part by undetermined coefficients."""
    a, b = np.linalg.solve([[omega**2 - 1.0, -loss], [loss, omega**2 - 1.0]], [0.1 * omega**2, 0.0])
    nu = np.sqrt(omega**2 - loss**2 / 4)
    p = 0.3 - b
    r = (-a + loss / 2 * p) / nu
    return a * np.sin(t) + b * np.cos(t) + np.exp(-loss / 2 * t) * (p * np.cos(nu * t) + r * np.sin(nu * t))


@pytest.mark.parametrize("method", METHODS)
def test_closed_form_and_its_energy(method):
    out = spring_march(method, spring())
    assert out.status == DONE and out.node == -1 and out.reason == ""
    # measured 6e-8 at worst (BDF, some hundred steps of 1e-9 each)
    np.testing.assert_allclose(out.q[:, 0, 0], spring_solution(out.t), rtol=0, atol=3e-7)
    stretch = out.q[:, 0] - np.sin(out.t)[:, None] * (0.1, 0.0, 0.0)
    kinetic, elastic = np.sum(out.v[:, 0] ** 2, axis=1), 25.0 * np.sum(stretch**2, axis=1)  # of 2 kg on 50 N/m
    off = kinetic + elastic - out.put_in + out.dissipated
    np.testing.assert_allclose(off, off[0], rtol=0, atol=1e-6 * elastic[0])
    assert out.dissipated[-1] > 0.1 * elastic[0]


@pytest.mark.parametrize("method", METHODS)
def test_a_force_that_is_lost_ends_the_march_where_it_is(method):
    out = spring_march(method, spring(fails_at=0.6), rtol=1e-6, atol=1e-9)
    assert out.status == DIVERGED and out.node == 0
    assert 0.5 < out.t[-1] <= 0.6
    assert np.isfinite(out.q).all() and np.isfinite(out.dissipated).all()


def test_a_singular_matrix_is_a_failure_with_its_reason():
    def singular():
        raise RuntimeError("Factor is exactly singular")

    assert scipy_adapter._step(SimpleNamespace(step=singular)) == "Factor is exactly singular"


@pytest.mark.parametrize(
    "method", [pytest.param(m, marks=pytest.mark.slow if m in ("RK45", "Radau") else ()) for m in METHODS if m != "DOP853"]
)
def test_methods_agree_on_the_carried_net(carried, method):
    run, other = carried[method], carried["DOP853"]
    assert run.ok and run.message == "" and run.error_estimate is None
    np.testing.assert_array_equal(run.t, other.t)
    # steps of 1e-9 each, and of either sign: measured 3e-11 m, and that times omega_max = 1.3e4 1/s in velocity
    np.testing.assert_allclose(run.q, other.q, rtol=0, atol=2e-10)
    np.testing.assert_allclose(run.v, other.v, rtol=0, atol=2e-6)
    assert np.ptp(run.position("p0")[:, 0]) > 1e-4


@pytest.mark.parametrize("method", METHODS)
def test_energy_balances_on_the_carried_net(carried, method):
    balance = carried[method].energy_balance
    assert balance.imbalance < 1e-8  # measured 1.2e-9 at worst
    # all that moves was put in by the corners
    assert balance.work == pytest.approx(balance.kinetic + balance.elastic + balance.potential, rel=1e-6)


@pytest.mark.each_once
@pytest.mark.parametrize("compression", ["none", "damped", "linear"])
@pytest.mark.parametrize("method", ["RK45", "Radau", "LSODA"])
def test_energy_balances_on_a_cable_that_starts_slack(method, compression):
    scene = loose_cable(compression, zeta=0.5, reach=0.97)
    result = run(scene, method, 0.5, q=straight(build(scene)))
    assert result.ok
    assert result.energy_balance.imbalance < 1e-4  # measured 3e-5 at worst, at rtol = 1e-6
    assert result.energy_balance.dissipated > 1e-3


def test_counts_are_those_of_the_methods(carried):
    work = {method: run.work for method, run in carried.items()}
    # one evaluation for the start, one for the solver's own start, then stages for every step tried
    assert work["RK45"].force_evaluations == 2 + 6 * (work["RK45"].steps + work["RK45"].rejected)
    interpolations = len(carried["DOP853"].t) - 1
    tries = work["DOP853"].steps + work["DOP853"].rejected
    assert work["DOP853"].force_evaluations == 2 + 12 * tries + 3 * interpolations
    assert work["BDF"].force_evaluations == 2 + work["BDF"].newton_iterations
    assert work["Radau"].force_evaluations >= 2 + 3 * work["Radau"].newton_iterations + work["Radau"].steps
    for method in ("RK45", "DOP853"):
        assert work[method].newton_iterations == work[method].factorisations == 0
    for method in METHODS:
        assert work[method].halvings == 0


def test_an_exact_jacobian_keeps_newton_short(carried):
    # measured 2.6 and 2.7 iterations and 1.2 and 0.4 factorisations a step; a wrong Jacobian still converges, but slowly
    radau, bdf, lsoda = (carried[method].work for method in ("Radau", "BDF", "LSODA"))
    assert radau.newton_iterations < 3.5 * radau.steps and radau.factorisations < 2 * radau.steps
    assert bdf.newton_iterations < 3.2 * bdf.steps and bdf.factorisations < 0.5 * bdf.steps
    assert lsoda.force_evaluations < 1.5 * lsoda.steps


@pytest.mark.parametrize("method", ["RK45", "DOP853", "Radau", "BDF"])
def test_work_and_loss_do_not_change_the_steps(method):
    motion, rtol, atol = spring(), 1e-6, 1e-9
    q, v, f, power = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros(3)

    def rates(t, y):
        q[0], v[0] = y[:3], y[3:]
        motion.prescribe(t, q, v)
        motion.force(t, q, v, f, power)
        return np.concatenate([v[0], f[0] / 2.0])

    alone = solve_ivp(
        rates, (0.0, 1.0), [0.3, 0, 0, 0, 0, 0], method, rtol=rtol, atol=atol, first_step=1e-3,
        **({"jac": motion.jacobian(0.0, q, v).toarray()} if method in ("Radau", "BDF") else {}),
    )  # fmt: skip
    out = spring_march(method, motion, 1.0, rtol, atol)
    # scipy's Newton tolerance follows rtol by its square root and is scaled along; steps may differ by that little
    assert out.counts[0] == pytest.approx(len(alone.t) - 1, abs=0 if method in ("RK45", "DOP853") else 2)
    if method in ("RK45", "DOP853"):
        assert out.q[-1, 0, 0] == pytest.approx(alone.y[0, -1], rel=1e-12)


def test_band_for_lsoda_is_narrow_and_holds_the_whole_jacobian():
    model = build(carried_net())
    net, q = fresh_net(model), equilibrium(carried_net()).q.copy()
    compiled = system(model)
    motion = Motion(
        lambda t, q, v: compiled.prescribe(t, net.address, q, v), None, sparse_jacobian(model, net), model.mass[: model.n_free]
    )
    equations = scipy_adapter._Equations(motion, q, np.zeros_like(q))
    y = equations.y.copy()
    whole = equations.matrix(0.0, y).toarray()
    options = equations.narrow(0.0)
    order, lower, upper = equations.order, options["lband"], options["uband"]
    packed = options["jac"](0.0, y[order])
    row, column = np.indices(whole.shape)
    inside = (row - column <= lower) & (column - row <= upper)
    unpacked = np.zeros_like(whole)
    unpacked[inside] = packed[(row - column + upper)[inside], column[inside]]
    np.testing.assert_array_equal(unpacked, whole[np.ix_(order, order)])
    # four cables side by side, six unknowns a node: about 6 (4 + 1) on either side, of 464
    assert lower + upper < 90 < len(y) / 5


def pulse_after_a_rest():
    """A cable whose end rests for 1.5 s and then jerks for 40 ms; its recording begins at once."""
    t = np.concatenate([np.linspace(0.0, 1.5, 31), np.linspace(1.5, 1.54, 9)[1:], np.linspace(1.6, 3.0, 15)])
    x = np.where((t > 1.5) & (t < 1.54), 0.02 * np.sin(np.pi * (t - 1.5) / 0.04) ** 2, 0.0)
    return Scene(
        [Driven("a", samples(t, np.c_[x, 0 * x, 0 * x])), Fixed("b", (0.8, 0.0, 0.0))],
        [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=6, zeta=0.05)],
        [Gravity(9.81)],
    )


@pytest.mark.parametrize("method", METHODS)
def test_a_motion_after_a_rest_is_not_stepped_over(method):
    result = run(pulse_after_a_rest(), method, 1.54, dt=0.01)
    # LSODA without the stop at 1.05 s takes 31 steps and finds no motion at all
    assert result.ok
    assert np.abs(result.v[-1]).max() > 0.5
    assert result.energy_balance.work > 0.02


def test_stops_are_the_corners_and_where_a_path_sets_out():
    # the spline through samples at rest rings before the pulse, by 0.27 a sample: above a millionth from 1.05 s on
    np.testing.assert_allclose(stops(pulse_after_a_rest()), [0.0, 1.05, 3.0])
    still = samples([0.0, 1.0, 2.0], np.zeros((3, 3)))
    scene = Scene(
        [Driven("a", still), Driven("b", line((1.0, 0.0, 0.0), (0.0, 0.0, 0.2), 0.5))],
        [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=2)],
    )
    np.testing.assert_allclose(stops(scene), [0.0, 2.0])
    assert stops(loose_cable()).shape == (0,)


@pytest.mark.parametrize("save_every", [None, 0.1, 0.07])
def test_saved_times_are_those_asked_for(save_every):
    result = run(pulse_after_a_rest(), "RK45", 0.3, save_every=save_every, dt=0.01)
    expected = {None: np.linspace(0.0, 0.3, 401), 0.1: [0, 0.1, 0.2, 0.3], 0.07: [0, 0.07, 0.14, 0.21, 0.28, 0.3]}
    np.testing.assert_allclose(result.t, expected[save_every], rtol=1e-15)
    assert result.t[-1] == 0.3 and len(result.q) == len(result.v) == len(result.energy) == len(result.t)


@pytest.mark.parametrize("method", METHODS)
def test_too_much_work_ends_the_run_with_its_good_part(monkeypatch, method):
    monkeypatch.setattr(scipy_adapter, "MOST_WORK", 300)
    scene = loose_cable()
    result = run(scene, method, 2.0, q=straight(build(scene)), save_every=1.0)
    assert result.status == "unconverged" and not result.ok
    assert result.message.startswith(f"{method} with rtol=1e-06, atol=1e-09 m gave up at t={result.t[-1]:.4g} s: ")
    assert result.message.endswith('300 force evaluations were not enough; try other tolerances or method="edmc".')
    assert 0.0 < result.t[-1] < 2.0 and result.energy_balance.imbalance < 1e-2
    assert result.final.position("b")[2] < 0.0


@pytest.mark.parametrize("method", METHODS)
def test_a_start_beyond_all_bounds_has_diverged(method):
    scene = loose_cable()
    q = straight(build(scene))
    q[3, 0] = 1e200
    result = run(scene, method, 1.0, q=q)
    assert result.status == "diverged"
    assert re.search(r'diverged at t=0 s at node \d of 10 of cable "a-b": the force at the start is not', result.message)


def test_places_beyond_any_sense_have_diverged():
    def away(t, q, v, f, power):
        f[0], f[1], power[:] = 100.0 * q[0], 0.0, 0.0

    motion = spring()._replace(force=away)
    out = spring_march("RK45", motion, t_end=10.0, rtol=1e-3, atol=1e-3)
    assert (out.status, out.node, out.reason) == (DIVERGED, 0, "places or velocities are beyond any sense")
    # x = 0.3 cosh(growth t) with growth^2 = 100/2, until its velocity is 1e12
    growth = np.sqrt(50.0)
    assert out.t[-1] == pytest.approx(np.log(1e12 / (0.15 * growth)) / growth, rel=0.1)


def test_what_scipy_says_is_the_reason():
    failing = SimpleNamespace(step=lambda: "Required step size is less than spacing between numbers.")
    assert scipy_adapter._step(failing) == "Required step size is less than spacing between numbers."


def test_a_coordinate_of_zero_needs_no_atol():
    # all nodes on one spot in the origin: nothing to be relative to but the cable's length
    result = run(loose_cable(), "RK45", 0.1, q=np.zeros((11, 3)), tolerances=(1e-6, 0.0))
    assert result.ok and result.work.steps < 2000
