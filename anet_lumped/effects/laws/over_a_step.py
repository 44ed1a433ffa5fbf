"""Places and velocities of nodes over a step, or at one time where the step begins and ends at the same places."""

from anet_lumped.compiled.jit import inlined_law


@inlined_law
def middle_of(base, q, i):
    """Middle (3,) [m] of the places of a node in ``base`` and in q, (n, 3)."""
    return 0.5 * (base[i, 0] + q[i, 0]), 0.5 * (base[i, 1] + q[i, 1]), 0.5 * (base[i, 2] + q[i, 2])


@inlined_law
def velocity_of(base, q, v, per_h, i):
    """Mean velocity (3,) [m/s] of a node over a step of 1/per_h, or where per_h is 0 that in v."""
    if per_h == 0.0:
        return v[i, 0], v[i, 1], v[i, 2]
    return per_h * (q[i, 0] - base[i, 0]), per_h * (q[i, 1] - base[i, 1]), per_h * (q[i, 2] - base[i, 2])


@inlined_law
def minus(a, b):
    """Difference a - b of two vectors (3,)."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
