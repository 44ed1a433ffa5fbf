"""The system of the links of a net, S tau = r: symmetric elimination along the cables, then over the end links.

With the signs c_la = -1 at the first node of a link and c_lb = +1 at its second, S_lk is the sum of c_li c_ki d_l . W_i d_k over
the nodes i that both links have. Links that end at one body have S_lk = +- d_l . W_ij d_k with the nodes i and j of the body at
which they do, see `bodies`. `model.link_order` says in which order links are eliminated. Every entry is a number: there are no
blocks.
"""

from anet_lumped.compiled.jit import inlined, internal
from anet_lumped.mechanics.linear.node_elimination import times
from anet_lumped.mechanics.optional import as_meet_bodies, as_pull_bodies
from anet_lumped.model.tables import (
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    END_LINK_FIRST,
    END_LINK_LAST,
    END_LINKS_ENTRY,
    KERNEL_MEET_BODIES,
    KERNEL_PULL_BODIES,
    MEETING_ENTRY,
    MEETING_FIRST,
    MEETING_NODE,
    MEETING_SECOND,
    MEETING_SIGN,
)
from integrators.flat_view import flat

REDUNDANT = 1e-10  # of a diagonal entry: a pivot below that says that the link's length follows from other lengths


@inlined
def mobile(net, i, x, y, z):
    """W_i (x, y, z) of a node; zero for one that is prescribed."""
    links = net.links
    if links.matrix_mobility.shape[0] > 0:
        first = net.n_free - links.matrix_mobility.shape[0]
        if i >= net.n_free:
            return 0.0, 0.0, 0.0
        if i >= first:
            W = flat(links.matrix_mobility[i - first])
            return times((W[0], W[1], W[2], W[3], W[4], W[5], W[6], W[7], W[8]), x, y, z)
    w = links.mobility[i]
    return w * x, w * y, w * z


@inlined
def _change(net, x, i, fx, fy, fz):
    """Add W_i f to the vector of a node; a force on a body waits for `bodies.pull_bodies`."""
    if net.bodies.first <= i < net.n_free:
        pull = net.links.body_pull[i - net.bodies.first]
        pull[0], pull[1], pull[2] = pull[0] + fx, pull[1] + fy, pull[2] + fz
        return
    dx, dy, dz = mobile(net, i, fx, fy, fz)
    x[i, 0], x[i, 1], x[i, 2] = x[i, 0] + dx, x[i, 1] + dy, x[i, 2] + dz


@internal
def _factor_end_links(links):
    """Factor the system of the end links, L D L^T; returns how many of them are redundant."""
    end_pivot, entry, redundant = links.end_pivot, links.entry, 0
    for u in range(end_pivot.shape[0]):
        if end_pivot[u] > REDUNDANT * links.diagonal[links.segment[u]]:
            end_pivot[u] = 1.0 / end_pivot[u]
        else:
            end_pivot[u] = 0.0
            redundant += 1 if links.diagonal[links.segment[u]] > 0.0 else 0  # see `bodies`: 0 is of a link that nothing can move
        first, last, target = links.later_at[u], links.later_at[u + 1], links.target_at[u]
        for i in range(first, last):
            share = entry[i] * end_pivot[u]
            end_pivot[links.later[i]] -= share * entry[i]
            for j in range(i + 1, last):
                entry[links.target[target]] -= share * entry[j]
                target += 1
            entry[i] = share
    return redundant


