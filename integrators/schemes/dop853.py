"""Dormand and Prince's pair of order 8(5,3) with twelve stages and a dense output of order 7: for soft motion, accurately.

With a tolerance it chooses its steps; with fixed ones near its limit, a system with kinks gains energy.

Stable for h omega <= 5.960 without damping and no less with some, 6.39 for real eigenvalues: 0.5 a force evaluation, as much as
rk4 has and more than pairs of order 5 (Dormand-Prince 0.17, Bogacki-Shampine 0.24, Tsitouras 0.08 without damping).
Source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.5 and II.6; the coefficients of their
code DOP853 are those that scipy holds.
"""

from functools import cache

import numpy as np

from integrators.linear_stability import AmplificationPolynomial, polynomial_of_tableau

from . import embedded_pair
from .record import Family, Stepping, own_scheme

STAGES = 12
ALL_STAGES = STAGES + 1 + 3  # the end of the step, and what the dense output alone needs


def dense_weights(source):
    """Weights of the stages at theta, as coefficients of theta, theta^2, ...: the nested form of the source multiplied out.

    y(theta) = y + theta (F_0 + (1 - theta) (F_1 + theta (F_2 + (1 - theta) (F_3 + ...)))), with F_0 = dy, F_1 = h y' - dy,
    F_2 = 2 dy - h (y' + y'_end) and F_3 ... F_6 = h D k.
    """
    step, first, last = np.zeros(ALL_STAGES), np.eye(ALL_STAGES)[0], np.eye(ALL_STAGES)[STAGES]
    step[:STAGES] = source.B
    F = [step, first - step, 2.0 * step - first - last, *source.D]
    weights = np.zeros((ALL_STAGES, 1))
    for k in range(len(F) - 1, -1, -1):
        weights[:, 0] += F[k]
        weights = np.pad(weights, ((0, 0), (0, 1)))
        times_theta = np.roll(weights, 1, axis=1)
        weights = times_theta if k % 2 == 0 else weights - times_theta
    return weights[:, 1:]


@cache
def tableau():
    """The pair; its coefficients come from scipy, which is imported when they are first asked for.

    Returns
    -------
    embedded_pair.Pair
    """
    from scipy.integrate import DOP853 as source

    A, fine, coarse = np.zeros((ALL_STAGES, ALL_STAGES)), np.zeros(ALL_STAGES), np.zeros(ALL_STAGES)
    A[:STAGES, :STAGES], A[STAGES, :STAGES], A[STAGES + 1 :] = source.A, source.B, source.A_EXTRA
    fine[: STAGES + 1], coarse[: STAGES + 1] = source.E5, source.E3
    c = np.concatenate([source.C, [1.0], source.C_EXTRA])
    return embedded_pair.Pair(c, A, STAGES, fine, coarse, dense_weights(source))


def amplification():
    """Coefficients of R(z)."""
    A = tableau().A
    return polynomial_of_tableau(A[:STAGES, :STAGES], A[STAGES, :STAGES])


DOP853 = own_scheme(
    name="dop853",
    label="DOP853",
    family=Family.EXPLICIT_RUNGE_KUTTA,
    order=8,
    explicit=True,
    stepping=Stepping.EMBEDDED,
    limit=AmplificationPolynomial(amplification),
    note="undamped modes to h omega = 5.960, overdamped ones to 6.394; error control is driven to it",
    error_constant=6.404e-8,  # the coefficient of z^9 in R(z) is so far from 1/9!
    takes_rigid_bodies=True,
    step=embedded_pair.step,
    memory_rows=embedded_pair.memory_rows(ALL_STAGES),
    force_evaluations=STAGES,
    # where accuracy holds a step, the slower motion that sets it shows less
    stiff_beyond=2.5,
    coefficients=lambda: embedded_pair.coefficients(tableau()),
)
