"""The surface of the water, and the motion of current and wave together, at a place."""

from anet_lumped.compiled.jit import inlined_law

from .waves.kernel import AT_REST, wave_at
from .wind.kernel import wind_at


@inlined_law
def flow_at(t, q, level, motion):
    """At a position q: height above the surface, its slopes; velocity of the water, its gradient; acceleration, its gradient.

    ``motion`` are the numbers of current and waves, both (k,) float64, or an empty tuple of water at rest. Then the last four are
    empty tuples, too.
    """
    if len(motion) == 0:
        return q[2] - level, (0.0, 0.0, 1.0), (), (), (), ()
    current, wave = motion
    velocity, gradient = AT_REST[1], AT_REST[2]
    if len(current) > 0:
        velocity, gradient = wind_at(t, q[0], q[1], q[2], current)
    if len(wave) == 0:
        return q[2] - level, (0.0, 0.0, 1.0), velocity, gradient, AT_REST[1], AT_REST[2]
    (eta, _, eta_x, eta_y), u, u_gradient, a, a_gradient = wave_at(t, q[0], q[1], q[2], wave)
    velocity = (velocity[0] + u[0], velocity[1] + u[1], velocity[2] + u[2])
    gradient = (
        gradient[0] + u_gradient[0], gradient[1] + u_gradient[1], gradient[2] + u_gradient[2],
        gradient[3] + u_gradient[3], gradient[4] + u_gradient[4], gradient[5] + u_gradient[5],
        gradient[6] + u_gradient[6], gradient[7] + u_gradient[7], gradient[8] + u_gradient[8],
    )  # fmt: skip
    return q[2] - level - eta, (-eta_x, -eta_y, 1.0), velocity, gradient, a, a_gradient


@inlined_law
def height_at(t, q, i, level, motion):
    """Height of a node above the surface [m]; ``motion`` as in `flow_at`."""
    if len(motion) == 0:
        return q[i, 2] - level
    _, wave = motion
    return q[i, 2] - level - (wave_at(t, q[i, 0], q[i, 1], q[i, 2], wave)[0][0] if len(wave) > 0 else 0.0)
