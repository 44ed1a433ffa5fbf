"""The exact equilibrium of lumped chains under dead loads, found in the forces.

Given the force F at its start, a cable's shape follows segment by segment. A segment lies along its force F and has the length L0
(1 + |F|/EA); the force in the next segment is F_next = F - load, with the load of the node between both. So each cable has three
unknowns, however many segments it has. The position of its end relative to its start is the gradient of its complementary energy,

    r(F) = dU*/dF ,     U*(F) = sum over segments of L0 (|F_s| + |F_s|^2/(2 EA)) ,

which is convex. A cable closes if it ends at its end point. The forces that carry the loads of all free points and close all cables
are the minimum of a convex function under linear conditions, whose multipliers are the positions of the free points. Newton's
method with a line search finds this minimum from any start. A segment without force is slack, and |F| has a kink there. The kink is
rounded off, less in each of `ROUNDINGS` rounds. The direction u of each segment is an unknown of its own, |F| u = F, so that a
slack cable closes as exactly as a taut one (the primal-dual idea of Andersen, Christiansen, Conn & Overton, SIAM J. Sci. Comput.
22 (2000) 243).
"""

from typing import Any, NamedTuple

import numpy as np
from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, internal, kernel, njit
from anet_lumped.mechanics.linear import junctions
from anet_lumped.mechanics.linear import node_elimination as elimination
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_L0,
    CABLE_BLOCK_END_START,
    CABLE_BLOCK_START_END,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_JOINS_FREE_POINTS,
    CABLE_SEGMENTS,
    CABLE_START,
    FACTOR_DIRECTION,
)

_f1, _f2 = float64[::1], float64[:, ::1]
EPS = 2.220446049250313e-16
ROUNDINGS = 6  # of |F|, from 1e-2 of the load down to 1e-12 of it
ITERATIONS = 200  # Newton iterations in each round


class CableEnd(NamedTuple):
    """Where a cable ends, relative to its start [m], and what its end is pulled by [N].

    Parameters
    ----------
    x, y, z : by the directions of the segments that are unknowns
    along_force_x, along_force_y, along_force_z : by the directions of the forces
    pull_x, pull_y, pull_z : force at the end
    misaligned : largest component of |F| u - F, for the force F and the direction u of a segment
    """

    x: Any
    y: Any
    z: Any
    along_force_x: Any
    along_force_y: Any
    along_force_z: Any
    pull_x: Any
    pull_y: Any
    pull_z: Any
    misaligned: Any


@inlined
def _cable_end(net, load, EA, c, H, delta, u, C):
    """End of cable c relative to its start for a force H at its start, with the directions u of its segments.

    Writes the flexibility (9,) of the linearised cable to C. Returns the `CableEnd`.
    """
    count, node, L0, first = (
        net.cable[c, CABLE_SEGMENTS],
        net.cable[c, CABLE_FIRST_NODE],
        net.axial[c, AXIAL_L0],
        net.cable[c, CABLE_FIRST_SEGMENT],
    )
    fx, fy, fz = H[0], H[1], H[2]
    x = y = z = xf = yf = zf = off = 0.0
    per_EA = 1.0 / EA[c]
    cxx, cxy, cxz, cyy, cyz, czz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(count):
        size = (fx * fx + fy * fy + fz * fz + delta * delta) ** 0.5
        per_F = 1.0 / size
        ux, uy, uz = u[first + j, 0], u[first + j, 1], u[first + j, 2]
        gx, gy, gz = per_F * fx, per_F * fy, per_F * fz
        off = max(off, abs(fx - size * ux), abs(fy - size * uy), abs(fz - size * uz))
        x, y, z = x + ux + per_EA * fx, y + uy + per_EA * fy, z + uz + per_EA * fz
        xf, yf, zf = xf + gx + per_EA * fx, yf + gy + per_EA * fy, zf + gz + per_EA * fz
        cxx += per_EA + per_F * (1.0 - ux * gx)
        cyy += per_EA + per_F * (1.0 - uy * gy)
        czz += per_EA + per_F * (1.0 - uz * gz)
        cxy -= 0.5 * per_F * (ux * gy + gx * uy)
        cxz -= 0.5 * per_F * (ux * gz + gx * uz)
        cyz -= 0.5 * per_F * (uy * gz + gy * uz)
        if j < count - 1:
            fx, fy, fz = fx - load[node + j, 0], fy - load[node + j, 1], fz - load[node + j, 2]
    C[0], C[1], C[2] = L0 * cxx, L0 * cxy, L0 * cxz
    C[3], C[4], C[5] = L0 * cxy, L0 * cyy, L0 * cyz
    C[6], C[7], C[8] = L0 * cxz, L0 * cyz, L0 * czz
    return CableEnd(L0 * x, L0 * y, L0 * z, L0 * xf, L0 * yf, L0 * zf, fx, fy, fz, off)


