"""A user's own effects: the law of one node or of one segment, in plain Python, makes an effect like those of the library.

    @node_energy
    def magnet(t, q, strength, at):
        x, y, z = q[0] - at[0], q[1] - at[1], q[2] - at[2]
        return -strength / (x * x + y * y + z * z) ** 1.5

    scene = Scene(points, cables, [Gravity(), magnet(strength=2e-4, at=(0.0, 0.0, -0.9), points=["p0"])])

Numba compiles the law, and dual numbers give its derivatives exactly to rounding, so that statics and implicit steps converge as
with any other effect. A law may hold arithmetic, comparisons, branches, loops and the functions in `dual.NAMES`, of `math` or of
numpy. Functions of the user's that it calls must be compiled too (``@numba.njit``). It may not raise exceptions. A law is compiled
once a process, in a few seconds, when the first scene that has it is built.

The name of the function is the name of the effect, also in scene files once the module that defines it is imported. Its first
arguments are

    node_force(t, q, v)               -> force on a node (fx, fy, fz) [N]
    node_energy(t, q)                 -> potential energy of a node [J]
    segment_force(t, q0, q1, v0, v1)  -> force on either node of a segment ((fx, fy, fz), (fx, fy, fz)) [N]
    segment_energy(t, q0, q1)         -> potential energy of a segment [J]

with the time t [s], positions [m] and velocities [m/s] as three numbers each; node 0 of a segment is the one towards its cable's
start. The arguments in `OF_NODES` and `OF_SEGMENTS` are filled in for each element. All others are the effect's parameters, a
number or a tuple of numbers each, with the defaults that they have in the law. Prefer an energy to the force that follows from it:
the energy balance of a run then holds it, a run that gains energy is noticed, and a step of `edmc` does exactly the work that the
energy says, however stiff the law is (`energy_steps`). A force is taken at the middle of the step; of what it puts in, nothing is
promised. Methods of diffrax do not take such effects.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, fields, make_dataclass, replace
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import SceneError, check_names, check_number, quoted
from anet_lumped.effects import REGISTRY
from anet_lumped.effects.effect import Effect, names_left
from anet_lumped.effects.laws.diameters import check_diameters

from . import kernels as own_kernels
from . import law as own_law
from .law import Kind, Law, is_number, is_pair, is_vector, read_law

OF_NODES = ("mass", "length", "area")
"""Of the node: mass [kg]; half of the unstretched length of its segments [m]; that length times their diameters [m2]."""
OF_SEGMENTS = ("L0", "mass_per_length", "EA", "EI", "diameter", "Cdn", "Cdt", "Can", "Cat")
"""Of the segment's cable, see `Cable`; L0 is the segment's unstretched length [m]."""

NODE_FORCE = Kind(("t", "q", "v"), OF_NODES, "the force (fx, fy, fz) [N]", is_vector, own_kernels.of_node_force)
NODE_ENERGY = Kind(("t", "q"), OF_NODES, "one number, the energy [J]", is_number, own_kernels.of_node_energy)
DEAD_ENERGY = NODE_ENERGY._replace(make=own_kernels.of_dead_energy)
SEGMENT_FORCE = Kind(
    ("t", "q0", "q1", "v0", "v1"), OF_SEGMENTS, "the forces on both nodes ((fx, fy, fz), (fx, fy, fz)) [N]", is_pair,
    own_kernels.of_segment_force,
)  # fmt: skip
SEGMENT_ENERGY = Kind(("t", "q0", "q1"), OF_SEGMENTS, "one number, the energy [J]", is_number, own_kernels.of_segment_energy)


class _Own(Effect):
    """What the effects made here share. Their fields are the parameters of the law, and the names of what it acts on."""

    law: ClassVar[Law]
    where: ClassVar[str]  # name of the field that says what it acts on
    _elements: ClassVar[Callable[..., tuple[Any, dict[str, Any]]]]  # what it acts on, and what is filled in for each

    def check_parameters(self) -> None:
        for name in (one.name for one in fields(self)):  # type: ignore[arg-type]  # `_effect` makes dataclasses of them
            value = getattr(self, name)
            self._set(**{name: check_names(name, value, self._called) if name == self.where else self._numbers(name, value)})

    def check_kernels(self) -> None:
        """Compile the law itself; its compiled functions follow, and are checked, when a model is built."""
        own_law.compiled(self.law, self._shapes)

    @property
    def _shapes(self) -> tuple[int, ...]:
        values = (getattr(self, name) for name in self.law.parameters)
        return tuple(len(value) if isinstance(value, tuple) else 0 for value in values)

    def _numbers(self, name: str, value: Any) -> float | tuple[float, ...]:
        """A number, or a tuple of numbers."""
        if isinstance(value, tuple | list | np.ndarray) and len(value):
            return tuple(check_number(name, x, "", self._called) for x in value)
        return check_number(name, value, "", self._called)

    @property
    def sudden(self) -> tuple[tuple[float, float, float], ...]:
        return ((-math.inf, math.inf, 0.0),) if own_law.reads_time(self.law) else ()

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        return own_law.kernels(self.law, self._shapes)

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions.

        Returns
        -------
        index : int64, see `own_kernels`
        params : float64
            Those of the effect; of each element what is filled in; masses of the nodes of each [kg], 0 if a node does not move.

        Raises
        ------
        SceneError : no point or cable of that name, or a held point; a cable that lacks what the law needs
        """
        index, of_elements = self._elements(model)
        own = [np.ravel(getattr(self, name)) for name in self.law.parameters]
        nodes = np.reshape(index, (-1, 4))[:, :2].ravel() if self.where == "cables" else np.asarray(index)
        masses = np.where(nodes < model.n_free, model.mass[np.minimum(nodes, model.n_free - 1)], 0.0)
        filled = [np.column_stack([of_elements[name] for name in self.law.fills]).ravel()] if self.law.fills else []
        return np.asarray(index, np.int64), np.concatenate([*own, *filled, masses]).astype(float)


