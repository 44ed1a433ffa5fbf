"""How the error of places grows in a march with fixed steps, from what its steps leave out.

A step of a scheme whose error is of order p leaves out C h^(p+1) |d^(p+1) q/dt^(p+1)| of every coordinate. The derivative is a
difference of the velocities at p + 1 steps in a row,

    h^p d^(p+1) q/dt^(p+1) = sum_j (-1)^(p-j) (p over j) v_j ,

so that it costs one addition a step. An implicit scheme of order 2 lets velocities swing from step to step where it does not
resolve a vibration. Places hardly move with that, and its errors do not add up. So of such a scheme the difference is that of the
means of two velocities in a row, which do not swing.

The prescribed nodes are where they should be, and what moves along with them is, too; but what stays behind, as a weight does whose
support shakes fast, is no more off for their motion. So of a coordinate the geometric mean of two counts: the derivative less the
mean of the prescribed nodes, and the smaller of that and its own.

What is left out is summed up by its size, since the error of a swing is one of its phase, which grows as long as it swings:
x = A cos(omega t) is off by A C (omega h)^p omega t, and the sum is 2/pi of that. A damped motion forgets some of its errors, and a
whip multiplies some, which this sum does not see.

A difference of order p sees (2 sin(h omega/2))^p of a vibration, less than its derivative (h omega)^p: of order 8 and with
h omega = 3.8, which is stable, a 260th. `times_seen` is how many times as much a step leaves out of it.

Source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.3 (local and global error).
"""

from typing import NamedTuple

import numpy as np
from numba import types

from integrators.flat_view import flat
from integrators.jit import internal
from integrators.states import copy

SWING = 0.5 * np.pi  # largest of |cos| over its mean: the sum of what a swing leaves out is so much less than its error of phase
# Steps after those of a difference that are taken to be like these, so that what is added costs some per cent of a step. Of a short
# march of explicit steps, which costs next to nothing, not so many: a snap among few steps would be overlooked.
UNSEEN, UNSEEN_EXPLICIT = 2, 29
SHORT = 4096  # steps
WAITS = -1  # steps that a difference has, before which the next step is not one of it


class StepError(NamedTuple):
    """What a scheme's steps leave out.

    Parameters
    ----------
    needs_copied_start : bool
        Steps may fail and leave another state than the one before them, see `Scheme`.
    order : int
        p, of the error that grows.
    constant : float
        C.
    unseen : int
        Steps that are not looked at after those of a difference, see `unseen_steps`.
    of_means : int
        1 where the difference is that of means of two velocities, which takes one step more, else 0.
    """

    needs_copied_start: bool
    order: int
    constant: float
    unseen: int
    of_means: int


STEP_ERROR = types.NamedTuple((types.boolean, types.int64, types.float64, types.int64, types.int64), StepError)
MEANS_OF_ORDER = 2  # of implicit schemes


def step_error(scheme, steps):
    """What a scheme's steps leave out, in a march of so many.

    Parameters
    ----------
    scheme : Scheme
    steps : float
    """
    explicit, order = scheme.explicit and not scheme.keeps_constraints, scheme.error_order or scheme.order
    of_means = int(not scheme.explicit and order == MEANS_OF_ORDER)
    return StepError(scheme.needs_copied_start, order, scheme.error_constant, unseen_steps(explicit, steps), of_means)


def steps_of_differences(scheme, differences):
    """Steps that a march takes for so many differences, looking as often as it does at most."""
    error = step_error(scheme, 0)
    each = error.order + error.of_means
    return each + (differences - 1) * (each + 1 + UNSEEN)


def unseen_steps(explicit, steps):
    """Steps that a march of so many does not look at after those of a difference."""
    return UNSEEN_EXPLICIT if explicit and steps > SHORT else UNSEEN


def times_seen(scheme, x, zeta):
    """How many times what differences of velocities see of it an explicit step of a higher order leaves out of a vibration.

    Parameters
    ----------
    scheme : Scheme
        With an amplification polynomial R(z).
    x, zeta : float
        h omega, and its damping ratio, below 1.

    Returns
    -------
    times : float
        |R(z) - exp(z)| over C |z| |1 - exp(-z)|^p pi/2, at least 1.
    """
    order = scheme.error_order or scheme.order
    z = x * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    with np.errstate(over="ignore"):  # of a step so long that the vibration dies in it by more than a float holds
        seen = SWING * scheme.error_constant * abs(z) * abs(1.0 - np.exp(-z)) ** order
    return max(1.0, float(scheme.limit.error_of_step(z)) / seen) if x > 0.0 else 1.0


class Growth(NamedTuple):
    """Difference of velocities that is being formed [m/s], and errors of places so far [m]; (n, 3) both."""

    difference: np.ndarray
    error: np.ndarray


_f2 = types.Array(types.float64, 2, "C")
GROWTH = types.NamedTuple((_f2, _f2), Growth)


@internal
def begin(growth, v, n_free):
    """Begin at the start of a march; returns the number of steps that the difference has, none."""
    error = flat(growth.error)
    for i in range(error.shape[0]):
        error[i] = 0.0
    copy(flat(v), flat(growth.difference))
    return np.int64(0)


@internal
def follow(growth, step_error, steps, weight, h, v, n_free):
    """Add a step to the difference, and what is left out to the error where the difference is complete.

    Parameters
    ----------
    growth : Growth
    step_error : StepError
    steps : int64
        Steps that the difference has, at least `WAITS`: then this one is its first.
    weight : float64
        Of the velocities that were added last.
    h : float64 [s]
    v : (n, 3) float64 [m/s], at the end of the step
    n_free : int64, nodes that move

    Returns
    -------
    steps, weight
    """
    p, of_means, V, difference, error = step_error.order, step_error.of_means, flat(v), flat(growth.difference), growth.error
    steps += 1
    if steps == 0:
        copy(V, difference)
        return steps, 1.0
    before = of_means * weight  # a velocity is part of two means
    weight *= -float(p - steps + 1) / float(steps)
    for i in range(V.shape[0]):
        difference[i] += (weight + before) * V[i]
    if steps < p + of_means:
        return steps, weight
    left_out = SWING * step_error.constant * h * (p + of_means + step_error.unseen + 1) / (1 + of_means)
    n, per_node = v.shape[0], 1.0 / max(v.shape[0] - n_free, 1)
    for x in range(3):
        shared = 0.0
        for i in range(n_free, n):
            shared += per_node * growth.difference[i, x]
        for i in range(n_free):
            own = growth.difference[i, x]
            along = abs(own - shared)
            error[i, x] += left_out * np.sqrt(along * min(abs(own), along))
    return -(step_error.unseen + 1), 1.0


@internal
def largest_error(growth, n_free):
    """Largest error of the place of a node so far [m]."""
    error, largest = flat(growth.error), 0.0
    for i in range(0, 3 * n_free, 3):
        largest = max(largest, error[i] * error[i] + error[i + 1] * error[i + 1] + error[i + 2] * error[i + 2])
    return np.sqrt(largest)
