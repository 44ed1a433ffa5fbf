"""Added masses of effects, and the state in a stage at which the forces of effects are taken."""

from anet_lumped.compiled.jit import inlined, internal
from anet_lumped.effects.signatures import as_inertia
from anet_lumped.mechanics.linear.node_elimination import inverse, times
from anet_lumped.model.tables import KERNEL_ELIMINATE_GROUPS_OF_INERTIA, SLOT_INERTIA, SLOT_TANGENT, SLOT_WHOLE_STEP
from integrators.flat_view import flat


@inlined
def numbers_of(effects, e):
    """Index and parameters of the e-th effect."""
    return (
        effects.index[effects.index_at[e] : effects.index_at[e + 1]],
        effects.params[effects.params_at[e] : effects.params_at[e + 1]],
    )


@internal
def add_masses(net, t, q):
    """Write the added masses of the moving nodes to ``net.added_mass``."""
    effects, added = net.effects, net.added_mass
    clear(added)
    for e in range(effects.address.shape[0]):
        if effects.address[e, SLOT_INERTIA] != 0:
            index, params = numbers_of(effects, e)
            as_inertia(effects.address[e, SLOT_INERTIA])(t, q, index, params, added)


@inlined
def mobility_with_fluid(m, A):
    """(m I + A)^-1 of a node with the added mass A, a matrix (9,)."""
    return inverse((m + A[0, 0], A[0, 1], A[0, 2], A[1, 0], m + A[1, 1], A[1, 2], A[2, 0], A[2, 1], m + A[2, 2]))


@internal
def share_with_fluid(net, t, q, v, f):
    """Multiply the force f on each moving node by m (m I + A)^-1, so that f/m is its acceleration with the added mass A.

    Nodes of bodies are left to `bodies.free_motion`.

    Returns
    -------
    power : float64 [W]
        Power that accelerates the fluid, (f - m (m I + A)^-1 f) . v.
    """
    add_masses(net, t, q)
    power = 0.0
    for i in range(net.bodies.first):
        m = net.mass[i]
        mobility = mobility_with_fluid(m, net.added_mass[i])
        own_force = times(mobility, m * f[i, 0], m * f[i, 1], m * f[i, 2])
        for x in range(3):
            power += (f[i, x] - own_force[x]) * v[i, x]
            f[i, x] = own_force[x]
    return power


@inlined
def any_live(net):
    """Whether an effect has a force that depends on position, velocity or time, so that it is not a dead load."""
    for e in range(net.effects.address.shape[0]):
        if net.effects.address[e, SLOT_TANGENT] != 0 or net.effects.address[e, SLOT_WHOLE_STEP] != 0:
            return True
    return False


@inlined
def eliminates_inertia(net):
    """Whether the blocks of all nodes inside cables are their inertia, so that ``net.diagonal`` is read of free points only.

    See `chain.eliminate_groups_of_inertia`.
    """
    short, singles = net.single_kinds[0], net.single_cables.shape[0]
    return short == singles and net.kernels[KERNEL_ELIMINATE_GROUPS_OF_INERTIA] != 0


@internal
def take_middle(net, theta, per_tau, base, q):
    """Write the state in which a stage takes external forces to ``net.middle_q`` and ``net.middle_v``.

    q_m = base + theta (q - base) and v_m = (q - base)/tau.
    """
    Q, A, middle_q, middle_v = flat(q), flat(base), flat(net.middle_q), flat(net.middle_v)
    for i in range(Q.shape[0]):
        moved = Q[i] - A[i]
        middle_q[i], middle_v[i] = A[i] + theta * moved, moved * per_tau


@internal
def clear(blocks):
    """Set an array to zero."""
    numbers = flat(blocks)
    for i in range(numbers.shape[0]):
        numbers[i] = 0.0
