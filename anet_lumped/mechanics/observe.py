"""Tensions and energies of a state, which a run saves."""

import math

from numba import float64, int64, void

from anet_lumped.compiled.jit import internal, kernel
from anet_lumped.effects.laws.axial import elastic_energy, tension_parts
from anet_lumped.effects.laws.creep import stored_energy, tension_at_once
from anet_lumped.effects.signatures import as_energy
from anet_lumped.mechanics.creeping_law import creep_of
from anet_lumped.mechanics.effect_forces import numbers_of
from anet_lumped.mechanics.optional import as_set_lengths
from anet_lumped.mechanics.segment_law import SHORTEST, spring_of
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_L0_RATE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    CREEP_STATIC,
    CREPT_CHANGE,
    CREPT_STRETCH,
    KERNEL_SET_LENGTHS,
    LINEARISED_LAW,
    LINEARISED_MEAN_STEP,
    LINEARISED_TAU,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
    SLOT_ENERGY,
)
from integrators.stage import LAW_AT_END, LAW_BACKWARD, LAW_BETWEEN
from integrators.system import NO_EVENTS

_f1, _f2 = float64[::1], float64[:, ::1]


@internal
def _creeping_tension(net, c, s, stretch, rate, acting):
    """`observe` of a segment s of cable c that creeps, of the ``stretch`` l - L0 [m] and the ``rate`` of length [m/s]."""
    creep, crept, row, h = creep_of(net, c), net.crept[s, CREPT_STRETCH], net.segment[s], net.linearised[LINEARISED_TAU]
    if net.linearised[LINEARISED_LAW] != LAW_BETWEEN or stretch <= crept:
        return tension_at_once(stretch - crept, crept, rate, creep)
    mean_rate = (row[SEGMENT_STRETCH] - row[SEGMENT_STRETCH_BEFORE] + net.crept[s, CREPT_CHANGE]) / h
    k, omega_squared = net.axial[c, AXIAL_STIFFNESS], net.axial[c, AXIAL_OMEGA_SQUARED]
    resolved = 1.0 / (1.0 + (0.25 * h + 0.5 * creep.fast_damper / k) * h * omega_squared)
    at_once = tension_at_once(stretch - crept, crept, mean_rate + resolved * (rate - mean_rate), creep)
    return max(acting - row[SEGMENT_TENSION] + at_once, 0.0)


@kernel(void(_f2, _f2, int64, _f1))
def observe(q, v, net_address, tension):
    """Write the tension of every segment in a state (n_segments,) [N].

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

    Of cables that creep the law is that of `creep.tension_at_once`, and their slow stretches [m] follow the tensions of all
    segments, where ``tension`` has room for them.
    """
    net = view_net(net_address)
    for i in range(min(net.crept.shape[0], tension.shape[0] - net.tension.shape[0])):
        tension[net.tension.shape[0] + i] = net.crept[i, CREPT_STRETCH]
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        L0, k, damper, two_way_damper, spring = (
            net.axial[c, AXIAL_L0],
            net.axial[c, AXIAL_STIFFNESS],
            net.axial[c, AXIAL_DAMPER],
            net.axial[c, AXIAL_TWO_WAY_DAMPER],
            spring_of(net, c),
        )
        before = net.cable[c, CABLE_START]
        for j in range(count):
            i, s = node + j if j < count - 1 else net.cable[c, CABLE_END], first + j
            acting = net.tension[s] if two_way_damper > 0.0 else max(net.tension[s], 0.0)
            if net.linearised[LINEARISED_LAW] == LAW_BACKWARD or net.axial[c, AXIAL_INEXTENSIBLE] > 0.0:
                tension[s] = acting
            else:
                dx, dy, dz = q[i, 0] - q[before, 0], q[i, 1] - q[before, 1], q[i, 2] - q[before, 2]
                l = math.sqrt(dx * dx + dy * dy + dz * dz)
                rate = dx * (v[i, 0] - v[before, 0]) + dy * (v[i, 1] - v[before, 1]) + dz * (v[i, 2] - v[before, 2])
                rate = rate / max(l, SHORTEST * L0) - net.axial[c, AXIAL_L0_RATE]
                T, elastic = tension_parts(l - L0, rate, spring, damper, two_way_damper)
                if net.creep.shape[0] > 0 and net.creep[c, CREEP_STATIC] > 0.0:
                    T = _creeping_tension(net, c, s, l - L0, rate, acting)
                elif net.linearised[LINEARISED_LAW] == LAW_BETWEEN and (elastic != 0.0 or two_way_damper > 0.0):
                    h, row = net.linearised[LINEARISED_TAU], net.segment[s]
                    mean_rate = row[SEGMENT_STRETCH] - row[SEGMENT_STRETCH_BEFORE]
                    if two_way_damper == 0.0:
                        mean_rate = max(row[SEGMENT_STRETCH], 0.0) - max(row[SEGMENT_STRETCH_BEFORE], 0.0)
                    mean_rate /= h
                    resolved = 1.0 / (1.0 + (0.25 * h + 0.5 * damper / k) * h * net.axial[c, AXIAL_OMEGA_SQUARED])
                    T = acting + (elastic - row[SEGMENT_TENSION] + damper * mean_rate) + damper * resolved * (rate - mean_rate)
                    T = T if two_way_damper > 0.0 else max(T, 0.0)
                elif net.linearised[LINEARISED_LAW] == LAW_AT_END and net.linearised[LINEARISED_MEAN_STEP] > 0.0:
                    h = net.linearised[LINEARISED_MEAN_STEP]
                    stiff = (0.25 * h + 0.5 * damper / k) * h * net.axial[c, AXIAL_OMEGA_SQUARED]
                    T = net.mean_tension[s] + (T - net.mean_tension[s]) / (1.0 + stiff * stiff)
                tension[s] = T
            before = i


@kernel(void(float64, _f2, _f2, int64, _f1))
def energies(t, q, v, net_address, energy):
    """Kinetic energy of the moving nodes, spring energy, and potential energy of the effects: (3,) [J], overwritten."""
    net = view_net(net_address)
    if net.lengths.cable.shape[0] > 0:
        as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t, t, t)
    kinetic, elastic, potential = 0.0, 0.0, 0.0
    for i in range(net.n_free):
        kinetic += 0.5 * net.mass[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
    for c in range(net.cable.shape[0]):
        count, node = net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        L0, spring = net.axial[c, AXIAL_L0], spring_of(net, c)
        before = net.cable[c, CABLE_START]
        for j in range(count):
            i = node + j if j < count - 1 else net.cable[c, CABLE_END]
            dx, dy, dz = q[i, 0] - q[before, 0], q[i, 1] - q[before, 1], q[i, 2] - q[before, 2]
            stretch = math.sqrt(dx * dx + dy * dy + dz * dz) - L0
            if net.creep.shape[0] > 0 and net.creep[c, CREEP_STATIC] > 0.0:
                crept = net.crept[net.cable[c, CABLE_FIRST_SEGMENT] + j, CREPT_STRETCH]
                elastic += stored_energy(stretch - crept, crept, creep_of(net, c))
            else:
                elastic += elastic_energy(stretch, spring)
            before = i
    effects = net.effects
    for e in range(effects.address.shape[0]):
        index, params = numbers_of(effects, e)
        potential += as_energy(effects.address[e, SLOT_ENERGY])(t, q, index, params)
    energy[0], energy[1], energy[2] = kinetic, elastic, potential


@kernel(float64(_f2, _f2, int64))
def no_margin(q, v, net_address):
    """`System.margin` of a net whose cables do not break: `NO_EVENTS`."""
    return NO_EVENTS
