"""Diagonally implicit Runge-Kutta methods: each stage is one solve, q = q_hat + gamma h v, M (v - v_hat) = gamma h f(q, v).

==========  =====  =============================================================================================
midpoint    2      implicit midpoint rule; symplectic
sdirk2      2      Alexander's two-stage method, gamma = 1 - 1/sqrt 2; L-stable
tr_bdf2     2      a trapezoidal stage, then BDF2, gamma = 2 - sqrt 2; L-stable, its first stage is explicit
==========  =====  =============================================================================================

All are unconditionally stable for a linear system; none keeps a nonlinear one from gaining energy.

Where a step does not resolve the stretching, the internal forces of single stages mislead. The stages of sdirk2 are of order 1,
and no step makes the error of their forces smaller: the centripetal force of a mass on a stiff spring that goes round is -1/sqrt 2
times what it must be in the first stage and 3/2 (2 + sqrt 2) = 5.12 times in the last, while their mean with the weights b is right
(stages on the circle, q_s = q + h sum A V, in the limit of small steps). With the midpoint rule the places at the end of a step
are not those that any forces balanced. Of these two the mean over the step is observed instead. The stages of tr_bdf2 are of order
2, and its last force is right.
Source: Alexander, SIAM J. Numer. Anal. 14 (1977) 1006; Bank et al., IEEE Trans. CAD 4 (1985) 436; Hosea & Shampine, Appl.
Numer. Math. 20 (1996) 21.
"""

import numpy as np
from numba import njit

from .march import arrive
from .newton import newton
from .stage import STATE, Stage
from .system import DONE, SCHEME, UNCONVERGED

ORDER = 2
MEMORY = 11
KEPT = 1
_STAGES = 3

_a = 1.0 - np.sqrt(0.5)
_d, _w = 1.0 - np.sqrt(0.5), np.sqrt(2.0) / 4.0
TABLEAUS = {
    "midpoint": ([[0.5]], [1.0]),
    "sdirk2": ([[_a, 0.0], [1.0 - _a, _a]], [1.0 - _a, _a]),
    "tr_bdf2": ([[0.0, 0.0, 0.0], [_d, _d, 0.0], [_w, _w, _d]], [_w, _w, _d]),
}
AVERAGED = tuple(name for name, (A, _) in TABLEAUS.items() if A[0][0] > 0.0)
"""Schemes of which the mean over a step is observed, see above."""


def options(name):
    """Tableau of a scheme as a step takes it: stages, then the rows of A padded to three, then b."""
    A, b = TABLEAUS[name]
    table = np.zeros((_STAGES + 1, _STAGES))
    table[: len(b), : len(b)] = A
    table[_STAGES, : len(b)] = b
    return np.concatenate([[len(b)], table.ravel()])


@njit(cache=True, error_model="numpy")
def step(system, net, t, h, q, v, memory, options, counts, balance):
    """One step; memory[0] is the force at its start, and then at its end."""
    stages, table = int(options[SCHEME]), options[SCHEME + 1 :]
    b, averages = table[_STAGES * _STAGES :], table[0] > 0.0
    if averages:
        system.average(net, 0.0, h)
    q_s, base, target, v_s = memory[1], memory[2], memory[3], memory[4]
    for s in range(stages):
        V, A = memory[5 + s], memory[8 + s]
        row = table[_STAGES * s : _STAGES * (s + 1)]
        ahead = 0.0
        for r in range(stages):
            ahead += row[r]
        gh = h * row[s]
        if gh == 0.0:
            for i in range(system.n_free):
                for x in range(3):
                    V[i, x], A[i, x] = v[i, x], memory[0, i, x] * system.per_mass[i, x]
            continue
        for i in range(q.shape[0]):
            for x in range(3):
                q_hat, v_hat = q[i, x], v[i, x]
                for r in range(s):
                    q_hat += h * row[r] * memory[5 + r, i, x]
                    v_hat += h * row[r] * memory[8 + r, i, x]
                base[i, x] = q_hat
                target[i, x] = q_hat + gh * v_hat
                q_s[i, x] = target[i, x]
        for i in range(system.n_free, q.shape[0]):
            for x in range(3):
                q_s[i, x], v_s[i, x] = q[i, x], v[i, x]
        system.prescribe(t + ahead * h, net, q_s, v_s)
        for i in range(system.n_free, q.shape[0]):
            for x in range(3):
                base[i, x] = q_s[i, x] - gh * v_s[i, x]
        stage = Stage(STATE, t + ahead * h, 1.0 / (gh * gh), 1.0, gh, 0.0)
        if not newton(system, net, stage, base, target, q_s, options, counts):
            return UNCONVERGED
        if averages:
            system.average(net, b[s], h)
        for i in range(system.n_free):
            for x in range(3):
                V[i, x] = (q_s[i, x] - base[i, x]) / gh
                A[i, x] = (V[i, x] - (target[i, x] - base[i, x]) / gh) / gh
    for i in range(system.n_free):
        for x in range(3):
            for s in range(stages):
                q[i, x] += h * b[s] * memory[5 + s, i, x]
                v[i, x] += h * b[s] * memory[8 + s, i, x]
    arrive(system, net, t, h, q, v, memory, counts, balance)
    if table[0] == 0.0:
        # an explicit first stage goes on with the force that the last one balanced, whose damper saw the taut part of it
        for i in range(system.n_free):
            for x in range(3):
                memory[0, i, x] = memory[7 + stages, i, x] / system.per_mass[i, x]
    return DONE
