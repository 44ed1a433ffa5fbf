"""Rest lengths that change in time. A segment of a cable of N segments has

    L(t) = (length + p(t))/N (1 + e(t)) ,     k(t) = EA N/(length + p(t)) ,

with the length p paid out and the strain e at rest. Masses are linear in p, and so are the numbers of effects, such as weights and
coefficients of drag; `model.rest_lengths` finds their slopes. A net holds these quantities for one time or for a step: for a step
L0 at both ends, and everything else in the middle. A change of rest lengths does work on the net: `power_of_lengths` at one time,
`work_of_lengths` and `energy_of_paid_out` over a step.
"""

import math

from anet_lumped.compiled.jit import inlined, internal, kernel
from anet_lumped.effects.laws.axial import Spring, elastic_energy, energy_of_length, tension_parts
from anet_lumped.effects.signatures import as_energy
from anet_lumped.mechanics.effect_forces import numbers_of
from anet_lumped.mechanics.optional import SIGNATURES
from anet_lumped.mechanics.segment_law import SHORTEST, spring_of
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_L0_ACCELERATION,
    AXIAL_L0_BEFORE,
    AXIAL_L0_RATE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    MATERIAL_BA_GIVEN,
    MATERIAL_DAMPER,
    MATERIAL_EA,
    MATERIAL_LENGTH,
    PAID_BEFORE,
    PAID_MIDDLE,
    PAID_NOW,
    PAID_RATE,
    SEGMENT_STRETCH_BEFORE,
    SLOT_ENERGY,
)
from anet_lumped.prescribed.path_kernel import evaluate


@internal
def _set_masses(net, paid):
    """Write the masses and the effects' numbers for the lengths ``paid`` (rows,) [m] that are paid out."""
    lengths, mass, params = net.lengths, net.mass, net.effects.params
    for i in range(lengths.mass.shape[0]):
        mass[i] = lengths.mass[i]
    for i in range(lengths.params.shape[0]):
        params[i] = lengths.params[i]
    for r in range(paid.shape[0]):
        for i in range(lengths.mass_at[r], lengths.mass_at[r + 1]):
            mass[lengths.mass_node[i]] += lengths.mass_slope[i] * paid[r]
        for i in range(lengths.param_at[r], lengths.param_at[r + 1]):
            params[lengths.param[i]] += lengths.param_slope[i] * paid[r]


@internal
def _omega_squared(net, c):
    """Square of the highest frequency of a segment of cable c, k max(1/m_a + 1/m_b), as ``Net.axial`` holds it [1/s2]."""
    count, node, largest, node_before = net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE], 0.0, net.cable[c, CABLE_START]
    for j in range(count):
        i = node + j if j < count - 1 else net.cable[c, CABLE_END]
        mobility = (1.0 / net.mass[node_before] if node_before < net.n_free else 0.0) + (
            1.0 / net.mass[i] if i < net.n_free else 0.0
        )
        largest, node_before = max(largest, mobility), i
    return net.axial[c, AXIAL_STIFFNESS] * largest


