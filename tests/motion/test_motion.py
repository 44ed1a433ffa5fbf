"""Motion of nets: against an independent solver, symmetries, momenta, and going on from a state."""

import itertools

import naive
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_net import small_net, state
from systems import MU, scatter

from anet_lumped import (
    Cable,
    Driven,
    Free,
    Scene,
    simulate,
)
from anet_lumped.model.build import build


@pytest.mark.parametrize(
    ("compression", "zeta"), [pytest.param("none", 0.0, marks=pytest.mark.slow), ("damped", 0.2), ("linear", 0.2)]
)
def test_against_an_independent_solver(compression, zeta):
    """The equations of motion written a second time, marched by scipy: they share no line with the code.

    Without dampers for "none", whose tension jumps where a moving segment turns taut: solvers lose order there.
    """
    scene, t_end = small_net(compression=compression, zeta=zeta), 0.06
    model = build(scene)
    m, n = naive.masses(model), model.n_free
    driven, path = model.node("b"), scene.point("b").path
    run = simulate(scene, t_end, method="rk4", dt=1e-5, save_every=t_end, start="straight")
    q, v = run.q[0].copy(), run.v[0].copy()

    def rates(t, y):
        q[:n], v[:n] = y.reshape(2, n, 3)
        q[driven], v[driven], _ = path.at(t)
        return np.concatenate([v[:n].ravel(), (naive.force(model, q, v)[0][:n] / m[:n, None]).ravel()])

    y0 = np.concatenate([q[:n].ravel(), v[:n].ravel()])
    exact = solve_ivp(rates, (0, t_end), y0, method="DOP853", rtol=1e-7, atol=1e-9).y[:, -1].reshape(2, n, 3)
    # the law has a kink where a segment turns taut or slack: scipy's tolerance and what both solvers lose there
    np.testing.assert_allclose(run.q[-1, :n], exact[0], atol=1e-6)
    np.testing.assert_allclose(run.v[-1, :n], exact[1], atol=1e-4)
    assert np.abs(exact[0] - run.q[0, :n]).max() > 0.01  # [m]; it has moved


TURN = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)

SAME = {
    "shifted": (dict(shift=(3.0, -2.0, 5.0)), lambda x: x + np.array([3.0, -2.0, 5.0])),
    "turned": (dict(turn=TURN), lambda x: x @ TURN.T),
    "renumbered": (dict(order=1), lambda x: x),
    "renumbered otherwise": (dict(order=4), lambda x: x),
    "one cable reversed": (dict(flipped=("x-y",)), lambda x: x),
    "all cables reversed": (dict(flipped=("a-x", "x-b", "x-y", "second")), lambda x: x),
}


@pytest.mark.each_once
@pytest.mark.parametrize("case", SAME)
@pytest.mark.parametrize("method", ["verlet", "edmc", "backward_euler", "sdirk2"])
def test_same_motion(method, case, solve_to):
    """Translation, rotation (gravity and paths too), numbering and direction of cables change nothing but rounding."""
    solve_to(1e-8)
    changes, expected = SAME[case]
    plain, changed = small_net(), small_net(**changes)
    dt = 1e-4 if method == "verlet" else 5e-3
    a, b = (simulate(scene, 0.3, method=method, dt=dt, save_every=0.05, start="straight") for scene in (plain, changed))
    # 60 steps of a force error of 1e-8 of some 0.1 N on 10 g, over 0.3 s: 1e-8 m; verlet has rounding alone, 1e-12 m
    tolerance = 1e-11 if method == "verlet" else 1e-8
    for cable in plain.cables:
        shape = b.shape(cable.name)[:, :: -1 if cable.name in changes.get("flipped", ()) else 1]
        np.testing.assert_allclose(shape, expected(a.shape(cable.name)), atol=tolerance)
        T = b.tension(cable.name)[:, :: -1 if cable.name in changes.get("flipped", ()) else 1]
        # k = EA/L0 times that, up to 1200 N/m, and c times errors of velocities
        np.testing.assert_allclose(T, a.tension(cable.name), atol=5e3 * tolerance)
    for mine, theirs in zip(a.energy.T, b.energy.T, strict=True):  # not where the height counts from
        np.testing.assert_allclose(theirs - theirs[0], mine - mine[0], atol=1e2 * tolerance)


@pytest.mark.parametrize(("method", "keeps_spin"), [("verlet", True), ("edmc", True), ("backward_euler", False)])
def test_momentum_of_a_flying_net(method, keeps_spin, solve_to):
    """Without supports and weight: linear momentum is kept by all, angular momentum by edmc (and Verlet) to the end."""
    solve_to(1e-10)
    points = [Free(name, 0.02) for name in "xyz"]
    cables = [
        Cable(p, q, length=0.5, mass_per_length=MU, EA=500.0, zeta=0.1, segments=4) for p, q in itertools.combinations("xyz", 2)
    ]
    scene = Scene(points, cables)
    model, rng = build(scene), np.random.default_rng(2)
    q, v = scatter(model, rng), rng.normal(size=(model.n, 3))
    dt = 1e-4 if method == "verlet" else 2e-3
    run = simulate(scene, 0.5, method=method, dt=dt, save_every=0.1, start=state(scene, q, v))
    assert run.ok
    m = naive.masses(model)[:, None]
    P, L = (m * run.v).sum(axis=1), (m * np.cross(run.q, run.v)).sum(axis=1)
    # 250 steps whose forces are out of balance by 1e-10 of up to 500 N on 12 nodes; Verlet has rounding alone
    np.testing.assert_allclose(P, P[[0]].repeat(len(P), 0), atol=1e-8)
    if keeps_spin:
        np.testing.assert_allclose(L, L[[0]].repeat(len(L), 0), atol=1e-8)
    else:
        assert np.abs(L[-1] - L[0]).max() > 1e-4


@pytest.mark.parametrize("method", ["verlet", "edmc"])
def test_a_run_goes_on_from_its_state(method):
    """Halfway and on again is one run, driven points at their own times included."""
    scene, dt = small_net(), 1e-4 if method == "verlet" else 5e-3
    whole = simulate(scene, 0.3, method=method, dt=dt, start="straight")
    first = simulate(scene, 0.15, method=method, dt=dt, start="straight")
    second = simulate(scene, 0.15, method=method, dt=dt, start=first.final)
    assert second.t[0] == first.t[-1] and second.t[-1] == pytest.approx(0.3, rel=1e-15)
    atol = 1e-11  # rounding of the times
    if method == "edmc":  # whose numerical damper looks back on two steps, and is in full at a start: a small part of its error
        finer = simulate(scene, 0.3, method=method, dt=0.5 * dt, start="straight")
        atol = 0.01 * np.abs(whole.q[-1] - finer.q[-1]).max()
    np.testing.assert_allclose(second.q[-1], whole.q[-1], atol=atol)
    for point in scene.points:
        if isinstance(point, Driven):
            for run in (whole, second):
                at = [point.path.at(t) for t in run.t]
                # the same formula, compiled with fused products
                np.testing.assert_allclose(run.position(point.name), [x for x, _, _ in at], rtol=1e-14, atol=1e-16)
                np.testing.assert_allclose(run.velocity(point.name), [x for _, x, _ in at], rtol=1e-14, atol=1e-15)