@inlined
def _turn(net, load, c, H, change, length, delta, u):
    """Add the Newton step of the directions u of cable c's segments that belongs to a ``change`` of the force at its start."""
    count, node, first = net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE], net.cable[c, CABLE_FIRST_SEGMENT]
    fx, fy, fz = H[0], H[1], H[2]
    dx, dy, dz = length * change[0], length * change[1], length * change[2]
    for j in range(count):
        per_F = (fx * fx + fy * fy + fz * fz + delta * delta) ** -0.5
        ux, uy, uz = u[first + j, 0], u[first + j, 1], u[first + j, 2]
        gx, gy, gz = per_F * fx, per_F * fy, per_F * fz
        # symmetrised as in _cable_end, so that the directions close the cable as the step of the forces meant
        ud, gd = 0.5 * (ux * dx + uy * dy + uz * dz), 0.5 * (gx * dx + gy * dy + gz * dz)
        ux = ux + length * (gx - ux) + per_F * (dx - ux * gd - gx * ud)
        uy = uy + length * (gy - uy) + per_F * (dy - uy * gd - gy * ud)
        uz = uz + length * (gz - uz) + per_F * (dz - uz * gd - gz * ud)
        shorten = 1.0 / max(1.0, (ux * ux + uy * uy + uz * uz) ** 0.5)
        u[first + j, 0], u[first + j, 1], u[first + j, 2] = shorten * ux, shorten * uy, shorten * uz
        if j < count - 1:
            fx, fy, fz = fx - load[node + j, 0], fy - load[node + j, 1], fz - load[node + j, 2]


@internal
def _gather(net, load, EA, H, delta, q, u, stiffness, gap, flat):
    """Linearise at forces H: write the gap and the stiffness of each cable, and the equations of the free points.

    Returns the largest gap over a cable's length, the largest out-of-balance force, the largest difference of |F| u and F, and the
    largest force and length that occur, to which rounding is relative.
    """
    block, right = net.points.block, net.right_side
    block[:] = 0.0
    for i in range(net.n_interior, net.n_free):
        for x in range(3):
            right[i, x] = load[i, x]
    closing, off, force, reach = 0.0, 0.0, 0.0, 0.0
    for c in range(net.cable.shape[0]):
        start, end = net.cable[c, CABLE_START], net.cable[c, CABLE_END]
        reached = _cable_end(net, load, EA, c, H[c], delta, u, flat)
        x, y, z, fx, fy, fz = reached.x, reached.y, reached.z, reached.pull_x, reached.pull_y, reached.pull_z
        off = max(off, reached.misaligned)
        K = elimination.inverse((flat[0], flat[1], flat[2], flat[3], flat[4], flat[5], flat[6], flat[7], flat[8]))
        for i in range(9):
            stiffness[c, i] = K[i]
        rx, ry, rz = x - q[end, 0] + q[start, 0], y - q[end, 1] + q[start, 1], z - q[end, 2] + q[start, 2]
        gap[c, 0], gap[c, 1] = rx + reached.along_force_x - x, ry + reached.along_force_y - y
        gap[c, 2] = rz + reached.along_force_z - z
        size = max(net.axial[c, AXIAL_L0] * net.cable[c, CABLE_SEGMENTS], abs(x), abs(y), abs(z))
        closing, reach = max(closing, max(abs(rx), abs(ry), abs(rz)) / size), max(reach, size)
        force = max(force, abs(fx), abs(fy), abs(fz), max(abs(H[c, 0]), abs(H[c, 1]), abs(H[c, 2])))
        if start < net.n_free:
            right[start, 0] += H[c, 0]
            right[start, 1] += H[c, 1]
            right[start, 2] += H[c, 2]
        if end < net.n_free:
            right[end, 0] -= fx
            right[end, 1] -= fy
            right[end, 2] -= fz
    balance = 0.0
    for i in range(net.n_interior, net.n_free):
        for x in range(3):
            balance = max(balance, abs(right[i, x]))
    for c in range(net.cable.shape[0]):
        start, end, k, r = net.cable[c, CABLE_START], net.cable[c, CABLE_END], stiffness[c], gap[c]
        K = (k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7], k[8])
        kr = elimination.times(K, r[0], r[1], r[2])
        if start < net.n_free:
            junctions.add_block(block[start - net.n_interior], K, 1.0)
            for x in range(3):
                right[start, x] -= kr[x]
        if end < net.n_free:
            junctions.add_block(block[end - net.n_interior], K, 1.0)
            for x in range(3):
                right[end, x] += kr[x]
        if net.cable[c, CABLE_JOINS_FREE_POINTS] == 1:
            junctions.add_block(block[net.cable[c, CABLE_BLOCK_START_END]], K, -1.0)
            junctions.add_block(block[net.cable[c, CABLE_BLOCK_END_START]], K, -1.0)
    return closing, balance, off, force, reach


