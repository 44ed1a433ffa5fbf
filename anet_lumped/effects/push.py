"""Forces on points and bodies that are given from outside, step by step: those of `Session.push`.

f_i += F_i, with what F_i does in a second counted as taken with the opposite sign.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from anet_lumped.compiled.jit import njit

from .effect import Effect
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE


@dataclass(frozen=True)
class Push(Effect):
    """A force on each of the `pushed_points`, none to begin with. A session adds it to its scene and writes the forces into
    its table.

    `table` has the nodes of these points, and the force (3,) on each [N].
    """

    same_everywhere: ClassVar[bool] = True
    from_outside: ClassVar[bool] = True

    @property
    def linear_in_node_state(self) -> bool:
        """A force that is held over a step does not depend on the state."""
        return True

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Nodes, and zeros for the forces on them [N]."""
        nodes = [model.node_of[name] for name in pushed_points(model.scene)]
        return np.array(nodes, np.int64), np.zeros(3 * len(nodes))

    def of_cables(self) -> Effect | None:
        return None

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "energy": energy, "tangent": tangent}


def pushed_points(scene: Any) -> list[str]:
    """Names of the points that a session may push: free points, and all points of bodies that move freely."""
    on_bodies = [point.name for body in scene.bodies if not body.is_driven for point in body.points]
    return [*(point.name for point in scene.free_points), *on_bodies]


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i += F_i; returns -sum F_i . v_i [W]."""
    power = 0.0
    for k in range(index.shape[0]):
        for x in range(3):
            f[index[k], x] += params[3 * k + x]
            power -= params[3 * k + x] * v[index[k], x]
    return power


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """A force that is given step by step has no energy, 0 [J]."""
    return 0.0


@njit(TANGENT_SIGNATURE, cache=True)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Zero: a force that is given does not depend on position or velocity."""
