"""The account of a step of edmc, and what it takes out of the velocities that the step cannot resolve."""

import math

from numba import float64, int64, njit, void

from anet_lumped.compiled.lanes import (
    WIDTH,
    at,
    below,
    index,
    lane,
    members_of,
    of_table,
    put,
    select,
)
from anet_lumped.effects.signatures import as_between, as_force
from anet_lumped.mechanics.cable_rows import add_to_points, put_row3, row3, segment_count
from anet_lumped.mechanics.effect_forces import any_live, take_middle
from anet_lumped.mechanics.length_work import work_of_lengths
from anet_lumped.mechanics.segment_law import (
    BEGINS,
    law_of,
    numerical_damper,
    spring_of,
    switch,
)
from anet_lumped.mechanics.set_lengths import energy_between, set_lengths
from anet_lumped.model.net import net_at
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_START,
    LINEARISED_BEGINNING,
    LINEARISED_LEAST_DAMPER,
    PAID_BEFORE,
    PAID_MIDDLE,
    PAID_NOW,
    SEGMENT_COLUMNS,
    SEGMENT_NUMERICAL_DAMPER,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
    SLOT_FORCE,
    SLOT_WHOLE_STEP,
)
from integrators.stage import STAGE

_f1, _f2 = float64[::1], float64[:, ::1]

