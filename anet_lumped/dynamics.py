"""What an integrator asks of a net: forces, prescribed motion, the residual of a stage, the Newton step, the energies."""

import math

from numba import float64, int64, njit, types, void

from integrators.stage import BACKWARD, BETWEEN, STAGE, STATE

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
STRICT = 300.0  # times its inertia is what a length that must not change counts for
PENALTY = 1e7  # of a length that must not change, over the inertia of a node
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
def _moving(net, i):
    """Mass of a node if it moves."""
    return net.mass[i] if i < net.n_free else 0.0


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _rigid(stage, net, c):
    """Penalty of a cable that does not stretch [N/m], 0 for one that does.

    Its tension is a multiplier: each Newton step adds the penalty times the length that is too much, whatever the penalty,
    until none is left (augmented Lagrangian); a large one leaves next to nothing after the first.
    """
    if net.law[c, 6] == 0.0:
        return 0.0
    if net.cable[c, SEGMENTS] > 1:
        return PENALTY * stage.W * net.mass[net.cable[c, FIRST_NODE]]
    return PENALTY * stage.W * max(_moving(net, net.cable[c, START]), _moving(net, net.cable[c, END]))


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


@njit(cache=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def _linearise(stage, q0, q1, a0, a1, law, guess, light, rigid, row):
    """Force of a segment on the node at its start, and its tension; writes the linearised law to ``row``.

    q0, q1 are its ends now, a0, a1 those of the base, ``guess`` the tension that its geometric stiffness takes. A segment that
    cannot push, is short by a length that inertia (``light`` [N/m]) hardly feels and was predicted taut is linearised as taut.
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
    if rigid > 0.0:
        T, slope, secant = guess + rigid * (l - L0), rigid, 0.0
        if two_damper == 0.0 and guess + light * (l - L0) <= 0.0:
            T, slope = 0.0, 0.0
    else:
        T, slope, secant = _law(stage, l - L0, before, k, damper, two_spring, two_damper, numerical)
    if stage.law == STATE and slope > 0.0 and (before > 0.0 or two_damper > 0.0):
        # dT = slope n.dd - (c/tau)(I - n n^T) d_hat . dd / l: the damper sees the segment turn
        turn, along = damper / (slope * stage.tau * max(l, 0.01 * L0)), before + L0
        gx, gy, gz = nx - turn * (ax - along * nx), ny - turn * (ay - along * ny), nz - turn * (az - along * nz)
    row[0], row[1], row[2], row[3], row[4], row[5] = ex, ey, ez, gx, gy, gz
    row[GEOMETRIC] = max(guess, 0.0) * per_sum
    row[STIFFNESS], row[TENSION] = slope, T
    if rigid > 0.0 and two_damper == 0.0:
        T = max(T, 0.0)
    elif T == 0.0 and guess > 0.0 and two_damper == 0.0 and stage.law == BETWEEN and guess + light * min(l - L0, before) > 0.0:
        row[TENSION], row[STIFFNESS], _ = tension_between(before, l - L0, k, damper / stage.tau + numerical, 1.0, 1.0)
    row[BEFORE], row[STRETCH], row[SECANT] = before, l - L0, secant
    return T * ex, T * ey, T * ez, T


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
    norm, noise, finite, predicted, floor = 0.0, 4.0 * EPS * heaviest * reach, 0.0, 0.0, 4.0 * EPS * heaviest * reach
    kept, net.linearised[0], net.linearised[1] = net.kept, stage.law, stage.tau
    for i in range(net.n_interior, n):
        for x in range(3):
            kept[i - net.n_interior, x] = right[i, x]
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        start, end, inner = net.cable[c, START], net.cable[c, END], count - 1
        of = net.law[c]
        numerical = _numerical(stage, of)
        law = (of[0], of[1], of[2], of[3], of[4], numerical)
        rigid = _rigid(stage, net, c)
        taut = rigid + of[2] * per_tau + (0.5 * of[1] + numerical if stage.law == BETWEEN else of[1])
        old = abs(0.5 * of[1] - numerical - of[2] * per_tau) if stage.law == BETWEEN else of[2] * per_tau
        inertia = stage.W * max(mass[node] if inner > 0 else 0.0, _moving(net, start), _moving(net, end))
        light = max(old, inertia)
        # a length that is off costs k/2 of its square; where the length is not allowed to be off it must be small by itself
        share = STRICT * inertia / rigid if rigid > 0.0 else max(light / max(taut, 1e-300), math.sqrt(inertia / max(taut, 1e-300)))
        share, one_way = min(1.0, share), of[4] == 0.0
        hx, hy, hz, off = 0.0, 0.0, 0.0, 0.0
        q0, a0 = (q[start, 0], q[start, 1], q[start, 2]), (base[start, 0], base[start, 1], base[start, 2])
        # views of the cable's own nodes, so that no index can be negative and the loop stays tight
        Q, A, R = q[node : node + inner], base[node : node + inner], right[node : node + inner]
        row, guess = net.segment[first : first + count], net.tension[first : first + count]
        fx, fy, fz, largest = 0.0, 0.0, 0.0, 0.0
        for j in range(inner):
            q1, a1 = (Q[j, 0], Q[j, 1], Q[j, 2]), (A[j, 0], A[j, 1], A[j, 2])
            tx, ty, tz, T = _linearise(stage, q0, q1, a0, a1, law, guess[j], light, rigid, row[j])
            used = max(guess[j], 0.0) if one_way else guess[j]
            off = max(off, abs(row[j, TENSION] - used) * (share if row[j, STIFFNESS] > 0.9 * taut else 1.0))
            ux, uy, uz = used * row[j, 0], used * row[j, 1], used * row[j, 2]
            if j == 0:
                kept[start - net.n_interior, 0] += ux
                kept[start - net.n_interior, 1] += uy
                kept[start - net.n_interior, 2] += uz
                pull[start, 0] += tx
                pull[start, 1] += ty
                pull[start, 2] += tz
            else:
                sx, sy, sz = R[j - 1, 0], R[j - 1, 1], R[j - 1, 2]
                scale = max(scale, abs(sx), abs(sy), abs(sz))
                rx, ry, rz = sx + tx - fx, sy + ty - fy, sz + tz - fz
                norm = max(norm, abs(rx), abs(ry), abs(rz))
                finite += rx + ry + rz
                predicted = max(predicted, abs(sx + ux - hx), abs(sy + uy - hy), abs(sz + uz - hz))
            hx, hy, hz = ux, uy, uz
            q0, a0, fx, fy, fz, largest = q1, a1, tx, ty, tz, max(largest, abs(T))
        q1, a1 = (q[end, 0], q[end, 1], q[end, 2]), (base[end, 0], base[end, 1], base[end, 2])
        tx, ty, tz, T = _linearise(stage, q0, q1, a0, a1, law, guess[inner], light, rigid, row[inner])
        used = max(guess[inner], 0.0) if one_way else guess[inner]
        off = max(off, abs(row[inner, TENSION] - used) * (share if row[inner, STIFFNESS] > 0.9 * taut else 1.0))
        ux, uy, uz = used * row[inner, 0], used * row[inner, 1], used * row[inner, 2]
        if inner == 0:
            kept[start - net.n_interior, 0] += ux
            kept[start - net.n_interior, 1] += uy
            kept[start - net.n_interior, 2] += uz
            pull[start, 0] += tx
            pull[start, 1] += ty
            pull[start, 2] += tz
        else:
            sx, sy, sz = R[inner - 1, 0], R[inner - 1, 1], R[inner - 1, 2]
            rx, ry, rz = sx + tx - fx, sy + ty - fy, sz + tz - fz
            norm = max(norm, abs(rx), abs(ry), abs(rz))
            finite += rx + ry + rz
            predicted = max(predicted, abs(sx + ux - hx), abs(sy + uy - hy), abs(sz + uz - hz))
        floor = max(floor, 4.0 * EPS * (max(largest, abs(T)) + (share * taut + light) * max(reach, of[0])))
        predicted = max(predicted, off)
        kept[end - net.n_interior, 0] -= ux
        kept[end - net.n_interior, 1] -= uy
        kept[end - net.n_interior, 2] -= uz
        pull[end, 0] -= tx
        pull[end, 1] -= ty
        pull[end, 2] -= tz
        noise = max(noise, 4.0 * EPS * (max(largest, abs(T)) + (law[1] + law[2] * per_tau) * max(reach, law[0])))
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
            numerical, rigid = _numerical(stage, net.law[c]), _rigid(stage, net, c)
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
                        row[STIFFNESS], row[TENSION], changed = rigid, rigid * row[STRETCH], True
                    continue
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
    net.linearised[0] = -1.0


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
        dissipated += (net.tension[s] - row[SECANT]) * (row[STRETCH] - row[BEFORE])
    effects = net.effects
    for e in range(effects.address.shape[0]):
        i, j = effects.index_at[e], effects.index_at[e + 1]
        a, b = effects.params_at[e], effects.params_at[e + 1]
        dissipated += stage.tau * as_force(effects.address[e, 0])(
            stage.t, net.middle_q, net.middle_v, effects.index[i:j], effects.params[a:b], net.right
        )
    for i in range(net.n_driven, q.shape[0]):
        for x in range(3):
            put_in -= net.kept[i - net.n_interior, x] * (q[i, x] - base[i, x])
    energy[0], energy[1] = put_in, dissipated


@njit(types.UniTuple(float64, 2)(STAGE, _f2, int64), cache=True, error_model="numpy", fastmath={"contract"})
def calm(stage, v, place):
    """Take out of the velocities what rings: rates of length that a step of law ``BETWEEN`` cannot resolve.

    Where stretching is over within a step, v_b = 2 (q_b - q_a)/h - v_a changes its sign from step to step for ever, while the
    places are at rest. Each taut segment takes from the rate at which its length changes a share s'/(1 + s') of what that
    differs from the step's own, s' = ((h omega/2)^2 + (h omega^2 c/2k)^2)^2, by equal and opposite impulses along itself, all at
    once and each as if its nodes were as many times lighter as they have segments: momenta are kept, and the kinetic energy
    falls but for the work of prescribed nodes. Of fifth order where the step resolves the stretching. The impulses over the
    step are a part of the tensions that acted.

    Returns
    -------
    put_in, lost : float64 [J]
    """
    net, put_in, h, change = net_at(place), 0.0, stage.tau, net_at(place).middle_v
    for i in range(change.shape[0]):
        for x in range(3):
            change[i, x] = 0.0
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        start, end, of = net.cable[c, START], net.cable[c, END], net.law[c]
        stiff = 1e100 if of[6] > 0.0 else 0.25 * h * h * of[5] + (0.5 * h * of[5] * of[2] / of[1]) ** 2
        share = 2.0 * stage.dissipation * (stiff * stiff / (1.0 + stiff * stiff))
        i1 = start
        for j in range(count):
            i2 = node + j if j < count - 1 else end
            row, v1, v2, d1, d2 = net.segment[first + j], v[i1], v[i2], change[i1], change[i2]
            m1, m2 = 1.0 / net.mass[i1] if i1 < net.n_free else 0.0, 1.0 / net.mass[i2] if i2 < net.n_free else 0.0
            of_1, of_2, i1 = net.degree[i1], net.degree[i2], i2
            nx, ny, nz = row[GRADIENT], row[GRADIENT + 1], row[GRADIENT + 2]
            rate = nx * (v2[0] - v1[0]) + ny * (v2[1] - v1[1]) + nz * (v2[2] - v1[2])
            less = share * (rate - (row[STRETCH] - row[BEFORE]) / h)
            if net.tension[first + j] <= 0.0 or less * rate <= 0.0 or m1 + m2 == 0.0:
                continue
            if abs(less) > abs(rate):
                less = rate
            impulse = less / (of_1 * m1 + of_2 * m2)
            net.tension[first + j] += impulse / h
            if m1 == 0.0:
                put_in -= impulse * (nx * v1[0] + ny * v1[1] + nz * v1[2])
            elif m2 == 0.0:
                put_in += impulse * (nx * v2[0] + ny * v2[1] + nz * v2[2])
            a, b = impulse * m1, impulse * m2
            d1[0], d1[1], d1[2] = d1[0] + a * nx, d1[1] + a * ny, d1[2] + a * nz
            d2[0], d2[1], d2[2] = d2[0] - b * nx, d2[1] - b * ny, d2[2] - b * nz
    gained = 0.0
    for i in range(net.n_free):
        for x in range(3):
            gained += net.mass[i] * change[i, x] * (v[i, x] + 0.5 * change[i, x])
            v[i, x] += change[i, x]
    return put_in, put_in - gained


@njit(void(_f2, _f2, int64, _f1), cache=True, error_model="numpy", fastmath={"contract"})
def observe(q, v, place, tension):
    """Tension of every segment in a state (n_segments,) [N], overwritten.

    By the law at one time; after a step of law ``BETWEEN`` by the tension that acted over it and what the law says of the
    difference between the end and the mean of the step, in which an error of the places is not multiplied by the stiffness.
    Nor is one of the rates by the damper: where the step does not resolve the stretching, or how it is damped, the rate is
    that of the step.
    """
    net = net_at(place)
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, FIRST_SEGMENT], net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE]
        L0, k, damper, two_spring, two_damper = net.law[c, 0], net.law[c, 1], net.law[c, 2], net.law[c, 3], net.law[c, 4]
        before = net.cable[c, START]
        for j in range(count):
            i, s = node + j if j < count - 1 else net.cable[c, END], first + j
            acting = net.tension[s] if two_damper > 0.0 else max(net.tension[s], 0.0)
            if net.linearised[0] == BACKWARD or net.law[c, 6] > 0.0:
                tension[s] = acting
            else:
                dx, dy, dz = q[i, 0] - q[before, 0], q[i, 1] - q[before, 1], q[i, 2] - q[before, 2]
                l = math.sqrt(dx * dx + dy * dy + dz * dz)
                rate = dx * (v[i, 0] - v[before, 0]) + dy * (v[i, 1] - v[before, 1]) + dz * (v[i, 2] - v[before, 2])
                rate /= max(l, 1e-12 * L0)
                T, spring = tension_parts(l - L0, rate, k, damper, two_spring, two_damper)
                if net.linearised[0] == BETWEEN and (spring != 0.0 or two_damper > 0.0):
                    h, row = net.linearised[1], net.segment[s]
                    mean = row[STRETCH] - row[BEFORE]
                    if two_damper == 0.0:
                        mean = max(row[STRETCH], 0.0) - max(row[BEFORE], 0.0)
                    mean /= h
                    resolved = 1.0 / (1.0 + (0.25 * h + 0.5 * damper / k) * h * net.law[c, 5])
                    T = acting + (spring - row[TENSION] + damper * mean) + damper * resolved * (rate - mean)
                    T = T if two_damper > 0.0 else max(T, 0.0)
                tension[s] = T
            before = i


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
