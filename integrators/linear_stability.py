"""Largest stable steps of schemes for one mode, x'' + d x' + omega^2 x = 0.

A scheme's `StepLimit` tells up to which step no mode grows. All functions take and return arrays, element by element, so that
borders can be drawn.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

SCAN = np.arange(0.0, 10.0, 0.25)  # of h omega: finer than any feature of the Runge-Kutta regions here, wider than all of them
ROUND_OFF = 1e-13  # by which |R(z)| may exceed one
FASTEST = 10.0  # h omega above all limits here
HEAVIEST = 1e6  # damping ratio above all limits here


class StepLimit(ABC):
    """Largest stable steps of a scheme. A subclass needs only `largest_step`; the other limits follow from it by bisection."""

    @abstractmethod
    def largest_step(self, omega, d):
        """Largest step [s] up to which a mode of frequency omega [rad/s] and damping d [1/s] does not grow.

        Parameters
        ----------
        omega, d : (...) float64, of one shape

        Returns
        -------
        h : (...) float64 [s]
            0 if no step is stable, inf if every one is.
        """

    def largest_damping_ratio(self, x):
        """Largest damping ratio zeta = d/(2 omega) that is stable at h omega = x; NaN or negative if none is."""
        zeta = bisect(lambda zeta: self.largest_step(np.ones_like(x), 2.0 * zeta) >= x, 0.0 * x, HEAVIEST + 0.0 * x)
        return np.where(self.largest_step(np.ones_like(x), 2.0 * zeta) >= x, zeta, -np.inf)

    def highest_frequency(self, zeta, hd):
        """Largest h omega that is stable with a damping ratio zeta and beside it a damping hd = h d of all modes alike."""
        return bisect(lambda x: self.largest_step(x, 2.0 * zeta * x + hd) >= 1.0, 0.0 * zeta, FASTEST + 0.0 * zeta)


class NoLimit(StepLimit):
    """Every step is stable."""

    def largest_step(self, omega, d):
        """Infinite."""
        return np.full(np.shape(omega), np.inf)

    def largest_damping_ratio(self, x):
        """Infinite."""
        return np.full(np.shape(x), np.inf)

    def highest_frequency(self, zeta, hd):
        """Infinite."""
        return np.full(np.shape(zeta), np.inf)


@dataclass(frozen=True)
class LaggingDamping(StepLimit):
    """(h omega)^2 + 2 lag h d <= 4: a scheme of Stoermer and Verlet, whose damping force is ``lag`` half steps late.

    By Jury's criterion; for Verlet from l^3 - (2 - W - 3D/2) l^2 + (1 - 2D) l + D/2 with W = (h omega)^2 and D = h d.
    """

    lag: float

    def largest_step(self, omega, d):
        """4/(lag d + sqrt((lag d)^2 + 4 omega^2))."""
        d = self.lag * d
        return 4.0 / (d + np.sqrt(d**2 + 4.0 * omega**2))

    def largest_damping_ratio(self, x):
        """(4 - x^2)/(4 lag x)."""
        return (4.0 - x**2) / (4.0 * self.lag * x)


@dataclass(frozen=True, eq=False)
class AmplificationPolynomial(StepLimit):
    """|R(z)| <= 1 at both roots z of z^2 + h d z + (h omega)^2, for an explicit Runge-Kutta scheme.

    Parameters
    ----------
    make : function that returns the coefficients of R(z), lowest first; asked when they are needed
    """

    make: Callable[[], Sequence[float]]

    @cached_property
    def coefficients(self):
        """Coefficients of R(z), lowest first."""
        return np.asarray(self.make(), float)

    def largest_step(self, omega, d):
        """The first step beyond which |R(z)| exceeds one, by a scan and bisection."""
        fastest = np.abs(d + np.sqrt((d**2 - 4.0 * omega**2).astype(complex))) / 2.0
        scale = np.where(fastest > 0.0, fastest, 1.0)
        return np.where(fastest > 0.0, self._first_edge(omega / scale, d / scale) / scale, np.inf)

    def largest_damping_ratio(self, x):
        """(X/x + x/X)/2, where X ends the interval on the negative real axis; beyond it, by a scan and bisection.

        Less damping than this may be unstable too, because the regions have waists.
        """
        real = self.largest_step(np.ones(()), np.full((), 2.0))
        zeta = np.where(x <= real, (real / x + x / real) / 2.0, -np.inf)
        if (x > real).any():  # the last stable zeta < 1, where the region is taller than wide
            beyond, grid = x[x > real], np.linspace(0.0, 1.0, 401)
            stable = self.largest_step(np.ones_like(grid), 2.0 * grid)[:, None] >= beyond
            last = np.max(np.arange(401)[:, None] * stable, axis=0)
            edge = bisect(lambda z: self._stable(beyond, 2.0 * z * beyond), grid[last], grid[last + 1])
            zeta[x > real] = np.where(stable.any(axis=0), edge, -np.inf)
        return zeta

    def error_of_step(self, z):
        """What a step of a mode with z = h omega (-zeta + i sqrt(1 - zeta^2)) is off by over its amplitude, |R(z) - exp(z)|."""
        return np.abs(np.polyval(self.coefficients[::-1], z) - np.exp(z))

    def highest_frequency(self, zeta, hd):
        """The first h omega beyond which |R(z)| exceeds one."""
        return self._first_edge(1.0, 2.0 * zeta, hd)

    def _stable(self, x, hd):
        """Whether |R(z)| <= 1, round-off allowed for, at both roots of z^2 + hd z + x^2."""
        root = np.sqrt(np.asarray(hd**2 - 4.0 * x**2, complex))
        z = np.stack([-hd - root, -hd + root]) / 2.0
        return (np.abs(np.polyval(self.coefficients[::-1], z)) <= 1.0 + ROUND_OFF).all(axis=0)

    def _first_edge(self, omega, d, d0=0.0):
        """Smallest x beyond which it is unstable at frequency x omega and damping x d + d0."""

        def stable(x):
            return self._stable(x * omega, x * d + d0)

        first = np.argmin([stable(x) for x in SCAN], axis=0)
        return bisect(stable, SCAN[np.maximum(first - 1, 0)], SCAN[first])


def polynomial_of_tableau(A, b):
    """Coefficients of R(z) = 1 + sum b'A^(j-1) 1 z^j, lowest first, of a tableau A (s, s), b (s,)."""
    powers = (np.linalg.matrix_power(A, j).sum(axis=1) for j in range(len(b)))
    return [1.0, *(b @ power for power in powers)]


def bisect(stable: Callable, low, high):
    """Last stable value between a stable ``low`` and an unstable ``high``, element by element, to round-off."""
    for _ in range(54):
        middle = 0.5 * (low + high)
        good = stable(middle)
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    return low
