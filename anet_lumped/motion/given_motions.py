"""Motions that a session is given step by step: of driven points and bodies whose paths are `paths.external`."""

import math
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import InputError, quoted, shown
from anet_lumped.model.body_rotation import turn_of_points
from anet_lumped.model.meeting import too_far_to_meet
from anet_lumped.model.reach import shortfall
from anet_lumped.prescribed.path_kernel import lead
from anet_lumped.prescribed.turning import coefficients
from anet_lumped.scene.scene import Driven, Scene

from .given_forces import vector

PLACE, TURN = "place", "turn"
WHOLE_TURN = 2.0 * math.pi * (1.0 - 1e-6)  # [rad]: there a rotation vector has no rate for most angular velocities


class Track(NamedTuple):
    """What is driven from outside: the place of a point or of a body's origin, or the rotation vector of a body."""

    name: str
    kind: str


def tracks_of(scene: Scene) -> list[Track]:
    """All that is driven from outside in a scene."""
    found = [Track(p.name, PLACE) for p in scene.points if isinstance(p, Driven) and p.path.kind == "external"]
    for body in scene.bodies:
        for kind, path in ((PLACE, body.path), (TURN, body.turning)):
            if path is not None and path.kind == "external":
                found.append(Track(body.name, kind))
    return found


class GivenMotions:
    """Positions and rotation vectors, with their rates, at the start and at the end of the next step.

    Parameters
    ----------
    scene : Scene
    begin : State that the session starts from
    origin : (3,) float64 [m], of the coordinates that the session computes in
    dt : float [s]
    """

    def __init__(self, scene: Scene, begin: Any, origin: np.ndarray, dt: float) -> None:
        self.scene, self.dt, self.origin = scene, dt, origin
        self.tracks = tracks_of(scene)
        self.given = np.zeros((2, len(self.tracks), 2, 3))
        for k, track in enumerate(self.tracks):
            self.given[0, k] = _start(scene, begin, track)
        self.given[1] = self.given[0]
        self.given[1, :, 0] += dt * self.given[0, :, 1]

    def attach(self, scene: Scene, paths: Any) -> None:
        """Write to the paths of a net from now on."""
        driven = [point.name for point in scene.points if isinstance(point, Driven)]
        bodies = [body.name for body in scene.bodies if body.is_driven]
        numbers = []
        for track in self.tracks:
            of_body = track.name in bodies
            number = len(driven) + 2 * bodies.index(track.name) if of_body else driven.index(track.name)
            numbers.append(number + (track.kind == TURN))
        self._pieces, self._paths = np.array([paths.first[k] for k in numbers], np.int64), paths

    def lead(self, t: float, goal: float) -> None:
        """Write the paths through the next step."""
        lead(self._pieces, self._paths.breaks, self._paths.coefficients, self.given[0], self.given[1], t, goal)

    def go_on(self) -> None:
        """After a step: what is not given anew goes on with the rates that were given last."""
        self.given[0] = self.given[1]
        self.given[1, :, 0] += self.dt * self.given[1, :, 1]

    def drive(self, name: Any, position: Any, velocity: Any, rotation: Any, angular_velocity: Any) -> None:
        """Keep what `Session.drive` is given."""
        place, turn = self._track(name, PLACE), self._track(name, TURN)
        if place is None and turn is None:
            self.scene.point(name)
            known = ", ".join(map(quoted, dict.fromkeys(track.name for track in self.tracks)))
            raise InputError(
                f"A point is driven from outside if its path is paths.external, but {quoted(name)} is not; "
                f"{known or 'no point'} is."
            )
        if turn is None and not (rotation is None and angular_velocity is None):
            raise InputError(
                f"A body is turned from outside if its `turning` is paths.external, but that of {quoted(name)} is not; leave "
                "`rotation` and `angular_velocity` out."
            )
        if place is None and position is not None:
            raise InputError(f"Only the rotation of {quoted(name)} is driven from outside; leave `position` out.")
        if place is not None and position is not None:
            self.given[1, place, 0] = vector("position", position, "m", "drive") - self.origin
            self.given[1, place, 1] = vector("velocity", velocity, "m/s", "drive")
        if turn is not None and not (rotation is None and angular_velocity is None):
            phi = self.given[1, turn, 0].copy() if rotation is None else vector("rotation", rotation, "rad", "drive")
            spin = (0.0, 0.0, 0.0) if angular_velocity is None else angular_velocity
            if not float(np.linalg.norm(phi)) < WHOLE_TURN:
                raise InputError(f"Argument `rotation` of drive must be less than a whole turn [rad], but it is {shown(rotation)}.")
            self.given[1, turn, 0] = phi
            self.given[1, turn, 1] = rate_of(phi, vector("angular_velocity", spin, "rad/s", "drive"))

    def too_far(self, t: float) -> str:
        """Words for cables that do not stretch and do not reach where points are to be at the end of a step, else nothing.

        Of bodies that are driven from outside nothing is said.
        """
        points = {point.name for point in self.scene.points}
        if not all(track.name in points for track in self.tracks):
            return ""
        driven = {track.name: self.given[1, k, 0] + self.origin for k, track in enumerate(self.tracks)}
        short = shortfall(self.scene, t, driven=driven)
        words = too_far_to_meet(self.scene, t, driven) if short is None else short.words
        return "" if words is None else f" {words}"

    def _track(self, name: Any, kind: str) -> int | None:
        """Number of a track, or None."""
        return next((k for k, track in enumerate(self.tracks) if track == (name, kind)), None)


def _start(scene: Scene, begin: Any, track: Track) -> np.ndarray:
    """Place [m] or rotation vector [rad] of a track, and its rate, (2, 3)."""
    if track.kind == PLACE:
        node = begin.model.node_of[track.name]
        return np.array([begin.q[node], begin.v[node]])
    phi, spin = turn_of_points(begin.model, track.name, begin.q, begin.v)
    return np.array([phi, rate_of(phi, spin)])


def rate_of(phi: np.ndarray, spin: np.ndarray) -> np.ndarray:
    """Rate (3,) of a rotation vector phi (3,) [rad] of what turns with an angular velocity (3,) [rad/s], see `turning.spin`."""
    A, B, C, *_ = coefficients(float(phi @ phi))
    x, y, z = phi
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.linalg.solve(A * np.eye(3) + B * across + C * np.outer(phi, phi), spin)
