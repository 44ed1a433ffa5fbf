"""What an integrator asks of a net: forces, prescribed motion, the residual of a stage, the Newton step, the energies."""

import math

from numba import float64, int64, njit, types, void

from integrators.stage import BACKWARD, BETWEEN, STAGE, STATE
from integrators.system import NEVER

from . import chain, elimination
from .effects.axial import elastic_energy, energy_of_length, tension_parts
from .effects.signatures import as_between, as_energy, as_force, as_inertia, as_tangent
from .elimination import (
    BEFORE,
    COLUMNS,
    CURVE,
    CURVE_END,
    DIRECTION,
    END,
    FIRST_NODE,
    FIRST_SEGMENT,
    GEOMETRIC,
    GRADIENT,
    LAST,
    NUMERICAL,
    SEGMENTS,
    START,
    STIFFNESS,
    STRETCH,
    TENSION,
)
from .lanes import WIDTH, at, below, four, index, lane, largest, members_of, of_table, put, put_four, select, total
from .net import net_at
from .path_kernel import evaluate
from .rest_length import energy_between, set_lengths
from .segment_law import (
    AFRESH,
    BEGINS,
    DAMPER,
    FIRST_LENGTH,
    GROWTH,
    LENGTH,
    RIGID,
    SPRING,
    SQUARE,
    TWO_WAY_DAMPER,
    TWO_WAY_SPRING,
    law_of,
    less,
    linearise,
    numerical_damper,
    penalty,
    spring_of,
    switch,
    weights,
)

_f1, _f2 = float64[::1], float64[:, ::1]
EPS = 2.220446049250313e-16
SPENT = 1e-5  # of the kinetic energy, what the numerical damper may take in a step from a stretch that the step resolves
# Of `Net.linearised`: law of the stage that was linearised last (-1: none) and its tau [s]; whether the next one begins a step,
# BEGINS, and whether it does so without one before it, AFRESH; the least share of the numerical damper in that step; the step of
# `Net.mean` [s], 0 if there is none.
LAW, TAU, BEGINNING, LEAST, AVERAGED = range(5)
FORCE, TANGENT, ENERGY, WHOLE_STEP, INERTIA = range(5)  # columns of `Effects.address`
ROUNDS = 4  # eliminations a Newton step may spend on finding which segments are slack


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


@njit(cache=True, error_model="numpy")
def _add_masses(net, t, q):
    """Added masses of the moving nodes, for ``net.added``."""
    effects, added = net.effects, net.added
    for i in range(added.shape[0]):
        for x in range(3):
            for y in range(3):
                added[i, x, y] = 0.0
    for e in range(effects.address.shape[0]):
        if effects.address[e, INERTIA] != 0:
            i, j = effects.index_at[e], effects.index_at[e + 1]
            a, b = effects.params_at[e], effects.params_at[e + 1]
            as_inertia(effects.address[e, INERTIA])(t, q, effects.index[i:j], effects.params[a:b], added)


@njit(cache=True, error_model="numpy")
def _share_with_fluid(net, t, q, v, f):
    """Make the forces f on moving nodes m (m I + A)^-1 f, so that f/m is the acceleration of the node with its added mass A.

    Returns
    -------
    power : float64 [W], given to the fluid
    """
    _add_masses(net, t, q)
    power = 0.0
    for i in range(net.n_free):
        m, A = net.mass[i], net.added[i]
        inverse = elimination.inverse((m + A[0, 0], A[0, 1], A[0, 2], A[1, 0], m + A[1, 1], A[1, 2], A[2, 0], A[2, 1], m + A[2, 2]))
        left = elimination.times(inverse, m * f[i, 0], m * f[i, 1], m * f[i, 2])
        for x in range(3):
            power += (f[i, x] - left[x]) * v[i, x]
            f[i, x] = left[x]
    return power


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _count(net, c):
    """Segments of a cable, or of each of a group."""
    return lane(of_table(net.cable, c, SEGMENTS), 0)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _place(flat, node):
    """Row of an (n, 3) array."""
    i = index(node, 0, 3, 0)
    return at(flat, i), at(flat, index(i, 0, 1, 1)), at(flat, index(i, 0, 1, 2))


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _put_place(flat, node, place):
    i = index(node, 0, 3, 0)
    put(flat, i, place[0])
    put(flat, index(i, 0, 1, 1), place[1])
    put(flat, index(i, 0, 1, 2), place[2])


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _add_to_points(array, base, nodes, members, force, sign):
    """Add forces of the members of a group to the rows ``nodes - base`` of an array."""
    for k in range(members):
        row = array[lane(nodes, k) - base]
        row[0], row[1] = row[0] + sign * lane(force[0], k), row[1] + sign * lane(force[1], k)
        row[2] += sign * lane(force[2], k)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _force_of(net, c, members, q, v, f):
    """`force` of a cable, or of the cables of a group of which ``members`` count; returns the power that dampers dissipate."""
    node, start, end = of_table(net.cable, c, FIRST_NODE), of_table(net.cable, c, START), of_table(net.cable, c, END)
    L0, spring, damper = of_table(net.law, c, LENGTH), spring_of(net, c), of_table(net.law, c, DAMPER)
    two_damper, count = switch(net, c, TWO_WAY_DAMPER), _count(net, c)
    Q, V, F, lost, growth = q.ravel(), v.ravel(), f.ravel(), 0.0 * L0, of_table(net.law, c, GROWTH)
    i, q0, v0, pull = start, _place(Q, start), _place(V, start), (lost, lost, lost)
    for j in range(count):
        after = index(node, j, 1, 0) if j < count - 1 else end
        q1, v1 = _place(Q, after), _place(V, after)
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
            _add_to_points(f, 0, start, members, here, 1.0)
        else:
            _put_place(F, i, here)
        i, q0, v0, pull = after, q1, v1, ahead
    _add_to_points(f, 0, end, members, pull, -1.0)
    power = 0.0
    for x in range(members):
        power += lane(lost, x)
    return power


