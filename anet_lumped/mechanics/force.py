"""Force on every node at one time: all that an explicit method needs of a net."""

import math

from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, kernel, on_demand
from anet_lumped.compiled.lanes import WIDTH, column, group_members, shifted
from anet_lumped.effects.laws.axial import tension_parts
from anet_lumped.effects.signatures import as_force
from anet_lumped.mechanics.cable_rows import add_to_points, put_row3, row3, segment_count, sum_of_members
from anet_lumped.mechanics.effect_forces import numbers_of, share_with_fluid
from anet_lumped.mechanics.optional import as_cable_force, as_force_bodies, as_power_of_lengths, as_set_lengths
from anet_lumped.mechanics.segment_law import SHORTEST, group_constant, spring_of
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_L0_RATE,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_START,
    KERNEL_FORCE_BODIES,
    KERNEL_FORCE_GROUPS,
    KERNEL_FORCE_SINGLES,
    KERNEL_FORCE_TRAILS,
    KERNEL_POWER_OF_LENGTHS,
    KERNEL_SET_LENGTHS,
    SLOT_FORCE,
)
from integrators.flat_view import flat

_f1, _f2 = float64[::1], float64[:, ::1]


@inlined
def _cable_force(net, c, members, count, q, v, f):
    """Add the force of a cable of ``count`` segments, or of the ``members`` cables of a group, to f.

    Returns the power that dampers dissipate [W].
    """
    node, start, end = column(net.cable, c, CABLE_FIRST_NODE), column(net.cable, c, CABLE_START), column(net.cable, c, CABLE_END)
    L0, spring, damper = column(net.axial, c, AXIAL_L0), spring_of(net, c), column(net.axial, c, AXIAL_DAMPER)
    two_way_damper = group_constant(net, c, AXIAL_TWO_WAY_DAMPER)
    flat_q, flat_v, flat_f, dissipated, L0_rate = flat(q), flat(v), flat(f), 0.0 * L0, column(net.axial, c, AXIAL_L0_RATE)
    i, q0, v0, pull_behind = start, row3(flat_q, start), row3(flat_v, start), (dissipated, dissipated, dissipated)
    for j in range(count):
        next_node = shifted(node, j, 1, 0) if j < count - 1 else end
        q1, v1 = row3(flat_q, next_node), row3(flat_v, next_node)
        dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
        l = math.sqrt(dx * dx + dy * dy + dz * dz)
        per_l = 1.0 / max(l, SHORTEST * L0)
        rate = (dx * (v1[0] - v0[0]) + dy * (v1[1] - v0[1]) + dz * (v1[2] - v0[2])) * per_l - L0_rate
        T, elastic = tension_parts(l - L0, rate, spring, damper, two_way_damper)
        dissipated = dissipated + (T - elastic) * rate
        tension_per_length = T * per_l
        pull = tension_per_length * dx, tension_per_length * dy, tension_per_length * dz
        node_force = pull[0] - pull_behind[0], pull[1] - pull_behind[1], pull[2] - pull_behind[2]
        if j == 0:
            add_to_points(f, 0, start, members, node_force, 1.0)
        else:
            put_row3(flat_f, i, node_force)
        i, q0, v0, pull_behind = next_node, q1, v1, pull
    add_to_points(f, 0, end, members, pull_behind, -1.0)
    return sum_of_members(dissipated, members)


@on_demand
def force_of_singles(net_address, q, v, f):
    """Add the force of the cables that are in no group and on no trail to f; return the power that their dampers dissipate [W]."""
    net, dissipated = view_net(net_address), 0.0
    for c in net.trails.other_cables:
        dissipated += _cable_force(net, c, 1, segment_count(net, c), q, v, f)
    return dissipated


@on_demand
def force_of_groups(net_address, q, v, f):
    """Add the force of the cables that are taken by fours to f; return the power that their dampers dissipate [W]."""
    net, dissipated = view_net(net_address), 0.0
    for g in range(net.cable_groups.shape[0]):
        members = group_members(net.cable_groups, g)
        dissipated += _cable_force(net, members, net.cable_groups[g, WIDTH], segment_count(net, members), q, v, f)
    return dissipated


@kernel(types.void(float64, _f2, _f2, int64, _f2, _f1))
def force(t, q, v, net_address, f, power):
    """Force on every node.

    f_i = external force + sum over the segments at node i of +- T n. A taut segment has T = k (l - L0) + c d(l - L0)/dt, a slack
    one T by the cable's compression law.

    Parameters
    ----------
    t : float64 [s]
    q, v : (n, 3) float64 [m], [m/s]
    net_address : int64
    f : (n, 3) float64 [N], overwritten
        f/m0 is the acceleration of a moving node, with its mass m0 in the model. So the force is multiplied by m (m I + A)^-1, with
        the current mass m and the added mass A, and by m0/m.
    power : (3,) float64 [W], overwritten
        Power taken by dampers; power taken by effects; power put in by prescribed nodes and by changes of the rest lengths.
    """
    net = view_net(net_address)
    trails = net.trails
    if net.lengths.cable.shape[0] > 0:
        as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t, t, t)
    for i in range(0 if trails.run.shape[0] > 0 else net.n_interior, f.shape[0]):
        for x in range(3):
            f[i, x] = 0.0
    by_dampers, by_effects, put_in = 0.0, 0.0, 0.0
    if net.cable_groups.shape[0] > 0:
        by_dampers += as_cable_force(net.kernels[KERNEL_FORCE_GROUPS])(net_address, q, v, f)
    if trails.run.shape[0] > 0:
        by_dampers += as_cable_force(net.kernels[KERNEL_FORCE_TRAILS])(net_address, q, v, f)
    if trails.other_cables.shape[0] > 0:
        by_dampers += as_cable_force(net.kernels[KERNEL_FORCE_SINGLES])(net_address, q, v, f)
    effects = net.effects
    for e in range(effects.address.shape[0]):
        index, params = numbers_of(effects, e)
        by_effects += as_force(effects.address[e, SLOT_FORCE])(t, q, v, index, params, f)
    if net.added_mass.shape[0] > 0:
        by_effects += share_with_fluid(net, t, q, v, f)
    if net.lengths.cable.shape[0] > 0:
        put_in = as_power_of_lengths(net.kernels[KERNEL_POWER_OF_LENGTHS])(net_address, t, q, v, f)
    if net.bodies.first < net.n_free:
        by_effects += as_force_bodies(net.kernels[KERNEL_FORCE_BODIES])(net_address, t, q, v, f)
    for i in range(net.n_driven, q.shape[0]):
        put_in -= f[i, 0] * v[i, 0] + f[i, 1] * v[i, 1] + f[i, 2] * v[i, 2]
    power[0], power[1], power[2] = by_dampers, by_effects, put_in
