"""What all effects of a net need: their added masses, and the middle of a step at which they are taken."""

from numba import njit

from anet_lumped.effects.signatures import as_inertia
from anet_lumped.mechanics.linear import node_elimination as elimination
from anet_lumped.model.tables import (
    SLOT_INERTIA,
    SLOT_TANGENT,
    SLOT_WHOLE_STEP,
)


@njit(cache=True, error_model="numpy", forceinline=True)
def numbers_of(effects, e):
    """Index and parameters of effect e, which its compiled functions read."""
    i, j = effects.index_at[e], effects.index_at[e + 1]
    a, b = effects.params_at[e], effects.params_at[e + 1]
    return effects.index[i:j], effects.params[a:b]


@njit(cache=True, error_model="numpy")
def add_masses(net, t, q):
    """Added masses of the moving nodes, for ``net.added``."""
    effects, added = net.effects, net.added
    for i in range(added.shape[0]):
        for x in range(3):
            for y in range(3):
                added[i, x, y] = 0.0
    for e in range(effects.address.shape[0]):
        if effects.address[e, SLOT_INERTIA] != 0:
            index, params = numbers_of(effects, e)
            as_inertia(effects.address[e, SLOT_INERTIA])(t, q, index, params, added)


@njit(cache=True, error_model="numpy")
def _share_with_fluid(net, t, q, v, f):
    """Make the forces f on moving nodes m (m I + A)^-1 f, so that f/m is the acceleration of the node with its added mass A.

    Returns
    -------
    power : float64 [W], given to the fluid
    """
    add_masses(net, t, q)
    power = 0.0
    for i in range(net.n_free):
        m, A = net.mass[i], net.added[i]
        inverse = elimination.inverse((m + A[0, 0], A[0, 1], A[0, 2], A[1, 0], m + A[1, 1], A[1, 2], A[2, 0], A[2, 1], m + A[2, 2]))
        left = elimination.times(inverse, m * f[i, 0], m * f[i, 1], m * f[i, 2])
        for x in range(3):
            power += (f[i, x] - left[x]) * v[i, x]
            f[i, x] = left[x]
    return power


@njit(cache=True, error_model="numpy")
def any_live(net):
    """Whether any effect is more than a dead load."""
    for e in range(net.effects.address.shape[0]):
        if net.effects.address[e, SLOT_TANGENT] != 0 or net.effects.address[e, SLOT_WHOLE_STEP] != 0:
            return True
    return False


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def take_middle(net, theta, per_tau, base, q):
    """Place and velocity at which a stage takes external forces."""
    Q, A, middle_q, middle_v = q.ravel(), base.ravel(), net.middle_q.ravel(), net.middle_v.ravel()
    for i in range(Q.shape[0]):
        moved = Q[i] - A[i]
        middle_q[i], middle_v[i] = A[i] + theta * moved, moved * per_tau


@njit(cache=True, error_model="numpy")
def clear(blocks):
    flat = blocks.ravel()
    for i in range(flat.shape[0]):
        flat[i] = 0.0