@njit(cache=True, error_model="numpy")
def _as_of_first_masses(net, f):
    """Scale forces on moving nodes so that over the masses of the model they give the acceleration of those of now."""
    for i in range(net.n_free):
        share = net.lengths.mass[i] / net.mass[i]
        for x in range(3):
            f[i, x] *= share


@njit(float64(int64, float64, _f2, _f2), cache=True, error_model="numpy")
def _power_of_lengths(place, t, q, v):
    """Power that the change of rest lengths puts in [W]: -T dL0/dt + dk/dt (l - L0)^2/2, and the energy of mass that comes.

    From psi = k/2 (l - L0)^2 with k = EA/(length per segment): dpsi/dt = T_spring (dl/dt - dL0/dt) + dk/dt (l - L0)^2/2.
    """
    net = net_at(place)
    lengths, power = net.lengths, 0.0
    for r in range(lengths.cable.shape[0]):
        c = lengths.cable[r]
        count, node, law = net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE], net.law[c]
        spring = spring_of(net, c)
        stiffer = -spring[0] * lengths.paid[3, r] / (lengths.material[r, 0] + lengths.paid[2, r])
        a = net.cable[c, START]
        for j in range(count):
            b = node + j if j < count - 1 else net.cable[c, END]
            q0, q1, v0, v1 = q[a], q[b], v[a], v[b]
            dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
            l = math.sqrt(dx * dx + dy * dy + dz * dz)
            rate = (dx * (v1[0] - v0[0]) + dy * (v1[1] - v0[1]) + dz * (v1[2] - v0[2])) / max(l, 1e-12 * law[0]) - law[7]
            T, _ = tension_parts(l - law[0], rate, spring, law[2], law[4])
            power += elastic_energy(l - law[0], (stiffer, *spring[1:])) + (energy_of_length(l - law[0], spring) - T) * law[7]
            a = b
    if lengths.mass_node.shape[0] > 0:
        for r in range(lengths.cable.shape[0]):
            lengths.trial[0, r] = lengths.paid[1, r] - lengths.paid[3, r]
            lengths.trial[1, r] = lengths.paid[1, r] + lengths.paid[3, r]
        power += 0.5 * energy_between(place, t, q, v, lengths.trial[0], lengths.trial[1])  # linear in the masses
    return power


@njit(float64(STAGE, _f2, _f2, int64), cache=True, error_model="numpy")
def _work_of_lengths(stage, base, q, place):
    """What the change of rest lengths puts in over a step of law ``BETWEEN`` by the tensions that act in it [J].

    -T (L_b - L_a), and for the spring k of the middle, with which the secant was taken, what that of the ends stores besides.
    """
    net = net_at(place)
    lengths, work = net.lengths, 0.0
    for r in range(lengths.cable.shape[0]):
        c = lengths.cable[r]
        first, count, node, law = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE], net.law[c]
        middle = lengths.material[r, 0] + lengths.paid[1, r]
        spring = spring_of(net, c)
        k_a = spring[0] * middle / (lengths.material[r, 0] + lengths.paid[0, r])
        k_b = spring[0] * middle / (lengths.material[r, 0] + lengths.paid[2, r])
        at_start, at_end = (k_a, spring[1], law[8], *spring[3:]), (k_b, *spring[1:])
        a = net.cable[c, START]
        for j in range(count):
            b, before = node + j if j < count - 1 else net.cable[c, END], net.segment[first + j, BEFORE]
            dx, dy, dz = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1], q[b, 2] - q[a, 2]
            stretch = math.sqrt(dx * dx + dy * dy + dz * dz) - law[0]
            work += elastic_energy(before, spring) - elastic_energy(before, at_start)
            work += elastic_energy(stretch, at_end) - elastic_energy(stretch, spring)
            work -= net.tension[first + j] * (law[0] - law[8])
            a = b
    return work


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
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        dissipated += as_force(effects.address[e, FORCE])(t, q, v, effects.index[i:j], effects.params[a:b], f)
    if net.added.shape[0] > 0:
        dissipated += _share_with_fluid(net, t, q, v, f)
    put_in = 0.0
    if net.lengths.cable.shape[0] > 0:
        put_in = _power_of_lengths(place, t, q, v)
        _as_of_first_masses(net, f)
    for i in range(net.n_driven, q.shape[0]):
        put_in -= f[i, 0] * v[i, 0] + f[i, 1] * v[i, 1] + f[i, 2] * v[i, 2]
    power[0], power[1] = dissipated, put_in


