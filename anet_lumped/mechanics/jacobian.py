"""The sparse analytic Jacobian of the motion as a system of first order, y = (q, v) of the moving nodes, M dv/dt = f(t, q, v)."""

from typing import NamedTuple

import numpy as np
from numba import types, void
from scipy.sparse import csc_array

from anet_lumped.compiled.jit import internal, kernel
from anet_lumped.effects.laws.axial import tension_slopes
from anet_lumped.effects.signatures import as_tangent
from anet_lumped.mechanics.effect_forces import add_masses, clear, numbers_of
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    SLOT_TANGENT,
)

from .linear import node_elimination as elimination
from .segment_law import SHORTEST, spring_of

_f2, _f3 = (types.Array(types.float64, d, "C") for d in (2, 3))
_i1, _i2 = (types.Array(types.int64, d, "C") for d in (1, 2))


class Pattern(NamedTuple):
    """Positions of all entries of the Jacobian. They are the same for every state of a model.

    The 3x3 blocks are numbered: first the block of every moving node with itself; then both blocks of every pair of moving nodes
    that a segment joins, and of every pair that is two segments apart where an effect joins such pairs. Write the blocks of
    df/dq, those of df/dv and a 1 one after the other: entry e of the matrix in compressed columns is ``scale[e]`` times
    number ``source[e]`` of that row.
    """

    slot: np.ndarray  # (n_segments, 2) int64: blocks (first node, second node) and back; -1 if either node is prescribed
    far_slot: np.ndarray  # (n_segments, 2) int64: blocks (first node, second node of the next segment) and back, likewise
    row: np.ndarray  # (blocks,) int64: node of whose force a block is the derivative
    blocks: int
    indices: np.ndarray
    indptr: np.ndarray
    source: np.ndarray
    scale: np.ndarray  # 1 or 1/m


