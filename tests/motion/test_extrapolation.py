"""Runs extrapolated from a step and its half: order 4, the scheme's statements that are kept, arguments."""

import numpy as np
import pytest
from systems import MOTIONS, four_cables, loose_cable

from anet_lumped import simulate
from anet_lumped.results.energy_balance import error_of_steps

RATIOS = np.array([1.0, 1.4, 2.0, 2.8])  # four numbers of steps


def errors(motion, rho_inf, steps):
    """Largest error of places and of velocities over the run, of a coarse step that divides it in ``steps``."""
    dt = motion.t_end / steps
    run = simulate(motion.scene, motion.t_end, method="edmc", dt=dt, save_every=dt, start=motion.start, rho_inf=rho_inf,
                   extrapolate=True)  # fmt: skip
    assert run.ok and run.dt == dt
    n = run.model.n_free
    x, v = np.moveaxis([motion.exact(t) for t in run.t], 1, 0)
    return np.abs(run.q[:, :n, 0] - x).max(), np.abs(run.v[:, :n, 0] - v).max()


@pytest.mark.parametrize("system", MOTIONS)
def test_order(system, solve_to):
    """At rho_inf = 1; the numerical damper, of higher order by itself, switches with the motion, which is no series in h^2."""
    # what Newton's tolerance leaves, of the force of a swing that is 1e-5 of the weight, stays below the errors measured
    solve_to(1e-12)
    swing = not MOTIONS[system](1e-4).axial
    motion = MOTIONS[system](1e-6 if swing else 1e-4)  # the closed form of a swing is that of a small one
    steps = np.round(motion.steps * (0.15 if swing else 0.5) * RATIOS).astype(int)
    found = np.log([errors(motion, 1.0, n) for n in steps])
    slopes = -np.polyfit(np.log(steps), found, 1)[0]
    np.testing.assert_allclose(slopes, 4.0, atol=0.15)


def test_carried_net():
    """With its numerical damper: the two runs' mean loss of accuracy is that of h^2, the extrapolated run's far below."""
    net = four_cables(1e6, carried=True)
    exact = simulate(net, 2.0, method="edmc", dt=2.5e-3, save_every=0.04, extrapolate=True)
    coarse, fine = (simulate(net, 2.0, method="edmc", dt=dt, save_every=0.04) for dt in (0.02, 0.01))
    run = simulate(net, 2.0, method="edmc", dt=0.02, save_every=0.04, extrapolate=True)
    off = [np.linalg.norm(r.position("p0") - exact.position("p0"), axis=1).max() for r in (coarse, fine, run)]
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.02) and off[1] > 15.0 * off[2]
    np.testing.assert_array_equal(run.t, coarse.t)
    assert run.error_estimate == pytest.approx(np.linalg.norm(fine.q - coarse.q, axis=2).max() / 3.0)
    assert run.work.steps == 300 and run.dt == 0.02 and run.extrapolated and "extrapolated" in run.reason
    assert not coarse.extrapolated
    assert error_of_steps(run) < 1e-6


def test_statements_of_the_scheme_are_kept_to_the_error():
    """Undamped and partly slack: tensions never push, and the energy rises by no more than what the two runs differ by."""
    run = simulate(loose_cable(1e4, 0.0), 0.4, dt=5e-3, method="edmc", start="straight", extrapolate=True)
    assert run.ok and (run.segment_tension >= 0.0).all()
    energy = run.energy[:, :3].sum(axis=1)
    assert np.diff(energy).max() < 1e-3 * np.ptp(run.energy[:, 2])


def test_audit_knows_the_order():
    net = four_cables(1e6, carried=True)
    run = simulate(net, 1.0, method="edmc", dt=0.02, save_every=0.04, extrapolate=True, audit=1e-5)
    exact = simulate(net, 1.0, method="edmc", dt=1.25e-3, save_every=0.04, extrapolate=True)
    assert run.ok and run.audit.passed
    # the step from order 4 to the next is not small here: the ramp's corners
    assert run.audit.error == pytest.approx(np.linalg.norm(run.q - exact.q, axis=2).max(), rel=0.3)


def test_the_last_step_may_be_shorter():
    run = simulate(four_cables(1e4), 0.1, method="edmc", dt=0.03, extrapolate=True)
    np.testing.assert_allclose(run.t, [0.0, 0.03, 0.06, 0.09, 0.1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (dict(method="rk4"), r'`extrapolate` needs method="edmc" with a fixed step, but the method is rk4\.'),
        (dict(rtol=1e-4), r"`extrapolate` needs .* a fixed step, but `rtol` or `atol` is given\."),
    ],
)
def test_arguments(options, message):
    with pytest.raises(ValueError, match=message):
        simulate(four_cables(), 0.1, extrapolate=True, **options)
