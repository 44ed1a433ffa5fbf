"""Forces, slopes, energy and added mass of water on the segments and points of a scene: what `Water` compiles.

The equations are in the module `effects.water`. Each function is copied into two kernels: one for water that moves, whose
``motion`` are the numbers of current and waves, and one for water at rest, whose ``motion`` is an empty tuple, see `moving_water`
and `still_water`. So what the motion of the water needs is left out of the latter when it is compiled.
"""

from anet_lumped.compiled.jit import inlined_law
from anet_lumped.effects.flow.surface import flow_at, height_at
from anet_lumped.effects.laws.drag import subtract_multiple, subtract_point_slopes, subtract_segment_slopes, tangent_of
from anet_lumped.effects.laws.morison import add_mass, point_force, segment_force, subtract_inertia_slopes
from anet_lumped.effects.laws.over_a_step import middle_of
from anet_lumped.effects.laws.submergence import point_share, point_share_between, wetted, wetted_between

HEADER, SEGMENT_NUMBERS, POINT_NUMBERS = 3, 8, 5  # numbers in ``params`` before all others, of each segment and of each point


@inlined_law
def wave_at(params):
    """Position in ``params`` at which the numbers of the waves begin, and those of the current end, which begin at `HEADER`."""
    return HEADER + int(params[1])


@inlined_law
def segments_at(params):
    """Position in ``params`` at which the numbers of the segments begin, and those of the waves end."""
    return wave_at(params) + int(params[2])


@inlined_law
def _has_waves(motion):
    if len(motion) == 0:
        return False
    return len(motion[1]) > 0


@inlined_law
def _row(q, i):
    return q[i, 0], q[i, 1], q[i, 2]


