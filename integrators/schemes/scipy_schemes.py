"""scipy's solvers as schemes; what marches them is `scipy_adapter`."""

from integrators.linear_stability import AmplificationPolynomial, NoLimit, polynomial_of_tableau

from .record import Family, Origin, Scheme, Stepping


def amplification(name):
    """Coefficients of R(z) of the solution that an explicit pair of scipy propagates."""
    import numpy as np
    import scipy.integrate

    pair = getattr(scipy.integrate, name)
    return polynomial_of_tableau(np.pad(pair.A, ((0, 0), (0, len(pair.B) - pair.A.shape[1]))), pair.B)


RK45 = Scheme(
    name="RK45",
    label="scipy RK45",
    origin=Origin.SCIPY,
    family=Family.EXPLICIT_RUNGE_KUTTA,
    order=5,
    explicit=True,
    limit=AmplificationPolynomial(lambda: amplification("RK45")),
    note="adaptive: the step that error control is driven to; undamped modes only to h omega = 0.997",
    stepping=Stepping.ADAPTIVE,
)
DOP853 = Scheme(
    name="DOP853",
    label="scipy DOP853",
    origin=Origin.SCIPY,
    family=Family.EXPLICIT_RUNGE_KUTTA,
    order=8,
    explicit=True,
    limit=AmplificationPolynomial(lambda: amplification("DOP853")),
    note="adaptive: the step that error control is driven to; undamped modes to h omega = 5.960",
    stepping=Stepping.ADAPTIVE,
)
RADAU = Scheme(
    name="Radau",
    label="scipy Radau",
    origin=Origin.SCIPY,
    family=Family.COLLOCATION,
    order=5,
    explicit=False,
    limit=NoLimit(),
    note="stable for small motion (L-stable), adaptive",
    stepping=Stepping.ADAPTIVE,
)
BDF = Scheme(
    name="BDF",
    label="scipy BDF",
    origin=Origin.SCIPY,
    family=Family.MULTISTEP,
    order=None,
    explicit=False,
    limit=NoLimit(),
    note="adaptive; orders 1 and 2 have no limit, orders 3 to 5 are unstable for weakly damped modes at some steps",
    stepping=Stepping.ADAPTIVE,
)
LSODA = Scheme(
    name="LSODA",
    label="scipy LSODA",
    origin=Origin.SCIPY,
    family=Family.MULTISTEP,
    order=None,
    explicit=False,
    limit=NoLimit(),
    note="adaptive; its Adams half is limited like an explicit scheme, its BDF half as BDF is",
    stepping=Stepping.ADAPTIVE,
)
