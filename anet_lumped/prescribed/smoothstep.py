"""The quintic smoothstep 6 s^5 - 15 s^4 + 10 s^3, by which paths, loads and waves set in.

It goes from 0 to 1 and has neither slope nor curvature at its ends. Python, compiled code (`smoothstep_kernel`), JAX and
symbolic expressions all evaluate these lines.
"""


def smoothstep(s):
    """Value, slope and curvature of the smoothstep at s, which is between 0 and 1."""
    both = s * (1.0 - s)
    return s * s * s * (10.0 + s * (6.0 * s - 15.0)), 30.0 * both * both, 60.0 * both * (1.0 - 2.0 * s)


def ramped(t, ramp):
    """Smoothstep of t/ramp, and its first two derivatives in time; 0 before t = 0, 1 after the ramp or without one.

    Parameters
    ----------
    t, ramp : float [s]

    Returns
    -------
    value, rate, acceleration : float [1], [1/s], [1/s^2]
    """
    if ramp == 0.0 or t >= ramp:
        return 1.0, 0.0, 0.0
    if t <= 0.0:
        return 0.0, 0.0, 0.0
    value, slope, curvature = smoothstep(t / ramp)
    return value, slope / ramp, curvature / (ramp * ramp)
