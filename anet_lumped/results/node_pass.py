"""Compiled: one pass over the saved nodes of a run: which of them fly, and what that does to their places.

It also tells whether tensions change by so much that displacements across the motion may grow, see `amplification`.
"""

import numpy as np
from numba import int64, void

from anet_lumped.compiled.jit import internal, kernel
from integrators.flat_view import flat

from .place_rows import (
    BETWEEN,
    END,
    FALLS,
    FIRST,
    FIRST_LOOSE,
    FLIGHT,
    FLYING,
    GROWN,
    HOLDS,
    IS_SEEN,
    OFF,
    SECOND,
    SEVERAL,
    SPEED,
    START,
    TIME,
    TOGETHER,
    UNTIL,
    place_rows_at,
)

OF_SECOND_DIFFERENCE = 0.7  # of the velocities where a segment goes slack: what the velocity that a node flies with is off by
SWAYS = 4.0  # times that a displacement becomes as large in a motion that multiplies nothing, at most
LEAST_ROWS = 64  # saved states that show swings
RESOLVED = 0.6  # sum of second differences of a tension over that of its distances from its mean, of ten states a turn at least
A_TURN = 24.0  # steps that are enough to carry a displacement through a turn of the tensions


@internal
def _hold(rows, tension, row):  # type: ignore[no-untyped-def]
    """Mark the nodes that taut segments at a row hold, those that any segment holds where there is no such row."""
    held, segments = rows.of_nodes[SPEED], rows.segments
    s = segments.shape[0]
    for i in range(held.shape[0]):
        held[i] = 0.0
    for i in range(s):
        if row < 0 or tension[row * s + i] > 0.0 or segments[i, HOLDS] != 0:
            held[segments[i, START]] = 1.0
            held[segments[i, END]] = 1.0


@internal
def _find_loose(rows):  # type: ignore[no-untyped-def]
    """A row without a slack segment has none that flies, unless it belongs to no segment at all."""
    tension, flies, numbers, held = flat(rows.tension), rows.flies, rows.numbers, rows.of_nodes[SPEED]
    k, n_free, loose, alone = flies.shape[0], flies.shape[1], 0, False
    _hold(rows, tension, -1)
    for i in range(n_free):
        alone = alone or held[i] == 0.0
    for r in range(k):
        if rows.columns[SECOND, r] == 0.0 and not alone:
            continue
        _hold(rows, tension, r)
        one = 0
        for i in range(n_free):
            if held[i] == 0.0:
                flies[r, i], one = True, 1
                if r > 0 and numbers[FIRST_LOOSE] < 0.0 and rows.nodes[i, BETWEEN] != 0:
                    numbers[FIRST_LOOSE] = r
        loose += one
    numbers[FLYING] = loose / k


@internal
def _second_difference(v, before, now, after, i, n):  # type: ignore[no-untyped-def]
    """Size of that of the vectors of a node i of n at three rows."""
    total = 0.0
    for x in range(3):
        one = v[3 * (after * n + i) + x] - 2.0 * v[3 * (now * n + i) + x] + v[3 * (before * n + i) + x]
        total += one * one
    return np.sqrt(total)


@internal
def _follow_flights(rows):  # type: ignore[no-untyped-def]
    """What lasts from the start is off by nothing, and what lies still is off by no more than it moves."""
    t, v, flies, off, grown, largest = rows.columns[TIME], flat(rows.v), rows.flies, rows.of_nodes[OFF], rows.of_nodes[GROWN], 0.0
    k, n = t.shape[0], off.shape[0]
    for i in range(n):
        off[i] = 0.0
    for r in range(k):
        for i in range(flies.shape[1]):
            if flies[r, i] and r > 0 and rows.nodes[i, SEVERAL] != 0:
                if not flies[r - 1, i]:
                    later = _second_difference(v, max(r - 1, 0), r, min(r + 1, k - 1), i, n)
                    off[i] = OF_SECOND_DIFFERENCE * max(_second_difference(v, max(r - 2, 0), r - 1, r, i, n), later)
                    grown[i] = 0.0
                if off[i] > 0.0:
                    j = 3 * (r * n + i)
                    speed = np.sqrt(v[j] * v[j] + v[j + 1] * v[j + 1] + v[j + 2] * v[j + 2])
                    grown[i] += min(off[i], speed) * (t[r] - t[r - 1])
                    largest = max(largest, grown[i])
        rows.columns[FLIGHT, r] = largest


