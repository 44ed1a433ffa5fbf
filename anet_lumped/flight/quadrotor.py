"""Quadrotors: a rigid body with four rotors in its plane, and the numbers of two of them.

The rotors stand at the angles 45, 135, 225 and 315 degrees about the body's z axis, from its x axis, at the distance ``arm`` from
its centre. Each pulls along z with the thrust k omega^2 of its speed omega and turns the body against its own spin by c k omega^2,
the first about +z, the next about -z, and so on. The air drags the body by -(sum omega) K v, with its velocity v in its own axes.

Source: Mahony, Kumar and Corke, IEEE Robot. Autom. Mag. 19(3) (2012) 20, for thrust, torque and the drag of rotors.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_number, check_vector, shown
from anet_lumped.scene.body import Body


@dataclass(frozen=True)
class Quadrotor:
    """The numbers of a quadrotor.

    Parameters
    ----------
    mass : float [kg]
    inertia : (3,) or (3, 3) array_like [kg m2], as of a `Body`
    arm : float [m], distance of the rotors from the centre
    thrust_coefficient : float [N s2], k: thrust over the square of a rotor's speed
    torque_ratio : float [m], c: torque over thrust
    largest_speed : float [rad/s], of a rotor
    lag : float [s], time constant of a rotor's speed; 0: it follows at once
    drag : (3,) array_like [kg], K along the axes of the body, over the sum of the rotors' speeds
    """

    mass: float
    inertia: Sequence[Any]
    arm: float
    thrust_coefficient: float
    torque_ratio: float
    largest_speed: float
    lag: float = 0.0
    drag: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        units = {"mass": "kg", "arm": "m", "thrust_coefficient": "N s2", "torque_ratio": "m", "largest_speed": "rad/s"}
        for key, unit in units.items():
            object.__setattr__(self, key, check_number(key, getattr(self, key), unit, "Quadrotor", sign="positive"))
        object.__setattr__(self, "lag", check_number("lag", self.lag, "s", "Quadrotor", sign="non-negative"))
        object.__setattr__(self, "drag", check_vector("drag", self.drag, "kg", "Quadrotor"))
        Body("quadrotor", mass=self.mass, inertia=self.inertia, at=(0, 0, 0))  # says what is wrong with an inertia

    @cached_property
    def mixing(self) -> np.ndarray:
        """(4, 4) matrix: thrusts of the rotors [N] to the whole thrust [N] and the torque about the axes of the body [N m]."""
        angle = 0.25 * np.pi + 0.5 * np.pi * np.arange(4)
        x, y = self.arm * np.cos(angle), self.arm * np.sin(angle)
        return np.array([np.ones(4), y, -x, self.torque_ratio * np.array([1.0, -1.0, 1.0, -1.0])])

    @property
    def largest_thrust(self) -> float:
        """Thrust of a rotor at its largest speed [N]."""
        return self.thrust_coefficient * self.largest_speed**2

    @cached_property
    def inertia_tensor(self) -> np.ndarray:
        """(3, 3) inertia [kg m2]."""
        return Body("quadrotor", mass=self.mass, inertia=self.inertia, at=(0, 0, 0)).inertia_tensor


CRAZYFLIE = Quadrotor(
    mass=0.028,
    inertia=(
        (16.571710e-6, 0.830806e-6, 0.718277e-6),
        (0.830806e-6, 16.655602e-6, 1.800197e-6),
        (0.718277e-6, 1.800197e-6, 29.261652e-6),
    ),
    arm=0.046,
    thrust_coefficient=1.28192e-8,
    torque_ratio=0.005964552,
    largest_speed=3052.0,
    lag=0.0125,
    drag=(9.1785e-7, 9.1785e-7, 10.311e-7),
)  # fmt: skip
"""The Crazyflie 2.0 with its battery. Mass, inertia, torque over thrust, speed at full command and drag: Foerster, System
Identification of the Crazyflie 2.0 Nano Quadrocopter, ETH Zurich (2015). Thrust coefficient, arm and lag: model crazyflie2 of the
RotorS simulator, Furrer et al. (2016)."""

THESIS_QUADROTOR = Quadrotor(
    mass=1.04,
    inertia=(1.04 / 0.716 * 0.007, 1.04 / 0.716 * 0.007, 1.04 / 0.716 * 0.012),
    arm=0.17,
    thrust_coefficient=8.54858e-6,
    torque_ratio=0.016,
    largest_speed=838.0,
    lag=0.0125,
    drag=(8.06428e-5, 8.06428e-5, 0.0),
)
"""The quadrotor of 1.04 kg of the thesis (appendix 7.2), which tells no more of it. All else is that of the Hummingbird of
0.716 kg, whose inertia is taken in proportion to the mass: Furrer et al., RotorS - A Modular Gazebo MAV Simulator Framework
(2016)."""


def quadrotor(
    name: str, at: Vector, of: Quadrotor = CRAZYFLIE, *, rotation: Vector = (0.0, 0.0, 0.0),
    attachments: Mapping[str, Vector] | Sequence[tuple[str, Vector]] = (),
) -> Body:  # fmt: skip
    """The body of a quadrotor, whose origin is its centre of mass.

    Parameters
    ----------
    name : name of the body
    at : (3,) array_like [m], where it starts
    of : Quadrotor
    rotation : (3,) array_like [rad], rotation vector of its axes at the start
    attachments : dict of name to (3,) array_like [m]

    Raises
    ------
    SceneError : `of` is no Quadrotor; what `Body` refuses
    """
    if not isinstance(of, Quadrotor):
        raise SceneError(f"Argument `of` of quadrotor must be a Quadrotor, such as CRAZYFLIE, but it is {shown(of)}.")
    return Body(name, mass=of.mass, inertia=of.inertia, at=at, rotation=rotation, attachments=attachments)
