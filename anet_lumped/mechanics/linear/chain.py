"""The elimination of the interior nodes of each cable, in O(n), and the substitution back along it.

One Newton step solves, for the displacements d of all moving nodes and the tensions T of all segments,

    D_i d_i + sum over segments at i of -+ [ a (d_j - d_i) + e T ] = r_i ,      T = T_0 + k g . (d_j - d_i) ,

where D_i holds inertia and external stiffness, a is the geometric stiffness of the segment, e the direction in which its tension
acts, g the gradient of its length, and k = dT/dl, 0 for a slack segment. The tension stays an unknown until its node is eliminated.
So all numbers that occur are as large as inertia and tension, and none is as large as the stiffness. With M = D + S_behind + a I,

    y = M^-1 e,   z = M^-T g,   rho = 1/(1 + k g . y),   T = rho [T_0 + k (g - a z) . d_next - k z . r_i]
    S = a I - a^2 M^-1 + rho k (e - a y)(g - a z)^T .

S is the stiffness that the next node feels of the eliminated node and all that lies behind it: (G^-1 + (M - a I)^-1)^-1 for the
segment stiffness G = a I + k e g^T, after Sherman and Morrison. "Behind" a node is the side of the cable's start, "ahead" the side
of its end. Effects that join neighbours along a cable, or next-but-one neighbours, add the blocks ``net.near_blocks`` and
``net.far_blocks``; `node_elimination` has the formulas.
"""

import numpy as np

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.compiled.lanes import WIDTH, column, group_members, lane, load, load_four, max_of_lanes, shifted, store, store_four
from anet_lumped.compiled.rows_of_lanes import columns_apart, load_tile, store_tile
from anet_lumped.mechanics.linear.node_elimination import (
    SegmentTangent,
    eliminate,
    eliminate_far,
    eliminate_near,
)
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    FACTOR_COLUMNS,
    FAR_FACTOR_COLUMNS,
    FAR_FACTOR_PER_SECOND,
    LINEARISED_W,
    SEGMENT_COLUMNS,
    SEGMENT_DIRECTION,
    SEGMENT_GEOMETRIC,
    SEGMENT_GRADIENT,
    SEGMENT_STIFFNESS,
    SEGMENT_TENSION,
)
from integrators.flat_view import flat


@inlined
def segment_stiffness(row):
    """Stiffness a I + k e g^T (9,) of a segment, from its row of ``Net.segment``."""
    a, k, e, g = row[SEGMENT_GEOMETRIC], row[SEGMENT_STIFFNESS], SEGMENT_DIRECTION, SEGMENT_GRADIENT
    ex, ey, ez = k * row[e], k * row[e + 1], k * row[e + 2]
    gx, gy, gz = row[g], row[g + 1], row[g + 2]
    return (
        a + ex * gx, ex * gy, ex * gz, ey * gx, a + ey * gy, ey * gz, ez * gx, ez * gy, a + ez * gz,
    )  # fmt: skip


@inlined
def _linearised(segment, first, j):
    """`SegmentTangent` of segment ``first + j``."""
    ex, ey, ez, gx = load_four(segment, shifted(first, j, SEGMENT_COLUMNS, SEGMENT_DIRECTION))
    gy, gz, a, k = load_four(segment, shifted(first, j, SEGMENT_COLUMNS, SEGMENT_GRADIENT + 1))
    return SegmentTangent(ex, ey, ez, gx, gy, gz, a, k, load(segment, shifted(first, j, SEGMENT_COLUMNS, SEGMENT_TENSION)))


@inlined
def blocks_of_segment(numbers, s):
    """The two blocks (18,) of segment s in the flat array ``Net.near_blocks`` or ``Net.far_blocks``."""
    row = shifted(s, 0, 18, 0)
    first, second = load_four(numbers, row) + load_four(numbers, shifted(row, 0, 1, 4)), load_four(numbers, shifted(row, 0, 1, 8))
    return (
        first
        + second
        + load_four(numbers, shifted(row, 0, 1, 12))
        + (load(numbers, shifted(row, 0, 1, 16)), load(numbers, shifted(row, 0, 1, 17)))
    )


