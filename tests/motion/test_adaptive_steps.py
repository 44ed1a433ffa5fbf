"""Adaptive steps: their error, where they land, and the energy."""

import numpy as np
import pytest
from systems import four_cables, hanging_chain, loose_cable, spring_mass

from anet_lumped import (
    Driven,
    Scene,
    simulate,
)
from anet_lumped.prescribed import paths
from integrators import schemes


@pytest.mark.parametrize("rho_inf", [0.0, 1.0])
def test_adaptive_error_follows_the_tolerance(rho_inf):
    net, t_end = four_cables(1e4, carried=True), 1.5
    exact = simulate(net, t_end, method="verlet", dt=2e-5)
    off, estimates, steps = [], [], []
    for rtol in (1e-4, 1e-5, 1e-6, 1e-7):
        run = simulate(net, t_end, rtol=rtol, rho_inf=rho_inf)
        assert run.ok and run.method == "edmc" and run.t[-1] == t_end
        off.append(np.abs(run.q[-1] - exact.q[-1]).max())
        estimates.append(run.error_estimate)
        steps.append(run.work.steps)
    # an error per step of h^3 makes the whole error of rtol^(2/3): 4.6 times less for each
    assert np.all(np.array(off[:-1]) > 3.0 * np.array(off[1:]))
    assert np.all(np.diff(steps) > 0)
    # a sum of local errors: right up to how they grow or cancel on the way (0.7 to 1.2 measured)
    np.testing.assert_array_less(np.abs(np.log(np.array(estimates) / off)), np.log(2.0))


@pytest.mark.parametrize("rho_inf", [0.0, 1.0])
def test_adaptive_estimate_in_pure_stretching(rho_inf):
    """The numerical damper fades where the step resolves the stretching, so that the estimate is right at any rho_inf."""
    motion = spring_mass()
    run = simulate(motion.scene, motion.t_end, rtol=1e-6, start=motion.start, rho_inf=rho_inf)
    off = np.abs(run.q[-1, :1, 0] - motion.exact(motion.t_end)[0]).max()
    assert 0.3 < off / run.error_estimate < 3.0


@pytest.mark.parametrize("method", [*schemes.names(own=True, stable_undamped=True, embedded=False, takes_rigid_springs=False)])
def test_adaptive_steps_of_any_scheme(method):
    """Error and estimate are of one size; the schemes carry a force from step to step, which a step taken back must restore."""
    motion = hanging_chain(rate=1.0, amplitude=1e-2)
    exact = simulate(motion.scene, motion.t_end, method="rk4", dt=1e-4, start=motion.start).q[-1]
    rtol = 1e-7 if method == "rk4" or schemes.scheme(method).order == 2 else 1e-6
    run = simulate(motion.scene, motion.t_end, method=method, rtol=rtol, start=motion.start)
    assert run.ok
    off = np.abs(run.q[-1] - exact).max()
    # 0.5 to 2.2 for the implicit ones; the errors of verlet and rk4 change sign with the motion and cancel: 0.18 and 0.03
    assert (0.02 if method in ("verlet", "rk4") else 0.2) < off / run.error_estimate < 5.0


def test_adaptive_lands_where_asked():
    """On t_end, on what is saved and on corners, where the speed of a driven point jumps."""
    corner = Driven("a", paths.line((0, 0, 0), (0, 0.3, 0), ramp=0.0))
    net = loose_cable(1e4)
    scene = Scene([corner, net.points[1]], net.cables, net.effects)
    times = np.arange(0.0, 0.31, 0.07)
    run = simulate(scene, 0.3, rtol=1e-7, save_every=0.07, start="straight")
    np.testing.assert_allclose(run.t, [*times, 0.3], rtol=1e-14)
    # driven points are interpolated as all are, by a cubic, which a line is
    np.testing.assert_allclose(run.position("a")[:, 1], 0.3 * run.t, atol=1e-9)
    fixed = simulate(scene, 0.28, method="edmc", dt=2e-4, save_every=0.07, start="straight")
    assert np.abs(run.q[:-1] - fixed.q).max() < 3e-5  # [m], both with errors of some 5e-6 m
    longer = simulate(scene, 0.3, atol=1e-5, start="straight")
    assert longer.ok and len(longer.t) == 401 and longer.t[-1] == 0.3 and longer.work.steps < run.work.steps


def test_adaptive_keeps_the_energy_statement():
    """Each step taken is one of `edmc`: energy at the end is what was dissipated less than at the start."""
    for EA in (1e2, 1e6):
        run = simulate(loose_cable(EA), 0.6, rtol=1e-5, start="straight")
        balance = run.energy_balance
        assert run.ok and balance.dissipated > 0 and balance.kinetic + balance.elastic + balance.potential < 0
        # Newton's force error of 1e-6 of the weight over the way of each node, in hundreds of steps
        assert balance.imbalance < 1e-6
