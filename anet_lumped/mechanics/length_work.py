"""What cables give and take whose rest lengths change in time: power at one time, work over a step."""

import math

from numba import float64, int64, njit

from anet_lumped.effects.laws.axial import elastic_energy, energy_of_length, tension_parts
from anet_lumped.mechanics.segment_law import (
    spring_of,
)
from anet_lumped.mechanics.set_lengths import energy_between
from anet_lumped.model.net import net_at
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_L0_RATE,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    MATERIAL_LENGTH,
    PAID_BEFORE,
    PAID_MIDDLE,
    PAID_NOW,
    PAID_RATE,
    SEGMENT_STRETCH_BEFORE,
)
from integrators.stage import STAGE

_f2 = float64[:, ::1]


@njit(cache=True, error_model="numpy")
def _as_of_first_masses(net, f):
    """Scale forces on moving nodes so that over the masses of the model they give the acceleration of those of now."""
    for i in range(net.n_free):
        share = net.lengths.mass[i] / net.mass[i]
        for x in range(3):
            f[i, x] *= share


@njit(float64(int64, float64, _f2, _f2), cache=True, error_model="numpy")
def power_of_lengths(place, t, q, v):
    """Power that the change of rest lengths puts in [W]: -T dL0/dt + dk/dt (l - L0)^2/2, and the energy of mass that comes.

    From psi = k/2 (l - L0)^2 with k = EA/(length per segment): dpsi/dt = T_spring (dl/dt - dL0/dt) + dk/dt (l - L0)^2/2.
    """
    net = net_at(place)
    lengths, power = net.lengths, 0.0
    for r in range(lengths.cable.shape[0]):
        c = lengths.cable[r]
        count, node, law = net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE], net.axial[c]
        spring = spring_of(net, c)
        stiffer = -spring[0] * lengths.paid[PAID_RATE, r] / (lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_NOW, r])
        a = net.cable[c, CABLE_START]
        for j in range(count):
            b = node + j if j < count - 1 else net.cable[c, CABLE_END]
            q0, q1, v0, v1 = q[a], q[b], v[a], v[b]
            dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
            l = math.sqrt(dx * dx + dy * dy + dz * dz)
            rate = (dx * (v1[0] - v0[0]) + dy * (v1[1] - v0[1]) + dz * (v1[2] - v0[2])) / max(l, 1e-12 * law[AXIAL_L0]) - law[
                AXIAL_L0_RATE
            ]
            T, _ = tension_parts(l - law[AXIAL_L0], rate, spring, law[AXIAL_DAMPER], law[AXIAL_TWO_WAY_DAMPER])
            power += (
                elastic_energy(l - law[AXIAL_L0], (stiffer, *spring[1:]))
                + (energy_of_length(l - law[AXIAL_L0], spring) - T) * law[AXIAL_L0_RATE]
            )
            a = b
    if lengths.mass_node.shape[0] > 0:
        for r in range(lengths.cable.shape[0]):
            lengths.trial[0, r] = lengths.paid[PAID_MIDDLE, r] - lengths.paid[PAID_RATE, r]
            lengths.trial[1, r] = lengths.paid[PAID_MIDDLE, r] + lengths.paid[PAID_RATE, r]
        power += 0.5 * energy_between(place, t, q, v, lengths.trial[0], lengths.trial[1])  # linear in the masses
    return power


@njit(float64(STAGE, _f2, _f2, int64), cache=True, error_model="numpy")
def work_of_lengths(stage, base, q, place):
    """What the change of rest lengths puts in over a step of law ``LAW_BETWEEN`` by the tensions that act in it [J].

    -T (L_b - L_a), and for the spring k of the middle, with which the secant was taken, what that of the ends stores besides.
    """
    net = net_at(place)
    lengths, work = net.lengths, 0.0
    for r in range(lengths.cable.shape[0]):
        c = lengths.cable[r]
        first, count, node, law = (
            net.cable[c, CABLE_FIRST_SEGMENT],
            net.cable[c, CABLE_SEGMENTS],
            net.cable[c, CABLE_FIRST_NODE],
            net.axial[c],
        )
        middle = lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_MIDDLE, r]
        spring = spring_of(net, c)
        k_a = spring[0] * middle / (lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_BEFORE, r])
        k_b = spring[0] * middle / (lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_NOW, r])
        at_start, at_end = (k_a, spring[1], law[AXIAL_L0_BEFORE], *spring[3:]), (k_b, *spring[1:])
        a = net.cable[c, CABLE_START]
        for j in range(count):
            b, before = node + j if j < count - 1 else net.cable[c, CABLE_END], net.segment[first + j, SEGMENT_STRETCH_BEFORE]
            dx, dy, dz = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1], q[b, 2] - q[a, 2]
            stretch = math.sqrt(dx * dx + dy * dy + dz * dz) - law[AXIAL_L0]
            work += elastic_energy(before, spring) - elastic_energy(before, at_start)
            work += elastic_energy(stretch, at_end) - elastic_energy(stretch, spring)
            work -= net.tension[first + j] * (law[AXIAL_L0] - law[AXIAL_L0_BEFORE])
            a = b
    return work
