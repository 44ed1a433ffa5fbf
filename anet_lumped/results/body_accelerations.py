"""Accelerations of rigid bodies, and the forces of joints between them, from the forces on their nodes.

Node k, at the arm d_k from the origin of its body, has the acceleration a + w' x d_k + w x (w x d_k), and resists it with its mass
and added mass B_k. With J_k = (I, -[d_k]) the virtual work of all nodes of a body gives

    sum J_k^T B_k J_k (a, w') = sum J_k^T (f_k - B_k w x (w x d_k)) + J_p^T F ,

with the force F at the point p where it is pinned. That point has no acceleration, or that of the point to which it is pinned; if
this is on another body, that body has the force -F there.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.model.body_rotation import angular_velocities
from anet_lumped.model.model import Model
from anet_lumped.scene.joints import joined_to


class Joined(NamedTuple):
    """Bodies that are joined to one another.

    Parameters
    ----------
    point : dict of point name to (3,) [m/s2], accelerations
    joint : dict of body name to (3,) [N], force at the point where a body is pinned, on it
    """

    point: dict[str, np.ndarray]
    joint: dict[str, np.ndarray]


def of_joined(model: Model, name: str, motion: tuple, force: np.ndarray, resisting: tuple, driven: Mapping[str, Any]) -> Joined:
    """`Joined` of a body that moves freely or is pinned, and of those that joints tie to it.

    Parameters
    ----------
    model : Model
    name : name of the body
    motion : q, v (n, 3) float64 [m], [m/s]
    force : (n, 3) float64 [N], of cables and effects on each node
    resisting : masses (n,) and added masses (n_free, 3, 3) of the nodes [kg]
    driven : dict of name to (3,) float64 [m/s2], accelerations of points that are no body's, or of a driven one, and pinned to
    """
    (q, v), (mass, added) = motion, resisting
    bodies: list[Any] = joined_to(model.scene.bodies, name)
    rows = {point.name: 6 * b for b, body in enumerate(bodies) for point in body.points}
    pins = [body for body in bodies if body.pinned is not None]
    size = 6 * len(bodies)
    M, right = np.zeros((size + 3 * len(pins),) * 2), np.zeros(size + 3 * len(pins))
    turns = {body.name: angular_velocities(model, body.name, 0.0, q, v) for body in bodies}

    def arm(point: str) -> np.ndarray:
        return q[model.node_of[point]] - q[model.node_of[bodies[rows[point] // 6].name]]

    def inward(point: str) -> np.ndarray:
        turn = turns[bodies[rows[point] // 6].name]
        return np.cross(turn, np.cross(turn, arm(point)))

    for body in bodies:
        own = slice(rows[body.name], rows[body.name] + 6)
        for point in body.points:
            k = model.node_of[point.name]
            J, B = np.hstack([np.eye(3), -_cross(arm(point.name))]), mass[k] * np.eye(3) + added[k]
            M[own, own] += J.T @ B @ J
            right[own] += J.T @ (force[k] - B @ inward(point.name))
    for p, body in enumerate(pins):
        unknown = slice(size + 3 * p, size + 3 * p + 3)
        for point, sign in ((body.pivot, 1.0), (body.pinned_to, -1.0)):
            if point in rows:
                of = slice(rows[point], rows[point] + 6)
                J = sign * np.hstack([np.eye(3), -_cross(arm(point))])
                M[unknown, of] += J
                M[of, unknown] -= J.T
                right[unknown] -= sign * inward(point)
            elif point is not None:
                right[unknown] += driven[point]
    scale = np.sqrt(np.abs(np.diag(M)))  # so that lengths do not count
    scale[size:] = 1.0
    scale[scale == 0.0] = 1.0
    found = np.linalg.solve(M / np.outer(scale, scale), right / scale) / scale
    points = {}
    for point, at in rows.items():
        points[point] = found[at : at + 3] + np.cross(found[at + 3 : at + 6], arm(point)) + inward(point)
    return Joined(points, {body.name: found[size + 3 * p : size + 3 * p + 3] for p, body in enumerate(pins)})


def _cross(d: np.ndarray) -> np.ndarray:
    """Matrix of the cross product with a vector."""
    x, y, z = d
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
