"""Scene → Model: nodes, segments and the elimination order, as the flat arrays that compiled code works on."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from . import rest_length
from .effects.axial import SWITCHES
from .effects.signatures import SLOTS, addresses
from .lanes import WIDTH
from .net import Effects, Lengths, Net, Points
from .paths import pack
from .scene import Driven, Fixed, Free, Scene


@dataclass(frozen=True, eq=False)
class Model:
    """A scene cut into nodes and segments.

    Nodes are numbered: interior nodes cable by cable, free points, fixed points, driven points; segments cable by cable,
    from the end that is eliminated first. ``cable``, ``law``, ``springs``, ``group`` and ``alone`` are the tables of `Net`.

    Parameters
    ----------
    scene : Scene
    n, n_free, n_interior, n_driven : int
        Nodes, nodes that move, interior nodes, and the number of the first driven node.
    mass : (n,) float64 [kg]
        Half of the segments on either side, and the point's own.
    cable : (n_cables, 10) int64
    law : (n_cables, 9) float64
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
    law: np.ndarray
    springs: np.ndarray
    group: np.ndarray
    alone: np.ndarray
    flipped: np.ndarray
    node_of: dict
    symbolic: Points
    effects: Effects
    lengths: Lengths

    @property
    def forces(self):
        """Effects that exert forces, in the order of ``effects``."""
        return tuple(effect for effect in self.scene.effects if not hasattr(effect, "lengths"))

    @property
    def n_segments(self):
        """Number of segments of all cables."""
        return int(self.cable[:, 1].sum())

    def _number(self, cable):
        return self.scene.cables.index(self.scene.cable(cable))

    @cached_property
    def cable_of(self):
        """(n_segments,) int64: number of each segment's cable."""
        return np.repeat(np.arange(len(self.cable)), self.cable[:, 1])

    @cached_property
    def strength(self):
        """(n_segments,) float64: tension at which each segment breaks [N], inf for never; empty if no cable breaks."""
        limits = [np.inf if cable.breaking_tension is None else cable.breaking_tension for cable in self.scene.cables]
        return np.array(limits)[self.cable_of] if np.isfinite(limits).any() else np.empty(0)

    @cached_property
    def springs_of_cables(self):
        """What the law of each cable takes as its spring, see `effects.axial`, as arrays (n_cables,), filled up with empty rows."""
        springs = [cable.springs for cable in self.scene.cables]
        rows = np.zeros((max([len(own) for own in springs] + [1]) - 1, 2, len(springs)))
        for c, own in enumerate(springs):
            rows[: len(own) - 1, :, c] = np.reshape(own[1:], (-1, 2))
        share = np.array([own[0][1] if own else 1.0 for own in springs])
        return share * self.law[:, 1], self.law[:, 3], self.law[:, 0], rows, 0, len(rows)

    @cached_property
    def ends(self):
        """(n_segments, 2) int64: nodes at both ends of each segment."""
        rows = []
        for _, count, node, start, end in self.cable[:, :5]:
            nodes = np.r_[start, node : node + count - 1, end]
            rows.append(np.column_stack([nodes[:-1], nodes[1:]]))
        return np.concatenate([*rows, np.empty((0, 2), np.int64)])

    def node(self, point):
        """Number of a point's node."""
        self.scene.point(point)
        return self.node_of[point]

    def where(self, node):
        """Name of a node: its point, or its place along its cable."""
        for name, number in self.node_of.items():
            if number == node:
                return f'point "{name}"'
        for cable in self.scene.cables:
            place = np.flatnonzero(self.nodes(cable.name) == node)
            if len(place):
                return f'node {place[0]} of {cable.segments} of cable "{cable.name}"'
        return f"node {node}"

    def nodes(self, cable):
        """(segments + 1,) int64: nodes of a cable from its start to its end."""
        c = self._number(cable)
        _, count, first, start, end = self.cable[c, :5]
        nodes = np.r_[start, first : first + count - 1, end]
        return nodes[::-1] if self.flipped[c] else nodes

    def segments(self, cable):
        """Segments of a cable from its start to its end, as a slice."""
        c = self._number(cable)
        first, count = self.cable[c, :2]
        if not self.flipped[c]:
            return slice(first, first + count)
        return slice(first + count - 1, first - 1 if first else None, -1)

    def net(self):
        """The arrays that compiled code works on, with fresh scratch space: one a run."""
        n, segments = self.n, self.n_segments
        couples = max((getattr(effect, "couples", 0) for effect in self.forces), default=0)
        heavier = any("inertia" in effect.kernels() for effect in self.forces)
        changing = len(self.lengths.cable) > 0  # then masses, laws and effects' numbers are the run's own
        effects = self.effects._replace(params=self.effects.params.copy()) if changing else self.effects
        net = Net(
            n_free=self.n_free,
            n_interior=self.n_interior,
            mass=self.mass.copy() if changing else self.mass,
            degree=np.bincount(self.ends.ravel(), minlength=n).astype(float),
            cable=self.cable,
            group=self.group,
            alone=self.alone,
            law=self.law.copy() if changing else self.law,
            springs=self.springs,
            paths=pack([point.path for point in self.scene.points if isinstance(point, Driven)]),
            n_driven=self.n_driven,
            effects=effects,
            lengths=rest_length.of_a_run(self.lengths) if changing else self.lengths,
            points=self.symbolic._replace(block=np.zeros_like(self.symbolic.block)),
            segment=np.zeros((segments, 14)),
            tension=np.zeros(segments),
            mean=np.zeros(segments),
            linearised=np.array([-1.0, 1.0, 2.0, 1.0, 0.0]),
            pull=np.zeros((n, 3)),
            kept=np.zeros((n - self.n_interior, 3)),
            right=np.zeros((n, 3)),
            diagonal=np.zeros((self.n_free, 3, 3)),
            factor=np.zeros((segments, 16)),
            border=np.zeros((segments, 16)),
            further=np.zeros((segments if couples > 1 else 0, 12)),
            carried=np.zeros((6, 4, 4)),
            step=np.zeros((n, 3)),
            middle_q=np.zeros((n, 3)),
            middle_v=np.zeros((n, 3)),
            near=np.zeros((segments if couples > 0 else 0, 2, 3, 3)),
            far=np.zeros((segments if couples > 1 else 0, 2, 3, 3)),
            added=np.zeros((self.n_free if heavier else 0, 3, 3)),
            strength=self.strength,
            observed=np.zeros(len(self.strength)),
            remembered=np.zeros(16 * len(self.strength) + 5),
            solver=_solver(couples) if couples else 0,
        ).placed()
        if changing:
            rest_length.set_lengths(net.place, 0.0, 0.0, 0.0)
        return net


