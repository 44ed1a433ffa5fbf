"""The flat arrays that compiled code sees: one type for every scene, so that every kernel is compiled once.

A kernel is given a net by its address, ``net.place``, and looks at it with `net_at`, see `integrators.addresses`.

Nodes are numbered: interior nodes of the cables (each cable's run is contiguous, in elimination order), then the free
points, then the fixed and at last the driven ones. The first ``n_free`` nodes move; the rest are prescribed.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from anet_lumped.prescribed.path_kernel import TABLE
from integrators.addresses import count_words, view_at, words_of

_f1, _f2, _f3, _f4 = (types.Array(types.float64, d, "C") for d in (1, 2, 3, 4))
_i1, _i2 = (types.Array(types.int64, d, "C") for d in (1, 2))


class Effects(NamedTuple):
    """The effects of a scene other than axial ones. Effect k has the numbers ``index[index_at[k]:index_at[k+1]]`` and
    ``params[params_at[k]:params_at[k+1]]`` and the functions at ``address[k]``, in the order of `signatures.SLOTS`."""

    address: np.ndarray
    index: np.ndarray
    index_at: np.ndarray
    params: np.ndarray
    params_at: np.ndarray
    linear: int  # 1 if the force of each is linear in the place and velocity of the node that it acts on


class Lengths(NamedTuple):
    """Rest lengths that change in time, see `rest_length`; all empty for a scene that has none.

    Row r belongs to cable ``cable[r]``: ``material[r]`` is its length [m], EA [N], damper c [N s/m], and 1 where c goes as
    1/length. Rows 2 r and 2 r + 1 of ``paths`` are, in x, the length paid out [m] and the strain at rest. A length x paid out
    adds ``mass_slope`` x to the masses ``mass_node``, and ``param_slope`` x to the effects' numbers ``param``, from
    ``mass_at[r]`` and ``param_at[r]`` on, to ``mass`` and ``params`` without it.
    """

    cable: np.ndarray
    material: np.ndarray  # (rows, 4)
    paths: tuple
    mass: np.ndarray
    mass_at: np.ndarray
    mass_node: np.ndarray
    mass_slope: np.ndarray
    params: np.ndarray
    param_at: np.ndarray
    param: np.ndarray
    param_slope: np.ndarray
    at: np.ndarray  # (3,) times of ``paid`` [s]
    paid: np.ndarray  # (4, rows) paid out before, in the middle and at the end of a step [m], and the rate at the end [m/s]
    trial: np.ndarray  # (2, rows) scratch
    place: np.ndarray  # (3, 2 rows, 3) scratch


class Points(NamedTuple):
    """Block LU of the system over the free points: symbolic part (elimination order, fill) and the blocks themselves.

    Free point p is eliminated p-th. Its later neighbours are ``later[later_at[p]:later_at[p+1]]``; ``upper`` and ``lower``
    are the positions of the blocks (p, j) and (j, p) in ``block``; the diagonal block of p is ``block[p]``. ``target`` holds,
    for each pair (i, j) of later neighbours in row order, the block that their product updates, from ``target_at[p]`` on.
    """

    later_at: np.ndarray
    later: np.ndarray
    upper: np.ndarray
    lower: np.ndarray
    target_at: np.ndarray
    target: np.ndarray
    block: np.ndarray


class Net(NamedTuple):
    """A model as compiled code sees it, with the scratch arrays of one run.

    ``cable`` (n_cables, 10) int64: first segment, segments, first interior node, start node, end node, start is free,
    positions of the blocks (start, end) and (end, start) among the free points' blocks (-1 where there are none), first row in
    ``springs`` and the one after the last (the same where there is no curve).
    ``law`` (n_cables, 9): L0 [m], k [N/m], c [N s/m], how much of k pushes, two-way damper, and the square of the highest frequency
    of a segment between the two masses at its ends, k (1/m_a + 1/m_b) [1/s2],
    and 1 where the cable does not stretch (its k and c are then 0); dL0/dt [m/s], and L0 at the start of a stage [m].
    """

    n_free: int
    n_interior: int
    mass: np.ndarray  # (n,)
    degree: np.ndarray  # (n,) segments that a node has
    cable: np.ndarray
    group: np.ndarray  # (groups, 5) cables that are taken at once, the last one repeated, and how many of the four count
    alone: np.ndarray  # (cables not in a group,)
    axial: np.ndarray
    springs: np.ndarray  # (rows, 2) of tension-strain curves, see `Cable.springs`
    paths: tuple
    n_driven: int  # first driven node
    effects: Effects
    lengths: Lengths
    points: Points
    segment: np.ndarray  # (n_segments, 14) scratch: the linearised law of each segment, columns in `tables`
    tension: np.ndarray  # (n_segments,) tension that the last Newton step predicted
    mean: np.ndarray  # (n_segments,) tension, averaged over the stages of a step
    linearised: np.ndarray  # (5,) of the stage that ``segment`` belongs to, columns in `tables`
    pull: np.ndarray  # (n, 3) scratch
    kept: np.ndarray  # (points, 3) scratch
    right: np.ndarray  # (n, 3) right-hand side, overwritten by the elimination
    diagonal: np.ndarray  # (n_free, 3, 3)
    factor: np.ndarray  # (n_segments, 16) scratch of the elimination, see `node_elimination`
    border: np.ndarray  # (n_segments, 16) the same for cables between two free points
    further: np.ndarray  # (n_segments, 12) the same where an effect couples next-but-one neighbours, empty where none does
    carried: np.ndarray  # (6, 4, 4) scratch of a cable between two free points
    step: np.ndarray  # (n, 3) the Newton step; zero on prescribed nodes
    middle_q: np.ndarray  # (n, 3) place and
    middle_v: np.ndarray  # (n, 3) velocity at which external forces are taken
    near: np.ndarray  # (n_segments, 2, 3, 3) blocks between neighbours, empty where no effect couples them
    far: np.ndarray  # (n_segments, 2, 3, 3) blocks between next-but-one neighbours, likewise
    added: np.ndarray  # (n_free, 3, 3) [kg] added mass, empty where no effect has any
    strength: np.ndarray  # (n_segments,) [N] tension at which each breaks, inf for never; empty where no cable does
    observed: np.ndarray  # (n_segments,) scratch, likewise
    remembered: np.ndarray  # scratch of `memory.remember`, likewise
    solver: int = 0  # address of the linear algebra where effects join neighbours, see `coupled`; 0 for that of `chain`
    place: int = 0  # address of ``words``
    words: np.ndarray = np.empty(0, np.int64)  # this tuple as compiled code lays it out in memory, for `net_at`

    def placed(self):
        """The same net with its address; it and its arrays must outlive every use of the address."""
        held = np.empty(WORDS, np.int64)
        net = self._replace(words=held, place=held.ctypes.data)
        held[:] = words_of(net)
        return net


EFFECTS = types.NamedTuple((_i2, _i1, _i1, _f1, _i1, types.int64), Effects)
LENGTHS = types.NamedTuple((_i1, _f2, TABLE, _f1, _i1, _i1, _f1, _f1, _i1, _i1, _f1, _f1, _f2, _f2, _f3), Lengths)
POINTS = types.NamedTuple((_i1,) * 6 + (_f3,), Points)
NET = types.NamedTuple(
    (types.int64, types.int64, _f1, _f1, _i2, _i2, _i1, _f2, _f2, TABLE, types.int64, EFFECTS, LENGTHS, POINTS)
    + (_f2, _f1, _f1, _f1, _f2, _f2, _f2, _f3, _f2, _f2, _f2, _f3)
    + (_f2,) * 3
    + (_f4, _f4, _f3)
    + (_f1,) * 3
    + (types.int64, types.int64, _i1),
    Net,
)


WORDS = count_words(NET)
net_at = view_at(NET)
