"""Tensions and energies of a state, which a run saves. Both need the length of every segment, and are found in one pass.

Cables that are taken one by one, cables that are taken by fours and cables that creep have kernels of their own, which are compiled
for the scenes that have such cables.
"""

import math

from numba import float64, int64

from anet_lumped.compiled.jit import inlined, internal, kernel, on_demand
from anet_lumped.compiled.lanes import WIDTH, column, group_members, load, load_four, select, shifted, store, sum_of_lanes
from anet_lumped.compiled.rows_of_lanes import load_row, spread, thrice
from anet_lumped.effects.laws.axial import elastic_secant, tension_parts
from anet_lumped.effects.laws.creep import slow_part, stored_energy, tension_at_once
from anet_lumped.effects.signatures import as_energy
from anet_lumped.mechanics.cable_rows import row3, segment_count, sum_of_members
from anet_lumped.mechanics.creeping_law import creep_of
from anet_lumped.mechanics.effect_forces import numbers_of
from anet_lumped.mechanics.optional import as_cable_observe, as_set_lengths
from anet_lumped.mechanics.plain_cables import are_plain, law_of, plain_law_of
from anet_lumped.mechanics.segment_law import SHORTEST
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_L0_RATE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_STIFFNESS,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_START,
    CREEP_STATIC,
    CREPT_CHANGE,
    CREPT_STRETCH,
    CREPT_T_MAX,
    KERNEL_OBSERVE_GROUPS,
    KERNEL_OBSERVE_SINGLES,
    KERNEL_SET_LENGTHS,
    LINEARISED_LAW,
    LINEARISED_MEAN_STEP,
    LINEARISED_TAU,
    SEGMENT_COLUMNS,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
    SLOT_ENERGY,
)
from integrators.flat_view import flat
from integrators.stage import LAW_AT_END, LAW_BACKWARD, LAW_BETWEEN
from integrators.system import NO_EVENTS, OBSERVE

_f2 = float64[:, ::1]
BETWEEN = float(LAW_BETWEEN)  # of the type of that in ``Net.linearised``, so that what takes either is compiled once


@internal
def _creeping_tension(net, c, s, stretch, rate, acting):
    """`observe` of a segment s of cable c that creeps, of the ``stretch`` l - L0 [m] and the ``rate`` of length [m/s]."""
    creep, crept, row, h = creep_of(net, c, s), net.crept[s, CREPT_STRETCH], net.segment[s], net.linearised[LINEARISED_TAU]
    if net.linearised[LINEARISED_LAW] != LAW_BETWEEN or stretch <= crept + slow_part(crept, creep).offset:
        return tension_at_once(stretch - crept, crept, rate, creep)
    mean_rate = (row[SEGMENT_STRETCH] - row[SEGMENT_STRETCH_BEFORE] + net.crept[s, CREPT_CHANGE]) / h
    k, omega_squared = net.axial[c, AXIAL_STIFFNESS], net.axial[c, AXIAL_OMEGA_SQUARED]
    resolved = 1.0 / (1.0 + (0.25 * h + 0.5 * creep.fast_damper / k) * h * omega_squared)
    at_once = tension_at_once(stretch - crept, crept, mean_rate + resolved * (rate - mean_rate), creep)
    return max(acting - row[SEGMENT_TENSION] + at_once, 0.0)


