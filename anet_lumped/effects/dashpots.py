"""Dashpots between points and the world: dampers from outside, linear and quadratic, along fixed axes or those of a body.

With the velocity v of the point and its components v_a = v.e_a along three axes across each other,

    F = -sum_a (b_a + c_a |v_a|) v_a e_a .

Two numbers in place of three are those across the third axis, and along it; across it the quadratic part is then the same in all
directions, -c |v_t| v_t with v_t = v - (v.e_3) e_3. F.v is never above 0. A step takes F at its middle, for its mean velocity.

The slope of the force by the turn of a body is left out of the tangent: Newton's method looks at the force after each step, so that
this costs iterations where a body turns fast, and no accuracy.
Source: MoorDyn's documentation, "External Loads"; MoorDyn_Point.f90 and MoorDyn_Body.f90 of OpenFAST, for the components.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import SceneError, as_entries, check_number, check_pairs, quoted
from anet_lumped.compiled.jit import inlined_law, njit
from anet_lumped.effects.laws.axes_drag import axis_of, dot
from anet_lumped.effects.laws.over_a_step import middle_of

from .effect import Effect
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE

Numbers = Mapping[str, Sequence[float]] | Sequence[tuple[str, Sequence[float]]]
ALONG = {"linear": "N s/m", "quadratic": "N s2/m2", "linear_in_body": "N s/m", "quadratic_in_body": "N s2/m2"}
EACH, OF_BODY = 8, 5  # numbers of a dashpot; nodes of one along the axes of a body
WORLD = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Dashpots(Effect):
    """Forces -(b + c |v|) v on points and bodies, along each of three axes by the velocity along it.

    Coefficients are three numbers, or two: across the third axis, and along it.

    Parameters
    ----------
    linear : dict or pairs of str and three or two numbers [N s/m]
        b along the axes of the world, by the name of a free point, of a body for its origin, or of an attachment.
    quadratic : dict or pairs of str and three or two numbers [N s2/m2]
        c, likewise.
    linear_in_body : dict or pairs of str and three or two numbers [N s/m]
        b along the axes of the body, which turn with it, by the name of a body or of an attachment.
    quadratic_in_body : dict or pairs of str and three or two numbers [N s2/m2]
        c, likewise.
    """

    linear: Numbers = ()
    quadratic: Numbers = ()
    linear_in_body: Numbers = ()
    quadratic_in_body: Numbers = ()

    no_force_at_rest: ClassVar[bool] = True
    same_everywhere: ClassVar[bool] = True
    passive: ClassVar[bool] = True
    stiff: ClassVar[bool] = True

    def check_parameters(self) -> None:
        for argument, unit in ALONG.items():
            pairs = check_pairs(argument, getattr(self, argument), "a name and numbers", self._called, may_be_empty=True)
            self._set(**{argument: tuple((name, self._checked(argument, name, value, unit)) for name, value in pairs)})

    def _checked(self, argument: str, name: str, value: Any, unit: str) -> tuple[float, ...]:
        numbers = None if isinstance(value, str | Mapping) else as_entries(value)
        owner = f"{self._called} of {quoted(name)}"
        if numbers is None or len(numbers) not in (2, 3):
            raise SceneError(
                f"Argument `{argument}` must be three or two numbers [{unit}], but {owner} has {argument}={value!r:.60}."
            )
        return tuple(check_number(argument, number, unit, owner, sign="non-negative") for number in numbers)

    @property
    def linear_in_node_state(self) -> bool:
        """With linear dashpots along the axes of the world alone."""
        return not (self.quadratic or self.linear_in_body or self.quadratic_in_body)

    @classmethod
    def example(cls, scene: Any) -> Self:
        """A dashpot at the first point that moves freely, or at none."""
        return cls({point.name: (0.1, 0.1, 0.1) for point in scene.free_points[:1]})

    def without_bodies(self, held: Sequence[str]) -> Effect | None:
        left = {key: tuple(pair for pair in getattr(self, key) if pair[0] not in held) for key in ALONG}
        return replace(self, **left) if any(left.values()) else None  # type: ignore[arg-type]  # pairs, as they are checked

    def of_cables(self) -> Effect | None:
        return None

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Number of dashpots along axes of the world; the node of each of them; of each other one its node, and those of the
            origin of its body and of the points on its axes.
        params : float64
            Of each dashpot b [N s/m], c [N s2/m2], three each, 1 where c acts alike in all directions across the third axis, and 0.

        Raises
        ------
        SceneError : a point or body that the scene lacks, or that does not move freely
        """
        scene = model.scene
        free = {point.name for point in scene.free_points}
        on_body = {point.name: body for body in scene.bodies if not body.is_driven for point in body.points}
        index, params = [], []
        of_world, of_bodies = (self._joined(*keys) for keys in (("linear", "quadratic"), ("linear_in_body", "quadratic_in_body")))
        for name, numbers in of_world.items():
            if name not in free and name not in on_body:
                scene.point(name)
                raise SceneError(
                    f"A dashpot must be at a point or body that moves freely, but {quoted(name)} of {self._called} does not."
                )
            index.append([model.node_of[name]])
            params.append(numbers)
        for name, numbers in of_bodies.items():
            if name not in on_body:
                scene.point(name)
                raise SceneError(
                    f"A dashpot in the axes of a body must be on one that moves, but {quoted(name)} of {self._called} is not."
                )
            index.append([model.node_of[name], *(model.node_of[point.name] for point in on_body[name].points[:4])])
            params.append(numbers)
        return np.array([len(of_world), *np.concatenate([[], *index])], np.int64), np.concatenate([np.empty(0), *params])

    def _joined(self, linear: str, quadratic: str) -> dict[str, list[float]]:
        """Numbers of a dashpot for the kernels, by its name."""
        b, c = dict(getattr(self, linear)), dict(getattr(self, quadratic))
        return {
            name: [*_three(b.get(name, ())), *_three(c.get(name, ())), float(len(c.get(name, ())) == 2), 0.0]
            for name in dict.fromkeys([*b, *c])
        }

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return {"force": force, "tangent": tangent, "energy": energy}


