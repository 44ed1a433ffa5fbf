"""How many times a motion multiplies small errors while its cables stay taut, as their tensions tell.

A force T along a segment of the length l holds its ends across it with the stiffness T/l. So a small displacement z across the
motion, such as that of a net which swings in a plane a little out of it, obeys

    m_i d2z_i/dt2 = sum of (T/l) (z_j - z_i) over the segments between i and j .

This is exact across a plane motion, since no length changes to first order. With tensions that do not change, z swings and stays as
small as it is. Tensions that go up and down with the swings pump it, as a child does a swing: nets and cables that swing far for a
long time, or that are shaken, multiply every error by exp(rate t), and the motion is chaotic. `carry_across` carries a displacement
along with the tensions of a run. What it grows by beyond `SWAYS` times counts as what the motion multiplies its errors by; up to
that a displacement grows as its nodes share it out, and as T^(-1/4) where tensions change slowly.

Nodes that are loose, and cables that buckle, multiply errors in other ways, see `free_flight` and `buckling`; so from the first
such time on no more growth counts. Nor is it looked for where effects couple more than neighbours or nodes are those of bodies, nor
where a run saves its states too seldom to show how its tensions change.

Source: parametric resonance, Landau & Lifshitz, Mechanics, 1976, section 27; the power -1/4 is that of an adiabatic invariant,
section 49.
"""

from typing import Any

import numpy as np
from scipy.ndimage import maximum_filter1d

from .buckling import BENDS, first_buckled
from .energy_balance import SWINGS
from .free_flight import first_loose

SWAYS = 4.0  # times that a displacement becomes as large in a motion that multiplies nothing, at most
LEAST_ROWS = 64  # saved states that show swings
SEEN = 1e-5  # of the longest cable: less error than that may grow unseen
RESOLVED = 0.6  # sum of second differences of a tension over that of its distances from its mean, of ten states a turn at least


def amplification(run: Any) -> np.ndarray:
    """Logarithm of the times by which the motion has multiplied its first errors up to each saved time, (k,), never falling.

    An error that is made at the row a is multiplied exp(x[b] - x[a]) times up to the row b.
    """
    grown = np.zeros(len(run.t))
    if len(run.t) < LEAST_ROWS or not _is_seen(run):
        return grown
    rows = _rows_before_it_is_loose(run)
    if rows < LEAST_ROWS:
        return grown
    tension = np.ascontiguousarray(run.segment_tension[:rows])
    if not _shown(tension):
        return grown
    size = maximum_filter1d(_carried(run, tension), 2 * max(1, rows // SWINGS) + 1, mode="nearest")
    grown[:rows] = np.maximum.accumulate(np.maximum(size - np.minimum.accumulate(size) - np.log(SWAYS), 0.0))
    grown[rows:] = grown[rows - 1]
    return grown


def _is_seen(run: Any) -> bool:
    """Whether the run has an error that is worth looking at, and no more across it than tensions."""
    plain = not run.model.has_bodies and all(effect.coupled_neighbours < BENDS for effect in run.scene.effects)
    return plain and run.error_growth[-1] > SEEN * max(cable.length for cable in run.scene.cables)


def _rows_before_it_is_loose(run: Any) -> int:
    """Saved times before nodes are loose or cables buckle."""
    times = [t for t in (first_loose(run), first_buckled(run)) if t is not None]
    return int(np.searchsorted(run.t, min(times))) if times else len(run.t)


def _shown(tension: np.ndarray) -> bool:
    """Whether saved states (k, n_segments) [N] are near enough to each other to show how the tensions change."""
    T = tension.sum(axis=1)
    T = T[1:] + T[:-1]  # those of a stiff cable alternate about their means
    return float(np.abs(np.diff(T, 2)).sum()) <= RESOLVED * float(np.abs(T - T.mean()).sum())


def _carried(run: Any, tension: np.ndarray) -> np.ndarray:
    """Logarithm of a displacement across the motion, the largest of a node at each saved time (k,); it begins at random."""
    from .across_kernel import carry_across  # compiled on first use

    model, n_free = run.model, run.model.n_free
    mass, motion = np.zeros(model.n), np.zeros((2, model.n))
    mass[:n_free] = model.mass[:n_free]
    motion[0, :n_free] = np.random.default_rng(0).uniform(-1.0, 1.0, n_free)
    rows = len(tension)
    logarithm = np.zeros(rows)
    scratch = np.zeros((2, max(model.n, model.n_segments)))
    carry_across(run.t[:rows], run.q[:rows], tension, np.ascontiguousarray(model.ends), mass, motion, scratch, logarithm)
    return logarithm
