"""The motion of a point that a body carries along, whose own motion is prescribed."""

from dataclasses import dataclass, field

import numpy as np

from anet_lumped.checks import Vector

from .paths import Path
from .turning import matrix_of, spin


@dataclass(frozen=True, repr=False)
class TurningPath(Path):
    """The path r + R R_0 arm of a point of a body, whose origin moves by r and which turns by R.

    Parameters
    ----------
    origin : Path of the origin [m]
    turning : Path of the rotation vector of R [rad], or None for a body that does not turn
    rotation, arm : (3,) [rad], [m], rotation vector of R_0 and place of the point in the body's axes
    """

    origin: Path = field(kw_only=True)
    turning: Path | None = field(kw_only=True)
    rotation: Vector = field(kw_only=True)
    arm: Vector = field(kw_only=True)

    @classmethod
    def of(cls, origin: Path, turning: Path | None, rotation: Vector, arm: Vector) -> "TurningPath":
        """The path of a point."""
        own = (("origin", origin), ("turning", turning), ("rotation", rotation), ("arm", arm))
        corners = np.unique(np.concatenate([path.corners for path in (origin, turning) if path is not None]))
        still = np.zeros((1, *origin.coefficients.shape[1:]))
        return cls("turning", own, np.zeros(1), still, corners, origin=origin, turning=turning, rotation=rotation, arm=arm)

    def at(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position [m], velocity [m/s] and acceleration [m/s²] at time `t` [s], each (3,)."""
        q, v, a = self.origin.at(t)
        arm = matrix_of(self.rotation) @ self.arm
        if self.turning is None:
            return q + arm, v, a
        phi, rate, second = (tuple(row.tolist()) for row in self.turning.at(t))
        omega, alpha = (np.array(vector) for vector in spin(phi, rate, second))
        arm = matrix_of(phi) @ arm
        across = np.cross(omega, arm)
        return q + arm, v + across, a + np.cross(alpha, arm) + np.cross(omega, across)
