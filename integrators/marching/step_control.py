"""The length of the next step: by the error of the last one, and so that steps end on given times."""

import numpy as np

from integrators.jit import internal

MOST_REJECTIONS = 40  # in a row, after which a march ends because no step keeps the error small


@internal
def next_corner(corners, corner, t, resolution):
    """Index of the first corner later than t + ``resolution`` [s], searched from the index ``corner`` on."""
    while corner < corners.shape[0] and corners[corner] <= t + resolution:
        corner += 1
    return corner


@internal
def shortened(t, h, goal):
    """Length of a step from t that should be h [s]: shortened so that no step passes the goal and no short step is left before it.

    Returns
    -------
    h : float64 [s]
    ends_on_goal : bool
    """
    if t + h > goal - 1e-9 * h:
        return goal - t, True
    return (0.5 * (goal - t) if t + 2.0 * h > goal else h), False


@internal
def growth(error, error_before, order, most):
    """Factor of the next step after one of an error of 1 at most: a PI controller.

    Source: Gustafsson, ACM Trans. Math. Softw. 17 (1991) 533.

    Parameters
    ----------
    error, error_before : float64
        Of this step and the last, over the error allowed.
    order : float64, of the error in the step
    most : float64, largest factor
    """
    factor = 0.9 * max(error, 1e-8) ** (-0.7 / order) * max(error_before, 1e-8) ** (0.4 / order)
    return min(most, max(0.2, factor))


@internal
def shrinkage(error, order):
    """Factor of the next try after a step whose error is above 1, or is not finite."""
    return max(0.2, 0.9 * error ** (-1.0 / order)) if error < np.inf else 0.25
