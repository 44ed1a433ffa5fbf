"""Rotors: commanded thrusts and torques to the forces and torques that act on quadrotors in a step."""

from collections.abc import Sequence

import numpy as np

from .laws import command_rotors, turn_rotors
from .quadrotor import Quadrotor


class Rotors:
    """The four rotors of each of m quadrotors.

    A commanded thrust and torque is shared among the rotors, each of which gives something between zero and its largest thrust.
    Torques come first: where a rotor would have to push down, all give more; where one would have to give too much, all give less.
    What cannot be given even so is cut off.

    The speed of a rotor follows the commanded one with its lag, exactly for a command that is held over the step,

        omega(t) = c + (omega_0 - c) exp(-t/lag) ,

    and its thrust is the mean of k omega^2 over the step, so that its impulse is exact.

    Parameters
    ----------
    quadrotors : sequence of m Quadrotor
    dt : float [s], step
    """

    def __init__(self, quadrotors: Sequence[Quadrotor], dt: float) -> None:
        self.quadrotors, self.dt = tuple(quadrotors), dt
        count = len(self.quadrotors)
        self.mixing = np.array([one.mixing for one in quadrotors]).reshape(-1, 4, 4)
        self.sharing = np.linalg.inv(self.mixing)
        self.limits = np.array([(one.largest_thrust, one.thrust_coefficient) for one in quadrotors]).reshape(-1, 2)
        self.drag = np.array([one.drag for one in quadrotors]).reshape(-1, 3)
        self.lags = np.array([_lag_means(one.lag, dt) for one in quadrotors]).reshape(-1, 3)
        self.speed, self.command, self.acting = np.zeros((count, 4)), np.zeros((count, 4)), np.zeros((count, 6))

    def settle(self, thrust: np.ndarray, torque: np.ndarray) -> None:
        """Let the rotors turn as commanded, without lag."""
        command_rotors(told(thrust, torque), self.sharing, self.limits, self.speed)

    def step(
        self, thrust: np.ndarray, torque: np.ndarray, rotation: np.ndarray, velocity: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Forces and torques that act in a step, in the axes of the bodies.

        Parameters
        ----------
        thrust, torque : (m,), (m, 3) float64 [N], [N m], commanded; torques in the axes of the bodies
        rotation : (m, 3, 3) float64, of the bodies
        velocity : (m, 3) float64 [m/s], of the bodies through the air, in the axes of the world

        Returns
        -------
        force, torque : (m, 3) float64 [N], [N m]
        """
        command_rotors(told(thrust, torque), self.sharing, self.limits, self.command)
        turn_rotors(self.command, self.speed, self.limits, self.mixing, self.lags, self.drag, rotation, velocity, self.acting)
        return self.acting[:, :3], self.acting[:, 3:]


def told(thrust: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """(m, 4) thrusts [N] and torques [N m], one row a quadrotor."""
    return np.column_stack([np.reshape(thrust, (-1, 1)), torque])


def _lag_means(lag: float, dt: float) -> tuple[float, float, float]:
    """exp(-dt/lag), and the means of exp(-t/lag) and of its square over a step of dt [s]."""
    if lag == 0.0:
        return 0.0, 0.0, 0.0
    left = float(np.exp(-dt / lag))
    return left, lag / dt * (1.0 - left), 0.5 * lag / dt * (1.0 - left * left)