def pattern(model):
    """`Pattern` of a model."""
    n = model.n_free
    number = {(i, i): i for i in range(n)}
    slot = np.full((model.n_segments, 2), -1, np.int64)
    for s, (a, b) in enumerate(model.ends.tolist()):
        if a < n and b < n:
            slot[s] = [number.setdefault(pair, len(number)) for pair in ((a, b), (b, a))]
    far_slot = np.full((model.n_segments, 2), -1, np.int64)
    if model.coupled_neighbours > 1:
        for s in range(model.n_segments - 1):
            a, b = int(model.ends[s, 0]), int(model.ends[s + 1, 1])
            if model.cable_of[s] == model.cable_of[s + 1] and a < n and b < n:
                far_slot[s] = [number.setdefault(pair, len(number)) for pair in ((a, b), (b, a))]
    i, j = np.array(list(number), np.int64).reshape(-1, 2).T
    x, y = np.divmod(np.arange(9), 3)
    row, column = (3 * i[:, None] + x).ravel(), (3 * j[:, None] + y).ravel()
    rows = np.concatenate([3 * n + row, 3 * n + row, np.arange(3 * n)])
    columns = np.concatenate([column, 3 * n + column, 3 * n + np.arange(3 * n)])
    source = np.minimum(np.arange(len(rows)), 2 * len(row))
    scale = np.concatenate([np.tile(1.0 / model.mass[row // 3], 2), np.ones(3 * n)])
    order = np.lexsort((rows, columns))
    indptr = np.searchsorted(columns[order], np.arange(6 * n + 1))
    return Pattern(
        slot, far_slot, np.ascontiguousarray(i), len(number),
        rows[order].astype(np.int32), indptr.astype(np.int32), source[order], scale[order],
    )  # fmt: skip


@internal
def _add_couplings(net, slot, far_slot, blocks_of_pairs):
    """Add ``net.near_blocks`` and ``net.far_blocks`` to the blocks of pairs of moving nodes, then set both to zero."""
    for s in range(min(net.near_blocks.shape[0], slot.shape[0])):
        for way in range(2):
            for x in range(3):
                for y in range(3):
                    if slot[s, way] >= 0:
                        blocks_of_pairs[slot[s, way], x, y] += net.near_blocks[s, way, x, y]
                    if net.far_blocks.shape[0] > 0 and far_slot[s, way] >= 0:
                        blocks_of_pairs[far_slot[s, way], x, y] += net.far_blocks[s, way, x, y]
    clear(net.near_blocks)
    clear(net.far_blocks)


@internal
def _with_fluid(net, row, force_blocks):
    """Multiply the blocks of the force on a node by m (m I + A)^-1, with its mass m and added mass A, as `force` does the force."""
    for b in range(force_blocks.shape[0]):
        m, A = net.mass[row[b]], net.added_mass[row[b]]
        inverse = elimination.inverse((m + A[0, 0], A[0, 1], A[0, 2], A[1, 0], m + A[1, 1], A[1, 2], A[2, 0], A[2, 1], m + A[2, 2]))
        for y in range(3):
            force_blocks[b, 0, y], force_blocks[b, 1, y], force_blocks[b, 2, y] = elimination.times(
                inverse, m * force_blocks[b, 0, y], m * force_blocks[b, 1, y], m * force_blocks[b, 2, y]
            )


@kernel(void(types.float64, _f2, _f2, types.int64, _i2, _i2, _i1, _f3, _f3))
def blocks(t, q, v, net_address, slot, far_slot, row, df_dq, df_dv):
    """Blocks of df/dq and df/dv.

    A segment from node a to node b, d = q_b - q_a of length l and n = d/l, u = v_b - v_a, pulls a with T n, where

        d(T n)/dd = n (T_l n + T_r (u - r n)/l)^T + (T/l)(I - n n^T),    d(T n)/du = T_r n n^T,    r = n . u ,

    with the slopes T_l, T_r of the axial law in length and rate. Effects add their blocks. With added masses A the blocks of a
    node's force are multiplied by m (m I + A)^-1; the derivative of this factor is left out.

    Parameters
    ----------
    t : float [s]
    q, v : (n, 3) float64 [m], [m/s]; prescribed rows hold the prescribed motion
    net_address : int, address of the net
    slot, far_slot, row : see `Pattern`
    df_dq, df_dv : (blocks, 3, 3) float64 [N/m], [N s/m], overwritten
    """
    net = view_net(net_address)
    n_free, effects = net.n_free, net.effects
    clear(df_dq)
    clear(df_dv)
    for e in range(effects.address.shape[0]):
        if effects.address[e, SLOT_TANGENT] == 0:
            continue
        (index, params), tangent = numbers_of(effects, e), as_tangent(effects.address[e, SLOT_TANGENT])
        tangent(t, q, v, index, params, -1.0, 0.0, df_dq[:n_free], net.near_blocks, net.far_blocks)
        _add_couplings(net, slot, far_slot, df_dq)
        tangent(t, q, v, index, params, 0.0, -1.0, df_dv[:n_free], net.near_blocks, net.far_blocks)
        _add_couplings(net, slot, far_slot, df_dv)
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        spring, L0, damper = spring_of(net, c), net.axial[c, AXIAL_L0], net.axial[c, AXIAL_DAMPER]
        two_way_damper = net.axial[c, AXIAL_TWO_WAY_DAMPER]
        a = net.cable[c, CABLE_START]
        for j in range(count):
            b = node + j if j < count - 1 else net.cable[c, CABLE_END]
            dx, dy, dz = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1], q[b, 2] - q[a, 2]
            ux, uy, uz = v[b, 0] - v[a, 0], v[b, 1] - v[a, 1], v[b, 2] - v[a, 2]
            l = (dx * dx + dy * dy + dz * dz) ** 0.5
            per_l = 1.0 / max(l, SHORTEST * L0)
            n = (dx * per_l, dy * per_l, dz * per_l)
            rate = n[0] * ux + n[1] * uy + n[2] * uz
            T, length_slope, rate_slope = tension_slopes(l - L0, rate, spring, damper, two_way_damper)
            tension_per_length, rate_slope_per_length = T * per_l, rate_slope * per_l
            along_slope = length_slope - rate_slope_per_length * rate - tension_per_length
            gradient = (
                along_slope * n[0] + rate_slope_per_length * ux,
                along_slope * n[1] + rate_slope_per_length * uy,
                along_slope * n[2] + rate_slope_per_length * uz,
            )
            ab, ba = slot[first + j, 0], slot[first + j, 1]
            for x in range(3):
                for y in range(3):
                    K, C = n[x] * gradient[y], rate_slope * n[x] * n[y]
                    if x == y:
                        K += tension_per_length
                    if a < n_free:
                        df_dq[a, x, y] -= K
                        df_dv[a, x, y] -= C
                    if b < n_free:
                        df_dq[b, x, y] -= K
                        df_dv[b, x, y] -= C
                    if ab >= 0:
                        df_dq[ab, x, y] += K
                        df_dv[ab, x, y] += C
                        df_dq[ba, x, y] += K
                        df_dv[ba, x, y] += C
            a = b
    if net.added_mass.shape[0] > 0:
        add_masses(net, t, q)
        _with_fluid(net, row, df_dq)
        _with_fluid(net, row, df_dv)


def sparse_jacobian(model, net):
    """Jacobian of dy/dt = (v, f/m) for y = (q, v) of the moving nodes.

    Parameters
    ----------
    model : Model
    net : Net
        The model's own, with its scratch arrays.

    Returns
    -------
    jacobian : callable (t, q, v) -> csc_array (6 n_free, 6 n_free)
        t [s], q and v (n, 3) [m], [m/s] with the prescribed rows filled in. The pattern is fixed; zeros in it are kept.
    """
    found, size = pattern(model), 6 * model.n_free
    values = np.ones(18 * found.blocks + 1)
    df_dq, df_dv = values[:-1].reshape(2, found.blocks, 3, 3)

    def jacobian(t, q, v):
        blocks(t, q, v, net.address, found.slot, found.far_slot, found.row, df_dq, df_dv)
        return csc_array((values[found.source] * found.scale, found.indices, found.indptr), shape=(size, size))

    return jacobian
