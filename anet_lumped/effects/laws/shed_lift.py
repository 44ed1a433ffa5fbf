"""Lift of the vortices that a cable sheds, and how its phase follows the vibration of the cable.

Let t be the unit tangent of the cable, u the velocity of the fluid relative to it, and w = t x u, which points across cable and
flow and is as long as the part u_n of u across the cable. The lift per length, and the rate of its phase, are

    f = rho/2 d Cl |w| w cos(phi) ,     dphi/dt = 2 pi s |w|/d ,     s = St + St_range sin(phi_v - phi) ,

with the frequency s = f d/U of the vortices. phi_v is the phase of the vibration across the flow, of which the velocity
y' = v.w/|w| and the acceleration y'' tell:

    cos(phi_v) : sin(phi_v) = y'/rms(y') : -y''/rms(y'') .

A mean square m of y is that of an exponential window of length T, dm/dt = (y^2 - m)/T. Where nothing vibrates, s = St.

Source: Thorsen, Saevik & Larsen, J. Fluids Struct. 49 (2014) 135, "A simplified method for time domain simulation of cross-flow
vortex-induced vibrations", eq. 3 to 8; the same authors, J. Fluids Struct. 61 (2016) 1, for the vectors; as MoorDyn has it.
"""

import math

from anet_lumped.compiled.jit import inlined_law, law

from .drag import vector_length

SHORTEST = 1e-9  # of the length between two neighbours: closer ones have no tangent, and feel no lift


@inlined_law
def across(u, chord, length):
    """Unit tangent of a chord, 1/its length, w = t x u and |w|; zeros where the chord is shorter than `SHORTEST` of ``length``."""
    l = vector_length(chord[0], chord[1], chord[2])
    per_l = 1.0 / l if l > SHORTEST * length else 0.0
    t = chord[0] * per_l, chord[1] * per_l, chord[2] * per_l
    w = t[1] * u[2] - t[2] * u[1], t[2] * u[0] - t[0] * u[2], t[0] * u[1] - t[1] * u[0]
    return t, per_l, w, vector_length(w[0], w[1], w[2])


@inlined_law
def lift(w, speed, c, phase):
    """Lift c |w| w cos(phi) (3,) [N], with c = rho/2 d Cl times a length [kg/m]."""
    k = c * speed * math.cos(phase)
    return k * w[0], k * w[1], k * w[2]


@law
def lift_slopes(u, t, per_l, w, speed, c, phase, ahead):
    """Slopes of `lift` in u and in the chord, where the phase is ``phase`` and grows with |w| by ``ahead`` [s/m].

    With n = u - (u.t) t, a = c |w| cos(phi) and b = c (cos(phi)/|w| - ahead sin(phi)), df/dw = a I + b w w^T, so that

        df/du = a [t]x + b w n^T ,     df/dchord = -(a ([u]x + w t^T) + b (u.t) w n^T)/l .

    Returns
    -------
    in_u, in_chord : 9 float64 each [kg/s], [N/m]
        Row by row.
    """
    a = c * speed * math.cos(phase)
    b = c * (math.cos(phase) / speed - ahead * math.sin(phase)) if speed > 0.0 else 0.0
    s = u[0] * t[0] + u[1] * t[1] + u[2] * t[2]
    n = u[0] - s * t[0], u[1] - s * t[1], u[2] - s * t[2]
    in_u = (
        b * w[0] * n[0], b * w[0] * n[1] - a * t[2], b * w[0] * n[2] + a * t[1],
        b * w[1] * n[0] + a * t[2], b * w[1] * n[1], b * w[1] * n[2] - a * t[0],
        b * w[2] * n[0] - a * t[1], b * w[2] * n[1] + a * t[0], b * w[2] * n[2],
    )  # fmt: skip
    x, y, z = (
        -per_l * (a * t[0] + b * s * n[0]),
        -per_l * (a * t[1] + b * s * n[1]),
        -per_l * (a * t[2] + b * s * n[2]),
    )
    k = per_l * a
    in_chord = (
        w[0] * x, w[0] * y + k * u[2], w[0] * z - k * u[1],
        w[1] * x - k * u[2], w[1] * y, w[1] * z + k * u[0],
        w[2] * x + k * u[1], w[2] * y - k * u[0], w[2] * z,
    )  # fmt: skip
    return in_u, in_chord


@inlined_law
def frequency(St, St_range, phase, velocity, acceleration, mean_square_velocity, mean_square_acceleration):
    """Frequency s of the vortices, of velocity and acceleration across the flow and their mean squares."""
    cosine = velocity / math.sqrt(mean_square_velocity) if mean_square_velocity > 0.0 else 0.0
    sine = -acceleration / math.sqrt(mean_square_acceleration) if mean_square_acceleration > 0.0 else 0.0
    size = math.sqrt(cosine * cosine + sine * sine)
    if size == 0.0:
        return St
    return St + St_range * (sine * math.cos(phase) - cosine * math.sin(phase)) / size
