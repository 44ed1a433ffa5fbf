"""Forces on points and bodies, and torques on bodies, constant or functions of time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, Self

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_pairs, check_vector, quoted, shown
from anet_lumped.compiled.jit import inlined, njit
from anet_lumped.prescribed.path_in_numbers import PIECE, constant, numbers_of_path, value_at
from anet_lumped.prescribed.paths import Path
from anet_lumped.prescribed.signals import Signal

from .effect import Effect
from .laws.couple import along, combined, couple, cross_product, direction_weights
from .signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE

AXES = ("world", "body")
UNITS = {"force": "N", "torque": "N m", "force_in_body": "N"}
FORCE, TORQUE = 0, 1
IN_WORLD, IN_BODY = 0, 1
HEADER = 5  # of a load in ``index``: force or torque, its axes, pieces of its path, whether it has a sine, nodes


class _Load(NamedTuple):
    """A force on one node, or a torque on a body, as the kernels read it."""

    kind: int
    path: Path
    body: Any
    in_body: bool  # along the axes of the body


@dataclass(frozen=True)
class AppliedForces(Effect):
    """Forces F(t) on free points and bodies, and torques tau(t) on bodies, whatever they do.

    A force acts at the point named: a free point, an attachment of a body ("quad1.hook") or its origin ("quad1"). Constant forces
    in the axes of the world have the potential energy -sum F . q. What others do counts as negative dissipation.

    Parameters
    ----------
    force : dict or pairs of str and (3,) array_like or Path [N]
        By the name of a point; a path of `anet_lumped.paths` gives the force as a function of time, in N in place of m.
    torque : dict or pairs of str and (3,) array_like or Path [N m]
        By the name of a body, likewise.
    axes : "world" or "body"
        Axes in which forces and torques are given; those of a body turn with it, those on a free point are the world's.
    force_in_body : dict or pairs of str and (3,) array_like or Path [N]
        Forces on bodies and attachments along the axes of the body, whatever `axes` are.
    """

    force: Mapping[str, Vector | Path] | tuple[tuple[str, Vector | Path], ...] = ()
    torque: Mapping[str, Vector | Path] | tuple[tuple[str, Vector | Path], ...] = ()
    axes: Literal["world", "body"] = "world"
    force_in_body: Mapping[str, Vector | Path] | tuple[tuple[str, Vector | Path], ...] = ()

    def check_parameters(self) -> None:
        if self.axes not in AXES:
            raise SceneError(f'Argument `axes` must be "world" or "body", but {self._called} has axes={shown(self.axes)}.')
        for argument, unit in UNITS.items():
            pairs = check_pairs(argument, getattr(self, argument), "a name and a vector or path", self._called, may_be_empty=True)
            self._set(**{argument: tuple((name, self._checked(argument, name, value, unit)) for name, value in pairs)})

    def _checked(self, argument: str, name: str, value: Any, unit: str) -> Any:
        if not isinstance(value, Path):
            return check_vector(argument, value, unit, f"{self._called} of {quoted(name)}")
        if value.kind == "external":
            raise SceneError(
                f"Argument `{argument}` must be a vector, or a path that is known before a run, but {self._called} has "
                f"{shown(value)} for {quoted(name)}; a Session pushes from outside."
            )
        return value

    @property
    def same_everywhere(self) -> bool:
        """Forces know no places."""
        return True

    @property
    def dead_load(self) -> bool:
        """Constant forces in the axes of the world, and no torque."""
        return self.linear_in_node_state and not any(isinstance(value, Path) for value in dict(self.force).values())

    @property
    def linear_in_node_state(self) -> bool:
        """A force that does not turn with a body is the same at any place."""
        return self.axes == "world" and not self.torque and not self.force_in_body

    @property
    def signals(self) -> tuple[Signal, ...]:
        """The functions of time, whose corners steps end on."""
        return tuple(
            Signal(argument, ((name, value),), value)
            for argument in UNITS for name, value in dict(getattr(self, argument)).items() if isinstance(value, Path)
        )  # fmt: skip

    @classmethod
    def example(cls, scene: Any) -> Self:
        """A push on the first point that moves freely, or on none."""
        return cls({point.name: (0.0, 0.1, 0.0) for point in scene.free_points[:1]})

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """For each load a `HEADER` and nodes; pieces of its path, its sine, directions and weights of the body that it turns with.

        Raises
        ------
        SceneError : a point or body that the scene lacks, or that does not move freely
        """
        index: list[int] = []
        numbers: list[np.ndarray] = []
        for load, name in [*self._forces(model.scene), *self._torques(model.scene)]:
            turns = load.body is not None and (load.kind == TORQUE or load.in_body)
            points = load.body.points if turns else ()
            nodes = [model.node_of[point.name] for point in points]
            path = load.path
            axes = IN_BODY if load.in_body and turns else IN_WORLD
            index += [load.kind, axes, len(path.breaks), path.sine is not None, len(nodes), model.node_of[name], *nodes]
            numbers.append(numbers_of_path(path))
            if turns:
                weights, directions, share = direction_weights([point.arm for point in points])
                numbers += [np.array([share]), directions.ravel(), weights.ravel()]
        return np.array(index, np.int64), np.concatenate([np.empty(0), *numbers])

    def _forces(self, scene: Any) -> list[tuple[_Load, str]]:
        """Forces, with the names of their points."""
        free = {point.name: None for point in scene.free_points}
        on_body = {point.name: body for body in scene.bodies if not body.is_driven for point in body.points}
        for name in dict(self.force):
            if name not in free and name not in on_body:
                scene.point(name)
                raise SceneError(
                    f"A force must act on a point or body that moves freely, but {quoted(name)} of {self._called} does not."
                )
        for name in dict(self.force_in_body):
            if name not in on_body:
                scene.point(name)
                raise SceneError(
                    f"A force in the axes of a body must be on one that moves freely, but {quoted(name)} of {self._called} is not."
                )
        loads = [(name, value, self.axes == "body") for name, value in dict(self.force).items()]
        loads += [(name, value, True) for name, value in dict(self.force_in_body).items()]
        return [(_Load(FORCE, _path(value), on_body.get(name), in_body), name) for name, value, in_body in loads]

    def _torques(self, scene: Any) -> list[tuple[_Load, str]]:
        """Torques, with the names of their bodies."""
        for name in dict(self.torque):
            if scene.body(name).is_driven:
                raise SceneError(f"A torque must act on a body that moves freely, but {quoted(name)} of {self._called} does not.")
        in_body = self.axes == "body"
        return [(_Load(TORQUE, _path(value), scene.body(name), in_body), name) for name, value in dict(self.torque).items()]

    def without_bodies(self, held: Sequence[str]) -> Effect | None:
        left = {key: tuple((name, value) for name, value in dict(getattr(self, key)).items() if name not in held) for key in UNITS}
        return replace(self, **left) if any(left.values()) else None  # type: ignore[arg-type]  # pairs, as they are checked

    def of_cables(self) -> Effect | None:
        return None

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        dead: dict[str, Callable[..., Any]] = {"force": dead_force, "energy": dead_energy}
        return dead if self.dead_load else {"force": force, "energy": energy, "tangent": tangent}


def _path(value: Any) -> Path:
    """A path, or a constant vector as one."""
    return value if isinstance(value, Path) else constant(value)


@inlined
def _direction(q, index, first, nodes, params, at):
    """Sum of the rows of q of a body's nodes, weighted."""
    x, y, z = 0.0, 0.0, 0.0
    for k in range(nodes):
        i, c = index[first + k], params[at + k]
        x, y, z = x + c * q[i, 0], y + c * q[i, 1], z + c * q[i, 2]
    return x, y, z


