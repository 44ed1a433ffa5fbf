"""The account of a step of edmc, and what it takes out of the velocities that the step cannot resolve."""

import math

from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, kernel, on_demand
from anet_lumped.compiled.lanes import WIDTH, column, group_members, is_below, load, select, shifted, store
from anet_lumped.effects.laws.axial import damped_changes
from anet_lumped.effects.signatures import as_force, as_settle, as_whole_step
from anet_lumped.mechanics.cable_rows import add_to_points, put_row3, row3, segment_count, sum_of_members
from anet_lumped.mechanics.effect_forces import any_live, numbers_of, take_middle
from anet_lumped.mechanics.optional import as_cable_settle, as_energy_of_paid_out, as_settle_effects, as_work_of_lengths
from anet_lumped.mechanics.segment_law import BEGINS, group_constant, numerical_damper, spring_of, tension_law
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_L0_RATE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_START,
    KERNEL_ENERGY_OF_PAID_OUT,
    KERNEL_SETTLE_EFFECTS,
    KERNEL_SETTLE_GROUPS,
    KERNEL_SETTLE_SINGLES,
    KERNEL_WORK_OF_LENGTHS,
    LINEARISED_BEGINNING,
    LINEARISED_LEAST_DAMPER,
    SEGMENT_COLUMNS,
    SEGMENT_NUMERICAL_DAMPER,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
    SLOT_FORCE,
    SLOT_SETTLE,
    SLOT_WHOLE_STEP,
)
from integrators.flat_view import flat
from integrators.stage import STAGE

_f1, _f2 = float64[::1], float64[:, ::1]

SPENT = 1e-5  # of the kinetic energy, what the numerical damper may take in a step from a stretch that the step resolves


@inlined
def _mobility(net, node):
    """Inverse of the mass of a node that moves [1/kg], 0 for one that is prescribed."""
    return select(is_below(node, net.n_free), 1.0 / load(net.mass, node), 0.0)


@inlined
def _moved(net, node, a, q, e):
    """How far a driven node has gone along e in a step [m]; 0 for any other."""
    return select(is_below(node, net.n_driven), 0.0, e[0] * (q[0] - a[0]) + e[1] * (q[1] - a[1]) + e[2] * (q[2] - a[2]))


@inlined
def _unresolved(stiff):
    """Share s'/(1 + s') with s' = ``stiff`` squared: near 1 where the step resolves no motion, of fifth order where it does."""
    return stiff * stiff / (1.0 + stiff * stiff)


