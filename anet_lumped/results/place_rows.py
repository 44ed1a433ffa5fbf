"""What compiled passes over the saved states of a run read and write, for the errors of its places, see `error_estimate`.

All arrays are at one address, so that a call costs little.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from integrators.addresses import view_at

# columns of `PlaceRows.nodes`
BETWEEN, SEVERAL = range(2)
# rows of `PlaceRows.columns`
TIME, GROWTH, MOTION, MOVED, BASE = range(5)
FLIGHT, MULTIPLIED, WAYS, LEFT, LOST, FIRST, SECOND, THIRD = range(7, 15)
COLUMNS = 15
# of `PlaceRows.numbers`, given
FALLS, DRIVEN, UNTIL, IS_SEEN, RATE, WEIGHT = range(6)
# of `PlaceRows.numbers`, written
FIRST_LOOSE, FLYING, TOGETHER = range(6, 9)
NUMBERS = 9
# columns of `PlaceRows.segments`
START, END, HOLDS = range(3)
# rows of `PlaceRows.of_nodes` and of `PlaceRows.of_segments`
MASS, OFF, GROWN, ASIDE, SPEED = range(5)
OF_NODES = 5
LENGTH, STIFFNESS = range(2)


class PlaceRows(NamedTuple):
    """Arrays of the passes over k saved states of n nodes, of which n_free move, and s segments.

    Parameters
    ----------
    q, v : (k, n, 3) float64 [m], [m/s]
    tension : (k, s) float64 [N]
    energy : (k, 7) float64 [J], see `energy_balance.COLUMNS`
    segments : (s, 3) int64, nodes at both ends of each, and 1 of one that pushes and so holds its nodes as a taut one does
    nodes : (n_free, 2) int64, 1 of a node between several segments, or of a cable of several, and of the latter alone
    flies : (k, n_free) bool, written: which nodes have no taut segment
    columns : (COLUMNS, k) float64
        Given: saved times [s]; what the steps have left out of places [m]; the energy of the motion [J]; the share of the energy in
        play that a method which books nothing has taken or given; the mean way of the prescribed nodes, three rows [m].
        Written: the errors of flights up to each saved time [m]; the logarithm of what the motion has multiplied errors by; the
        longest way of a node from its start [m]; what is left of errors [m]; the way that lost energy takes [m]. Then scratch.
    numbers : (NUMBERS,) float64
        Given: whether nothing but gravity acts, whether nodes are driven, the row from which on growth is not looked for, whether
        it is at all, the least rate at which an axial vibration fades [1/s], and the weight of all that moves [N], 0 where
        stretching alone is no bound.
        Written: the first row after the start at which a node between several segments flies, -1 for none; the share of saved times
        at which one flies; between how many saved times tensions count as one, 0 where nothing can grow.
    of_nodes : (OF_NODES, n) float64, given: masses [kg], 0 of a node that is held; then scratch
    of_segments : (2, s) float64, scratch
    """

    q: np.ndarray
    v: np.ndarray
    tension: np.ndarray
    energy: np.ndarray
    segments: np.ndarray
    nodes: np.ndarray
    flies: np.ndarray
    columns: np.ndarray
    numbers: np.ndarray
    of_nodes: np.ndarray
    of_segments: np.ndarray


_f1, _f2, _f3 = (types.Array(types.float64, n, "C") for n in (1, 2, 3))
_i2, _b2 = types.Array(types.int64, 2, "C"), types.Array(types.boolean, 2, "C")
place_rows_at = view_at(types.NamedTuple((_f3, _f3, _f2, _f2, _i2, _i2, _b2, _f2, _f1, _f2, _f2), PlaceRows))