@njit(cache=True, error_model="numpy")
def _live(net):
    """Whether any effect is more than a dead load."""
    for e in range(net.effects.address.shape[0]):
        if net.effects.address[e, TANGENT] != 0 or net.effects.address[e, WHOLE_STEP] != 0:
            return True
    return False


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _middle(net, theta, per_tau, base, q):
    """Place and velocity at which a stage takes external forces."""
    Q, A, middle_q, middle_v = q.ravel(), base.ravel(), net.middle_q.ravel(), net.middle_v.ravel()
    for i in range(Q.shape[0]):
        moved = Q[i] - A[i]
        middle_q[i], middle_v[i] = A[i] + theta * moved, moved * per_tau


@njit(cache=True, error_model="numpy")
def _set_lengths_of(stage, place):
    """Rest lengths at the end and the start of a stage, and what else follows from them where external forces are taken."""
    begins = stage.t - (stage.theta * stage.tau if stage.law != STATE else 0.0)
    set_lengths(place, begins, stage.t, begins + stage.tau if stage.law != STATE else stage.t)
    if stage.law == STATE:
        net = net_at(place)
        for c in net.lengths.cable:
            net.law[c, 8] = net.law[c, 0] - stage.tau * net.law[c, 7]


@njit(cache=True, error_model="numpy")
def _clear(blocks):
    flat = blocks.ravel()
    for i in range(flat.shape[0]):
        flat[i] = 0.0


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _residual_of(stage, net, c, members, base, q, beginning, reach):
    """`residual` of a cable, or of the cables of a group of which ``members`` count.

    Returns norm, scale, noise and predicted of its interior nodes, what rounding leaves of the last, and a number that is not
    finite if a force is not.
    """
    first, node, per_tau = of_table(net.cable, c, FIRST_SEGMENT), of_table(net.cable, c, FIRST_NODE), 1.0 / stage.tau
    start, end = of_table(net.cable, c, START), of_table(net.cable, c, END)
    count, two_damper = _count(net, c), switch(net, c, TWO_WAY_DAMPER)
    L0, k, damper = of_table(net.law, c, LENGTH), of_table(net.law, c, SPRING), of_table(net.law, c, DAMPER)
    numerical, rigid, soft, taut, light, share = weights(stage, net, c)
    law = (
        spring_of(net, c), k, of_table(net.law, c, FIRST_LENGTH), damper, two_damper, switch(net, c, RIGID), numerical, rigid,
        light, beginning, net.linearised[LEAST],
    )  # fmt: skip
    Q, A, R, segment = q.ravel(), base.ravel(), net.right.ravel(), net.segment.ravel()
    zero = 0.0 * L0
    norm, scale, predicted, finite, off, most, enough = zero, zero, zero, zero, zero, zero, 0.9 * soft
    q0, a0, f, h = _place(Q, start), _place(A, start), (zero, zero, zero), (zero, zero, zero)
    for j in range(count):
        i = index(node, j, 1, 0) if j < count - 1 else end
        s = index(first, j, 1, 0)
        row, guess, q1, a1 = index(s, 0, COLUMNS, 0), at(net.tension, s), _place(Q, i), _place(A, i)
        stretch, _, last, damped = four(segment, index(row, 0, 1, STRETCH))
        old = at(segment, index(row, 0, 1, BEFORE)), stretch, last, damped
        T, new = linearise(stage, q0, q1, a0, a1, law, guess, old)
        put_four(segment, row, new[:4])
        put_four(segment, index(row, 0, 1, 4), new[4:8])
        put_four(segment, index(row, 0, 1, 8), new[8:12])
        put(segment, index(row, 0, 1, LAST), new[LAST])
        put(segment, index(row, 0, 1, NUMERICAL), new[NUMERICAL])
        used = select(two_damper == 0.0, max(guess, 0.0), guess)
        off = max(off, abs(new[TENSION] - used) * select(new[STIFFNESS] > enough, share, 1.0))
        t, u = (T * new[0], T * new[1], T * new[2]), (used * new[0], used * new[1], used * new[2])
        if j == 0:
            _add_to_points(net.kept, net.n_interior, start, members, u, 1.0)
            _add_to_points(net.pull, 0, start, members, t, 1.0)
        else:
            x, y, z = _place(R, index(node, j - 1, 1, 0))
            scale = max(scale, max(abs(x), max(abs(y), abs(z))))
            rx, ry, rz = x + t[0] - f[0], y + t[1] - f[1], z + t[2] - f[2]
            norm, finite = max(norm, max(abs(rx), max(abs(ry), abs(rz)))), finite + (rx + ry + rz)
            px, py, pz = x + u[0] - h[0], y + u[1] - h[1], z + u[2] - h[2]
            predicted = max(predicted, max(abs(px), max(abs(py), abs(pz))))
        f, h, q0, a0, most = t, u, q1, a1, max(most, abs(T))
    _add_to_points(net.kept, net.n_interior, end, members, h, -1.0)
    _add_to_points(net.pull, 0, end, members, f, -1.0)
    noise = 4.0 * EPS * (most + (k + damper * per_tau) * max(L0, reach))
    floor = 4.0 * EPS * (most + (share * taut + light) * max(L0, reach))
    return (
        largest(norm), largest(scale), largest(noise), largest(max(predicted, off)), largest(floor), total(finite)
    )  # fmt: skip


