"""Effects of one's own: the law of one node or of one segment in plain Python makes an effect like those that come with this.

    @node_energy
    def magnet(t, q, strength, at):
        x, y, z = q[0] - at[0], q[1] - at[1], q[2] - at[2]
        return -strength / (x * x + y * y + z * z) ** 1.5

    scene = Scene(points, cables, [Gravity(), magnet(strength=2e-4, at=(0.0, 0.0, -0.9), points=["p0"])])

The law is compiled by Numba, and its derivatives by dual numbers are exact to rounding: statics and implicit steps converge as
with any other effect. Arithmetic, comparisons, branches, loops and the functions in `dual.NAMES`, of `math` or of numpy, are
understood; functions of one's own that it calls must be compiled too (``@numba.njit``). A law is compiled once a process, in a few
seconds, when the first scene that has it is built.

The name of the function is the effect's, in scene files too once the module that defines it is imported. Its first arguments are

    node_force(t, q, v)               -> force on a node (fx, fy, fz) [N]
    node_energy(t, q)                 -> potential energy of a node [J]
    segment_force(t, q0, q1, v0, v1)  -> force on either node of a segment ((fx, fy, fz), (fx, fy, fz)) [N]
    segment_energy(t, q0, q1)         -> potential energy of a segment [J]

with the time t [s], places [m] and velocities [m/s] as three numbers each; node 0 of a segment is the one towards its cable's
start. The arguments in `OF_NODES` and `OF_SEGMENTS` are filled in for each element; all others are the effect's parameters, a
number or a tuple of numbers each, with the defaults that they have there. An energy is better than the force that it gives: the
balance of a run knows it, and a run that gains energy is found out. A step of `edmc` takes the law at its middle, so that its
energy is kept to the step's second order. Methods of diffrax do not take effects of one's own.
"""

import inspect
from dataclasses import field, fields, make_dataclass
from typing import ClassVar

import numpy as np

from anet_lumped.checks import SceneError, check_number
from anet_lumped.effects import REGISTRY

from . import kernels as own_kernels
from . import law as own_law
from .law import Kind, Law, is_number, is_pair, is_vector, read_law

OF_NODES = ("mass", "length", "area")
"""Mass [kg]; unstretched length of half of its segments [m]; the same times their cables' diameters [m2]."""
OF_SEGMENTS = ("L0", "mass_per_length", "EA", "EI", "diameter", "Cdn", "Cdt", "Can", "Cat")
"""Of the segment's cable, see `Cable`; L0 is the segment's unstretched length [m]."""
SAMPLES = 3  # places at which a load that is said to be dead must be

NODE_FORCE = Kind(("t", "q", "v"), OF_NODES, "the force (fx, fy, fz) [N]", is_vector, own_kernels.of_node_force)
NODE_ENERGY = Kind(("t", "q"), OF_NODES, "one number, the energy [J]", is_number, own_kernels.of_node_energy)
SEGMENT_FORCE = Kind(
    ("t", "q0", "q1", "v0", "v1"), OF_SEGMENTS, "the forces on both nodes ((fx, fy, fz), (fx, fy, fz)) [N]", is_pair,
    own_kernels.of_segment_force,
)  # fmt: skip
SEGMENT_ENERGY = Kind(("t", "q0", "q1"), OF_SEGMENTS, "one number, the energy [J]", is_number, own_kernels.of_segment_energy)


class _Own:
    """What the effects made here share; their fields are the parameters of the law and the names of what it acts on."""

    law: ClassVar[Law]
    where: ClassVar[str]  # name of the field that says what it acts on

    def __post_init__(self):
        for name in (one.name for one in fields(self)):
            check = self._names if name == self.where else self._numbers
            object.__setattr__(self, name, check(name, getattr(self, name)))
        own_law.compiled(self.law, self._shapes)

    @property
    def _called(self):
        return f"effect {type(self).__name__}"

    @property
    def _shapes(self):
        values = (getattr(self, name) for name in self.law.parameters)
        return tuple(len(value) if isinstance(value, tuple) else 0 for value in values)

    def _names(self, name, value):
        """A tuple of names, or None."""
        if value is None:
            return None
        names = () if isinstance(value, str) else tuple(value)
        if not names or not all(isinstance(one, str) for one in names):
            raise SceneError(f"Argument `{name}` must be names or None, but {self._called} has {name}={value!r}.")
        return names

    def _numbers(self, name, value):
        """A number, or a tuple of numbers."""
        if isinstance(value, tuple | list | np.ndarray) and len(value):
            return tuple(check_number(name, x, "", self._called) for x in value)
        return check_number(name, value, "", self._called)

    def kernels(self):
        """Compiled functions, by their slot in `signatures`."""
        return own_law.kernels(self.law, self._shapes)

    def table(self, model):
        """Index and parameters for the kernels.

        Returns
        -------
        index : int64, see `own_kernels`
        params : float64
            Those of the effect; of each element what is filled in.

        Raises
        ------
        SceneError : no point or cable of that name, or a held point; a cable that lacks what the law needs; no dead load
        """
        index, of_elements = self._elements(model)
        own = [np.ravel(getattr(self, name)) for name in self.law.parameters]
        filled = [np.column_stack([of_elements[name] for name in self.law.fills]).ravel()] if self.law.fills else []
        params = np.concatenate([*own, *filled, np.empty(0)]).astype(float)
        if self.linear:
            self._check_dead(params)
        return np.asarray(index, np.int64), params

    def _check_dead(self, params):
        random, blocks, D = np.random.default_rng(0), np.zeros((0, 2, 3, 3)), np.zeros((1, 3, 3))
        for q in random.normal(size=(SAMPLES, 1, 3)):
            self.kernels()["tangent"](0.0, q, np.zeros((1, 3)), np.zeros(1, np.int64), params, 1.0, 0.0, D, blocks, blocks)
            if D.any():
                raise SceneError(
                    f"The force of a dead load must not depend on the place, but that of {self._called} does; make it without "
                    "dead=True."
                )


