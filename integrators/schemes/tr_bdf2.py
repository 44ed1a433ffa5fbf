"""TR-BDF2: a trapezoidal stage, then BDF2, gamma = 2 - sqrt 2. Order 2, L-stable, its first stage is explicit; see `dirk`.

Source: Bank et al., IEEE Trans. CAD 4 (1985) 436; Hosea & Shampine, Appl. Numer. Math. 20 (1996) 21.
"""

from math import sqrt

from .dirk import dirk_scheme

D, W = 1.0 - sqrt(0.5), sqrt(2.0) / 4.0
TR_BDF2 = dirk_scheme(
    name="tr_bdf2",
    label="TR-BDF2",
    order=2,
    A=[[0.0, 0.0, 0.0], [D, D, 0.0], [W, W, D]],
    b=[W, W, D],
    note="stable for small motion (L-stable); may gain energy when slack, from its explicit first stage",
)
