"""Rotation and angular velocity of bodies, from the places and velocities of their points."""

from typing import Any

import numpy as np

from anet_lumped.prescribed.turning import matrix_of, spin

from .model import Model


def points_of(model: Model, body: str) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of a body (k,), and their places in its own axes (k, 3) [m]."""
    points = model.scene.body(body).points
    return np.array([model.node_of[point.name] for point in points]), np.array([point.arm for point in points], float)


def rotations(model: Model, body: str, t: Any, q: np.ndarray) -> np.ndarray:
    """Rotation matrices (..., 3, 3) of a body, whose columns are its axes, at times t (...) and places q (..., n, 3) [m].

    Of a body that moves freely the nearest rotation to the places of its points (Kabsch), which is theirs to rounding.
    """
    own = model.scene.body(body)
    if own.is_driven:
        first, (_, turning) = matrix_of(own.rotation), own.motion
        if turning is not None and turning.kind == "external":
            rows = [matrix_of(turn_of_points(model, body, places, places)[0]) for places in q.reshape(-1, *q.shape[-2:])]
            return (np.array(rows) @ first).reshape((*np.shape(t), 3, 3))
        turned = [np.eye(3) if turning is None else matrix_of(turning.at(float(time))[0]) for time in np.ravel(t)]
        return (np.array(turned).reshape(-1, 3, 3) @ first).reshape((*np.shape(t), 3, 3))
    nodes, arms = points_of(model, body)
    arms = arms - arms.mean(axis=0)
    places = q[..., nodes, :] - q[..., nodes, :].mean(axis=-2, keepdims=True)
    U, _, Vt = np.linalg.svd(np.swapaxes(places, -1, -2) @ arms)
    U[..., :, 2] *= np.linalg.det(U @ Vt)[..., None]
    return U @ Vt


def angular_velocities(model: Model, body: str, t: Any, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Angular velocities (..., 3) of a body [rad/s], in the axes of the world, at places and velocities (..., n, 3)."""
    own = model.scene.body(body)
    if own.is_driven:
        _, turning = own.motion
        if turning is not None and turning.kind == "external":
            rows = zip(q.reshape(-1, *q.shape[-2:]), v.reshape(-1, *v.shape[-2:]), strict=True)
            return np.array([turn_of_points(model, body, *row)[1] for row in rows]).reshape((*np.shape(t), 3))
        found = [np.zeros(3) if turning is None else spin(*(tuple(x) for x in turning.at(float(time))))[0] for time in np.ravel(t)]
        return np.array(found).reshape((*np.shape(t), 3))
    nodes, _ = points_of(model, body)
    arms = q[..., nodes, :] - q[..., nodes, :].mean(axis=-2, keepdims=True)
    rates = v[..., nodes, :] - v[..., nodes, :].mean(axis=-2, keepdims=True)
    inertia = (arms**2).sum(axis=(-2, -1))[..., None, None] * np.eye(3) - np.swapaxes(arms, -1, -2) @ arms
    return np.linalg.solve(inertia, np.cross(arms, rates).sum(axis=-2)[..., None])[..., 0]


def turn_of_points(model: Model, body: str, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation vector (3,) [rad] of a driven body since its start, and angular velocity (3,) [rad/s], by its attachments.

    About a line through all of them nothing tells a rotation, nor what turns a body without attachments; there both are zero.

    Parameters
    ----------
    model : Model
    body : name of a body whose motion is prescribed
    q, v : (n, 3) float64 [m], [m/s]
    """
    from scipy.spatial.transform import Rotation

    own = model.scene.body(body)
    nodes, arms = points_of(model, body)
    arms = arms @ matrix_of(own.rotation).T
    places, rates = q[nodes] - q[nodes[0]], v[nodes] - v[nodes[0]]
    size = float(np.linalg.norm(arms))
    if np.linalg.norm(places - arms) <= 1e-12 * size:
        phi = np.zeros(3)
    else:
        U, _, Vt = np.linalg.svd(places.T @ arms)
        phi = Rotation.from_matrix((U * (1.0, 1.0, np.linalg.det(U @ Vt))) @ Vt).as_rotvec()
    rows = [[[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]] for x, y, z in places]
    spin = np.linalg.lstsq(np.array(rows).reshape(-1, 3), rates.ravel(), rcond=1e-9)[0]
    return phi, spin


def quaternions(matrices: np.ndarray) -> np.ndarray:
    """Unit quaternions (..., 4) as (w, x, y, z) of rotation matrices (..., 3, 3), with w >= 0."""
    from scipy.spatial.transform import Rotation

    flat = Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat(canonical=True)
    return np.roll(flat, 1, axis=-1).reshape((*matrices.shape[:-2], 4))
