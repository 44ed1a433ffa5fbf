"""Ball joints between bodies outside a Newton step: they keep velocities, accelerations and places together.

A joint pulls with the force f at a node of the body that is pinned, and with -f at a node of the other one. A pull on node l of a
body gives its node k the acceleration W_kl f, see `mechanics.links.bodies`. So that the points of all joints move alike,

    sum over joints m of (+-W_jm) f_m = g_j ,

with the difference g_j between what the other body's point has and what the own point has: of velocities, f is an impulse; of
places, to first order in the turns, what shifts and turns the bodies by the least sum m |d|^2; of accelerations, f is the force of
the joint. Impulses act at one place on both bodies, so that momenta stay, and what they take is the kinetic energy of the
difference.
"""

from numba import float64, int64, types

from anet_lumped.compiled.jit import inlined, internal, kernel, on_demand
from anet_lumped.mechanics.drive import evaluate_driven
from anet_lumped.mechanics.linear.junctions import solve_blocks
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    BODY_AS_PREDICTED,
    JOINT_BODY,
    JOINT_FIRST,
    JOINT_FIRST_SECOND,
    JOINT_OTHER,
    JOINT_OTHER_NODE,
    JOINT_POSITION,
    JOINT_SECOND,
    JOINT_SECOND_FIRST,
    JOINTED_FORCE,
    JOINTED_INERTIA,
    JOINTED_MOMENT,
    JOINTED_REFERENCE,
    JOINTED_SPIN,
)
from integrators.stage import LAW_BETWEEN

from .free_motion import acceleration_at, pulled, put_inertial_forces
from .inertia import NO_MATRIX, Inertia, moved_by
from .rotation import reference_of
from .settling import stiffen_body
from .shape import keep_shape
from .stage import NO_VECTOR, out_of_balance, pass_to_other
from .vectors import added, cross, dot, inertia_of, minus, nine, plus, put, put_three, row, scaled, three, turned

_f2 = float64[:, ::1]

CLOSINGS = 3  # of joints that a step has left open by what it leaves out; each leaves about the square of what it finds


@inlined
def _put_inertia(net, b, reference, inertia):
    """Keep reference point and `Inertia` of a body, without a force on it."""
    own = net.bodies.jointed[b]
    put_three(own, JOINTED_REFERENCE, reference)
    for x in range(9):
        own[JOINTED_INERTIA + x], own[JOINTED_INERTIA + 9 + x] = inertia.per_mass[x], inertia.carried[x]
        own[JOINTED_INERTIA + 18 + x] = inertia.turning[x]
    put_three(own, JOINTED_FORCE, NO_VECTOR)
    put_three(own, JOINTED_MOMENT, NO_VECTOR)


@inlined
def _inertia(own):
    """The `Inertia` that a row of ``bodies.jointed`` holds."""
    at = JOINTED_INERTIA
    return Inertia(nine(own, at), nine(own, at + 9), nine(own, at + 18))


@inlined
def _moved(own):
    """Shift and turn of a body by the force and moment on it."""
    return moved_by(_inertia(own), three(own, JOINTED_FORCE), three(own, JOINTED_MOMENT))


@internal
def _put_inertias(net_address, q):
    """Keep the inertia of all bodies at the places q, by the masses of their nodes alone."""
    net = view_net(net_address)
    bodies = net.bodies
    for b in range(bodies.pivot.shape[0]):
        (mass, reference), J = reference_of(net, b, q), NO_MATRIX
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            J = added(J, inertia_of(net.mass[i], minus(row(q, i), reference)))
        w = 1.0 / mass if bodies.pivot[b] < 0 else 0.0
        _put_inertia(net, b, reference, Inertia((w, 0.0, 0.0, 0.0, w, 0.0, 0.0, 0.0, w), NO_MATRIX, J))


@inlined
def _add_mobility(net, block, b, at_k, at_l, sign, q):
    """Add +-W_kl of body b to a block, by the positions of both nodes in ``bodies.node``."""
    bodies, own = net.bodies, net.bodies.jointed[b]
    reference = three(own, JOINTED_REFERENCE)
    arm_k, arm_l = minus(row(q, bodies.node[at_k]), reference), minus(row(q, bodies.node[at_l]), reference)
    for y in range(3):
        f = 1.0 if y == 0 else 0.0, 1.0 if y == 1 else 0.0, 1.0 if y == 2 else 0.0
        shift, turn = moved_by(_inertia(own), f, cross(arm_l, f))
        a = plus(shift, cross(turn, arm_k))
        block[0, y] += sign * a[0]
        block[1, y] += sign * a[1]
        block[2, y] += sign * a[2]