@njit(types.UniTuple(float64, 4)(STAGE, _f2, _f2, _f2, int64), cache=True, error_model="numpy", fastmath={"contract"})
def residual(stage, base, target, q, place):
    """Out-of-balance force of a stage, and its linearisation in the net.

    Parameters
    ----------
    stage : Stage
    base, target, q : (n, 3) float64 [m]
        See `integrators.stage`; prescribed rows of q hold the prescribed places, those of base what makes v_m theirs.
    place : int64
        Address of the net; its ``tension`` holds the tensions that the geometric stiffness takes; ``segment``, ``diagonal``
        and ``right`` are written.

    Returns
    -------
    norm, scale, noise, predicted : float64 [N]
        Largest component of the out-of-balance force; the largest inertial or external force on a node, which a tolerance
        is relative to; what rounding of the places alone leaves in it; and the out-of-balance force with the tensions of the
        net instead of those of the law at q, or, if it is more, the length by which the two laws of a segment differ, as
        inertia would feel it, less what rounding leaves. That length is all that a stiff segment leaves open, and the
        tension that goes with it is known far better from the Newton step than from the places.
    """
    net = net_at(place)
    if net.lengths.cable.shape[0] > 0:
        _set_lengths_of(stage, place)
    n, n_free, mass, right, diagonal = q.shape[0], net.n_free, net.mass, net.right, net.diagonal
    middle_q, middle_v, per_tau = net.middle_q, net.middle_v, 1.0 / stage.tau
    reach, scale, heaviest = 0.0, 0.0, 0.0
    for i in range(n):
        W = mass[i] * stage.W if i < n_free else 0.0
        x, y, z = q[i, 0], q[i, 1], q[i, 2]
        fx, fy, fz = W * (target[i, 0] - x), W * (target[i, 1] - y), W * (target[i, 2] - z)
        right[i, 0], right[i, 1], right[i, 2] = fx, fy, fz
        # one of three first, so that a node waits but once for the one before it
        reach, scale = max(reach, max(abs(x), abs(y), abs(z))), max(scale, max(abs(fx), abs(fy), abs(fz)))
        heaviest = max(heaviest, W)
        if i < n_free:
            D = diagonal[i]
            D[0, 0], D[0, 1], D[0, 2] = W, 0.0, 0.0
            D[1, 0], D[1, 1], D[1, 2] = 0.0, W, 0.0
            D[2, 0], D[2, 1], D[2, 2] = 0.0, 0.0, W
    effects = net.effects
    if _live(net):
        _middle(net, stage.theta, per_tau, base, q)
    if net.near.shape[0] > 0:
        _clear(net.near)
        _clear(net.far)
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        index, params, of = effects.index[i:j], effects.params[a:b], effects.address[e]
        if of[WHOLE_STEP] != 0 and stage.law == BETWEEN:
            as_between(of[WHOLE_STEP])(stage.t, stage.tau, base, q, index, params, right, diagonal, net.near, net.far)
            continue
        as_force(of[FORCE])(stage.t, middle_q, middle_v, index, params, right)
        if of[TANGENT] != 0:
            as_tangent(of[TANGENT])(
                stage.t, middle_q, middle_v, index, params, stage.theta, per_tau, diagonal, net.near, net.far
            )
    if net.added.shape[0] > 0:
        _add_masses(net, stage.t, middle_q)
        for i in range(n_free):
            A = net.added[i]
            for x in range(3):
                for y in range(3):
                    right[i, x] += stage.W * A[x, y] * (target[i, y] - q[i, y])
                    diagonal[i, x, y] += stage.W * A[x, y]
    pull = net.pull
    for i in range(net.n_interior, n):
        for x in range(3):
            pull[i, x] = right[i, x]
    norm, noise, finite, predicted, floor = 0.0, 4.0 * EPS * heaviest * reach, 0.0, 0.0, 4.0 * EPS * heaviest * reach
    kept, beginning = net.kept, net.linearised[BEGINNING]
    net.linearised[LAW], net.linearised[TAU], net.linearised[BEGINNING] = stage.law, stage.tau, 0.0
    for i in range(net.n_interior, n):
        for x in range(3):
            kept[i - net.n_interior, x] = right[i, x]
    for g in range(net.group.shape[0]):
        of = _residual_of(stage, net, members_of(net.group, g), net.group[g, WIDTH], base, q, beginning, reach)
        norm, scale, noise = max(norm, of[0]), max(scale, of[1]), max(noise, of[2])
        predicted, floor, finite = max(predicted, of[3]), max(floor, of[4]), finite + of[5]
    for c in net.alone:
        of = _residual_of(stage, net, c, 1, base, q, beginning, reach)
        norm, scale, noise = max(norm, of[0]), max(scale, of[1]), max(noise, of[2])
        predicted, floor, finite = max(predicted, of[3]), max(floor, of[4]), finite + of[5]
    for i in range(net.n_interior, n_free):
        norm = max(norm, abs(pull[i, 0]), abs(pull[i, 1]), abs(pull[i, 2]))
        finite += pull[i, 0] + pull[i, 1] + pull[i, 2]
        p = i - net.n_interior
        predicted = max(predicted, abs(kept[p, 0]), abs(kept[p, 1]), abs(kept[p, 2]))
    if not finite - finite == 0.0:
        norm = 1e300
    if stage.law == STATE or not finite - finite == 0.0:
        predicted = 1e300
    return norm, scale, noise, max(0.0, predicted - floor)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _finish_tensions(stage, net):
    """Give the tensions what `less` has left to the end; returns a bound of the force that the step leaves out of balance [N].

    Of second order in the step d of a segment's ends against each other: its force turns by up to |d|/(l_a + l), of which
    the tangent has the part that the guessed tension makes, and its length by up to |d|^2/(2 l), which counts as in `weights`.
    No bound (1e300) where a segment that cannot push was not linearised as taut, or ends short: a tension can be positive
    there, as the secant from a taut length to a short one is, and yet the law is not straight; nor is a tension-strain curve.
    """
    left = 0.0
    for g in range(net.group.shape[0]):
        left = max(left, _finish_tensions_of(stage, net, members_of(net.group, g)))
    for c in net.alone:
        left = max(left, _finish_tensions_of(stage, net, c))
    return 2.0 * left


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _finish_tensions_of(stage, net, c):
    """`_finish_tensions` of a cable, or of a group."""
    first, node, end = of_table(net.cable, c, FIRST_SEGMENT), of_table(net.cable, c, FIRST_NODE), of_table(net.cable, c, END)
    L0, step, segment, count = of_table(net.law, c, LENGTH), net.step.ravel(), net.segment.ravel(), _count(net, c)
    _, _, soft, taut, _, share = weights(stage, net, c)
    one_way = switch(net, c, TWO_WAY_SPRING) < 1.0 and switch(net, c, RIGID) == 0.0
    curved = lane(of_table(net.cable, c, CURVE), 0) < lane(of_table(net.cable, c, CURVE_END), 0)
    per_sum, strain = (0.5 if stage.law == BETWEEN else 1.0) / L0, share * taut / (2.0 * L0)
    most, longest = 0.0 * L0, 0.0 * L0
    x0, y0, z0 = _place(step, of_table(net.cable, c, START))
    for j in range(count):
        i = index(node, j, 1, 0) if j < count - 1 else end
        s = index(first, j, 1, 0)
        x1, y1, z1 = _place(step, i)
        gx, gy, gz, a = four(segment, index(s, 0, COLUMNS, GRADIENT))
        dx, dy, dz, T = x1 - x0, y1 - y0, z1 - z0, at(net.tension, s)
        x0, y0, z0 = x1, y1, z1
        square = dx * dx + dy * dy + dz * dz
        stiffness, longer = at(segment, index(s, 0, COLUMNS, STIFFNESS)), gx * dx + gy * dy + gz * dz
        if one_way:
            stretch, _, _, numerical = four(segment, index(s, 0, COLUMNS, STRETCH))
            straight = soft + numerical if stage.law == BETWEEN else soft
            as_taut = (stretch > 0.0) | (stiffness + a > (1.0 - 1e-9) * straight)
            most = max(most, select(as_taut & (stretch + longer > 0.0), 0.0, 1e300))
        T = select(stiffness != 0.0, T + a * longer, T)
        put(net.tension, s, T)
        turned = abs(T * per_sum - a) * math.sqrt(square) + T * per_sum * per_sum * square
        most, longest = max(most, turned), max(longest, square)
    return 1e300 if curved else largest(max(2.0 * most, strain * longest))


