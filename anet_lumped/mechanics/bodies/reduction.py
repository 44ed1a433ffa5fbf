"""Bodies in the linear system of a Newton step: the blocks of their nodes, mapped to two unknowns a body and back.

A body shifts by dr and turns by dphi: its node k, at the arm b, moves by dr + dphi x b. With the block S and the force f that are
left at the node, the equations of the body become

    sum f = sum S (dr - [b] dphi) + m W dr ,      sum s x f = sum [s] S (dr - [b] dphi) + T dphi ,

with the arm s of the force and the matrix T of `stage`. [x] is the matrix of the cross product. A cable between a body and another
point, or another body, has blocks that are mapped on either side. An effect may join two nodes of a body, of which the force on one
depends on the other.
"""

import math

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    BODY_FORCE,
    BODY_INERTIA,
    BODY_MOMENT,
    BODY_RADIUS,
    BODY_SECOND_ORDER,
    BODY_TURNING,
    JOINED_END,
    JOINED_END_BODY,
    JOINED_END_START,
    JOINED_START,
    JOINED_START_BODY,
    JOINED_START_END,
    JOINED_TARGETS,
    JOINT_BLOCKS,
    JOINT_BODY,
    JOINT_OTHER_NODE,
    JOINT_POSITION,
    JOINT_UNKNOWN,
    LINEARISED_LAW,
)
from integrators.newton import UNKNOWN_FORCE
from integrators.stage import LAW_BETWEEN

from .stage import MOMENT_WEIGHT
from .vectors import cross, cross_matrix, dot, matrix_product, minus, plus, put, row, scaled, three, turned_by

ONE = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@inlined
def _block(block):
    """A 3x3 block as a tuple by rows."""
    return (
        block[0, 0], block[0, 1], block[0, 2], block[1, 0], block[1, 1], block[1, 2], block[2, 0], block[2, 1], block[2, 2]
    )  # fmt: skip


@inlined
def _add(block, m, sign):
    """Add ``sign`` times a matrix (9,) to a block."""
    for x in range(3):
        for y in range(3):
            block[x, y] += sign * m[3 * x + y]


@inlined
def _arms(net, between, k):
    """Matrices [s] of the arm of a force and [b] of the arm of a displacement, of the k-th node of bodies."""
    end = cross_matrix(row(net.bodies.arm_end, k))
    return (cross_matrix(row(net.bodies.arm_mean, k)) if between else end), end


@inlined
def _index(bodies, b, node):
    """Which of the nodes of bodies a node of body b is."""
    k = bodies.node_at[b]
    while bodies.node[k] != node:
        k += 1
    return k


@on_demand
def reduce_bodies(net_address):
    """Map what the elimination of cables leaves at the nodes of bodies to the bodies' unknowns."""
    net = view_net(net_address)
    between = net.linearised[LINEARISED_LAW] == LAW_BETWEEN
    bodies, blocks, right_side, base = net.bodies, net.points.block, net.right_side, net.n_interior
    for b in range(bodies.pivot.shape[0]):
        first, end, of = bodies.node_at[b], bodies.node_at[b + 1], bodies.state[b]
        shift, turn = bodies.node[first], bodies.node[first + 1]
        shifts, turns = blocks[shift - base], blocks[turn - base]
        shift_turn, turn_shift = blocks[bodies.blocks[b, 0]], blocks[bodies.blocks[b, 1]]
        S_shift, S_turn, f_shift, f_turn = _block(shifts), _block(turns), row(right_side, shift), row(right_side, turn)
        for x in range(3):
            for y in range(3):
                shifts[x, y], turns[x, y] = (of[BODY_INERTIA] if x == y else 0.0), of[BODY_TURNING + 3 * x + y]
        force, moment = three(of, BODY_FORCE), three(of, BODY_MOMENT)
        of[BODY_SECOND_ORDER + 1] = 0.0
        of[BODY_SECOND_ORDER + 2] = 0.0
        for k in range(first, end):
            i = bodies.node[k]
            S, f = _block(blocks[i - base]), row(right_side, i)
            if i == shift:
                S, f = S_shift, f_shift
            elif i == turn:
                S, f = S_turn, f_turn
            stiffness, length = 0.0, math.sqrt(dot(row(bodies.arm_end, k), row(bodies.arm_end, k)))
            for x in range(9):
                stiffness = max(stiffness, abs(S[x]))
            force = plus(force, f)
            moment = plus(moment, cross(row(bodies.arm_mean, k) if between else row(bodies.arm_end, k), f))
            of[BODY_SECOND_ORDER + 1] += stiffness * length
            of[BODY_SECOND_ORDER + 2] += math.sqrt(dot(f, f)) * length
            if stiffness == 0.0:
                continue  # nothing pulls at this node that depends on where it is
            s, arm = _arms(net, between, k)
            S_arm, s_S = matrix_product(S, arm), matrix_product(s, S)
            _add(shifts, S, 1.0)
            _add(shift_turn, S_arm, -1.0)
            _add(turn_shift, s_S, 1.0)
            _add(turns, matrix_product(s_S, arm), -1.0)
        put(right_side, shift, force)
        put(right_side, turn, moment)
    if net.near_blocks.shape[0] > 0:
        before = net.near_blocks.shape[0] - bodies.pairs.shape[0]
        for p in range(bodies.pairs.shape[0]):
            _reduce_coupling(net, between, bodies.pairs[p], net.near_blocks[before + p])
    for j in range(bodies.joined.shape[0]):
        _reduce_pair(net, between, bodies.joined[j])
    for j in range(bodies.joint.shape[0]):
        _join(net, between, bodies.joint[j])
    for b in range(bodies.pivot.shape[0]):
        if bodies.pivot[b] >= 0:
            _hold_pivot(net, b)