@njit(
    types.UniTuple(float64, 4)(int64, _f2, _f1, float64, float64, _f2, _f2), cache=True, error_model="numpy", fastmath={"contract"}
)
def solve(net_address, load, EA, scale, tolerance, H, q):
    """Find the forces at the cables' starts and the positions of the free points; overwrite H and q by them.

    Parameters
    ----------
    net_address : int, address of the net
    load : (n, 3) float64 [N], force on every node
    EA : (n_cables,) float64 [N]
    scale : float64 [N], the load that tolerances are relative to
    tolerance : float64, of the gaps over the cables' lengths
    H : (n_cables, 3) float64 [N], force with which a cable pulls its start; any first guess
    q : (n, 3) float64 [m], rows of the points are read and those of the free points written

    Returns
    -------
    closing, balance, noise, iterations : float64
        Largest gap relative to a cable's length; largest out-of-balance force on a free point relative to scale; what rounding of
        the largest tension may leave in that force; Newton iterations.
    """
    net = view_net(net_address)
    cables = net.cable.shape[0]
    stiffness, gap, change, flat = np.zeros((cables, 9)), np.zeros((cables, 3)), np.zeros((cables, 3)), np.zeros(9)
    trial, u = np.zeros(3), net.factor[:, FACTOR_DIRECTION : FACTOR_DIRECTION + 3]
    u[:] = 0.0
    iterations, closing, balance, noise = 0, np.inf, np.inf, 0.0
    delta = 1e-2 * scale
    for rounding in range(ROUNDINGS):
        last = rounding == ROUNDINGS - 1
        enough = tolerance if last else 1e-3
        polished = False
        for _ in range(ITERATIONS):
            closing, balance, off, force, reach = _gather(net, load, EA, H, delta, q, u, stiffness, gap, flat)
            balance /= scale
            noise = 32.0 * EPS * force / scale
            small = 1e-12 + noise
            if balance <= small and closing <= enough and off <= (small if last else 1e-3) * scale:
                if polished or not last:
                    break
                polished = True  # one step more costs little and takes a quadratic iteration to rounding
            iterations += 1
            junctions.solve_points(net_address)
            for i in range(net.n_interior, net.n_free):
                for x in range(3):
                    q[i, x] += net.newton_step[i, x]
            slope, size = 0.0, 0.0
            for c in range(cables):
                start, end, k = net.cable[c, CABLE_START], net.cable[c, CABLE_END], stiffness[c]
                dx, dy, dz = (
                    net.newton_step[end, 0] - net.newton_step[start, 0] - gap[c, 0],
                    net.newton_step[end, 1] - net.newton_step[start, 1] - gap[c, 1],
                    net.newton_step[end, 2] - net.newton_step[start, 2] - gap[c, 2],
                )
                change[c, 0], change[c, 1], change[c, 2] = elimination.times(
                    (k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7], k[8]), dx, dy, dz
                )
                size += abs(change[c, 0]) + abs(change[c, 1]) + abs(change[c, 2])
                slope += change[c, 0] * dx + change[c, 1] * dy + change[c, 2] * dz
            length = 1.0
            if balance <= 1e-9 + noise:
                # On balanced forces the slope of the convex function along the step starts at -slope and grows; a step that
                # overshoots its zero by far is too long.
                while length > 1e-9:
                    now = 0.0
                    for c in range(cables):
                        start, end = net.cable[c, CABLE_START], net.cable[c, CABLE_END]
                        for x in range(3):
                            trial[x] = H[c, x] + length * change[c, x]
                        reached = _cable_end(net, load, EA, c, trial, delta, u, flat)
                        now += (reached.along_force_x - q[end, 0] + q[start, 0]) * change[c, 0]
                        now += (reached.along_force_y - q[end, 1] + q[start, 1]) * change[c, 1]
                        now += (reached.along_force_z - q[end, 2] + q[start, 2]) * change[c, 2]
                    if now <= 0.5 * slope + 8.0 * EPS * size * reach:
                        break
                    length *= 0.5
            for c in range(cables):
                _turn(net, load, c, H[c], change[c], length, delta, u)
                for x in range(3):
                    H[c, x] += length * change[c, x]
        delta *= 1e-2
    return closing, balance, noise, float64(iterations)