@njit(types.Tuple((int64, float64))(STAGE, int64), cache=True, error_model="numpy", fastmath={"contract"})
def direction(stage, place):
    """Newton step of the stage that `residual` linearised last, for ``net.step`` and ``net.tension``.

    A segment that the step would make slack or taut leaves the piece of its law that was linearised: its law is replaced by
    the tangent at the predicted length and the step is solved again, until no segment changes. Source: DESIGN, numerics 3.

    Returns
    -------
    solves : int64
        Eliminations made.
    left : float64 [N]
        What a whole step leaves out of balance at most; 1e300 if that is not known without looking.
    """
    net = net_at(place)
    right, kept, step = net.right, net.pull, net.step
    for i in range(net.n_interior, net.n_free):
        for x in range(3):
            kept[i, x] = right[i, x]
    length_direction, taut = GRADIENT if stage.law == BETWEEN else DIRECTION, False
    for solves in range(1, ROUNDS + 1):
        smallest = chain.solve(place)
        taut = smallest > 0.0  # all are taut and stay so: a slack segment has no tension
        if taut or solves == ROUNDS:
            break
        changed = False
        for c in range(net.cable.shape[0]):
            first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
            L0, k, damper, two_spring, two_damper = net.law[c, 0], net.law[c, 1], net.law[c, 2], net.law[c, 3], net.law[c, 4]
            spring, curved = spring_of(net, c), net.cable[c, CURVE] < net.cable[c, CURVE_END]
            if two_spring == 1.0:
                continue
            rigid = penalty(stage, net, c)
            x0, y0, z0 = step[net.cable[c, START], 0], step[net.cable[c, START], 1], step[net.cable[c, START], 2]
            for j in range(count):
                i = node + j if j < count - 1 else net.cable[c, END]
                row = net.segment[first + j]
                n = row[length_direction : length_direction + 3]
                x1, y1, z1 = step[i, 0], step[i, 1], step[i, 2]
                longer = n[0] * (x1 - x0) + n[1] * (y1 - y0) + n[2] * (z1 - z0)
                x0, y0, z0 = x1, y1, z1
                stretch = row[STRETCH] + longer
                T_linear = net.tension[first + j]
                if rigid > 0.0:
                    if row[STIFFNESS] > 0.0 and T_linear <= 0.0:
                        row[STIFFNESS], row[TENSION], changed = 0.0, 0.0, True
                    elif row[STIFFNESS] == 0.0 and stretch > 0.0:
                        row[STIFFNESS], row[TENSION], changed = less(stage, rigid, row[GEOMETRIC]), rigid * row[STRETCH], True
                    continue
                if not curved and ((T_linear > 0.0) if stretch > 0.0 else row[TENSION] == 0.0):
                    continue
                T, slope, _ = law_of(stage, max(stretch, -L0), row[BEFORE], spring, damper, two_damper, row[NUMERICAL])
                if curved and longer != 0.0:
                    here, _, _ = law_of(stage, row[STRETCH], row[BEFORE], spring, damper, two_damper, row[NUMERICAL])
                    slope = max(slope, (T - here) / longer)
                if abs(T - T_linear) > 1e-2 * (abs(T) + abs(T_linear)) + 64.0 * EPS * k:
                    if slope > 0.0 and length_direction == DIRECTION:
                        turn = row[STIFFNESS] / slope  # the part of the gradient that turns has no slope in it
                        for x in range(3):
                            row[GRADIENT + x] = n[x] + (row[GRADIENT + x] - n[x]) * turn
                    row[STIFFNESS], row[TENSION] = less(stage, slope, row[GEOMETRIC]), T - slope * longer
                    changed = True
        if not changed:
            break
        for i in range(net.n_interior, net.n_free):
            for x in range(3):
                right[i, x] = kept[i, x]
    left = _finish_tensions(stage, net) if stage.law != STATE else 1e300
    return solves, left if taut and net.effects.linear == 1 else 1e300


