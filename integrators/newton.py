"""Newton's method for a stage: full steps, then a line search, converged on force."""

from numba import njit

from .system import FACTORISATIONS, FORCES, ITERATIONS, NEWTON, TOLERANCE

FULL_STEPS = 8  # the force may rise for a while on the way of a stiff net through its full steps, and converge all the same
SHORTEST = 1.0 / 64.0


@njit(cache=True, error_model="numpy")
def newton(system, net, stage, base, target, q, options, counts):
    """Solve a stage for q in place.

    Converged when the largest out-of-balance force is at most ``options[TOLERANCE]`` times the largest force on a node, plus
    what rounding leaves; the internal forces may be those that the last full step predicted. After `FULL_STEPS` iterations a
    step must lower the force, or is halved until it does.

    Returns
    -------
    converged : bool
    """
    norm, scale, noise, predicted = system.residual(stage, base, target, q, net)
    counts[FORCES] += 1
    for iteration in range(int(options[ITERATIONS]) + 1):
        if predicted <= options[TOLERANCE] * scale:
            return True
        if norm <= options[TOLERANCE] * scale + noise:
            system.adopt(net)
            return True
        if norm == 1e300 or iteration == int(options[ITERATIONS]):
            break
        solves, left = system.direction(stage, net)
        counts[FACTORISATIONS] += solves
        counts[NEWTON] += 1
        length, before = 1.0, norm
        system.correct(net, 1.0, q)
        if left <= options[TOLERANCE] * scale:
            return True
        norm, scale, noise, predicted = system.residual(stage, base, target, q, net)
        counts[FORCES] += 1
        while iteration >= FULL_STEPS and not norm < before and predicted > options[TOLERANCE] * scale and length > SHORTEST:
            length *= 0.5
            system.correct(net, -length, q)
            norm, scale, noise, predicted = system.residual(stage, base, target, q, net)
            predicted = 1e300
            counts[FORCES] += 1
    system.forget(net)
    return False
