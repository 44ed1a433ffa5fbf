"""Admittance: quadrotors that give way to the pull of their cables, as masses on springs and dampers do.

    M x'' + D x' + K x = P - P_0

with the measured pull P and the one expected, P_0. Where the quadrotor shall be is shifted by x. A pull that is held from one call
to the next moves x exactly.
Source: Hogan, J. Dyn. Syst. Meas. Control 107 (1985) 1.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.linalg import expm

from anet_lumped.checks import check_number

from .geometric import Goal
from .seen import Seen


class Admittance:
    """A guide whose goals give way to the pull of cables.

    Parameters
    ----------
    guide : callable(Seen) -> Goal
    pull : (m, 3) array_like [N], the one expected
    mass, damping, stiffness : float [kg], [N s/m], [N/m]
    """

    def __init__(
        self, guide: Callable[[Seen], Goal], pull: Any, *, mass: float = 1.0, damping: float = 6.0, stiffness: float = 9.0
    ) -> None:
        self.guide, self.pull = guide, np.array(pull, float)
        self.mass = check_number("mass", mass, "kg", "Admittance", sign="positive")
        self.damping = check_number("damping", damping, "N s/m", "Admittance", sign="non-negative")
        self.stiffness = check_number("stiffness", stiffness, "N/m", "Admittance", sign="positive")
        self.reset()

    def reset(self) -> None:
        """Go back to no shift."""
        self._t, self._moved, self._force = math.nan, np.zeros((2, *self.pull.shape)), np.zeros(self.pull.shape)
        self._steps: dict[float, tuple[np.ndarray, np.ndarray]] = {}
        if hasattr(self.guide, "reset"):
            self.guide.reset()

    def _step(self, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Matrix (2, 2) by which x and x' go on in a time dt [s], and vector (2,) of what a force held adds."""
        if dt not in self._steps:
            A = np.zeros((3, 3))
            A[0, 1], A[1] = 1.0, (-self.stiffness / self.mass, -self.damping / self.mass, 1.0 / self.mass)
            whole = expm(A * dt)
            self._steps[dt] = whole[:2, :2], whole[:2, 2]
        return self._steps[dt]

    def __call__(self, seen: Seen) -> Goal:
        """Where the quadrotors shall be."""
        goal, force = self.guide(seen), seen.pull - self.pull
        if not math.isnan(self._t):
            by_state, by_force = self._step(round(seen.t - self._t, 9))
            self._moved = np.tensordot(by_state, self._moved, 1) + by_force[:, None, None] * self._force
        self._t, self._force = seen.t, force
        x, v = self._moved
        a = (force - self.damping * v - self.stiffness * x) / self.mass
        return Goal(goal.position + x, goal.velocity + v, goal.acceleration + a)