@inlined
def observe_cable(net, c, stage_law, law, q, v, tension, creeps):
    """Write the tensions of a cable, or of a group of cables; returns the energy of the springs of each cable [J].

    ``stage_law`` is that of the last stage, ``law`` what `law_of` returns, and ``creeps`` True for a cable that creeps, else None.
    """
    first, node, end = (
        column(net.cable, c, CABLE_FIRST_SEGMENT),
        column(net.cable, c, CABLE_FIRST_NODE),
        column(net.cable, c, CABLE_END),
    )
    before, count, flat_q, flat_v, segment = (
        column(net.cable, c, CABLE_START),
        segment_count(net, c),
        flat(q),
        flat(v),
        flat(net.segment),
    )
    L0, k, damper = column(net.axial, c, AXIAL_L0), column(net.axial, c, AXIAL_STIFFNESS), column(net.axial, c, AXIAL_DAMPER)
    (spring, two_way_damper, inextensible), L0_rate = law, column(net.axial, c, AXIAL_L0_RATE)
    omega_squared = column(net.axial, c, AXIAL_OMEGA_SQUARED)
    acted_at_end = stage_law == LAW_BACKWARD or inextensible > 0.0
    over_step, h, mean_step = stage_law == LAW_BETWEEN, net.linearised[LINEARISED_TAU], net.linearised[LINEARISED_MEAN_STEP]
    per_h, resolved = 1.0 / h, 1.0 / (1.0 + (0.25 * h + 0.5 * damper / k) * h * omega_squared)
    stiff = (0.25 * mean_step + 0.5 * damper / k) * mean_step * omega_squared
    energy, q1, v1 = 0.0 * L0, row3(flat_q, before), row3(flat_v, before)
    for j in range(count):
        i = shifted(node, j, 1, 0) if j < count - 1 else end
        s = shifted(first, j, 1, 0)
        acting, q2, v2 = load(net.tension, s), row3(flat_q, i), row3(flat_v, i)
        if two_way_damper == 0.0:
            acting = max(acting, 0.0)
        dx, dy, dz = q2[0] - q1[0], q2[1] - q1[1], q2[2] - q1[2]
        l = math.sqrt(dx * dx + dy * dy + dz * dz)
        secant, _ = elastic_secant(0.0 * l, l - L0, spring)
        energy_of_segment, T = secant * (l - L0), acting
        if creeps is not None:
            crept = net.crept[s, CREPT_STRETCH]
            energy_of_segment = stored_energy(l - L0 - crept, crept, creep_of(net, c, s))
        if not acted_at_end:
            rate = dx * (v2[0] - v1[0]) + dy * (v2[1] - v1[1]) + dz * (v2[2] - v1[2])
            rate = rate / max(l, SHORTEST * L0) - L0_rate
            T, elastic = tension_parts(l - L0, rate, spring, damper, two_way_damper)
            if over_step:
                row = shifted(s, 0, SEGMENT_COLUMNS, SEGMENT_TENSION)
                spring_at_end, stretch_before, stretch, _ = load_four(segment, row)
                if two_way_damper == 0.0:
                    stretch_before, stretch = max(stretch_before, 0.0), max(stretch, 0.0)
                mean_rate = (stretch - stretch_before) * per_h
                at_end = acting + (elastic - spring_at_end + damper * mean_rate) + damper * resolved * (rate - mean_rate)
                if two_way_damper == 0.0:
                    at_end = max(at_end, 0.0)
                T = select((elastic != 0.0) | (two_way_damper > 0.0), at_end, T)
            elif stage_law == LAW_AT_END and mean_step > 0.0:
                mean_tension = load(net.mean_tension, s)
                T = mean_tension + (T - mean_tension) / (1.0 + stiff * stiff)
            if creeps is not None:
                T = _creeping_tension(net, c, s, l - L0, rate, acting)
        store(tension, s, T)
        energy, q1, v1 = energy + energy_of_segment, q2, v2
    return energy


@on_demand
def observe_of_singles(q, v, net_address, tension):
    """`observe_cables` of those that are in no group."""
    net, elastic = view_net(net_address), 0.0
    for c in net.single_cables:
        elastic += observe_cable(net, c, net.linearised[LINEARISED_LAW], law_of(net, c), q, v, tension, None)
    return elastic


@on_demand
def observe_of_creeping(q, v, net_address, tension):
    """`observe_cables` of those that are in no group, some of which creep."""
    net, elastic = view_net(net_address), 0.0
    count = net.tension.shape[0]
    for i in range(net.crept.shape[0] if tension.shape[0] > count else 0):
        tension[count + i], tension[2 * count + i] = net.crept[i, CREPT_STRETCH], net.crept[i, CREPT_T_MAX]
    for c in net.single_cables:
        if net.creep[c, CREEP_STATIC] > 0.0:
            elastic += observe_cable(net, c, net.linearised[LINEARISED_LAW], law_of(net, c), q, v, tension, True)
        else:
            elastic += observe_cable(net, c, net.linearised[LINEARISED_LAW], law_of(net, c), q, v, tension, None)
    return elastic


