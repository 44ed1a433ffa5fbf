"""The flat arrays that compiled code sees: one type for every scene, so that every kernel is compiled once.

A kernel is given a net by its address, ``net.address``, and looks at it with `view_net`, see `integrators.addresses`.

Nodes are numbered: interior nodes of the cables (each cable's run is contiguous, in elimination order), then the free
points, then the points of bodies, then the fixed and at last the driven ones. The first ``n_free`` nodes move; the rest are
prescribed.
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
    ``params[params_at[k]:params_at[k+1]]`` and the functions at ``address[k]``, in the order of `signatures.SLOTS`. ``inner`` (m,)
    are the positions in ``params`` of inner states."""

    address: np.ndarray
    index: np.ndarray
    index_at: np.ndarray
    params: np.ndarray
    params_at: np.ndarray
    linear_in_node_state: int  # 1 if the force of each is linear in the position and velocity of the node that it acts on
    inner: np.ndarray

    def numbers(self, e):
        """Index and parameters of the e-th effect."""
        return (
            self.index[self.index_at[e] : self.index_at[e + 1]],
            self.params[self.params_at[e] : self.params_at[e + 1]],
        )


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
    times: np.ndarray  # (3,) of ``paid`` [s]
    paid: np.ndarray  # (4, rows) paid out before, in the middle and at the end of a step [m], and the rate at the end [m/s]
    trial: np.ndarray  # (2, rows) scratch
    path_values: np.ndarray  # (3, 2 rows, 3) scratch


class Bodies(NamedTuple):
    """Rigid bodies that move freely or are pinned; the nodes of body b are ``node[node_at[b]:node_at[b + 1]]``.

    The first two nodes of each body lend their rows to its unknowns in the system over the free points: how far its centre of mass
    shifts, and how far it turns; where it is pinned to another body, the third one lends its row to the force of the joint.
    `tables` names the columns of ``joined``, ``joint``, ``joint_pairs``, ``state`` and ``jointed``.
    """

    first: int  # first node that a body carries; ``n_free`` if there are none
    node_at: np.ndarray
    node: np.ndarray
    pivot: np.ndarray  # (bodies,) node about which a body is pinned at a place of the world, -1 for any other
    arm: np.ndarray  # (nodes, 3) [m] place of each node in the axes of its body
    blocks: np.ndarray  # (bodies, 2) blocks (shift, turn) and (turn, shift)
    joined: np.ndarray  # (pairs, 14) cables that end at a body and at another one, or at a free point
    pairs: np.ndarray  # (pairs, 3) body, and two of its nodes, by their places in ``node``, of which effects may join the forces
    joint: np.ndarray  # (joints, 14) bodies that are pinned to another body, or to a point that moves
    joint_pairs: np.ndarray  # (pairs, 4) joints at one body
    arm_end: np.ndarray  # (nodes, 3) [m] scratch: place from the centre of mass, or from the pivot, in the stage
    arm_mean: np.ndarray  # (nodes, 3) [m] scratch: where forces act from there, in the mean over a step
    slowing: np.ndarray  # (nodes, 3) [m/s2] scratch: opposite of the mean acceleration of each node in the stage, from ``first`` on
    state: np.ndarray  # (bodies, columns) scratch
    jointed: np.ndarray  # (bodies, columns) scratch; empty without joints
    joint_gap: np.ndarray  # (joints, 3) scratch: what is to change at each joint, a place, a velocity or an acceleration
    joint_force: np.ndarray  # (joints, 3) scratch: what changes it, on the body that is pinned

    def of_a_run(self):
        """The same with scratch of its own."""
        return self._replace(**{name: getattr(self, name).copy() for name in self._fields[self._fields.index("arm_end") :]})


class Carried(NamedTuple):
    """Points of bodies whose motion is prescribed, the last nodes.

    ``Net.paths`` ends with two paths a body, of its origin and of its rotation vector.
    """

    body: np.ndarray  # (nodes,) which of these bodies carries each
    arm: np.ndarray  # (nodes, 3) [m] from the origin, as the body starts
    values: np.ndarray  # (3, paths, 3) scratch of positions, velocities and accelerations; empty without such bodies


class Fronts(NamedTuple):
    """Elimination of many free points by dense matrices, see `model.fronts`; empty where there are few.

    `tables` names the columns of ``front``.
    """

    front: np.ndarray  # (fronts, 7) those that are added to a front stand before it
    entry: np.ndarray  # (blocks, 3) a block of the system, and its row and column among the points of the front
    point: np.ndarray  # pivots and rows of each front
    in_parent: np.ndarray  # where each row stands among the points of the front that this one is added to; -1 for pivots
    factor: np.ndarray  # scratch: the rows of U of each front
    dense: np.ndarray  # scratch: the front at hand
    waiting: np.ndarray  # scratch: what is left of fronts until it is added

    def of_a_run(self):
        """The same with scratch of its own."""
        return self._replace(**{name: np.empty_like(getattr(self, name)) for name in self._fields[4:]})


