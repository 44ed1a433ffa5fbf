"""Alexander's two-stage method, gamma = 1 - 1/sqrt 2: order 2, L-stable; see `dirk`.

Source: Alexander, SIAM J. Numer. Anal. 14 (1977) 1006.
"""

from math import sqrt

from .dirk import dirk_scheme

GAMMA = 1.0 - sqrt(0.5)
SDIRK2 = dirk_scheme(
    name="sdirk2",
    label="SDIRK2",
    order=2,
    A=[[GAMMA, 0.0], [1.0 - GAMMA, GAMMA]],
    b=[1.0 - GAMMA, GAMMA],
    note="stable for small motion (L-stable); may gain some energy when slack",
    observes_mean_over_stages=True,
)
