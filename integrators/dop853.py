"""Dormand and Prince's pair of order 8(5,3) with twelve stages and a dense output of order 7: for soft motion, accurately.

With a tolerance it chooses its steps; with fixed ones near its limit, a system with kinks gains energy.

Stable for h omega <= 5.960 without damping and no less with some, 6.39 for real eigenvalues: 0.5 a force evaluation, as much as
rk4 has and more than pairs of order 5 (Dormand-Prince 0.17, Bogacki-Shampine 0.24, Tsitouras 0.08 without damping).
Source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.5 and II.6; the coefficients of their
code DOP853 are those that scipy holds.
"""

import numpy as np
from scipy.integrate import DOP853

from . import embedded_pair as pair

ORDER = 8
STAGES = DOP853.n_stages


def _dense():
    """Weights of the stages at theta, as coefficients of theta, theta^2, ...: the nested form of the source multiplied out.

    y(theta) = y + theta (F_0 + (1 - theta) (F_1 + theta (F_2 + (1 - theta) (F_3 + ...)))), with F_0 = dy, F_1 = h y' - dy,
    F_2 = 2 dy - h (y' + y'_end) and F_3 ... F_6 = h D k.
    """
    S = len(DOP853.C_EXTRA) + STAGES + 1
    step, first, last = np.zeros(S), np.eye(S)[0], np.eye(S)[STAGES]
    step[:STAGES] = DOP853.B
    F = [step, first - step, 2.0 * step - first - last, *DOP853.D]
    weights = np.zeros((S, 1))
    for k in range(len(F) - 1, -1, -1):
        weights[:, 0] += F[k]
        weights = np.pad(weights, ((0, 0), (0, 1)))
        times_theta = np.roll(weights, 1, axis=1)
        weights = times_theta if k % 2 == 0 else weights - times_theta
    return weights[:, 1:]


def _pair():
    S = len(DOP853.C_EXTRA) + STAGES + 1
    A, fine, coarse = np.zeros((S, S)), np.zeros(S), np.zeros(S)
    A[:STAGES, :STAGES], A[STAGES, :STAGES], A[STAGES + 1 :] = DOP853.A, DOP853.B, DOP853.A_EXTRA
    fine[: STAGES + 1], coarse[: STAGES + 1] = DOP853.E5, DOP853.E3
    c = np.concatenate([DOP853.C, [1.0], DOP853.C_EXTRA])
    return pair.Pair(c, A, STAGES, fine, coarse, _dense())


PAIR = _pair()
MEMORY = pair.memory(PAIR)
STIFF = 2.5  # h |lambda| above which stability holds a step: where accuracy does, the slower motion that sets it shows less
step = pair.step


def options():
    """The tableau as a step takes it."""
    return pair.options(PAIR)
