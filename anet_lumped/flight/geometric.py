"""The geometric controller of quadrotors on SE(3), also with the pulls of cables fed forward.

With errors e_x, e_v of place and velocity, the force that a quadrotor of mass m shall exert is

    F = m (a_d - omega_x^2 e_x - 2 zeta omega_x e_v + g e_3) - P

with the measured pull P of its cables, if that is fed forward. Its thrust is F . R e_3; the attitude R_d has its z axis along F and
its x axis near the heading. With the errors of attitude and angular velocity in the axes of the body,

    e_R = 1/2 (R_d^T R - R^T R_d)^v ,   e_W = W ,
    tau = J (-omega_R^2 e_R - 2 zeta omega_R e_W) + W x J W - M

with the measured moment M of its cables. The rate of R_d is left out. The gains are given as the frequencies omega_x and omega_R of
both loops and their damping ratio zeta.
Source: Lee, Leok and McClamroch, Geometric Tracking Control of a Quadrotor UAV on SE(3), 49th IEEE CDC (2010) 5420.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from anet_lumped.checks import check_number
from anet_lumped.prescribed.path_in_numbers import counted
from anet_lumped.prescribed.paths import Path

from .compiled_law import CompiledLaw, Goal, Wrench, law_of
from .laws import attitudes_along, exert, go_along, stay, turn_to
from .quadrotor import Quadrotor
from .seen import Seen
from .timing import Held


def hold(positions: Any) -> CompiledLaw:
    """Guide that keeps quadrotors at places (m, 3) [m]."""
    places = np.array(positions, float).reshape(-1, 3)
    return CompiledLaw(stay, places, gives="goal", quadrotors=len(places))


def follow(paths: Sequence[Path]) -> CompiledLaw:
    """Guide that takes each quadrotor along a path of `anet_lumped.paths`."""
    return CompiledLaw(go_along, np.concatenate([np.zeros(0), *map(counted, paths)]), gives="goal", quadrotors=len(paths))


class PositionControl:
    """The force that each quadrotor shall exert, from where it is and shall be.

    Parameters
    ----------
    quadrotors : sequence of m Quadrotor
    guide : callable(Seen) -> Goal
    frequency : float [rad/s], omega_x
    damping : float, zeta
    feed_forward : bool, whether the measured pull of the cables is fed forward
    """

    def __init__(
        self, quadrotors: Sequence[Quadrotor], guide: Callable[[Seen], Goal], *, frequency: float = 2.0, damping: float = 0.9,
        feed_forward: bool = True,
    ) -> None:  # fmt: skip
        self.guide, self.feed_forward = guide, feed_forward
        self.frequency = check_number("frequency", frequency, "rad/s", "PositionControl", sign="positive")
        self.damping = check_number("damping", damping, "", "PositionControl", sign="positive")
        self._mass = [one.mass for one in quadrotors]

    def reset(self) -> None:
        """Begin anew."""
        if hasattr(self.guide, "reset"):
            self.guide.reset()

    def __call__(self, seen: Seen) -> np.ndarray:
        """(m, 3) force in the axes of the world [N]."""
        return self._law(None)(seen, np.concatenate(self.guide(seen)))

    def _law(self, guide: CompiledLaw | None) -> CompiledLaw:
        """The law of forces, to which a goal is given."""
        numbers = self.frequency, self.damping, float(self.feed_forward), *self._mass
        return CompiledLaw(exert, numbers, gives="force", guide=guide, quadrotors=len(self._mass), needs_given=True)

    @property
    def law(self) -> CompiledLaw | None:
        """The same compiled, if its guide is."""
        guide = law_of(self.guide)
        return None if guide is None else self._law(guide)


class AttitudeControl:
    """Thrust and torque that turn each quadrotor to where it exerts a force.

    Parameters
    ----------
    quadrotors : sequence of m Quadrotor
    frequency : float [rad/s], omega_R
    damping : float, zeta
    heading : float [rad], of the x axes about z
    feed_forward : bool, whether the measured moment of the cables is fed forward
    """

    def __init__(
        self, quadrotors: Sequence[Quadrotor], *, frequency: float = 15.0, damping: float = 0.8, heading: float = 0.0,
        feed_forward: bool = True,
    ) -> None:  # fmt: skip
        self.frequency = check_number("frequency", frequency, "rad/s", "AttitudeControl", sign="positive")
        self.damping = check_number("damping", damping, "", "AttitudeControl", sign="positive")
        self.heading = check_number("heading", heading, "rad", "AttitudeControl")
        self.feed_forward = feed_forward
        turn = self.frequency, self.damping, np.cos(self.heading), np.sin(self.heading), float(feed_forward)
        inertia = [one.inertia_tensor.ravel() for one in quadrotors]
        self._law = CompiledLaw(turn_to, np.concatenate([turn, *inertia]), quadrotors=len(inertia), needs_given=True)

    def __call__(self, seen: Seen, force: np.ndarray) -> Wrench:
        """The wrench for a force (m, 3) in the axes of the world [N]."""
        return self._law(seen, force)

    @property
    def law(self) -> CompiledLaw:
        """The same compiled."""
        return self._law


def attitudes(force: np.ndarray, heading: float = 0.0) -> np.ndarray:
    """(m, 3, 3) rotations whose z axes lie along forces (m, 3), and whose x axes lie in the plane of z and the heading [rad]."""
    found = np.empty((len(force), 3, 3))
    attitudes_along(np.ascontiguousarray(force, float), float(np.cos(heading)), float(np.sin(heading)), found)
    return found


class Cascade:
    """A controller of flights: attitudes follow forces, and forces follow a guide, each at a rate and with a delay of its own.

    Parameters
    ----------
    position : PositionControl, or any callable(Seen) -> (m, 3) force [N]
    attitude : AttitudeControl, or any callable(Seen, force) -> Wrench
    rates : (2,) float [1/s], of both
    delay : float [s], of both
    """

    def __init__(
        self, position: Callable[[Seen], np.ndarray], attitude: Callable[[Seen, np.ndarray], Wrench],
        rates: tuple[float, float] = (100.0, 500.0), delay: float = 0.0,
    ) -> None:  # fmt: skip
        self.position, self.attitude = Held(position, rates[0], delay), Held(attitude, rates[1], delay)

    def reset(self) -> None:
        """Begin anew."""
        self.position.reset()
        self.attitude.reset()

    def __call__(self, seen: Seen) -> Wrench:
        """What the quadrotors are told."""
        return self.attitude(seen, self.position(seen))


def geometric(
    quadrotors: Sequence[Quadrotor], guide: Callable[[Seen], Goal], *, feed_forward: bool = True,
    rates: tuple[float, float] = (100.0, 500.0), delay: float = 0.0,
) -> Cascade:  # fmt: skip
    """The geometric controller with gains for a quadrotor with a cable: `PositionControl` and `AttitudeControl` in a `Cascade`."""
    position = PositionControl(quadrotors, guide, feed_forward=feed_forward)
    return Cascade(position, AttitudeControl(quadrotors, feed_forward=feed_forward), rates, delay)