@inlined
def _block_of_node(diagonal, node, j):
    """The block (9,) of node ``node + j`` in the flat array ``Net.diagonal``."""
    i = shifted(node, j, 9, 0)
    return load_four(diagonal, i) + load_four(diagonal, shifted(i, 0, 1, 4)) + (load(diagonal, shifted(i, 0, 1, 8)),)


@inlined
def eliminate_node(behind, flat_arrays, inertia, blocks, node, first, first_factor, j):
    """Eliminate interior node j of a cable through its segment j + 1; write ``net.factor`` and ``net.far_factor``.

    Takes ``flat_arrays`` of `flat_arrays_of` and ``blocks`` of `eliminate_all_groups`; ``inertia``, (W m,) of nodes that have
    inertia alone, else empty; and ``first_factor``, where the factors of the first segment are. Returns the `EliminatedNode`.
    """
    diagonal, right, segment, factor, far_factor = flat_arrays
    index_r, index_factor = shifted(node, j, 3, 0), factors_of_segment(first, first_factor, j + 1)
    D = inertia if len(inertia) == 1 else _block_of_node(diagonal, node, j)
    r = (load(right, index_r), load(right, shifted(index_r, 0, 1, 1)), load(right, shifted(index_r, 0, 1, 2)))
    tangent, s = _linearised(segment, first, j + 1), shifted(first, j, 1, 1)
    if len(blocks) == 0:
        eliminated = eliminate(behind, D, r, tangent)
    elif len(blocks) == 1:
        eliminated = eliminate_near(behind, D, r, tangent, blocks_of_segment(blocks[0], s))
    else:
        near, far = blocks_of_segment(blocks[0], s), blocks_of_segment(blocks[1], s)
        eliminated = eliminate_far(behind, D, r, tangent, near, far)
    follows = eliminated.follows
    if len(blocks) > 1:
        index_far = shifted(s, 0, FAR_FACTOR_COLUMNS, 0)
        store_four(far_factor, index_far, follows[16:20])
        store_four(far_factor, shifted(index_far, 0, 1, 4), follows[20:24])
        store_four(far_factor, shifted(index_far, 0, 1, 8), follows[24:])
    apart = columns_apart(first)
    store_tile(factor, index_factor, follows[:4])
    store_tile(factor, index_factor + 4 * apart, follows[4:8])
    store_tile(factor, index_factor + 8 * apart, follows[8:12])
    store_tile(factor, index_factor + 12 * apart, follows[12:16])
    return eliminated


@inlined
def factors_of_segment(first, first_factor, j):
    """Address in ``net.factor``, flat, of the factors of segment j of a cable, or of a group, whose first ones are at
    ``first_factor``; ``first`` is the address of the first segment."""
    return first_factor + j * FACTOR_COLUMNS * columns_apart(first)


@inlined
def factors_of_groups(net):
    """Address in ``net.factor``, flat, of the factors of the first group: they stand behind the rows of all segments, as lanes."""
    return net.tension.shape[0] * FACTOR_COLUMNS


@inlined
def flat_arrays_of(net):
    """Arrays that `eliminate_node` reads and writes."""
    return flat(net.diagonal), flat(net.right_side), flat(net.segment), flat(net.factor), flat(net.far_factor)


@inlined
def _eliminate(net, inertia, blocks, c, members, first_factor):
    """Eliminate the interior of a cable with a prescribed start, or of the ``members`` cables of a group.

    Returns the address of the factors of the next group.
    """
    first, node = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE)
    ex, ey, ez, gx, gy, gz, a, k, T = _linearised(flat(net.segment), first, 0)
    kx, ky, kz = k * ex, k * ey, k * ez
    state = (
        a + kx * gx, kx * gy, kx * gz, ky * gx, a + ky * gy, ky * gz, kz * gx, kz * gy, a + kz * gz, -ex * T, -ey * T, -ez * T
    )  # fmt: skip
    if len(blocks) < 2:
        behind = state
    else:
        zero = 0.0 * a  # nothing behind acts beyond the first node
        six_zeros = (zero, zero, zero, zero, zero, zero)
        behind = state + six_zeros + six_zeros + six_zeros + six_zeros + six_zeros
    flat_arrays, count = flat_arrays_of(net), lane(column(net.cable, c, CABLE_SEGMENTS), 0)
    for j in range(count - 1):
        behind = eliminate_node(behind, flat_arrays, inertia, blocks, node, first, first_factor, j).ahead
    add_to_end_point(net, c, members, behind)
    return factors_of_segment(first, first_factor, count)


