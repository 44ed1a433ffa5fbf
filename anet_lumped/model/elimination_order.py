"""The order in which free points are eliminated, and the pattern of blocks that this fills."""

from heapq import heapify, heappop, heappush

import numpy as np

from anet_lumped.model.net import Points


def minimum_degree(names, links, last=(), after=()):
    """Elimination order of the free points by least fill, and each one's later neighbours (fill included).

    Those in ``last`` come after all others, and each in the dict ``after`` behind the neighbour that this names. Of points with
    equally many neighbours the first of ``names`` comes first. A heap holds for each point how many neighbours it had at any time;
    entries that have been overtaken are passed over.
    """
    neighbours = {name: set() for name in names}
    for a, b in links:
        if a in neighbours and b in neighbours:
            neighbours[a].add(b)
            neighbours[b].add(a)
    rank, last, after = {name: i for i, name in enumerate(neighbours)}, set(last), dict(after)
    entries = [(name in last, len(others), rank[name], name) for name, others in neighbours.items()]
    heapify(entries)
    order, later = [], {}
    while neighbours:
        _, degree, _, name = heappop(entries)
        if name not in neighbours or len(neighbours[name]) != degree or after.get(name) in neighbours:
            continue  # one that waits for a neighbour has a new entry when that is eliminated
        later[name] = neighbours.pop(name)
        for p in later[name]:
            neighbours[p] |= later[name]
            neighbours[p] -= {p, name}
            heappush(entries, (p in last, len(neighbours[p]), rank[p], p))
        order.append(name)
    return order, later


def symbolic_elimination(names, order, later, carried=0, more=0):
    """Symbolic block LU: arrays of `Points`, and the position of each block.

    The points are numbered as in ``names`` and eliminated in ``order``. Room is left for the blocks of ``carried`` nodes behind
    those of the points, and for ``more`` blocks at the end.
    """
    rank = {name: i for i, name in enumerate(names)}
    block_of, behind = {(p, p): p for p in range(len(order))}, len(order) + carried
    turns = [rank[name] for name in order]
    ahead = [sorted(rank[other] for other in later[name]) for name in order]
    for p, others in zip(turns, ahead, strict=True):
        for q in others:
            block_of[p, q], block_of[q, p] = behind, behind + 1
            behind += 2
    target = [[block_of[i, j] for i in others for j in others] for others in ahead]

    def flat(rows):
        return np.array([x for row in rows for x in row], np.int64)

    def starts(rows):
        return np.cumsum([0, *map(len, rows)]).astype(np.int64)

    points = Points(
        order=np.array(turns, np.int64),
        later_at=starts(ahead),
        later=flat(ahead),
        upper=flat([[block_of[p, q] for q in others] for p, others in zip(turns, ahead, strict=True)]),
        lower=flat([[block_of[q, p] for q in others] for p, others in zip(turns, ahead, strict=True)]),
        target_at=starts(target),
        target=flat(target),
        block=np.zeros((behind + more, 3, 3)),
    )
    return points, block_of
