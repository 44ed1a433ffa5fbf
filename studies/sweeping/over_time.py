"""What a sweep measures over the saved times of a run, or over those from a time on.

A statistic is taken of each column of (k, m) values by itself, over time; of the m columns the largest counts, or the least for the
least value. Columns are the segments of cables, the ends of cables at a point, the coordinate of a point, or the cables that lie on
the ground. Means, deviations and times weigh each saved time with half of the times to the saved ones beside it.
"""

from dataclasses import replace

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.results.rainflow import cycles
from anet_lumped.results.run import with_states
from anet_lumped.results.slack import is_slack

ROUNDED = 1e-12  # of a time: what a saved time may lie before the one that it stands for
AXES = {"x": 0, "y": 1, "height": 2}


class WindowError(InputError):
    """A time from which on a run has too few saved states."""


def window(run, since):
    """The part of a run from a time `since` [s] on; all of it for None.

    Raises
    ------
    WindowError : fewer than two saved times are left
    """
    if since is None:
        return run
    rows = _rows(run, since)
    if np.count_nonzero(rows) < 2:
        raise WindowError(f"A run must have two saved times from t={since:g} s on, but it ends at t={run.t[-1]:g} s.")
    later = replace(with_states(run, rows), peak_at_most=None)
    so_far = later.largest_tension
    if so_far is None:
        return later
    # of peaks between saved times, those count that are higher than all before
    return replace(later, largest_tension=np.where(so_far > so_far[0], so_far, 0.0))


def _rows(run, since):
    return run.t >= (-np.inf if since is None else since - ROUNDED * abs(since))


def weights(t):
    """Half of the times to the neighbours of each time, (k,) [s]; their sum is the whole time."""
    steps = np.diff(t)
    return 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))


def least(t, values):
    """The least of all values."""
    return values.min()


def largest(t, values):
    """The largest of all values."""
    return values.max()


def mean(t, values):
    """The largest mean over time of a column."""
    return np.average(values, axis=0, weights=weights(t)).max()


def deviation(t, values):
    """The largest standard deviation over time of a column."""
    share = weights(t)
    apart = values - np.average(values, axis=0, weights=share)
    return np.sqrt(np.average(apart**2, axis=0, weights=share)).max()


def spread(t, values):
    """The largest difference between the largest and the least value of a column."""
    return np.ptp(values, axis=0).max()


def rainflow(t, values):
    """The largest range of a rainflow cycle of a column."""
    return max(float(cycles(t, column).ranges.max(initial=0.0)) for column in values.T)


def equivalent(t, values):
    """The largest damage-equivalent range of a column, at 1 Hz and with the exponent 3 of chain."""
    return max(cycles(t, column).equivalent() for column in values.T)


def tension(run, target):
    """Tensions of the segments of a cable, of all cables, or of the ends of cables at a point, (k, m) [N]."""
    cables = run.scene.cables
    ends = [run.end_tension(cable.name, target) for cable in cables for point in (cable.start, cable.end) if point == target]
    if ends:
        return np.stack(ends, axis=1)
    return np.concatenate([run.tension(cable.name) for cable in cables if target in (None, cable.name)], axis=1)


def peak_tension(run, target, since):
    """Largest tension of a cable, or of all, in all steps [N]; of the ends of cables at a point, at a saved time."""
    run = window(run, since)
    if target in (None, *(cable.name for cable in run.scene.cables)):
        return run.peak_tension(target)
    return float(tension(run, target).max())


def coordinate(run, target, axis):
    """A coordinate of a point, (k, 1) [m]."""
    return run.position(target)[:, [axis]]


def touchdown(run, target):
    """Length of a cable on the ground, or of each, (k, m) [m]."""
    cables = [cable.name for cable in run.scene.cables if target in (None, cable.name)]
    return np.stack([run.touchdown_length(name) for name in cables], axis=1)


def statistic(run, target, since, values, of):
    """A statistic `of` the `values` of a run from a time on."""
    run = window(run, since)
    return float(of(run.t, values(run, target)))


def displacement(run, target, since):
    """Largest distance of a point from where it was at the start of the run, at a saved time [m]."""
    path = run.position(target)
    return float(np.linalg.norm(window(run, since).position(target) - path[0], axis=1).max())


def slack_time(run, target, since):
    """Time for which a cable was slack; the longest of all cables [s]."""
    t, rows = window(run, since).t, _rows(run, since)
    cables = [cable.name for cable in run.scene.cables if target in (None, cable.name)]
    return max(float(weights(t) @ is_slack(run, name)[rows]) for name in cables)


def snaps(run, target, since):
    """Number of snaps of a cable, or of all."""
    begin = window(run, since).t[0]
    return sum(snap.t >= begin and target in (None, snap.cable) for snap in run.snaps)
