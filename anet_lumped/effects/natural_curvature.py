"""Natural curvature of cables that bend: the arc that a cable forms by itself, as a coiled hose or a pre-bent rod does.

Two neighbouring segments with unit tangents t1 and t2 rest where t2 = R t1, with the rotation R by |kappa| L0 about the vector
kappa. `Bending` stores B (1 - t1 . t2) of a pair, B = EI/L0. This effect adds

    V = B t2 . M t1 ,   M = I - R ,

so that both together store B (1 - t2 . R t1). The vector kappa keeps its direction in the world: the law has no twist, and holds
for cables that move across kappa. The first segment of an arc is turned by half of its angle, |kappa| L0/2: so is the direction of
a clamp.

Over a whole step from a to b, with the means of both ends and the e and S of `bending`, the forces of

    g1 = B S1 (I - e1 e1^T) M^T (mean t2) ,   g2 = B S2 (I - e2 e2^T) M (mean t1)

do exactly the work by which V changes.
Source: Bergou et al., ACM Trans. Graph. 27 (2008) 63, for rods with a curvature at rest.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_pairs, check_vector, quoted
from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.prescribed.turning import matrix_of

from .effect import Effect, names_left
from .laws.rod import (
    add_row,
    assemble_pair,
    between_nodes,
    combined,
    dot,
    own_block,
    own_step_block,
    projected,
    step_of,
    tangent_of_segment,
)
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE, WHOLE_STEP_SIGNATURE

EACH = 11  # numbers of a pair: B, L0 and M by rows


@dataclass(frozen=True)
class NaturalCurvature(Effect):
    """Curvature that cables have where nothing loads them; beside `Bending`, which holds them to be straight.

    Parameters
    ----------
    curvature : dict or pairs of str and (3,) array_like [1/m]
        By the name of a cable that has an `EI`: the vector about which it turns by the right hand from its start to its end, as
        long as its curvature.
    """

    curvature: Mapping[str, Vector] | tuple[tuple[str, Vector], ...]

    coupled_neighbours: ClassVar[int] = 2
    same_everywhere: ClassVar[bool] = True

    def check_parameters(self) -> None:
        pairs = check_pairs("curvature", self.curvature, "a cable's name and a vector", self._called)
        self._set(curvature=tuple((name, check_vector("curvature", value, "1/m", self._called)) for name, value in pairs))

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls({scene.cables[0].name: (0.0, 0.1, 0.0)})

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Three nodes and the first segment of each pair; `EACH` numbers of each.

        Raises
        ------
        SceneError : an unknown cable, or one without an EI
        """
        index: list[int] = []
        numbers: list[float] = []
        for name, kappa in dict(self.curvature).items():
            cable = model.scene.cable(name)
            if not cable.EI > 0.0:
                raise SceneError(f"A cable with a natural curvature needs an `EI` [N m2], but cable {quoted(name)} has none.")
            c = model.scene.cable_numbers[name]
            first, count = model.segment_run(c)
            sign = -1.0 if model.flipped[c] else 1.0
            M = np.eye(3) - matrix_of(sign * cable.L0 * np.array(kappa))
            for s in range(first, first + count - 1):
                index += [*model.ends[s], model.ends[s + 1, 1], s]
                numbers += [cable.EI / cable.L0, cable.L0, *M.ravel()]
        return np.array(index, np.int64), np.array(numbers)

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        left = tuple((piece, kappa) for name, kappa in dict(self.curvature).items() for piece in names_left(name, pieces))
        return NaturalCurvature(left) if left else None

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step}


@inlined_law
def _rotated(params, at, t):
    """M t."""
    m = at + 2
    x, y = (params[m], params[m + 1], params[m + 2]), (params[m + 3], params[m + 4], params[m + 5])
    return dot(x, t), dot(y, t), dot((params[m + 6], params[m + 7], params[m + 8]), t)


@inlined_law
def _rotated_back(params, at, t):
    """M^T t."""
    m = at + 2
    x, y = (params[m], params[m + 3], params[m + 6]), (params[m + 1], params[m + 4], params[m + 7])
    return dot(x, t), dot(y, t), dot((params[m + 2], params[m + 5], params[m + 8]), t)


