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

from anet_lumped.model.tables import CABLE_END, CABLE_FIRST_NODE, CABLE_START

from .buckling import buckling_exponents, first_buckled

MULTIPLIED = 50.0  # times the error that a run tells of a motion that goes loose, or buckles: what it may be at least
LARGEST_EXPONENT = 300.0  # of which the exponential is a number
WITHIN = 4.0  # times an error that is told, which most are within
OF_SECOND_DIFFERENCE = 0.7  # of the velocities where a segment goes slack: what the velocity that a node flies with is off by


def loose(run: Any) -> np.ndarray:
    """Which free nodes have no taut segment at each saved time, (k, n_free) bool.

    A segment that pushes (compression="linear") holds its nodes as a taut one does.
    """
    model, k = run.model, len(run.t)
    if not _any_slack(run):
        return np.zeros((k, model.n_free), bool)
    held, taut = np.zeros((k, model.n), bool), run.segment_tension > 0.0
    for c, cable in enumerate(run.scene.cables):
        first, count = model.segment_run(c)
        if cable.compression == "linear":
            taut[:, first : first + count] = True
        node, start, end = model.cable[c, CABLE_FIRST_NODE], model.cable[c, CABLE_START], model.cable[c, CABLE_END]
        of_cable = taut[:, first : first + count]
        held[:, node : node + count - 1] |= of_cable[:, :-1] | of_cable[:, 1:]
        held[:, start] |= of_cable[:, 0]
        held[:, end] |= of_cable[:, -1]
    return ~held[:, : model.n_free]


def _any_slack(run: Any) -> bool:
    """Whether a segment that cannot push is slack at a saved time: far less work than to find which nodes are loose."""
    slack = (run.segment_tension <= 0.0).any(axis=0)
    if not slack.any():
        return False
    return any(slack[run.model.segments(cable.name)].any() for cable in run.scene.cables if cable.compression != "linear")


def goes_loose(run: Any) -> bool:
    """Whether a node between several segments has none that is taut at a saved time after the start."""
    return first_loose(run) is not None


def first_loose(run: Any) -> float | None:
    """First saved time after the start at which a node between several segments has none that is taut [s]; None: never.

    The end of a cable of several segments counts as one.
    """
    return first_of(run, loose(run)) if _any_slack(run) else None


def first_of(run: Any, flies: np.ndarray) -> float | None:
    """As `first_loose`, of what is `loose`."""
    if not flies.any():
        return None
    model = run.model
    between = np.bincount(model.ends.ravel(), minlength=model.n)[: model.n_free] > 1
    found = np.flatnonzero((flies & (between | _of_several_segments(run)))[1:].any(axis=1))
    return float(run.t[1 + found[0]]) if len(found) else None


def multiplied(run: Any) -> float:
    """Times the errors told of places that they may be, as far as nodes go: 1, or what looseness and buckling make of them."""
    if not run.error_estimate or not (goes_loose(run) or first_buckled(run) is not None):
        return 1.0
    times = min(longest_way(run) / run.error_estimate, times_at_most(run))
    return times if times > WITHIN else 1.0


def longest_way(run: Any) -> float:
    """Longest way that a node has gone from its first position, along an axis [m]."""
    return float(max((run.q.max(axis=0) - run.q[0]).max(), (run.q[0] - run.q.min(axis=0)).max()))


def times_at_most(run: Any) -> float:
    """Times the errors told of a motion that goes loose or buckles that they may be, `MULTIPLIED` or more as buckling does."""
    return max(MULTIPLIED, math.exp(min(buckling_exponents(run)[-1], LARGEST_EXPONENT)))


def _falls(scene: Any) -> bool:
    """Whether nothing but gravity acts on nodes."""
    return all(effect.dead_load and any(effect.uniform_acceleration) for effect in scene.effects)


def _of_several_segments(run: Any) -> np.ndarray:
    """Which free nodes belong to a cable of several segments, (n_free,) bool."""
    several = np.zeros(run.model.n, bool)
    for cable in run.scene.cables:
        several[run.model.nodes(cable.name)] |= cable.segments > 1
    return several[: run.model.n_free]


def flight_errors(run: Any, flies: np.ndarray) -> np.ndarray:
    """Largest error that a flight has led to up to each saved time, where nothing but gravity acts.

    Parameters
    ----------
    run : Run
    flies : (k, n_free) bool, of `loose`

    Returns
    -------
    error : (k,) float64 [m]
    """
    errors, k = np.zeros(len(run.t)), len(run.t)
    if k < 2 or not flies.any() or not _falls(run.scene):
        return errors
    # one flight after the other, and of those no more that last from the start: they are off by nothing
    flat = np.flatnonzero(np.ascontiguousarray((flies & _of_several_segments(run)).T))
    begins = np.append(True, (flat[1:] != flat[:-1] + 1) | (flat[1:] % k == 0))[: len(flat)]
    flight, first = np.cumsum(begins) - 1, flat[begins] % k
    if not first.any():
        return errors
    if not first.all():
        counts = first[flight] > 0
        flat, begins = flat[counts], begins[counts]
        flight, first = np.cumsum(begins) - 1, first[first > 0]
    node, row = np.divmod(flat, k)
    off = OF_SECOND_DIFFERENCE * _changes(run.v, first, node[begins])
    speed = _sizes(run.v[row, node])  # a node that lies still is off by nothing
    grown = np.cumsum(np.minimum(off[flight], speed) * np.diff(run.t)[row - 1])
    before = np.append(0.0, grown)[np.flatnonzero(begins)]
    np.maximum.at(errors, row, grown - before[flight])
    return np.maximum.accumulate(errors)


def _sizes(vectors: np.ndarray) -> np.ndarray:
    """Of vectors (m, 3), (m,)."""
    return np.sqrt(np.einsum("ij,ij->i", vectors, vectors))


def _changes(v: np.ndarray, row: np.ndarray, node: np.ndarray) -> np.ndarray:
    """Larger one of the second differences of velocities (k, n, 3) at rows of nodes and at the rows before them, (m,) [m/s].

    The force on a node ends between the row before its flight and the first one of it.
    """
    earlier, before, now, after = (v[np.clip(row + n, 0, len(v) - 1), node] for n in (-2, -1, 0, 1))
    return np.maximum(_sizes(after - 2.0 * now + before), _sizes(now - 2.0 * before + earlier))
