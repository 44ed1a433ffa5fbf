"""Backward Euler: q+ = q + h v+, v+ = v + h a(q+, v+), with the rate of a length taken over the whole step.

Order 1. For springs that cannot push the step is the minimum of a strictly convex energy and never raises the energy. It damps
the motion itself, too. Source: Martin et al., ACM Trans. Graph. 30 (2011) 72, for the variational form.
"""

from integrators.jit import scheme_step
from integrators.linear_stability import NoLimit
from integrators.newton import newton
from integrators.stage import LAW_BACKWARD, Stage
from integrators.step_ends import evaluate_end
from integrators.system import DONE, UNCONVERGED, system_at

from .record import EnergyPromise, Family, own_scheme


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; memory[0] is the force at its start, and then at its end."""
    system, q, v = system_at(system_address), state.q, state.v
    base, target = state.memory[1], state.memory[2]
    for i in range(q.shape[0]):
        for x in range(3):
            base[i, x] = q[i, x]
            target[i, x] = q[i, x] + h * v[i, x]
    for i in range(system.n_free):
        for x in range(3):
            q[i, x] = target[i, x]
    system.prescribe(t + h, data_address, q, v)
    stage = Stage(LAW_BACKWARD, t + h, 1.0 / (h * h), 1.0, h, 0.0)
    if not newton(system_address, data_address, stage, base, target, q, parameters, counts):
        return UNCONVERGED
    for i in range(system.n_free):
        for x in range(3):
            v[i, x] = (q[i, x] - base[i, x]) / h
    evaluate_end(system_address, data_address, t, h, state, counts, 1.0)  # only forces at its end act
    return DONE


BACKWARD_EULER = own_scheme(
    name="backward_euler",
    label="backward Euler",
    family=Family.DIAGONALLY_IMPLICIT,
    order=1,
    explicit=False,
    limit=NoLimit(),
    note="energy never rises at any step; damps the motion itself strongly",
    energy=EnergyPromise.NEVER_RISES,
    damps_the_motion=True,
    error_constant=1 / 2,
    takes_rigid_bodies=True,
    step=step,
    memory_rows=3,
)
