"""Rigid bodies as boxes: each with the inertia of its body, or around the points of a body whose motion is prescribed."""

from typing import Any, NamedTuple

import numpy as np

from anet_lumped.model.body_rotation import rotations
from anet_lumped.scene.body import Body

THINNEST = 0.1  # of the longest side, so that a flat body is seen


class Box(NamedTuple):
    """A box of a body: its sides (3,) [m], its middle (3,) and the directions of its sides (3, 3) in the axes of the body."""

    name: str
    sides: np.ndarray
    middle: np.ndarray
    axes: np.ndarray


def box_of(body: Body) -> Box:
    """`Box` of a body; a uniform box of sides l has the second moments m l^2/12 along them."""
    if body.is_driven:
        places = np.array([(0.0, 0.0, 0.0), *(place for _, place in body.places)])
        sides, middle, axes = np.ptp(places, axis=0), 0.5 * (places.max(axis=0) + places.min(axis=0)), np.eye(3)
    else:
        J = body.inertia_tensor
        second, axes = np.linalg.eigh(0.5 * np.trace(J) * np.eye(3) - J)
        axes[:, 0] *= np.sign(np.linalg.det(axes))
        sides, middle = np.sqrt(12.0 * np.maximum(second, 0.0) / body.mass), np.array(body.centre_of_mass, float)
    longest = float(sides.max()) or 1e-3
    return Box(body.name, np.maximum(sides, THINNEST * longest), middle, axes)


def poses(run: Any, t: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middles (k, bodies, 3) [m] and axes (k, bodies, 3, 3) of the boxes of a run, at times t (k,) and places q (k, n, 3)."""
    boxes = [box_of(body) for body in run.scene.bodies]
    turns = [rotations(run.model, box.name, t, q) for box in boxes]
    middles = [q[:, run.model.node_of[box.name]] + R @ box.middle for box, R in zip(boxes, turns, strict=True)]
    return np.stack(middles, axis=1), np.stack([R @ box.axes for box, R in zip(boxes, turns, strict=True)], axis=1)


def box_edges(run: Any, t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(k, 12 bodies, 2, 3) ends of the edges of all boxes [m]; arguments as of `poses`."""
    middles, axes = poses(run, t, q)
    signs = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1).T
    along = np.array([box_of(body).sides * signs for body in run.scene.bodies])
    at = middles[:, :, None] + np.einsum("kbxy,bcy->kbcx", axes, along)
    return at[:, :, EDGES].reshape(len(t), -1, 2, 3)


EDGES = np.array([(i, j) for i in range(8) for j in range(i + 1, 8) if bin(i ^ j).count("1") == 1])
"""(12, 2) pairs of the eight corners that an edge joins: their numbers differ by one binary digit, as their places by one side."""