@inlined
def add_to_end_point(net, c, members, state):
    """Add the block and the right-hand side that an eliminated cable leaves at its end to those of its end point, if free."""
    ends = column(net.cable, c, CABLE_END)
    for k in range(members):
        end = lane(ends, k)
        if end < net.n_free:
            S, b = flat(net.points.block[end - net.n_interior]), net.right_side[end]
            S[0], S[1], S[2] = S[0] + lane(state[0], k), S[1] + lane(state[1], k), S[2] + lane(state[2], k)
            S[3], S[4], S[5] = S[3] + lane(state[3], k), S[4] + lane(state[4], k), S[5] + lane(state[5], k)
            S[6], S[7], S[8] = S[6] + lane(state[6], k), S[7] + lane(state[7], k), S[8] + lane(state[8], k)
            b[0], b[1], b[2] = b[0] + lane(state[9], k), b[1] + lane(state[10], k), b[2] + lane(state[11], k)


@inlined
def eliminate_all_groups(net_address, blocks):
    """Eliminate the interior of the cables that are taken by fours, see `solve.eliminate_cables`.

    ``blocks`` holds the blocks that the effects of the scene have, as flat arrays: none, ``Net.near_blocks``, or this and
    ``Net.far_blocks``. The compiler knows how many.
    """
    net = view_net(net_address)
    first_factor = factors_of_groups(net)
    for g in range(net.cable_groups.shape[0]):
        c = group_members(net.cable_groups, g)
        first_factor = _eliminate(net, (), blocks, c, net.cable_groups[g, WIDTH], first_factor)


@on_demand
def eliminate_groups_of_inertia(net_address):
    """`eliminate_all_groups` where effects neither join neighbours nor stiffen nodes.

    Then the block of each node inside a cable is its inertia W m I, of one mass, and ``net.diagonal`` is not read.
    """
    net = view_net(net_address)
    first_factor, W = factors_of_groups(net), net.linearised[LINEARISED_W]
    for g in range(net.cable_groups.shape[0]):
        c = group_members(net.cable_groups, g)
        inertia = (W * load(net.mass, column(net.cable, c, CABLE_FIRST_NODE)),)
        first_factor = _eliminate(net, inertia, (), c, net.cable_groups[g, WIDTH], first_factor)


@inlined
def eliminate_all_singles(net_address, blocks):
    """Eliminate the interior of the cables that are in no group and have a prescribed start."""
    net = view_net(net_address)
    for i in range(net.single_kinds[1], net.single_cables.shape[0]):
        c = net.single_cables[i]
        _eliminate(net, (), blocks, c, 1, net.cable[c, CABLE_FIRST_SEGMENT] * FACTOR_COLUMNS)


@on_demand
def eliminate_groups(net_address):
    """`eliminate_all_groups` where effects join no neighbours."""
    eliminate_all_groups(net_address, ())


@on_demand
def eliminate_singles(net_address):
    """`eliminate_all_singles` where effects join no neighbours."""
    eliminate_all_singles(net_address, ())