@lru_cache(maxsize=8)
def build(scene):
    """Cut a scene into nodes and segments and choose the elimination order.

    Returns
    -------
    Model
    """
    n_interior = sum(cable.segments - 1 for cable in scene.cables)
    free = [point.name for point in scene.points if isinstance(point, Free)]
    links = [(cable.start, cable.end) for cable in scene.cables]
    order, later = _minimum_degree(free, links)
    fixed = [point.name for point in scene.points if isinstance(point, Fixed)]
    driven = [point.name for point in scene.points if isinstance(point, Driven)]
    node_of = {name: n_interior + i for i, name in enumerate([*order, *fixed, *driven])}
    rank = {name: i for i, name in enumerate(order)}

    n, n_free = n_interior + len(scene.points), n_interior + len(order)
    mass = np.zeros(n)
    for name in order:
        mass[node_of[name]] = scene.point(name).mass
    symbolic, block_of = _symbolic(order, later)
    cable = np.full((len(scene.cables), 10), -1, np.int64)
    law = np.zeros((len(scene.cables), 9))
    flipped = np.zeros(len(scene.cables), bool)
    segment = node = 0
    for c, one in enumerate(scene.cables):
        flipped[c] = one.start in rank and one.end not in rank
        start, end = (one.end, one.start) if flipped[c] else (one.start, one.end)
        bordered = start in rank and end in rank
        cable[c, :6] = segment, one.segments, node, node_of[start], node_of[end], bordered
        if bordered:
            cable[c, 6:8] = block_of[rank[start], rank[end]], block_of[rank[end], rank[start]]
        spring = (0.0, 0.0) if one.inextensible else (one.stiffness, one.dashpot)
        law[c, :5] = one.L0, *spring, *SWITCHES[one.compression]
        law[c, 3] = max(law[c, 3], one.EA_compression / one.EA_first)
        law[c, 6] = one.inextensible
        law[c, 8] = one.L0
        half = 0.5 * one.mass_per_length * one.L0
        mass[node : node + one.segments - 1] = 2.0 * half
        mass[[node_of[start], node_of[end]]] += half
        segment += one.segments
        node += one.segments - 1
    mobility = np.append(1.0 / mass[:n_free], np.zeros(n - n_free))
    for c, (_, count, node, start, end) in enumerate(cable[:, :5]):
        of = mobility[np.r_[start, node : node + count - 1, end]]
        law[c, 5] = law[c, 1] * (of[1:] + of[:-1]).max()
    springs = _curves(scene.cables, cable)
    group, alone = _groups(cable, law)
    model = Model(
        scene=scene,
        n=n,
        n_free=n_free,
        n_interior=n_interior,
        n_driven=n - len(driven),
        mass=mass,
        cable=cable,
        law=law,
        springs=springs,
        group=group,
        alone=alone,
        flipped=flipped,
        node_of=node_of,
        symbolic=symbolic,
        effects=None,
        lengths=None,
    )
    model = replace(model, effects=_effect_tables(model.forces, model))
    return replace(model, lengths=rest_length.table(scene, model, build.__wrapped__))


