"""Force of the segments of trails, four at once."""

import math

from anet_lumped.compiled.jit import on_demand
from anet_lumped.compiled.lanes import WIDTH, add_three, group_members, load_three, sum_of_lanes
from anet_lumped.compiled.rows_of_lanes import load_row
from anet_lumped.effects.laws.axial import Spring, tension_parts
from anet_lumped.mechanics.segment_law import SHORTEST
from anet_lumped.model.net import view_net
from integrators.flat_view import flat


@on_demand
def force_of_trails(net_address, q, v, f):
    """Add the force of the cables along trails to f; return the power that their dampers dissipate [W].

    See `force.force` for the law, and `model.trails` for trails. Members of a group may meet at a node: forces are added to it one
    after the other.
    """
    net, dissipated = view_net(net_address), 0.0
    trails, flat_q, flat_v, flat_f = net.trails, flat(q), flat(v), flat(f)
    number = flat(trails.number)
    for g in range(trails.run.shape[0]):
        first, push_share, two_way_damper = trails.run[g, 0], trails.law[g, 0], trails.law[g, 1]
        behind = group_members(trails.position, first)
        q0, v0 = load_three(flat_q, behind), load_three(flat_v, behind)
        taken = 0.0 * q0[0]
        pull_behind = taken, taken, taken
        for row in range(first + 1, first + 1 + trails.run[g, 1]):
            ahead, at = group_members(trails.position, row), 3 * WIDTH * row
            q1, v1 = load_three(flat_q, ahead), load_three(flat_v, ahead)
            L0, k, c = load_row(number, at), load_row(number, at + WIDTH), load_row(number, at + 2 * WIDTH)
            dx, dy, dz = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
            l = math.sqrt(dx * dx + dy * dy + dz * dz)
            per_l = 1.0 / max(l, SHORTEST * L0)
            rate = (dx * (v1[0] - v0[0]) + dy * (v1[1] - v0[1]) + dz * (v1[2] - v0[2])) * per_l
            T, elastic = tension_parts(l - L0, rate, Spring(k, push_share, L0, net.springs, 0, 0), c, two_way_damper)
            taken = taken + (T - elastic) * rate
            tension_per_length = T * per_l
            pull = tension_per_length * dx, tension_per_length * dy, tension_per_length * dz
            add_three(flat_f, behind, (pull[0] - pull_behind[0], pull[1] - pull_behind[1], pull[2] - pull_behind[2]))
            behind, q0, v0, pull_behind = ahead, q1, v1, pull
        add_three(flat_f, behind, (-pull_behind[0], -pull_behind[1], -pull_behind[2]))
        dissipated += sum_of_lanes(taken)
    return dissipated
