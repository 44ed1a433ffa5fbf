"""Coulomb's friction in one direction, with a step of the sign of a speed that is rounded off."""

import math

from anet_lumped.compiled.jit import inlined_law


@inlined_law
def slide(speed, u):
    """v/sqrt(v^2 + u^2) and its slope [s/m], for a speed v and the slip speed u, at which it is 0.7 [m/s]."""
    root = math.sqrt(speed * speed + u * u)
    share = speed / root
    return share, (1.0 - share * share) / root