@njit(void(int64, float64, _f2), cache=True, error_model="numpy", fastmath={"contract"})
def correct(place, length, q):
    """q += length times the Newton step, for the moving nodes."""
    net = net_at(place)
    for i in range(net.n_free):
        for x in range(3):
            q[i, x] += length * net.step[i, x]


@njit(void(int64), cache=True, error_model="numpy", fastmath={"contract"})
def adopt(place):
    """Let the tensions of the net be those of the law, where `residual` was last: they balance the forces there."""
    net = net_at(place)
    for c in range(net.cable.shape[0]):
        first = net.cable[c, FIRST_SEGMENT]
        for s in range(first, first + net.cable[c, SEGMENTS]):
            net.tension[s] = max(net.segment[s, TENSION], 0.0) if net.law[c, 4] == 0.0 else net.segment[s, TENSION]
    for i in range(net.kept.shape[0]):
        for x in range(3):
            net.kept[i, x] = net.pull[net.n_interior + i, x]


@njit(void(int64), cache=True, error_model="numpy", fastmath={"contract"})
def forget(place):
    """Drop the predicted tensions, so that what a failed iteration left does not shape the next tangent."""
    net = net_at(place)
    net.tension[:] = 0.0
    net.linearised[LAW], net.linearised[BEGINNING] = -1.0, AFRESH


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
    first, node = of_table(net.cable, c, FIRST_SEGMENT), of_table(net.cable, c, FIRST_NODE)
    start, end, count = of_table(net.cable, c, START), of_table(net.cable, c, END), _count(net, c)
    L0, k, damper = of_table(net.law, c, LENGTH), of_table(net.law, c, SPRING), of_table(net.law, c, DAMPER)
    spring, two_damper = spring_of(net, c), switch(net, c, TWO_WAY_DAMPER)
    square, L_a = of_table(net.law, c, SQUARE), of_table(net.law, c, FIRST_LENGTH)
    if switch(net, c, RIGID) > 0.0:
        share = 2.0 * stage.dissipation + 0.0 * L0
    else:
        damped = 0.5 * h * square * damper / k
        stiff = 0.25 * h * h * square + damped * damped
        share = 2.0 * stage.dissipation * (stiff * stiff / (1.0 + stiff * stiff))
    A, Q, V, change, segment, zero = base.ravel(), q.ravel(), v.ravel(), net.middle_v.ravel(), net.segment.ravel(), 0.0 * L0
    dissipated, put_in, lost, total_square = zero, zero, zero, zero
    i1, q1, v1, m1, of_1 = start, _place(Q, start), _place(V, start), _mobility(net, start), at(net.degree, start)
    d = zero, zero, zero
    for j in range(count):
        i2 = index(node, j, 1, 0) if j < count - 1 else end
        s = index(first, j, 1, 0)
        row, T, q2, v2 = index(s, 0, COLUMNS, 0), at(net.tension, s), _place(Q, i2), _place(V, i2)
        m2, of_2 = _mobility(net, i2), at(net.degree, i2)
        dx, dy, dz = q2[0] - q1[0], q2[1] - q1[1], q2[2] - q1[2]
        l = math.sqrt(dx * dx + dy * dy + dz * dz)
        per_l, stretch, before = 1.0 / max(l, 1e-12 * L0), l - L0, at(segment, index(row, 0, 1, BEFORE))
        n, longer = (dx * per_l, dy * per_l, dz * per_l), stretch - before
        numerical = at(segment, index(row, 0, 1, NUMERICAL))
        acting, _, secant = law_of(stage, stretch, before, spring, damper, two_damper, numerical)
        put(segment, index(row, 0, 1, STRETCH), stretch)
        put(segment, index(row, 0, 1, TENSION), acting)
        dissipated, total_square = dissipated + (T - secant) * longer, total_square + longer * longer
        rate = n[0] * (v2[0] - v1[0]) + n[1] * (v2[1] - v1[1]) + n[2] * (v2[2] - v1[2])
        wanted = share * (rate - (longer + L0 - L_a) * per_h)
        acts = (T > 0.0) & (wanted * rate > 0.0) & (m1 + m2 > 0.0)
        impulse = select(acts, select(abs(wanted) > abs(rate), rate, wanted) / (of_1 * m1 + of_2 * m2), 0.0)
        put(net.tension, s, T + impulse * per_h)
        a, b = impulse * m1, impulse * m2
        here = d[0] + a * n[0], d[1] + a * n[1], d[2] + a * n[2]
        if j == 0:
            _add_to_points(net.middle_v, 0, start, members, here, 1.0)
            lost = lost - select(m1 == 0.0, impulse, 0.0) * (n[0] * v1[0] + n[1] * v1[1] + n[2] * v1[2])
        else:
            _put_place(change, i1, here)
        if j == count - 1:
            lost = lost + select((m2 == 0.0) & (m1 > 0.0), impulse, 0.0) * (n[0] * v2[0] + n[1] * v2[1] + n[2] * v2[2])
        if j == 0 or j == count - 1:
            a1, a2, per = _place(A, i1), _place(A, i2), 1.0 / max(l + before + L_a, 1e-12 * L_a)
            e = (a2[0] - a1[0] + dx) * per, (a2[1] - a1[1] + dy) * per, (a2[2] - a1[2] + dz) * per
            put_in = put_in + T * (_moved(net, i2, a2, q2, e) - _moved(net, i1, a1, q1, e))
        d = -b * n[0], -b * n[1], -b * n[2]
        i1, q1, v1, m1, of_1 = i2, q2, v2, m2, of_2
    _add_to_points(net.middle_v, 0, end, members, d, 1.0)
    full = numerical_damper(stage, net, c) * total_square
    sums = 0.0, 0.0, 0.0, 0.0
    for x in range(members):
        sums = (
            sums[0] + lane(dissipated, x), sums[1] + lane(put_in, x), sums[2] + lane(lost, x), sums[3] + lane(full, x)
        )  # fmt: skip
    return sums


