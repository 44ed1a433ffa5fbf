"""The blow at joints with which a run begins: bodies whose points at a joint do not move alike are brought together at once."""

from typing import Any

import numpy as np

from anet_lumped.checks import InputError, quoted
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.tables import JOINT_BODY, JOINT_OTHER_NODE, JOINT_POSITION
from anet_lumped.scene.joints import parents_first

OPEN = 1e-6  # of the largest coordinate, or of a metre: two points of a joint that are nearer are together
ALIKE = 1e-9  # of the largest speed: smaller differences of velocities are none


def blow_at_joints(model: Any, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, float, float] | None:
    """Velocities after the impulses that joints need, the work of what is driven, and the energy that they take [J].

    None where all points of joints move alike.

    Parameters
    ----------
    model : Model
    t : float [s]
    q, v : (n, 3) float64 [m], [m/s]

    Raises
    ------
    InputError : a body that does not start where it is pinned
    """
    from anet_lumped.mechanics.bodies.joints import keep_joints
    from anet_lumped.mechanics.prescribe import prescribe

    q, v, net, joints = q.copy(), v.copy(), fresh_net(model, force=False, newton=False), model.bodies.joint
    prescribe(t, net.address, q, v)
    own, other = model.bodies.node[joints[:, JOINT_POSITION]], joints[:, JOINT_OTHER_NODE]
    apart = np.linalg.norm(q[own] - q[other], axis=1)
    if apart.max() > OPEN * max(1.0, float(np.abs(q).max())):
        worst = int(np.argmax(apart))
        free = [body for body in parents_first(model.scene.bodies) if not body.is_driven]
        name = free[joints[worst, JOINT_BODY]].name
        raise InputError(
            f"A body must start where it is pinned, but {quoted(name)} starts {apart[worst]:.3g} m from it; State.moved takes "
            "along what is pinned to the body that it moves."
        )
    if np.abs(v[own] - v[other]).max() <= ALIKE * np.abs(v).max():
        return None
    before = 0.5 * model.mass @ (v * v).sum(axis=1)
    work = keep_joints(t, net.address, q, v)
    return v, work, float(before + work - 0.5 * model.mass @ (v * v).sum(axis=1))
