"""Comparisons at equal error: what a method costs at an accuracy that it was not run with, and who is dominated."""

import numpy as np


def on_front(errors, times):
    """Which points no other one beats: none is as accurate and as fast, and better in one of the two.

    Parameters
    ----------
    errors, times : (n,) float64

    Returns
    -------
    (n,) bool; False where an error or a time is not finite
    """
    errors, times = np.asarray(errors, float), np.asarray(times, float)
    found, best = np.zeros(len(errors), bool), np.inf
    finite = np.isfinite(errors) & np.isfinite(times)
    for i in np.lexsort((errors, times)):
        if finite[i] and errors[i] < best:
            found[i], best = True, errors[i]
    return found


def time_at(errors, times, target):
    """Least time in which a method meets an error, between two of its runs by a straight line in both logarithms.

    The runs that count are those on the method's own front. Nothing is extrapolated: a method whose fastest run is more
    accurate than asked costs what that run cost.

    Parameters
    ----------
    errors : (n,) float64 [any unit]
    times : (n,) float64 [s]
    target : float, in the unit of the errors

    Returns
    -------
    time : float [s], NaN if no run is as accurate
    error : float, the one that this time is had at: ``target``, or that of the fastest run if it is smaller
    """
    errors, times = np.asarray(errors, float), np.asarray(times, float)
    front = np.flatnonzero(on_front(errors, times))
    front = front[np.argsort(times[front])]
    errors, times = errors[front], times[front]
    if not len(errors) or errors[-1] > target:
        return np.nan, np.nan
    if errors[0] <= target:
        return float(times[0]), float(errors[0])
    return float(np.exp(np.interp(-np.log(target), -np.log(errors), np.log(times)))), float(target)
