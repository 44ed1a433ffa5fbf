"""Accelerations of rigid bodies from the forces on their nodes.

Node k, at the arm d_k from the origin of the body, has the acceleration a + w' x d_k + w x (w x d_k), and resists it with its mass
and added mass B_k. With J_k = (I, -[d_k]) the virtual work of all nodes gives

    sum J_k^T B_k J_k (a, w') = sum J_k^T (f_k - B_k w x (w x d_k)) .

A body that is pinned turns about its pivot, which has no acceleration.
"""

from typing import Any

import numpy as np

from anet_lumped.model.body_rotation import angular_velocities
from anet_lumped.model.model import Model


def of_body_point(model: Model, name: str, motion: tuple, force: np.ndarray, resisting: tuple) -> np.ndarray:
    """Acceleration of a point of a body that moves freely or is pinned, (3,) [m/s2].

    Parameters
    ----------
    model : Model
    name : name of the point
    motion : q, v (n, 3) float64 [m], [m/s]
    force : (n, 3) float64 [N], of cables and effects on each node
    resisting : masses (n,) and added masses (n_free, 3, 3) of the nodes [kg]
    """
    (q, v), (mass, added) = motion, resisting
    point: Any = model.scene.point(name)
    body: Any = model.scene.body(point.body)
    nodes = np.array([model.node_of[one.name] for one in body.points])
    pivot = nodes[0] if not body.pinned else model.node_of[f"{body.name}.{body.pinned}"]
    turn = angular_velocities(model, body.name, 0.0, q, v)
    M, right = np.zeros((6, 6)), np.zeros(6)
    for k in nodes:
        d = q[k] - q[pivot]
        J = np.hstack([np.eye(3), -_cross(d)])
        B = mass[k] * np.eye(3) + added[k]
        M += J.T @ B @ J
        right += J.T @ (force[k] - B @ np.cross(turn, np.cross(turn, d)))
    found: np.ndarray = np.zeros(6)
    if body.pinned is None:
        found = np.linalg.solve(M, right)
    else:
        found[3:] = np.linalg.solve(M[3:, 3:], right[3:])
    d = q[model.node_of[name]] - q[pivot]
    return found[:3] + np.cross(found[3:], d) + np.cross(turn, np.cross(turn, d))


def _cross(d: np.ndarray) -> np.ndarray:
    """Matrix of the cross product with a vector."""
    x, y, z = d
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
