"""Rigid bodies in motion, against closed forms and Euler's equations."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from anet_lumped import Body, Cable, Fixed, Free, InputError, PayloadChange, Scene, SceneError, equilibrium, simulate
from anet_lumped.effects import Gravity, ViscousDamping, Water

G = 9.81
INERTIA = np.array([0.02, 0.03, 0.045])
ELSEWHERE = (
    [Fixed("far", (5.0, 0.0, 0.0)), Free("tip", at=(6.0, 0.0, 0.0))],
    [Cable("far", "tip", length=1.0, mass_per_length=0.1, EA=1e3, segments=2)],
)  # a scene holds at least one cable


def top(**given):
    """A body that no cable holds."""
    points, cables = ELSEWHERE
    arguments = dict(mass=1.5, inertia=tuple(INERTIA), at=(0.0, 0.0, 0.0), attachments={"hook": (0.1, 0.05, 0.02)}) | given
    return Scene(points, cables, bodies=[Body("top", **arguments)])


def thrown(scene, **motion):
    """State of a scene whose cables are straight, with its body in motion."""
    return simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0).moved(scene.bodies[0].name, **motion)


def momenta(run, body):
    """Momentum (k, 3) and angular momentum about the origin of a body's nodes."""
    nodes = [run.model.node_of[point.name] for point in run.scene.body(body).points]
    m = run.model.mass[nodes]
    return np.einsum("i,kix->kx", m, run.v[:, nodes]), np.einsum("i,kix->kx", m, np.cross(run.q[:, nodes], run.v[:, nodes]))


def test_points_have_the_moments_of_the_body():
    tensor = [[0.02, 0.001, -0.002], [0.001, 0.03, 0.003], [-0.002, 0.003, 0.045]]
    body = Body(
        "b", mass=1.5, inertia=tensor, at=(1.0, 2.0, 3.0), centre_of_mass=(0.1, -0.2, 0.05), attachments={"a": (0.5, 0.4, 0.3)}
    )
    m, arms = np.array([p.mass for p in body.points]), np.array([p.arm for p in body.points])
    d = arms - m @ arms / m.sum()
    assert_allclose(m.sum(), 1.5, rtol=1e-14)
    assert_allclose(m @ arms / m.sum(), (0.1, -0.2, 0.05), atol=1e-14)
    assert_allclose(np.eye(3) * (m @ (d**2).sum(axis=1)) - (m[:, None] * d).T @ d, tensor, atol=1e-14)


def test_intermediate_axis_flips_by_jacobis_functions():
    """Torque-free motion: with L^2 > 2 E J_2 and J_1 < J_2 < J_3, w_2 follows sn (Landau and Lifshitz, Mechanics, section 37)."""
    w0 = np.array([0.05, 3.0, 0.4])
    scene = top()
    run = simulate(scene, 8.0, method="edmc", dt=0.001, start=thrown(scene, angular_velocity=w0))
    J1, J2, J3 = INERTIA
    L2, E2 = ((INERTIA * w0) ** 2).sum(), (INERTIA * w0**2).sum()
    assert L2 > E2 * J2
    rate = np.sqrt((J3 - J2) * (L2 - E2 * J1) / (J1 * J2 * J3))
    k2 = (J2 - J1) * (E2 * J3 - L2) / ((J3 - J2) * (L2 - E2 * J1))
    largest = np.sqrt((E2 * J3 - L2) / (J2 * (J3 - J2)))
    phase = solve_for_phase(w0[1] / largest, k2)
    w = np.einsum("kji,kj->ki", run.rotation("top"), run.angular_velocity("top"))  # in the axes of the body
    sign = np.sign(w[5, 1] - w[0, 1]) or 1.0
    expected = largest * ellipj(sign * rate * run.t + phase, k2)[0]
    assert_allclose(w[:, 1], expected, atol=2e-3 * largest)
    assert w[:, 1].min() < -2.9 and w[:, 1].max() > 2.9  # it flips, and flips back
    assert 3.0 * ellipk(k2) / rate < 8.0


def solve_for_phase(value, k2):
    """u with sn(u) = value, in the first quarter."""
    from scipy.optimize import brentq

    return brentq(lambda u: ellipj(u, k2)[0] - value, 0.0, ellipk(k2))


@pytest.mark.parametrize("spin", [3.0, 50.0])
def test_free_flight_keeps_both_momenta_and_the_energy(spin):
    scene = top(centre_of_mass=(0.03, -0.02, 0.01))
    run = simulate(
        scene, 4.0, method="edmc", dt=0.01,
        start=thrown(scene, velocity=(1.0, -2.0, 0.5), angular_velocity=spin * np.array([0.5, -0.7, 0.4])),
    )  # fmt: skip
    P, L = momenta(run, "top")
    assert np.abs(P - P[0]).max() < 1e-10 * np.abs(P[0]).max()
    assert np.abs(L - L[0]).max() < 1e-10 * np.abs(L).max() + 1e-12 * np.abs(run.position("top")).max() * np.abs(P).max()
    assert np.ptp(run.energy[:, 0]) < 1e-10 * run.energy[0, 0]
    assert run.work.newton_iterations <= (1.3 if spin < 10.0 else 6.0) * run.work.steps


