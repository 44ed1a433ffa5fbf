"""Pulls of the cables on points and bodies, from the tensions of segments and the directions in which they pull."""

from typing import Any

import numpy as np
from numba import float64, int64, void

from anet_lumped.checks import InputError, quoted
from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.scene.scene import Scene

from .body_readings import BodyTable

_f1, _f2, _i1 = float64[::1], float64[:, ::1], int64[::1]


class CableEnds:
    """Segments that end at points, by the node, and those that end at bodies.

    Parameters
    ----------
    model : Model
    table : BodyTable of the bodies that move freely
    """

    def __init__(self, model: Any, table: BodyTable) -> None:
        self._ends, self._at = model.ends, dict[int, tuple[np.ndarray, np.ndarray]]()
        self._count = len(table.share)
        body_of, origin = np.full(model.n, -1), np.full(model.n, -1)
        for b in range(self._count):
            own = table.node[table.first[b] : table.first[b + 1]]
            body_of[own], origin[own] = b, own[0]
        ends = [(s, node, sign) for s, row in enumerate(model.ends.tolist()) for node, sign in zip(row, (1, -1), strict=True)]
        found = np.array([(s, node, sign) for s, node, sign in ends if body_of[node] >= 0], np.int64).reshape(-1, 3)
        self.pulling = tuple(np.ascontiguousarray(x) for x in (*found.T, body_of[found[:, 1]], origin[found[:, 1]]))
        bare = np.zeros(model.n)
        for point in model.scene.all_points:
            bare[model.node_of[point.name]] = getattr(point, "mass", 0.0)
        loaded = table.node[(model.mass - bare)[table.node] > 0.0]
        weight = np.outer(model.mass - bare, model.scene.gravity)[loaded]
        self.loaded = loaded, body_of[loaded], origin[loaded], weight

    def directions(self, q: np.ndarray) -> np.ndarray:
        """(n_segments, 3) directions from the first to the second end of each segment, at places (n, 3) [m]."""
        d = q[self._ends[:, 1]] - q[self._ends[:, 0]]
        return d / np.linalg.norm(d, axis=1)[:, None]

    def pull(self, node: int, directions: np.ndarray, tension: np.ndarray) -> np.ndarray:
        """(3,) force on a node [N] of segments with tensions (n_segments,) [N] along ``directions`` (n_segments, 3)."""
        if node not in self._at:
            own = np.flatnonzero((self._ends == node).any(axis=1))
            self._at[node] = own, np.where(self._ends[own, 0] == node, 1.0, -1.0)
        own, sign = self._at[node]
        return (sign * tension[own]) @ directions[own]


def check_tied_there(scene: Scene, point: str) -> None:
    """Refuse the name of a body whose cables all end at attachments: nothing pulls at its origin, and 0 N would look like no pull.

    Raises
    ------
    InputError
    """
    if point in {body.name for body in scene.bodies}:
        ends = {end for cable in scene.cables for end in (cable.start, cable.end)}
        tied = sorted(end for end in ends if end.rpartition(".")[0] == point)
        if point not in ends and tied:
            raise InputError(
                f"A pull is that of the cables at one point, but none ends at the origin of body {quoted(point)}; ask for "
                f"{quoted(tied[0])}, or for `pulls()`, the forces and moments on all bodies."
            )


@inlined
def _add(q, node, origin, x, y, z, force, moment):
    """Add a force at a node to the force and moment of a body."""
    a, b, c = q[node, 0] - q[origin, 0], q[node, 1] - q[origin, 1], q[node, 2] - q[origin, 2]
    force[0], force[1], force[2] = force[0] + x, force[1] + y, force[2] + z
    moment[0], moment[1], moment[2] = moment[0] + b * z - c * y, moment[1] + c * x - a * z, moment[2] + a * y - b * x


@kernel(void(_f2, _f2, int64, _f1, _i1, _i1, _i1, _i1, _i1, _i1, _i1, _i1, _f2, _f2, _f2))
def pull_bodies(
    q, rows, column, tension, segment, node, sign, body, origin, loaded, loaded_body, loaded_origin, weight, force, moment
):
    """Add the pulls of segments, and the weights of nodes, to the forces (m, 3) [N] and moments (m, 3) [N m] of bodies.

    With the weights of the half segments that end there, as a cable pulls whose mass is spread over its length. Directions are in
    three columns of ``rows`` (n_segments, columns) from ``column`` on; the others are in `CableEnds`.
    """
    for k in range(segment.shape[0]):
        row, T = rows[segment[k]], sign[k] * tension[segment[k]]
        x, y, z = T * row[column], T * row[column + 1], T * row[column + 2]
        _add(q, node[k], origin[k], x, y, z, force[body[k]], moment[body[k]])
    for k in range(loaded.shape[0]):
        w, b = weight[k], loaded_body[k]
        _add(q, loaded[k], loaded_origin[k], w[0], w[1], w[2], force[b], moment[b])
