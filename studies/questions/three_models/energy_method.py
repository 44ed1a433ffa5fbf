"""The thesis's first model: p0 is where the potential energy of points on catenaries is least, by sampling or by a gradient."""

import itertools
import math

import numpy as np

from anet_lumped.statics.catenary import catenary
from studies.questions.three_models.cases import GRAVITY, LENGTH, MASS_PER_LENGTH, SUPPORTS, TWO, first_guess

POINTS = 100  # of each cable, the thesis's choice after its Table 5.1
LINE_SAMPLES = 100  # of p0 on the symmetry line of two cables, the same
APART = 0.01  # [m] between samples in a cube, as the thesis found it to be needed
REST_BOX = (5, 5, 11)  # samples along the edges of the box that four cables at rest are found in
CARRIED_CUBE = (5, 5, 5)  # of the cube that goes along with the supports
TOLERANCE = 1e-5  # of the minimiser: force out of balance over the weight of a cable; the differences hold 1e-8
WALL = 100.0  # force of it over the weight of a cable


def point_heights(support, p0):
    """Heights of the points of one cable, equal in arc length with both ends, (POINTS,) [m].

    Parameters
    ----------
    support, p0 : (3,) [m]
        A cable that does not reach from one to the other is a straight line, so that the energy goes on beyond.
    """
    arc = np.linspace(0.0, LENGTH, POINTS)
    if math.dist(support, p0) >= LENGTH * (1 - 1e-12):
        return support[2] + (p0[2] - support[2]) * arc / LENGTH
    return catenary(support, p0, LENGTH).point(arc)[:, 2]


def energy(supports, p0, load):
    """Potential energy of Eq. 5.1 and of a load at p0, over the weight of one cable [m].

    Every point has the same mass, as in the thesis.

    Parameters
    ----------
    supports : (n, 3) [m]
    p0 : (3,) [m]
    load : float [kg]
    """
    heights = sum(float(point_heights(support, p0).mean()) for support in supports)
    return heights + load / (MASS_PER_LENGTH * LENGTH) * float(p0[2])


def weight():
    """Weight of one cable [N]."""
    return MASS_PER_LENGTH * LENGTH * GRAVITY


def least(supports, samples, load):
    """The sample of least energy of those that all supports reach (Eq. 5.2, with "and"), (3,) [m]."""
    reached = [at for at in samples if all(math.dist(support, at) <= LENGTH * (1 + 1e-12) for support in supports)]
    return np.array(reached[int(np.argmin([energy(supports, at, load) for at in reached]))])


def rest_samples(name):
    """Samples of p0 of a net at rest, (k, 3) [m]: the symmetry line of two cables, a box for four.

    Both begin where all cables are straight.
    """
    supports = np.array(SUPPORTS[name])
    middle = supports.mean(axis=0)
    lowest = middle - (0.0, 0.0, math.sqrt(LENGTH**2 - math.dist(supports[0], middle) ** 2))
    if name == TWO:
        return np.linspace(lowest, middle, LINE_SAMPLES)
    return box(np.add(lowest, (0.0, 0.0, APART * (REST_BOX[2] // 2))), REST_BOX)


def box(middle, edges):
    """Samples APART from each other, so many along each edge, about a place (3,) [m]; (k, 3) [m]."""
    steps = [APART * (np.arange(edge) - edge // 2) for edge in edges]
    return np.asarray(middle) + np.array(list(itertools.product(*steps)))


def sampled_rest(name, load):
    """p0 of a net at rest by sampling, (3,) [m]."""
    return least(SUPPORTS[name], rest_samples(name), load)


def sampled_pose(supports, last, load):
    """p0 by sampling a cube about a place, (3,) [m]."""
    return least(supports, box(last, CARRIED_CUBE), load)


def descended(supports, start, load):
    """p0 by SciPy's minimiser BFGS on the same energy, its gradient from differences, (3,) [m].

    Where a cable does not reach, a wall as steep as WALL is added, so that the energy has no other minimum there.

    Raises
    ------
    RuntimeError : it has not converged
    """
    from scipy.optimize import minimize

    def walled(p0):
        beyond = sum(max(0.0, math.dist(support, p0) - LENGTH) for support in supports)
        return energy(supports, p0, load) + WALL * beyond

    found = minimize(walled, start, method="BFGS", options={"gtol": TOLERANCE})
    if not found.success:
        raise RuntimeError(f"The minimiser has not converged: {found.message}")
    return found.x


def descended_rest(name, load):
    """p0 of a net at rest by the gradient, (3,) [m]."""
    return descended(SUPPORTS[name], first_guess(name), load)