@inlined_law
def _difference(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined_law
def _relative(u, v):
    """Velocity u of the water, an empty tuple at rest, less a velocity v."""
    if len(u) == 0:
        return -v[0], -v[1], -v[2]
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


@inlined_law
def _force_on_end(flow, V, t, numbers):
    return segment_force(_relative(flow[2], V), flow[4], t, numbers[2], numbers[3], numbers[5], numbers[6], numbers[7])


@inlined_law
def _force_on_point(flow, V, numbers):
    return point_force(_relative(flow[2], V), flow[4], numbers[1], numbers[3], numbers[4])


@inlined_law
def _add(f, i, w, force, lift, V, lift_counts):
    """Add w times a force and a lift along z to the force on a node; return the power that they take [W].

    The lift of still water takes none, because it has an energy: ``lift_counts`` is False.
    """
    lift_force = w * (force[2] + lift)
    f[i, 0] += w * force[0]
    f[i, 1] += w * force[1]
    f[i, 2] += lift_force
    vertical = lift_force if lift_counts else w * force[2]
    return -(w * (force[0] * V[0] + force[1] * V[1]) + vertical * V[2])


@inlined_law
def force_of(t, q, v, index, params, f, motion):
    """Add the force on both nodes of every segment and on points; return the power that those without an energy take, -f.v [W]."""
    level, begin, segments, waves, power = params[0], segments_at(params), index[0], _has_waves(motion), 0.0
    last, flow_i = -1, flow_at(t, (0.0, 0.0, 0.0), level, motion)
    flow_j = flow_i
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        flow_i = flow_j if i == last else flow_at(t, _row(q, i), level, motion)
        flow_j, last = flow_at(t, _row(q, j), level, motion), j
        _, w1, w2, _, _, _ = wetted(flow_i[0], flow_j[0], numbers[1])
        if w1 + w2 == 0.0:
            continue
        d, v1, v2 = _difference(_row(q, j), _row(q, i)), _row(v, i), _row(v, j)
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        power += _add(f, i, w1, _force_on_end(flow_i, v1, (tx, ty, tz), numbers), numbers[4], v1, waves)
        power += _add(f, j, w2, _force_on_end(flow_j, v2, (tx, ty, tz), numbers), numbers[4], v2, waves)
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        flow, V = flow_at(t, _row(q, node), level, motion), _row(v, node)
        w, _, _ = point_share(flow[0], numbers[0])
        power += _add(f, node, w, _force_on_point(flow, V, numbers), numbers[2], V, waves)
    return power


@inlined_law
def _subtract_share_slope(block, force, lift, slope, up):
    """Subtract (force + lift e_z) slope up^T from a block, the part of a tangent that is due to the change of the submerged share.

    ``slope`` is that of the share in the height [1/m], ``up`` that of the height in the position.
    """
    for y in range(3):
        block[0, y] -= slope * force[0] * up[y]
        block[1, y] -= slope * force[1] * up[y]
        block[2, y] -= slope * (force[2] + lift) * up[y]


@inlined_law
def _segment_slopes(s, i, j, flow_i, flow_j, v1, v2, t, per_l, wet, lift, numbers, c_q, c_v, D, near):
    """Subtract the slopes of the force on both nodes of a segment; ``lift`` [N] is the part of its buoyancy that w multiplies."""
    if i < D.shape[0]:
        shares = wet[1], wet[3], wet[4]
        _end_slopes(-1.0, flow_i, flow_j[1], v1, t, per_l, shares, lift, numbers, c_q, c_v, D[i], near[s, 0])
    if j < D.shape[0]:
        shares = wet[2], wet[5], wet[4]
        _end_slopes(1.0, flow_j, flow_i[1], v2, t, per_l, shares, lift, numbers, c_q, c_v, D[j], near[s, 1])


@inlined_law
def _end_slopes(side, flow, other_up, V, t, per_l, shares, lift, numbers, c_q, c_v, own, other):
    """Subtract the slopes of the force on the node at one end of a segment; ``shares`` are its w and the slopes of that [1/m]."""
    u, (w, k, k_other) = _relative(flow[2], V), shares
    subtract_segment_slopes(u, flow[3], t, per_l, w * numbers[2], w * numbers[3], side, c_q, c_v, own, other)
    subtract_inertia_slopes(flow[4], flow[5], t, per_l, w * numbers[5], numbers[6], numbers[7], side, c_q, own, other)
    if k != 0.0 or k_other != 0.0:
        F = _force_on_end(flow, V, t, numbers)
        _subtract_share_slope(own, F, lift, c_q * k, flow[1])
        _subtract_share_slope(other, F, lift, c_q * k_other, other_up)


@inlined_law
def _point_slopes(node, flow, V, wet, lift, numbers, c_q, c_v, D):
    """Subtract the slopes of the force on a point; ``lift`` as for a segment."""
    w, slope, _ = wet
    subtract_point_slopes(_relative(flow[2], V), flow[3], w * numbers[1], c_q, c_v, D[node])
    subtract_multiple(c_q * w * numbers[3] * (1.0 + numbers[4]), flow[5], D[node])
    _subtract_share_slope(D[node], _force_on_point(flow, V, numbers), lift, c_q * slope, flow[1])


@inlined_law
def subtract_slopes(t, q, v, index, params, c_q, c_v, D, near, motion):
    """Subtract the exact slopes of `force_of`, including those of the water's velocity and acceleration with the position."""
    level, begin, segments, last = params[0], segments_at(params), index[0], -1
    flow_i = flow_at(t, (0.0, 0.0, 0.0), level, motion)
    flow_j = flow_i
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        flow_i = flow_j if i == last else flow_at(t, _row(q, i), level, motion)
        flow_j, last = flow_at(t, _row(q, j), level, motion), j
        wet = wetted(flow_i[0], flow_j[0], numbers[1])
        if wet[1] + wet[2] == 0.0:
            continue
        d = _difference(_row(q, j), _row(q, i))
        tx, ty, tz, per_l = tangent_of(d[0], d[1], d[2], numbers[0])
        _segment_slopes(
            s, i, j, flow_i, flow_j, _row(v, i), _row(v, j), (tx, ty, tz), per_l, wet, numbers[4], numbers, c_q, c_v, D, near
        )
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        flow = flow_at(t, _row(q, node), level, motion)
        _point_slopes(node, flow, _row(v, node), point_share(flow[0], numbers[0]), numbers[2], numbers, c_q, c_v, D)


@inlined_law
def energy_of(q, index, params, motion):
    """-sum rho g V e of the segments and -sum rho g V H of the points, see `submergence` [J]; none in a wave."""
    level, begin, segments, total = params[0], segments_at(params), index[0], 0.0
    if _has_waves(motion):
        return 0.0
    for s in range(segments):
        numbers = params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        total -= numbers[4] * wetted(q[index[1 + 2 * s], 2] - level, q[index[2 + 2 * s], 2] - level, numbers[1])[0]
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        numbers = params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        total -= numbers[2] * point_share(q[index[1 + 2 * segments + p], 2] - level, numbers[0])[2]
    return total


@inlined_law
def _mean_velocity(base, q, i, per_h):
    return per_h * (q[i, 0] - base[i, 0]), per_h * (q[i, 1] - base[i, 1]), per_h * (q[i, 2] - base[i, 2])


@inlined_law
def _lift_over_step(s, i, j, level, base, q, numbers, f, D, near):
    """Add the buoyancy of a segment in still water over a whole step, and its derivative."""
    g1, g2, s11, s12, s21, s22 = wetted_between(
        base[i, 2] - level, base[j, 2] - level, q[i, 2] - level, q[j, 2] - level, numbers[1]
    )  # fmt: skip
    lift = numbers[4]
    f[i, 2] += lift * g1
    f[j, 2] += lift * g2
    if i < D.shape[0]:
        D[i, 2, 2] -= lift * s11
        near[s, 0, 2, 2] -= lift * s12
    if j < D.shape[0]:
        D[j, 2, 2] -= lift * s22
        near[s, 1, 2, 2] -= lift * s21


@inlined_law
def force_over_step(t, h, base, q, index, params, f, D, near, motion):
    """Force over a whole step, and its exact derivative.

    It is `force_of` at the middle of the step, apart from the buoyancy of still water: that takes the weights of `wetted_between`,
    so that its work is the change of its energy. The work of all other forces counts as dissipated; in water at rest it is never
    negative.
    """
    level, begin, segments, waves, per_h = params[0], segments_at(params), index[0], _has_waves(motion), 1.0 / h
    dissipated, last = 0.0, -1
    flow_i = flow_at(t, (0.0, 0.0, 0.0), level, motion)
    flow_j = flow_i
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        q1, q2 = middle_of(base, q, i), middle_of(base, q, j)
        flow_i = flow_j if i == last else flow_at(t, q1, level, motion)
        flow_j, last = flow_at(t, q2, level, motion), j
        v1, v2, d, lift = _mean_velocity(base, q, i, per_h), _mean_velocity(base, q, j, per_h), _difference(q2, q1), numbers[4]
        wet = wetted(flow_i[0], flow_j[0], numbers[1])
        if not waves:
            _lift_over_step(s, i, j, level, base, q, numbers, f, D, near)
            lift = 0.0
        if wet[1] + wet[2] == 0.0:
            continue
        tx, ty, tz, per_l = tangent_of(d[0], d[1], d[2], numbers[0])
        _segment_slopes(s, i, j, flow_i, flow_j, v1, v2, (tx, ty, tz), per_l, wet, lift, numbers, 0.5, per_h, D, near)
        dissipated += h * _add(f, i, wet[1], _force_on_end(flow_i, v1, (tx, ty, tz), numbers), lift, v1, True)
        dissipated += h * _add(f, j, wet[2], _force_on_end(flow_j, v2, (tx, ty, tz), numbers), lift, v2, True)
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        flow, V, lift = flow_at(t, middle_of(base, q, node), level, motion), _mean_velocity(base, q, node, per_h), numbers[2]
        if not waves:
            g, slope = point_share_between(base[node, 2] - level, q[node, 2] - level, numbers[0])
            f[node, 2] += lift * g
            D[node, 2, 2] -= lift * slope
            lift = 0.0
        wet = point_share(flow[0], numbers[0])
        _point_slopes(node, flow, V, wet, lift, numbers, 0.5, per_h, D)
        dissipated += h * _add(f, node, wet[0], _force_on_point(flow, V, numbers), lift, V, True)
    return dissipated, 0.0


@inlined_law
def add_masses(t, q, index, params, A, motion):
    """Add the added masses of segments and points."""
    level, begin, segments, last, z1, z2 = params[0], segments_at(params), index[0], -1, 0.0, 0.0
    for s in range(segments):
        i, j, numbers = index[1 + 2 * s], index[2 + 2 * s], params[begin + SEGMENT_NUMBERS * s : begin + SEGMENT_NUMBERS * (s + 1)]
        z1 = z2 if i == last else height_at(t, q, i, level, motion)
        z2, last = height_at(t, q, j, level, motion), j
        _, w1, w2, _, _, _ = wetted(z1, z2, numbers[1])
        if w1 + w2 == 0.0:
            continue
        d = _difference(_row(q, j), _row(q, i))
        tx, ty, tz, _ = tangent_of(d[0], d[1], d[2], numbers[0])
        if i < A.shape[0]:
            add_mass(w1 * numbers[5], numbers[6], numbers[7], (tx, ty, tz), A[i])
        if j < A.shape[0]:
            add_mass(w2 * numbers[5], numbers[6], numbers[7], (tx, ty, tz), A[j])
    begin += SEGMENT_NUMBERS * segments
    for p in range(index.shape[0] - 1 - 2 * segments):
        node, numbers = index[1 + 2 * segments + p], params[begin + POINT_NUMBERS * p : begin + POINT_NUMBERS * (p + 1)]
        m = point_share(height_at(t, q, node, level, motion), numbers[0])[0] * numbers[3] * numbers[4]
        A[node, 0, 0] += m
        A[node, 1, 1] += m
        A[node, 2, 2] += m