class _OfNodes(_Own):
    where = "points"
    points: tuple[str, ...] | None

    def of_cables(self) -> Effect | None:
        """A law that asks for what a node has of its cables is spread over these; any other acts on the node itself."""
        return self if self.points is None and self.law.fills else None

    def without_bodies(self, held: Sequence[str]) -> Effect | None:
        if self.points is None:
            return self
        names = tuple(name for name in self.points if name not in held)
        return replace(self, points=names) if names else None  # type: ignore[type-var]  # as below

    def _elements(self, model: Any) -> tuple[np.ndarray, dict[str, Any]]:
        """Nodes that it acts on, and the arguments that are filled in for each."""
        held = [name for name in self.points or () if model.node(name) >= model.n_free]
        if held:
            raise SceneError(
                f"An effect on nodes can act on free points, but {self._called} has points with {quoted(held[0])}, held."
            )
        nodes = np.arange(model.n_free) if self.points is None else np.array([model.node(name) for name in self.points])
        length, area = np.zeros(model.n), np.zeros(model.n)
        if "area" in self.law.fills:
            check_diameters(model.scene.cables, self._called)
        for c, cable in enumerate(model.scene.cables):
            for ends in model.ends[model.cable_of == c].T:
                np.add.at(length, ends, 0.5 * cable.L0)
                np.add.at(area, ends, 0.5 * cable.L0 * (cable.diameter or 0.0))
        return nodes, {"mass": model.mass[nodes], "length": length[nodes], "area": area[nodes]}