SPENT = 1e-5  # of the kinetic energy, what the numerical damper may take in a step from a stretch that the step resolves


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _mobility(net, node):
    """Inverse of the mass of a node that moves [1/kg], 0 for one that is prescribed."""
    return select(below(node, net.n_free), 1.0 / at(net.mass, node), 0.0)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _moved(net, node, a, q, e):
    """How far a driven node has gone along e in a step [m]; 0 for any other."""
    return select(below(node, net.n_driven), 0.0, e[0] * (q[0] - a[0]) + e[1] * (q[1] - a[1]) + e[2] * (q[2] - a[2]))


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _settle_of(stage, net, c, members, base, q, v):
    """`settle` of a cable, or of the cables of a group of which ``members`` count; the impulses go to ``net.middle_v``.

    Returns
    -------
    dissipated, put_in, lost, full : float64 [J]
        ``lost`` is what prescribed ends put in by the impulses, ``full`` what the numerical damper in full would dissipate.
    """
    h, per_h = stage.tau, 1.0 / stage.tau
    first, node = of_table(net.cable, c, CABLE_FIRST_SEGMENT), of_table(net.cable, c, CABLE_FIRST_NODE)
    start, end, count = of_table(net.cable, c, CABLE_START), of_table(net.cable, c, CABLE_END), segment_count(net, c)
    L0, k, damper = of_table(net.axial, c, AXIAL_L0), of_table(net.axial, c, AXIAL_STIFFNESS), of_table(net.axial, c, AXIAL_DAMPER)
    spring, two_damper = spring_of(net, c), switch(net, c, AXIAL_TWO_WAY_DAMPER)
    square, L_a = of_table(net.axial, c, AXIAL_OMEGA_SQUARED), of_table(net.axial, c, AXIAL_L0_BEFORE)
    if switch(net, c, AXIAL_INEXTENSIBLE) > 0.0:
        share = 2.0 * stage.dissipation + 0.0 * L0
    else:
        damped = 0.5 * h * square * damper / k
        stiff = 0.25 * h * h * square + damped * damped
        share = 2.0 * stage.dissipation * (stiff * stiff / (1.0 + stiff * stiff))
    A, Q, V, change, segment, zero = base.ravel(), q.ravel(), v.ravel(), net.middle_v.ravel(), net.segment.ravel(), 0.0 * L0
    dissipated, put_in, lost, total_square = zero, zero, zero, zero
    i1, q1, v1, m1, of_1 = start, row3(Q, start), row3(V, start), _mobility(net, start), at(net.degree, start)
    d = zero, zero, zero
    for j in range(count):
        i2 = index(node, j, 1, 0) if j < count - 1 else end
        s = index(first, j, 1, 0)
        row, T, q2, v2 = index(s, 0, SEGMENT_COLUMNS, 0), at(net.tension, s), row3(Q, i2), row3(V, i2)
        m2, of_2 = _mobility(net, i2), at(net.degree, i2)
        dx, dy, dz = q2[0] - q1[0], q2[1] - q1[1], q2[2] - q1[2]
        l = math.sqrt(dx * dx + dy * dy + dz * dz)
        per_l, stretch, before = 1.0 / max(l, 1e-12 * L0), l - L0, at(segment, index(row, 0, 1, SEGMENT_STRETCH_BEFORE))
        n, longer = (dx * per_l, dy * per_l, dz * per_l), stretch - before
        numerical = at(segment, index(row, 0, 1, SEGMENT_NUMERICAL_DAMPER))
        acting, _, secant = law_of(stage, stretch, before, spring, damper, two_damper, numerical)
        put(segment, index(row, 0, 1, SEGMENT_STRETCH), stretch)
        put(segment, index(row, 0, 1, SEGMENT_TENSION), acting)
        dissipated, total_square = dissipated + (T - secant) * longer, total_square + longer * longer
        rate = n[0] * (v2[0] - v1[0]) + n[1] * (v2[1] - v1[1]) + n[2] * (v2[2] - v1[2])
        wanted = share * (rate - (longer + L0 - L_a) * per_h)
        acts = (T > 0.0) & (wanted * rate > 0.0) & (m1 + m2 > 0.0)
        impulse = select(acts, select(abs(wanted) > abs(rate), rate, wanted) / (of_1 * m1 + of_2 * m2), 0.0)
        put(net.tension, s, T + impulse * per_h)
        a, b = impulse * m1, impulse * m2
        here = d[0] + a * n[0], d[1] + a * n[1], d[2] + a * n[2]
        if j == 0:
            add_to_points(net.middle_v, 0, start, members, here, 1.0)
            lost = lost - select(m1 == 0.0, impulse, 0.0) * (n[0] * v1[0] + n[1] * v1[1] + n[2] * v1[2])
        else:
            put_row3(change, i1, here)
        if j == count - 1:
            lost = lost + select((m2 == 0.0) & (m1 > 0.0), impulse, 0.0) * (n[0] * v2[0] + n[1] * v2[1] + n[2] * v2[2])
        if j == 0 or j == count - 1:
            a1, a2, per = row3(A, i1), row3(A, i2), 1.0 / max(l + before + L_a, 1e-12 * L_a)
            e = (a2[0] - a1[0] + dx) * per, (a2[1] - a1[1] + dy) * per, (a2[2] - a1[2] + dz) * per
            put_in = put_in + T * (_moved(net, i2, a2, q2, e) - _moved(net, i1, a1, q1, e))
        d = -b * n[0], -b * n[1], -b * n[2]
        i1, q1, v1, m1, of_1 = i2, q2, v2, m2, of_2
    add_to_points(net.middle_v, 0, end, members, d, 1.0)
    full = numerical_damper(stage, net, c) * total_square
    sums = 0.0, 0.0, 0.0, 0.0
    for x in range(members):
        sums = (
            sums[0] + lane(dissipated, x), sums[1] + lane(put_in, x), sums[2] + lane(lost, x), sums[3] + lane(full, x)
        )  # fmt: skip
    return sums


