"""A state with a body moved."""

from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, Vector, check_vector, quoted
from anet_lumped.model.body_rotation import points_of
from anet_lumped.prescribed.turning import matrix_of
from anet_lumped.scene.joints import parents_first


def moved(
    state: Any, body: str, at: Vector | None = None, rotation: Vector | None = None, velocity: Vector | None = None,
    angular_velocity: Vector | None = None,
) -> Any:  # fmt: skip
    """A State with a body at another place, or in another motion; the nodes of cables stay, but for those at its attachments.

    Bodies that are pinned to it go along: they shift, and keep their rotations and angular velocities.

    Parameters
    ----------
    state : State
    body : name of a body whose motion is not prescribed
    at, velocity : (3,) array_like or None [m], [m/s], of its origin
    rotation : (3,) array_like or None [rad], rotation vector of its axes
    angular_velocity : (3,) array_like or None [rad/s], in the axes of the world

    Raises
    ------
    InputError : a point; a body whose motion is prescribed; a place or velocity of one that is pinned to a point, from which they
        follow
    """
    if body in {point.name for point in state.scene.points}:
        raise InputError(
            f"What is moved must be a body, but {quoted(body)} is a point; State.of(scene, shapes=..., points=...) takes the "
            "places of points and cables."
        )
    own = state.scene.body(body)
    if own.is_driven:
        raise InputError(f"A body to be moved must move freely, but the motion of {quoted(body)} is prescribed.")
    if own.is_jointed and not (at is None and velocity is None):
        raise InputError(
            f"A body that is pinned to a point has its place and its velocity from that, but {quoted(body)} is pinned to "
            f"{quoted(own.pinned_to)}; leave `at` and `velocity` out."
        )
    nodes, arms = points_of(state.model, body)
    R = state.rotation(body) if rotation is None else matrix_of(check_vector("rotation", rotation, "rad", f"body {quoted(body)}"))
    origin = state.q[nodes[0]] if at is None else np.array(check_vector("at", at, "m", f"body {quoted(body)}"))
    rate = state.v[nodes[0]] if velocity is None else np.array(check_vector("velocity", velocity, "m/s", f"body {quoted(body)}"))
    if angular_velocity is None:
        turn = state.angular_velocity(body)
    else:
        turn = np.array(check_vector("angular_velocity", angular_velocity, "rad/s", f"body {quoted(body)}"))
    q, v = state.q.copy(), state.v.copy()
    q[nodes] = origin + arms @ R.T
    v[nodes] = rate + np.cross(turn, q[nodes] - origin)
    for one in parents_first(state.scene.bodies):
        if one.is_jointed:
            _follow(state.model, one, q, v)
    return replace(state, q=q, v=v, q_near=None)


def _follow(model: Any, body: Any, q: np.ndarray, v: np.ndarray) -> None:
    """Shift the nodes of a body in q and v (n, 3) so that its point at the joint moves with that to which it is pinned."""
    nodes, _ = points_of(model, body.name)
    own, other = model.node_of[body.pivot], model.node_of[body.pinned_to]
    q[nodes] += q[other] - q[own]
    v[nodes] += v[other] - v[own]