@internal
def factor(net, q, shift):
    """Factor S at the places q; its diagonal is multiplied by 1 + ``shift``.

    A positive shift makes redundant constraints solvable: as it goes to zero the tensions tend to those of which the sum of
    S_ll tau_l^2 is smallest.

    Returns
    -------
    redundant : int64
        Pivots of no more than `REDUNDANT` of their diagonal entry; such a link is left without tension.
    """
    links, redundant = net.links, 0
    vector, diagonal, pivot, to_next, to_start = links.vector, links.diagonal, links.pivot, links.to_next, links.to_start
    end_pivot, entry = links.end_pivot, links.entry
    for u in range(end_pivot.shape[0]):
        end_pivot[u] = 0.0
    for k in range(entry.shape[0]):
        entry[k] = 0.0
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        u, w = links.unknown[c, END_LINK_FIRST], links.unknown[c, END_LINK_LAST]
        a, x0, y0, z0, per_pivot, border = net.cable[c, CABLE_START], 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(count):
            b, s = node + j if j < count - 1 else net.cable[c, CABLE_END], first + j
            x, y, z = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1], q[b, 2] - q[a, 2]
            xa, ya, za = mobile(net, a, x, y, z)
            xb, yb, zb = mobile(net, b, x, y, z)
            own = x * (xa + xb) + y * (ya + yb) + z * (za + zb)
            vector[s, 0], vector[s, 1], vector[s, 2], diagonal[s] = x, y, z, own
            value, off = own * (1.0 + shift), -(x0 * xa + y0 * ya + z0 * za)
            if u >= 0 and j == 1:
                border = off
            elif j > 0:
                share = off * per_pivot
                to_next[s - 1] = share
                value -= share * off
                border = -share * border
            if u >= 0 and j == 0:
                end_pivot[u] += value
            elif w >= 0 and j == count - 1:
                end_pivot[w] += value
                if u >= 0:
                    entry[links.unknown[c, END_LINKS_ENTRY]] += border
            else:
                if value > REDUNDANT * own:
                    per_pivot = 1.0 / value
                else:
                    per_pivot = 0.0
                    redundant += 1 if own > 0.0 else 0  # one of own = 0 joins two prescribed points
                pivot[s] = per_pivot
                if u >= 0:
                    to_start[s] = border * per_pivot
                    end_pivot[u] -= to_start[s] * border
            a, x0, y0, z0 = b, x, y, z
    for k in range(links.meeting.shape[0]):
        row = links.meeting[k]
        d, e = vector[row[MEETING_FIRST]], vector[row[MEETING_SECOND]]
        x, y, z = mobile(net, row[MEETING_NODE], d[0], d[1], d[2])
        entry[row[MEETING_ENTRY]] += row[MEETING_SIGN] * (e[0] * x + e[1] * y + e[2] * z)
    if net.bodies.first < net.n_free:
        as_meet_bodies(net.kernels[KERNEL_MEET_BODIES])(net.address)
    return redundant + _factor_end_links(links)


@internal
def _solve_end_links(links):
    """Solve for the end links, in ``links.right_side``."""
    right_side, segment, later, entry = links.right_side, links.segment, links.later, links.entry
    count = segment.shape[0]
    for u in range(count):
        r = right_side[segment[u]]
        for i in range(links.later_at[u], links.later_at[u + 1]):
            right_side[segment[later[i]]] -= entry[i] * r
    for k in range(count):
        u = count - 1 - k
        tau = right_side[segment[u]] * links.end_pivot[u]
        for i in range(links.later_at[u], links.later_at[u + 1]):
            tau -= entry[i] * right_side[segment[later[i]]]
        right_side[segment[u]] = tau


@internal
def solve(net, x):
    """Change a field of vectors x (n, 3) on the moving nodes, such as accelerations, so that d . (x_b - x_a) has given values.

    x_i changes by W_i times the sum of +- tau d. Of all such changes that is the smallest one, measured by the masses.

    Parameters
    ----------
    net : Net
        Factored. ``links.right_side`` (n_segments,) holds the values, and then tau.
    x : (n, 3) float64
    """
    links = net.links
    vector, right_side, to_next, to_start = links.vector, links.right_side, links.to_next, links.to_start
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        u, w = links.unknown[c, END_LINK_FIRST], links.unknown[c, END_LINK_LAST]
        a, before, of_start = net.cable[c, CABLE_START], 0.0, 0.0
        for j in range(count):
            b, s = node + j if j < count - 1 else net.cable[c, CABLE_END], first + j
            d, xa, xb = vector[s], x[a], x[b]
            r = d[0] * (xb[0] - xa[0]) + d[1] * (xb[1] - xa[1]) + d[2] * (xb[2] - xa[2]) - right_side[s]
            if j > 1 or (j == 1 and u < 0):
                r -= to_next[s - 1] * before
            right_side[s] = r
            if u >= 0 and j > 0 and (j < count - 1 or w < 0):
                of_start += to_start[s] * r
            a, before = b, r
        if u >= 0:
            right_side[first] -= of_start
    _solve_end_links(links)
    for c in range(net.cable.shape[0]):
        first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
        u, w = links.unknown[c, END_LINK_FIRST], links.unknown[c, END_LINK_LAST]
        b, tau, at_start = net.cable[c, CABLE_END], 0.0, right_side[first] if u >= 0 else 0.0
        px, py, pz = 0.0, 0.0, 0.0  # pull of the link behind node b on it
        for k in range(count):
            j = count - 1 - k
            s = first + j
            if (u >= 0 and j == 0) or (w >= 0 and j == count - 1):
                tau = right_side[s]
            else:
                tau = right_side[s] * links.pivot[s] - (to_next[s] * tau if j < count - 1 else 0.0)
                if u >= 0:
                    tau -= to_start[s] * at_start
                right_side[s] = tau
            fx, fy, fz = tau * vector[s, 0], tau * vector[s, 1], tau * vector[s, 2]
            _change(net, x, b, px - fx, py - fy, pz - fz)
            b, px, py, pz = node + j - 1 if j > 0 else net.cable[c, CABLE_START], fx, fy, fz
        _change(net, x, b, px, py, pz)
    if net.bodies.first < net.n_free:
        as_pull_bodies(net.kernels[KERNEL_PULL_BODIES])(net.address, x)