@inlined
def _join(net, between, joint):
    """Add the force f of a joint and the condition that both of its points move alike, with the arms b and s of each,

    m W dr - ... = +-f ,    T dphi - ... = +-s x f ,    dr_1 + dphi_1 x b_1 = dr_2 + dphi_2 x b_2 .
    """
    blocks, base, unknown = net.points.block, net.n_interior, joint[JOINT_UNKNOWN]
    put(net.right_side, unknown, (0.0, 0.0, 0.0))
    for x in range(3):
        for y in range(3):
            blocks[unknown - base, x, y] = 0.0
    for side in range(2):
        if joint[JOINT_BODY + side] >= 0:
            s, arm = _arms(net, between, joint[JOINT_POSITION + side])
            at, sign = JOINT_BLOCKS + 4 * side, -1.0 if side == 0 else 1.0
            _add(blocks[joint[at]], ONE, sign)
            _add(blocks[joint[at + 1]], ONE, sign)
            _add(blocks[joint[at + 2]], arm, -sign)
            _add(blocks[joint[at + 3]], s, sign)


@inlined
def _reduce_coupling(net, between, pair, near):
    """Map the two blocks that an effect has between two nodes of a body."""
    bodies, blocks, base = net.bodies, net.points.block, net.n_interior
    b = pair[0]
    first = bodies.node_at[b]
    shifts, turns = blocks[bodies.node[first] - base], blocks[bodies.node[first + 1] - base]
    shift_turn, turn_shift = blocks[bodies.blocks[b, 0]], blocks[bodies.blocks[b, 1]]
    for way in range(2):
        of_force, of_place = (pair[1], pair[2]) if way == 0 else (pair[2], pair[1])
        S, s, arm = _block(near[way]), _arms(net, between, of_force)[0], _arms(net, between, of_place)[1]
        s_S = matrix_product(s, S)
        _add(shifts, S, 1.0)
        _add(shift_turn, matrix_product(S, arm), -1.0)
        _add(turn_shift, s_S, 1.0)
        _add(turns, matrix_product(s_S, arm), -1.0)


