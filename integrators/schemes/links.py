"""Two explicit pairs for springs that do not stretch: order 8 with steps of its own, order 5 for steps that are given.

A system with constraints gives the accelerations that keep lengths as they are, so that what is left to integrate is not stiff.
After each step lengths and their rates are given back (`System.project`), before the force at its end is asked for, which begins
the next step. The order of a pair stays, because the projection changes no more than the step was wrong by.

Source: `dop853` for the pair of order 8; Dormand & Prince, J. Comp. Appl. Math. 6 (1980) 19, and Shampine, Math. Comp. 46 (1986)
135, for that of order 5 and its dense output; Hairer & Wanner, Solving Ordinary Differential Equations II (1996), VII.2, for the
projection.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from integrators.linear_stability import AmplificationPolynomial, polynomial_of_tableau

from . import dop853, embedded_pair
from .record import Family

STAGES_5 = 7


@cache
def tableau_of_order_5():
    """Dormand and Prince's pair of order 5(4), the coefficients that scipy holds.

    Returns
    -------
    embedded_pair.Pair
    """
    from scipy.integrate import RK45 as source

    A = np.zeros((STAGES_5, STAGES_5))
    A[: STAGES_5 - 1, : STAGES_5 - 2], A[STAGES_5 - 1, : STAGES_5 - 1] = source.A, source.B
    c = np.append(source.C, 1.0)
    return embedded_pair.Pair(c, A, STAGES_5 - 1, np.asarray(source.E), np.zeros(STAGES_5), np.asarray(source.P))


def _amplification_of_order_5():
    A = tableau_of_order_5().A
    return polynomial_of_tableau(A[:-1, :-1], A[-1, :-1])


LINKS = replace(
    dop853.DOP853,
    name="links",
    label="links",
    family=Family.CONSTRAINED,
    note="lengths are kept; transverse modes to h omega = 5.960",
    keeps_constraints=True,
    takes_rigid_springs=True,
    with_given_steps="links5",
)

LINKS5 = replace(
    LINKS,
    name="links5",
    label="links, order 5",
    order=5,
    limit=AmplificationPolynomial(_amplification_of_order_5),
    note="lengths are kept; transverse modes to h omega = 1.0 without damping, overdamped ones to 3.31",
    error_constant=1 / 3600,
    with_given_steps="",
    memory_rows=embedded_pair.memory_rows(STAGES_5),
    force_evaluations=STAGES_5 - 1,
    coefficients=lambda: embedded_pair.coefficients(tableau_of_order_5()),
)
