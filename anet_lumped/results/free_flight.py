"""Nodes that nothing holds: which of them fly, and how far the error of a velocity takes them while they do.

Where the last taut segment at a node goes slack, its force ends within a step. What the step leaves out of the velocity is of the
size of the second difference of the velocities there. A node that is held swings about its place with that; one that flies keeps
it, so that its error grows with the time of its flight. A weight on one segment leaves with the speed that the energy gives it,
which `edmc` keeps; so only nodes of cables of several segments count, whose vibrations share the energy out.
"""

import math
from typing import Any

import numpy as np

from .buckling import buckling_exponents, first_buckled

MULTIPLIED = 50.0  # times the error that a run tells of a motion that goes loose, or buckles: what it may be at least
LARGEST_EXPONENT = 300.0  # of which the exponential is a number
WITHIN = 4.0  # times an error that is told, which most are within
OF_SECOND_DIFFERENCE = 0.7  # of the velocities where a segment goes slack: what the velocity that a node flies with is off by


def loose(run: Any) -> np.ndarray:
    """Which free nodes have no taut segment at each saved time, (k, n_free) bool.

    A segment that pushes (compression="linear") holds its nodes as a taut one does.
    """
    model = run.model
    held = np.zeros((len(run.t), model.n), bool)
    for cable in run.scene.cables:
        taut = np.ones((len(run.t), cable.segments), bool) if cable.compression == "linear" else run.tension(cable.name) > 0.0
        nodes = model.nodes(cable.name)
        held[:, nodes[:-1]] |= taut
        held[:, nodes[1:]] |= taut
    return ~held[:, : model.n_free]


def goes_loose(run: Any) -> bool:
    """Whether a node of a cable of several segments has none that is taut at a saved time after the start."""
    return first_loose(run) is not None


def first_loose(run: Any) -> float | None:
    """First saved time after the start at which a node of a cable of several segments has none that is taut [s]; None: never."""
    pulls_only = [cable.name for cable in run.scene.cables if cable.compression != "linear"]
    if not any((run.tension(name)[1:] <= 0.0).any() for name in pulls_only):  # a small part of the time of what follows
        return None
    found = np.flatnonzero((loose(run) & _of_several_segments(run))[1:].any(axis=1))
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
    flies = flies & _of_several_segments(run)
    if len(run.t) < 2 or not flies.any() or not _falls(run.scene):
        return np.zeros(len(run.t))
    v = run.v[:, : run.model.n_free]
    second = np.linalg.norm(np.diff(np.concatenate([v[:1], v, v[-1:]]), 2, axis=0), axis=2)
    second[1:] = np.maximum(second[1:], second[:-1])  # the force ends between the row before and this one
    begins = np.zeros_like(flies)
    begins[1:] = flies[1:] & ~flies[:-1]
    row = np.maximum.accumulate(np.where(begins, np.arange(len(run.t))[:, None], 0), axis=0)  # where the flight began; 0: never
    off = np.where(flies & (row > 0), OF_SECOND_DIFFERENCE * np.take_along_axis(second, row, axis=0), 0.0)
    off = np.minimum(off, np.linalg.norm(v, axis=2))  # a node that lies still is off by nothing
    grown = np.cumsum(off * np.diff(run.t, prepend=run.t[0])[:, None], axis=0)
    before = np.take_along_axis(grown, np.maximum(row - 1, 0), axis=0)
    return np.maximum.accumulate(np.where(flies, grown - before, 0.0).max(axis=1))
