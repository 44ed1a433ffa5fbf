"""Rows of the nodes of a cable, or of the four cables of a group at once, read and written in compiled code."""

from numba import njit

from anet_lumped.compiled.lanes import (
    at,
    index,
    lane,
    of_table,
    put,
)
from anet_lumped.model.tables import (
    CABLE_SEGMENTS,
)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def segment_count(net, c):
    """Segments of a cable, or of each of a group."""
    return lane(of_table(net.cable, c, CABLE_SEGMENTS), 0)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def row3(flat, node):
    """Row of an (n, 3) array."""
    i = index(node, 0, 3, 0)
    return at(flat, i), at(flat, index(i, 0, 1, 1)), at(flat, index(i, 0, 1, 2))


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def put_row3(flat, node, place):
    i = index(node, 0, 3, 0)
    put(flat, i, place[0])
    put(flat, index(i, 0, 1, 1), place[1])
    put(flat, index(i, 0, 1, 2), place[2])


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def add_to_points(array, base, nodes, members, force, sign):
    """Add forces of the members of a group to the rows ``nodes - base`` of an array."""
    for k in range(members):
        row = array[lane(nodes, k) - base]
        row[0], row[1] = row[0] + sign * lane(force[0], k), row[1] + sign * lane(force[1], k)
        row[2] += sign * lane(force[2], k)
