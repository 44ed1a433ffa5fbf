"""A Gymnasium environment over a session: an agent moves the points that are driven from outside.

It needs the package gymnasium, which ``pip install "anet-lumped[gym]"`` brings.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

try:
    import gymnasium
except ModuleNotFoundError as missing:
    raise ModuleNotFoundError(
        'anet_lumped.flight.environment needs the package gymnasium; pip install "anet-lumped[gym]" brings it.'
    ) from missing

from anet_lumped.checks import InputError, number, shown
from anet_lumped.motion.session import Session, SessionError
from anet_lumped.scene.scene import Driven, Free, Scene

FAR = 1e6  # bound of what is observed [m], [m/s], [N]


class NetEnv(gymnasium.Env):
    """Points driven from outside, whose velocities are the action.

    An action (m, 3) in [-1, 1], times ``speed`` [m/s], is the velocity of each of the m points whose path is `paths.external`. It
    is reached along a cubic within the first step of the session and held for the others. An observation is a vector of float64:
    positions and then velocities of these points and of the free points, (m + n, 3) each, then the largest tension of each cable.
    ``names`` and ``cables`` have their order.

    Parameters
    ----------
    scene : Scene
    reward : callable(session) -> float, of the state reached
    dt : float [s], step of the session
    substeps : int, steps that an action is held
    duration : float [s], after which an episode is cut off
    speed : float [m/s]
    ended : callable(session) -> bool or None, whether the state reached ends the episode
    session : keyword arguments of `Session`

    Raises
    ------
    InputError : no point is driven from outside, or a number out of its range
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  (as the base class has it)

    def __init__(
        self, scene: Scene, reward: Callable[[Session], float], *, dt: float = 0.004, substeps: int = 5, duration: float = 4.0,
        speed: float = 1.0, ended: Callable[[Session], bool] | None = None, **session: Any,
    ) -> None:  # fmt: skip
        for name, value in (("substeps", substeps), ("duration", duration), ("speed", speed)):
            if not 0 < number(value) < np.inf:
                raise InputError(f"Argument `{name}` must be positive and finite, but it is {shown(value)}.")
        self.reward, self.ended, self.substeps, self.duration, self.speed = reward, ended, int(substeps), duration, speed
        self.session = Session(scene, dt, **session)
        self.driven = [p.name for p in scene.points if isinstance(p, Driven) and p.path.kind == "external"]
        if not self.driven:
            raise InputError("An environment needs at least one point whose path is paths.external, but the scene has none.")
        self.names = [*self.driven, *(p.name for p in scene.points if isinstance(p, Free))]
        self.cables = [cable.name for cable in scene.cables]
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(self.driven), 3), np.float64)
        size = 6 * len(self.names) + len(self.cables)
        self.observation_space = gymnasium.spaces.Box(-FAR, FAR, (size,), np.float64)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """Go back to the start of the session; nothing of it is random."""
        super().reset(seed=seed)
        self.session.reset()
        return self._observed(), {"t": self.session.t}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Move the driven points for ``substeps`` steps.

        A step that fails ends the episode; its message is ``info["failed"]``.
        """
        velocity = self.speed * np.clip(np.asarray(action, float).reshape(len(self.driven), 3), -1.0, 1.0)
        session, info = self.session, dict[str, Any]()
        for k, name in enumerate(self.driven):
            mean = 0.5 * (session.velocity(name) + velocity[k])
            session.drive(name, session.position(name) + session.dt * mean, velocity[k])
        try:
            for _ in range(self.substeps):
                session.step()
        except SessionError as failure:
            info["failed"] = str(failure)
        over = "failed" in info or (self.ended is not None and bool(self.ended(session)))
        info |= {"t": session.t}
        return self._observed(), float(self.reward(session)), over, session.t >= self.duration * (1.0 - 1e-9), info

    def _observed(self) -> np.ndarray:
        session = self.session
        places = [session.position(name) for name in self.names]
        speeds = [session.velocity(name) for name in self.names]
        tensions = [session.tension(cable).max() for cable in self.cables]
        return np.clip(np.nan_to_num(np.concatenate([*places, *speeds, tensions])), -FAR, FAR)