def _solver(couples):
    from .coupled import solver  # on demand: what it compiles is not asked for by most nets

    return solver(couples)


def _curves(cables, table):
    """Rows of ``springs`` of all tension-strain curves, each one once; writes where those of a cable are into the table."""
    first, rows = {(): (0, 0)}, []
    for row, one in zip(table, cables, strict=True):
        if one.springs not in first:
            first[one.springs] = len(rows), len(rows) + len(one.springs)
            rows.extend(one.springs)
        row[8:] = first[one.springs]
    return np.array(rows, float).reshape(-1, 2)


def _groups(cable, law):
    """Cables that hang on a prescribed point and are alike but for their numbers, by fours; the tables of `Net`."""
    alike = {}
    for c, (row, of) in enumerate(zip(cable, law, strict=True)):
        alike.setdefault((row[1], row[9], *of[3:5], of[6]) if row[1] > 1 and row[5] == 0 else c, []).append(c)
    fours = [cables[i : i + WIDTH] for cables in alike.values() for i in range(0, len(cables), WIDTH)]
    groups = [[*four, *[four[-1]] * (WIDTH - len(four)), len(four)] for four in fours if len(four) > 1]
    alone = sorted(four[0] for four in fours if len(four) == 1)
    return np.array(groups, np.int64).reshape(-1, WIDTH + 1), np.array(alone, np.int64)


def _minimum_degree(names, links):
    """Elimination order of the free points by least fill, and each one's later neighbours (fill included)."""
    neighbours = {name: set() for name in names}
    for a, b in links:
        if a in neighbours and b in neighbours:
            neighbours[a].add(b)
            neighbours[b].add(a)
    order, later = [], {}
    while neighbours:
        name = min(neighbours, key=lambda p: len(neighbours[p]))
        later[name] = neighbours.pop(name)
        for p in later[name]:
            neighbours[p] |= later[name]
            neighbours[p] -= {p, name}
        order.append(name)
    return order, later


def _symbolic(order, later):
    """Symbolic block LU: arrays of `Points`, and the position of each block."""
    rank = {name: i for i, name in enumerate(order)}
    block_of = {(p, p): p for p in range(len(order))}
    ahead = [sorted(rank[other] for other in later[name]) for name in order]
    for p, others in enumerate(ahead):
        for q in others:
            block_of[p, q] = len(block_of)
            block_of[q, p] = len(block_of)
    target = [[block_of[i, j] for i in others for j in others] for others in ahead]

    def flat(rows):
        return np.array([x for row in rows for x in row], np.int64)

    def starts(rows):
        return np.cumsum([0, *map(len, rows)]).astype(np.int64)

    points = Points(
        later_at=starts(ahead),
        later=flat(ahead),
        upper=flat([[block_of[p, q] for q in others] for p, others in enumerate(ahead)]),
        lower=flat([[block_of[q, p] for q in others] for p, others in enumerate(ahead)]),
        target_at=starts(target),
        target=flat(target),
        block=np.zeros((len(block_of), 3, 3)),
    )
    return points, block_of


def _effect_tables(effects, model):
    """Tables and addresses of the compiled functions of the effects present; ``model`` is complete but for them."""
    tables = [effect.table(model) for effect in effects]
    index, params = [np.asarray(i, np.int64) for i, _ in tables], [np.asarray(p, float) for _, p in tables]
    return Effects(
        address=np.array([addresses(effect) for effect in effects], np.int64).reshape(-1, len(SLOTS)),
        index=np.concatenate([*index, np.empty(0, np.int64)]),
        index_at=np.cumsum([0, *map(len, index)]).astype(np.int64),
        params=np.concatenate([*params, np.empty(0)]),
        params_at=np.cumsum([0, *map(len, params)]).astype(np.int64),
        linear=int(all(getattr(effect, "linear", False) for effect in effects)),
    )
