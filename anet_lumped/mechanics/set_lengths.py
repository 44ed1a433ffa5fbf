"""Rest lengths that change in time: of a segment of a cable of N segments,

    L(t) = (length + p(t))/N (1 + e(t)) ,     k(t) = EA N/(length + p(t)) ,

with the length p paid out and the strain e at rest, and masses and the effects' numbers (weights, coefficients of drag), which are
linear in p. How they depend on it is found by cutting the scene with longer cables, so that no effect need know of it.

In force at one time, or over a step: then the lengths are those of both its ends, and all else is that of its middle.
"""

from numba import float64, int64, njit, void

from anet_lumped.effects.signatures import as_energy
from anet_lumped.mechanics.effect_forces import numbers_of
from anet_lumped.model.net import net_at
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_L0_BEFORE,
    AXIAL_L0_RATE,
    AXIAL_OMEGA_SQUARED,
    AXIAL_STIFFNESS,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_SEGMENTS,
    CABLE_START,
    MATERIAL_BA_GIVEN,
    MATERIAL_DAMPER,
    MATERIAL_EA,
    MATERIAL_LENGTH,
    PAID_MIDDLE,
    PAID_RATE,
    SLOT_ENERGY,
)
from anet_lumped.prescribed.path_kernel import evaluate

_f1, _f2 = float64[::1], float64[:, ::1]


@njit(cache=True, error_model="numpy")
def _write(net, paid):
    """Masses and the effects' numbers for lengths paid out (rows,) [m]."""
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


@njit(cache=True, error_model="numpy")
def _square(net, c):
    """Square of the highest frequency of a segment of cable c, as `Net.axial` has it [1/s2]."""
    count, node, largest, before = net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE], 0.0, net.cable[c, CABLE_START]
    for j in range(count):
        i = node + j if j < count - 1 else net.cable[c, CABLE_END]
        mobility = (1.0 / net.mass[before] if before < net.n_free else 0.0) + (1.0 / net.mass[i] if i < net.n_free else 0.0)
        largest, before = max(largest, mobility), i
    return net.axial[c, AXIAL_STIFFNESS] * largest


@njit(void(int64, float64, float64, float64), cache=True, error_model="numpy")
def set_lengths(place, before, middle, now):
    """Write `Net.axial`, the masses and the effects' numbers of a net: L0 at two times, all else at the one in the middle.

    Parameters
    ----------
    place : int64, address of the net
    before, middle, now : float64 [s]; thrice the same for one time
    """
    net = net_at(place)
    lengths, axial = net.lengths, net.axial
    at, paid, x, rate = lengths.at, lengths.paid, lengths.place[0], lengths.place[1]
    if at[0] == before and at[1] == middle and at[2] == now:
        return
    at[0], at[1], at[2] = before, middle, now
    for k in range(3):
        evaluate(at[k], lengths.paths, x, rate, lengths.place[2])
        for r in range(lengths.cable.shape[0]):
            c, length, p, e = lengths.cable[r], lengths.material[r, MATERIAL_LENGTH], x[2 * r, 0], x[2 * r + 1, 0]
            count, paid[k, r] = net.cable[c, CABLE_SEGMENTS], p
            L = (length + p) / count
            if k == 0:
                axial[c, AXIAL_L0_BEFORE] = L * (1.0 + e)
            elif k == 1:
                axial[c, AXIAL_STIFFNESS] = lengths.material[r, MATERIAL_EA] / L
                axial[c, AXIAL_DAMPER] = lengths.material[r, MATERIAL_DAMPER] * (
                    length / (length + p) if lengths.material[r, MATERIAL_BA_GIVEN] > 0.0 else 1.0
                )
            else:
                paid[PAID_RATE, r] = rate[2 * r, 0]
                axial[c, AXIAL_L0], axial[c, AXIAL_L0_RATE] = (
                    L * (1.0 + e),
                    rate[2 * r, 0] / count * (1.0 + e) + L * rate[2 * r + 1, 0],
                )
    _write(net, paid[PAID_MIDDLE])
    for c in range(net.cable.shape[0]):  # a cable beside one that changes shares a mass with it
        axial[c, AXIAL_OMEGA_SQUARED] = _square(net, c)


@njit(float64(int64, float64, _f2, _f2, _f1, _f1), cache=True, error_model="numpy")
def energy_between(place, t, q, v, less, more):
    """Kinetic and potential energy [J] of a state with the masses of lengths ``more`` paid out, less that of lengths ``less``.

    Parameters
    ----------
    q, v : (n, 3) float64 [m], [m/s]
    less, more : (rows,) float64 [m]
    """
    net = net_at(place)
    effects, gain = net.effects, 0.0
    for side in range(2):
        _write(net, more if side == 1 else less)
        energy = 0.0
        for i in range(net.n_free):
            energy += 0.5 * net.mass[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
        for e in range(effects.address.shape[0]):
            index, params = numbers_of(effects, e)
            energy += as_energy(effects.address[e, SLOT_ENERGY])(t, q, index, params)
        gain += energy if side == 1 else -energy
    _write(net, net.lengths.paid[PAID_MIDDLE])
    return gain
