"""Irregular waves: sums of regular ones of random phase whose energy is that of a spectrum."""

import math
from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_count, check_number, shown

from .base import Wave, check_depth_and_ramp, check_level_direction, highest_wave
from .components import Components, moved

LOWEST, HIGHEST = 0.5, 4.0  # circular frequencies that have components, over that of the peak; 0.5 % of the energy lies beyond
QUADRATURE = 32  # samples of the spectrum for each component


@dataclass(frozen=True)
class Irregular(Wave):
    """Waves of a one-sided spectrum S(omega), of which each component has the energy of a band: a^2/2 = integral of S.

    Bands are of equal width between 0.5 and 4 times the frequency of the peak, the frequency of each component is drawn within its
    band, so that the waves do not repeat, and its phase from all. The spectrum is scaled to what the bands hold, so that the
    variance of the elevation is (height/4)^2.
    """

    height: float
    period: float
    seed: int
    direction: Vector = (1.0, 0.0, 0.0)
    spreading: float | None = None
    components: int = 100
    depth: float = math.inf
    ramp: float = 0.0

    def __post_init__(self) -> None:
        owner = f"wave {type(self).__name__}"
        for key, unit, sign in (("height", "m", "non-negative"), ("period", "s", "positive")):
            object.__setattr__(self, key, check_number(key, getattr(self, key), unit, owner, sign=sign))
        if not isinstance(self.seed, int) or isinstance(self.seed, bool) or self.seed < 0:
            raise SceneError(f"Argument `seed` must be an integer of at least 0, but {owner} has seed={shown(self.seed)}.")
        object.__setattr__(self, "direction", check_level_direction(self.direction, owner))
        if self.spreading is not None:
            object.__setattr__(self, "spreading", check_number("spreading", self.spreading, "", owner, sign="positive"))
        object.__setattr__(self, "components", check_count("components", self.components, owner))
        check_depth_and_ramp(self, owner)

    @abstractmethod
    def spectrum(self, frequency: np.ndarray) -> np.ndarray:
        """Spectrum of the elevation over the circular frequency [rad/s], one-sided, but for a factor."""

    @property
    def highest_frequency(self) -> float:
        """Upper end of the highest band [rad/s]."""
        return HIGHEST * 2.0 * math.pi / self.period

    @property
    def usual_period(self) -> float:
        """Period of the peak [s]."""
        return self.period

    def seen_from(self, origin: Vector, g: float) -> Components:
        """The same waves about another origin, see `Wave`."""
        return moved(self, origin, g)

    def rows(self, g: float) -> np.ndarray:
        """Regular waves, see `Wave`."""
        highest = highest_wave(self.wave_number(g), self.depth)
        if self.height > highest:
            raise SceneError(
                f"Argument `height` must be below {highest:.4g} m, where a wave of this period breaks, but wave "
                f"{type(self).__name__} has height={self.height}."
            )
        n, random, peak = self.components, np.random.default_rng(self.seed), 2.0 * math.pi / self.period
        width = (HIGHEST - LOWEST) * peak / n
        fine = LOWEST * peak + width * (np.arange(n * QUADRATURE) + 0.5) / QUADRATURE
        energy = self.spectrum(fine).reshape(n, QUADRATURE).sum(axis=1)
        amplitude = self.height / 4.0 * np.sqrt(2.0 * energy / energy.sum())
        frequency = LOWEST * peak + width * (np.arange(n) + random.random(n))
        phase = random.uniform(0.0, 2.0 * math.pi, n)
        angle = math.atan2(self.direction[1], self.direction[0]) + self._deviations(random)
        return np.column_stack([amplitude, frequency, phase, np.cos(angle), np.sin(angle)])

    def _deviations(self, random: np.random.Generator) -> np.ndarray:
        """Angles (n,) between the components and `direction` [rad]: (1 + sin)/2 has a beta distribution."""
        n = self.components
        if self.spreading is None:
            return np.zeros(n)
        from scipy.special import betaincinv

        half = 0.5 * (self.spreading + 1.0)
        shares = (random.permutation(n) + random.random(n)) / n
        return np.arcsin(2.0 * betaincinv(half, half, shares) - 1.0)