@internal
def _pull_together(net_address, q):
    """Solve for the forces of joints that make up for ``bodies.joint_gap``; add them to the forces and moments on bodies."""
    net = view_net(net_address)
    bodies, block = net.bodies, net.joints.block
    for p in range(block.shape[0]):
        for x in range(3):
            for y in range(3):
                block[p, x, y] = 0.0
    for j in range(bodies.joint.shape[0]):
        joint = bodies.joint[j]
        for side in range(2):
            if joint[JOINT_BODY + side] >= 0:
                at = joint[JOINT_POSITION + side]
                _add_mobility(net, block[j], joint[JOINT_BODY + side], at, at, 1.0, q)
    for p in range(bodies.joint_pairs.shape[0]):
        pair = bodies.joint_pairs[p]
        first, second = bodies.joint[pair[JOINT_FIRST]], bodies.joint[pair[JOINT_SECOND]]
        for one in range(2):
            for other in range(2):
                b = first[JOINT_BODY + one]
                if b >= 0 and b == second[JOINT_BODY + other]:
                    k, l, sign = first[JOINT_POSITION + one], second[JOINT_POSITION + other], 1.0 if one == other else -1.0
                    _add_mobility(net, block[pair[JOINT_FIRST_SECOND]], b, k, l, sign, q)
                    _add_mobility(net, block[pair[JOINT_SECOND_FIRST]], b, l, k, sign, q)
    solve_blocks(net.joints, bodies.joint_gap, bodies.joint_force, 0)
    for j in range(bodies.joint.shape[0]):
        joint = bodies.joint[j]
        for side in range(2):
            if joint[JOINT_BODY + side] >= 0:
                own, f = bodies.jointed[joint[JOINT_BODY + side]], scaled(1.0 if side == 0 else -1.0, row(bodies.joint_force, j))
                arm = minus(row(q, bodies.node[joint[JOINT_POSITION + side]]), three(own, JOINTED_REFERENCE))
                put_three(own, JOINTED_FORCE, plus(three(own, JOINTED_FORCE), f))
                put_three(own, JOINTED_MOMENT, plus(three(own, JOINTED_MOMENT), cross(arm, f)))


@inlined
def _put_gaps(net, x, share):
    """Write ``share`` times what the places, or velocities, at each joint differ by."""
    bodies = net.bodies
    for j in range(bodies.joint.shape[0]):
        joint = bodies.joint[j]
        ahead = minus(row(x, joint[JOINT_OTHER_NODE]), row(x, bodies.node[joint[JOINT_POSITION]]))
        put(bodies.joint_gap, j, scaled(share, ahead))


@internal
def _close_velocities(net_address, q, v, share):
    """Take a share of the difference of velocities out of all joints, by impulses; returns work put in and energy taken [J]."""
    net = view_net(net_address)
    bodies, put_in, gained = net.bodies, 0.0, 0.0
    _put_inertias(net_address, q)
    _put_gaps(net, v, share)
    _pull_together(net_address, q)
    for b in range(bodies.pivot.shape[0]):
        own = bodies.jointed[b]
        reference, (shift, turn) = three(own, JOINTED_REFERENCE), _moved(own)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            before, more = row(v, i), plus(shift, cross(turn, minus(row(q, i), reference)))
            gained += net.mass[i] * dot(more, plus(before, scaled(0.5, more)))
            put(v, i, plus(before, more))
    for j in range(bodies.joint.shape[0]):
        if bodies.joint[j, JOINT_OTHER] < 0:
            put_in += dot(row(bodies.joint_force, j), row(v, bodies.joint[j, JOINT_OTHER_NODE]))
    return put_in, put_in - gained


@on_demand
def settle_joints(stage, net_address, base, q, v):
    """Make velocities at joints agree at the end of a step of edmc, which would swing from step to step, see ARCHITECTURE.md.

    With the numerical damper left out, they keep that swing. Returns the work of driven points at joints in the step, and the
    energy taken [J].
    """
    net, put_in = view_net(net_address), 0.0
    bodies, between = net.bodies, stage.law == LAW_BETWEEN
    for b in range(bodies.pivot.shape[0]):
        force, moment = out_of_balance(net, b, net.predicted_force, net.n_interior, between)
        put_three(bodies.state[b], BODY_AS_PREDICTED, force)
        put_three(bodies.state[b], BODY_AS_PREDICTED + 3, moment)
    for j in range(bodies.joint.shape[0] - 1, -1, -1):
        force, i = pass_to_other(net, j, BODY_AS_PREDICTED, between), bodies.joint[j, JOINT_OTHER_NODE]
        if bodies.joint[j, JOINT_OTHER] < 0:
            put_in -= dot(force, minus(row(q, i), row(base, i)))
    by_impulses, taken = _close_velocities(net_address, q, v, 2.0 * stage.dissipation)
    return put_in + by_impulses, taken


