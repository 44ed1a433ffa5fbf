"""What an integrator asks of a net: forces, prescribed motion, the residual of a stage, the Newton step, the energies."""

import math

from numba import float64, int64, njit, types, void

from integrators.stage import BETWEEN, STAGE, STATE

from . import chain
from .chain import (
    BEFORE,
    DIRECTION,
    END,
    FIRST_NODE,
    FIRST_SEGMENT,
    GEOMETRIC,
    GRADIENT,
    SECANT,
    SEGMENTS,
    START,
    STIFFNESS,
    STRETCH,
    TENSION,
)
from .effects.axial import stored, tension_between, tension_parts, tension_slopes
from .effects.signatures import as_energy, as_force, as_tangent
from .net import net_at
from .path_kernel import evaluate

_f1, _f2 = float64[::1], float64[:, ::1]
EPS = 2.220446049250313e-16
ROUNDS = 4  # eliminations a Newton step may spend on finding which segments are slack


@njit(void(float64, int64, _f2, _f2), cache=True, error_model="numpy", fastmath={"contract"})
def prescribe(t, place, q, v):
    """Write place and velocity of the driven nodes at time t; fixed ones keep what they hold."""
    net = net_at(place)
    first = net.n_driven
    if first < q.shape[0]:
        evaluate(t, net.paths, q[first:], v[first:], net.step[first:])
        net.step[first:] = 0.0


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _pull(q0, q1, v0, v1, L0, k, c, two_spring, two_damper):
    """Force of a segment on the node at its start, and the power that its damper dissipates."""
    dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
    l = math.sqrt(dx * dx + dy * dy + dz * dz)
    per_l = 1.0 / max(l, 1e-12 * L0)
    rate = (dx * (v1[0] - v0[0]) + dy * (v1[1] - v0[1]) + dz * (v1[2] - v0[2])) * per_l
    T, spring = tension_parts(l - L0, rate, k, c, two_spring, two_damper)
    along = T * per_l
    return along * dx, along * dy, along * dz, (T - spring) * rate