@kernel(SIGNATURES["set_lengths"])
def set_lengths(net_address, t_start, t_middle, t_end):
    """Write the rest lengths at both ends of a step, and everything else that follows from them in its middle.

    Writes ``Net.axial``, the masses, and the effects' numbers.

    Parameters
    ----------
    net_address : int64
    t_start, t_middle, t_end : float64 [s]
        Times of the step; all equal to set everything for one time.
    """
    net = view_net(net_address)
    lengths, axial = net.lengths, net.axial
    times, paid, x, rate, change = (
        lengths.times,
        lengths.paid,
        lengths.path_values[0],
        lengths.path_values[1],
        lengths.path_values[2],
    )
    if times[0] == t_start and times[1] == t_middle and times[2] == t_end:
        return
    times[0], times[1], times[2] = t_start, t_middle, t_end
    for k in range(3):
        evaluate(times[k], lengths.paths, x, rate, change)
        for r in range(lengths.cable.shape[0]):
            c, length, p, e = lengths.cable[r], lengths.material[r, MATERIAL_LENGTH], x[2 * r, 0], x[2 * r + 1, 0]
            count, paid[k, r] = net.cable[c, CABLE_SEGMENTS], p
            L = (length + p) / count
            if k == PAID_BEFORE:
                axial[c, AXIAL_L0_BEFORE] = L * (1.0 + e)
            elif k == PAID_MIDDLE:
                damper_ratio = length / (length + p) if lengths.material[r, MATERIAL_BA_GIVEN] > 0.0 else 1.0
                axial[c, AXIAL_STIFFNESS] = lengths.material[r, MATERIAL_EA] / L
                axial[c, AXIAL_DAMPER] = lengths.material[r, MATERIAL_DAMPER] * damper_ratio
            else:
                paid[PAID_RATE, r] = rate[2 * r, 0]
                axial[c, AXIAL_L0] = L * (1.0 + e)
                axial[c, AXIAL_L0_RATE] = rate[2 * r, 0] / count * (1.0 + e) + L * rate[2 * r + 1, 0]
                axial[c, AXIAL_L0_ACCELERATION] = (
                    change[2 * r, 0] * (1.0 + e) + 2.0 * rate[2 * r, 0] * rate[2 * r + 1, 0]
                ) / count + L * change[2 * r + 1, 0]
    _set_masses(net, paid[PAID_MIDDLE])
    for c in range(net.cable.shape[0]):  # of all cables: the mass of an end point changes with each cable that it holds
        axial[c, AXIAL_OMEGA_SQUARED] = _omega_squared(net, c)


@internal
def _energy_gain(net, t, q, v, paid_before, paid_after):
    """Kinetic and potential energy of a state with the masses at ``paid_after``, less the same energy at ``paid_before`` [J].

    Parameters
    ----------
    t : float64 [s]
    q, v : (n, 3) float64 [m], [m/s]
    paid_before, paid_after : (rows,) float64 [m]
        Lengths paid out.
    """
    effects, gain = net.effects, 0.0
    for after in range(2):
        _set_masses(net, paid_after if after == 1 else paid_before)
        energy = 0.0
        for i in range(net.n_free):
            energy += 0.5 * net.mass[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
        for e in range(effects.address.shape[0]):
            index, params = numbers_of(effects, e)
            energy += as_energy(effects.address[e, SLOT_ENERGY])(t, q, index, params)
        gain += energy if after == 1 else -energy
    _set_masses(net, net.lengths.paid[PAID_MIDDLE])
    return gain


@inlined
def _with_stiffness(spring, k):
    """The same `Spring` with another stiffness, or with its rate in place of the stiffness."""
    return Spring(k, spring.push_share, spring.L0, spring.curve, spring.first_piece, spring.end_piece)


@kernel(SIGNATURES["power_of_lengths"])
def power_of_lengths(net_address, t, q, v, f):
    """Power that the change of rest lengths puts in [W]; multiplies f by m0/m(t).

    The power is the sum over the segments of -T dL0/dt + dk/dt (l - L0)^2/2, plus the kinetic and potential energy of the mass that
    is paid out in a second. The sum follows from psi = k/2 (l - L0)^2, whose rate is

        dpsi/dt = T_spring (dl/dt - dL0/dt) + dk/dt (l - L0)^2/2 .

    The force f (n, 3) [N] on each moving node is multiplied by m0/m(t), with the mass m0 in the model, so that f/m0 is the node's
    acceleration.
    """
    net = view_net(net_address)
    lengths, power = net.lengths, 0.0
    for r in range(lengths.cable.shape[0]):
        c = lengths.cable[r]
        count, node, row = net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE], net.axial[c]
        spring, L0, L0_rate = spring_of(net, c), row[AXIAL_L0], row[AXIAL_L0_RATE]
        stiffness_rate = (
            -spring.stiffness * lengths.paid[PAID_RATE, r] / (lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_NOW, r])
        )
        a = net.cable[c, CABLE_START]
        for j in range(count):
            b = node + j if j < count - 1 else net.cable[c, CABLE_END]
            q0, q1, v0, v1 = q[a], q[b], v[a], v[b]
            dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
            l = math.sqrt(dx * dx + dy * dy + dz * dz)
            rate = (dx * (v1[0] - v0[0]) + dy * (v1[1] - v0[1]) + dz * (v1[2] - v0[2])) / max(l, SHORTEST * L0) - L0_rate
            T, _ = tension_parts(l - L0, rate, spring, row[AXIAL_DAMPER], row[AXIAL_TWO_WAY_DAMPER])
            if row[AXIAL_INEXTENSIBLE] > 0.0:
                T = net.tension[net.cable[c, CABLE_FIRST_SEGMENT] + j]
            power += (
                elastic_energy(l - L0, _with_stiffness(spring, stiffness_rate)) + (energy_of_length(l - L0, spring) - T) * L0_rate
            )
            a = b
    if lengths.mass_node.shape[0] > 0:
        for r in range(lengths.cable.shape[0]):
            lengths.trial[0, r] = lengths.paid[PAID_MIDDLE, r] - lengths.paid[PAID_RATE, r]
            lengths.trial[1, r] = lengths.paid[PAID_MIDDLE, r] + lengths.paid[PAID_RATE, r]
        power += 0.5 * _energy_gain(net, t, q, v, lengths.trial[0], lengths.trial[1])  # linear in the masses
    for i in range(net.n_free):
        mass_ratio = lengths.mass[i] / net.mass[i]
        for x in range(3):
            f[i, x] *= mass_ratio
    return power