@inlined
def _reduce_pair(net, between, pair):
    """Map the blocks of a cable between two moving points, at least one of them on a body."""
    bodies, blocks = net.bodies, net.points.block
    there, back = _block(blocks[pair[JOINED_START_END]]), _block(blocks[pair[JOINED_END_START]])
    starts, ends = pair[JOINED_START_BODY] >= 0, pair[JOINED_END_BODY] >= 0
    nothing = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    s_start, b_start, s_end, b_end = nothing, nothing, nothing, nothing
    if starts:
        s_start, b_start = _arms(net, between, _index(bodies, pair[JOINED_START_BODY], pair[JOINED_START]))
    if ends:
        s_end, b_end = _arms(net, between, _index(bodies, pair[JOINED_END_BODY], pair[JOINED_END]))
    at = JOINED_TARGETS
    _add(blocks[pair[at]], there, 1.0)
    _add(blocks[pair[at + 4]], back, 1.0)
    if ends:
        _add(blocks[pair[at + 1]], matrix_product(there, b_end), -1.0)
        _add(blocks[pair[at + 6]], matrix_product(s_end, back), 1.0)
    if starts:
        _add(blocks[pair[at + 2]], matrix_product(s_start, there), 1.0)
        _add(blocks[pair[at + 5]], matrix_product(back, b_start), -1.0)
    if starts and ends:
        _add(blocks[pair[at + 3]], matrix_product(matrix_product(s_start, there), b_end), -1.0)
        _add(blocks[pair[at + 7]], matrix_product(matrix_product(s_end, back), b_start), -1.0)


@inlined
def _hold_pivot(net, b):
    """Let the shift of a pinned body be zero: its row and column become those of the identity."""
    points, base, p = net.points, net.n_interior, net.bodies.node[net.bodies.node_at[b]] - net.n_interior
    for x in range(3):
        net.right_side[base + p, x] = 0.0
        for y in range(3):
            points.block[p, x, y] = 1.0 if x == y else 0.0
    for e in range(points.order.shape[0]):
        for j in range(points.later_at[e], points.later_at[e + 1]):
            if points.order[e] == p or points.later[j] == p:
                _add(points.block[points.upper[j]], _block(points.block[points.upper[j]]), -1.0)
                _add(points.block[points.lower[j]], _block(points.block[points.lower[j]]), -1.0)


@on_demand
def spread_bodies(net_address):
    """Write the displacements of the nodes of bodies to ``net.newton_step``: exactly those of one piece, that keep joints closed.

    Of the turn dphi that the system gives, the Cayley vector of the rotation is taken.
    """
    net = view_net(net_address)
    bodies, step, joint = net.bodies, net.newton_step, 0
    for b in range(bodies.pivot.shape[0]):
        first = bodies.node_at[b]
        shift, turn = row(step, bodies.node[first]), row(step, bodies.node[first + 1])
        square = dot(turn, turn)
        if square > 1.0:  # a first guess far from the solution: a turn by more than a radian says nothing
            turn = scaled(1.0 / math.sqrt(square), turn)
        if joint < bodies.joint.shape[0] and bodies.joint[joint, JOINT_BODY] == b:
            by_turn = turned_by(turn, row(bodies.arm_end, bodies.joint[joint, JOINT_POSITION]))
            shift = minus(row(step, bodies.joint[joint, JOINT_OTHER_NODE]), by_turn)
            joint += 1
        for k in range(first, bodies.node_at[b + 1]):
            arm = row(bodies.arm_end, k)
            put(step, bodies.node[k], plus(shift, turned_by(turn, arm)))
        of = bodies.state[b]
        of[BODY_SECOND_ORDER + 3], of[BODY_SECOND_ORDER + 4] = math.sqrt(dot(shift, shift)), math.sqrt(square)


@on_demand
def finish_bodies(net_address):
    """Bound on the force that a whole Newton step leaves out of balance on bodies, by the second order of its turns [N].

    A node is off its linearised place by |dphi|^2 |b|/2, where the block S at it takes a force; its arm and the force on it turn
    together; the inertia turns with the body. Of bodies with joints no bound is known: turns shift the next bodies, too.
    """
    net, bound = view_net(net_address), 0.0
    if net.bodies.joint.shape[0] > 0:
        return UNKNOWN_FORCE
    for b in range(net.bodies.pivot.shape[0]):
        of = net.bodies.state[b]
        shift, turn, radius = of[BODY_SECOND_ORDER + 3], of[BODY_SECOND_ORDER + 4], of[BODY_RADIUS]
        stiffness_arm, force_arm = of[BODY_SECOND_ORDER + 1], of[BODY_SECOND_ORDER + 2]
        of_places = stiffness_arm * turn * (turn + shift / radius)
        of_moments = MOMENT_WEIGHT * (force_arm + of[BODY_SECOND_ORDER]) * turn * turn / radius
        bound = max(bound, of_places + of_moments)
    return bound
