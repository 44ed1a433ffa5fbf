"""Whether saved states are so far apart that a motion swings between them: curves through them show another motion.

From one state to the next a node goes h (v_a + v_b)/2, but for an error of (omega h)^2/12 of that where the states show a swing of
omega. Where they do not, what its velocities say and the way that it goes have little to do with each other. Of a net that is
carried, its swings are those about the mean of its nodes.
"""

from typing import Any

import numpy as np

HIDDEN = 0.3  # of the ways that velocities tell: as much is off where six states show a turn
MOVES = 1e-3  # of the longest cable, by which nodes move that do not hang still


def hides_swings(run: Any) -> bool:
    """Whether curves through the saved states of a run do not show its swings."""
    if len(run.t) < 3 or not (np.isfinite(run.q).all() and np.isfinite(run.v).all()):
        return False
    q, v = (x - x.mean(axis=1, keepdims=True) for x in (run.q, run.v))
    ways = 0.5 * np.diff(run.t)[:, None, None] * (v[1:] + v[:-1])
    off = np.diff(q, axis=0) - ways
    moves = float(np.abs(q - q.mean(axis=0)).max()) > MOVES * run.scene.longest
    return moves and float((off**2).sum()) > HIDDEN**2 * float((ways**2).sum())