@kernel(SIGNATURES["work_of_lengths"])
def work_of_lengths(stage, net_address, base, q, v):
    """Work that the change of rest lengths puts in over a step of `LAW_BETWEEN`, by the tensions that act in it [J].

    The work has three parts. The first is -T (L_b - L_a). The second accounts for the stiffness: the secant of the spring k in the
    middle of the step acts, while k_a and k_b store the energy at its start and end,

        psi(x_a; k) - psi(x_a; k_a) + psi(x_b; k_b) - psi(x_b; k) .

    The third is the energy of the mass that is paid out in the first half of the step. ``v`` (n, 3) [m/s] is the velocity at the
    end of the step.
    """
    net, h = view_net(net_address), stage.tau
    lengths, work = net.lengths, 0.0
    for r in range(lengths.cable.shape[0]):
        c = lengths.cable[r]
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        L0, L0_before = net.axial[c, AXIAL_L0], net.axial[c, AXIAL_L0_BEFORE]
        length_in_middle = lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_MIDDLE, r]
        spring = spring_of(net, c)
        k_a = spring.stiffness * length_in_middle / (lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_BEFORE, r])
        k_b = spring.stiffness * length_in_middle / (lengths.material[r, MATERIAL_LENGTH] + lengths.paid[PAID_NOW, r])
        spring_at_start = Spring(k_a, spring.push_share, L0_before, spring.curve, spring.first_piece, spring.end_piece)
        spring_at_end = _with_stiffness(spring, k_b)
        a = net.cable[c, CABLE_START]
        for j in range(count):
            b = node + j if j < count - 1 else net.cable[c, CABLE_END]
            stretch_before = net.segment[first + j, SEGMENT_STRETCH_BEFORE]
            dx, dy, dz = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1], q[b, 2] - q[a, 2]
            stretch = math.sqrt(dx * dx + dy * dy + dz * dz) - L0
            work += elastic_energy(stretch_before, spring) - elastic_energy(stretch_before, spring_at_start)
            work += elastic_energy(stretch, spring_at_end) - elastic_energy(stretch, spring)
            work -= net.tension[first + j] * (L0 - L0_before)
            a = b
    if lengths.mass_node.shape[0] > 0:
        v_start = net.middle_q  # scratch
        for i in range(net.n_free):
            for x in range(3):
                v_start[i, x] = 2.0 * (q[i, x] - base[i, x]) / h - v[i, x]
        work += _energy_gain(net, stage.t - 0.5 * h, base, v_start, lengths.paid[PAID_BEFORE], lengths.paid[PAID_MIDDLE])
    return work


@kernel(SIGNATURES["energy_of_paid_out"])
def energy_of_paid_out(stage, net_address, q, v):
    """Energy of the mass paid out in the second half of a step [J]; then sets all that changes to its value at the end."""
    net, h = view_net(net_address), stage.tau
    lengths, energy = net.lengths, 0.0
    if lengths.mass_node.shape[0] > 0:
        energy = _energy_gain(net, stage.t + 0.5 * h, q, v, lengths.paid[PAID_MIDDLE], lengths.paid[PAID_NOW])
    set_lengths(net_address, stage.t + 0.5 * h, stage.t + 0.5 * h, stage.t + 0.5 * h)
    return energy