class Trails(NamedTuple):
    """Walks over segments that the force at one time takes by fours, see `model.trails`; empty for a run without such forces.

    Group g goes along the rows ``run[g, 0]`` to ``run[g, 0] + run[g, 1]`` of ``position``; the segments that end at the nodes of a
    row have the numbers in the same row of ``number``.
    """

    law: np.ndarray  # (groups, 2) share of the stiffness that pushes, and 1 for a damper that acts on slack segments too
    run: np.ndarray  # (groups, 2)
    position: np.ndarray  # (rows, 4) where the row of a node begins in a flat (n, 3) array
    number: np.ndarray  # (rows, 12) L0 [m] of four segments, their k [N/m] and c [N s/m]
    other_cables: np.ndarray  # single cables that no trail goes along


class Points(NamedTuple):
    """Block LU of the system over the free points: symbolic part (elimination order, fill) and the blocks themselves.

    Free point p = ``order[e]`` is eliminated e-th; the unknowns of bodies, two a body, count as points too. Its later neighbours
    are ``later[later_at[e]:later_at[e+1]]``; ``upper`` and ``lower`` are the positions of the blocks (p, j) and (j, p) in
    ``block``; the diagonal block of p is ``block[p]``. ``target`` holds, for each pair (i, j) of later neighbours in row order, the
    block that their product updates, from ``target_at[e]`` on. The first blocks are those of the free nodes from ``n_interior`` on,
    also of nodes that bodies carry, which are not eliminated here. Many points are eliminated by ``fronts``; then later neighbours
    are without fill, and ``target`` is empty.
    """

    order: np.ndarray
    later_at: np.ndarray
    later: np.ndarray
    upper: np.ndarray
    lower: np.ndarray
    target_at: np.ndarray
    target: np.ndarray
    block: np.ndarray
    fronts: Fronts

    def of_a_run(self):
        """The same with numbers of its own."""
        return self._replace(block=np.zeros_like(self.block), fronts=self.fronts.of_a_run())


class Links(NamedTuple):
    """The system of the tensions of links, segments that do not stretch, see `link_order`; empty for a run without links.

    End link u is segment ``segment[u]`` and is eliminated u-th. Its later neighbours are ``later[later_at[u]:later_at[u+1]]``;
    their positions there are those of the entries that join both. ``target`` holds the entry that each pair of later neighbours
    updates, in row order, from ``target_at[u]`` on. `tables` names the columns of ``unknown``, ``meeting`` and ``state``.
    """

    unknown: np.ndarray  # (n_cables, 3)
    segment: np.ndarray
    later_at: np.ndarray
    later: np.ndarray
    target_at: np.ndarray
    target: np.ndarray
    meeting: np.ndarray  # (pairs, 5)
    body_meeting: np.ndarray  # (pairs, 7)
    mobility: np.ndarray  # (n,) [1/kg] inverse of the masses, 0 for prescribed nodes
    matrix_mobility: np.ndarray  # (nodes, 3, 3) of the last moving nodes: of bodies' ones, or with added mass of all
    vector: np.ndarray  # (n_segments, 3) [m]
    diagonal: np.ndarray  # (n_segments,) of the system
    pivot: np.ndarray  # (n_segments,) inverse of the pivot
    to_next: np.ndarray  # (n_segments,) factor towards the next link of the cable
    to_start: np.ndarray  # (n_segments,) factor towards the first link of the cable, which is an end link
    end_pivot: np.ndarray  # (end links,) inverse of the pivot; while the system is put together, its diagonal
    entry: np.ndarray  # (entries,) of the system of the end links, and its factors
    right_side: np.ndarray  # (n_segments,) and the solution
    tau: np.ndarray  # (n_segments,) [N/m] tension over length
    acceleration: np.ndarray  # (n, 3) [m/s2]
    driven: np.ndarray  # (3, driven nodes, 3) scratch of places and velocities, and the velocities before an impulse
    body: np.ndarray  # (bodies, 27) inertia
    body_pull: (
        np.ndarray
    )  # (nodes of bodies, 3) [N] scratch: pull of the links on each node from `Bodies.first` on; zero between uses
    state: np.ndarray  # (4,)

    def of_a_run(self):
        """The same with numbers of its own."""
        return self._replace(**{name: getattr(self, name).copy() for name in self._fields[8:]})