@inlined
def _cable_settle(stage, net, c, members, base, q, v):
    """`settle` of a cable, or of the cables of a group of which ``members`` count; the impulses go to ``net.middle_v``.

    Returns
    -------
    by_dampers, by_method, put_in, of_impulses, full : float64 [J]
        What dampers and the numerical damper dissipate, what driven ends put in by the tensions, prescribed ends and changes of
        rest lengths by the impulses, and what the numerical damper in full would dissipate.
    """
    h, per_h = stage.tau, 1.0 / stage.tau
    first, node = column(net.cable, c, CABLE_FIRST_SEGMENT), column(net.cable, c, CABLE_FIRST_NODE)
    start, end, count = column(net.cable, c, CABLE_START), column(net.cable, c, CABLE_END), segment_count(net, c)
    L0, k, damper = column(net.axial, c, AXIAL_L0), column(net.axial, c, AXIAL_STIFFNESS), column(net.axial, c, AXIAL_DAMPER)
    spring, two_damper = spring_of(net, c), group_constant(net, c, AXIAL_TWO_WAY_DAMPER)
    square, L_a = column(net.axial, c, AXIAL_OMEGA_SQUARED), column(net.axial, c, AXIAL_L0_BEFORE)
    L0_rate = column(net.axial, c, AXIAL_L0_RATE)
    if group_constant(net, c, AXIAL_INEXTENSIBLE) > 0.0:
        of_taut = of_slack = 2.0 * stage.dissipation + 0.0 * L0
    else:
        stiff, damped = 0.25 * h * h * square, 0.5 * h * square * damper / k
        of_taut = 2.0 * stage.dissipation * _unresolved(stiff + damped * damped)
        of_slack = 2.0 * stage.dissipation * _unresolved(spring[1] * stiff + two_damper * damped * damped)
    A, Q, V, change, segment, zero = flat(base), flat(q), flat(v), flat(net.middle_v), flat(net.segment), 0.0 * L0
    by_dampers, by_method, put_in, of_impulses, total_square = zero, zero, zero, zero, zero
    i1, q1, v1, m1, of_1 = start, row3(Q, start), row3(V, start), _mobility(net, start), load(net.node_segments, start)
    d = zero, zero, zero
    for j in range(count):
        i2 = shifted(node, j, 1, 0) if j < count - 1 else end
        s = shifted(first, j, 1, 0)
        row, T, q2, v2 = shifted(s, 0, SEGMENT_COLUMNS, 0), load(net.tension, s), row3(Q, i2), row3(V, i2)
        m2, of_2 = _mobility(net, i2), load(net.node_segments, i2)
        dx, dy, dz = q2[0] - q1[0], q2[1] - q1[1], q2[2] - q1[2]
        l = math.sqrt(dx * dx + dy * dy + dz * dz)
        per_l, stretch, before = 1.0 / max(l, 1e-12 * L0), l - L0, load(segment, shifted(row, 0, 1, SEGMENT_STRETCH_BEFORE))
        n, longer = (dx * per_l, dy * per_l, dz * per_l), stretch - before
        numerical = load(segment, shifted(row, 0, 1, SEGMENT_NUMERICAL_DAMPER))
        acting, _, secant = tension_law(stage, stretch, before, spring, damper, two_damper, numerical)
        store(segment, shifted(row, 0, 1, SEGMENT_STRETCH), stretch)
        store(segment, shifted(row, 0, 1, SEGMENT_TENSION), acting)
        moved, stretched = damped_changes(before, stretch, spring[1], two_damper)
        of_damper, of_method = damper * per_h * abs(moved), numerical * abs(stretched)
        off, per_damper = (T - secant) * longer, of_damper / max(of_damper + of_method, 1e-300)
        by_dampers, by_method = by_dampers + per_damper * off, by_method + (1.0 - per_damper) * off
        total_square = total_square + longer * longer
        rate = n[0] * (v2[0] - v1[0]) + n[1] * (v2[1] - v1[1]) + n[2] * (v2[2] - v1[2]) - L0_rate
        wanted = select(stretch > 0.0, of_taut, of_slack) * (rate - longer * per_h)
        acts = ((T > 0.0) | (two_damper > 0.0)) & (wanted * rate > 0.0) & (m1 + m2 > 0.0)
        impulse = select(acts, select(abs(wanted) > abs(rate), rate, wanted) / (of_1 * m1 + of_2 * m2), 0.0)
        store(net.tension, s, T + impulse * per_h)
        of_impulses = of_impulses - impulse * L0_rate
        a, b = impulse * m1, impulse * m2
        here = d[0] + a * n[0], d[1] + a * n[1], d[2] + a * n[2]
        if j == 0:
            add_to_points(net.middle_v, 0, start, members, here, 1.0)
            of_impulses = of_impulses - select(m1 == 0.0, impulse, 0.0) * (n[0] * v1[0] + n[1] * v1[1] + n[2] * v1[2])
        else:
            put_row3(change, i1, here)
        if j == count - 1:
            of_impulses = of_impulses + select((m2 == 0.0) & (m1 > 0.0), impulse, 0.0) * (
                n[0] * v2[0] + n[1] * v2[1] + n[2] * v2[2]
            )
        if j == 0 or j == count - 1:
            a1, a2, per = row3(A, i1), row3(A, i2), 1.0 / max(l + before + L_a, 1e-12 * L_a)
            e = (a2[0] - a1[0] + dx) * per, (a2[1] - a1[1] + dy) * per, (a2[2] - a1[2] + dz) * per
            put_in = put_in + T * (_moved(net, i2, a2, q2, e) - _moved(net, i1, a1, q1, e))
        d = -b * n[0], -b * n[1], -b * n[2]
        i1, q1, v1, m1, of_1 = i2, q2, v2, m2, of_2
    add_to_points(net.middle_v, 0, end, members, d, 1.0)
    return (
        sum_of_members(by_dampers, members),
        sum_of_members(by_method, members),
        sum_of_members(put_in, members),
        sum_of_members(of_impulses, members),
        sum_of_members(numerical_damper(stage, net, c) * total_square, members),
    )


@inlined
def _added(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4]


@on_demand
def settle_of_singles(stage, net_address, base, q, v):
    """`_cable_settle` of the cables that are in no group, summed."""
    net, sums = view_net(net_address), (0.0, 0.0, 0.0, 0.0, 0.0)
    for c in net.single_cables:
        sums = _added(sums, _cable_settle(stage, net, c, 1, base, q, v))
    return sums


@on_demand
def settle_of_groups(stage, net_address, base, q, v):
    """`_cable_settle` of the cables that are taken by fours, summed."""
    net, sums = view_net(net_address), (0.0, 0.0, 0.0, 0.0, 0.0)
    for g in range(net.cable_groups.shape[0]):
        members = group_members(net.cable_groups, g)
        sums = _added(sums, _cable_settle(stage, net, members, net.cable_groups[g, WIDTH], base, q, v))
    return sums


@on_demand
def settle_effects(stage, net_address, base, q, v):
    """What effects take out of the velocities at the end of a step, which rings in their contacts; returns its energy [J]."""
    net, taken = view_net(net_address), 0.0
    for e in range(net.effects.address.shape[0]):
        if net.effects.address[e, SLOT_SETTLE] != 0:
            index, params = numbers_of(net.effects, e)
            taken += as_settle(net.effects.address[e, SLOT_SETTLE])(
                stage.t + 0.5 * stage.tau, stage.tau, stage.dissipation, base, q, v, index, params
            )
    return taken


