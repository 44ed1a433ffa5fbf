"""Largest tensions of a run: of each cable at each saved time, and peaks that pass between two of them."""

from typing import Any, NamedTuple

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.tables import CABLE_FIRST_SEGMENT

HIDES = 1e-3  # of the largest tension: by how much less saved states may show that count as showing it


class Hidden(NamedTuple):
    """A largest tension that passes between two saved states.

    Parameters
    ----------
    row : int, of the saved time after it
    cable : int, its number in the scene
    tension : float [N]
    shown : float [N], the largest tension of any cable in the saved states
    rise : float [N], by which it is above what the cable carries in the saved states before and after it
    """

    row: int
    cable: int
    tension: float
    shown: float
    rise: float


def largest_of_cables(model: Model, tension: np.ndarray) -> np.ndarray:
    """Largest tension of each cable (k, cables) in rows of tensions (k, n_segments) [N]; 0 where all of it is slack or pushes."""
    largest = np.zeros((len(tension), len(model.cable)))
    if len(model.cable):
        first = model.cable[:, CABLE_FIRST_SEGMENT]
        order = np.argsort(first)
        largest[:, order] = np.maximum.reduceat(tension, first[order], axis=1)
    return np.maximum(largest, 0.0, out=largest)


def largest_so_far(model: Model, tension: np.ndarray, noticed: np.ndarray | float = 0.0) -> np.ndarray:
    """Largest tension of each cable up to each of the rows of tensions (k, n_segments) [N], (k, cables) [N].

    ``noticed`` (k, cables) [N] are those found so far in states between these.
    """
    largest = np.maximum(largest_of_cables(model, tension), noticed)
    return np.maximum.accumulate(largest, axis=0, out=largest)


def peak_tension(run: Any, cable: str | None = None) -> float:
    """`Run.peak_tension`."""
    shown = run.segment_tension if cable is None else run.tension(cable)
    peak = float(shown.max(initial=0.0))
    if run.largest_tension is None:
        return peak
    names = [one.name for one in run.scene.cables]
    last = run.largest_tension[-1]
    return max(peak, float(last.max(initial=0.0) if cable is None else last[names.index(cable)]))


def hidden_peak(run: Any) -> Hidden | None:
    """The largest tension of a run, if it is between two saved states; None if these show it, but for `HIDES`."""
    if run.largest_tension is None:
        return None
    shown, peak = float(run.segment_tension.max(initial=0.0)), float(run.largest_tension[-1].max(initial=0.0))
    if peak <= (1.0 + HIDES) * shown:
        return None
    cable = int(run.largest_tension[-1].argmax())
    row = int(np.argmax(run.largest_tension[:, cable] == peak))
    own = run.tension(run.scene.cables[cable].name)
    beside = own[max(row - 1, 0) : row + 1].max(axis=1).min()
    return Hidden(row, cable, peak, shown, peak - max(float(beside), 0.0))
