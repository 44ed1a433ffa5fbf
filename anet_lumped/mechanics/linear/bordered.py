"""The elimination of the interior of cables between two free points, and the substitution back; `chain` has the other cables."""

from math import inf

from anet_lumped.compiled.jit import inlined, internal, on_demand
from anet_lumped.mechanics.linear.chain import (
    add_to_end_point,
    blocks_of_segment,
    displacement_behind,
    eliminate_node,
    flat_arrays_of,
)
from anet_lumped.mechanics.linear.node_elimination import difference, identity_multiple_minus, times
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    BORDER_TENSION,
    BORDER_UNKNOWNS,
    CABLE_BLOCK_END_START,
    CABLE_BLOCK_START_END,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    FACTOR_COLUMNS,
    FACTOR_CONSTANT,
    FACTOR_PER_NEXT,
    FACTOR_TENSION_PER_NEXT,
    FAR_FACTOR_PER_SECOND,
    FAR_FACTOR_TENSION_PER_SECOND,
    FIRST_TENSION_CONSTANT,
    FIRST_TENSION_PER_END,
    FIRST_TENSION_PER_START,
    SEGMENT_DIRECTION,
    SEGMENT_GEOMETRIC,
    SEGMENT_GRADIENT,
    SEGMENT_STIFFNESS,
    SEGMENT_TENSION,
)
from integrators.flat_view import flat

TENSION_UNKNOWN = 3  # of the unknowns of a cable between two free points; the others are the displacement of its start


@inlined
def eliminate_all_bordered(net_address, blocks):
    """Eliminate the interior of the cables between two free points."""
    net = view_net(net_address)
    for i in range(net.single_kinds[0], net.single_kinds[1]):
        _eliminate_bordered(net_address, blocks, net.single_cables[i])


@on_demand
def eliminate_bordered(net_address):
    """`eliminate_all_bordered` where effects join no neighbours."""
    eliminate_all_bordered(net_address, ())


@inlined
def _subtract_block(table, m):
    """Subtract a 3x3 block from the first three columns of a table of three rows."""
    for x in range(3):
        for y in range(3):
            table[x, y] -= m[x, y]


