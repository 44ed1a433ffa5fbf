"""An effect as one would add it to the library: this file, one line of the registry, and its test (`test_new_effect`)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anet_lumped.checks import check_names, check_number, check_vector
from anet_lumped.compiled.jit import njit
from anet_lumped.effects.effect import Effect
from anet_lumped.effects.signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE


@dataclass(frozen=True)
class Tether(Effect):
    """A spring without length from an anchor to each node, f = -k (q - anchor), of energy k |q - anchor|^2/2.

    Parameters
    ----------
    stiffness : float [N/m]
    anchor : tuple of 3 float [m]
    points : names of free points, or None for every node that moves
    """

    stiffness: float
    anchor: tuple[float, float, float] = (0.0, 0.0, 0.0)
    points: tuple[str, ...] | None = None

    linear_in_node_state: ClassVar[bool] = True
    passive: ClassVar[bool] = True

    def check_parameters(self):
        self._set(
            stiffness=check_number("stiffness", self.stiffness, "N/m", self._called, sign="non-negative"),
            anchor=check_vector("anchor", self.anchor, "m", self._called),
            points=check_names("points", self.points, self._called),
        )

    @classmethod
    def example(cls, scene):
        return cls(0.1)

    def table(self, model):
        """Nodes; stiffness [N/m] and anchor [m]."""
        nodes = range(model.n_free) if self.points is None else [model.node(name) for name in self.points]
        return np.array(nodes, np.int64), np.array([self.stiffness, *self.anchor])

    def kernels(self):
        return {"force": force, "tangent": tangent, "energy": energy}

    def after_break(self, pieces, cables):
        left = {name for cable in cables for name in (cable.start, cable.end)}
        points = self.points and tuple(name for name in self.points if name in left)
        return None if points == () else Tether(self.stiffness, self.anchor, points)


@njit(FORCE_SIGNATURE, cache=True)
def force(t, q, v, index, params, f):
    """f_i -= k (q_i - anchor)."""
    for i in index:
        for x in range(3):
            f[i, x] -= params[0] * (q[i, x] - params[1 + x])
    return 0.0


@njit(TANGENT_SIGNATURE, cache=True)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """df/dq = -k."""
    for i in index:
        for x in range(3):
            D[i, x, x] += c_q * params[0]


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Sum of k |q_i - anchor|^2/2 [J]."""
    total = 0.0
    for i in index:
        for x in range(3):
            total += 0.5 * params[0] * (q[i, x] - params[1 + x]) ** 2
    return total
