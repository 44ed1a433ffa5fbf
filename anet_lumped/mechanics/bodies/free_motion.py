"""The motion of bodies under given forces: Newton's and Euler's equations."""

from anet_lumped.compiled.jit import on_demand
from anet_lumped.model.net import view_net

from .rotation import centre_of_mass, spin_of
from .vectors import applied, cross, minus, plus, put, row, scaled, solved


@on_demand
def force_bodies(net_address, t, q, v, f):
    """Replace the force on each node of a body by its mass times its acceleration as a part of the body.

    With the force F and the moment M about the centre of mass,

        a = F/m ,     J w' = M - w x J w ,     f_k = m_k (a + w' x d_k + w x (w x d_k)) .

    Source: Euler. A pinned body turns about its pivot.
    """
    net = view_net(net_address)
    bodies = net.bodies
    for b in range(bodies.pivot.shape[0]):
        mass, reference = centre_of_mass(net, b, q)
        pivot = bodies.pivot[b]
        if pivot >= 0:
            reference = row(q, pivot)
        force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            force = plus(force, row(f, i))
            moment = plus(moment, cross(minus(row(q, i), reference), row(f, i)))
        spin, inertia = spin_of(net, b, reference, q, v)
        spin_rate = solved(inertia, minus(moment, cross(spin, applied(inertia, spin))))
        shift = scaled(0.0 if pivot >= 0 else 1.0 / mass, force)
        for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
            i = bodies.node[k]
            arm = minus(row(q, i), reference)
            a = plus(shift, plus(cross(spin_rate, arm), cross(spin, cross(spin, arm))))
            put(f, i, scaled(net.mass[i], a))
    return 0.0
