"""A state with a body moved."""

from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, Vector, check_vector, quoted
from anet_lumped.model.body_rotation import points_of
from anet_lumped.prescribed.turning import matrix_of


def moved(
    state: Any, body: str, at: Vector | None = None, rotation: Vector | None = None, velocity: Vector | None = None,
    angular_velocity: Vector | None = None,
) -> Any:  # fmt: skip
    """A State with a body at another place, or in another motion; the nodes of cables stay, but for those at its attachments.

    Parameters
    ----------
    state : State
    body : name of a body whose motion is not prescribed
    at, velocity : (3,) array_like or None [m], [m/s], of its origin
    rotation : (3,) array_like or None [rad], rotation vector of its axes
    angular_velocity : (3,) array_like or None [rad/s], in the axes of the world

    Raises
    ------
    InputError : a body whose motion is prescribed
    """
    own = state.scene.body(body)
    if own.is_driven:
        raise InputError(f"A body to be moved must move freely, but the motion of {quoted(body)} is prescribed.")
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
    return replace(state, q=q, v=v, q_near=None)
