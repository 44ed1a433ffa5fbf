"""The flat arrays that compiled code sees: one type for every scene, so that every kernel is compiled once.

A kernel is given a net by its address, ``net.place``, and looks at it with `net_at`: handing over some thirty arrays by value would
cost as much as eighty nodes.

Nodes are numbered: interior nodes of the cables (each cable's run is contiguous, in elimination order), then the free
points, then the fixed and at last the driven ones. The first ``n_free`` nodes move; the rest are prescribed.
"""

from typing import NamedTuple

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from .path_kernel import TABLE

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1, _i2 = (types.Array(types.int64, d, "C") for d in (1, 2))


class Effects(NamedTuple):
    """The effects of a scene other than axial ones. Effect k has the numbers ``index[index_at[k]:index_at[k+1]]`` and
    ``params[params_at[k]:params_at[k+1]]`` and the functions at ``address[k]``: force, tangent and energy."""

    address: np.ndarray
    index: np.ndarray
    index_at: np.ndarray
    params: np.ndarray
    params_at: np.ndarray


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

    ``cable`` (n_cables, 8) int64: first segment, segments, first interior node, start node, end node, start is free,
    positions of the blocks (start, end) and (end, start) among the free points' blocks (-1 where there are none).
    ``law`` (n_cables, 7): L0 [m], k [N/m], c [N s/m], two-way spring, two-way damper, and the square of the highest frequency
    of a segment between the two masses at its ends, k (1/m_a + 1/m_b) [1/s2],
    and 1 where the cable does not stretch (its k and c are then 0).
    """

    n_free: int
    n_interior: int
    mass: np.ndarray  # (n,)
    degree: np.ndarray  # (n,) segments that a node has
    cable: np.ndarray
    law: np.ndarray
    paths: tuple
    n_driven: int  # first driven node
    effects: Effects
    points: Points
    segment: np.ndarray  # (n_segments, 12) scratch: the linearised law of each segment, columns in chain.py
    tension: np.ndarray  # (n_segments,) tension that the last Newton step predicted
    linearised: np.ndarray  # (2,) law of the stage that ``segment`` belongs to, -1 before the first, and its tau [s]
    pull: np.ndarray  # (n, 3) scratch
    kept: np.ndarray  # (points, 3) scratch
    right: np.ndarray  # (n, 3) right-hand side, overwritten by the elimination
    diagonal: np.ndarray  # (n_free, 3, 3)
    factor: np.ndarray  # (n_segments, 16) scratch of the elimination, see chain.py
    border: np.ndarray  # (n_segments, 16) the same for cables between two free points
    carried: np.ndarray  # (8, 3, 4) scratch of a cable between two free points
    step: np.ndarray  # (n, 3) the Newton step; zero on prescribed nodes
    middle_q: np.ndarray  # (n, 3) place and
    middle_v: np.ndarray  # (n, 3) velocity at which external forces are taken
    place: int = 0  # address of ``words``
    words: np.ndarray = np.empty(0, np.int64)  # this tuple as compiled code lays it out in memory, for `net_at`

    def placed(self):
        """The same net with its address; it and its arrays must outlive every use of the address."""
        words = np.empty(WORDS, np.int64)
        net = self._replace(words=words, place=words.ctypes.data)
        words[:] = _words(net)
        return net


EFFECTS = types.NamedTuple((_i2, _i1, _i1, _f1, _i1), Effects)
POINTS = types.NamedTuple((_i1,) * 6 + (_f3,), Points)
NET = types.NamedTuple(
    (types.int64, types.int64, _f1, _f1, _i2, _f2, TABLE, types.int64, EFFECTS, POINTS)
    + (_f2, _f1, _f1, _f2, _f2, _f2, _f3, _f2, _f2, _f3)
    + (_f2,) * 3
    + (types.int64, _i1),
    Net,
)


def _words(value):
    """A tuple of arrays and integers as Numba lays it out in memory, a word each: of an array no owner, no parent, then size,
    item size, address, shape and strides."""
    if isinstance(value, np.ndarray):
        return [0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides]
    if isinstance(value, tuple):
        return [word for part in value for word in _words(part)]
    return [value]


def _size(kind):
    """Words that a value of a Numba type takes."""
    if isinstance(kind, types.Array):
        return 5 + 2 * kind.ndim
    return sum(map(_size, kind)) if isinstance(kind, types.BaseTuple) else 1


WORDS = _size(NET)


@intrinsic
def net_at(typing_context, place):
    """The net at an address, borrowed: what is not used of it is not even read."""

    def codegen(context, builder, signature, args):
        model = context.data_model_manager[NET]
        pointer = builder.inttoptr(args[0], model.get_data_type().as_pointer())
        return _borrowed(context, builder, NET, model.load_from_data_pointer(builder, pointer))

    return NET(types.int64), codegen


def _borrowed(context, builder, kind, value):
    """``value`` with arrays that own nothing, so that no references are counted."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        parts = cgutils.unpack_tuple(builder, value, len(kind))
        return context.make_tuple(builder, kind, [_borrowed(context, builder, k, x) for k, x in zip(kind, parts, strict=True)])
    return value
