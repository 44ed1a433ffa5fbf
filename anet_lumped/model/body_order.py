"""The points of a scene in the order of their nodes, and the place of rigid bodies in the system over the free points.

A body has two unknowns of three numbers there, how far it shifts and how far it turns. They are eliminated with the free points in
the order of least fill: bodies that carry a net before the points at which it meets.
"""

from typing import NamedTuple

import numpy as np

from anet_lumped.model.elimination_order import minimum_degree, symbolic_elimination
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
)
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

    def bodies(self, node_of, n_interior, cable):
        """`Bodies` of a scene whose points have the nodes ``node_of``."""
        free = [body for body in self.scene.bodies if not body.is_driven]
        number, rank = {body.name: b for b, body in enumerate(free)}, {name: i for i, name in enumerate(self.free)}
        nodes = [[node_of[point.name] for point in body.points] for body in free]
        counts, points = [len(own) for own in nodes], [point for body in free for point in body.points]
        heads = [(rank[body.points[0].name], rank[body.points[1].name]) for body in free]
        pinned = [_pivot(body) for body in free]
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
        return Bodies(
            first=n_interior + min((head for both in heads for head in both), default=len(self.free)),
            node_at=node_at,
            node=np.array([node for own in nodes for node in own], np.int64),
            pivot=np.array([-1 if name is None else node_of[name] for name in pinned], np.int64),
            arm=np.array([point.arm for point in points], float).reshape(-1, 3),
            blocks=np.array([(self.block_of[s, t], self.block_of[t, s]) for s, t in heads], np.int64).reshape(-1, 2),
            joined=np.array(joined, np.int64).reshape(-1, JOINED_COLUMNS),
            pairs=np.array(pairs, np.int64).reshape(-1, 3),
            arm_end=np.zeros((count, 3)),
            arm_mean=np.zeros((count, 3)),
            slowing=np.zeros((count, 3)),
            state=np.zeros((len(free), BODY_COLUMNS)),
        )


def _pivot(body):
    """Name of the point about which a body turns, or None."""
    return body.pinned if body.pinned is None else f"{body.name}.{body.pinned}" if body.pinned else body.name


def order_of_points(scene):
    """`PointOrder` of a scene."""
    free_bodies = [body for body in scene.bodies if not body.is_driven]
    joints = [point.name for point in scene.points if isinstance(point, Free)]
    heads = {body.name: tuple(point.name for point in body.points[:2]) for body in free_bodies}
    unknowns = {name: (name,) for name in joints}
    unknowns |= {point.name: heads[body.name] for body in free_bodies for point in body.points}
    pairs = [(cable.start, cable.end) for cable in scene.cables]
    links = [(u, w) for a, b in pairs for u in unknowns.get(a, ()) for w in unknowns.get(b, ()) if u != w]
    of_bodies = [name for both in heads.values() for name in both]
    names, links = [*joints, *of_bodies], [*links, *heads.values()]
    order, later = minimum_degree(names, links)
    numbered = minimum_degree(names, links, last=of_bodies)[0] if of_bodies else order
    carried = [point.name for body in free_bodies for point in body.points[2:]]
    both_move = [(a, b) for a, b in pairs if a in unknowns and b in unknowns]
    own = dict.fromkeys((a, b) for a, b in both_move if len(unknowns[a]) + len(unknowns[b]) > 2)
    symbolic, block_of = symbolic_elimination(numbered, order, later, len(carried), 2 * len(own))
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
