"""Force of moving water on a slender segment and on a sphere, by Morison's equation.

Let M be the displaced mass, t the unit tangent of the segment, and a the acceleration of the water, with the part a_n across and
the component s = a.t along the segment. The force is

    f = drag(u) + M (1 + Can) a_n + M (1 + Cat) s t .

The 1 is the force of the pressure that accelerates the water itself (Froude-Krylov); Can and Cat are the water that the segment
pushes aside. The acceleration of the segment meets the added mass A = M (Can (I - t t^T) + Cat t t^T). On a sphere the force of the
accelerated water is M (1 + Ca) a, and its added mass is M Ca.

Source
------
Morison et al., Petr. Trans. AIME 189 (1950) 149; DNV-RP-C205 (2010), 6.2; drag: module `drag`.
"""

from anet_lumped.compiled.jit import inlined_law

from .drag import point_drag, segment_drag


@inlined_law
def segment_force(u, a, t, normal, along, mass, Can, Cat):
    """Force on a segment that is wholly under water.

    Parameters
    ----------
    u, a : tuple of 3 float64 [m/s], [m/s2]
        Velocity of the water less the velocity of the segment; acceleration of the water, an empty tuple where it has none.
    t : tuple of 3 float64
        Unit tangent.
    normal, along : float64 [kg/m]
        Drag coefficients, see `drag.segment_drag`.
    mass : float64 [kg]
        Displaced mass.
    Can, Cat : float64

    Returns
    -------
    fx, fy, fz : float64 [N]
    """
    fx, fy, fz = segment_drag(u[0], u[1], u[2], t[0], t[1], t[2], normal, along)
    if len(a) == 0:
        return fx, fy, fz
    across = mass * (1.0 + Can)
    along_less_across = mass * (Cat - Can) * (a[0] * t[0] + a[1] * t[1] + a[2] * t[2])
    return (
        fx + across * a[0] + along_less_across * t[0],
        fy + across * a[1] + along_less_across * t[1],
        fz + across * a[2] + along_less_across * t[2],
    )


@inlined_law
def subtract_inertia_slopes(a, gradient, t, per_l, mass, Can, Cat, side, c_q, own, other):
    """Subtract c_q df/dq of the part of `segment_force` that is due to the water's acceleration.

    With the vector d of length l from the segment's start to its end,

        df/da = M (1 + Can) I + M (Cat - Can) t t^T ,   df/dd = M (Cat - Can) (s (I - t t^T) + t a_n^T)/l .

    Parameters
    ----------
    a, gradient : tuples of 3 float64 [m/s2] and 9 float64 [1/s2]
        The water's acceleration and its derivatives with respect to position, row by row; empty tuples where they are zero.
    t, per_l, side, own, other
        As in `drag.subtract_segment_slopes`.
    mass, Can, Cat : float64 [kg], [1], [1]
    """
    if len(a) == 0:
        return
    s = a[0] * t[0] + a[1] * t[1] + a[2] * t[2]
    across, along_less_across = mass * (1.0 + Can), mass * (Cat - Can)
    turning = side * c_q * per_l * along_less_across
    for x in range(3):
        for y in range(3):
            df_dd = turning * (t[x] * (a[y] - 2.0 * s * t[y]) + (s if x == y else 0.0))
            df_da_gradient = across * gradient[3 * x + y]
            df_da_gradient += along_less_across * t[x] * (t[0] * gradient[y] + t[1] * gradient[3 + y] + t[2] * gradient[6 + y])
            own[x, y] -= df_dd + c_q * df_da_gradient
            other[x, y] += df_dd


@inlined_law
def add_mass(mass, Can, Cat, t, A):
    """Add M (Can (I - t t^T) + Cat t t^T) to a 3x3 block [kg]."""
    across, along_less_across = mass * Can, mass * (Cat - Can)
    x, y, z = along_less_across * t[0], along_less_across * t[1], along_less_across * t[2]
    A[0, 0] += x * t[0] + across
    A[0, 1] += x * t[1]
    A[0, 2] += x * t[2]
    A[1, 0] += y * t[0]
    A[1, 1] += y * t[1] + across
    A[1, 2] += y * t[2]
    A[2, 0] += z * t[0]
    A[2, 1] += z * t[1]
    A[2, 2] += z * t[2] + across


@inlined_law
def point_force(u, a, coefficient, mass, Ca):
    """Force on the body that a point carries, wholly under water: drag + M (1 + Ca) a, (3,) [N]; () stands for a = 0."""
    fx, fy, fz = point_drag(u[0], u[1], u[2], coefficient)
    if len(a) == 0:
        return fx, fy, fz
    m = mass * (1.0 + Ca)
    return fx + m * a[0], fy + m * a[1], fz + m * a[2]
