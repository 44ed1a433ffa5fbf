"""What forces do to a body: its inertia with the fluid that its nodes carry, which need not be the same in all directions.

Node k, at the arm d_k from the reference point, has the acceleration a + w' x d_k + g_k with g_k = w x (w x d_k), and resists it
with its mass and its added mass, B_k = m_k I + A_k. So of the force F and the moment M on the body

    S a - C w' = F - sum B_k g_k ,    -C^T a + J w' = M - sum d_k x B_k g_k ,

    S = sum B_k ,    C = sum B_k [d_k] ,    J = -sum [d_k] B_k [d_k] ,

with the matrix [x] of the cross product. The reference point is the centre of mass, and C is that of the fluid alone. A pinned body
has its pivot as the reference point and a = 0.
"""

from typing import NamedTuple

from anet_lumped.compiled.jit import inlined
from anet_lumped.mechanics.linear.node_elimination import inverse

from .vectors import (
    added,
    applied,
    cross_matrix,
    inertia_of,
    matrix_product,
    minus,
    plus,
    row,
    solved,
    times_scalar,
    transposed_applied,
)

NO_MATRIX = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Inertia(NamedTuple):
    """Of a body, matrices (9,) by rows.

    Parameters
    ----------
    per_mass : S^-1 [1/kg], zero for a pinned body
    carried : S^-1 C [m], likewise
    turning : J - C^T S^-1 C [kg m2]
    """

    per_mass: tuple
    carried: tuple
    turning: tuple


@inlined
def added_mass_of(net, i):
    """Added mass of a node, a matrix (9,) by rows [kg]; zero where no effect has any."""
    if net.added_mass.shape[0] == 0:
        return NO_MATRIX
    A = net.added_mass[i]
    return A[0, 0], A[0, 1], A[0, 2], A[1, 0], A[1, 1], A[1, 2], A[2, 0], A[2, 1], A[2, 2]


@inlined
def inertia_with_fluid(net, b, mass, reference, q):
    """`Inertia` of body b; with fluid, ``net.added_mass`` is that at q."""
    bodies, J, S, C, pinned = net.bodies, NO_MATRIX, NO_MATRIX, NO_MATRIX, net.bodies.pivot[b] >= 0
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        arm = minus(row(q, i), reference)
        J = added(J, inertia_of(net.mass[i], arm))
        if net.added_mass.shape[0] > 0:
            A, across = added_mass_of(net, i), cross_matrix(arm)
            coupled = matrix_product(A, across)
            S, C = added(S, A), added(C, coupled)
            J = added(J, times_scalar(-1.0, matrix_product(across, coupled)))
    if pinned:
        return Inertia(NO_MATRIX, NO_MATRIX, J)
    if net.added_mass.shape[0] == 0:
        w = 1.0 / mass
        return Inertia((w, 0.0, 0.0, 0.0, w, 0.0, 0.0, 0.0, w), NO_MATRIX, J)
    per_mass = inverse(added(S, (mass, 0.0, 0.0, 0.0, mass, 0.0, 0.0, 0.0, mass)))
    carried = matrix_product(per_mass, C)
    transposed = C[0], C[3], C[6], C[1], C[4], C[7], C[2], C[5], C[8]
    return Inertia(per_mass, carried, added(J, times_scalar(-1.0, matrix_product(transposed, carried))))


@inlined
def moved_by(inertia, force, moment):
    """Acceleration of the reference point and rate of the angular velocity [m/s2], [rad/s2] by a force and a moment about it."""
    turn = solved(inertia.turning, plus(moment, transposed_applied(inertia.carried, force)))
    return plus(applied(inertia.per_mass, force), applied(inertia.carried, turn)), turn