class _OfSegments(_Own):
    where = "cables"
    cables: tuple[str, ...] | None
    coupled_neighbours: ClassVar[int] = 1

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        if self.cables is None:
            return self
        names = tuple(piece for name in self.cables for piece in names_left(name, pieces))
        return replace(self, cables=names) if names else None  # type: ignore[type-var]  # `_effect` makes dataclasses of them

    def _elements(self, model: Any) -> tuple[list[int], dict[str, Any]]:
        """Both nodes, segment and side of the segments that it acts on, and the arguments that are filled in for each."""
        cables = model.scene.cables if self.cables is None else [model.scene.cable(name) for name in self.cables]
        index: list[int] = []
        of: dict[str, list[Any]] = {name: [] for name in self.law.fills}
        for cable in cables:
            nodes, segments = model.nodes(cable.name), np.arange(model.n_segments)[model.segments(cable.name)]
            for i, j, s in zip(nodes[:-1], nodes[1:], segments, strict=True):
                index += [i, j, s, int(model.ends[s, 0] != i)]
            for name, values in of.items():
                if getattr(cable, name) is None:
                    raise SceneError(
                        f"The {self._called} needs the `{name}` of its cables, but cable {quoted(cable.name)} has none."
                    )
                values += cable.segments * [getattr(cable, name)]
        return index, of


def node_force(law: Callable[..., Any]) -> type[Any]:
    """Make an effect of the force on a node, law(t, q, v, ...) -> (fx, fy, fz) [N]; see the module.

    Returns
    -------
    type
        An effect whose arguments are the parameters of the law, and ``points``: names of the free points it acts on, None for
        every node that moves. The mechanical energy loses -f . v.

    Raises
    ------
    SceneError : arguments that no law of this kind has; a name that another effect has
    """
    return _effect(law, NODE_FORCE, _OfNodes)


def node_energy(law: Callable[..., Any] | None = None, *, dead: bool = False) -> Any:
    """Make an effect of the potential energy of a node, law(t, q, ...) -> E [J], f = -dE/dq; otherwise as `node_force`.

    Parameters
    ----------
    law : function
    dead : bool
        The force does not depend on the position, as weight does not: statics and steps are then as quick as with weight alone.
    """
    kind = DEAD_ENERGY if dead else NODE_ENERGY
    if law is None:  # as in @node_energy(dead=True)
        return lambda law: _effect(law, kind, _OfNodes, dead)
    return _effect(law, kind, _OfNodes, dead)


def segment_force(law: Callable[..., Any]) -> type[Any]:
    """Make an effect of the forces of a segment, law(t, q0, q1, v0, v1, ...) -> ((fx, fy, fz), (fx, fy, fz)) [N].

    Otherwise as `node_force`, with ``cables`` in place of ``points``: names of cables, None for all.
    """
    return _effect(law, SEGMENT_FORCE, _OfSegments)


def segment_energy(law: Callable[..., Any]) -> type[Any]:
    """Make an effect of the potential energy of a segment, law(t, q0, q1, ...) -> E [J]; otherwise as `segment_force`."""
    return _effect(law, SEGMENT_ENERGY, _OfSegments)


def _effect(function: Callable[..., Any], kind: Kind, base: type[Any], dead: bool = False) -> type[Any]:
    """The class of an effect, under the name of its law."""
    law, arguments = read_law(function, kind, base)
    function, name = law.function, law.function.__name__
    known = REGISTRY.classes.get(name)
    if not (known is None or (isinstance(known, type) and issubclass(known, _Own))):
        raise SceneError(f"An effect must have a name of its own, but `{name}` is that of {known}.")
    described = []
    for key in law.parameters:
        given, annotation = arguments[key].default, arguments[key].annotation
        given = tuple(given) if isinstance(given, list | np.ndarray) else given  # a dataclass takes no default that may change
        plain = float | tuple[float, ...] if annotation is inspect.Parameter.empty else annotation
        described.append((key, plain) if given is inspect.Parameter.empty else (key, plain, field(default=given)))
    described.append((base.where, tuple[str, ...] | None, field(default=None, kw_only=True)))
    namespace = {"law": law, "dead_load": dead, "__doc__": function.__doc__}
    made = make_dataclass(name, described, bases=(base,), namespace=namespace, frozen=True)
    made.__module__, made.__qualname__ = function.__module__, function.__qualname__
    REGISTRY[name] = made
    return made