@njit(void(STAGE, _f2, _f2, _f2, int64, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def settle(stage, base, q, v, place, energy):
    """Account for a step of law ``BETWEEN`` from base to q, and take out of the velocities at its end what rings.

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
        put_in = _work_of_lengths(stage, base, q, place)
        if lengths.mass_node.shape[0] > 0:
            for i in range(net.n_free):
                for x in range(3):
                    net.middle_q[i, x] = 2.0 * (q[i, x] - base[i, x]) * per_h - v[i, x]  # velocity at the start
            put_in += energy_between(place, stage.t - 0.5 * h, base, net.middle_q, lengths.paid[0], lengths.paid[1])
    if _live(net):
        _middle(net, 0.5, per_h, base, q)
        for i in range(net.n_free, q.shape[0]):
            for x in range(3):
                right[i, x] = 0.0
        effects = net.effects
        for e in range(effects.address.shape[0]):
            i, j = effects.index_at[e], effects.index_at[e + 1]
            a, b = effects.params_at[e], effects.params_at[e + 1]
            index, params, of = effects.index[i:j], effects.params[a:b], effects.address[e]
            if of[WHOLE_STEP] != 0:
                dissipated += as_between(of[WHOLE_STEP])(
                    stage.t, h, base, q, index, params, right, net.diagonal, net.near, net.far
                )
            else:
                dissipated += h * as_force(of[FORCE])(stage.t, net.middle_q, net.middle_v, index, params, right)
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
    net.linearised[LEAST] = min(1.0, SPENT * kinetic / max(full, 1e-300))
    net.linearised[BEGINNING] = BEGINS
    if lengths.cable.shape[0] > 0:
        if lengths.mass_node.shape[0] > 0:
            put_in += energy_between(place, stage.t + 0.5 * h, q, v, lengths.paid[1], lengths.paid[2])
        set_lengths(place, stage.t + 0.5 * h, stage.t + 0.5 * h, stage.t + 0.5 * h)
    energy[0], energy[1] = put_in, dissipated + lost


@njit(cache=True, error_model="numpy", forceinline=True)
def _exchange(own, copy, at, back):
    """Copy an array to ``copy`` from ``at`` on, or back; returns where it ends there."""
    for i in range(own.shape[0]):
        if back == 1:
            own[i] = copy[at + i]
        else:
            copy[at + i] = own[i]
    return at + own.shape[0]


@njit(void(int64, int64), cache=True, error_model="numpy")
def remember(place, back):
    """Copy what steps leave to the next: the tensions and the law of each segment; or put it back if ``back`` is 1."""
    net = net_at(place)
    at = _exchange(net.segment.ravel(), net.remembered, 0, back)
    at = _exchange(net.tension, net.remembered, at, back)
    at = _exchange(net.mean, net.remembered, at, back)
    _exchange(net.linearised, net.remembered, at, back)


@njit(void(int64, float64, float64), cache=True, error_model="numpy", fastmath={"contract"})
def average(place, share, h):
    """Add a share of the tensions that balance the stage solved last to their mean over a step of h seconds; 0 begins one."""
    net = net_at(place)
    if share == 0.0:
        net.mean[:] = 0.0
        net.linearised[AVERAGED] = h
        return
    for s in range(net.mean.shape[0]):
        net.mean[s] += share * net.tension[s]


@njit(void(_f2, _f2, int64, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def observe(q, v, place, tension):
    """Tension of every segment in a state (n_segments,) [N], overwritten.

    By the law at one time; after a step of law ``BETWEEN`` by the tension that acted over it and what the law says of the
    difference between the end and the mean of the step, in which an error of the places is not multiplied by the stiffness.
    Nor is one of the rates by the damper: where the step does not resolve the stretching, or how it is damped, the rate is
    that of the step. After the stages of a Runge-Kutta step whose mean was taken, by the law where the step resolves the
    stretching, and by that mean where it does not.
    """
    net = net_at(place)
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        L0, k, damper, two_damper, spring = net.law[c, 0], net.law[c, 1], net.law[c, 2], net.law[c, 4], spring_of(net, c)
        before = net.cable[c, START]
        for j in range(count):
            i, s = node + j if j < count - 1 else net.cable[c, END], first + j
            acting = net.tension[s] if two_damper > 0.0 else max(net.tension[s], 0.0)
            if net.linearised[LAW] == BACKWARD or net.law[c, 6] > 0.0:
                tension[s] = acting
            else:
                dx, dy, dz = q[i, 0] - q[before, 0], q[i, 1] - q[before, 1], q[i, 2] - q[before, 2]
                l = math.sqrt(dx * dx + dy * dy + dz * dz)
                rate = dx * (v[i, 0] - v[before, 0]) + dy * (v[i, 1] - v[before, 1]) + dz * (v[i, 2] - v[before, 2])
                rate = rate / max(l, 1e-12 * L0) - net.law[c, GROWTH]
                T, elastic = tension_parts(l - L0, rate, spring, damper, two_damper)
                if net.linearised[LAW] == BETWEEN and (elastic != 0.0 or two_damper > 0.0):
                    h, row = net.linearised[TAU], net.segment[s]
                    mean = row[STRETCH] - row[BEFORE]
                    if two_damper == 0.0:
                        mean = max(row[STRETCH], 0.0) - max(row[BEFORE], 0.0)
                    mean /= h
                    resolved = 1.0 / (1.0 + (0.25 * h + 0.5 * damper / k) * h * net.law[c, 5])
                    T = acting + (elastic - row[TENSION] + damper * mean) + damper * resolved * (rate - mean)
                    T = T if two_damper > 0.0 else max(T, 0.0)
                elif net.linearised[LAW] == STATE and net.linearised[AVERAGED] > 0.0:
                    h = net.linearised[AVERAGED]
                    stiff = (0.25 * h + 0.5 * damper / k) * h * net.law[c, 5]
                    T = net.mean[s] + (T - net.mean[s]) / (1.0 + stiff * stiff)
                tension[s] = T
            before = i


@njit(void(float64, _f2, _f2, int64, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def energies(t, q, v, place, energy):
    """Kinetic energy of the moving nodes, spring energy, and potential energy of the effects: (3,) [J], overwritten."""
    net = net_at(place)
    if net.lengths.cable.shape[0] > 0:
        set_lengths(place, t, t, t)
    kinetic, elastic, potential = 0.0, 0.0, 0.0
    for i in range(net.n_free):
        kinetic += 0.5 * net.mass[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
    for c in range(net.cable.shape[0]):
        count, node = net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        L0, spring = net.law[c, 0], spring_of(net, c)
        before = net.cable[c, START]
        for j in range(count):
            i = node + j if j < count - 1 else net.cable[c, END]
            dx, dy, dz = q[i, 0] - q[before, 0], q[i, 1] - q[before, 1], q[i, 2] - q[before, 2]
            elastic += elastic_energy(math.sqrt(dx * dx + dy * dy + dz * dz) - L0, spring)
            before = i
    effects = net.effects
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        potential += as_energy(effects.address[e, ENERGY])(t, q, effects.index[i:j], effects.params[a:b])
    energy[0], energy[1], energy[2] = kinetic, elastic, potential


@njit(float64(_f2, _f2, int64), cache=True, error_model="numpy", fastmath={"contract"})
def margin(q, v, place):
    """Largest of T/T_max - 1 over the segments of cables that may break, T as in `observe`; `NEVER` if there are none."""
    net = net_at(place)
    largest = NEVER
    if net.strength.shape[0] > 0:
        observe(q, v, place, net.observed)
        for s in range(net.strength.shape[0]):
            largest = max(largest, net.observed[s] / net.strength[s] - 1.0)
    return largest
