"""Forces and torques that a session is given, as forces on nodes that are held over a step."""

from typing import Any

import numpy as np
from numba import float64, int64, void

from anet_lumped.checks import InputError, check_vector, quoted, shown
from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.effects.laws.couple import along, combined, couple, cross_product
from anet_lumped.effects.push import pushed_points
from anet_lumped.prescribed.turning_kernel import turned

from .body_readings import axes_and_rates, body_table

_f1, _f2, _f3, _i1, _i2 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1], int64[:, ::1]
WORLD, BODY = 0, 1
AXES = {"world": WORLD, "body": BODY}


class GivenForces:
    """Forces on free points and bodies, and torques on bodies.

    What is given in the axes of a body, and any torque, is taken with the axes that the body will have in the middle of the step by
    its angular velocity now. So the forces on nodes do not change within the step, and what they leave out is of second order.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene: Any) -> None:
        self.scene = scene
        self.bodies = [body for body in scene.bodies if not body.is_driven]
        self.holders = {event.point: event.holder for event in scene.releases}
        self.names = [name for name in pushed_points(scene) if name not in self.holders]
        self.row = {name: k for k, name in enumerate(self.names)}
        self.body = {body.name: b for b, body in enumerate(self.bodies)}
        self.of_body = np.full(len(self.names), -1)
        for b, body in enumerate(self.bodies):
            self.of_body[[self.row[point.name] for point in body.points]] = b
        self.force = np.zeros((len(self.names), 3))
        self.torque = np.zeros((len(self.bodies), 3))
        self._origins = np.array([self.row[body.name] for body in self.bodies], np.int64)
        self.axes = np.zeros((2, len(self.names)), np.int64)  # of forces, and of torques by body
        self.acts = self.turns = False
        self.changed = True

    def attach(self, model: Any, params: np.ndarray, begin: int) -> None:
        """Write to the table of `Push` of a model from now on, which begins at ``params[begin]``."""
        slots = {name: begin + 3 * k for k, name in enumerate(pushed_points(model.scene))}
        self._node = np.array([model.node_of[name] for name in self.names], np.int64)
        free = (point.name for point in self.scene.free_points)
        free = [name if name in model.node_of else self.holders[name] for name in free]
        self.free_nodes = np.array([model.node_of[name] for name in free], np.int64)
        self._slot = np.array([slots[name] for name in self.names], np.int64)
        self._params, self._table = params, body_table(model, self.bodies)
        self._rows = np.array([self.row[point.name] for body in self.bodies for point in body.points], np.int64)
        self.changed = True

    def push(self, name: Any, force: Any, torque: Any, axes: Any) -> None:
        """Keep what `Session.push` is given."""
        if name not in self.row:
            self.scene.point(name)
            is_not = "is held by another one at first" if name in self.holders else "is not free"
            raise InputError(f"A force is given to a free point or to a body that moves freely, but {quoted(name)} {is_not}.")
        if axes not in AXES:
            raise InputError(f'Argument `axes` of push must be "world" or "body", but it is {shown(axes)}.')
        k = self.row[name]
        if torque is not None and name not in self.body:
            known = ", ".join(map(quoted, self.body)) or "no body"
            raise InputError(f"A torque is given to a body that moves freely, but {quoted(name)} is none; {known} is.")
        if axes == "body" and self.of_body[k] < 0:
            raise InputError(f'A force with axes="body" is given to a body or an attachment, but {quoted(name)} is a free point.')
        self.force[k] = vector("force", force, "N", "push")
        self.axes[0, k] = AXES[axes]
        if name in self.body:
            b = self.body[name]
            self.torque[b] = 0.0 if torque is None else vector("torque", torque, "N m", "push")
            self.axes[1, b] = AXES[axes]
        self._look()

    def push_bodies(self, force: np.ndarray, torque: np.ndarray, axes: str) -> None:
        """Keep what `Session.push_bodies` is given."""
        count = len(self.bodies)
        for name, value in (("force", force), ("torque", torque)):
            if np.shape(value) != (count, 3) or not np.isfinite(value).all():
                raise InputError(f"Argument `{name}` of push_bodies must be finite numbers ({count}, 3), but it is {shown(value)}.")
        if axes not in AXES:
            raise InputError(f'Argument `axes` of push_bodies must be "world" or "body", but it is {shown(axes)}.')
        self.force[self._origins], self.torque[:] = force, torque
        self.axes[0, self._origins] = self.axes[1, :count] = AXES[axes]
        self.acts = self.turns = self.changed = True

    def _look(self) -> None:
        """See whether anything acts, and whether anything of it turns."""
        self.turns = bool(self.torque.any() or self.axes[0].any())
        self.acts = self.turns or bool(self.force.any())
        self.changed = True

    def write(self, q: np.ndarray, v: np.ndarray, dt: float) -> bool:
        """Write the forces of the next step, from the places and velocities at its start; returns whether they are others."""
        changed = self.changed or self.turns
        if changed:
            given = self.force, self.torque, self.axes, self.of_body, self._slot
            spread(0.5 * dt, q, v, *given, *self._table, self._rows, self._params)
        self.changed = False
        return changed

    def places(self, q: np.ndarray) -> np.ndarray:
        """Places of all points that may be pushed (k, 3) [m]."""
        return q[self._node]

    def work(self, before: np.ndarray, q: np.ndarray) -> float:
        """Work of the forces [J] on points that were at ``before`` (k, 3), of `places`, and are in q (n, 3) [m] now."""
        return float(work_of(self._params, self._slot, self._node, before, q))

    def saved(self) -> tuple[np.ndarray, ...]:
        """What has been given."""
        return self.force.copy(), self.torque.copy(), self.axes.copy()

    def restore(self, saved: tuple[np.ndarray, ...]) -> None:
        """Go back to what had been given."""
        self.force[:], self.torque[:], self.axes[:] = saved
        self._look()
        self.changed = False  # the table goes back with the net


def vector(name: str, value: Any, unit: str, owner: str) -> np.ndarray:
    """Three finite numbers; `check_vector` says what is wrong with others, and takes ten times as long."""
    if isinstance(value, np.ndarray) and value.shape == (3,) and value.dtype == float and np.isfinite(value).all():
        return value
    return np.array(check_vector(name, value, unit, owner))


@kernel(float64(_f1, _i1, _i1, _f2, _f2))
def work_of(params, slot, node, before, q):
    """Sum of the forces at ``slot`` in ``params`` times the ways of their nodes from ``before`` (k, 3) to q (n, 3) [J]."""
    total = 0.0
    for k in range(slot.shape[0]):
        for x in range(3):
            total += params[slot[k] + x] * (q[node[k], x] - before[k, x])
    return total


@inlined
def _row(array, i):
    """Row i of an (n, 3) array."""
    return array[i, 0], array[i, 1], array[i, 2]


@kernel(void(float64, _f2, _f2, _f2, _f2, _i2, _i1, _i1, _i1, _i1, _f2, _f3, _f1, _i1, _f1))
def spread(ahead, q, v, force, torque, axes, of_body, slot, first, node, weights, directions, share, rows, params):
    """Write given forces and torques as forces on nodes.

    Parameters
    ----------
    ahead : float64 [s], time from now at which the axes of bodies are taken
    q, v : (n, 3) float64 [m], [m/s]
    force, torque : (k, 3), (bodies, 3) float64 [N], [N m]
    axes : (2, k) int64, WORLD or BODY: of each force, and of the torque of each body
    of_body : (k,) int64, body of each point, -1 for a free point
    slot : (k,) int64, where the force on each point lies in ``params``
    first, node, weights, directions, share : of a `BodyTable`
    rows : (nodes,) int64, which of the points each node of the bodies is
    params : (l,) float64, written
    """
    for k in range(force.shape[0]):
        for x in range(3):
            params[slot[k] + x] = force[k, x]
    for b in range(torque.shape[0]):
        e1, e2, d1, d2 = axes_and_rates(q, v, first[b], first[b + 1], node, weights)
        e3 = cross_product(e1, e2)
        turn = combined(e1, e2, e3, (ahead * along(d2, e3), -ahead * along(d1, e3), ahead * along(d1, e2)))
        e1, e2 = turned(turn, e1), turned(turn, e2)
        e3, u = cross_product(e1, e2), directions[b]
        u1, u2, u3 = _row(u, 0), _row(u, 1), _row(u, 2)
        for k in range(first[b], first[b + 1]):
            p = rows[k]
            if axes[0, p] == BODY:
                given = _row(force, p)
                turned_force = combined(e1, e2, e3, (along(u1, given), along(u2, given), along(u3, given)))
                for x in range(3):
                    params[slot[p] + x] = turned_force[x]
        given = _row(torque, b)
        if axes[1, b] == BODY:
            tau = along(u1, given), along(u2, given), along(u3, given)
        else:
            tau = along(e1, given), along(e2, given), along(e3, given)
        g1, g2, g3 = couple(e1, e2, e3, tau, share[b])
        for k in range(first[b], first[b + 1]):
            for x in range(3):
                params[slot[rows[k]] + x] += weights[0, k] * g1[x] + weights[1, k] * g2[x] + weights[2, k] * g3[x]
