"""How many times a motion multiplies small errors while its cables stay taut, as their tensions tell.

A force T along a segment of the length l holds its ends across it with the stiffness T/l. So a small displacement z across the
motion, such as that of a net which swings in a plane a little out of it, obeys

    m_i d2z_i/dt2 = sum of (T/l) (z_j - z_i) over the segments between i and j .

This is exact across a plane motion, since no length changes to first order. With tensions that do not change, z swings and stays as
small as it is. Tensions that go up and down with the swings pump it, as a child does a swing: nets and cables that swing far for a
long time, or that are shaken, multiply every error by exp(rate t), and the motion is chaotic. `carry_across` carries a displacement
along with the tensions of a run, through some tens of steps in each of their turns. What it grows by beyond `SWAYS` times counts as
what the motion multiplies its errors by; up to that a displacement grows as its nodes share it out, and as T^(-1/4) where tensions
change slowly. The energy z K z/2 + sum of m (dz/dt)^2/2 of a displacement grows at no more than the rate at which the T/l do: where
that is less than `SWAYS` times, nothing is carried along.

Nodes that are loose, and cables that buckle, multiply errors in other ways, see `free_flight` and `buckling`; so from the first
such time on no more growth counts. Nor is it looked for where effects couple more than neighbours or nodes are those of bodies, nor
where a run saves its states too seldom to show how its tensions change.

Source: parametric resonance, Landau & Lifshitz, Mechanics, 1976, section 27; the power -1/4 is that of an adiabatic invariant,
section 49.
"""

import math
from typing import Any

import numpy as np
from scipy.ndimage import maximum_filter1d

from anet_lumped.model.tables import CABLE_END, CABLE_FIRST_NODE, CABLE_START

from .buckling import BENDS, first_buckled
from .energy_balance import SWINGS
from .free_flight import first_loose, first_of

SWAYS = 4.0  # times that a displacement becomes as large in a motion that multiplies nothing, at most
LEAST_ROWS = 64  # saved states that show swings
SEEN = 1e-5  # of the longest cable: less error than that may grow unseen
RESOLVED = 0.6  # sum of second differences of a tension over that of its distances from its mean, of ten states a turn at least
A_TURN = 24.0  # steps that are enough to carry a displacement through a turn of the tensions


