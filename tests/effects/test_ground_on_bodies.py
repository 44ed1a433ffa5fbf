"""Rigid bodies on the ground: rest, fall, friction, and what a hard ground leaves to the steps."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from anet_lumped import Body, Cable, Fixed, Free, Rod, Scene, simulate
from anet_lumped.effects import Gravity, Ground

G = 9.81
FEET = {f"{i}{j}": (0.3 * i, 0.2 * j, -0.1) for i in (-1, 1) for j in (-1, 1)}
BOX = dict(mass=4.0, inertia=(0.08, 0.12, 0.15), attachments=FEET, contact_area=0.02)


def alone(body, *effects):
    points = [Fixed("far", (20.0, 0.0, 5.0)), Free("tip", at=(21.0, 0.0, 5.0))]
    cables = [Cable("far", "tip", length=1.0, mass_per_length=0.1, EA=1e3, diameter=0.01, segments=2)]
    return Scene(points, cables, [Gravity(G), *effects], bodies=[body])


@pytest.mark.parametrize("stiffness", [1e5, 1e8])
@pytest.mark.parametrize("rotation", [(0.0, 0.0, 0.0), (0.25, 0.1, 0.0)])
def test_a_box_falls_and_comes_to_rest(stiffness, rotation):
    """It stands on its feet, m g/(k A) in the ground; no step raises the energy, whatever it resolves."""
    ground = Ground(0.0, stiffness, 0.4 * math.sqrt(stiffness * 0.02 * 4.0) / 0.02)  # a fifth of critical
    run = simulate(
        alone(Body("b", at=(0.0, 0.0, 0.4), rotation=rotation, **BOX), ground), 6.0, method="edmc", dt=0.005, start="straight"
    )
    energy = run.energy[:, :3].sum(axis=1)
    assert run.status == "done" and np.max(energy - np.minimum.accumulate(energy)) < 1e-9 * energy[0]
    assert run.position("b")[-1, 2] == pytest.approx(0.1 - 4.0 * G / (stiffness * 0.02), abs=1e-6)
    assert_allclose(run.velocity("b")[-1], np.zeros(3), atol=1e-5)
    assert_allclose(run.angular_velocity("b")[-1], np.zeros(3), atol=1e-5)
    assert_allclose(run.rotation("b")[-1][:, 2], (0.0, 0.0, 1.0), atol=1e-5)
    assert abs(run.energy_balance.imbalance) < 1e-6
    load = ground.force_on(run.final)
    assert load[:, 2].sum() == pytest.approx(-4.0 * G, rel=1e-4)


def test_explicit_steps_come_to_the_same_rest():
    ground = Ground(0.0, 1e5, 1e3)
    run = simulate(alone(Body("b", at=(0.0, 0.0, 0.2), **BOX), ground), 3.0, method="verlet", dt=2e-4, start="straight")
    assert run.position("b")[-1, 2] == pytest.approx(0.1 - 4.0 * G / (1e5 * 0.02), abs=1e-4)


def test_a_box_that_slides_stops_after_a_length():
    """v^2/(2 mu g), and the box stays level, for its feet are far apart."""
    ground, speed = Ground(0.0, 1e7, 1e5, friction=0.3, slip_speed=1e-4), 1.5
    scene = alone(Body("b", at=(0.0, 0.0, 0.1 - 4.0 * G / (1e7 * 0.02)), **BOX), ground)
    start = simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0).moved("b", velocity=(speed, 0.0, 0.0))
    run = simulate(scene, 1.0, method="edmc", dt=0.001, start=start)
    assert run.position("b")[-1, 0] == pytest.approx(speed**2 / (2.0 * 0.3 * G), rel=2e-3)


def test_a_rod_lies_on_its_length():
    """Its segments carry its weight on the area d L, at m g/(k d L)."""
    d, length, mu = 0.05, 2.0, 6.0
    rod = Rod("r", (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), diameter=d, mass_per_length=mu, segments=8)
    body = Body("b", at=(0.0, 0.0, 0.1), rotation=(0.0, 0.05, 0.0), rods=[rod])
    run = simulate(alone(body, Ground(0.0, 1e6, 1e5)), 4.0, method="edmc", dt=0.005, start="straight")
    assert run.position("b")[-1, 2] == pytest.approx(-mu * length * G / (1e6 * d * length), rel=1e-4)
    assert math.isclose(run.rotation("b")[-1][2, 0], 0.0, abs_tol=1e-6)


def test_the_area_of_a_body_without_attachments_is_at_its_origin():
    body = Body("b", mass=2.0, inertia=(0.1, 0.1, 0.1), at=(0.0, 0.0, 0.05), contact_area=0.01)
    run = simulate(alone(body, Ground(0.0, 1e6, 1e5)), 2.0, method="edmc", dt=0.005, start="straight")
    assert run.position("b")[-1, 2] == pytest.approx(-2.0 * G / (1e6 * 0.01), rel=1e-4)


def test_on_a_hard_ground_without_damper_the_velocities_do_not_ring():
    """The step does not resolve the contact: what is left of the fall neither bounces nor rings from step to step."""
    run = simulate(
        alone(Body("b", at=(0.0, 0.0, 0.11), **BOX), Ground(0.0, 1e10, 0.0)), 2.0, method="edmc", dt=0.01, start="straight"
    )
    assert run.position("b")[-1, 2] == pytest.approx(0.1, abs=1e-6)
    late = run.t > 1.0
    assert np.abs(run.velocity("b")[late]).max() < 1e-6 and np.abs(run.angular_velocity("b")[late]).max() < 1e-6
    assert abs(run.energy_balance.imbalance) < 1e-6  # rounding of impulses on points of a billionth of the mass
