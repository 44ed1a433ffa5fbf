"""Bodies that are pinned to other bodies: against an integration of their own, closed forms and what has to be kept."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from test_bodies import ELSEWHERE, G, thrown

from anet_lumped import Body, Cable, Fixed, Scene, paths, simulate
from anet_lumped.effects import Gravity, Water
from anet_lumped.prescribed.turning import matrix_of

UPPER = dict(mass=1.2, inertia=(0.02, 0.025, 0.01), at=(0.0, 0.0, 0.0), rotation=(0.5, 0.2, 0.0), centre_of_mass=(0.0, 0.0, -0.3))
LOWER = dict(mass=0.8, inertia=(0.01, 0.012, 0.004), rotation=(1.0, -0.3, 0.2), centre_of_mass=(0.0, 0.01, -0.2))
LOW, TOP = (0.02, 0.0, -0.6), (0.0, 0.0, 0.05)
SPINS = np.array([0.5, -1.0, 2.0]), np.array([-2.0, 1.5, -3.0])


def pair(*effects, **upper):
    """Two bodies, the lower one pinned to the upper one, listed first to show that the order is of no concern."""
    one = Body("upper", **UPPER | dict(pinned="", attachments={"low": LOW}) | upper)
    other = Body("lower", **LOWER, attachments={"top": TOP}, pinned="top", pinned_to="upper.low")
    points, cables = ELSEWHERE
    return Scene(points, cables, effects, bodies=[other, one])


def across(x):
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def double_pendulum(t_end, spins):
    """Rotations and angular velocities of `pair` at t_end, by the principle of virtual power.

    With the centres c_1 = R_1 r_1 and c_2 = R_1 l + R_2 r_2 and the angular velocities W as unknowns, v_i = B_i W, sum over both of
    B_i^T m (B_i W' + b_i) + J_i w_i' + w_i x J_i w_i = sum of B_i^T m g. Source: T. R. Kane, Dynamics (1968).
    """
    m, J = np.array([UPPER["mass"], LOWER["mass"]]), [np.diag(UPPER["inertia"]), np.diag(LOWER["inertia"])]
    r1, joint = np.array(UPPER["centre_of_mass"]), np.array(LOW)
    r2 = np.array(LOWER["centre_of_mass"]) - TOP

    def rates(t, y):
        (R1, R2), (w1, w2) = y[:18].reshape(2, 3, 3), y[18:].reshape(2, 3)
        c1, l, c2 = R1 @ r1, R1 @ joint, R2 @ r2
        B = [np.hstack([-across(c1), np.zeros((3, 3))]), np.hstack([-across(l), -across(c2)])]
        b = [np.cross(w1, np.cross(w1, c1)), np.cross(w1, np.cross(w1, l)) + np.cross(w2, np.cross(w2, c2))]
        M, right = np.zeros((6, 6)), np.zeros(6)
        for i, (R, w) in enumerate(((R1, w1), (R2, w2))):
            own, inertia = slice(3 * i, 3 * i + 3), R @ J[i] @ R.T
            M += m[i] * B[i].T @ B[i]
            M[own, own] += inertia
            right += m[i] * B[i].T @ (np.array([0.0, 0.0, -G]) - b[i])
            right[own] -= np.cross(w, inertia @ w)
        return np.concatenate([(across(w1) @ R1).ravel(), (across(w2) @ R2).ravel(), np.linalg.solve(M, right)])

    start = [matrix_of(body["rotation"]).ravel() for body in (UPPER, LOWER)]
    exact = solve_ivp(rates, (0.0, t_end), np.concatenate([*start, *spins]), method="DOP853", rtol=1e-12, atol=1e-13)
    return exact.y[:18, -1].reshape(2, 3, 3), exact.y[18:, -1].reshape(2, 3)


def spun(scene):
    return thrown(scene).moved("upper", angular_velocity=SPINS[0]).moved("lower", angular_velocity=SPINS[1])


@pytest.mark.parametrize("method", ["edmc", "dop853", "verlet", "rk4", "backward_euler"])
def test_a_double_pendulum_against_an_integration_of_its_own(method):
    rotations, rates = double_pendulum(1.0, SPINS)
    scene = pair(Gravity(G))
    start, errors = spun(scene), []
    steps = [{"rtol": 1e-11, "atol": 1e-12}] if method == "dop853" else [{"dt": dt} for dt in (0.004, 0.002, 0.001)]
    for step in steps:
        run = simulate(scene, 1.0, method=method, start=start, **step)
        assert np.abs(run.position("lower.top") - run.position("upper.low")).max() < 1e-14
        found = [run.rotation(name)[-1] - R for name, R in zip(("upper", "lower"), rotations, strict=True)]
        of_rates = [run.angular_velocity(name)[-1] - w for name, w in zip(("upper", "lower"), rates, strict=True)]
        errors.append((np.abs(found).max(), np.abs(of_rates).max()))
        print(method, step, errors[-1], run.energy_balance, run.work)
    if method == "dop853":
        assert errors[0][0] < 1e-8
    else:
        order = {"edmc": 2, "verlet": 2, "rk4": 4, "backward_euler": 1}[method]
        slopes = np.log2(np.divide(errors[-2], errors[-1]))
        assert_allclose(slopes, order, atol=0.15)