class _OfNodes(_Own):
    where = "points"

    def _elements(self, model):
        """Nodes that it acts on, and what is filled in of each."""
        held = [name for name in self.points or () if model.node(name) >= model.n_free]
        if held:
            raise SceneError(f'An effect on nodes can act on free points, but {self._called} has points with "{held[0]}", held.')
        nodes = np.arange(model.n_free) if self.points is None else np.array([model.node(name) for name in self.points])
        length, area = np.zeros(model.n), np.zeros(model.n)
        for c, cable in enumerate(model.scene.cables):
            if cable.diameter is None and "area" in self.law.fills:
                raise SceneError(f'The {self._called} needs the `diameter` [m] of every cable, but cable "{cable.name}" has none.')
            for ends in model.ends[model.cable_of == c].T:
                np.add.at(length, ends, 0.5 * cable.L0)
                np.add.at(area, ends, 0.5 * cable.L0 * (cable.diameter or 0.0))
        return nodes, {"mass": model.mass[nodes], "length": length[nodes], "area": area[nodes]}


class _OfSegments(_Own):
    where = "cables"
    couples: ClassVar[int] = 1

    def _elements(self, model):
        """Both nodes, segment and side of the segments that it acts on, and what is filled in of each."""
        cables = model.scene.cables if self.cables is None else [model.scene.cable(name) for name in self.cables]
        index, of = [], {name: [] for name in self.law.fills}
        for cable in cables:
            nodes, segments = model.nodes(cable.name), np.arange(model.n_segments)[model.segments(cable.name)]
            for i, j, s in zip(nodes[:-1], nodes[1:], segments, strict=True):
                index += [i, j, s, int(model.ends[s, 0] != i)]
            for name, values in of.items():
                if getattr(cable, name) is None:
                    raise SceneError(f'The {self._called} needs the `{name}` of its cables, but cable "{cable.name}" has none.')
                values += cable.segments * [getattr(cable, name)]
        return index, of


def node_force(law):
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


def node_energy(law=None, *, dead=False):
    """Make an effect of the potential energy of a node, law(t, q, ...) -> E [J], f = -dE/dq; otherwise as `node_force`.

    Parameters
    ----------
    law : function
    dead : bool
        The force does not depend on the place, as weight: statics and steps are then as quick as with weight alone.
    """
    if law is None:  # as in @node_energy(dead=True)
        return lambda law: _effect(law, NODE_ENERGY, _OfNodes, dead)
    return _effect(law, NODE_ENERGY, _OfNodes, dead)


def segment_force(law):
    """Make an effect of the forces of a segment, law(t, q0, q1, v0, v1, ...) -> ((fx, fy, fz), (fx, fy, fz)) [N].

    Otherwise as `node_force`, with ``cables`` in place of ``points``: names of cables, None for all.
    """
    return _effect(law, SEGMENT_FORCE, _OfSegments)


def segment_energy(law):
    """Make an effect of the potential energy of a segment, law(t, q0, q1, ...) -> E [J]; otherwise as `segment_force`."""
    return _effect(law, SEGMENT_ENERGY, _OfSegments)


def _effect(function, kind, base, dead=False):
    """The class of an effect, under the name of its law."""
    law, arguments = read_law(function, kind, base.where)
    function, name = law.function, law.function.__name__
    known = REGISTRY.classes.get(name)
    if not (known is None or (isinstance(known, type) and issubclass(known, _Own))):
        raise SceneError(f"An effect must have a name of its own, but `{name}` is that of {known}.")
    described = []
    for key in law.parameters:
        given, annotation = arguments[key].default, arguments[key].annotation
        plain = float | tuple[float, ...] if annotation is inspect.Parameter.empty else annotation
        described.append((key, plain) if given is inspect.Parameter.empty else (key, plain, field(default=given)))
    described.append((base.where, tuple[str, ...] | None, field(default=None, kw_only=True)))
    namespace = {"law": law, "linear": dead, "__doc__": function.__doc__}
    made = make_dataclass(name, described, bases=(base,), namespace=namespace, frozen=True)
    made.__module__, made.__qualname__ = function.__module__, function.__qualname__
    REGISTRY[name] = made
    return made
