"""A distributed load: a force per unstretched length that does not depend on the shape of a cable."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import Vector, check_names, check_number, check_vector
from anet_lumped.compiled.jit import njit
from anet_lumped.prescribed.smoothstep_kernel import ramped

from .effect import Effect, names_left
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE


@dataclass(frozen=True)
class Load(Effect):
    """A force p per unstretched length of cables; each node of a segment takes p L0/2.

    A constant load is a dead load, with the potential energy -sum f . q. A load that grows has no potential energy: its work counts
    as negative dissipation.

    Parameters
    ----------
    per_length : (3,) array_like [N/m]
        p, a force over an unstretched length.
    cables : sequence of str or None
        Names of the cables that it acts on; all if None.
    ramp : float [s]
        Time from t = 0 in which the load grows from zero to p, by s^3 (6 s^2 - 15 s + 10) with s = t/ramp; 0: a constant load.
    """

    per_length: Vector
    cables: Sequence[str] | None = None
    ramp: float = 0.0

    same_everywhere: ClassVar[bool] = True

    def check_parameters(self) -> None:
        self._set(
            per_length=check_vector("per_length", self.per_length, "N/m", self._called),
            cables=check_names("cables", self.cables, self._called),
            ramp=check_number("ramp", self.ramp, "s", self._called, sign="non-negative"),
        )

    @property
    def dead_load(self) -> bool:
        """Unless it grows in time."""
        return self.ramp == 0.0

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls((0.0, 0.1, 0.0))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """No index; ramp [s] and the load on each moving node [N].

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

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        dead: dict[str, Callable[..., Any]] = {"force": force, "energy": energy}
        return dead if self.dead_load else dead | {"tangent": tangent}

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        if self.cables is None:
            return self
        names = [piece for name in self.cables for piece in names_left(name, pieces)]
        return Load(self.per_length, tuple(names), self.ramp) if names else None


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i += p_i; returns -sum p_i . v_i [W] for a load that grows, 0 for a constant one, which has an energy."""
    (ramp_share, _, _), power = ramped(t, params[0]), 0.0
    for i in range((params.shape[0] - 1) // 3):
        for x in range(3):
            p = ramp_share * params[1 + 3 * i + x]
            f[i, x] += p
            power -= p * v[i, x]
    return power if params[0] > 0.0 else 0.0


@njit(TANGENT_SIGNATURE, cache=True)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Zero: the load does not depend on position or velocity."""


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """-sum p_i . q_i [J] of a constant load."""
    total = 0.0
    if params[0] == 0.0:
        for i in range((params.shape[0] - 1) // 3):
            for x in range(3):
                total -= params[1 + 3 * i + x] * q[i, x]
    return total