@internal
def _eliminate_bordered(net_address, blocks, c):
    """Eliminate a cable between two free points.

    The elimination begins at the start, whose displacement is not known yet. So the displacement of the start and the tension of
    the first segment are kept as four unknowns u = (d_start, T_first). The force on the first node from behind is
    a_0 d_start - a_0 d - e_0 T_first. So no stiffness enters before T_first is eliminated, last of all. With effects that join
    neighbours, blocks of theirs are subtracted from a_0.

    ``push`` (3, 4) times u is added to the right-hand side of the node that is eliminated, ``push_second`` times u to that of the
    next node. The interior nodes enter the equations of the start (three rows) and of T_first (the last row) by the vector

        per_node d + per_second d_next + constant + per_unknown u

    of the displacements d and d_next of the next two nodes to be eliminated: at first (a_0 d_first, g_0 . d_first). The elimination
    of node after node keeps it up to date. All of these are parts of ``Net.border_work``.
    """
    net = view_net(net_address)
    start, end, s = net.cable[c, CABLE_START], net.cable[c, CABLE_END], net.cable[c, CABLE_FIRST_SEGMENT]
    first = net.segment[s]
    first_a, first_k = first[SEGMENT_GEOMETRIC], first[SEGMENT_STIFFNESS]
    first_e = first[SEGMENT_DIRECTION : SEGMENT_DIRECTION + 3]
    first_g = first[SEGMENT_GRADIENT : SEGMENT_GRADIENT + 3]
    work = flat(net.border_work)
    for i in range(work.shape[0]):
        work[i] = 0.0
    push, push_second, per_node = net.border_work[0], net.border_work[1], net.border_work[2]
    per_second, per_unknown, constant = net.border_work[3], net.border_work[4], net.border_work[5, 0]
    for x in range(3):
        push[x, x], push[x, TENSION_UNKNOWN] = first_a, -first_e[x]
        per_node[x, x], per_node[TENSION_UNKNOWN, x] = first_a, first_g[x]
    if len(blocks) > 0:
        _subtract_block(push, net.near_blocks[s, 1])
        _subtract_block(per_node, net.near_blocks[s, 0])
    behind = (first_a, 0.0, 0.0, 0.0, first_a, 0.0, 0.0, 0.0, first_a, 0.0, 0.0, 0.0)
    if len(blocks) < 2:
        state = behind
    else:
        six_zeros = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        state = behind + six_zeros + six_zeros + six_zeros + six_zeros + six_zeros
        _subtract_block(push_second, net.far_blocks[s, 1])
        _subtract_block(per_second, net.far_blocks[s, 0])
    flat_arrays, first_segment = flat_arrays_of(net), net.cable[c, CABLE_FIRST_SEGMENT]
    first_factor = first_segment * FACTOR_COLUMNS
    for j in range(net.cable[c, CABLE_SEGMENTS] - 1):
        s += 1
        segment, border = net.segment[s], net.border[s]
        a = segment[SEGMENT_GEOMETRIC]
        if len(blocks) > 0:
            next_per_node = identity_multiple_minus(a, blocks_of_segment(blocks[0], s)[9:])
            if len(blocks) > 1:
                next_per_node = difference(next_per_node, state[21:30])
        eliminated = eliminate_node(state, flat_arrays, (), blocks, net.cable[c, CABLE_FIRST_NODE], first_segment, first_factor, j)
        state, M_inverse, y, z, rho_k = eliminated.ahead, eliminated.M_inverse, eliminated.y, eliminated.z, eliminated.rho_k
        # what u adds to the displacement of the node and to the tension of the segment, and with them to the force on the next node
        for u in range(BORDER_UNKNOWNS):
            T_u = rho_k * (z[0] * push[0, u] + z[1] * push[1, u] + z[2] * push[2, u])
            at_constant_T = times(M_inverse, push[0, u], push[1, u], push[2, u])
            dx, dy, dz = at_constant_T[0] - y[0] * T_u, at_constant_T[1] - y[1] * T_u, at_constant_T[2] - y[2] * T_u
            border[u], border[BORDER_UNKNOWNS + u], border[2 * BORDER_UNKNOWNS + u], border[BORDER_TENSION + u] = dx, dy, dz, -T_u
            if len(blocks) == 0:
                by_node = a * dx, a * dy, a * dz
            else:
                by_node = times(next_per_node, dx, dy, dz)
            for x in range(3):
                push[x, u] = by_node[x] + segment[SEGMENT_DIRECTION + x] * T_u + push_second[x, u]
            if len(blocks) > 1:
                for x in range(3):
                    push_second[x, u] = -(
                        net.far_blocks[s, 1, x, 0] * dx + net.far_blocks[s, 1, x, 1] * dy + net.far_blocks[s, 1, x, 2] * dz
                    )
        # in the vector above, d = H d_next + h + border u takes the place of the displacement of the node
        H, h = net.factor[s, FACTOR_PER_NEXT:FACTOR_CONSTANT], net.factor[s, FACTOR_CONSTANT:FACTOR_TENSION_PER_NEXT]
        for row in range(BORDER_UNKNOWNS):
            per_x, per_y, per_z = per_node[row, 0], per_node[row, 1], per_node[row, 2]
            constant[row] += per_x * h[0] + per_y * h[1] + per_z * h[2]
            for u in range(BORDER_UNKNOWNS):
                per_unknown[row, u] += (
                    per_x * border[u] + per_y * border[BORDER_UNKNOWNS + u] + per_z * border[2 * BORDER_UNKNOWNS + u]
                )
            for i in range(3):
                per_node[row, i] = per_x * H[i] + per_y * H[3 + i] + per_z * H[6 + i] + per_second[row, i]
            if len(blocks) > 1:
                J = net.far_factor[s, FAR_FACTOR_PER_SECOND:FAR_FACTOR_TENSION_PER_SECOND]
                for i in range(3):
                    per_second[row, i] = per_x * J[i] + per_y * J[3 + i] + per_z * J[6 + i]
    # T_first = T_0 + k g . (d_first - d_start) of the first segment, solved for T_first
    first_tension = net.factor[net.cable[c, CABLE_FIRST_SEGMENT]]
    rho = 1.0 / (1.0 - first_k * per_unknown[TENSION_UNKNOWN, TENSION_UNKNOWN])
    for i in range(3):
        first_tension[FIRST_TENSION_PER_END + i] = rho * first_k * per_node[TENSION_UNKNOWN, i]
        first_tension[FIRST_TENSION_PER_START + i] = rho * first_k * (per_unknown[TENSION_UNKNOWN, i] - first_g[i])
    first_tension[FIRST_TENSION_CONSTANT] = rho * (first[SEGMENT_TENSION] + first_k * constant[TENSION_UNKNOWN])
    add_to_end_point(net, c, 1, state)
    block, right = net.points.block, net.right_side
    of_start, of_end = block[start - net.n_interior], block[end - net.n_interior]
    to_end, to_start = block[net.cable[c, CABLE_BLOCK_START_END]], block[net.cable[c, CABLE_BLOCK_END_START]]
    for x in range(3):
        # force on the start: that of the interior, e_0 T_first and -a_0 d_start; on the end: that of `add_to_end_point`, and push u
        per_T = per_unknown[x, TENSION_UNKNOWN] + first_e[x]
        right[start, x] += constant[x] + per_T * first_tension[FIRST_TENSION_CONSTANT]
        right[end, x] += push[x, TENSION_UNKNOWN] * first_tension[FIRST_TENSION_CONSTANT]
        of_start[x, x] += first_a
        for i in range(3):
            of_start[x, i] -= per_unknown[x, i] + per_T * first_tension[FIRST_TENSION_PER_START + i]
            to_end[x, i] -= per_node[x, i] + per_T * first_tension[FIRST_TENSION_PER_END + i]
            to_start[x, i] -= push[x, i] + push[x, TENSION_UNKNOWN] * first_tension[FIRST_TENSION_PER_START + i]
            of_end[x, i] -= push[x, TENSION_UNKNOWN] * first_tension[FIRST_TENSION_PER_END + i]