def amplification(run: Any, flies: np.ndarray | None = None) -> np.ndarray:
    """Logarithm of the times by which the motion has multiplied its first errors up to each saved time, (k,), never falling.

    An error that is made at the row a is multiplied exp(x[b] - x[a]) times up to the row b. ``flies`` (k, n_free) bool is what is
    `loose`, if that is known.
    """
    grown = np.zeros(len(run.t))
    if len(run.t) < LEAST_ROWS or not _is_seen(run):
        return grown
    rows = _rows_before_it_is_loose(run, flies)
    if rows < LEAST_ROWS:
        return grown
    tension = np.ascontiguousarray(run.segment_tension[:rows])
    bends = _bends(tension)
    if bends > RESOLVED:
        return grown
    together = max(1, int(2.0 * np.pi / np.sqrt(max(bends, 1e-12)) / A_TURN))
    if _pumped_at_most(tension, together) <= np.log(SWAYS):
        return grown
    size = maximum_filter1d(_carried(run, tension, together), 2 * max(1, rows // SWINGS) + 1, mode="nearest")
    grown[:rows] = np.maximum.accumulate(np.maximum(size - np.minimum.accumulate(size) - np.log(SWAYS), 0.0))
    grown[rows:] = grown[rows - 1]
    return grown


def _is_seen(run: Any) -> bool:
    """Whether the run has an error that is worth looking at, and no more across it than tensions."""
    plain = not run.model.has_bodies and all(effect.coupled_neighbours < BENDS for effect in run.scene.effects)
    return plain and run.error_growth[-1] > SEEN * max(cable.length for cable in run.scene.cables)


def _rows_before_it_is_loose(run: Any, flies: np.ndarray | None) -> int:
    """Saved times before nodes are loose or cables buckle."""
    loose_from = first_loose(run) if flies is None else first_of(run, flies)
    times = [t for t in (loose_from, first_buckled(run)) if t is not None]
    return int(np.searchsorted(run.t, min(times))) if times else len(run.t)


def _bends(tension: np.ndarray) -> float:
    """Sum of second differences of the tension (k, n_segments) of all segments over that of its distances from its mean.

    Of x = sin(2 pi r/N) at rows r it is near to (2 pi/N)^2: it tells how many saved states show a turn.
    """
    T = tension.sum(axis=1)
    T = T[1:] + T[:-1]  # those of a stiff cable alternate about their means
    apart = float(np.abs(T - T.mean()).sum())
    return float(np.abs(np.diff(T, 2)).sum()) / apart if apart > 0.0 else 0.0


def _pumped_at_most(tension: np.ndarray, together: int) -> float:
    """Logarithm of the times by which the size of a displacement grows at most, as tensions (k, n_segments) change.

    Its energy z K z/2 + m (dz/dt)^2/2 grows by z (dK/dt) z/2 only, and so at no more than the largest rate at which the logarithm
    of a T/l grows. Of a spring, l grows and falls with T.
    """
    T = tension[1::together] + tension[:-1:together]
    if T.min() <= 0.0:
        return math.inf
    grown = (T[1:] / T[:-1]).max(axis=1, initial=1.0)
    return 0.5 * float(np.log(grown).sum())


def _carried(run: Any, tension: np.ndarray, together: int) -> np.ndarray:
    """Logarithm of a displacement across the motion, the largest of a node at each saved time (k,); it begins at random.

    It is carried through ``together`` times between two saved states in one, and in these it is as large as at their end.
    """
    from .across_kernel import MOST_PARTS, carry_across  # compiled on first use

    model, n_free = run.model, run.model.n_free
    mass, motion = np.zeros(model.n), np.zeros((2, model.n))
    mass[:n_free] = model.mass[:n_free]
    motion[0, :n_free] = np.random.default_rng(0).uniform(-1.0, 1.0, n_free)
    times = (len(tension) - 1) // together
    last, logarithm = times * together, np.zeros(len(tension))
    means = tension[:last:together] + tension[together : last + 1 : together]
    for n in range(1, together):
        means += 2.0 * tension[n:last:together]
    lengths = _lengths(run, run.q[: last + 1 : together])
    means /= together * np.maximum(lengths[1:] + lengths[:-1], 1e-300)
    ends, sizes = np.ascontiguousarray(model.ends), np.zeros(times)
    carry_across(np.diff(run.t[: last + 1 : together]), MOST_PARTS * together, means, ends, mass, motion, np.zeros(model.n), sizes)
    logarithm[1 : last + 1] = np.repeat(sizes, together)
    logarithm[last + 1 :] = logarithm[last]
    return logarithm


def _lengths(run: Any, q: np.ndarray) -> np.ndarray:
    """Lengths of all segments (k, n_segments) [m] in some rows of places (k, n, 3), in the order of ``model.ends``."""
    model = run.model
    lengths = np.empty((len(q), model.n_segments))
    for c in range(len(model.cable)):
        (first, count), node = model.segment_run(c), model.cable[c, CABLE_FIRST_NODE]
        last, (start, end) = node + count - 2, model.cable[c, [CABLE_START, CABLE_END]]
        if count > 2:
            lengths[:, first + 1 : first + count - 1] = _sizes(q[:, node + 1 : last + 1] - q[:, node:last])
        lengths[:, first] = _sizes(q[:, node if count > 1 else end] - q[:, start])
        if count > 1:
            lengths[:, first + count - 1] = _sizes(q[:, end] - q[:, last])
    return lengths


def _sizes(vectors: np.ndarray) -> np.ndarray:
    """Of vectors (..., 3), of shape (...)."""
    return np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