@inlined_law
def _cross(H, weight, e, params, at, transposed, t):
    """weight (I - e e^T) M (I - t t^T) for H, or with M^T."""
    m = at + 2
    for x in range(3):
        for y in range(3):
            H[x, y] = params[m + 3 * y + x] if transposed else params[m + 3 * x + y]
    for x in range(3):
        along = H[x, 0] * t[0] + H[x, 1] * t[1] + H[x, 2] * t[2]
        for y in range(3):
            H[x, y] -= along * t[y]
    for y in range(3):
        along = e[0] * H[0, y] + e[1] * H[1, y] + e[2] * H[2, y]
        for x in range(3):
            H[x, y] = weight * (H[x, y] - e[x] * along)


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """f_i -= dV/dq_i; see the module. It has an energy, so that it takes no power [W]."""
    for p in range(index.shape[0] // 4):
        i, j, k, at = index[4 * p], index[4 * p + 1], index[4 * p + 2], EACH * p
        B, L0 = params[at], params[at + 1]
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), L0)
        t2, l2 = tangent_of_segment(between_nodes(q, j, k), L0)
        g1, g2 = projected(B / l1, t1, _rotated_back(params, at, t2)), projected(B / l2, t2, _rotated(params, at, t1))
        add_row(f, i, g1, 1.0)
        add_row(f, j, g1, -1.0)
        add_row(f, j, g2, 1.0)
        add_row(f, k, g2, -1.0)
    return 0.0


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Exact second derivatives of the energy; see the module."""
    H11, H12, H21, H22 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for p in range(index.shape[0] // 4):
        i, j, k, s, at = index[4 * p], index[4 * p + 1], index[4 * p + 2], index[4 * p + 3], EACH * p
        B, L0 = params[at], params[at + 1]
        t1, l1 = tangent_of_segment(between_nodes(q, i, j), L0)
        t2, l2 = tangent_of_segment(between_nodes(q, j, k), L0)
        own_block(H11, -B, l1, t1, _rotated_back(params, at, t2))
        own_block(H22, -B, l2, t2, _rotated(params, at, t1))
        _cross(H12, B / (l1 * l2), t1, params, at, True, t2)
        _cross(H21, B / (l1 * l2), t2, params, at, False, t1)
        assemble_pair(c_q, i, j, k, s, H11, H12, H21, H22, D, near, far)


@njit(ENERGY_SIGNATURE, cache=True, error_model="numpy")
def energy(t, q, index, params):
    """Sum of B t2 . M t1 [J]."""
    total = 0.0
    for p in range(index.shape[0] // 4):
        at = EACH * p
        t1, _ = tangent_of_segment(between_nodes(q, index[4 * p], index[4 * p + 1]), params[at + 1])
        t2, _ = tangent_of_segment(between_nodes(q, index[4 * p + 1], index[4 * p + 2]), params[at + 1])
        total += params[at] * dot(t2, _rotated(params, at, t1))
    return total


@njit(WHOLE_STEP_SIGNATURE, cache=True, error_model="numpy")
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Forces over a whole step as discrete gradients of the energy, and their exact derivatives; see the module."""
    H11, H12, H21, H22 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for p in range(index.shape[0] // 4):
        i, j, k, s, at = index[4 * p], index[4 * p + 1], index[4 * p + 2], index[4 * p + 3], EACH * p
        B, L0 = params[at], params[at + 1]
        t1a, t1, l1a, l1, S1, e1, _ = step_of(base, q, i, j, L0)
        t2a, t2, l2a, l2, S2, e2, _ = step_of(base, q, j, k, L0)
        w1 = _rotated_back(params, at, combined(0.5, t2a, 0.5, t2))
        w2 = _rotated(params, at, combined(0.5, t1a, 0.5, t1))
        g1, g2 = projected(B * S1, e1, w1), projected(B * S2, e2, w2)
        add_row(f, i, g1, 1.0)
        add_row(f, j, g1, -1.0)
        add_row(f, j, g2, 1.0)
        add_row(f, k, g2, -1.0)
        own_step_block(H11, -B, S1, e1, t1, l1a, l1, w1)
        own_step_block(H22, -B, S2, e2, t2, l2a, l2, w2)
        _cross(H12, 0.5 * B * S1 / l2, e1, params, at, True, t2)
        _cross(H21, 0.5 * B * S2 / l1, e2, params, at, False, t1)
        assemble_pair(1.0, i, j, k, s, H11, H12, H21, H22, D, near, far)
    return 0.0, 0.0
