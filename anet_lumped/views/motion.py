"""What is shown of a run: its finite states, thinned, about the middle of the motion; what holds, and its strains."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.model.rest_lengths import at_time
from anet_lumped.scene.origin import largest_distance
from anet_lumped.scene.scene import Driven, Fixed

FAR = 1e30  # [m], beyond which single precision has no room for squares
ESCAPED = 10.0  # times the reach of a scene: places beyond that, of a run that diverges, do not count for what a camera sees
DRIFTS = 4.0  # times its own size that a structure travels, from which on a camera goes along with it
CLIPPED = 3.0  # largest tension over the one that 1 % exceed, from which on the scale of colours ends at the latter


@dataclass(frozen=True)
class Motion:
    """The states of a run that can be drawn.

    Parameters
    ----------
    t : (k,) float64 [s]
    q : (k, n, 3) float64 [m], places about `middle`
    tension : (k, n_segments) float64 [N]
    energy : (k, 5) float64 [J], kinetic, elastic, potential since the start, work put in, dissipated
    broken_at : (n_segments,) float64 [s], when each segment broke; inf for never
    middle : (3,) float64 [m], of the motion, in the coordinates of the scene
    box : (2, 3) float64 [m], lowest and highest place, about `middle`
    left_out : int, states that are not finite
    """

    t: np.ndarray
    q: np.ndarray
    tension: np.ndarray
    energy: np.ndarray
    broken_at: np.ndarray
    middle: np.ndarray
    box: np.ndarray
    left_out: int

    @property
    def size(self) -> float:
        """Extent of the structure itself [m], in the first state; of one that diverges, the last may be anywhere."""
        return float(np.ptp(self.q[0], axis=0).max()) or 1.0

    @property
    def drifts(self) -> bool:
        """Whether the structure travels so far that it is small in a picture of all the motion."""
        return float(np.ptp(self.box, axis=0).max()) > DRIFTS * self.size

    @property
    def full_scale(self) -> float:
        """Tension at the end of the scale of colours [N]: the largest, or less if only a few are as large as that."""
        largest, common = float(self.tension.max(initial=0.0)), float(np.quantile(self.tension, 0.99)) if self.tension.size else 0.0
        return (common if 0.0 < CLIPPED * common < largest else largest) or 1.0


def motion_of(run: Any) -> Motion:
    """Return what can be drawn of a run.

    Raises
    ------
    InputError : no state of the run is finite
    """
    with np.errstate(invalid="ignore"):
        finite = (np.abs(run.q) < FAR).all(axis=(1, 2)) & np.isfinite(run.segment_tension).all(axis=1)
    finite &= np.isfinite(run.energy).all(axis=1)
    if not finite.any():
        raise InputError("A run that is looked at must have a finite state, but this one has none.")
    near = run.q if run.q_near is None else run.q_near
    box = _box(run, near[finite])
    middle = box.mean(axis=0)
    origin = 0.0 if run.q_near is None else run.q[finite][0, 0] - near[finite][0, 0]
    energy = run.energy[finite]
    potential = energy[:, 2] - energy[0, 2]
    return Motion(
        run.t[finite],
        near[finite] - middle,
        run.segment_tension[finite],
        np.column_stack([energy[:, 0], energy[:, 1], potential, energy[:, 3], energy[:, 4:].sum(axis=1)]),
        broken_at(run),
        middle + origin,
        box - middle,
        int(np.count_nonzero(~finite)),
    )


def _box(run: Any, q: np.ndarray) -> np.ndarray:
    """Lowest and highest place, without places to which a run that diverges has thrown nodes."""
    cables = run.scene.cables  # without any, nothing but `largest_distance` says how far what moves may go
    reach = ESCAPED * (np.ptp(q[0], axis=0).max() + sum(one.length for one in cables)) if cables else largest_distance(run.scene)
    held = q[:, [run.model.node(point.name) for point in run.scene.points if kind_of(point) != "free"]]
    lowest = np.concatenate([held.reshape(-1, 3), q[0]]).min(axis=0) - reach
    highest = np.concatenate([held.reshape(-1, 3), q[0]]).max(axis=0) + reach
    return np.array([np.clip(q, lowest, highest).min(axis=(0, 1)), np.clip(q, lowest, highest).max(axis=(0, 1))])


def kind_of(point: Any) -> str:
    """The word for a point in a scene file: "fixed", "driven" or "free"."""
    return "fixed" if isinstance(point, Fixed) else "driven" if isinstance(point, Driven) else "free"


def broken_at(run: Any) -> np.ndarray:
    """Return when each segment broke; in a state of that very time it still holds.

    Returns
    -------
    t : (n_segments,) float64 [s], in the order of `Run.segment_tension`; inf for never
    """
    found = np.full(run.model.n_segments, np.inf)
    for event in run.events:
        if event.segment is not None:
            found[run.model.segments(event.where)][event.segment] = event.t  # a view, as segments of a cable are a slice
    return found


def strain(run: Any, k: int) -> np.ndarray:
    """Return how much longer than at rest each segment is, l/L0(t) - 1.

    Parameters
    ----------
    run : Run
    k : number of a saved state

    Returns
    -------
    eps : (n_segments,) float64
    """
    changed, rest = at_time(run.scene, float(run.t[k])), np.empty(run.model.n_segments)
    for cable in run.scene.cables:
        rest[run.model.segments(cable.name)] = changed.get(cable.name, cable.length) / cable.segments
    q = run.q[k] if run.q_near is None else run.q_near[k]
    a, b = run.model.ends.T
    return np.linalg.norm(q[b] - q[a], axis=1) / rest - 1.0


def thinned(states: int, most: int) -> np.ndarray:
    """Numbers of at most so many states, evenly spaced, with the first and the last; int64."""
    return np.unique(np.linspace(0, states - 1, min(states, max(most, 2))).round().astype(np.int64))
