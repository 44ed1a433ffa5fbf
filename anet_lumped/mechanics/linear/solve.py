"""The linear system of a Newton step: eliminate the cables, solve for the free points, substitute back along the cables."""

import numpy as np
from numba import float64, int64

from anet_lumped.compiled.jit import internal, kernel
from anet_lumped.mechanics.linear.chain import segment_stiffness
from anet_lumped.mechanics.linear.junctions import add_block, solve_points
from anet_lumped.mechanics.optional import as_eliminate, as_reduce_bodies, as_spread_bodies, as_substitute
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    CABLE_BLOCK_END_START,
    CABLE_BLOCK_START_END,
    CABLE_END,
    CABLE_FIRST_SEGMENT,
    CABLE_JOINS_FREE_POINTS,
    CABLE_START,
    KERNEL_ELIMINATE_BORDERED,
    KERNEL_ELIMINATE_GROUPS,
    KERNEL_ELIMINATE_GROUPS_OF_INERTIA,
    KERNEL_ELIMINATE_SINGLES,
    KERNEL_REDUCE_BODIES,
    KERNEL_SPREAD_BODIES,
    KERNEL_SUBSTITUTE_BORDERED,
    KERNEL_SUBSTITUTE_GROUPS,
    KERNEL_SUBSTITUTE_SINGLES,
    SEGMENT_DIRECTION,
    SEGMENT_TENSION,
)
from integrators.flat_view import flat


@internal
def eliminate_cables(net_address):
    """Eliminate the interior of every cable; add the stiffness and force that remain to its free ends.

    Reads ``net.segment``, ``net.diagonal`` and ``net.right_side``. Adds to ``net.points.block`` and ``net.right_side`` of the free
    points. Writes ``net.factor``, ``net.far_factor`` and ``net.border``, from which `substitute_cables` finds the interior nodes.
    The elimination of a node waits for the node behind it. Therefore four cables of one number of segments are eliminated at once.
    """
    net = view_net(net_address)
    diagonal, block, kinds = net.diagonal, net.points.block, net.single_kinds
    free_points = net.n_free - net.n_interior
    for p in range(block.shape[0]):
        for x in range(3):
            for y in range(3):
                block[p, x, y] = diagonal[net.n_interior + p, x, y] if p < free_points else 0.0
    if net.kernels[KERNEL_ELIMINATE_GROUPS_OF_INERTIA] != 0:
        as_eliminate(net.kernels[KERNEL_ELIMINATE_GROUPS_OF_INERTIA])(net_address)
    elif net.cable_groups.shape[0] > 0:
        as_eliminate(net.kernels[KERNEL_ELIMINATE_GROUPS])(net_address)
    for i in range(kinds[0]):
        _eliminate_short(net, net.single_cables[i])
    if kinds[1] > kinds[0]:
        as_eliminate(net.kernels[KERNEL_ELIMINATE_BORDERED])(net_address)
    if net.single_cables.shape[0] > kinds[1]:
        as_eliminate(net.kernels[KERNEL_ELIMINATE_SINGLES])(net_address)


@internal
def _eliminate_short(net, c):
    """Add the stiffness of a cable of one segment, which has no interior, to its end points."""
    start, end, block = net.cable[c, CABLE_START], net.cable[c, CABLE_END], net.points.block
    row = net.segment[net.cable[c, CABLE_FIRST_SEGMENT]]
    G, T = segment_stiffness(row), row[SEGMENT_TENSION]
    if start < net.n_free:
        add_block(block[start - net.n_interior], G, 1.0)
        for x in range(3):
            net.right_side[start, x] += row[SEGMENT_DIRECTION + x] * T
    if end < net.n_free:
        add_block(block[end - net.n_interior], G, 1.0)
        for x in range(3):
            net.right_side[end, x] -= row[SEGMENT_DIRECTION + x] * T
    if net.cable[c, CABLE_JOINS_FREE_POINTS] == 1:
        add_block(block[net.cable[c, CABLE_BLOCK_START_END]], G, -1.0)
        add_block(block[net.cable[c, CABLE_BLOCK_END_START]], G, -1.0)
        if net.near_blocks.shape[0] > 0:
            near = net.near_blocks[net.cable[c, CABLE_FIRST_SEGMENT]]
            add_block(block[net.cable[c, CABLE_BLOCK_START_END]], flat(near[0]), 1.0)
            add_block(block[net.cable[c, CABLE_BLOCK_END_START]], flat(near[1]), 1.0)


@internal
def substitute_cables(net_address):
    """Write the displacements of the interior nodes to ``net.newton_step`` and the tensions to ``net.tension``.

    Goes along each cable from its end, whose displacement is known, to its start. Returns the smallest tension [N].
    """
    net, smallest = view_net(net_address), np.inf
    count, kinds = net.single_cables.shape[0], net.single_kinds
    if net.cable_groups.shape[0] > 0:
        smallest = min(smallest, as_substitute(net.kernels[KERNEL_SUBSTITUTE_GROUPS])(net_address))
    if kinds[0] > 0 or count > kinds[1]:
        smallest = min(smallest, as_substitute(net.kernels[KERNEL_SUBSTITUTE_SINGLES])(net_address))
    if kinds[1] > kinds[0]:
        smallest = min(smallest, as_substitute(net.kernels[KERNEL_SUBSTITUTE_BORDERED])(net_address))
    return smallest


@kernel(float64(int64))
def solve(net_address):
    """Solve the linear system of `chain` for ``net.newton_step`` and ``net.tension``; overwrites ``net.right_side``.

    Returns the smallest tension [N].
    """
    net = view_net(net_address)
    has_bodies = net.bodies.first < net.n_free
    eliminate_cables(net_address)
    if has_bodies:
        as_reduce_bodies(net.kernels[KERNEL_REDUCE_BODIES])(net_address)
    solve_points(net_address)
    if has_bodies:
        as_spread_bodies(net.kernels[KERNEL_SPREAD_BODIES])(net_address)
    return substitute_cables(net_address)