@inlined
def _add(f, v, i, share, force):
    """Add ``share`` times a force to row i of f; returns the power that it takes [W]."""
    power = 0.0
    for x in range(3):
        f[i, x] += share * force[x]
        power -= share * force[x] * v[i, x]
    return power


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def force(t, q, v, index, params, f):
    """Add forces and the couples of torques, see `laws.couple`; returns -sum f . v [W]."""
    power, i, at = 0.0, 0, 0
    while i < index.shape[0]:
        kind, axes, pieces, has_sine, nodes = index[i], index[i + 1], index[i + 2], index[i + 3], index[i + 4]
        value, at = value_at(t, params, at, pieces, has_sine != 0)
        point, first, end = index[i + HEADER], i + HEADER + 1, i + HEADER + 1 + nodes
        if nodes == 0:
            power += _add(f, v, point, 1.0, value)
        else:
            share, directions, weights = params[at], at + 1, at + 10
            e1 = _direction(q, index, first, nodes, params, weights)
            e2 = _direction(q, index, first, nodes, params, weights + nodes)
            e3 = cross_product(e1, e2)
            if axes == IN_BODY:  # components along the three directions of the body
                u1 = params[directions], params[directions + 1], params[directions + 2]
                u2 = params[directions + 3], params[directions + 4], params[directions + 5]
                u3 = params[directions + 6], params[directions + 7], params[directions + 8]
                components = along(u1, value), along(u2, value), along(u3, value)
            else:
                components = along(e1, value), along(e2, value), along(e3, value)
            if kind == FORCE:
                power += _add(f, v, point, 1.0, combined(e1, e2, e3, components))
            else:
                g1, g2, g3 = couple(e1, e2, e3, components, share)
                for k in range(nodes):
                    power += _add(f, v, index[first + k], params[weights + k], g1)
                    power += _add(f, v, index[first + k], params[weights + nodes + k], g2)
                    power += _add(f, v, index[first + k], params[weights + 2 * nodes + k], g3)
            at = weights + 3 * nodes
        i = end
    return power


@njit(ENERGY_SIGNATURE, cache=True)
def energy(t, q, index, params):
    """Forces that change or turn have no energy, 0 [J]."""
    return 0.0


@njit(TANGENT_SIGNATURE, cache=True)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Zero. A force that turns with its body couples nodes that no segment joins, for which there are no blocks.

    What is left out is tau h^2/(8 J) of the inertia of a body J in a step h: each of Newton's iterations leaves so much of the
    force out of balance.
    """


@njit(FORCE_SIGNATURE, cache=True, error_model="numpy")
def dead_force(t, q, v, index, params, f):
    """Add constant forces; returns 0 [W], for they have an energy."""
    for k in range(index.shape[0] // (HEADER + 1)):
        i, at = index[k * (HEADER + 1) + HEADER], k * PIECE + 1
        for x in range(3):
            f[i, x] += params[at + x]
    return 0.0


@njit(ENERGY_SIGNATURE, cache=True)
def dead_energy(t, q, index, params):
    """-sum F . q [J]."""
    total = 0.0
    for k in range(index.shape[0] // (HEADER + 1)):
        i, at = index[k * (HEADER + 1) + HEADER], k * PIECE + 1
        for x in range(3):
            total -= params[at + x] * q[i, x]
    return total
