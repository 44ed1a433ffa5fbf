"""The motion of bodies under given forces: Newton's and Euler's equations, with the fluid that bodies push aside."""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.mechanics.linear.node_elimination import inverse
from anet_lumped.model.net import view_net

from .rotation import centre_of_mass, spin_of
from .vectors import added, applied, cross, cross_matrix, dot, matrix_product, minus, plus, put, row, scaled, solved, times_scalar

NO_VECTOR = (0.0, 0.0, 0.0)
NO_MATRIX = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@inlined
def _acceleration(net, b, q, reference, spin, force, moment):
    """Acceleration of the reference point, and rate of the spin, of a body whose nodes have added masses A_k.

    Every node accelerates by a_k = a + w' x d_k + w x (w x d_k), and the sums over the nodes of (m_k I + A_k) a_k, and of their
    moments, are the force and the moment: six equations for a and w'.
    """
    bodies, pinned = net.bodies, net.bodies.pivot[b] >= 0
    shift, shift_turn, turn = NO_MATRIX, NO_MATRIX, NO_MATRIX
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        A, m, arm = net.added_mass[i], net.mass[i], minus(row(q, i), reference)
        M = (m + A[0, 0], A[0, 1], A[0, 2], A[1, 0], m + A[1, 1], A[1, 2], A[2, 0], A[2, 1], m + A[2, 2])
        across = cross_matrix(arm)
        M_arm = matrix_product(M, across)
        shift, shift_turn = added(shift, M), added(shift_turn, times_scalar(-1.0, M_arm))
        turn = added(turn, times_scalar(-1.0, matrix_product(across, M_arm)))
        pull = applied(M, cross(spin, cross(spin, arm)))
        force, moment = minus(force, pull), minus(moment, cross(arm, pull))
    if pinned:
        return NO_VECTOR, solved(turn, moment)
    mobility = inverse(shift)
    turn_shift = (
        shift_turn[0], shift_turn[3], shift_turn[6], shift_turn[1], shift_turn[4], shift_turn[7], shift_turn[2], shift_turn[5],
        shift_turn[8],
    )  # fmt: skip
    coupling = matrix_product(turn_shift, mobility)
    left = added(turn, times_scalar(-1.0, matrix_product(coupling, shift_turn)))
    spin_rate = solved(left, minus(moment, applied(coupling, force)))
    return applied(mobility, minus(force, applied(shift_turn, spin_rate))), spin_rate


@on_demand
def force_bodies(net_address, t, q, v, f):
    """Replace the force on each node of a body by its mass times its acceleration as a part of the body.

    With the force F and the moment M about the centre of mass,

        a = F/m ,     J w' = M - w x J w ,     f_k = m_k (a + w' x d_k + w x (w x d_k)) .

    Source: Euler. A pinned body turns about its pivot. Returns the power that accelerates the fluid [W].
    """
    net, power = view_net(net_address), 0.0
    bodies, with_fluid = net.bodies, net.added_mass.shape[0] > 0
    for b in range(bodies.pivot.shape[0]):
        mass, reference = centre_of_mass(net, b, q)
        pivot = bodies.pivot[b]
        if pivot >= 0:
            reference = row(q, pivot)
        force, moment = NO_VECTOR, NO_VECTOR
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            force = plus(force, row(f, i))
            moment = plus(moment, cross(minus(row(q, i), reference), row(f, i)))
        spin, inertia = spin_of(net, b, reference, q, v)
        if with_fluid:
            shift, spin_rate = _acceleration(net, b, q, reference, spin, force, moment)
        else:
            spin_rate = solved(inertia, minus(moment, cross(spin, applied(inertia, spin))))
            shift = scaled(0.0 if pivot >= 0 else 1.0 / mass, force)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            arm = minus(row(q, i), reference)
            a = plus(shift, plus(cross(spin_rate, arm), cross(spin, cross(spin, arm))))
            put(f, i, scaled(net.mass[i], a))
            if with_fluid:
                A, V = net.added_mass[i], row(v, i)
                power += V[0] * dot(row(A, 0), a) + V[1] * dot(row(A, 1), a) + V[2] * dot(row(A, 2), a)
    return power
