"""Positions of nodes for a law: as plain numbers, and as dual numbers with slopes in themselves or without any."""

from anet_lumped.compiled import dual
from anet_lumped.compiled.jit import njit


@njit(error_model="numpy", cache=True)
def position(q, i):
    """Position of a node, or its velocity, as a tuple."""
    return q[i, 0], q[i, 1], q[i, 2]


@njit(error_model="numpy", cache=True)
def add(f, i, fx, fy, fz):
    """Add a force on a node."""
    f[i, 0] += fx
    f[i, 1] += fy
    f[i, 2] += fz


@njit(error_model="numpy", cache=True)
def seeded(q):
    """A position with slopes in itself."""
    x, y, z = q
    return dual.seeded(x, y, z)


@njit(error_model="numpy", cache=True)
def constant(q):
    """The same without slopes: a law that is given either is compiled once."""
    x, y, z = q
    return dual.constant(x, y, z)
