"""How many times a motion multiplies small errors while its cables stay taut, as their tensions tell.

A force T along a segment of the length l holds its ends across it with the stiffness T/l. So a small displacement z across the
motion, such as that of a net which swings in a plane a little out of it, obeys

    m_i d2z_i/dt2 = sum of (T/l) (z_j - z_i) over the segments between i and j .

This is exact across a plane motion, since no length changes to first order, whether segments pull or push. With tensions that pull
and do not change, z swings and stays as small as it is. Segments that push (compression="linear") let z grow, as a column that
buckles. Tensions that go up and down with the swings pump it, as a child does a swing: nets and cables that swing far for a
long time, or that are shaken, multiply every error by exp(rate t), and the motion is chaotic. `across_kernel` carries one
along with the tensions of a run, through some tens of steps in each of their turns. What it grows by beyond `SWAYS` times counts as
what the motion multiplies its errors by; up to that a displacement grows as its nodes share it out, and as T^(-1/4) where tensions
change slowly. The energy z K z/2 + sum of m (dz/dt)^2/2 of a displacement grows at no more than the rate at which the T/l do: where
that is less than `SWAYS` times, nothing is carried along.

Nodes that are loose multiply errors in another way, see `free_flight`; so from the first such time on no more growth counts. Nor is
it looked for where effects couple more than neighbours or nodes are those of bodies, nor
where a run saves its states too seldom to show how its tensions change.

Source: parametric resonance, Landau & Lifshitz, Mechanics, 1976, section 27; the power -1/4 is that of an adiabatic invariant,
section 49.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from .place_rows import ASIDE, MULTIPLIED, OFF, TOGETHER
from .saved_motion import SavedMotion, look_at

SWINGS = 0.1  # of the mean of tensions: by less than that they neither go slack nor pump
HARDLY_SEEN = 0.3  # of distances from the mean: second differences where less than a dozen states show a turn


def amplification(run: Any) -> np.ndarray:
    """Logarithm of the times by which the motion has multiplied its first errors up to each saved time, (k,), never falling.

    An error that is made at the row a is multiplied exp(x[b] - x[a]) times up to the row b.
    """
    return multiply(look_at(run, grows=True))


def multiply(seen: SavedMotion) -> np.ndarray:
    """As `amplification`, of a run that was looked at; a row of its `PlaceRows.columns`."""
    if seen.rows.numbers[TOGETHER] > 0.0:
        from .across_kernel import multiply_errors  # compiled on first use

        seen.rows.of_nodes[OFF:] = 0.0
        n_free = seen.rows.flies.shape[1]
        seen.rows.of_nodes[ASIDE, :n_free] = _at_random(n_free)
        multiply_errors(seen.address)
    return seen.rows.columns[MULTIPLIED]


def is_hardly_seen(run: Any) -> bool:
    """Whether tensions swing, and saved states show so little of it that cables may be slack or pump between them.

    The sum of second differences over that of distances from the mean is near to (2 pi/N)^2 of N states a turn. Tensions of stiff
    cables alternate about their means, so those of two in a row count.
    """
    sums = run.segment_tension.sum(axis=1)
    means = 0.5 * (sums[1:] + sums[:-1])
    if len(means) < 3:
        return False
    apart = float(np.abs(means - means.mean()).mean())
    bent = float(np.abs(means[2:] - means[1:-1] - (means[1:-1] - means[:-2])).mean())
    return apart > SWINGS * abs(float(means.mean())) and bent > HARDLY_SEEN * apart


@lru_cache(maxsize=16)
def _at_random(n: int) -> np.ndarray:
    """A displacement of moving nodes to begin with, (n,)."""
    return np.random.default_rng(0).uniform(-1.0, 1.0, n)
