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


def weights_at(errors, times, target):
    """Runs of a method between which it meets an error, and their weights in the logarithm of its time.

    The runs that count are those on the method's own front, between two of which the time is a straight line in both logarithms.
    Nothing is extrapolated: a method whose fastest run is more accurate than asked costs what that run cost.

    Parameters
    ----------
    errors : (n,) float64 [any unit]
    times : (n,) float64 [s]
    target : float, in the unit of the errors

    Returns
    -------
    dict of int to float : index of a run -> weight; one run, two, or none if no run is as accurate
    """
    errors, times = np.asarray(errors, float), np.asarray(times, float)
    front = np.flatnonzero(on_front(errors, times))
    front = front[np.argsort(times[front])]  # errors fall along it
    if not len(front) or errors[front[-1]] > target:
        return {}
    after = int(np.argmax(errors[front] <= target))
    if after == 0:
        return {int(front[0]): 1.0}
    a, b = np.log(errors[front[after - 1]]), np.log(errors[front[after]])
    share = (a - np.log(target)) / (a - b)
    return {int(front[after - 1]): 1.0 - share, int(front[after]): share}


def time_at(errors, times, target):
    """Least time in which a method meets an error, between two of its runs (see `weights_at`).

    Returns
    -------
    time : float [s], NaN if no run is as accurate
    error : float, the one that this time is had at: ``target``, or that of the fastest run if it is smaller
    """
    weights = weights_at(errors, times, target)
    if not weights:
        return np.nan, np.nan
    times = np.asarray(times, float)
    time = float(np.exp(sum(weight * np.log(times[i]) for i, weight in weights.items())))
    (first, *others) = weights
    return time, float(target) if others else float(np.asarray(errors, float)[first])
