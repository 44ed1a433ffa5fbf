"""How far apart two runs of one scene are, at the times that both have saved."""

from typing import Any, NamedTuple

import numpy as np


class Distances(NamedTuple):
    """Distances of the nodes of two runs.

    Parameters
    ----------
    rows, other_rows : (k,) int64, saved states of the one and of the other run at the times that both have saved
    apart : (k, n) float64 [m]
    """

    rows: np.ndarray
    other_rows: np.ndarray
    apart: np.ndarray


def distances(run: Any, other: Any) -> Distances:
    """Distances of the nodes of two runs of one scene, at the times that both have saved.

    Parameters
    ----------
    run, other : Run
        Times are the same within a millionth of the step of the first.
    """
    near = np.minimum(np.searchsorted(other.t, run.t - 1e-6 * run.dt), len(other.t) - 1)
    rows = np.flatnonzero(np.abs(other.t[near] - run.t) < 1e-6 * run.dt)
    return Distances(rows, near[rows], np.linalg.norm(run.q[rows] - other.q[near[rows]], axis=2))
