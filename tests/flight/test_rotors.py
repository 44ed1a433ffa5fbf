"""Rotors: how thrusts make torques, lag and saturation, drag; the numbers of the quadrotors."""

from dataclasses import replace

import numpy as np
import pytest
from flying import mixed
from scipy.integrate import quad

from anet_lumped import SceneError
from anet_lumped.flight.quadrotor import CRAZYFLIE, THESIS_QUADROTOR, Quadrotor, quadrotor
from anet_lumped.flight.rotors import Rotors

LEVEL, STILL = np.eye(3)[None], np.zeros((1, 3))


@pytest.mark.parametrize("of", [CRAZYFLIE, THESIS_QUADROTOR])
def test_it_hovers_with_room_to_climb(of):
    hover = of.mass * 9.81 / 4.0
    assert 1.3 * hover < of.largest_thrust < 4.0 * hover
    body = quadrotor("quad", (0, 0, 1), of, attachments={"hook": (0, 0, -0.02)})
    assert body.mass == of.mass and body.inertia_tensor == pytest.approx(of.inertia_tensor)


@pytest.mark.parametrize("of", [CRAZYFLIE, THESIS_QUADROTOR])
def test_mixing(of):
    thrusts = of.largest_thrust * np.array([0.2, 0.5, 0.3, 0.7])
    force, torque = mixed(of, thrusts)
    assert of.mixing @ thrusts == pytest.approx([force, *torque], rel=1e-12)
    rotors = Rotors([replace(of, lag=0.0, drag=(0, 0, 0))], 0.004)
    acting, turning = rotors.step(np.array([force]), torque[None], LEVEL, STILL)
    assert acting[0] == pytest.approx([0.0, 0.0, force], rel=1e-12) and turning[0] == pytest.approx(torque, rel=1e-12)
    assert rotors.speed[0] == pytest.approx(np.sqrt(thrusts / of.thrust_coefficient), rel=1e-12)


def test_lag_is_exact_for_a_held_command():
    """Mean of k omega^2 over the step with omega(t) = c + (omega_0 - c) exp(-t/lag), by quadrature; the speed at the end."""
    of, dt = THESIS_QUADROTOR, 0.004
    rotors = Rotors([replace(of, drag=(0, 0, 0))], dt)
    rotors.settle(np.array([8.0]), STILL)
    first = rotors.speed[0, 0]
    c = np.sqrt(14.0 / 4.0 / of.thrust_coefficient)
    for step in range(3):
        force, torque = rotors.step(np.array([14.0]), STILL, LEVEL, STILL)
        mean, _ = quad(lambda t: of.thrust_coefficient * (c + (first - c) * np.exp(-t / of.lag)) ** 2, step * dt, (step + 1) * dt)
        assert force[0, 2] == pytest.approx(4.0 * mean / dt, rel=1e-12)
        assert np.abs(torque).max() < 1e-12
        assert rotors.speed[0] == pytest.approx(np.full(4, c + (first - c) * np.exp(-(step + 1) * dt / of.lag)), rel=1e-12)


def test_torques_come_first_and_what_rotors_cannot_give_is_cut_off():
    of = replace(THESIS_QUADROTOR, lag=0.0, drag=(0, 0, 0))
    rotors = Rotors([of], 0.004)
    rotors.step(np.array([100.0]), STILL, LEVEL, STILL)
    assert rotors.speed[0] == pytest.approx(np.full(4, of.largest_speed), rel=1e-12)
    for thrust in (-3.0, 1.0, 23.0):  # below zero, and above what four rotors give with that torque
        force, torque = rotors.step(np.array([thrust]), np.array([[0.5, -0.2, 0.01]]), LEVEL, STILL)
        assert torque[0] == pytest.approx([0.5, -0.2, 0.01], rel=1e-12)
        assert (force[0, 2] > 1.0) if thrust < 20.0 else (force[0, 2] < 23.0)
    rotors.step(np.array([1.0]), np.array([[5.0, 0.0, 0.0]]), LEVEL, STILL)
    assert rotors.speed[0].min() == 0.0 and rotors.speed[0].max() == pytest.approx(of.largest_speed, rel=1e-12)


def test_drag_is_in_the_axes_of_the_body():
    of = replace(CRAZYFLIE, lag=0.0)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # its x axis along y
    rotors = Rotors([of], 0.004)
    force, _ = rotors.step(np.array([0.25]), STILL, turn[None], np.array([[0.0, 2.0, 1.0]]))
    speeds = rotors.speed.sum()
    assert force[0] == pytest.approx([-speeds * of.drag[0] * 2.0, 0.0, 0.25 - speeds * of.drag[2]], rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(("change", "message"), [
    ({"mass": 0.0}, r"`mass` must be positive and finite \[kg\], but Quadrotor has mass=0.0"),
    ({"lag": -1.0}, r"`lag` must be non-negative and finite \[s\]"),
    ({"drag": (1.0, 2.0)}, r"`drag` must be three finite numbers"),
    ({"inertia": (1.0, 1.0, 3.0)}, "none above the sum of the other two"),
])  # fmt: skip
def test_refuses(change, message):
    with pytest.raises(SceneError, match=message):
        replace(CRAZYFLIE, **change)


def test_what_is_no_quadrotor():
    with pytest.raises(SceneError, match="`of` of quadrotor must be a Quadrotor, such as CRAZYFLIE, but it is 'crazyflie'"):
        quadrotor("quad", (0, 0, 0), "crazyflie")
    assert isinstance(CRAZYFLIE, Quadrotor)
