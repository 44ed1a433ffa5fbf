"""Backward Euler: q+ = q + h v+, v+ = v + h a(q+, v+), with the rate of a length taken over the whole step.

Order 1. For springs that cannot push the step is the minimum of a strictly convex energy and never raises the energy; it
eats the motion too. Source: Martin et al., ACM Trans. Graph. 30 (2011) 72, for the variational form.
"""

from numba import njit

from .march import arrive
from .newton import newton
from .stage import BACKWARD, Stage
from .system import DONE, UNCONVERGED

ORDER = 1
MEMORY = 3
KEPT = 1


@njit(cache=True, error_model="numpy")
def step(system, net, t, h, q, v, memory, options, counts, balance):
    """One step; memory[0] is the force at its start, and then at its end."""
    base, target = memory[1], memory[2]
    for i in range(q.shape[0]):
        for x in range(3):
            base[i, x] = q[i, x]
            target[i, x] = q[i, x] + h * v[i, x]
    for i in range(system.n_free):
        for x in range(3):
            q[i, x] = target[i, x]
    system.prescribe(t + h, net, q, v)
    stage = Stage(BACKWARD, t + h, 1.0 / (h * h), 1.0, h, 0.0)
    if not newton(system, net, stage, base, target, q, options, counts):
        return UNCONVERGED
    for i in range(system.n_free):
        for x in range(3):
            v[i, x] = (q[i, x] - base[i, x]) / h
    arrive(system, net, t, h, q, v, memory, counts, balance, 1.0)  # only forces at its end act
    return DONE