@on_demand
def observe_of_groups(q, v, net_address, tension):
    """`observe_cables` of those that are taken by fours."""
    net, elastic = view_net(net_address), 0.0
    stage_law = net.linearised[LINEARISED_LAW]
    for g in range(net.cable_groups.shape[0]):
        c = group_members(net.cable_groups, g)
        if are_plain(stage_law, net, c):
            of_cables = observe_cable(net, c, BETWEEN, plain_law_of(net, c), q, v, tension, None)
        else:
            of_cables = observe_cable(net, c, stage_law, law_of(net, c), q, v, tension, None)
        elastic += sum_of_members(of_cables, net.cable_groups[g, WIDTH])
    return elastic


@internal
def observe_cables(q, v, net_address, tension):
    """Write the tension of every segment in a state (n_segments,) [N]; returns the energy of all springs [J].

    The law at one time would multiply rounding errors of the positions by the stiffness. Therefore the tension depends on the last
    stage:

    * `LAW_BACKWARD`, and cables that do not stretch: the tension that acted, since it acted at the end of the step.
    * `LAW_BETWEEN`: the tension T that acted over the step h, plus the difference by the law between the end of the step and the
      whole step. T_law is the tension over the step by the law, T_spring the tension of the spring at the end, r the rate of the
      stretch at the end, and r_m its mean over the step:

          T_end = T + (T_spring - T_law + c r_m) + c (r - r_m)/(1 + (h/4 + c/(2 k)) h omega^2) .

      The last term is small where the step does not resolve the stretching: the rate at one time means little there.
    * Stages of a Runge-Kutta step whose mean tension T_m was taken: with s = (h/4 + c/(2 k)) h omega^2,

          T_end = T_m + (T_law - T_m)/(1 + s^2) ,

      which is the law where the step resolves the stretching, and the mean where it does not.
    * Otherwise: the law at one time.

    Of cables that creep the law is that of `creep.tension_at_once`. The slow stretches [m] and the largest tensions held [N] follow
    the tensions of all segments, where ``tension`` has room for them.
    """
    net, elastic = view_net(net_address), 0.0
    if net.single_cables.shape[0] > 0:
        elastic += as_cable_observe(net.kernels[KERNEL_OBSERVE_SINGLES])(q, v, net_address, tension)
    if net.cable_groups.shape[0] > 0:
        elastic += as_cable_observe(net.kernels[KERNEL_OBSERVE_GROUPS])(q, v, net_address, tension)
    return elastic


@internal
def _kinetic_energy(net_address, v):
    """Kinetic energy of the moving nodes [J]; four of them are taken at once."""
    net = view_net(net_address)
    flat_v, mass, squares, by_fours = flat(v), net.mass, spread(0.0), net.n_free - net.n_free % WIDTH
    for i in range(0, by_fours, WIDTH):
        m = thrice(load_row(mass, i))
        x, y, z = load_row(flat_v, 3 * i), load_row(flat_v, 3 * i + WIDTH), load_row(flat_v, 3 * i + 2 * WIDTH)
        squares = squares + (m[0] * (x * x) + m[1] * (y * y) + m[2] * (z * z))
    kinetic = 0.5 * sum_of_lanes(squares)
    for i in range(by_fours, net.n_free):
        kinetic += 0.5 * mass[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
    return kinetic


@internal
def write_energies(t, q, v, net_address, elastic, energy):
    """Write the energies of a state (3,) [J]: kinetic of the moving nodes, ``elastic`` of the springs, potential of the effects."""
    net, potential = view_net(net_address), 0.0
    effects = net.effects
    for e in range(effects.address.shape[0]):
        index, params = numbers_of(effects, e)
        potential += as_energy(effects.address[e, SLOT_ENERGY])(t, q, index, params)
    energy[0], energy[1], energy[2] = _kinetic_energy(net_address, v), elastic, potential


@kernel(OBSERVE)
def observe(t, q, v, net_address, row, energy):
    """Write the tensions of a state, see `observe_cables`, and its energies at time t, see `write_energies`.

    Where ``energy`` has no room, only tensions are written, and t does not count.
    """
    asked, net = energy.shape[0] > 0, view_net(net_address)
    if asked and net.lengths.cable.shape[0] > 0:
        as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t, t, t)
    elastic = observe_cables(q, v, net_address, row)
    if asked:
        write_energies(t, q, v, net_address, elastic, energy)


@kernel(float64(_f2, _f2, int64))
def no_margin(q, v, net_address):
    """`System.margin` of a net whose cables do not break: `NO_EVENTS`."""
    return NO_EVENTS
