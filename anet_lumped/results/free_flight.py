"""Nodes that nothing holds: which of them fly, and how far the error of a velocity takes them while they do.

Where the last taut segment at a node goes slack, its force ends within a step. What the step leaves out of the velocity is of the
size of the second difference of the velocities there. A node that is held swings about its place with that; one that flies keeps
it, so that its error grows with the time of its flight. A weight on one segment leaves with the speed that the energy gives it,
which `edmc` keeps; so only nodes of cables of several segments count, whose vibrations share the energy out.

Errors of nodes that fly between several segments, of one cable or of more, are multiplied where these catch them, as those of a
ball between walls.
"""

import math
from typing import Any

import numpy as np

from .amplification import is_hardly_seen
from .buckling import buckling_exponents, first_buckled
from .lost_vibrations import said_sway
from .place_rows import FIRST_LOOSE, FLIGHT
from .saved_motion import LARGEST_EXPONENT, look_at

MULTIPLIED = 50.0  # times the error that a run tells of a motion that goes loose, or buckles: what it may be at least
WITHIN = 4.0  # times an error that is told, which most are within


def loose(run: Any) -> np.ndarray:
    """Which free nodes have no taut segment at each saved time, (k, n_free) bool.

    A segment that pushes (compression="linear") holds its nodes as a taut one does.
    """
    return look_at(run).rows.flies


def goes_loose(run: Any) -> bool:
    """Whether a node between several segments has none that is taut at a saved time after the start."""
    return first_loose(run) is not None


def first_loose(run: Any) -> float | None:
    """First saved time after the start at which a node between several segments has none that is taut [s]; None: never.

    The end of a cable of several segments counts as one.
    """
    if run.segment_tension.min(initial=1.0) > 0.0:  # so that nothing is compiled for what stays taut
        return None
    row = int(look_at(run).rows.numbers[FIRST_LOOSE])
    return float(run.t[row]) if row > 0 else None


def multiplied(run: Any) -> float:
    """Times the errors told of places that they may be, as far as nodes go: 1, or what looseness and buckling make of them.

    Or what they are with the sway that nodes could have by vibrations which the method took (`lost_vibrations`), if that is more.
    """
    if not run.error_estimate:
        return 1.0
    times = said_sway(run) / run.error_estimate
    if goes_loose(run) or first_buckled(run) is not None or is_hardly_seen(run):
        times = max(times, times_at_most(run))
    times = min(longest_way(run) / run.error_estimate, times)
    return times if times > WITHIN else 1.0


def longest_way(run: Any) -> float:
    """Longest way that a node has gone from its first position, along an axis [m]."""
    return float(max((run.q.max(axis=0) - run.q[0]).max(), (run.q[0] - run.q.min(axis=0)).max()))


def times_at_most(run: Any) -> float:
    """Times the errors told of a motion that goes loose or buckles that they may be, `MULTIPLIED` or more as buckling does."""
    return max(MULTIPLIED, math.exp(min(buckling_exponents(run)[-1], LARGEST_EXPONENT)))


def flight_errors(run: Any) -> np.ndarray:
    """Largest error that a flight has led to up to each saved time, where nothing but gravity acts, (k,) [m]."""
    return look_at(run).rows.columns[FLIGHT]