@dataclass(frozen=True)
class PiersonMoskowitz(Irregular):
    """Waves of a fully developed sea: S = 5/16 Hs^2 w_p^4 w^-5 exp(-5/4 (w/w_p)^-4), with the frequency w_p of the peak.

    Parameters
    ----------
    height : float [m], significant: four times the standard deviation of the elevation
    period : float [s], of the peak of the spectrum
    seed : int, of phases, frequencies and directions: the same seed, the same waves
    direction : (3,) array_like, level; where the waves go; any length but zero
    spreading : float or None, exponent n of the directions, drawn from cos(theta - theta_0)^n within a right angle of `direction`;
        None: all waves go the same way
    components : int, waves that add up; the time that they take grows with them
    depth : float [m], of the water below the still surface; inf for deep water
    ramp : float [s], over which the waves grow from nothing by the quintic smoothstep; 0: they are there at t = 0

    Source
    ------
    DNV-RP-C205 (2010), 3.5.5 (spectrum) and 3.5.8 (directions); Pierson and Moskowitz, J. Geophys. Res. 69 (1964) 5181.
    """

    def spectrum(self, frequency: np.ndarray) -> np.ndarray:
        """Spectrum [m2 s/rad]."""
        return pierson_moskowitz(frequency, self.height, 2.0 * math.pi / self.period)


@dataclass(frozen=True)
class Jonswap(Irregular):
    """Waves of a growing sea: the spectrum of Pierson and Moskowitz times gamma^exp(-(w - w_p)^2/(2 sigma^2 w_p^2)), scaled to Hs.

    sigma is 0.07 below the frequency w_p of the peak and 0.09 above it.

    Parameters
    ----------
    height : float [m], significant: four times the standard deviation of the elevation
    period : float [s], of the peak of the spectrum
    seed : int, of phases, frequencies and directions: the same seed, the same waves
    direction : (3,) array_like, level; where the waves go; any length but zero
    spreading : float or None, exponent n of the directions, drawn from cos(theta - theta_0)^n within a right angle of `direction`;
        None: all waves go the same way
    components : int, waves that add up; the time that they take grows with them
    depth : float [m], of the water below the still surface; inf for deep water
    ramp : float [s], over which the waves grow from nothing by the quintic smoothstep; 0: they are there at t = 0
    gamma : float, of at least 1; how much the peak is higher than that of Pierson and Moskowitz

    Source
    ------
    DNV-RP-C205 (2010), 3.5.5 (spectrum) and 3.5.8 (directions); Hasselmann et al., Dtsch. Hydrogr. Z. A8 (1973) 12.
    """

    gamma: float = 3.3

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "gamma", check_number("gamma", self.gamma, "", "wave Jonswap", sign="positive"))
        if self.gamma < 1.0:
            raise SceneError(f"Argument `gamma` must be at least 1, but wave Jonswap has gamma={self.gamma}.")

    def spectrum(self, frequency: np.ndarray) -> np.ndarray:
        """Spectrum [m2 s/rad], but for the factor that scales it to the height."""
        peak = 2.0 * math.pi / self.period
        sigma = np.where(frequency > peak, 0.09, 0.07)
        return pierson_moskowitz(frequency, self.height, peak) * self.gamma ** np.exp(
            -0.5 * ((frequency / peak - 1.0) / sigma) ** 2
        )


def pierson_moskowitz(frequency: np.ndarray, height: float, peak: float) -> np.ndarray:
    """Spectrum [m2 s/rad] of a significant height [m] and a circular frequency of the peak [rad/s]."""
    x = frequency / peak
    return 0.3125 * height**2 / peak * x**-5 * np.exp(-1.25 * x**-4)