@internal
def _close_places(net_address, q):
    """Shift and turn bodies, each as one piece, until all joints are closed."""
    net = view_net(net_address)
    bodies = net.bodies
    for _ in range(CLOSINGS):
        _put_inertias(net_address, q)
        _put_gaps(net, q, 1.0)
        _pull_together(net_address, q)
        for b in range(bodies.pivot.shape[0]):
            own = bodies.jointed[b]
            reference, (shift, turn) = three(own, JOINTED_REFERENCE), _moved(own)
            for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
                i = bodies.node[k]
                put(q, i, plus(plus(reference, shift), turned(turn, minus(row(q, i), reference))))
    for j in range(bodies.joint.shape[0]):  # to the last bit
        joint = bodies.joint[j]
        b, ahead = joint[JOINT_BODY], minus(row(q, joint[JOINT_OTHER_NODE]), row(q, bodies.node[joint[JOINT_POSITION]]))
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            put(q, bodies.node[k], plus(row(q, bodies.node[k]), ahead))


@kernel(types.float64(float64, int64, _f2, _f2))
def keep_joints(t, net_address, q, v):
    """`System.project` of a net with joints: shape and velocities of one piece, and closed joints; returns the work put in [J]."""
    net = view_net(net_address)
    for b in range(net.bodies.pivot.shape[0]):
        keep_shape(net, b, q)
    _close_places(net_address, q)
    for b in range(net.bodies.pivot.shape[0]):
        stiffen_body(net, b, q, v)
    return _close_velocities(net_address, q, v, 1.0)[0]


@on_demand
def force_jointed(net_address, t, q, v, f):
    """`free_motion.force_bodies` with the forces of joints; driven points get theirs in f."""
    net, power = view_net(net_address), 0.0
    bodies, acceleration = net.bodies, net.newton_step  # scratch: its rows of prescribed nodes must be zero again afterwards
    if net.n_driven < q.shape[0]:
        evaluate_driven(t, net, q[net.n_driven :], v[net.n_driven :], acceleration[net.n_driven :])
    for b in range(bodies.pivot.shape[0]):
        reference, inertia, spin, force, moment = pulled(net, b, q, v, f)
        _put_inertia(net, b, reference, inertia)
        own = bodies.jointed[b]
        put_three(own, JOINTED_FORCE, force)
        put_three(own, JOINTED_MOMENT, moment)
        put_three(own, JOINTED_SPIN, spin)
    for j in range(bodies.joint.shape[0]):
        joint = bodies.joint[j]
        i = joint[JOINT_OTHER_NODE]
        ahead = row(acceleration, i)
        if joint[JOINT_OTHER] >= 0:
            ahead = _acceleration(net, joint[JOINT_OTHER], row(q, i))
        at = row(q, bodies.node[joint[JOINT_POSITION]])
        put(bodies.joint_gap, j, minus(ahead, _acceleration(net, joint[JOINT_BODY], at)))
    _pull_together(net_address, q)
    for b in range(bodies.pivot.shape[0]):
        own = bodies.jointed[b]
        shift, turn = _moved(own)
        power += put_inertial_forces(net, b, q, v, f, three(own, JOINTED_REFERENCE), three(own, JOINTED_SPIN), shift, turn)
    for j in range(bodies.joint.shape[0]):
        if bodies.joint[j, JOINT_OTHER] < 0:
            i = bodies.joint[j, JOINT_OTHER_NODE]
            put(f, i, minus(row(f, i), row(bodies.joint_force, j)))
    for i in range(net.n_driven, q.shape[0]):
        put(acceleration, i, NO_VECTOR)
    return power


@inlined
def _acceleration(net, b, place):
    """Acceleration of a place of a body by the force and moment on it."""
    own = net.bodies.jointed[b]
    shift, turn = _moved(own)
    return acceleration_at(three(own, JOINTED_REFERENCE), three(own, JOINTED_SPIN), shift, turn, place)
