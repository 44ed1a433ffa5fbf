"""Newton's method for a stage: full steps at first, then with a line search; it converges on force."""

from .jit import internal
from .system import FACTORISATIONS, FORCES, ITERATIONS, NEWTON, TOLERANCE, system_at

FULL_STEPS = 8  # without a line search: in a stiff system the force may rise in some full steps and converge all the same
SHORTEST_STEP = 1.0 / 64.0
UNKNOWN_FORCE = 1e300  # [N] force out of balance where it is not finite, or that is not known


@internal
def newton(system_address, data_address, stage, base, target, q, parameters, counts):
    """Solve a stage for q; overwrite the array q by the solution.

    Newton's method has converged when the largest out-of-balance force is at most ``parameters[TOLERANCE]`` times the largest force
    on a node, plus what rounding leaves. Either the internal forces by their law or those that the last full step predicted must
    fulfil this. After `FULL_STEPS` iterations a step that does not lower the force is halved until it does.

    Returns
    -------
    converged : bool
    """
    system, tolerance = system_at(system_address), parameters[TOLERANCE]
    norm, scale, noise, predicted = system.residual(stage, base, target, q, data_address)
    counts[FORCES] += 1
    for iteration in range(int(parameters[ITERATIONS]) + 1):
        if predicted <= tolerance * scale:
            return True
        if norm <= tolerance * scale + noise:
            system.adopt(data_address)
            return True
        if norm == UNKNOWN_FORCE or iteration == int(parameters[ITERATIONS]):
            break
        solves, unbalanced = system.direction(stage, data_address)
        counts[FACTORISATIONS] += solves
        counts[NEWTON] += 1
        length, norm_before = 1.0, norm
        system.correct(data_address, 1.0, q)
        if unbalanced <= tolerance * scale:
            return True
        norm, scale, noise, predicted = system.residual(stage, base, target, q, data_address)
        counts[FORCES] += 1
        while iteration >= FULL_STEPS and not norm < norm_before and predicted > tolerance * scale and length > SHORTEST_STEP:
            length *= 0.5
            system.correct(data_address, -length, q)
            norm, scale, noise, predicted = system.residual(stage, base, target, q, data_address)
            predicted = UNKNOWN_FORCE
            counts[FORCES] += 1
    system.forget(data_address)
    return False
