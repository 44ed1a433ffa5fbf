"""The symbolic part of the elimination of many free points: in which order, and in which dense matrices, called fronts.

The multifrontal method (Duff and Reid, ACM Trans. Math. Software 9, 1983; Liu, SIAM Review 34, 1992). Points that are eliminated
one after the other and see nearly the same later neighbours share a front: the dense matrix of these points, its pivots, and of
their later neighbours, its rows. When the pivots of a front are eliminated, what is left of it is added to the front behind it.
"""

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from anet_lumped.compiled.lanes import WIDTH
from anet_lumped.model.net import Fronts
from anet_lumped.model.tables import (
    FRONT_COLUMNS,
    FRONT_FIRST_ENTRY,
    FRONT_FIRST_FACTOR,
    FRONT_FIRST_IN_SUBTREE,
    FRONT_FIRST_POINT,
    FRONT_PIVOTS,
    FRONT_ROWS,
    FRONT_WAITING_AT,
)

# Free points from which on fronts are the faster way. On square nets of 196, 400 and 900 points they take 0.8, 0.6 and 0.4 of the
# time of blocks one by one; on 3,600 points an eighth of SuperLU's.
MANY = 200
FEW_PIVOTS = 3  # fronts of up to so many pivots are one with the front behind them
ZEROS = 0.2  # fill that a merged front may hold beyond that of its parts, relative to theirs


def least_fill_order(names, links):
    """Elimination order of many points by multiple minimum degree, as SciPy's SuperLU finds it."""
    rank = {name: i for i, name in enumerate(names)}
    pairs = np.array([(rank[a], rank[b]) for a, b in links if a in rank and b in rank], np.int64).reshape(-1, 2)
    count, (a, b) = len(rank), pairs.T
    values = np.append(np.full(2 * len(pairs), -1.0), np.full(count, 1.0 + 2 * len(pairs)))  # any numbers with large pivots
    rows, columns = np.concatenate([a, b, np.arange(count)]), np.concatenate([b, a, np.arange(count)])
    matrix = csc_array((values, (rows, columns)), shape=(count, count))
    found = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    names = list(names)
    return [names[i] for i in np.argsort(found.perm_c)]


def symbolic_fronts(order, later, block_of):
    """`Fronts` of points that are eliminated in a given order.

    Parameters
    ----------
    order : list of int
        Numbers of the points.
    later : list of lists of int
        For each of them in this order, the numbers of its neighbours that are eliminated after it.
    block_of : dict
        Block of a pair of numbers, of neighbours.

    Returns
    -------
    Fronts
        With room for the numbers of a run.
    """
    turn = {number: i for i, number in enumerate(order)}
    later = [[turn[number] for number in numbers] for numbers in later]
    pivots, rows, children, roots = _merged(*_filled(later))
    fronts = _children_first(children, roots)
    position = {p: f for f, p in enumerate(fronts)}
    table, entries, points, in_parent = np.zeros((len(fronts), FRONT_COLUMNS), np.int64), [], [], []
    parent = {child: p for p in fronts for child in children[p]}
    own = {p: {point: i for i, point in enumerate([*pivots[p], *sorted(rows[p])])} for p in fronts}
    factors = waiting = most_waiting = largest = 0
    for f, p in enumerate(fronts):
        place, n_pivots, n_rows = own[p], len(pivots[p]), len(rows[p])
        size = 3 * (n_pivots + n_rows)
        waiting -= sum(_left(rows[child]) for child in children[p])
        row = table[f]
        row[FRONT_PIVOTS], row[FRONT_ROWS], row[FRONT_FIRST_POINT], row[FRONT_FIRST_ENTRY] = (
            n_pivots,
            n_rows,
            len(points),
            len(entries),
        )
        row[FRONT_FIRST_FACTOR], row[FRONT_WAITING_AT] = factors, waiting
        row[FRONT_FIRST_IN_SUBTREE] = min([f, *(table[position[child], FRONT_FIRST_IN_SUBTREE] for child in children[p])])
        for pivot in pivots[p]:
            pairs = [(pivot, pivot), *((pivot, other) for other in later[pivot]), *((other, pivot) for other in later[pivot])]
            entries += [(block_of[order[i], order[j]], place[i], place[j]) for i, j in pairs]
        points += [order[i] for i in place]
        in_parent += [-1] * n_pivots + [own[parent[p]][point] for point in sorted(rows[p])]
        factors += 3 * n_pivots * (size + WIDTH)
        waiting += _left(rows[p])
        most_waiting, largest = max(most_waiting, waiting), max(largest, size)
    return Fronts(
        front=table,
        entry=np.array(entries, np.int64).reshape(-1, 3),
        point=np.array(points, np.int64),
        in_parent=np.array(in_parent, np.int64),
        factor=np.zeros(factors),
        dense=np.zeros(largest * (largest + WIDTH)),
        waiting=np.zeros(most_waiting),
    )


def _left(rows):
    """Numbers that a front with these rows leaves: a square matrix and its right side."""
    return 3 * len(rows) * (3 * len(rows) + 1)


def _filled(later):
    """Later neighbours of each point with the fill, and the points whose first later neighbour it is."""
    filled, children = [set(of) for of in later], [[] for _ in later]
    for p, own in enumerate(filled):
        for child in children[p]:
            own |= filled[child]
        own.discard(p)
        if own:
            children[min(own)].append(p)
    return filled, children


def _merged(filled, children):
    """Fronts, named by their last pivot: pivots in order, rows, the fronts that are added to each, and those added to none."""
    pivots, rows, added = {}, {}, {}
    for p, own in enumerate(filled):
        mine, kept = [p], []
        for child in sorted(children[p], key=lambda c: -len(pivots[c])):
            count, seen = len(pivots[child]), len(rows[child])
            if count + len(mine) <= FEW_PIVOTS or len(mine) + len(own) - seen <= ZEROS * (count + seen):
                mine += pivots.pop(child)
                kept += added.pop(child)
                del rows[child]
            else:
                kept.append(child)
        pivots[p], rows[p], added[p] = sorted(mine), own, kept
    return pivots, rows, added, [p for p in pivots if not rows[p]]


def _children_first(children, roots):
    """The fronts in an order in which those that are added to a front stand before it, the last of them right before it."""
    order, open_fronts = [], list(roots)
    while open_fronts:  # the front before its children, from the last front to the first
        p = open_fronts.pop()
        order.append(p)
        open_fronts += children[p]
    return order[::-1]
