"""Newton's method for a stage: full steps, then a line search, converged on force."""

from .jit import internal
from .system import FACTORISATIONS, FORCES, ITERATIONS, NEWTON, TOLERANCE, system_at

FULL_STEPS = 8  # the force may rise for a while on the way of a stiff system through its full steps, and converge all the same
SHORTEST = 1.0 / 64.0
HOPELESS = 1e300  # [N] force out of balance where it is not finite, or that is not known


@internal
def newton(system_address, data_address, stage, base, target, q, parameters, counts):
    """Solve a stage for q, in the array given.

    Converged when the largest out-of-balance force is at most ``parameters[TOLERANCE]`` times the largest force on a node, plus
    what rounding leaves; the internal forces may be those that the last full step predicted. After `FULL_STEPS` iterations a
    step must lower the force, or is halved until it does.

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
        if norm == HOPELESS or iteration == int(parameters[ITERATIONS]):
            break
        solves, left = system.direction(stage, data_address)
        counts[FACTORISATIONS] += solves
        counts[NEWTON] += 1
        length, before = 1.0, norm
        system.correct(data_address, 1.0, q)
        if left <= tolerance * scale:
            return True
        norm, scale, noise, predicted = system.residual(stage, base, target, q, data_address)
        counts[FORCES] += 1
        while iteration >= FULL_STEPS and not norm < before and predicted > tolerance * scale and length > SHORTEST:
            length *= 0.5
            system.correct(data_address, -length, q)
            norm, scale, noise, predicted = system.residual(stage, base, target, q, data_address)
            predicted = HOPELESS
            counts[FORCES] += 1
    system.forget(data_address)
    return False