@kernel(float64(int64, _f2, _f2, float64, _f2))
def first_guess(net_address, load, q, unloaded_scale, H):
    """Write what `solve` begins with: free points in the middle of the prescribed ones, and a force at each cable's start.

    The force is half of the cable's load, and between held points a force of the same size along its chord; a cable without a load
    is pulled by the scale instead. Arguments are those of `solve`; ``unloaded_scale`` is the scale where nothing is loaded [N].

    Returns
    -------
    total : float64 [N], sum of the loads of the moving nodes, which is the scale unless it is 0
    """
    net, total = view_net(net_address), 0.0
    for i in range(net.n_free):
        total += (load[i, 0] * load[i, 0] + load[i, 1] * load[i, 1] + load[i, 2] * load[i, 2]) ** 0.5
    scale = total if total > 0.0 else unloaded_scale
    for x in range(3):
        middle = 0.0
        for i in range(net.n_free, q.shape[0]):
            middle += q[i, x]
        for i in range(net.n_interior, net.n_free):
            q[i, x] = middle / (q.shape[0] - net.n_free)
    for c in range(net.cable.shape[0]):
        node, start, end = net.cable[c, CABLE_FIRST_NODE], net.cable[c, CABLE_START], net.cable[c, CABLE_END]
        x = y = z = 0.0
        for i in range(node, node + net.cable[c, CABLE_SEGMENTS] - 1):
            x, y, z = x + load[i, 0], y + load[i, 1], z + load[i, 2]
        H[c, 0], H[c, 1], H[c, 2] = 0.5 * x, 0.5 * y, 0.5 * z
        dx, dy, dz = q[end, 0] - q[start, 0], q[end, 1] - q[start, 1], q[end, 2] - q[start, 2]
        span, own = (dx * dx + dy * dy + dz * dz) ** 0.5, (x * x + y * y + z * z) ** 0.5
        if start >= net.n_free and end >= net.n_free and span > 0.0:
            pull = 0.5 * (own if own > 0.0 else scale) / span
            H[c, 0], H[c, 1], H[c, 2] = H[c, 0] + pull * dx, H[c, 1] + pull * dy, H[c, 2] + pull * dz
    return total


@kernel(types.UniTuple(float64, 2)(int64, _f2, _f1, _f2, _f2, _f1))
def unroll(net_address, load, EA, H, q, tension):
    """Positions of the interior nodes and tensions of the segments for the forces H, right after `solve`.

    Returns
    -------
    least, sum_of_all : float64 [N]
        The least tension; and a sum of all numbers, which is finite only if each of them is.
    """
    net, least, sum_of_all = view_net(net_address), np.inf, 0.0
    for c in range(net.cable.shape[0]):
        first, count, node, L0 = (
            net.cable[c, CABLE_FIRST_SEGMENT],
            net.cable[c, CABLE_SEGMENTS],
            net.cable[c, CABLE_FIRST_NODE],
            net.axial[c, AXIAL_L0],
        )
        start = net.cable[c, CABLE_START]
        fx, fy, fz = H[c, 0], H[c, 1], H[c, 2]
        x, y, z = q[start, 0], q[start, 1], q[start, 2]
        for j in range(count):
            F = (fx * fx + fy * fy + fz * fz) ** 0.5
            tension[first + j] = F
            least, sum_of_all = min(least, F), sum_of_all + F
            if j < count - 1:
                u, stretch = net.factor[first + j, FACTOR_DIRECTION : FACTOR_DIRECTION + 3], L0 / EA[c]
                x, y, z = x + L0 * u[0] + stretch * fx, y + L0 * u[1] + stretch * fy, z + L0 * u[2] + stretch * fz
                i = node + j
                q[i, 0], q[i, 1], q[i, 2] = x, y, z
                sum_of_all += x + y + z
                fx, fy, fz = fx - load[i, 0], fy - load[i, 1], fz - load[i, 2]
    for i in range(net.n_interior, q.shape[0]):
        sum_of_all += q[i, 0] + q[i, 1] + q[i, 2]
    return least, sum_of_all