@inlined
def displacement_behind(factor, far_factors, row, s, x, y, z, second_ahead):
    """Displacement of the node behind segment s and tension of the segment, from the displacement (x, y, z) of the node ahead.

    ``row`` is where `factors_of_segment` has those of the segment.
    ``far_factors`` is (``Net.far_factor``,) where both also depend on ``second_ahead``, the displacement of the second node ahead;
    else it is empty.
    """
    apart = columns_apart(s)
    h00, h01, h02, h10 = load_tile(factor, row, x)
    h11, h12, h20, h21 = load_tile(factor, row + 4 * apart, x)
    h22, hx, hy, hz = load_tile(factor, row + 8 * apart, x)
    wx, wy, wz, T = load_tile(factor, row + 12 * apart, x)
    if len(far_factors) == 1:
        u, v, w = second_ahead
        far_row = shifted(s, 0, FAR_FACTOR_COLUMNS, FAR_FACTOR_PER_SECOND)
        j00, j01, j02, j10 = load_four(far_factors[0], far_row)
        j11, j12, j20, j21 = load_four(far_factors[0], shifted(far_row, 0, 1, 4))
        j22, ox, oy, oz = load_four(far_factors[0], shifted(far_row, 0, 1, 8))
        hx = hx + j00 * u + j01 * v + j02 * w
        hy = hy + j10 * u + j11 * v + j12 * w
        hz = hz + j20 * u + j21 * v + j22 * w
        T = T + ox * u + oy * v + oz * w
    return (
        hx + h00 * x + h01 * y + h02 * z, hy + h10 * x + h11 * y + h12 * z, hz + h20 * x + h21 * y + h22 * z,
        T + wx * x + wy * y + wz * z,
    )  # fmt: skip


@inlined
def _substitute(net, far_factors, c, first_factor):
    """`solve.substitute_cables` of a cable, or of a group, that has a prescribed start or no interior.

    Returns their smallest tension [N], and the address of the factors of the next group.
    """
    first, node = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE)
    end = column(net.cable, c, CABLE_END)
    step, factor, segment = flat(net.newton_step), flat(net.factor), flat(net.segment)
    index_end, index_start = shifted(end, 0, 3, 0), shifted(column(net.cable, c, CABLE_START), 0, 3, 0)
    x, y, z = load(step, index_end), load(step, shifted(index_end, 0, 1, 1)), load(step, shifted(index_end, 0, 1, 2))
    largest_push, second_ahead = -np.inf + 0.0 * x, (0.0 * x, 0.0 * x, 0.0 * x)
    count = lane(column(net.cable, c, CABLE_SEGMENTS), 0)
    for j in range(count - 1, 0, -1):
        s, row = shifted(first, j, 1, 0), factors_of_segment(first, first_factor, j)
        (x, y, z, T), second_ahead = displacement_behind(factor, far_factors, row, s, x, y, z, second_ahead), (x, y, z)
        store(net.tension, s, T)
        i = shifted(node, j - 1, 3, 0)
        store(step, i, x)
        store(step, shifted(i, 0, 1, 1), y)
        store(step, shifted(i, 0, 1, 2), z)
        largest_push = max(largest_push, -T)
    _, _, _, gx, gy, gz, _, k, T = _linearised(segment, first, 0)
    x, y, z = (
        x - load(step, index_start),
        y - load(step, shifted(index_start, 0, 1, 1)),
        z - load(step, shifted(index_start, 0, 1, 2)),
    )
    T = T + k * (gx * x + gy * y + gz * z)
    store(net.tension, first, T)
    return -max_of_lanes(max(largest_push, -T)), factors_of_segment(first, first_factor, count)


@inlined
def substitute_all_groups(net_address, far_factors):
    """`solve.substitute_cables` of the cables that are taken by fours; returns their smallest tension [N]."""
    net, smallest = view_net(net_address), np.inf
    first_factor = factors_of_groups(net)
    for g in range(net.cable_groups.shape[0]):
        own, first_factor = _substitute(net, far_factors, group_members(net.cable_groups, g), first_factor)
        smallest = min(smallest, own)
    return smallest


@inlined
def substitute_all_singles(net_address, far_factors):
    """`solve.substitute_cables` of the cables in no group that are not between two free points; returns their smallest tension."""
    net, smallest = view_net(net_address), np.inf
    for i in range(net.single_cables.shape[0]):
        if i < net.single_kinds[0] or i >= net.single_kinds[1]:
            c = net.single_cables[i]
            own, _ = _substitute(net, far_factors, c, net.cable[c, CABLE_FIRST_SEGMENT] * FACTOR_COLUMNS)
            smallest = min(smallest, own)
    return smallest


@on_demand
def substitute_groups(net_address):
    """`substitute_all_groups` where effects join no next-but-one neighbours."""
    return substitute_all_groups(net_address, ())


@on_demand
def substitute_singles(net_address):
    """`substitute_all_singles` where effects join no next-but-one neighbours."""
    return substitute_all_singles(net_address, ())
