"""The implicit midpoint rule: one stage in the middle of the step. Order 2, symplectic; see `dirk`.

Source: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), II.1 and IV.2.
"""

from .dirk import dirk_scheme

MIDPOINT = dirk_scheme(
    name="midpoint",
    label="implicit midpoint",
    order=2,
    A=[[0.5]],
    b=[1.0],
    note="stable for small motion; energy may grow without bound in large motion or when slack",
    keeps_angular_momentum=True,
    observes_mean_over_stages=True,
)
