"""The one nonlinear problem that every implicit scheme solves, once or more a step.

Find the positions q of the moving nodes that fulfil

    m W (target - q) + f(t, q_m, v_m) + internal(q; base) = 0 ,    q_m = base + theta (q - base),   v_m = (q - base)/tau ,

with the external forces f at (q_m, v_m). The internal forces follow one of three laws:

``LAW_AT_END``: at the position q, with the rate of length of the velocity v_m there;
``LAW_BACKWARD``: at the position q, with the mean rate of length since base;
``LAW_BETWEEN``: for the whole step from base to q.

A stage q = base + gamma h v, M (v - v_hat) = gamma h f of a Runge-Kutta or multistep scheme has W = 1/(gamma h)^2,
target = base + gamma h v_hat, theta = 1, tau = gamma h.
"""

from typing import NamedTuple

from numba import types

LAW_AT_END, LAW_BACKWARD, LAW_BETWEEN = 0, 1, 2


class Stage(NamedTuple):
    """Numbers of one stage, see the module.

    ``dissipation`` is the numerical axial damper, as a multiple of the stiffness, where the step does not resolve stretching.
    """

    law: int
    t: float  # [s] at which external forces are taken
    W: float  # [1/s2]
    theta: float
    tau: float  # [s]
    dissipation: float


STAGE = types.NamedTuple((types.int64,) + (types.float64,) * 5, Stage)
