"""Scene → Model: nodes, segments and the elimination order, as the flat arrays that compiled code works on."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from anet_lumped.checks import quoted
from anet_lumped.effects import REGISTRY
from anet_lumped.model.tables import (
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    CABLE_CURVE,
    CABLE_CURVE_END,
    CABLE_END,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CREEP_COLUMNS,
    CREEP_DAMPER,
    CREEP_FAST,
    CREEP_ORIGINAL,
    CREEP_STATIC,
)
from anet_lumped.prescribed.paths import line, pack
from anet_lumped.scene.scene import Driven, Scene

from .held import first_unheld
from .link_order import link_tables
from .net import Bodies, Effects, Lengths, Points
from .trails import trail_tables

NOWHERE = (0.0, 0.0, 0.0)


def ends_of_segments(cable):
    """(n_segments, 2) int64: nodes at both ends of each segment, of the table of cables."""
    first_segment, count, node, start, end = np.repeat(cable[:, : CABLE_END + 1], cable[:, CABLE_SEGMENTS], axis=0).T
    place = np.arange(len(count)) - first_segment  # along its cable
    return np.column_stack([np.where(place == 0, start, node + place - 1), np.where(place == count - 1, end, node + place)])


@dataclass(frozen=True, eq=False)
class Model:
    """A scene cut into nodes and segments.

    Nodes are numbered: interior nodes cable by cable, free points, points of bodies, fixed points, driven points; segments cable by
    cable, from the end that is eliminated first. ``cable``, ``axial``, ``springs``, ``cable_groups``, ``single_cables`` and
    ``single_kinds`` are the tables of `Net`.

    Parameters
    ----------
    scene : Scene
    n, n_free, n_interior, n_driven : int
        Nodes, nodes that move, interior nodes, and the number of the first driven node.
    mass : (n,) float64 [kg]
        Half of the segments on either side, and the point's own.
    cable : (n_cables, 10) int64
    axial : (n_cables, 10) float64
    springs : (rows, 2) float64
    flipped : (n_cables,) bool
        The cable is eliminated from its end to its start.
    node_of : dict
        Point name to node.
    """

    scene: Scene
    n: int
    n_free: int
    n_interior: int
    n_driven: int
    mass: np.ndarray
    cable: np.ndarray
    axial: np.ndarray
    springs: np.ndarray
    cable_groups: np.ndarray
    single_cables: np.ndarray
    single_kinds: np.ndarray
    flipped: np.ndarray
    node_of: dict
    symbolic: Points
    bodies: Bodies
    joints: Points
    effects: Effects
    lengths: Lengths

    def __repr__(self):
        return f"<Model of {self.n} nodes and {self.n_segments} segments>"

    @property
    def has_bodies(self):
        """Whether there are bodies whose motion is not prescribed."""
        return self.bodies.first < self.n_free

    @cached_property
    def forces(self):
        """Effects that exert forces, in the order of ``effects``: those of the scene, each before what it makes for its scene."""
        scene = self.scene
        all_effects = [part for one in scene.effects for part in (one, one.on_bodies(scene), one.on_shedding(scene))]
        return tuple(effect for effect in all_effects if effect is not None and effect.kernels())

    @cached_property
    def kinds_of_library(self):
        """Classes of its effects that come with the library, not those of a user's own."""
        return frozenset(type(effect) for effect in self.forces if REGISTRY.name_of(effect) in REGISTRY.library)

    @property
    def coupled_neighbours(self):
        """How many segments away effects join a node with others along its cable: 0, 1 or 2."""
        return max((effect.coupled_neighbours for effect in self.forces), default=0)

    @property
    def near_rows(self):
        """Pairs of nodes that effects may join: the ends of each segment, then the `pairs` of bodies."""
        return self.n_segments + len(self.bodies.pairs)

    @property
    def sheds(self):
        """Whether there are nodes of cables that shed vortices."""
        return len(self.effects.inner) > 0

    @cached_property
    def shedding_nodes(self):
        """(k,) int64: nodes inside the cables that shed vortices, in the order of ``effects.inner``, four numbers each."""
        return np.concatenate([np.empty(0, np.int64), *(self.nodes(one.name)[1:-1] for one in self.scene.cables if one.Cl)])

    @property
    def creeps(self):
        """Whether there are cables that creep."""
        return len(self.creep) > 0

    @cached_property
    def creep(self):
        """(n_cables, 9) float64: `Net.creep`, without rows where no cable creeps."""
        if not any(cable.creeps for cable in self.scene.cables):
            return np.zeros((0, CREEP_COLUMNS))
        table = np.zeros((len(self.scene.cables), CREEP_COLUMNS))
        for row, cable, original in zip(table, self.scene.cables, self.cable[:, CABLE_CURVE_END], strict=True):
            if cable.creeps:
                row[: CREEP_DAMPER + 1] = cable.creep
            if cable.working_curve is not None:
                working, end = original + len(cable.tension_strain), original + len(cable.working_rows)
                row[CREEP_ORIGINAL:] = original, working, end, *cable.working_curve.numbers
        return table

    @property
    def cable_of_fast_parts(self):
        """``cable`` of a motion: cables that creep have no tension-strain curve there, since kernels of their own take them."""
        cable, creeps = self.cable.copy(), self.creep[:, CREEP_STATIC] > 0.0
        cable[creeps, CABLE_CURVE_END] = cable[creeps, CABLE_CURVE]
        return cable

    @property
    def axial_of_fast_parts(self):
        """``axial`` of a motion: of cables that creep, the springs are the fast ones, and kernels of their own take them."""
        axial, creeps = self.axial.copy(), self.creep[:, CREEP_STATIC] > 0.0
        axial[creeps, AXIAL_OMEGA_SQUARED] *= self.creep[creeps, CREEP_FAST] / axial[creeps, AXIAL_STIFFNESS]
        axial[creeps, AXIAL_STIFFNESS] = self.creep[creeps, CREEP_FAST]
        axial[creeps, AXIAL_L0] = axial[creeps, AXIAL_L0_BEFORE] = np.array([cable.L0 for cable in self.scene.cables])[creeps]
        axial[creeps, AXIAL_PUSH_SHARE] = 1.0  # as of springs for which `newton_step` looks for no slack segments
        return axial

    @cached_property
    def n_segments(self):
        """Number of segments of all cables."""
        return int(self.cable[:, CABLE_SEGMENTS].sum())

    @cached_property
    def unheld(self):
        """Name of the first point that hangs on no fixed or driven one; None if all do."""
        return first_unheld(self.scene)

    @cached_property
    def nodes_found(self):
        """What `nodes` has returned, by the name of the cable."""
        return {}

    def _number(self, cable):
        self.scene.cable(cable)
        return self.scene.cable_numbers[cable]

    @cached_property
    def path_table(self):
        """`PathTable` of the driven points, then of the origin and of the rotation vector of each driven body."""
        paths = [point.path for point in self.scene.points if isinstance(point, Driven)]
        for body in self.scene.bodies:
            if body.is_driven:
                origin, turning = body.motion
                paths += [origin, line(NOWHERE, NOWHERE, 0.0) if turning is None else turning]
        return pack(paths)

    @cached_property
    def node_segments(self):
        """(n,) float64: how many segments each node has."""
        return np.bincount(self.ends.ravel(), minlength=self.n).astype(float)

    @cached_property
    def cable_of(self):
        """(n_segments,) int64: number of each segment's cable."""
        return np.repeat(np.arange(len(self.cable)), self.cable[:, CABLE_SEGMENTS])

    @cached_property
    def breaking_tension(self):
        """(n_segments,) float64: tension at which each segment breaks [N], inf for never; empty if no cable breaks."""
        limits = [np.inf if cable.breaking_tension is None else cable.breaking_tension for cable in self.scene.cables]
        if not (np.isfinite(limits).any() or self.scene.limits):
            return np.empty(0)
        strength = np.array(limits)[self.cable_of]
        for cable, segment, tension in self.scene.limits:
            at = np.arange(self.n_segments)[self.segments(cable)][segment]
            strength[at] = min(strength[at], tension)
        return strength

    @cached_property
    def trails(self):
        """`Trails` without numbers, and the cable of each number, see `trail_tables`."""
        return trail_tables(self)

    @cached_property
    def links(self):
        """`Links` of a model whose cables do not stretch."""
        return link_tables(self)

    @cached_property
    def shares_of_first_springs(self):
        """(n_cables,) float64: share of EA that the first spring of each cable's curve has; 1 without a curve."""
        return np.array([own[0][1] if own else 1.0 for own in (cable.springs for cable in self.scene.cables)])

    @cached_property
    def springs_of_cables(self):
        """What the law of each cable takes as its spring, see `effects.axial`, as arrays (n_cables,), filled up with empty rows."""
        springs = [cable.springs for cable in self.scene.cables]
        rows = np.zeros((max([len(own) for own in springs] + [1]) - 1, 2, len(springs)))
        for c, own in enumerate(springs):
            more = np.reshape(own[1:], (-1, 2))
            rows[: len(more), :, c] = more
        share = self.shares_of_first_springs
        return share * self.axial[:, AXIAL_STIFFNESS], self.axial[:, AXIAL_PUSH_SHARE], self.axial[:, AXIAL_L0], rows, 0, len(rows)

    @cached_property
    def ends(self):
        """(n_segments, 2) int64: nodes at both ends of each segment."""
        return ends_of_segments(self.cable)

    def node(self, point):
        """Number of a point's node."""
        self.scene.point(point)
        return self.node_of[point]

    def where(self, node):
        """Name of a node: its point, or its place along its cable."""
        for name, number in self.node_of.items():
            if number == node:
                return f"point {quoted(name)}"
        for cable in self.scene.cables:
            place = np.flatnonzero(self.nodes(cable.name) == node)
            if len(place):
                return f"node {place[0]} of {cable.segments} of cable {quoted(cable.name)}"
        return f"node {node}"

    def nodes(self, cable):
        """(segments + 1,) int64, not to be written to: nodes of a cable from its start to its end."""
        c = self._number(cable)
        if cable not in self.nodes_found:
            _, count, first, start, end = self.cable[c, : CABLE_END + 1]
            nodes = np.empty(count + 1, np.int64)
            nodes[0], nodes[1:-1], nodes[-1] = start, np.arange(first, first + count - 1), end
            self.nodes_found[cable] = nodes[::-1] if self.flipped[c] else nodes
            self.nodes_found[cable].flags.writeable = False
        return self.nodes_found[cable]

    def segment_run(self, c):
        """First segment of the c-th cable, and how many it has, in the order of elimination."""
        return self.cable[c, CABLE_FIRST_SEGMENT], self.cable[c, CABLE_SEGMENTS]

    def segments(self, cable):
        """Segments of a cable from its start to its end, as a slice."""
        c = self._number(cable)
        first, count = self.segment_run(c)
        if not self.flipped[c]:
            return slice(first, first + count)
        return slice(first + count - 1, first - 1 if first else None, -1)
