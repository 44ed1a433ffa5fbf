"""Motions of rigid bodies, read from the places and velocities of their nodes in one compiled call."""

from typing import Any, NamedTuple

import numpy as np
from numba import float64, int64, void

from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.effects.laws.couple import along, cross_product, direction_weights

_f1, _f2, _f3, _i1 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1]


class BodyTable(NamedTuple):
    """Nodes of bodies, body by body, with the weights that give the directions of each, see `effects.laws.couple`.

    Parameters
    ----------
    first : (bodies + 1,) int64, where the nodes of each body begin; the first node is its origin
    node : (nodes,) int64
    weights : (3, nodes) float64 [1/m]
    directions : (bodies, 3, 3) float64, by rows u_1, u_2 and u_3 in the axes of the body
    share : (bodies,) float64
    """

    first: np.ndarray
    node: np.ndarray
    weights: np.ndarray
    directions: np.ndarray
    share: np.ndarray


class Motions(NamedTuple):
    """Where bodies are and how they move; all arrays are those of the reader, written anew by each reading.

    Parameters
    ----------
    position, velocity : (bodies, 3) float64 [m], [m/s], of the origins
    rotation : (bodies, 3, 3) float64, whose columns are the axes of a body
    angular_velocity : (bodies, 3) float64 [rad/s], in the axes of the world
    """

    position: np.ndarray
    velocity: np.ndarray
    rotation: np.ndarray
    angular_velocity: np.ndarray


def body_table(model: Any, bodies: Any) -> BodyTable:
    """`BodyTable` of bodies that move freely."""
    found = [direction_weights([point.arm for point in body.points]) for body in bodies]
    return BodyTable(
        first=np.cumsum([0, *(len(body.points) for body in bodies)]).astype(np.int64),
        node=np.array([model.node_of[point.name] for body in bodies for point in body.points], np.int64),
        weights=np.ascontiguousarray(np.concatenate([np.zeros((3, 0)), *(weights for weights, _, _ in found)], axis=1)),
        directions=np.array([directions for _, directions, _ in found]).reshape(-1, 3, 3),
        share=np.array([share for _, _, share in found]),
    )


@inlined
def axes_and_rates(q, v, first, last, node, weights):
    """Directions e_1 and e_2 of a body, of the nodes from ``first`` to ``last``, and their rates: e_a = sum c^a_k q_k."""
    e1, e2, d1, d2 = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(first, last):
        i, c1, c2 = node[k], weights[0, k], weights[1, k]
        e1 = e1[0] + c1 * q[i, 0], e1[1] + c1 * q[i, 1], e1[2] + c1 * q[i, 2]
        e2 = e2[0] + c2 * q[i, 0], e2[1] + c2 * q[i, 1], e2[2] + c2 * q[i, 2]
        d1 = d1[0] + c1 * v[i, 0], d1[1] + c1 * v[i, 1], d1[2] + c1 * v[i, 2]
        d2 = d2[0] + c2 * v[i, 0], d2[1] + c2 * v[i, 1], d2[2] + c2 * v[i, 2]
    return e1, e2, d1, d2


@kernel(void(_f2, _f2, _i1, _i1, _f2, _f3, _f2, _f2, _f3, _f2))
def read(q, v, first, node, weights, directions, position, velocity, rotation, angular_velocity):
    """Write the motions of bodies.

    With e_a = sum c^a_k q_k and its rate, R = sum e_a u_a^T and omega = (e_2'.e_3) e_1 - (e_1'.e_3) e_2 + (e_1'.e_2) e_3.
    """
    for b in range(directions.shape[0]):
        e1, e2, d1, d2 = axes_and_rates(q, v, first[b], first[b + 1], node, weights)
        e3 = cross_product(e1, e2)
        x, y, z = along(d2, e3), -along(d1, e3), along(d1, e2)
        origin, u = node[first[b]], directions[b]
        for i in range(3):
            position[b, i], velocity[b, i] = q[origin, i], v[origin, i]
            angular_velocity[b, i] = x * e1[i] + y * e2[i] + z * e3[i]
            for j in range(3):
                rotation[b, i, j] = e1[i] * u[0, j] + e2[i] * u[1, j] + e3[i] * u[2, j]
