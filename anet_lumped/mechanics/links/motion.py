"""What an integrator asks of cables that do not stretch: force and tensions at one time, and how far they are beyond an event.

The equation is that of the package. Tensions that are not asked for are kept as tau, tension over length.
"""

import math

from numba import float64, int64, types, void

from anet_lumped.compiled.jit import internal, kernel
from anet_lumped.effects.signatures import as_force
from anet_lumped.mechanics.drive import evaluate_driven
from anet_lumped.mechanics.effect_forces import add_masses, mobility_with_fluid, numbers_of
from anet_lumped.mechanics.notice import take_in
from anet_lumped.mechanics.observe import write_energies
from anet_lumped.mechanics.optional import as_force_bodies, as_mobility_bodies, as_power_of_lengths, as_set_lengths
from anet_lumped.mechanics.prescribe import prescribe
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_L0,
    AXIAL_L0_ACCELERATION,
    AXIAL_L0_RATE,
    AXIAL_PUSH_SHARE,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    KERNEL_FORCE_BODIES,
    KERNEL_MOBILITY_BODIES,
    KERNEL_POWER_OF_LENGTHS,
    KERNEL_SET_LENGTHS,
    LINKS_CURRENT,
    LINKS_FORCE,
    LINKS_REDUNDANT,
    LINKS_TIME,
    SLOT_FORCE,
)
from integrators.flat_view import flat
from integrators.system import NO_EVENTS, NOTICE, OBSERVE

from .elimination import factor, mobile, solve

_f1, _f2 = float64[::1], float64[:, ::1]
SHIFT = 1e-9  # of the diagonal, where constraints are redundant
PASSES = 2  # with the shift: each takes a share of it off what the one before has left
PUSHED_ALLOWED = 1e-9  # of the largest force: a link that is pushed by less carries nothing


@internal
def factored(net, q):
    """Factor the system of the links at q; returns how many times it is to be solved."""
    redundant = factor(net, q, 0.0)
    if redundant == 0:
        return 1
    factor(net, q, SHIFT)
    net.links.state[LINKS_REDUNDANT] = max(net.links.state[LINKS_REDUNDANT], redundant)
    return PASSES


@internal
def set_masses(net, t, q):
    """Write the mobility of each moving node, where masses, the fluid that nodes carry or the rotation of a body change."""
    links = net.links
    if net.lengths.cable.shape[0] > 0:
        for i in range(net.n_free):
            links.mobility[i] = 1.0 / net.mass[i] if net.mass[i] > 0.0 else 0.0
    if net.added_mass.shape[0] > 0:
        add_masses(net, t, q)
        for i in range(net.bodies.first):
            W, found = flat(links.matrix_mobility[i]), mobility_with_fluid(net.mass[i], net.added_mass[i])
            for k in range(9):
                W[k] = found[k]
    if net.bodies.first < net.n_free:
        as_mobility_bodies(net.kernels[KERNEL_MOBILITY_BODIES])(net.address, q)


@internal
def write_wanted(net, v, order):
    """Write to ``links.right_side`` what d . (x_b - x_a) is to be: of accelerations (``order`` 2) or of velocities (1).

    Lengths are kept as they are by their present value where a length changes.
    """
    right_side = net.links.right_side
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        L, rate, change = net.axial[c, AXIAL_L0], net.axial[c, AXIAL_L0_RATE], net.axial[c, AXIAL_L0_ACCELERATION]
        of_length = rate * rate + L * change if order == 2 else L * rate
        a = net.cable[c, CABLE_START]
        for j in range(count):
            b = node + j if j < count - 1 else net.cable[c, CABLE_END]
            wanted = of_length
            if order == 2:
                x, y, z = v[b, 0] - v[a, 0], v[b, 1] - v[a, 1], v[b, 2] - v[a, 2]
                wanted -= x * x + y * y + z * z
            right_side[first + j] = wanted
            a = b


@internal
def _write_tensions(net):
    """Write ``net.tension`` (n_segments,) [N]: tau times the length of each link."""
    links = net.links
    for s in range(net.tension.shape[0]):
        d = links.vector[s]
        net.tension[s] = links.tau[s] * math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])


@internal
def _accelerate(net, t, q, v, f):
    """Write the accelerations of all nodes to ``links.acceleration``, tau of all links to ``links.tau``, external forces to f.

    Of a node of a body the external force is the mass of the node times the acceleration that all external forces give it.

    Returns
    -------
    power : float64 [W]
        Taken by effects.
    """
    links, effects, power, largest = net.links, net.effects, 0.0, 0.0
    a = links.acceleration
    for i in range(f.shape[0]):
        for x in range(3):
            f[i, x], a[i, x] = 0.0, 0.0
    for e in range(effects.address.shape[0]):
        index, params = numbers_of(effects, e)
        power += as_force(effects.address[e, SLOT_FORCE])(t, q, v, index, params, f)
    set_masses(net, t, q)
    if net.bodies.first < net.n_free:
        as_force_bodies(net.kernels[KERNEL_FORCE_BODIES])(net.address, t, q, v, f)
    for i in range(net.n_free):
        if i < net.bodies.first:
            a[i, 0], a[i, 1], a[i, 2] = mobile(net, i, f[i, 0], f[i, 1], f[i, 2])
        else:
            a[i, 0], a[i, 1], a[i, 2] = f[i, 0] / net.mass[i], f[i, 1] / net.mass[i], f[i, 2] / net.mass[i]
        largest = max(largest, max(abs(f[i, 0]), max(abs(f[i, 1]), abs(f[i, 2]))))
    links.state[LINKS_FORCE] = largest
    if net.n_driven < q.shape[0]:
        evaluate_driven(t, net, links.driven[0], links.driven[1], a[net.n_driven :])
    for k in range(factored(net, q)):
        write_wanted(net, v, 2)
        solve(net, a)
        for s in range(links.tau.shape[0]):
            links.tau[s] = links.right_side[s] + (links.tau[s] if k > 0 else 0.0)
    return power