@njit(void(float64, _f2, _f2, int64, _f2, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def force(t, q, v, place, f, power):
    """Force on every node.

    f_i = external + sum over its segments of -+ T n, T = EA eps + BA (dl/dt)/L0 by the cable's compression law.

    Parameters
    ----------
    t : float64 [s]
    q, v : (n, 3) float64 [m], [m/s]
    place : int64, address of the net
    f : (n, 3) float64 [N], overwritten; on prescribed nodes the pull of the segments alone
    power : (2,) float64 [W], overwritten: dissipated by dampers and effects; put in by prescribed nodes
    """
    net = net_at(place)
    f[net.n_interior :] = 0.0
    dissipated = 0.0
    for c in range(net.cable.shape[0]):
        inner, node = net.cable[c, SEGMENTS] - 1, net.cable[c, FIRST_NODE]
        start, end = net.cable[c, START], net.cable[c, END]
        L0, k, damper, two_spring, two_damper = net.law[c, 0], net.law[c, 1], net.law[c, 2], net.law[c, 3], net.law[c, 4]
        q0, v0 = (q[start, 0], q[start, 1], q[start, 2]), (v[start, 0], v[start, 1], v[start, 2])
        # views of the cable's own nodes, so that no index can be negative and the loop stays tight
        Q, V, F = q[node : node + inner], v[node : node + inner], f[node : node + inner]
        before, fx, fy, fz = f[start], -f[start, 0], -f[start, 1], -f[start, 2]
        for j in range(inner):
            q1, v1 = (Q[j, 0], Q[j, 1], Q[j, 2]), (V[j, 0], V[j, 1], V[j, 2])
            gx, gy, gz, lost = _pull(q0, q1, v0, v1, L0, k, damper, two_spring, two_damper)
            dissipated += lost
            before[0], before[1], before[2] = gx - fx, gy - fy, gz - fz
            before, q0, v0, fx, fy, fz = F[j], q1, v1, gx, gy, gz
        q1, v1 = (q[end, 0], q[end, 1], q[end, 2]), (v[end, 0], v[end, 1], v[end, 2])
        gx, gy, gz, lost = _pull(q0, q1, v0, v1, L0, k, damper, two_spring, two_damper)
        dissipated += lost
        before[0], before[1], before[2] = gx - fx, gy - fy, gz - fz
        f[end, 0] -= gx
        f[end, 1] -= gy
        f[end, 2] -= gz
    effects = net.effects
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        dissipated += as_force(effects.address[e, 0])(t, q, v, effects.index[i:j], effects.params[a:b], f)
    put_in = 0.0
    for i in range(net.n_driven, q.shape[0]):
        put_in -= f[i, 0] * v[i, 0] + f[i, 1] * v[i, 1] + f[i, 2] * v[i, 2]
    power[0], power[1] = dissipated, put_in


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _numerical(stage, of):
    """Numerical damper of a cable's segments [N/m]: alpha k s^2/(1 + s^2), s = omega h/2.

    In full where the step does not resolve the highest frequency omega of a segment; of third order in the step where it does.
    """
    square = 0.25 * stage.tau * stage.tau * of[5]
    return stage.dissipation * of[1] * (square / (1.0 + square))


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _law(stage, stretch, before, k, c, two_spring, two_damper, numerical):
    """Tension, its slope in the length, and its conservative part, for the law that the stage asks for.

    ``before`` is the stretch that belongs to the start of the stage. Where a segment cannot push, the damper acts on the
    change of the taut part of the length, so that the tension is continuous in the length when a slack segment turns taut.
    ``numerical`` is the damper that the scheme adds [N/m], see `_numerical`.
    """
    if stage.law == BETWEEN:
        return tension_between(before, stretch, k, c / stage.tau + numerical, two_spring, two_damper)
    if two_damper > 0.0:
        rate = (stretch - before) / stage.tau
    else:
        rate = (max(stretch, 0.0) - max(before, 0.0)) / stage.tau
    T, of_stretch, of_rate = tension_slopes(stretch, rate, k, c, two_spring, two_damper)
    return T, of_stretch + of_rate / stage.tau, 0.0


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _linearise(stage, q0, q1, a0, a1, law, guess, row):
    """Force of a segment on the node at its start, and its tension; writes the linearised law to ``row``.

    q0, q1 are its ends now, a0, a1 those of the base, ``guess`` the tension that its geometric stiffness takes.
    """
    L0, k, damper, two_spring, two_damper, numerical = law
    dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
    ax, ay, az = a1[0] - a0[0], a1[1] - a0[1], a1[2] - a0[2]
    l = math.sqrt(dx * dx + dy * dy + dz * dz)
    per_l = 1.0 / max(l, 1e-12 * L0)
    nx, ny, nz = dx * per_l, dy * per_l, dz * per_l
    ex, ey, ez, gx, gy, gz = nx, ny, nz, nx, ny, nz
    per_sum = min(per_l, 100.0 / L0)
    if stage.law == STATE:
        before = nx * ax + ny * ay + nz * az - L0
    else:
        l_a = math.sqrt(ax * ax + ay * ay + az * az)
        before = l_a - L0
        if stage.law == BETWEEN:
            per = 1.0 / max(l_a + l, 1e-12 * L0)
            ex, ey, ez = (ax + dx) * per, (ay + dy) * per, (az + dz) * per
            per_sum = min(per, 100.0 / L0)
    T, slope, secant = _law(stage, l - L0, before, k, damper, two_spring, two_damper, numerical)
    if stage.law == STATE and slope > 0.0 and (before > 0.0 or two_damper > 0.0):
        # dT = slope n.dd - (c/tau)(I - n n^T) d_hat . dd / l: the damper sees the segment turn
        turn, along = damper / (slope * stage.tau * max(l, 0.01 * L0)), before + L0
        gx, gy, gz = nx - turn * (ax - along * nx), ny - turn * (ay - along * ny), nz - turn * (az - along * nz)
    row[0], row[1], row[2], row[3], row[4], row[5] = ex, ey, ez, gx, gy, gz
    row[GEOMETRIC] = max(guess, 0.0) * per_sum
    row[STIFFNESS], row[TENSION] = slope, T
    row[BEFORE], row[STRETCH], row[SECANT] = before, l - L0, secant
    return T * ex, T * ey, T * ez, T


@njit(types.UniTuple(float64, 3)(STAGE, _f2, _f2, _f2, int64), cache=True, error_model="numpy", fastmath={"contract"})
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
    norm, scale, noise : float64 [N]
        Largest component of the out-of-balance force; the largest inertial or external force on a node, which a tolerance
        is relative to; and what rounding of the places alone leaves in it.
    """
    net = net_at(place)
    n, n_free, mass, right, diagonal = q.shape[0], net.n_free, net.mass, net.right, net.diagonal
    middle_q, middle_v, per_tau = net.middle_q, net.middle_v, 1.0 / stage.tau
    reach, scale, heaviest = 0.0, 0.0, 0.0
    for i in range(n):
        W = mass[i] * stage.W if i < n_free else 0.0
        heaviest = max(heaviest, W)
        for x in range(3):
            here, before = q[i, x], base[i, x]
            moved = here - before
            middle_q[i, x] = before + stage.theta * moved
            middle_v[i, x] = moved * per_tau
            reach = max(reach, abs(here))
            inertia = W * (target[i, x] - here)
            scale = max(scale, abs(inertia))
            right[i, x] = inertia
        if i < n_free:
            D = diagonal[i]
            D[0, 0], D[0, 1], D[0, 2] = W, 0.0, 0.0
            D[1, 0], D[1, 1], D[1, 2] = 0.0, W, 0.0
            D[2, 0], D[2, 1], D[2, 2] = 0.0, 0.0, W
    effects = net.effects
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        index, params = effects.index[i:j], effects.params[a:b]
        as_force(effects.address[e, 0])(stage.t, middle_q, middle_v, index, params, right)
        as_tangent(effects.address[e, 1])(stage.t, middle_q, middle_v, index, params, stage.theta, per_tau, diagonal)
    pull = net.pull
    for i in range(net.n_interior, n):
        for x in range(3):
            pull[i, x] = right[i, x]
    norm, noise, finite = 0.0, 4.0 * EPS * heaviest * reach, 0.0
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        start, end, inner = net.cable[c, START], net.cable[c, END], count - 1
        of = net.law[c]
        law = (of[0], of[1], of[2], of[3], of[4], _numerical(stage, of))
        q0, a0 = (q[start, 0], q[start, 1], q[start, 2]), (base[start, 0], base[start, 1], base[start, 2])
        # views of the cable's own nodes, so that no index can be negative and the loop stays tight
        Q, A, R = q[node : node + inner], base[node : node + inner], right[node : node + inner]
        row, guess = net.segment[first : first + count], net.tension[first : first + count]
        fx, fy, fz, largest = 0.0, 0.0, 0.0, 0.0
        for j in range(inner):
            q1, a1 = (Q[j, 0], Q[j, 1], Q[j, 2]), (A[j, 0], A[j, 1], A[j, 2])
            tx, ty, tz, T = _linearise(stage, q0, q1, a0, a1, law, guess[j], row[j])
            if j == 0:
                pull[start, 0] += tx
                pull[start, 1] += ty
                pull[start, 2] += tz
            else:
                sx, sy, sz = R[j - 1, 0], R[j - 1, 1], R[j - 1, 2]
                scale = max(scale, abs(sx), abs(sy), abs(sz))
                rx, ry, rz = sx + tx - fx, sy + ty - fy, sz + tz - fz
                norm = max(norm, abs(rx), abs(ry), abs(rz))
                finite += rx + ry + rz
            q0, a0, fx, fy, fz, largest = q1, a1, tx, ty, tz, max(largest, abs(T))
        q1, a1 = (q[end, 0], q[end, 1], q[end, 2]), (base[end, 0], base[end, 1], base[end, 2])
        tx, ty, tz, T = _linearise(stage, q0, q1, a0, a1, law, guess[inner], row[inner])
        if inner == 0:
            pull[start, 0] += tx
            pull[start, 1] += ty
            pull[start, 2] += tz
        else:
            rx, ry, rz = R[inner - 1, 0] + tx - fx, R[inner - 1, 1] + ty - fy, R[inner - 1, 2] + tz - fz
            norm = max(norm, abs(rx), abs(ry), abs(rz))
            finite += rx + ry + rz
        pull[end, 0] -= tx
        pull[end, 1] -= ty
        pull[end, 2] -= tz
        noise = max(noise, 4.0 * EPS * (max(largest, abs(T)) + (law[1] + law[2] * per_tau) * max(reach, law[0])))
    for i in range(net.n_interior, n_free):
        norm = max(norm, abs(pull[i, 0]), abs(pull[i, 1]), abs(pull[i, 2]))
        finite += pull[i, 0] + pull[i, 1] + pull[i, 2]
    if not finite - finite == 0.0:
        norm = 1e300
    return norm, scale, noise


@njit(int64(STAGE, int64), cache=True, error_model="numpy", fastmath={"contract"})
def direction(stage, place):
    """Newton step of the stage that `residual` linearised last, for ``net.step`` and ``net.tension``.

    A segment that the step would make slack or taut leaves the piece of its law that was linearised: its law is replaced by
    the tangent at the predicted length and the step is solved again, until no segment changes. Source: DESIGN, numerics 3.

    Returns
    -------
    solves : int64
        Eliminations made.
    """
    net = net_at(place)
    right, kept, step = net.right, net.pull, net.step
    for i in range(net.n_interior, net.n_free):
        for x in range(3):
            kept[i, x] = right[i, x]
    length_direction = GRADIENT if stage.law == BETWEEN else DIRECTION
    for solves in range(1, ROUNDS + 1):
        if chain.solve(place) > 0.0 or solves == ROUNDS:  # all are taut and stay so: a slack segment has no tension
            break
        changed = False
        for c in range(net.cable.shape[0]):
            first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
            L0, k, damper, two_spring, two_damper = net.law[c, 0], net.law[c, 1], net.law[c, 2], net.law[c, 3], net.law[c, 4]
            if two_spring > 0.0:
                continue
            numerical = _numerical(stage, net.law[c])
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
                if (T_linear > 0.0) if stretch > 0.0 else row[TENSION] == 0.0:
                    continue
                T, slope, _ = _law(stage, max(stretch, -L0), row[BEFORE], k, damper, two_spring, two_damper, numerical)
                if abs(T - T_linear) > 1e-2 * (abs(T) + abs(T_linear)) + 64.0 * EPS * k:
                    if slope > 0.0 and length_direction == DIRECTION:
                        turn = row[STIFFNESS] / slope  # the part of the gradient that turns has no slope in it
                        for x in range(3):
                            row[GRADIENT + x] = n[x] + (row[GRADIENT + x] - n[x]) * turn
                    row[STIFFNESS], row[TENSION] = slope, T - slope * longer
                    changed = True
        if not changed:
            break
        for i in range(net.n_interior, net.n_free):
            for x in range(3):
                right[i, x] = kept[i, x]
    return solves


@njit(void(int64, float64, _f2), cache=True, error_model="numpy", fastmath={"contract"})
def correct(place, length, q):
    """q += length times the Newton step, for the moving nodes."""
    net = net_at(place)
    for i in range(net.n_free):
        for x in range(3):
            q[i, x] += length * net.step[i, x]


@njit(void(int64), cache=True, error_model="numpy", fastmath={"contract"})
def forget(place):
    """Drop the predicted tensions, so that what a failed iteration left does not shape the next tangent."""
    net_at(place).tension[:] = 0.0


@njit(void(STAGE, _f2, _f2, int64, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def settle(stage, base, q, place, energy):
    """Energy put in by driven nodes and dissipated, between base and q, exactly as the step of law ``BETWEEN`` accounts it.

    Parameters
    ----------
    stage, base, q, place
        As in the last call of `residual`.
    energy : (2,) float64 [J], overwritten
    """
    net = net_at(place)
    dissipated, put_in = 0.0, 0.0
    for s in range(net.segment.shape[0]):
        row = net.segment[s]
        dissipated += (row[TENSION] - row[SECANT]) * (row[STRETCH] - row[BEFORE])
    effects = net.effects
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        dissipated += stage.tau * as_force(effects.address[e, 0])(
            stage.t, net.middle_q, net.middle_v, effects.index[i:j], effects.params[a:b], net.right
        )
    for i in range(net.n_driven, q.shape[0]):
        for x in range(3):
            put_in -= net.pull[i, x] * (q[i, x] - base[i, x])
    energy[0], energy[1] = put_in, dissipated


@njit(void(float64, _f2, _f2, int64, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def energies(t, q, v, place, energy):
    """Kinetic energy of the moving nodes, spring energy, and potential energy of the effects: (3,) [J], overwritten."""
    net = net_at(place)
    kinetic, elastic, potential = 0.0, 0.0, 0.0
    for i in range(net.n_free):
        kinetic += 0.5 * net.mass[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
    for c in range(net.cable.shape[0]):
        count, node = net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        L0, k, two_spring = net.law[c, 0], net.law[c, 1], net.law[c, 3]
        before = net.cable[c, START]
        for j in range(count):
            i = node + j if j < count - 1 else net.cable[c, END]
            dx, dy, dz = q[i, 0] - q[before, 0], q[i, 1] - q[before, 1], q[i, 2] - q[before, 2]
            elastic += stored(math.sqrt(dx * dx + dy * dy + dz * dz) - L0, k, two_spring)
            before = i
    effects = net.effects
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        potential += as_energy(effects.address[e, 2])(t, q, effects.index[i:j], effects.params[a:b])
    energy[0], energy[1], energy[2] = kinetic, elastic, potential
