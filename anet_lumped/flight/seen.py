"""What a controller sees of a flight: the state of a session, exact or with noise and delay."""

from collections import deque
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import check_number
from anet_lumped.motion.session import Session


class Seen(NamedTuple):
    """The state of a flight with m quadrotors and k free points, in the orders of the scene.

    Parameters
    ----------
    t : float [s]
    position, velocity : (m, 3) float64 [m], [m/s], of the centres of the quadrotors
    rotation : (m, 3, 3) float64, whose columns are their axes
    angular_velocity : (m, 3) float64 [rad/s], in the axes of the world
    pull, moment : (m, 3) float64 [N], [N m], of the cables on each quadrotor in the last step, about its centre
    point, point_velocity : (k, 3) float64 [m], [m/s], of the free points
    """

    t: float
    position: np.ndarray
    velocity: np.ndarray
    rotation: np.ndarray
    angular_velocity: np.ndarray
    pull: np.ndarray
    moment: np.ndarray
    point: np.ndarray
    point_velocity: np.ndarray


def look(session: Session) -> Seen:
    """The state of a session, exact."""
    return Seen(session.t, *session.look())


class Sensors:
    """Noise and delay of what a controller sees. The noise is normal, and the same for the same seed.

    Parameters
    ----------
    delay : float [s]; what is seen is the last state that is at least so old
    position, velocity, rotation, angular_velocity, pull : float [m], [m/s], [rad], [rad/s], [N]
        Standard deviations of each coordinate. Those of free points are those of quadrotors.
    seed : int
    """

    def __init__(
        self, *, delay: float = 0.0, position: float = 0.0, velocity: float = 0.0, rotation: float = 0.0,
        angular_velocity: float = 0.0, pull: float = 0.0, seed: int = 0,
    ) -> None:  # fmt: skip
        given = {"delay": (delay, "s"), "position": (position, "m"), "velocity": (velocity, "m/s"), "rotation": (rotation, "rad")}
        given |= {"angular_velocity": (angular_velocity, "rad/s"), "pull": (pull, "N")}
        sizes = {key: check_number(key, value, unit, "Sensors", sign="non-negative") for key, (value, unit) in given.items()}
        self.delay, self.seed = sizes.pop("delay"), seed
        self._noise = {key: size for key, size in sizes.items() if size > 0.0}
        self.reset()

    def reset(self) -> None:
        """Forget what was seen, and draw the same noise again."""
        self._random, self._past = np.random.default_rng(self.seed), deque[Seen]()

    def __call__(self, seen: Seen) -> Seen:
        """What is seen at the time of a state, which has to come in the order of times."""
        if self._noise:
            seen = self._noisy(seen)
        if self.delay == 0.0:
            return seen
        self._past.append(seen)
        while len(self._past) > 1 and self._past[1].t <= seen.t - self.delay * (1.0 - 1e-9):
            self._past.popleft()
        return self._past[0]

    def _noisy(self, seen: Seen) -> Seen:
        """A state with noise."""
        changed: dict[str, Any] = {}
        for key, size in self._noise.items():
            if key == "rotation":
                from scipy.spatial.transform import Rotation

                turns = Rotation.from_rotvec(self._random.normal(0.0, size, seen.position.shape)).as_matrix()
                changed[key] = turns @ seen.rotation
                continue
            for name in {"position": ("position", "point"), "velocity": ("velocity", "point_velocity")}.get(key, (key,)):
                exact = getattr(seen, name)
                changed[name] = exact + self._random.normal(0.0, size, exact.shape)
        return seen._replace(**changed)