@njit(void(STAGE, _f2, _f2, _f2, int64, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def settle(stage, base, q, v, place, energy):
    """Account for a step of law ``LAW_BETWEEN`` from base to q, and take out of the velocities at its end what rings.

    The energy put in by driven nodes and dissipated is that of the very forces that acted in the step; what changes the rest
    lengths puts in -T (L_b - L_a), so that dampers dissipate by the change of l - L0.

    Where stretching is over within a step, v_b = 2 (q_b - q_a)/h - v_a changes its sign from step to step for ever, while the
    places are at rest. Each taut segment takes from the rate at which its length changes a share s'/(1 + s') of what that
    differs from the step's own, s' = ((h omega/2)^2 + (h omega^2 c/2k)^2)^2, by equal and opposite impulses along itself, all at
    once and each as if its nodes were as many times lighter as they have segments: momenta are kept, and the kinetic energy
    falls but for the work of prescribed nodes. Of fifth order where the step resolves the stretching. The impulses over the
    step are a part of the tensions that acted.

    Sets the least share of the numerical damper in the next step: all of it, unless that would take more than `SPENT` of the
    kinetic energy. Where stretching is no part of the motion, the full damper forgets what is left of an error in a length.

    Parameters
    ----------
    stage, base, place
        As in the last call of `residual`.
    q, v : (n, 3) float64 [m], [m/s]
        At the end of the step; v is changed.
    energy : (2,) float64 [J], overwritten: put in and dissipated
    """
    net, h, per_h = net_at(place), stage.tau, 1.0 / stage.tau
    change, right = net.middle_v, net.right
    dissipated, put_in, lost, full, kinetic = 0.0, 0.0, 0.0, 0.0, 0.0
    lengths = net.lengths
    if lengths.cable.shape[0] > 0:
        put_in = work_of_lengths(stage, base, q, place)
        if lengths.mass_node.shape[0] > 0:
            for i in range(net.n_free):
                for x in range(3):
                    net.middle_q[i, x] = 2.0 * (q[i, x] - base[i, x]) * per_h - v[i, x]  # velocity at the start
            put_in += energy_between(
                place, stage.t - 0.5 * h, base, net.middle_q, lengths.paid[PAID_BEFORE], lengths.paid[PAID_MIDDLE]
            )
    if any_live(net):
        take_middle(net, 0.5, per_h, base, q)
        for i in range(net.n_free, q.shape[0]):
            for x in range(3):
                right[i, x] = 0.0
        effects = net.effects
        for e in range(effects.address.shape[0]):
            i, j = effects.index_at[e], effects.index_at[e + 1]
            a, b = effects.params_at[e], effects.params_at[e + 1]
            index, params, of = effects.index[i:j], effects.params[a:b], effects.address[e]
            if of[SLOT_WHOLE_STEP] != 0:
                dissipated += as_between(of[SLOT_WHOLE_STEP])(
                    stage.t, h, base, q, index, params, right, net.diagonal, net.near, net.far
                )
            else:
                dissipated += h * as_force(of[SLOT_FORCE])(stage.t, net.middle_q, net.middle_v, index, params, right)
        for i in range(net.n_driven, q.shape[0]):
            for x in range(3):
                put_in -= right[i, x] * (q[i, x] - base[i, x])
        for i in range(net.added.shape[0]):  # what the fluid was given, at the acceleration 2 (v_b - v)/h of the step
            for x in range(3):
                for y in range(3):
                    at_end = v[i, y] - net.middle_v[i, y]
                    dissipated += 2.0 * net.middle_v[i, x] * net.added[i, x, y] * at_end
    for i in range(net.n_interior, q.shape[0]):
        for x in range(3):
            change[i, x] = 0.0
    for g in range(net.group.shape[0]):
        of = _settle_of(stage, net, members_of(net.group, g), net.group[g, WIDTH], base, q, v)
        dissipated, put_in, lost, full = dissipated + of[0], put_in + of[1], lost + of[2], full + of[3]
    for c in net.alone:
        of = _settle_of(stage, net, c, 1, base, q, v)
        dissipated, put_in, lost, full = dissipated + of[0], put_in + of[1], lost + of[2], full + of[3]
    put_in += lost
    for i in range(net.n_free):
        x, y, z, cx, cy, cz = v[i, 0], v[i, 1], v[i, 2], change[i, 0], change[i, 1], change[i, 2]
        lost -= net.mass[i] * (cx * (x + 0.5 * cx) + cy * (y + 0.5 * cy) + cz * (z + 0.5 * cz))
        kinetic += 0.5 * net.mass[i] * (x * x + y * y + z * z)
        v[i, 0], v[i, 1], v[i, 2] = x + cx, y + cy, z + cz
    net.linearised[LINEARISED_LEAST_DAMPER] = min(1.0, SPENT * kinetic / max(full, 1e-300))
    net.linearised[LINEARISED_BEGINNING] = BEGINS
    if lengths.cable.shape[0] > 0:
        if lengths.mass_node.shape[0] > 0:
            put_in += energy_between(place, stage.t + 0.5 * h, q, v, lengths.paid[PAID_MIDDLE], lengths.paid[PAID_NOW])
        set_lengths(place, stage.t + 0.5 * h, stage.t + 0.5 * h, stage.t + 0.5 * h)
    energy[0], energy[1] = put_in, dissipated + lost
