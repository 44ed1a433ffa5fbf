"""Force on every node at one time, and the prescribed motion: all that an explicit method asks of a net."""

import math

from numba import float64, int64, njit, void

from anet_lumped.compiled.lanes import (
    WIDTH,
    index,
    lane,
    members_of,
    of_table,
)
from anet_lumped.effects.laws.axial import tension_parts
from anet_lumped.effects.signatures import as_force
from anet_lumped.mechanics.cable_rows import add_to_points, put_row3, row3, segment_count
from anet_lumped.mechanics.effect_forces import _share_with_fluid, numbers_of
from anet_lumped.mechanics.length_work import _as_of_first_masses, power_of_lengths
from anet_lumped.mechanics.segment_law import (
    spring_of,
    switch,
)
from anet_lumped.mechanics.set_lengths import set_lengths
from anet_lumped.model.net import net_at
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_L0_RATE,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_START,
    SLOT_FORCE,
)
from anet_lumped.prescribed.path_kernel import evaluate

_f1, _f2 = float64[::1], float64[:, ::1]


@njit(void(float64, int64, _f2, _f2), cache=True, error_model="numpy", fastmath={"contract"})
def prescribe(t, place, q, v):
    """Write place and velocity of the driven nodes at time t; fixed ones keep what they hold."""
    net = net_at(place)
    if net.lengths.cable.shape[0] > 0:
        set_lengths(place, t, t, t)
    first = net.n_driven
    if first < q.shape[0]:
        evaluate(t, net.paths, q[first:], v[first:], net.step[first:])
        net.step[first:] = 0.0


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _force_of(net, c, members, q, v, f):
    """`force` of a cable, or of the cables of a group of which ``members`` count; returns the power that dampers dissipate."""
    node, start, end = (
        of_table(net.cable, c, CABLE_FIRST_NODE),
        of_table(net.cable, c, CABLE_START),
        of_table(net.cable, c, CABLE_END),
    )
    L0, spring, damper = of_table(net.axial, c, AXIAL_L0), spring_of(net, c), of_table(net.axial, c, AXIAL_DAMPER)
    two_damper, count = switch(net, c, AXIAL_TWO_WAY_DAMPER), segment_count(net, c)
    Q, V, F, lost, growth = q.ravel(), v.ravel(), f.ravel(), 0.0 * L0, of_table(net.axial, c, AXIAL_L0_RATE)
    i, q0, v0, pull = start, row3(Q, start), row3(V, start), (lost, lost, lost)
    for j in range(count):
        after = index(node, j, 1, 0) if j < count - 1 else end
        q1, v1 = row3(Q, after), row3(V, after)
        dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
        l = math.sqrt(dx * dx + dy * dy + dz * dz)
        per_l = 1.0 / max(l, 1e-12 * L0)
        rate = (dx * (v1[0] - v0[0]) + dy * (v1[1] - v0[1]) + dz * (v1[2] - v0[2])) * per_l - growth
        T, elastic = tension_parts(l - L0, rate, spring, damper, two_damper)
        lost = lost + (T - elastic) * rate
        along = T * per_l
        ahead = along * dx, along * dy, along * dz
        here = ahead[0] - pull[0], ahead[1] - pull[1], ahead[2] - pull[2]
        if j == 0:
            add_to_points(f, 0, start, members, here, 1.0)
        else:
            put_row3(F, i, here)
        i, q0, v0, pull = after, q1, v1, ahead
    add_to_points(f, 0, end, members, pull, -1.0)
    power = 0.0
    for x in range(members):
        power += lane(lost, x)
    return power


@njit(void(float64, _f2, _f2, int64, _f2, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def force(t, q, v, place, f, power):
    """Force on every node.

    f_i = external + sum over its segments of -+ T n, T = EA eps + BA (dl/dt)/L0 by the cable's compression law.

    Parameters
    ----------
    t : float64 [s]
    q, v : (n, 3) float64 [m], [m/s]
    place : int64, address of the net
    f : (n, 3) float64 [N], overwritten; on a node with added mass A the share m (m I + A)^-1 that accelerates its own
    power : (2,) float64 [W], overwritten: dissipated by dampers and effects; put in by prescribed nodes and by what changes the
        rest lengths. Masses that change share the force on moving nodes like added ones, so that f/m is the acceleration for
        the masses m of the model
    """
    net = net_at(place)
    if net.lengths.cable.shape[0] > 0:
        set_lengths(place, t, t, t)
    f[net.n_interior :] = 0.0
    dissipated = 0.0
    for g in range(net.group.shape[0]):
        dissipated += _force_of(net, members_of(net.group, g), net.group[g, WIDTH], q, v, f)
    for c in net.alone:
        dissipated += _force_of(net, c, 1, q, v, f)
    effects = net.effects
    for e in range(effects.address.shape[0]):
        index, params = numbers_of(effects, e)
        dissipated += as_force(effects.address[e, SLOT_FORCE])(t, q, v, index, params, f)
    if net.added.shape[0] > 0:
        dissipated += _share_with_fluid(net, t, q, v, f)
    put_in = 0.0
    if net.lengths.cable.shape[0] > 0:
        put_in = power_of_lengths(place, t, q, v)
        _as_of_first_masses(net, f)
    for i in range(net.n_driven, q.shape[0]):
        put_in -= f[i, 0] * v[i, 0] + f[i, 1] * v[i, 1] + f[i, 2] * v[i, 2]
    power[0], power[1] = dissipated, put_in
