"""The motion of bodies under given forces: Newton's and Euler's equations."""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.model.net import view_net

from .inertia import added_mass_of, inertia_with_fluid, moved_by
from .rotation import reference_of, spin_of
from .vectors import applied, cross, dot, minus, plus, put, row, scaled


@inlined
def pulled(net, b, q, v, f):
    """Reference point, `Inertia`, angular velocity, and force and moment of the forces f on a body, less what its spin takes."""
    bodies = net.bodies
    mass, reference = reference_of(net, b, q)
    inertia = inertia_with_fluid(net, b, mass, reference, q)
    spin, own_inertia = spin_of(net, b, reference, q, v)
    force, moment = (0.0, 0.0, 0.0), scaled(-1.0, cross(spin, applied(own_inertia, spin)))
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        arm = minus(row(q, i), reference)
        on_node = minus(row(f, i), applied(added_mass_of(net, i), cross(spin, cross(spin, arm))))
        force, moment = plus(force, on_node), plus(moment, cross(arm, on_node))
    return reference, inertia, spin, force, moment


@inlined
def acceleration_at(reference, spin, shift, turn, place):
    """Acceleration of a place of a body, from that of its reference point and the rate of its angular velocity."""
    arm = minus(place, reference)
    return plus(shift, plus(cross(turn, arm), cross(spin, cross(spin, arm))))


@inlined
def put_inertial_forces(net, b, q, v, f, reference, spin, shift, turn):
    """Write each node's mass times its acceleration to the rows of a body in f; returns the power that moves the fluid [W]."""
    bodies, power = net.bodies, 0.0
    for k in range(bodies.node_at[b], bodies.node_at[b + 1]):
        i = bodies.node[k]
        a = acceleration_at(reference, spin, shift, turn, row(q, i))
        put(f, i, scaled(net.mass[i], a))
        power += dot(row(v, i), applied(added_mass_of(net, i), a))
    return power


@on_demand
def force_bodies(net_address, t, q, v, f):
    """Replace the force on each node of a body by its mass times its acceleration as a part of the body.

    With the force F and the moment M about the centre of mass, a body in no fluid has

        a = F/m ,     J w' = M - w x J w ,     f_k = m_k (a + w' x d_k + w x (w x d_k)) ;

    `inertia` has the equations with a fluid. Source: Euler. A pinned body turns about its pivot.

    Returns
    -------
    power : float64 [W]
        Power that accelerates the fluid.
    """
    net, power = view_net(net_address), 0.0
    for b in range(net.bodies.pivot.shape[0]):
        reference, inertia, spin, force, moment = pulled(net, b, q, v, f)
        shift, turn = moved_by(inertia, force, moment)
        power += put_inertial_forces(net, b, q, v, f, reference, spin, shift, turn)
    return power
