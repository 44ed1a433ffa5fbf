"""Boxes that float: draft, Archimedes' lists, rolling and heaving, by closed forms; and no energy from the surface."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from slow import slow

from anet_lumped import Body, Cable, Fixed, Free, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity, ViscousDamping, Water

G, RHO = 9.81, 1000.0
THIN = dict(mass_per_length=1e-6, EA=1e4, diameter=1e-4)


def box(density, edges=(1.0, 3.0, 1.0), **given):
    """A homogeneous box."""
    m, (x, y, z) = density * RHO * math.prod(edges), np.square(edges)
    inertia = (m * (y + z) / 12.0, m * (x + z) / 12.0, m * (x + y) / 12.0)
    return Body("box", **(dict(mass=m, inertia=inertia, hull=edges, at=(0.0, 0.0, 0.0)) | given))


def alone(body, *effects):
    points = [Fixed("far", (60.0, 0.0, 30.0)), Free("tip", at=(60.0, 0.0, 29.0))]  # hangs at rest
    far = Cable("far", "tip", length=1.0, segments=2, mass_per_length=20.0, EA=1e6, diameter=0.1)  # its forces are no rounding
    return Scene(points, [far], [Gravity(G), Water(RHO), *effects], bodies=[body])


def list_of(s):
    """Angle of list of a square section of density s over that of water [rad], by Archimedes.

    With two corners under water the righting arm is sin(a) (GM + BM/2 tan(a)^2), with BM = 1/(12 s) and BG = (1 - s)/2.
    """
    if s == 0.5:
        return math.pi / 4.0
    slope = 12.0 * s * (1.0 - s) - 2.0
    return math.atan(math.sqrt(slope)) if slope > 0.0 else 0.0


@pytest.mark.parametrize("s", [0.1, 0.2, 0.22, 0.23, 0.5, 0.77, 0.8, 0.9])
def test_archimedes_list(s):
    """On a slack cable, from a start that is turned by a little: upright, at a list, or on an edge."""
    body = box(s, rotation=(0.0, 0.05, 0.0), at=(0.0, 0.0, 0.5 - s))
    cable = Cable("bed", "box", length=6.0, segments=6, **THIN)
    rest = equilibrium(Scene([Fixed("bed", (0.0, 0.0, -5.0))], [cable], [Gravity(G), Water(RHO)], bodies=[body]))
    assert rest.stable
    up = rest.rotation("box")[2]
    assert up[1] == pytest.approx(0.0, abs=1e-5)
    angle = math.atan2(abs(up[0]), abs(up[2]))
    assert min(angle, math.pi / 2.0 - angle) == pytest.approx(list_of(s), abs=1e-6)  # any of its sides may be the upper one
    arms = np.array([rest.position(point.name) for point in body.points]) - rest.position("box")
    assert_allclose(np.linalg.norm(arms, axis=1), [math.hypot(*point.arm) for point in body.points], atol=1e-12)


def test_where_the_upright_box_turns_unstable():
    """s (1 - s) = 1/6, which is 0.2113: by the sign of the stiffness against a small list."""
    for s, sign in ((0.2112, 1.0), (0.2115, -1.0), (0.7886, -1.0), (0.7889, 1.0)):
        body = box(s, at=(0.0, 0.0, 0.5 - s))
        scene = alone(body)
        start = simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0)
        level = start.moved("box", rotation=(0.0, 0.0, 0.0))
        turned = start.moved("box", rotation=(0.0, 1e-3, 0.0))
        effect, model = scene.effects[1].on_bodies(scene), start.model
        f = np.zeros((model.n, 3))
        effect.kernels()["force"](0.0, turned.q, np.zeros_like(f), *effect.table(model), f)
        moment = np.cross(turned.q - level.position("box"), f).sum(axis=0)[1]
        assert moment * sign < 0.0


@pytest.mark.parametrize("method", ["edmc", *slow("dop853")])
def test_rolling_period(method):
    """2 pi sqrt(J/(m g GM)) of small rolls, GM = BM - BG, without added mass; and the box heaves not at all."""
    s, edges = 0.6, (2.0, 4.0, 1.0)
    draft = s * edges[2]
    body = box(s, edges, at=(0.0, 0.0, 0.5 * edges[2] - draft), rotation=(0.0, 0.01, 0.0))
    GM = edges[0] ** 2 / (12.0 * draft) - 0.5 * (edges[2] - draft)
    steps = {"rtol": 1e-9} if method == "dop853" else {"dt": 0.01}
    run = simulate(alone(body), 15.0, method=method, start="straight", save_every=0.01, **steps)
    x = -run.rotation("box")[:, 2, 0]
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    times = run.t[up] - x[up] * (run.t[up + 1] - run.t[up]) / (x[up + 1] - x[up])
    exact = 2.0 * math.pi * math.sqrt(body.whole.inertia[1, 1] / (body.mass * G * GM))
    assert_allclose(np.diff(times).mean(), exact, rtol=3e-4)
    assert abs(run.energy_balance.imbalance) < 1e-7


def test_heaving_period():
    """2 pi sqrt((m + Ca rho V)/(rho g A)): water pushed aside goes with the share under water."""
    s, edges, Ca = 0.5, (1.0, 1.5, 0.8), 0.4
    body = box(s, edges, at=(0.0, 0.0, 0.002), Ca=(0.0, 0.0, Ca), centre_of_mass=(0.0, 0.0, -0.3))
    run = simulate(alone(body), 12.0, method="edmc", dt=0.005, start="straight", save_every=0.005)
    z = run.position("box")[:, 2]
    up = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
    times = run.t[up] - z[up] * (run.t[up + 1] - run.t[up]) / (z[up + 1] - z[up])
    mass = body.mass + Ca * RHO * math.prod(edges) * s
    assert_allclose(np.diff(times).mean(), 2.0 * math.pi * math.sqrt(mass / (RHO * G * edges[0] * edges[1])), rtol=1e-3)


@pytest.mark.parametrize("dt", [0.05, 0.01])
def test_a_box_that_tumbles_through_the_surface_gains_no_energy(dt):
    body = box(0.5, (1.0, 0.6, 0.8), at=(0.0, 0.0, 2.0), rotation=(0.4, 0.5, 0.2))
    scene = alone(body)
    start = simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0).moved("box", angular_velocity=(1.0, 3.0, 2.0))
    run = simulate(scene, 6.0, method="edmc", dt=dt, start=start)
    energy = run.energy[:, :3].sum(axis=1)
    scale = body.mass * G * 2.0
    assert np.max(energy - np.minimum.accumulate(energy)) < 1e-8 * scale  # what Newton's method leaves out of balance
    assert np.ptp(energy[run.t > 0.5]) < 1e-8 * scale  # once the far cable has stretched
    assert run.work.newton_iterations < 2.2 * run.work.steps  # 2.6 if the tangent of the lift joins no nodes


def test_a_damped_box_comes_to_the_rest_of_statics():
    s = 0.23
    run = simulate(
        alone(box(s, rotation=(0.0, 0.05, 0.0), at=(0.0, 0.0, 0.5 - s)), ViscousDamping(1.0)),
        60.0,
        method="edmc",
        dt=0.05,
        start="straight",
    )
    up = run.rotation("box")[-1][2]
    assert math.atan2(abs(up[0]), up[2]) == pytest.approx(list_of(s), abs=1e-4)