@internal
def _product(row, x):
    """Scalar product of two rows of three numbers."""
    return row[0] * x[0] + row[1] * x[1] + row[2] * x[2]


@internal
def _pull(net, s, sign, f):
    """Add to f (3,) [N] the pull of link s on the node at its start (``sign`` 1) or at its end (-1)."""
    d = net.links.vector[s]
    for x in range(3):
        f[x] += sign * net.links.tau[s] * d[x]


@kernel(types.void(float64, _f2, _f2, int64, _f2, _f1))
def force(t, q, v, net_address, f, power):
    """Force on every node: f/m0 is the acceleration of a moving node, with its mass m0 in the model.

    Parameters
    ----------
    t : float64 [s]
    q, v : (n, 3) float64 [m], [m/s]
    net_address : int64
    f : (n, 3) float64 [N], overwritten
    power : (3,) float64 [W], overwritten
        Power taken by dampers, of which links have none; power taken by effects; power put in by prescribed nodes and by changes of
        the rest lengths.
    """
    net = view_net(net_address)
    links = net.links
    if net.lengths.cable.shape[0] > 0:
        as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t, t, t)
    by_effects, put_in, a = _accelerate(net, t, q, v, f), 0.0, links.acceleration
    for c in range(net.cable.shape[0]):
        first, last = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_FIRST_SEGMENT] + net.cable[c, CABLE_SEGMENTS] - 1
        if net.cable[c, CABLE_START] >= net.n_driven:
            _pull(net, first, 1.0, f[net.cable[c, CABLE_START]])
        if net.cable[c, CABLE_END] >= net.n_driven:
            _pull(net, last, -1.0, f[net.cable[c, CABLE_END]])
    for i in range(net.n_free):
        for x in range(3):
            f[i, x] = net.mass[i] * a[i, x]
            if net.added_mass.shape[0] > 0:  # what accelerates the fluid
                by_effects += v[i, x] * _product(net.added_mass[i, x], a[i])
    if net.lengths.cable.shape[0] > 0:
        _write_tensions(net)
        put_in = as_power_of_lengths(net.kernels[KERNEL_POWER_OF_LENGTHS])(net_address, t, q, v, f)
    for i in range(net.n_driven, q.shape[0]):
        put_in -= f[i, 0] * v[i, 0] + f[i, 1] * v[i, 1] + f[i, 2] * v[i, 2]
    power[0], power[1], power[2] = 0.0, by_effects, put_in
    links.state[LINKS_TIME], links.state[LINKS_CURRENT] = t, 1.0


@kernel(types.void(float64, int64, _f2, _f2))
def prescribe_ends(t, net_address, q, v):
    """As `prescribe.prescribe`; keeps the velocities that driven nodes had before, which an impulse at t has to know."""
    net = view_net(net_address)
    before, first = net.links.driven[2], net.n_driven
    for i in range(first, q.shape[0]):
        for x in range(3):
            before[i - first, x] = v[i, x]
    prescribe(t, net_address, q, v)
    net.links.state[LINKS_TIME], net.links.state[LINKS_CURRENT] = t, 0.0


@kernel(OBSERVE)
def observe(t, q, v, net_address, tension, energy):
    """Write the tension of every link in a state at the time that was prescribed last (n_segments,) [N], and its energies at t."""
    net = view_net(net_address)
    if net.links.state[LINKS_CURRENT] == 0.0:
        _accelerate(net, net.links.state[LINKS_TIME], q, v, net.law_force)
    _write_tensions(net)
    for s in range(tension.shape[0]):
        tension[s] = net.tension[s]
    if energy.shape[0] > 0:
        if net.lengths.cable.shape[0] > 0:
            as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t, t, t)
        write_energies(t, q, v, net_address, 0.0, energy)


@kernel(NOTICE)
def notice(t, q, v, net_address, row, noticed):
    """Look at the tensions of a state whose force was asked for last, see `System.notice`."""
    observe(t, q, v, net_address, row, noticed[:0])
    take_in(view_net(net_address), row, noticed)


@kernel(float64(_f2, _f2, int64))
def margin(q, v, net_address):
    """How far the tensions of the state whose force was asked for last are beyond an event.

    The larger one of T/(breaking tension) - 1, and of -T over the largest force for links that do not push.
    """
    net = view_net(net_address)
    largest, worst = net.links.state[LINKS_FORCE], NO_EVENTS
    _write_tensions(net)
    for s in range(net.tension.shape[0]):
        largest = max(largest, abs(net.tension[s]))
    for s in range(net.breaking_tension.shape[0]):
        worst = max(worst, net.tension[s] / net.breaking_tension[s] - 1.0)
    for c in range(net.cable.shape[0]):
        if net.axial[c, AXIAL_PUSH_SHARE] == 0.0:
            for j in range(net.cable[c, CABLE_SEGMENTS]):
                pushed = -net.tension[net.cable[c, CABLE_FIRST_SEGMENT] + j]
                worst = max(worst, pushed / largest - PUSHED_ALLOWED if largest > 0.0 else -PUSHED_ALLOWED)
    return worst


@kernel(void(int64, int64))
def remember(net_address, back):
    """Links leave nothing to the next step."""