@inlined
def _substitute_bordered(net, far_factors, c):
    """`solve.substitute_cables` of a cable whose start is a free point too."""
    first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
    step, factor, tension, start, end = net.newton_step, net.factor, net.tension, net.cable[c, CABLE_START], net.cable[c, CABLE_END]
    x, y, z = step[end, 0], step[end, 1], step[end, 2]
    sx, sy, sz = step[start, 0], step[start, 1], step[start, 2]
    first_tension = factor[first]
    per_end, per_start = FIRST_TENSION_PER_END, FIRST_TENSION_PER_START
    T0 = (
        first_tension[FIRST_TENSION_CONSTANT]
        + first_tension[per_end] * x
        + first_tension[per_end + 1] * y
        + first_tension[per_end + 2] * z
        + first_tension[per_start] * sx
        + first_tension[per_start + 1] * sy
        + first_tension[per_start + 2] * sz
    )
    tension[first], smallest, second_ahead = T0, T0, (0.0, 0.0, 0.0)
    for j in range(count - 1, 0, -1):
        b, i = net.border[first + j], node + j - 1
        row = (first + j) * FACTOR_COLUMNS
        (x, y, z, T), second_ahead = (
            displacement_behind(flat(factor), far_factors, row, first + j, x, y, z, second_ahead),
            (x, y, z),
        )
        x += b[0] * sx + b[1] * sy + b[2] * sz + b[3] * T0
        y += b[4] * sx + b[5] * sy + b[6] * sz + b[7] * T0
        z += b[8] * sx + b[9] * sy + b[10] * sz + b[11] * T0
        T += b[12] * sx + b[13] * sy + b[14] * sz + b[15] * T0
        tension[first + j], smallest = T, min(smallest, T)
        step[i, 0], step[i, 1], step[i, 2] = x, y, z
    return smallest


@inlined
def substitute_all_bordered(net_address, far_factors):
    """`solve.substitute_cables` of the cables between two free points; returns their smallest tension [N]."""
    net, smallest = view_net(net_address), inf
    for i in range(net.single_kinds[0], net.single_kinds[1]):
        smallest = min(smallest, _substitute_bordered(net, far_factors, net.single_cables[i]))
    return smallest


@on_demand
def substitute_bordered(net_address):
    """`substitute_all_bordered` where effects join no next-but-one neighbours."""
    return substitute_all_bordered(net_address, ())
