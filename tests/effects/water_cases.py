"""Streams, a wave and a cable of half the density of water, for tests of water."""

import math

from anet_lumped import Cable
from anet_lumped.effects.flow.waves import Airy
from anet_lumped.effects.flow.wind import Sampled, Uniform

G, RHO, MU, D = 9.81, 1025.0, 0.1, 0.008  # D [m], diameter of a cable of half the density of water
AREA = math.pi / 4.0 * D * D
STREAM = (Uniform((0.3, -0.2, 0.0)), Sampled(((-2.0, 0.1, 0.2), (-0.5, 0.4, -0.1), (0.5, 0.9, 0.3))))
WAVE = Airy(0.5, 2.0, (1.0, 0.4, 0.0), depth=6.0, phase=0.4)


def cable(start="a", end="b", length=1.0, segments=10, **kwargs):
    made = dict(mass_per_length=MU, EA=1e4, zeta=0.1, diameter=D, Can=1.0, Cat=0.1) | kwargs
    return Cable(start, end, length=length, segments=segments, **made)
