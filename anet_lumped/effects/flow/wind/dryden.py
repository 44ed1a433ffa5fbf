"""Isotropic Dryden turbulence as a frozen field of random Fourier modes."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_count, check_number, check_vector, shown
from anet_lumped.compiled.jit import on_demand

from .base import Wind


@dataclass(frozen=True)
class Dryden(Wind):
    """Turbulence about a mean wind that carries it: u(t, x) = sum_m a_m cos(k_m.y) + b_m sin(k_m.y), y = x - carried t.

    The longitudinal and lateral correlations are f(r) = exp(-r/length) and g(r) = f + r f'/2 = (1 - r/(2 length)) exp(-r/length)
    (von Karman and Howarth), the one-sided spectra along any line

        Phi_u = sigma^2 (2 L/pi)/(1 + (L W)^2),  Phi_v = Phi_w = sigma^2 (L/pi) (1 + 3 (L W)^2)/(1 + (L W)^2)^2

    over the spatial frequency W [rad/m], and the energy spectrum is E(k) = (8 sigma^2 L/pi) (L k)^4/(1 + (L k)^2)^3. Each wave
    vector k_m has the same share of that energy: the spectrum is cut into parts of equal energy, and the size of one k_m is drawn
    from each part. Their directions spread evenly over the sphere. Each k_m has two waves whose velocities are across k_m and at
    right angles to each other, with random phases, so that the field has no divergence. With a finite number of modes the spectra
    hold as an average over seeds.

    Parameters
    ----------
    sigma : float [m/s], standard deviation of each component
    length : float [m], integral length scale L
    carried : (3,) array_like [m/s], mean wind that carries the field (Taylor); it is not part of this wind
    seed : int, of the random modes: the same seed, the same field
    modes : int, wave vectors; the time that the wind takes grows with them

    Source
    ------
    MIL-F-8785C (1980), 3.7.2.2 (Dryden form) with sigma_u = sigma_v = sigma_w and L_u = L_v = L_w, as it has them above 2000 ft;
    MIL-HDBK-1797 writes 2 L_v for this L_v. E(k) from Phi_u: Pope, Turbulent Flows (2000), 6.5.3. Random modes: Kraichnan,
    Phys. Fluids 13 (1970) 22.
    """

    sigma: float
    length: float
    carried: Vector
    seed: int
    modes: int = 200

    def __post_init__(self) -> None:
        owner = "wind Dryden"
        object.__setattr__(self, "sigma", check_number("sigma", self.sigma, "m/s", owner, sign="non-negative"))
        object.__setattr__(self, "length", check_number("length", self.length, "m", owner, sign="positive"))
        object.__setattr__(self, "carried", check_vector("carried", self.carried, "m/s", owner))
        object.__setattr__(self, "modes", check_count("modes", self.modes, owner))
        if not isinstance(self.seed, int) or isinstance(self.seed, bool) or self.seed < 0:
            raise SceneError(f"Argument `seed` must be an integer of at least 0, but {owner} has seed={shown(self.seed)}.")

    def numbers(self) -> np.ndarray:
        """Velocity that carries the field [m/s], then k_m [rad/m], a_m and b_m [m/s] of each mode."""
        random, n = np.random.default_rng(self.seed), self.modes
        k = np.array([wave_number(share) for share in (random.permutation(n) + random.random(n)) / n]) / self.length
        towards, first, second = _frames(n, random)
        phase = random.uniform(0.0, 2.0 * math.pi, (2, n, 1))
        # the n modes of two waves of amplitude A have variance A^2/2 (I - k k^T/k^2), on average A^2/3 I each
        amplitude = self.sigma * math.sqrt(3.0 / n)
        a = amplitude * (np.cos(phase[0]) * first + np.cos(phase[1]) * second)
        b = amplitude * (np.sin(phase[0]) * first + np.sin(phase[1]) * second)
        return np.concatenate([self.carried, np.hstack([k[:, None] * towards, a, b]).ravel()])

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `Wind`."""
        return _velocity


def energy_below(x: float) -> float:
    """Share of the energy that wave numbers k below x/L have, (16/(3 pi)) int_0^x y^4/(1 + y^2)^3 dy."""
    return (2.0 * math.atan(x) - 2.0 * x * (5.0 * x * x + 3.0) / (3.0 * (1.0 + x * x) ** 2)) / math.pi


def wave_number(share: float) -> float:
    """Wave number times L below which a given share of the energy lies; the inverse of `energy_below`."""
    from scipy.optimize import brentq

    # the share above x is about (16/(3 pi))/x, which bounds x from above
    high = 2.0 + 2.0 / max(1.0 - share, 1e-12)
    return brentq(lambda x: energy_below(x) - share, 0.0, high, xtol=1e-12)


def _frames(n: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """n right-handed frames (n, 3) each; the first axes spread evenly over the sphere (Fibonacci lattice, turned at random)."""
    i = np.arange(n) + 0.5
    height, angle = 1.0 - 2.0 * i / n, math.pi * (1.0 + math.sqrt(5.0)) * i
    level = np.sqrt(1.0 - height**2)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    axis = np.column_stack([level * np.cos(angle), level * np.sin(angle), height]) @ turn.T
    other = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis), axis=1)])
    other /= np.linalg.norm(other, axis=1, keepdims=True)
    return axis, other, np.cross(axis, other)


@on_demand
def _velocity(t, x, y, z, numbers):
    u, v, w = 0.0, 0.0, 0.0
    ux, uy, uz, vx, vy, vz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    X, Y, Z = x - numbers[0] * t, y - numbers[1] * t, z - numbers[2] * t
    for m in range(3, len(numbers), 9):
        kx, ky, kz = numbers[m], numbers[m + 1], numbers[m + 2]
        phase = kx * X + ky * Y + kz * Z
        cosine, sine = math.cos(phase), math.sin(phase)
        u += numbers[m + 3] * cosine + numbers[m + 6] * sine
        v += numbers[m + 4] * cosine + numbers[m + 7] * sine
        w += numbers[m + 5] * cosine + numbers[m + 8] * sine
        du = numbers[m + 6] * cosine - numbers[m + 3] * sine
        dv = numbers[m + 7] * cosine - numbers[m + 4] * sine
        dw = numbers[m + 8] * cosine - numbers[m + 5] * sine
        ux, uy, uz = ux + du * kx, uy + du * ky, uz + du * kz
        vx, vy, vz = vx + dv * kx, vy + dv * ky, vz + dv * kz
        wx, wy, wz = wx + dw * kx, wy + dw * ky, wz + dw * kz
    return (u, v, w), (ux, uy, uz, vx, vy, vz, wx, wy, wz)
