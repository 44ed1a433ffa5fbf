"""Where and when cables of a run were slack, and the snaps with which they were taut again.

A cable is slack at a saved time where one of its segments carries no tension, or pushes: no more than `CARRIES` of the largest
tension of the run, which rounding leaves. A segment that broke counts no more. Both know saved times only: what comes and goes
between two of them is not seen, so that ``save_every`` should be a part of what lasts shortest.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

CARRIES = 1e-9  # of the largest tension of a run: what rounding leaves in a slack segment
FALLEN = 0.5  # of its height: what a tension has fallen by when the peak that followed a slack time is over


@dataclass(frozen=True)
class SlackTime:
    """A time for which a cable was slack.

    Parameters
    ----------
    cable : str
    start, end : float [s], the first and the last saved time at which it was slack
    ends_with_run : bool, whether it was still slack at the end of the run
    """

    cable: str
    start: float
    end: float
    ends_with_run: bool


@dataclass(frozen=True)
class Snap:
    """The peak of tension with which a slack cable was taut again.

    Parameters
    ----------
    cable : str
    t : float [s], of the peak
    segment : int, where the tension was largest, counted from the cable's start
    tension : float [N], of that segment
    slack_for : float [s], between the saved times beside the slack ones before it
    """

    cable: str
    t: float
    segment: int
    tension: float
    slack_for: float


def slack_times(run: Any) -> list[SlackTime]:
    """Times for which cables were slack, in the order of the scene's cables and of time."""
    found = []
    for cable in run.scene.cables:
        for first, last in _stretches(is_slack(run, cable.name)):
            found.append(SlackTime(cable.name, float(run.t[first]), float(run.t[last]), last == len(run.t) - 1))
    return found


def snaps(run: Any) -> list[Snap]:
    """Snaps of all cables, from the largest tension on.

    A peak is the largest tension from the first saved time after a slack one until the tension has fallen by half, or the cable is
    slack again.
    """
    found = []
    for cable in run.scene.cables:
        slack, T = is_slack(run, cable.name), run.tension(cable.name)
        stretches = _stretches(slack)
        for k, (first, last) in enumerate(stretches):
            until = stretches[k + 1][0] if k + 1 < len(stretches) else len(run.t)
            if last + 1 < until:
                row, segment = _first_peak(T[last + 1 : until])
                peak = last + 1 + row
                slack_for = float(run.t[last + 1] - run.t[max(first - 1, 0)])
                found.append(Snap(cable.name, float(run.t[peak]), segment, float(T[peak, segment]), slack_for))
    return sorted(found, key=lambda snap: -snap.tension)


def is_slack(run: Any, cable: str) -> np.ndarray:
    """(k,) bool, whether a segment of a cable that has not broken carries nothing."""
    return ((run.tension(cable) <= CARRIES * run.segment_tension.max(initial=0.0)) & run.holds(cable)).any(axis=1)


def _stretches(slack: np.ndarray) -> list[tuple[int, int]]:
    """First and last row of each stretch of True in (k,) bool."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], slack, [False]]).astype(int)))
    return [(int(first), int(after) - 1) for first, after in zip(edges[::2], edges[1::2], strict=True)]


def _first_peak(T: np.ndarray) -> tuple[int, int]:
    """Row and segment of the first peak of tensions (k, segments)."""
    largest = T.max(axis=1)
    over = np.flatnonzero(largest < (1.0 - FALLEN) * np.maximum.accumulate(largest))
    rows = T[: over[0] if len(over) else len(T)]
    row, segment = np.unravel_index(np.argmax(rows), rows.shape)
    return int(row), int(segment)
