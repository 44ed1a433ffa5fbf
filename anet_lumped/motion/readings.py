"""What is seen of a session, read in one compiled call: motions of bodies, pulls of cables on them, free points."""

from typing import Any, NamedTuple

import numpy as np
from numba import float64, int64, types, void

from anet_lumped.compiled.jit import njit
from anet_lumped.model.tables import SEGMENT_DIRECTION
from integrators.addresses import view_at, words_of
from integrators.compile_once import compile_for, once
from integrators.system import entry_point, system_at

from .body_readings import BodyTable, read
from .cable_ends import pull_bodies

_f1, _f2, _f3, _i1, _i2 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1], int64[:, ::1]


class Sight(NamedTuple):
    """What is seen; arrays that `see` writes.

    Parameters
    ----------
    position, velocity : (m, 3) float64 [m], [m/s], of the origins of the m bodies that move freely
    rotation : (m, 3, 3) float64, whose columns are their axes
    angular_velocity : (m, 3) float64 [rad/s], in the axes of the world
    pull, moment : (m, 3) float64 [N], [N m], of the cables on each body in the last step, about its origin
    point, point_velocity : (k, 3) float64 [m], [m/s], of the free points
    """

    position: np.ndarray
    velocity: np.ndarray
    rotation: np.ndarray
    angular_velocity: np.ndarray
    pull: np.ndarray
    moment: np.ndarray
    point: np.ndarray
    point_velocity: np.ndarray


class Readings(NamedTuple):
    """Arrays and addresses that `see` reads of a session, until its next event.

    Parameters
    ----------
    q, v : (n, 3) float64 [m], [m/s]
    tension, least : (n_segments,) float64 [N], that acted in the last step, and the least that each segment can have
    segment : (n_segments, columns) float64, with the directions of the last step in three columns from ``column`` on
    ends : (n_segments, 2) int64
    acted, directions : (n_segments,), (n_segments, 3) float64, scratch
    table : BodyTable
    pulling : arrays of `CableEnds`: segment, node, sign, body, origin
    loaded : arrays of `CableEnds`: node, body, origin, and weight (k, 3) [N]
    free_nodes : (k,) int64
    origin : (3,) float64 [m], of the coordinates that the session computes in
    at_end : (1,) int64, whether tensions are those at the time reached, as no step has told others
    column : int
    system_address, data_address : int
    """

    q: np.ndarray
    v: np.ndarray
    tension: np.ndarray
    least: np.ndarray
    segment: np.ndarray
    ends: np.ndarray
    acted: np.ndarray
    directions: np.ndarray
    table: BodyTable
    pulling: tuple
    loaded: tuple
    free_nodes: np.ndarray
    origin: np.ndarray
    at_end: np.ndarray
    column: int
    system_address: int
    data_address: int


TABLE = types.NamedTuple((_i1, _i1, _f2, _f3, _f1), BodyTable)
SIGHT = types.NamedTuple((_f2, _f2, _f3, _f2, _f2, _f2, _f2, _f2), Sight)
READINGS = types.NamedTuple(
    (_f2, _f2, _f1, _f1, _f2, _i2, _f1, _f2, TABLE, types.UniTuple(_i1, 5), types.Tuple((_i1, _i1, _i1, _f2)), _i1, _f1, _i1)
    + (types.int64,) * 3,
    Readings,
)
readings_at = view_at(READINGS)


def sight_of(bodies: int, points: int) -> Sight:
    """`Sight` of so many bodies and points, not yet seen."""
    of_bodies = (np.zeros((bodies, 3)), np.zeros((bodies, 3)), np.zeros((bodies, 3, 3)), *np.zeros((3, bodies, 3)))
    return Sight(*of_bodies, *np.zeros((2, points, 3)))


def readings_of(session: Any, model: Any) -> Readings:
    """`Readings` of a session whose cables are left as in a model."""
    net, state, ends, count = session._net, session._state, session._cable_ends, model.n_segments
    return Readings(
        q=state.q, v=state.v, tension=net.tension, least=session._least_tension, segment=net.segment,
        ends=np.ascontiguousarray(model.ends, np.int64), acted=np.zeros(count), directions=np.zeros((count, 3)),
        table=session._table, pulling=ends.pulling, loaded=ends.loaded, free_nodes=session._forces.free_nodes,
        origin=session._origin, at_end=np.array([session._as_observed], np.int64), column=SEGMENT_DIRECTION,
        system_address=session._words.ctypes.data, data_address=net.address,
    )  # fmt: skip


@njit(error_model="numpy", fastmath={"contract"}, _nrt=False, cache=True, nogil=True)
def see(address, sight):
    """Write what is seen.

    Parameters
    ----------
    address : int64, of the words of `Readings`
    sight : Sight
    """
    r = readings_at(address)
    table, origin, nodes = r.table, r.origin, r.free_nodes
    position, point = sight.position, sight.point
    read(
        r.q, r.v, table.first, table.node, table.weights, table.directions, position, sight.velocity, sight.rotation,
        sight.angular_velocity,
    )  # fmt: skip
    for b in range(position.shape[0]):
        for x in range(3):
            position[b, x] += origin[x]
            sight.pull[b, x], sight.moment[b, x] = 0.0, 0.0
    for k in range(nodes.shape[0]):
        for x in range(3):
            point[k, x], sight.point_velocity[k, x] = r.q[nodes[k], x] + origin[x], r.v[nodes[k], x]
    acted, rows, column = r.acted, r.segment, r.column
    if r.at_end[0] == 1:
        _as_observed(address)
        rows, column = r.directions, 0
    else:
        for s in range(acted.shape[0]):
            acted[s] = max(r.tension[s], r.least[s])
    segment, node, sign, body, origin_of = r.pulling
    loaded, loaded_body, loaded_origin, weight = r.loaded
    pull_bodies(
        r.q, rows, column, acted, segment, node, sign, body, origin_of, loaded, loaded_body, loaded_origin, weight, sight.pull,
        sight.moment,
    )  # fmt: skip


@njit(error_model="numpy", fastmath={"contract"}, _nrt=False, cache=True)
def _as_observed(address):
    """Write the tensions at the time reached, and the directions of the segments there."""
    r = readings_at(address)
    system_at(r.system_address).observe(0.0, r.q, r.v, r.data_address, r.acted, r.origin[:0])  # no energies, for which time counts
    for s in range(r.ends.shape[0]):
        first, second, square = r.ends[s, 0], r.ends[s, 1], 0.0
        for x in range(3):
            r.directions[s, x] = r.q[second, x] - r.q[first, x]
            square += r.directions[s, x] * r.directions[s, x]
        for x in range(3):
            r.directions[s, x] /= square**0.5


@once
def compiled_see():
    """The entry of `see` for Python, compiled (or loaded from the cache) when it is first asked for."""
    return entry_point(compile_for(see, void(int64, SIGHT)))


def words_in_memory(readings: Readings) -> np.ndarray:
    """Readings as words (k,) int64, whose address `see` is given; the array and the readings must outlive the calls."""
    return np.array(words_of(readings), np.int64)
