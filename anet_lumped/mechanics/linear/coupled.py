"""The linear algebra of `chain` for nets whose effects join neighbours along a cable, compiled when a scene first asks for it."""

from numba import njit

from anet_lumped.compiled.addresses import address
from anet_lumped.model.net import net_at
from integrators.system import compiled

from .chain import SOLVE, eliminate_cables, solve_points, substitute_cables


@njit(cache=True, error_model="numpy")
def _near(place):
    """`chain.solve` with the blocks between neighbours."""
    eliminate_cables(place, (net_at(place).near.ravel(),))
    solve_points(place)
    return substitute_cables(place, ())


@njit(cache=True, error_model="numpy")
def _far(place):
    """`chain.solve` with those and the blocks between next-but-one neighbours."""
    net = net_at(place)
    eliminate_cables(place, (net.near.ravel(), net.far.ravel()))
    solve_points(place)
    return substitute_cables(place, (net.further.ravel(),))


def solver(reach):
    """Address of the solver of a net whose effects join each node with those up to ``reach`` segments away, 1 or 2."""
    return address(compiled((_near, _far)[reach - 1], SOLVE))
