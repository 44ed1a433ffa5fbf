"""Rows of the nodes of a cable, or of the four cables of a group at once, read and written in compiled code."""

from anet_lumped.compiled.jit import inlined
from anet_lumped.compiled.lanes import column, lane, load, shifted, store
from anet_lumped.model.tables import CABLE_SEGMENTS


@inlined
def segment_count(net, c):
    """Number of segments of a cable; in a group all cables have the same number."""
    return lane(column(net.cable, c, CABLE_SEGMENTS), 0)


@inlined
def row3(numbers, node):
    """Row ``node`` of an (n, 3) array that is given flat."""
    i = shifted(node, 0, 3, 0)
    return load(numbers, i), load(numbers, shifted(i, 0, 1, 1)), load(numbers, shifted(i, 0, 1, 2))


@inlined
def put_row3(numbers, node, row):
    """Write row ``node`` of an (n, 3) array that is given flat."""
    i = shifted(node, 0, 3, 0)
    store(numbers, i, row[0])
    store(numbers, shifted(i, 0, 1, 1), row[1])
    store(numbers, shifted(i, 0, 1, 2), row[2])


@inlined
def add_to_points(array, first_node, nodes, members, force, sign):
    """Add ``sign`` times the force on a point to row ``nodes - first_node`` of an array, for each of the members of a group."""
    for k in range(members):
        row = array[lane(nodes, k) - first_node]
        row[0], row[1] = row[0] + sign * lane(force[0], k), row[1] + sign * lane(force[1], k)
        row[2] += sign * lane(force[2], k)


@inlined
def sum_of_members(value, members):
    """Sum of a number that each cable has over the members of a group."""
    total = 0.0
    for k in range(members):
        total += lane(value, k)
    return total