@internal
def _pumps(tension, together, k):  # type: ignore[no-untyped-def]
    """Between how many of the first k saved times tensions count as one where a displacement may grow, 0 where none can.

    The sum of second differences over that of distances from the mean is near to (2 pi/N)^2 of x = sin(2 pi r/N): it tells how many
    saved states show a turn. Tensions of stiff cables alternate about their means, so those of two in a row count. ``together`` are
    the sums of all tensions at a row. What pushes on the mean of two rows lets a displacement grow, however short the turns are.

    The energy z K z/2 + m (dz/dt)^2/2 of a displacement grows by z (dK/dt) z/2 only, and so at no more than the largest rate at
    which the logarithm of a T/l grows. Of a spring, l grows and falls with T.
    """
    mean, apart, bent, s = 0.0, 0.0, 0.0, tension.shape[0] // together.shape[0]
    for r in range(k - 1):
        mean += (together[r] + together[r + 1]) / (k - 1)
    for r in range(k - 1):
        apart += abs(together[r] + together[r + 1] - mean)
        if r < k - 3:
            bent += abs(together[r] - together[r + 1] - together[r + 2] + together[r + 3])
    bends = bent / apart if apart > 0.0 else 0.0
    if bends > RESOLVED:
        for i in range(s * (k - 1)):
            if tension[i] + tension[i + s] < 0.0:
                return 1.0
        return 0.0
    each, logarithm = max(1, int64(2.0 * np.pi / np.sqrt(max(bends, 1e-12)) / A_TURN)), 0.0
    for r in range(each, k - 1, each):
        grown, a, b = 1.0, (r - each) * s, r * s
        for i in range(s):
            before = tension[a + i] + tension[a + s + i]
            now = tension[b + i] + tension[b + s + i]
            if before <= 0.0 or now <= 0.0:
                return float(each)
            grown = max(grown, now / before)
        logarithm += 0.5 * np.log(grown)
    return float(each) if logarithm > np.log(SWAYS) else 0.0


@kernel(void(int64))
def look_at_nodes(address):  # type: ignore[no-untyped-def]  # its signature is above
    """Write `PlaceRows.flies`, the first of `PlaceRows.columns` and the last three of `PlaceRows.numbers`."""
    rows = place_rows_at(address)
    tension, numbers, k, s = flat(rows.tension), rows.numbers, rows.columns.shape[1], rows.segments.shape[0]
    together, slack_rows, slack = rows.columns[FIRST], rows.columns[SECOND], False
    numbers[FIRST_LOOSE], numbers[FLYING] = -1.0, 0.0
    for r in range(k):
        total, slack_here = 0.0, 0.0
        for i in range(s):
            T = tension[r * s + i]
            total += T
            if T <= 0.0 and rows.segments[i, HOLDS] == 0:
                slack, slack_here = True, 1.0
        together[r], slack_rows[r] = total, slack_here
    if slack:
        _find_loose(rows)
    if slack and numbers[FALLS] > 0.0:
        _follow_flights(rows)
    until = int64(numbers[UNTIL])
    if numbers[FIRST_LOOSE] >= 0.0:
        until = min(until, int64(numbers[FIRST_LOOSE]))
    numbers[UNTIL] = until
    numbers[TOGETHER] = _pumps(tension, together, until) if numbers[IS_SEEN] > 0.0 and until >= LEAST_ROWS else 0.0
