"""The audit of a run: is its energy accounted for, and how far are its places and tensions from those of a finer run?

Where the finer run and the error that the run tells of itself disagree, a third run with a quarter of the step shows how fast the
places come nearer: the error is what is left of a geometric series, whatever the order.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from .audit import IMBALANCE, TENSION_ALLOWED, Audit
from .distances import distances
from .energy_balance import error_of_steps
from .run import RunInterrupt

SHARE, SHARE_OF_MOTION = 1e-2, 5e-2  # of the longest cable, and of the motion: the largest error that passes where none is named
LEAST = 1e-6  # of the longest cable, which passes where nothing moves
DISAGREE = 4.0  # times, or a quarter of, the error that the run tells of itself: then a third run is made
SLOWEST = 1.1  # times nearer, by which two finer runs must be: otherwise they tend to nothing


def audited(run: Any, finer: Callable[[int], Any], order: float | None, allowed: float | None = None) -> Any:
    """A run that reached its end, with its audit; its status is "audit failed" if it did not pass.

    Parameters
    ----------
    run : Run
    finer : callable(parts) -> Run
        The same run with each step in so many parts, or with a tenth of the tolerance for two, saved at the same times. It gives
        no warnings, as the run itself has given them.
    order : int or None
        Of the run in its step; None where its steps were chosen by a tolerance.
    allowed : float or None [m]
        Largest error that passes; None takes `SHARE` of the longest cable or `SHARE_OF_MOTION` of the motion, whichever is less.

    Returns
    -------
    Run
    """
    if allowed is None:
        longest = run.scene.longest
        moved = float(np.linalg.norm(run.q - run.q[0], axis=2).max())
        allowed = max(min(SHARE * longest, SHARE_OF_MOTION * moved), LEAST * longest)
    began = time.perf_counter()
    other = _unless_stopped(finer, 2, run)
    rows, _, apart = distances(run, other)
    row, node = np.unravel_index(np.argmax(apart), apart.shape)
    # q_h - q_(h/2) = (1 - 2^-p) of the error of q_h; a tenth of the tolerance leaves next to nothing of it
    left = 1.0 if order is None else 1.0 - 2.0**-order
    error, told = float(apart[row, node]) / left, run.error_estimate
    disagree = bool(told) and not run.extrapolated and not 1.0 / DISAGREE < error / told < DISAGREE
    if other.ok and order is not None and disagree and error > 0.1 * allowed:
        third = _unless_stopped(finer, 4, run)
        if third.ok:
            nearer = float(apart[row, node]) / max(float(distances(other, third).apart[row, node]), 1e-300)
            error = float(apart[row, node]) / (1.0 - 1.0 / nearer) if nearer > SLOWEST else np.inf
    took, imbalance = time.perf_counter() - began, error_of_steps(run)
    largest = float(other.segment_tension.max(initial=0.0))
    off = abs(float(run.segment_tension.max(initial=0.0)) - largest) / left
    tension_error = off / largest if largest > 0.0 else 0.0
    where, t = run.model.where(int(node)), float(run.t[rows[row]])
    reasons = []
    if not other.ok:
        reasons.append(f'the finer run ended as "{other.status}" at t={other.t[-1]:.4g} s')
    if error == np.inf:
        reasons.append(f"{where} comes no nearer to any place at t={t:.4g} s as the steps get shorter")
    elif not error <= allowed:
        reasons.append(f"{where} is off by {error:.3g} m at t={t:.4g} s where {allowed:.3g} m are allowed")
    if not tension_error <= TENSION_ALLOWED:
        reasons.append(f"the largest tension is off by {tension_error:.3g} of it where {TENSION_ALLOWED:g} are allowed")
    if not imbalance <= IMBALANCE:
        reasons.append(f"{imbalance:.2g} of the energy in play are not accounted for where {IMBALANCE:g} are allowed")
    reason = f"The audit failed: {', and '.join(reasons)}; try a smaller step or tolerance." if reasons else ""
    found = Audit(error, where, t, allowed, imbalance, took, reason, tension_error)
    return replace(run, audit=found, **({"status": "audit failed", "message": reason} if reasons else {}))


def _unless_stopped(finer: Callable[[int], Any], parts: int, run: Any) -> Any:
    """A finer run; where the user stops it, what is kept is the run that was done."""
    try:
        return finer(parts)
    except KeyboardInterrupt:
        message = "The run was done, but its audit was stopped by the user."
        raise RunInterrupt(replace(run, status="interrupted", message=message)) from None
