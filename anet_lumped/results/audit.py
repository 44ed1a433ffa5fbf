"""The audit of a run: is its energy accounted for, and how far are its places from those of a finer run?"""

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .energy_balance import error_of_steps

IMBALANCE = 1e-2  # of the energy in play: more than this is not accounted for
SHARE = 1e-2  # of the longest cable: the largest error that passes where none is named


@dataclass(frozen=True)
class Audit:
    """What the audit of a run found.

    Parameters
    ----------
    error : float [m]
        Largest error of a place, estimated from the same run with half the step (by its order) or a tenth of the tolerance.
    where, t : str, float [s]
        The node and the time of it.
    allowed : float [m]
    imbalance : float
        Energy that is not accounted for by work and forces, relative to what was in play.
    wall_time : float [s]
        That the finer run took.
    reason : str
        Why the run did not pass, one sentence; empty if it did.
    """

    error: float
    where: str
    t: float
    allowed: float
    imbalance: float
    wall_time: float
    reason: str = ""

    @property
    def passed(self) -> bool:
        """Whether nothing was found."""
        return not self.reason


def audited(run: Any, finer: Callable[[], Any], order: float | None, allowed: float | None = None) -> Any:
    """A run that reached its end, with its audit; its status is "audit failed" if it did not pass.

    Parameters
    ----------
    run : Run
    finer : callable -> Run
        The same run with half the step or a tenth of the tolerance, saved at the same times.
    order : int or None
        Of the run in its step; None where its steps were chosen by a tolerance.
    allowed : float or None [m]
        Largest error that passes; None takes `SHARE` of the longest cable.

    Returns
    -------
    Run
    """
    allowed = SHARE * max(cable.length for cable in run.scene.cables) if allowed is None else allowed
    began = time.perf_counter()
    with warnings.catch_warnings():  # the run itself has given them
        warnings.simplefilter("ignore")
        other = finer()
    took, imbalance = time.perf_counter() - began, error_of_steps(run)
    k = min(len(run.t), len(other.t))
    apart = np.linalg.norm(run.q[:k] - other.q[:k], axis=2)
    row, node = np.unravel_index(np.argmax(apart), apart.shape)
    # q_h - q_(h/2) = (1 - 2^-p) of the error of q_h; a tenth of the tolerance leaves next to nothing of it
    error = float(apart[row, node]) / (1.0 if order is None else 1.0 - 2.0**-order)
    where, t = run.model.where(int(node)), float(run.t[row])
    reasons = []
    if not other.ok:
        reasons.append(f'the finer run ended as "{other.status}" at t={other.t[-1]:.4g} s')
    if not error <= allowed:
        reasons.append(f"{where} is off by {error:.3g} m at t={t:.4g} s where {allowed:.3g} m are allowed")
    if not imbalance <= IMBALANCE:
        reasons.append(f"{imbalance:.2g} of the energy in play are not accounted for where {IMBALANCE:g} are allowed")
    reason = f"The audit failed: {', and '.join(reasons)}; try a smaller step or tolerance." if reasons else ""
    found = Audit(error, where, t, allowed, imbalance, took, reason)
    return replace(run, audit=found, **({"status": "audit failed", "message": reason} if reasons else {}))
