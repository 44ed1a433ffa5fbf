"""The points of a scene in the order of their nodes, and the place of rigid bodies in the system over the free points.

A body has two unknowns of three numbers there, how far it shifts and how far it turns. They are eliminated with the free points in
the order of least fill: bodies that carry a net before the points at which it meets. A body that is pinned to another one has a
third unknown, the force of the joint. Nothing resists a force, so that it is eliminated behind the shift of its body.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from anet_lumped.model import fronts
from anet_lumped.model.elimination_order import elimination, minimum_degree, symbolic_elimination
from anet_lumped.model.net import Bodies, Points
from anet_lumped.model.tables import (
    BODY_COLUMNS,
    JOINED_COLUMNS,
    JOINED_END,
    JOINED_END_BODY,
    JOINED_END_START,
    JOINED_START,
    JOINED_START_BODY,
    JOINED_START_END,
    JOINED_TARGETS,
    JOINT_BLOCKS,
    JOINT_BODY,
    JOINT_COLUMNS,
    JOINT_OTHER,
    JOINT_OTHER_NODE,
    JOINT_OTHER_POSITION,
    JOINT_POSITION,
    JOINT_UNKNOWN,
    JOINTED_COLUMNS,
)
from anet_lumped.scene.joints import parents_first
from anet_lumped.scene.scene import Driven, Fixed, Free, OnBody, OnDrivenBody, Scene


class PointOrder(NamedTuple):
    """Names of the points in the order of their nodes, and the system over the free ones.

    Parameters
    ----------
    free : tuple of str
        Free points; the first two points of each free body; its other points.
    fixed, driven : tuple of str
        Points on driven bodies come last.
    symbolic : Points
    blocks_of_pair : dict
        Of two moving points that a cable joins, the blocks (first, second) and (second, first).
    block_of : dict
        Blocks of the unknowns, by their numbers.
    scene : Scene
    """

    free: tuple[str, ...]
    fixed: tuple[str, ...]
    driven: tuple[str, ...]
    symbolic: Points
    blocks_of_pair: dict
    block_of: dict
    scene: Scene

    def bodies(self, node_of, n_interior):
        """`Bodies` of a scene whose points have the nodes ``node_of``, and the `Points` of the system over their joints."""
        free = free_bodies(self.scene)
        number, rank = {body.name: b for b, body in enumerate(free)}, {name: i for i, name in enumerate(self.free)}
        nodes = [[node_of[point.name] for point in body.points] for body in free]
        counts, points = [len(own) for own in nodes], [point for body in free for point in body.points]
        heads = [(rank[body.points[0].name], rank[body.points[1].name]) for body in free]
        pinned = [None if body.is_jointed else body.pivot for body in free]
        joined = []
        for (first, second), (there, back) in self.blocks_of_pair.items():
            ends = [self.scene.point(name) for name in (first, second)]
            of = [number[end.body] if isinstance(end, OnBody) else -1 for end in ends]
            if max(of) < 0:
                continue
            unknowns = [heads[b] if b >= 0 else (rank[end.name],) for b, end in zip(of, ends, strict=True)]
            row = np.full(JOINED_COLUMNS, -1)
            row[JOINED_START], row[JOINED_END] = node_of[first], node_of[second]
            row[JOINED_START_BODY], row[JOINED_END_BODY] = of
            row[JOINED_START_END], row[JOINED_END_START] = there, back
            for i, u in enumerate(unknowns[0]):
                for j, w in enumerate(unknowns[1]):
                    row[JOINED_TARGETS + 2 * i + j] = self.block_of[u, w]
                    row[JOINED_TARGETS + 4 + 2 * j + i] = self.block_of[w, u]
            joined.append(row)
        node_at = np.cumsum([0, *counts]).astype(np.int64)
        pairs = [(b, node_at[b] + i, node_at[b] + j) for b, body in enumerate(free) for i, j in body.pairs]
        count = len(points)
        joints = _joints(free, node_of, node_at, rank, self.block_of)
        symbolic, pairs_of_joints = _joint_order(joints)
        found = Bodies(
            first=n_interior + len(self.scene.free_points),
            node_at=node_at,
            node=np.array([node for own in nodes for node in own], np.int64),
            pivot=np.array([-1 if name is None else node_of[name] for name in pinned], np.int64),
            arm=np.array([point.arm for point in points], float).reshape(-1, 3),
            blocks=np.array([(self.block_of[s, t], self.block_of[t, s]) for s, t in heads], np.int64).reshape(-1, 2),
            joined=np.array(joined, np.int64).reshape(-1, JOINED_COLUMNS),
            pairs=np.array(pairs, np.int64).reshape(-1, 3),
            joint=joints,
            joint_pairs=pairs_of_joints,
            arm_end=np.zeros((count, 3)),
            arm_mean=np.zeros((count, 3)),
            slowing=np.zeros((count, 3)),
            state=np.zeros((len(free), BODY_COLUMNS)),
            jointed=np.zeros((len(free) if len(joints) else 0, JOINTED_COLUMNS)),
            joint_gap=np.zeros((len(joints), 3)),
            joint_force=np.zeros((len(joints), 3)),
        )
        return found, symbolic


def free_bodies(scene):
    """The bodies that move by themselves, in the order of their tables: each behind the body to which it is pinned."""
    return [body for body in parents_first(scene.bodies) if not body.is_driven]


def _joints(free, node_of, node_at, rank, block_of):
    """`Bodies.joint` of the bodies that are pinned to points."""
    number, rows = {point.name: b for b, body in enumerate(free) for point in body.points}, []
    position = {point.name: node_at[b] + k for b, body in enumerate(free) for k, point in enumerate(body.points)}
    for b, body in enumerate(free):
        if not body.is_jointed:
            continue
        row, other = np.full(JOINT_COLUMNS, -1), number.get(body.pinned_to, -1)
        row[JOINT_BODY], row[JOINT_OTHER] = b, other
        row[JOINT_POSITION], row[JOINT_OTHER_POSITION] = position[body.pivot], position.get(body.pinned_to, -1)
        row[JOINT_OTHER_NODE], row[JOINT_UNKNOWN] = node_of[body.pinned_to], node_of[body.points[2].name]
        force = rank[body.points[2].name]
        for k, one in enumerate((b, other)):
            if one >= 0:
                shift, turn = (rank[point.name] for point in free[one].points[:2])
                at = JOINT_BLOCKS + 4 * k
                row[at : at + 4] = block_of[force, shift], block_of[shift, force], block_of[force, turn], block_of[turn, force]
        rows.append(row)
    return np.array(rows, np.int64).reshape(-1, JOINT_COLUMNS)


def _joint_order(joints):
    """`Points` of the system over the forces of joints, and the pairs of joints at one body with the blocks between them."""
    names = range(len(joints))
    own = [{int(b) for b in row[[JOINT_BODY, JOINT_OTHER]] if b >= 0} for row in joints]
    at_body = {}
    for j, bodies in enumerate(own):
        for b in bodies:
            at_body.setdefault(b, []).append(j)
    links = [pair for meeting in at_body.values() for pair in combinations(meeting, 2)]
    order, later = minimum_degree(names, links)
    symbolic, block_of = symbolic_elimination(names, order, later)
    return symbolic, np.array([(j, k, block_of[j, k], block_of[k, j]) for j, k in links], np.int64).reshape(-1, 4)


def order_of_points(scene):
    """`PointOrder` of a scene."""
    free = free_bodies(scene)
    joints = [point.name for point in scene.points if isinstance(point, Free)]
    heads = {body.name: tuple(point.name for point in body.points[:2]) for body in free}
    unknowns = {name: (name,) for name in joints}
    unknowns |= {point.name: heads[body.name] for body in free for point in body.points}
    pairs = [(cable.start, cable.end) for cable in scene.cables]
    links = [(u, w) for a, b in pairs for u in unknowns.get(a, ()) for w in unknowns.get(b, ()) if u != w]
    forces = {body.points[2].name: body for body in free if body.is_jointed}
    of_bodies = [*(name for both in heads.values() for name in both), *forces]
    links = [*links, *heads.values()]
    for force, body in forces.items():
        links += [(force, unknown) for name in (body.name, body.pinned_to) for unknown in unknowns.get(name, ())]
    names, after = [*joints, *of_bodies], {force: heads[body.name][0] for force, body in forces.items()}
    by_fronts = len(names) >= fronts.MANY
    numbered, order, later = elimination(names, links, of_bodies, after, by_fronts)
    carried = [point.name for body in free for point in body.points[2:] if point.name not in forces]
    both_move = [(a, b) for a, b in pairs if a in unknowns and b in unknowns]
    own = dict.fromkeys((a, b) for a, b in both_move if len(unknowns[a]) + len(unknowns[b]) > 2)
    symbolic, block_of = symbolic_elimination(numbered, order, later, len(carried), 2 * len(own), by_fronts)
    rank, behind = {name: i for i, name in enumerate(numbered)}, len(symbolic.block) - 2 * len(own)
    blocks_of_pair = {}
    for a, b in both_move:
        if (a, b) not in own:
            blocks_of_pair[a, b] = block_of[rank[a], rank[b]], block_of[rank[b], rank[a]]
        elif (a, b) not in blocks_of_pair:
            blocks_of_pair[a, b] = behind, behind + 1
            behind += 2
    fixed = [point.name for point in scene.points if isinstance(point, Fixed)]
    driven = [point.name for point in scene.points if isinstance(point, Driven)]
    driven += [point.name for point in scene.all_points if isinstance(point, OnDrivenBody)]
    return PointOrder((*numbered, *carried), tuple(fixed), tuple(driven), symbolic, blocks_of_pair, block_of, scene)
