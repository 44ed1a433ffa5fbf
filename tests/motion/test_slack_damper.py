"""The numerical damper of `edmc` acts only where the spring does: a slack segment of a damped cable is no glue."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, State, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model.build import build

WEIGHT, C, Z0 = 13.0 * 9.81, 707.1, 0.3  # [N], [N s/m], [m]


def thrown(speed, EA=2e9, law="damped"):
    """A weight above a support, on one slack segment of 0.6 m whose damper acts all the same, and its velocity upwards [m/s]."""
    cable = Cable("a", "w", length=0.6, mass_per_length=1e-9, EA=EA, BA=0.6 * C, segments=1, compression=law)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("w", mass=13.0, at=(0.0, 0.0, Z0))], [cable], [Gravity(9.81)])
    model = build(scene)
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    q[model.node("w"), 2], v[model.node("w"), 2] = Z0, speed
    return scene, State(model, 0.0, q, v, np.zeros(1))


@pytest.mark.parametrize("speed", [0.0, 2.0, -2.0])
@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("EA", [1e2, 2e5, 2e9])
def test_only_the_dashpot_acts_on_a_slack_segment(speed, rho_inf, EA):
    """M dv/dt = -W - c v: v = -W/c + (v_0 + W/c) exp(-c t/M), whatever the stiffness of the spring that does not push.

    c h/2M = 0.027 at 1 ms: the trapezoidal rule, which edmc is here, is off by a twelfth of its square in each time constant; the
    method takes from the velocity at the end what the dashpot's own stiffness leaves, of fifth order in c h/M.
    """
    scene, start = thrown(speed, EA)
    run = simulate(scene, 0.1, method="edmc", dt=1e-3, start=start, rho_inf=rho_inf)
    limit, tau = -WEIGHT / C, 13.0 / C
    z = Z0 + limit * run.t + (speed - limit) * tau * (1.0 - np.exp(-run.t / tau))
    v = limit + (speed - limit) * np.exp(-run.t / tau)
    np.testing.assert_allclose(run.position("w")[:, 2], z, atol=1e-4 * abs(speed - limit) * tau)
    np.testing.assert_allclose(run.velocity("w")[:, 2], v, atol=3e-4 * abs(speed - limit))
    taken = run.energy_balance
    assert taken.by_dampers == pytest.approx(C * np.trapezoid(v**2, run.t), rel=2e-3)
    assert abs(taken.by_method) < 1e-4 * taken.by_dampers


def test_the_step_may_be_long():
    """A step of seven time constants: the place follows -W t/c within half a step, and the velocity does not ring about that."""
    scene, start = thrown(0.0)
    run = simulate(scene, 1.0, method="edmc", dt=0.125, start=start)
    assert run.position("w")[-1, 2] == pytest.approx(Z0 - WEIGHT / C, abs=0.5 * run.dt * WEIGHT / C)
    assert run.velocity("w")[-1, 2] == pytest.approx(-WEIGHT / C, rel=0.05)
    assert math.isclose(run.energy_balance.imbalance, 0.0, abs_tol=1e-9)