@pytest.mark.parametrize("method", ["edmc", "dop853", "verlet", "rk4", "symplectic_euler"])
def test_methods_agree_with_eulers_equations(method):
    w0, t_end = np.array([0.4, 3.0, -0.6]), 1.0
    scene = top()

    def rates(t, y):
        R, w = y[:9].reshape(3, 3), y[9:]
        across = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        return np.concatenate([(R @ across).ravel(), -np.cross(w, INERTIA * w) / INERTIA])

    exact = solve_ivp(rates, (0.0, t_end), np.concatenate([np.eye(3).ravel(), w0]), method="DOP853", rtol=1e-12, atol=1e-13)
    R = exact.y[:9, -1].reshape(3, 3)
    order = {"edmc": 2, "verlet": 2, "symplectic_euler": 1}.get(method, 4)
    steps = {"rtol": 1e-11, "atol": 1e-12} if method == "dop853" else {}
    errors = []
    for dt in (0.01,) if steps else (0.02, 0.01):
        run = simulate(scene, t_end, method=method, dt=dt, start=thrown(scene, angular_velocity=w0), **steps)
        errors.append(np.abs(run.rotation("top")[-1] - R).max())
    if steps:
        assert errors[0] < 1e-9
    else:
        assert abs(np.log2(errors[0] / errors[1]) - order) < 0.3


def test_edmc_is_of_order_two():
    w0 = np.array([0.4, 3.0, -0.6])
    scene = top()
    ends = [
        simulate(scene, 1.0, method="edmc", dt=dt, start=thrown(scene, angular_velocity=w0)).rotation("top")[-1]
        for dt in (0.01, 0.005, 0.0025)
    ]
    assert abs(np.log2(np.abs(ends[0] - ends[1]).max() / np.abs(ends[1] - ends[2]).max()) - 2.0) < 0.15


def period(t, x):
    """Mean time between upward crossings of zero [s], by straight lines between saves."""
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    times = t[up] - x[up] * (t[up + 1] - t[up]) / (x[up + 1] - x[up])
    return float(np.diff(times).mean())


@pytest.mark.parametrize("method", ["edmc", "dop853"])
def test_period_of_a_physical_pendulum(method):
    """T = 2 pi sqrt((J + m c^2)/(m g c)) of small swings."""
    c, J, m = 0.3, 0.02, 1.2
    points, cables = ELSEWHERE
    body = Body("bar", mass=m, inertia=(J, J, 0.01), at=(0.0, 0.0, 0.0), centre_of_mass=(0.0, 0.0, -c), pinned="")
    scene = Scene(points, cables, [Gravity(G)], bodies=[body])
    steps = {"rtol": 1e-9} if method == "dop853" else {"dt": 0.002}
    start = thrown(scene).moved("bar", rotation=(0.01, 0.0, 0.0))
    run = simulate(scene, 6.0, method=method, start=start, save_every=0.002, **steps)
    swing = run.rotation("bar")[:, 1, 2]
    assert_allclose(period(run.t, swing), 2.0 * np.pi * np.sqrt((J + m * c**2) / (m * G * c)), rtol=1e-4)
    assert_allclose(run.position("bar"), np.zeros_like(run.position("bar")), atol=1e-12)


def test_period_of_a_bifilar_pendulum():
    """T = 2 pi sqrt(J L/(m g b^2)) of small turns about the vertical, on two light cables of length L at the distances +-b."""
    J, m, b, L = 0.05, 2.0, 0.25, 1.5
    body = Body(
        "bar", mass=m, inertia=(0.002, J, J), at=(0.0, 0.0, -L), attachments={"left": (-b, 0.0, 0.0), "right": (b, 0.0, 0.0)}
    )
    points = [Fixed("a", (-b, 0.0, 0.0)), Fixed("b", (b, 0.0, 0.0))]
    cables = [Cable(*ends, length=L, mass_per_length=1e-5, EA=1e5, segments=1) for ends in (("a", "bar.left"), ("b", "bar.right"))]
    scene = Scene(points, cables, [Gravity(G)], bodies=[body])
    run = simulate(scene, 8.0, method="edmc", dt=0.004, start=equilibrium(scene).moved("bar", rotation=(0.0, 0.0, 0.02)))
    assert_allclose(period(run.t, run.rotation("bar")[:, 1, 0]), 2.0 * np.pi * np.sqrt(J * L / (m * G * b**2)), rtol=1e-3)


