"""Keep an error by the tolerance of a method that chooses its steps: two runs, and finer ones until both agree.

What two runs differ by is about the error of the one with the larger tolerance. The other one's error is smaller in proportion to
what steps leave out of places, which each run adds up. So a motion that multiplies errors is found out: it does so in both runs.
"""

import logging
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from anet_lumped.results.distances import distances
from anet_lumped.results.events import SLACK
from anet_lumped.results.run import Run

from .known_errors import AMPLIFIED, ERROR_OF_LENGTH, Known, Wanted
from .told_errors import told

LOG = logging.getLogger(__name__)
FIRST = 0.1  # of the error wanted, the tolerance of the first run
FINER = 0.1  # of a tolerance, the next one: a third more steps for a pair of order 8
SMALLEST = 1e-14  # of the longest cable: what rounding leaves of a step
LEAST_SHARE = 0.05  # of the distance of two runs, which is left of it as the error of the finer one


def keep_error_by_tolerance(march: Callable[[float], Run], wanted: Wanted, length: float, most: float = math.inf) -> Run:
    """March with tolerances small enough for the errors that are wanted.

    Parameters
    ----------
    march : callable(tolerance [m]) -> Run
    wanted : Wanted
    length : float [m], of the longest cable
    most : float, runs at most, of which there are two at least

    Returns
    -------
    Run
        The last one that is "done", or the first one; `Run.reason` says what was kept.
    """
    tolerance = FIRST * (wanted.error or ERROR_OF_LENGTH * length)
    run = march(tolerance)
    known = Known(math.inf, run.tension_error)  # no other run has shown it yet
    if run.ok:
        tolerance = min(tolerance, FIRST * wanted.of_places(run))
    runs = 1
    while run.ok:
        coarser, before, tolerance = run, tolerance, max(FINER * tolerance, SMALLEST * length)
        run, runs = march(tolerance), runs + 1
        if not run.ok:
            words = f"a smaller tolerance stopped at t={run.t[-1]:.4g} s: {run.message}"
            coarser = replace(coarser, warnings=(*coarser.warnings, f"{run.method} with {words}"))
            return told(coarser, known, wanted, f"a tolerance of {before:.2g} m")
        known = _compared(run, coarser, wanted)
        LOG.info("with a tolerance of %.2g m places are known to %.2g m", tolerance, known.error)
        if known.error <= wanted.of_places(run) or tolerance <= SMALLEST * length or runs >= most:
            return told(run, known, wanted, f"a tolerance of {tolerance:.2g} m")
    return run


def _compared(run: Run, coarser: Run, wanted: Wanted) -> Known:
    """Errors of a run, by what it and a coarser one saved at the same times and by what their steps left out.

    Where cables went slack, what two runs differ by need not fall with the tolerance: all of it is then the error of the finer one,
    and no less than the run tells of itself.
    """
    rows, rows_of_coarser, by_node = distances(run, coarser)
    apart = np.maximum.accumulate(by_node.max(axis=1))
    own, theirs = (max(one.error_estimate or 0.0, 1e-300) for one in (run, coarser))
    slack = any(event.kind == SLACK for event in run.events)
    error = float(apart[-1]) * (1.0 if slack else min(max(own / theirs, LEAST_SHARE), 1.0))
    error = max(error, own) if slack else error
    beyond = apart > np.maximum(AMPLIFIED * coarser.error[rows_of_coarser], wanted.of_places(run))
    of_told = max(error / own, 1.0)
    since = float(run.t[rows][np.argmax(beyond)]) if of_told > AMPLIFIED and beyond.any() else math.inf
    return Known(error, run.tension_error, of_told, since, float(apart[-1]))
