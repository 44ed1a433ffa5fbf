"""Which quadrotor a body of a scene is."""

from dataclasses import replace

import pytest

from anet_lumped import InputError, load_scene
from anet_lumped.flight.known import known_quadrotor, known_quadrotors
from anet_lumped.flight.quadrotor import CRAZYFLIE, THESIS_QUADROTOR, quadrotor

NET = load_scene("quadrotors_net")


def test_a_quadrotor_is_known_by_its_mass_and_its_inertia():
    assert known_quadrotors(NET) == {f"quad{i}": THESIS_QUADROTOR for i in range(4)}
    assert known_quadrotor(quadrotor("a", (0, 0, 0), CRAZYFLIE)) is CRAZYFLIE
    slower = replace(NET.bodies[0], inertia=(0.02, 0.02, 0.03))
    assert known_quadrotor(slower) is None and known_quadrotor(replace(NET.bodies[0], mass=1.05)) is None


def test_a_body_that_is_none_is_refused():
    heavy = replace(NET, bodies=[replace(NET.bodies[0], mass=3.0), *NET.bodies[1:]])
    with pytest.raises(
        InputError,
        match=r'known quadrotor, that of the thesis \(1.04 kg\) and the Crazyflie \(0.028 kg\), but body "quad0" of 3 kg',
    ):
        known_quadrotors(heavy)


def test_a_scene_without_any_is_refused():
    with pytest.raises(InputError, match=r"^A flight needs a scene with quadrotors, but no body of this one moves freely\."):
        known_quadrotors(load_scene("net_held"))