def test_precession_of_a_heavy_top():
    """A fast symmetric top in steady precession W about the vertical: J_3 s W - (J_1 - J_3) W^2 cos(a) = m g c, exactly.

    s is the spin along its axis in the axes of the world, less what precession adds; a the angle of the axis to the vertical.
    """
    m, c, J1, J3, a, W = 0.8, 0.12, 0.004, 0.006, 0.6, 2.5
    about_pivot = J1 + m * c**2
    spin = (m * G * c + (about_pivot - J3) * W**2 * np.cos(a)) / (J3 * W)
    points, cables = ELSEWHERE
    body = Body(
        "top", mass=m, inertia=(J1, J1, J3), at=(0.0, 0.0, 0.0), rotation=(0.0, a, 0.0), centre_of_mass=(0.0, 0.0, c), pinned=""
    )
    scene = Scene(points, cables, [Gravity(G)], bodies=[body])
    axis = np.array([np.sin(a), 0.0, np.cos(a)])
    start = thrown(scene, angular_velocity=spin * axis + W * np.array([0.0, 0.0, 1.0]))
    run = simulate(scene, 2.0, method="edmc", dt=2.5e-4, start=start)
    axes = run.rotation("top")[:, :, 2]
    assert_allclose(axes[:, 2], np.cos(a), atol=1e-5)
    turned = np.unwrap(np.arctan2(axes[:, 1], axes[:, 0]))
    assert_allclose(turned, W * run.t, atol=1e-3)


@pytest.mark.parametrize("EA", [1e2, 1e5, 1e9])
@pytest.mark.parametrize("dt", [0.02, 0.005])
@pytest.mark.parametrize("start", ["overstretched", "slack"])
def test_hard_starts_do_not_raise_the_energy(EA, dt, start):
    corners = {f"c{i}{j}": (0.2 * i, 0.15 * j, 0.05) for i in (-1, 1) for j in (-1, 1)}
    box = Body("box", mass=1.5, inertia=tuple(INERTIA), at=(0.02, 0.0, -0.1), attachments=corners)
    points = [Fixed(name, (2.0 * x, 2.0 * y, 1.0)) for name, (x, y, _) in corners.items()]
    length = 0.97 if start == "overstretched" else 1.4
    cables = [Cable(name, f"box.{name}", length=length, mass_per_length=0.02, EA=EA, zeta=0.05, segments=4) for name in corners]
    scene = Scene(points, cables, [Gravity(G)], bodies=[box])
    spin = np.array([20.0, -30.0, 35.0])  # 50 rad/s
    run = simulate(
        scene, 1.0, method="edmc", dt=dt, start=thrown(scene, velocity=(1.0, 0.4, 0.5), angular_velocity=spin), save_every=dt
    )
    energy = run.energy[:, :3].sum(axis=1)
    assert run.status == "done"
    assert np.max(energy - np.minimum.accumulate(energy)) < 1e-10 * energy[0]  # what Newton's method leaves out of balance


def test_what_takes_energy_takes_it_from_bodies_too():
    """Damping by mass: momentum and spin decay by exp(-rate t)."""
    points, cables = ELSEWHERE
    body = Body("b", mass=1.5, inertia=(0.03, 0.03, 0.03), at=(0.0, 0.0, 0.0))
    scene = Scene(points, cables, [ViscousDamping(0.7)], bodies=[body])
    run = simulate(
        scene, 2.0, method="edmc", dt=0.005, start=thrown(scene, velocity=(1.0, 0.0, 0.0), angular_velocity=(0.0, 2.0, 0.0))
    )
    assert_allclose(run.velocity("b")[:, 0], np.exp(-0.7 * run.t), atol=1e-5)
    assert_allclose(run.angular_velocity("b")[:, 1], 2.0 * np.exp(-0.7 * run.t), atol=2e-5)
    assert abs(run.energy_balance.imbalance) < 1e-12


def test_a_payload_is_not_on_a_body():
    scene = top()
    with pytest.raises(SceneError, match=r'A payload must be at a free point, but one is to change at "top\.hook", which is none'):
        replace(scene, events=[PayloadChange("top.hook", 0.1, 1.0)])


def test_a_method_that_moves_no_bodies_is_refused_in_a_sentence():
    with pytest.raises(InputError, match=r"Bodies that move need one of the methods .*edmc.*, but the method is sdirk2"):
        simulate(top(), 1.0, method="sdirk2", dt=0.01, start="straight")


def test_the_account_closes_where_a_body_moves_water():
    """Added mass at attachments that turn: the fluid is given what the velocities of the body at both ends of a step say."""
    cable = Cable("a", "b.l", length=1.0, mass_per_length=0.02, EA=1e4, zeta=0.05, segments=3, diameter=0.02)
    body = Body("b", mass=1.5, inertia=tuple(INERTIA), at=(0.2, 0.0, -1.0), attachments={"l": (-0.2, 0.0, 0.0)})
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0))], [cable], [Gravity(G), Water()], bodies=[body])
    start = equilibrium(scene).moved("b", velocity=(0.1, 0.0, 0.0), angular_velocity=(0.5, 1.0, 2.0))
    exact = simulate(scene, 0.2, method="dop853", rtol=1e-10, start=start).q[-1]
    runs = [simulate(scene, 0.2, method="edmc", dt=dt, start=start) for dt in (1e-3, 2.5e-4)]
    assert all(abs(run.energy_balance.imbalance) < 1e-8 for run in runs)
    errors = [np.abs(run.q[-1] - exact).max() for run in runs]
    assert errors[1] < 2e-6 and errors[0] > 8.0 * errors[1]