def _three(numbers: Sequence[float]) -> Sequence[float]:
    """A number along each of three axes, of three numbers, of two, or of none."""
    return (numbers[0], *numbers) if len(numbers) == 2 else numbers or (0.0, 0.0, 0.0)


@inlined_law
def _axes(q, index, at):
    """Axes of a body whose nodes begin at ``index[at]``."""
    origin = middle_of(q, q, index[at])
    (e1, _), (e2, _), (e3, _) = (
        axis_of(origin, middle_of(q, q, index[at + 1])), axis_of(origin, middle_of(q, q, index[at + 2])),
        axis_of(origin, middle_of(q, q, index[at + 3])),
    )  # fmt: skip
    return e1, e2, e3


@inlined_law
def _speeds(s, is_round):
    """|v_a| of the quadratic part along each axis, for the components s of the velocity."""
    if is_round > 0.0:
        across = math.sqrt(s[0] * s[0] + s[1] * s[1])
        return across, across, abs(s[2])
    return abs(s[0]), abs(s[1]), abs(s[2])


@inlined_law
def _place(index, d):
    """Where the nodes of dashpot d are in ``index``, and whether they are those of a body."""
    worlds = index[0]
    return (1 + d, False) if d < worlds else (1 + worlds + OF_BODY * (d - worlds), True)


@inlined_law
def _moving(q, v, index, params, d):
    """Of dashpot d its node, numbers and axes, and the components of the velocity and `_speeds` along these."""
    at, of_body = _place(index, d)
    i, numbers = index[at], params[EACH * d : EACH * (d + 1)]
    axes = _axes(q, index, at + 1) if of_body else WORLD
    V = (v[i, 0], v[i, 1], v[i, 2])
    s = dot(V, axes[0]), dot(V, axes[1]), dot(V, axes[2])
    return i, numbers, axes, s, _speeds(s, numbers[6])


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add F; returns -sum F.v [W]."""
    power = 0.0
    for d in range(params.shape[0] // EACH):
        i, numbers, axes, s, speeds = _moving(q, v, index, params, d)
        for a in range(3):
            F = -(numbers[a] + numbers[3 + a] * speeds[a]) * s[a]
            power -= F * s[a]
            for x in range(3):
                f[i, x] += F * axes[a][x]
    return power


@njit(TANGENT_SIGNATURE, cache=True, error_model="numpy")
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract c_v dF/dv; see the module for what is left out of dF/dq."""
    for d in range(params.shape[0] // EACH):
        i, numbers, axes, s, speeds = _moving(q, v, index, params, d)
        for a in range(3):
            for b in range(3):
                slope = numbers[a] + numbers[3 + a] * speeds[a] if a == b else 0.0
                if numbers[6] > 0.0 and a < 2 and b < 2:
                    slope += numbers[3 + a] * s[a] * s[b] / max(speeds[a], 1e-300)  # 0 at rest
                elif a == b:
                    slope += numbers[3 + a] * speeds[a]
                for x in range(3):
                    for y in range(3):
                        D[i, x, y] += c_v * slope * axes[a][x] * axes[b][y]


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Dashpots have no energy, 0 [J]."""
    return 0.0
