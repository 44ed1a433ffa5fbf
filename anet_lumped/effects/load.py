"""A distributed load: a force per unstretched length that does not depend on where a cable is."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from anet_lumped.checks import SceneError, check_name, check_number, check_vector
from anet_lumped.prescribed.smoothstep import ramped

from .signatures import ENERGY, FORCE, TANGENT, names_left


@dataclass(frozen=True)
class Load:
    """A dead load p on cables, half of p L0 on either node of a segment.

    A constant load has the potential energy -sum f . q. One that grows has none: what it does is booked as energy that it gives.

    Parameters
    ----------
    per_length : (3,) array_like [N/m]
        p, over the unstretched length.
    cables : sequence of str or None
        Those that it acts on; all if None.
    ramp : float [s]
        Time from t = 0 in which it grows from nothing, as s^3 (6 s^2 - 15 s + 10) of s = t/ramp; 0 for a constant load.
    """

    per_length: tuple[float, float, float]
    cables: tuple[str, ...] | None = None
    ramp: float = 0.0

    def __post_init__(self):
        object.__setattr__(self, "per_length", check_vector("per_length", self.per_length, "N/m", "effect Load"))
        object.__setattr__(self, "ramp", check_number("ramp", self.ramp, "s", "effect Load", sign="non-negative"))
        if self.cables is not None:
            if isinstance(self.cables, str) or not self.cables:
                raise SceneError(f"Argument `cables` must be a sequence of names, but effect Load has cables={self.cables!r}.")
            object.__setattr__(self, "cables", tuple(check_name(name, "cable") for name in self.cables))

    @property
    def linear(self):
        """Whether it is dead: it neither depends on the shape nor on time."""
        return self.ramp == 0.0

    def table(self, model):
        """Index and parameters for the kernels below: none; ramp [s] and the load on each moving node [N].

        Raises
        ------
        SceneError : an unknown cable
        """
        f = np.zeros((model.n, 3))
        for name in [cable.name for cable in model.scene.cables] if self.cables is None else self.cables:
            half = 0.5 * model.scene.cable(name).L0 * np.array(self.per_length)
            nodes = model.nodes(name)
            f[nodes[:-1]] += half
            f[nodes[1:]] += half
        return np.empty(0, np.int64), np.concatenate([[self.ramp], f[: model.n_free].ravel()])

    def kernels(self):
        """Compiled functions, by their slot in `signatures`."""
        return {"force": force, "tangent": tangent, "energy": energy}

    def of_pieces(self, pieces, cables):
        """The same load where cables have broken, see `anet_lumped.model.remainder`."""
        if self.cables is None:
            return self
        names = [piece for name in self.cables for piece in names_left(name, pieces)]
        return Load(self.per_length, tuple(names), self.ramp) if names else None


@njit(FORCE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i += p_i; returns what a load that grows takes out [W], -sum p_i . v_i."""
    (share, _, _), power = ramped(t, params[0]), 0.0
    for i in range((params.shape[0] - 1) // 3):
        for x in range(3):
            p = share * params[1 + 3 * i + x]
            f[i, x] += p
            power -= p * v[i, x]
    return power if params[0] > 0.0 else 0.0


@njit(TANGENT, cache=True)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """The load does not depend on place or velocity."""


@njit(ENERGY, cache=True)
def energy(t, q, index, params):
    """-sum p_i . q_i [J] of a constant load."""
    total = 0.0
    if params[0] == 0.0:
        for i in range((params.shape[0] - 1) // 3):
            for x in range(3):
                total -= params[1 + 3 * i + x] * q[i, x]
    return total