class Net(NamedTuple):
    """A model as compiled code sees it, with the scratch arrays of one run.

    `tables` names the columns of ``cable``, ``axial``, ``springs``, ``creep``, ``crept``, ``segment`` and ``linearised``.
    """

    n_free: int
    n_interior: int
    mass: np.ndarray  # (n,)
    node_segments: np.ndarray  # (n,) segments that a node has
    cable: np.ndarray
    cable_groups: np.ndarray  # (groups, 5) cables that are taken at once, the last one repeated, and how many of the four count
    single_cables: np.ndarray  # (cables not in a group,): first those of one segment, then those between two free points, the rest
    single_kinds: np.ndarray  # (2,) where in ``single_cables`` the second and the third kind begin
    trails: Trails
    axial: np.ndarray
    springs: np.ndarray  # (rows, 2) of tension-strain curves, see `Cable.springs`
    creep: np.ndarray  # (n_cables, 9) of cables that creep, columns in `tables`; empty where none does, and in statics
    crept: np.ndarray  # (n_segments, 3) slow stretch of each segment, its last change and largest tension, likewise
    paths: tuple
    n_driven: int  # first driven node
    carried: Carried
    effects: Effects
    lengths: Lengths
    points: Points
    bodies: Bodies
    joints: Points  # the same system over the forces of the joints of bodies
    segment: np.ndarray  # (n_segments, 14) scratch: the linearised law of each segment, columns in `tables`
    tension: np.ndarray  # (n_segments,) tension that the last Newton step predicted
    mean_tension: np.ndarray  # (n_segments,) tension, averaged over the stages of a step
    linearised: np.ndarray  # (8,) of the stage that ``segment`` belongs to, columns in `tables`
    law_force: np.ndarray  # (n, 3) scratch
    predicted_force: np.ndarray  # (points, 3) scratch
    right_side: np.ndarray  # (n, 3) right-hand side, overwritten by the elimination
    diagonal: np.ndarray  # (n_free, 3, 3)
    factor: np.ndarray  # (n_segments, 16) scratch of the elimination, columns in `tables`
    border: np.ndarray  # (n_segments, 16) the same for cables between two free points, columns in `tables`
    far_factor: np.ndarray  # (n_segments, 12) the same where an effect couples next-but-one neighbours, empty where none does
    border_work: np.ndarray  # (6, 4, 4) scratch of a cable between two free points, see `bordered`
    newton_step: np.ndarray  # (n, 3) the Newton step; zero on prescribed nodes
    middle_q: np.ndarray  # (n, 3) place and
    middle_v: np.ndarray  # (n, 3) velocity at which external forces are taken
    near_blocks: np.ndarray  # (n_segments + pairs of bodies, 2, 3, 3) blocks between neighbours, empty where no effect couples them
    far_blocks: np.ndarray  # (n_segments, 2, 3, 3) blocks between next-but-one neighbours, likewise
    added_mass: np.ndarray  # (n_free, 3, 3) [kg] added mass, empty where no effect has any
    breaking_tension: np.ndarray  # (n_segments,) [N] tension at which each breaks, inf for never; empty where no cable does
    observed_tension: np.ndarray  # (n_segments,) scratch, likewise
    remembered: np.ndarray  # scratch of `memory.remember`, likewise
    links: Links
    kernels: np.ndarray = np.empty(0, np.int64)  # (KERNELS,) addresses of kernels that only some scenes need, 0 for none
    address: int = 0  # address of ``words``
    words: np.ndarray = np.empty(0, np.int64)  # this tuple as compiled code lays it out in memory, for `view_net`

    def addressed(self):
        """The same net with its address; it and its arrays must outlive every use of the address."""
        held = np.empty(WORDS, np.int64)
        net = self._replace(words=held, address=held.ctypes.data)
        held[:] = words_of(net)
        return net


EFFECTS = types.NamedTuple((_i2, _i1, _i1, _f1, _i1, types.int64, _i1), Effects)
LENGTHS = types.NamedTuple((_i1, _f2, TABLE, _f1, _i1, _i1, _f1, _f1, _i1, _i1, _f1, _f1, _f2, _f2, _f3), Lengths)
CARRIED = types.NamedTuple((_i1, _f2, _f3), Carried)
BODIES = types.NamedTuple((types.int64, _i1, _i1, _i1, _f2) + (_i2,) * 5 + (_f2,) * 7, Bodies)
FRONTS = types.NamedTuple((_i2, _i2, _i1, _i1) + (_f1,) * 3, Fronts)
TRAILS = types.NamedTuple((_f2, _i2, _i2, _f2, _i1), Trails)
POINTS = types.NamedTuple((_i1,) * 7 + (_f3, FRONTS), Points)
LINKS = types.NamedTuple((_i2,) + (_i1,) * 5 + (_i2, _i2, _f1, _f3, _f2) + (_f1,) * 8 + (_f2, _f3, _f2, _f2, _f1), Links)


def _empty(kind):
    """The tuple of arrays of a type, without an entry."""
    return kind.instance_class(*(np.zeros((0,) * of.ndim, np.int64 if of.dtype == types.int64 else float) for of in kind.types))


NO_LINKS, NO_FRONTS, NO_TRAILS = _empty(LINKS), _empty(FRONTS), _empty(TRAILS)
NET = types.NamedTuple(
    (types.int64, types.int64, _f1, _f1, _i2, _i2, _i1, _i1, TRAILS, _f2, _f2, _f2, _f2, TABLE, types.int64)
    + (CARRIED, EFFECTS, LENGTHS, POINTS, BODIES, POINTS)
    + (_f2, _f1, _f1, _f1, _f2, _f2, _f2, _f3, _f2, _f2, _f2, _f3)
    + (_f2,) * 3
    + (_f4, _f4, _f3)
    + (_f1,) * 3
    + (LINKS, _i1, types.int64, _i1),
    Net,
)


WORDS = count_words(NET)
view_net = view_at(NET)
