"""The saved states of a run as arrays for compiled passes: `node_pass`, `across_kernel` and `fading`."""

import math
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.model.tables import CABLE_END, CABLE_SEGMENTS, CABLE_START
from integrators.addresses import words_of

from .buckling import BENDS, buckling_exponents
from .energy_balance import COLUMNS as OF_ENERGY
from .place_rows import (
    BETWEEN,
    COLUMNS,
    END,
    FALLS,
    GROWTH,
    HOLDS,
    IS_SEEN,
    MASS,
    NUMBERS,
    OF_NODES,
    SEVERAL,
    TIME,
    UNTIL,
    PlaceRows,
)

SEEN = 1e-5  # of the longest cable: less error than that may grow unseen
ROUNDING = 1e-12  # of the extent of a scene: places that are less off a line are on it
LARGEST_EXPONENT = 300.0  # of which the exponential is a number


class SavedMotion(NamedTuple):
    """The arrays of a run, which passes read and write, and the words by which they find them."""

    rows: PlaceRows
    words: np.ndarray

    @property
    def address(self) -> int:
        """Address of `PlaceRows`."""
        return self.words.ctypes.data


def look_at(run: Any, grows: bool = False) -> SavedMotion:
    """The saved states of a run, after a pass over its nodes.

    ``grows`` says whether to look for what the motion may multiply errors by.
    """
    from .node_pass import look_at_nodes  # compiled on first use

    model, k, n_free = run.model, len(run.t), run.model.n_free
    numbers, columns, of_nodes = np.zeros(NUMBERS), np.zeros((COLUMNS, k)), np.zeros((OF_NODES, model.n))
    numbers[FALLS], numbers[UNTIL], numbers[IS_SEEN] = _falls(run.scene), k, grows and _is_seen(run)
    columns[TIME] = run.t
    if run.error_growth is not None:
        columns[GROWTH] = run.error_growth
    of_nodes[MASS, :n_free] = model.mass[:n_free]
    energy = run.energy if run.energy.shape[1] == len(OF_ENERGY) else np.zeros((k, len(OF_ENERGY)))
    q, v, tension, energy = map(np.ascontiguousarray, (run.q, run.v, run.segment_tension, energy))
    flies, of_segments = np.zeros((k, n_free), bool), np.zeros((2, model.n_segments))
    rows = PlaceRows(q, v, tension, energy, _segments(model), _nodes(model), flies, columns, numbers, of_nodes, of_segments)
    seen = SavedMotion(rows, np.array(words_of(rows), np.int64))
    look_at_nodes(seen.address)
    return seen


def _segments(model: Any) -> np.ndarray:
    """`PlaceRows.segments` of a model."""
    segments = np.zeros((model.n_segments, 3), np.int64)
    segments[:, : END + 1] = model.ends
    pushes = [cable.compression == "linear" for cable in model.scene.cables]
    if any(pushes):
        segments[:, HOLDS] = np.array(pushes)[model.cable_of]
    return segments


def _nodes(model: Any) -> np.ndarray:
    """`PlaceRows.nodes` of a model."""
    several = np.zeros(model.n, np.int64)
    of_several = model.cable[model.cable[:, CABLE_SEGMENTS] > 1]
    several[: model.n_interior] = several[of_several[:, CABLE_START]] = several[of_several[:, CABLE_END]] = 1
    nodes = np.empty((model.n_free, 2), np.int64)
    nodes[:, SEVERAL] = several[: model.n_free]
    nodes[:, BETWEEN] = nodes[:, SEVERAL] | (model.node_segments[: model.n_free] > 1)
    return nodes


def _is_seen(run: Any) -> bool:
    """Whether the run has an error that is worth looking at, and no more across it than tensions."""
    if run.model.has_bodies or any(effect.coupled_neighbours >= BENDS for effect in run.scene.effects):
        return False
    error, least = run.error_growth[-1], SEEN * run.scene.longest
    on_one_line = _on_one_line(run.q)
    if error > least and not on_one_line:
        return True
    exponent = min(buckling_exponents(run)[-1], LARGEST_EXPONENT)
    nothing_to_grow = on_one_line and exponent > 0.0  # by buckling, which multiplies what is off the line
    return error * math.exp(exponent) > least and not nothing_to_grow


def _on_one_line(q: np.ndarray) -> bool:
    """Whether all places (k, n, 3) of all times are on one line."""
    first = q[0] - q[0, 0]
    lengths = np.linalg.norm(first, axis=1)
    if (extent := lengths.max()) == 0.0:
        return True
    along = first[lengths.argmax()] / extent

    def off(away: np.ndarray) -> float:
        return float(np.abs(away - (away @ along)[..., None] * along).max())

    # most motions leave a line between their first and their last state, which spares a look at all of them
    return all(off(rows - q[0, 0]) <= ROUNDING * extent for rows in (q[:1], q[-1:], q))


def _falls(scene: Any) -> bool:
    """Whether nothing but gravity acts on nodes."""
    return all(effect.dead_load and any(effect.uniform_acceleration) for effect in scene.effects)