@kernel(types.void(STAGE, _f2, _f2, _f2, int64, _f1))
def settle(stage, base, q, v, net_address, energy):
    """Account for a step of law ``LAW_BETWEEN`` from base to q, and take out of the velocities at its end what rings.

    The energy put in by driven nodes and dissipated is that of the very forces that acted in the step; what changes the rest
    lengths puts in -T (L_b - L_a), so that dampers dissipate by the change of l - L0.

    Where stretching is over within a step, v_b = 2 (q_b - q_a)/h - v_a changes its sign from step to step for ever, while the
    places are at rest. Each segment takes from the rate of l - L0 a share s'/(1 + s') of what that differs from the step's own,
    s' = ((h omega/2)^2 + (h omega^2 c/2k)^2)^2 of the spring and the damper that act on it, so that a slack segment of a cable that
    cannot push takes nothing, by equal and opposite impulses along itself, all at once and each as if its nodes were as many times
    lighter as they have segments: momenta are kept, and the kinetic energy falls but for the work of prescribed nodes and of
    changing rest lengths. Of fifth order where the step resolves the stretching. The impulses over the
    step are a part of the tensions that acted.

    Sets the least share of the numerical damper in the next step: all of it, unless that would take more than `SPENT` of the
    kinetic energy. Where stretching is no part of the motion, the full damper forgets what is left of an error in a length.

    Parameters
    ----------
    stage, base, net_address
        As in the last call of `residual`.
    q, v : (n, 3) float64 [m], [m/s]
        At the end of the step; v is changed.
    energy : (4,) float64 [J], overwritten: put in; dissipated by dampers, by effects and by the method
    """
    net, h, per_h = view_net(net_address), stage.tau, 1.0 / stage.tau
    change, right = net.middle_v, net.right_side
    put_in, by_effects, by_steps_of_effects, kinetic = 0.0, 0.0, 0.0, 0.0
    changing = net.lengths.cable.shape[0] > 0
    if changing:
        put_in = as_work_of_lengths(net.kernels[KERNEL_WORK_OF_LENGTHS])(stage, net_address, base, q, v)
    if any_live(net):
        take_middle(net, 0.5, per_h, base, q)
        for i in range(net.n_free, q.shape[0]):
            for x in range(3):
                right[i, x] = 0.0
        effects = net.effects
        for e in range(effects.address.shape[0]):
            index, params = numbers_of(effects, e)
            if effects.address[e, SLOT_WHOLE_STEP] != 0:
                taken, numerical = as_whole_step(effects.address[e, SLOT_WHOLE_STEP])(
                    stage.t, h, stage.dissipation, base, q, index, params, right, net.diagonal, net.near_blocks, net.far_blocks
                )
                by_effects, by_steps_of_effects = by_effects + taken, by_steps_of_effects + numerical
            else:
                by_effects += h * as_force(effects.address[e, SLOT_FORCE])(
                    stage.t, net.middle_q, net.middle_v, index, params, right
                )
        for i in range(net.n_driven, q.shape[0]):
            for x in range(3):
                put_in -= right[i, x] * (q[i, x] - base[i, x])
        for i in range(net.added_mass.shape[0]):  # what the fluid was given, at the acceleration 2 (v_b - v)/h of the step
            for x in range(3):
                for y in range(3):
                    at_end = v[i, y] - net.middle_v[i, y]
                    by_effects += 2.0 * net.middle_v[i, x] * net.added_mass[i, x, y] * at_end
    for i in range(net.n_interior, q.shape[0]):
        for x in range(3):
            change[i, x] = 0.0
    sums = 0.0, 0.0, 0.0, 0.0, 0.0
    if net.cable_groups.shape[0] > 0:
        sums = as_cable_settle(net.kernels[KERNEL_SETTLE_GROUPS])(stage, net_address, base, q, v)
    if net.single_cables.shape[0] > 0:
        sums = _added(sums, as_cable_settle(net.kernels[KERNEL_SETTLE_SINGLES])(stage, net_address, base, q, v))
    by_dampers, by_method, by_tensions, of_impulses, full = sums
    put_in += by_tensions + of_impulses
    by_method += of_impulses + by_steps_of_effects
    for i in range(net.n_free):
        x, y, z, cx, cy, cz = v[i, 0], v[i, 1], v[i, 2], change[i, 0], change[i, 1], change[i, 2]
        by_method -= net.mass[i] * (cx * (x + 0.5 * cx) + cy * (y + 0.5 * cy) + cz * (z + 0.5 * cz))
        kinetic += 0.5 * net.mass[i] * (x * x + y * y + z * z)
        v[i, 0], v[i, 1], v[i, 2] = x + cx, y + cy, z + cz
    if net.kernels[KERNEL_SETTLE_EFFECTS] != 0:
        by_method += as_settle_effects(net.kernels[KERNEL_SETTLE_EFFECTS])(stage, net_address, base, q, v)
    net.linearised[LINEARISED_LEAST_DAMPER] = min(1.0, SPENT * kinetic / max(full, 1e-300))
    net.linearised[LINEARISED_BEGINNING] = BEGINS
    if changing:
        put_in += as_energy_of_paid_out(net.kernels[KERNEL_ENERGY_OF_PAID_OUT])(stage, net_address, q, v)
    energy[0], energy[1], energy[2], energy[3] = put_in, by_dampers, by_effects, by_method
