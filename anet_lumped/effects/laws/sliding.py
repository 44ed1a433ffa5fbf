"""Coulomb friction along one direction, without its jump at rest: what acts of mu N at a speed v,

    v/sqrt(v^2 + u^2) ,

which is 0.7 at the slip speed u and near 1 beyond it.
"""

import math

from anet_lumped.compiled.jit import inlined_law


@inlined_law
def sliding_share(speed, slip_speed):
    """v/sqrt(v^2 + u^2) [-] and its slope in v [s/m], for v and u [m/s]."""
    root = math.sqrt(speed * speed + slip_speed * slip_speed)
    share = speed / root
    return share, (1.0 - share * share) / root
