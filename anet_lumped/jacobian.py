"""The sparse analytic Jacobian of the motion at first order: y = (q, v) of the moving nodes, M dv/dt = f(t, q, v)."""

from typing import NamedTuple

import numpy as np
from numba import njit, types, void
from scipy.sparse import csc_array

from .chain import END, FIRST_NODE, FIRST_SEGMENT, SEGMENTS, START
from .effects.axial import tension_slopes
from .effects.signatures import as_tangent
from .net import net_at

_f2, _f3 = (types.Array(types.float64, d, "C") for d in (2, 3))
_i2 = types.Array(types.int64, 2, "C")


class Pattern(NamedTuple):
    """Where the numbers of the Jacobian go; the same for every state of a model.

    The 3x3 blocks are numbered: first those of every moving node with itself, then both directions of every pair of
    moving nodes that a segment joins. Entry e of the matrix in compressed columns is ``scale[e]`` times entry
    ``source[e]`` of all blocks of df/dq, all blocks of df/dv and a last 1.
    """

    slot: np.ndarray  # (n_segments, 2) int64: blocks (first node, second node) and back; -1 if one is prescribed
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
        slot, len(number), rows[order].astype(np.int32), indptr.astype(np.int32), source[order], scale[order]
    )


@njit(void(types.float64, _f2, _f2, types.int64, _i2, _f3, _f3), cache=True, error_model="numpy")
def blocks(t, q, v, place, slot, of_q, of_v):
    """Blocks of df/dq and df/dv.

    A segment from node a to node b, d = q_b - q_a of length l and n = d/l, u = v_b - v_a, pulls a with T n, where

        d(T n)/dd = n (T_l n + T_r (u - r n)/l)^T + (T/l)(I - n n^T),    d(T n)/du = T_r n n^T,    r = n . u ,

    with the slopes T_l, T_r of the axial law in length and rate; effects add to the diagonal blocks.

    Parameters
    ----------
    t : float [s]
    q, v : (n, 3) float64 [m], [m/s]; prescribed rows hold the prescribed motion
    place : int, address of the net
    slot : (n_segments, 2) int64, see `Pattern`
    of_q, of_v : (blocks, 3, 3) float64 [N/m], [N s/m], overwritten
    """
    net = net_at(place)
    n_free, effects = net.n_free, net.effects
    of_q[:] = 0.0
    of_v[:] = 0.0
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        index, params, tangent = effects.index[i:j], effects.params[a:b], as_tangent(effects.address[e, 1])
        tangent(t, q, v, index, params, -1.0, 0.0, of_q[:n_free])
        tangent(t, q, v, index, params, 0.0, -1.0, of_v[:n_free])
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        L0, k, damper, two_spring, two_damper = (
            net.law[c, 0], net.law[c, 1], net.law[c, 2], net.law[c, 3], net.law[c, 4],
        )  # fmt: skip
        a = net.cable[c, START]
        for j in range(count):
            b = node + j if j < count - 1 else net.cable[c, END]
            dx, dy, dz = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1], q[b, 2] - q[a, 2]
            ux, uy, uz = v[b, 0] - v[a, 0], v[b, 1] - v[a, 1], v[b, 2] - v[a, 2]
            l = (dx * dx + dy * dy + dz * dz) ** 0.5
            per_l = 1.0 / max(l, 1e-12 * L0)
            n = (dx * per_l, dy * per_l, dz * per_l)
            rate = n[0] * ux + n[1] * uy + n[2] * uz
            T, of_length, of_rate = tension_slopes(l - L0, rate, k, damper, two_spring, two_damper)
            across, turn = T * per_l, of_rate * per_l
            along = of_length - turn * rate - across
            g = (along * n[0] + turn * ux, along * n[1] + turn * uy, along * n[2] + turn * uz)
            ab, ba = slot[first + j, 0], slot[first + j, 1]
            for x in range(3):
                for y in range(3):
                    K, C = n[x] * g[y], of_rate * n[x] * n[y]
                    if x == y:
                        K += across
                    if a < n_free:
                        of_q[a, x, y] -= K
                        of_v[a, x, y] -= C
                    if b < n_free:
                        of_q[b, x, y] -= K
                        of_v[b, x, y] -= C
                    if ab >= 0:
                        of_q[ab, x, y] += K
                        of_v[ab, x, y] += C
                        of_q[ba, x, y] += K
                        of_v[ba, x, y] += C
            a = b


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
    p, size = pattern(model), 6 * model.n_free
    values = np.ones(18 * p.blocks + 1)
    of_q, of_v = values[:-1].reshape(2, p.blocks, 3, 3)

    def jacobian(t, q, v):
        blocks(t, q, v, net.place, p.slot, of_q, of_v)
        return csc_array((values[p.source] * p.scale, p.indices, p.indptr), shape=(size, size))

    return jacobian
