"""Isotropic Dryden turbulence as a frozen field of random Fourier modes."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_count, check_number, check_vector, shown
from anet_lumped.compiled.jit import inlined, sum_on_demand

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
    modes : int, wave vectors; each takes some 3 ns a node and evaluation, so that 200 of them cost about as much as the cable

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
        """Velocity that carries the field [m/s], then k_m [rad/m], a_m and b_m [m/s] of all modes, each component by itself."""
        random, n = np.random.default_rng(self.seed), self.modes
        k = np.array([wave_number(share) for share in (random.permutation(n) + random.random(n)) / n]) / self.length
        towards, first, second = _frames(n, random)
        phase = random.uniform(0.0, 2.0 * math.pi, (2, n, 1))
        # the n modes of two waves of amplitude A have variance A^2/2 (I - k k^T/k^2), on average A^2/3 I each
        amplitude = self.sigma * math.sqrt(3.0 / n)
        a = amplitude * (np.cos(phase[0]) * first + np.cos(phase[1]) * second)
        b = amplitude * (np.sin(phase[0]) * first + np.sin(phase[1]) * second)
        return np.concatenate([self.carried, np.hstack([k[:, None] * towards, a, b]).T.ravel()])

    def steady(self) -> None:
        """Nothing: its mean is zero."""

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


QUADRANT = 1.5707963267341256, 6.0771005063039660e-11, 2.0222662487959506e-21  # pi/2, in parts whose multiples are exact
EDGE = 0.7853981634  # pi/4, to which a phase is brought; beyond 1e15 rad, where it has no digits left, it must not be larger


@inlined
def _sine_and_cosine(x):
    """Sine and cosine of x, to 1e-16 and the rounding of x, without branches, so that a processor takes several at once.

    Source: the polynomials of fdlibm's k_sin.c and k_cos.c (Sun Microsystems, 1993), after the reduction of Cody and Waite.
    """
    n = math.floor(x * (2.0 / math.pi) + 0.5)
    r = ((x - n * QUADRANT[0]) - n * QUADRANT[1]) - n * QUADRANT[2]
    r = EDGE if r > EDGE else r
    r = -EDGE if r < -EDGE else r
    z = r * r
    s = z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    s = -1.66666666666666324348e-01 + z * (
        8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * (2.75573137070700676789e-06 + s))
    )
    s = r + r * z * s
    c = z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
    c = z * (2.48015872894767294178e-05 + z * (-2.75573143513906633035e-07 + c))
    c = 1.0 - 0.5 * z + z * z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + c))
    quarter = n - 4.0 * math.floor(0.25 * n)
    odd = (quarter == 1.0) | (quarter == 3.0)
    sine, cosine = c if odd else s, s if odd else c
    return -sine if quarter >= 2.0 else sine, -cosine if (quarter == 1.0) | (quarter == 2.0) else cosine


@sum_on_demand
def _velocity(t, x, y, z, numbers):
    n = (len(numbers) - 3) // 9
    kx, ky, kz = numbers[3 : 3 + n], numbers[3 + n : 3 + 2 * n], numbers[3 + 2 * n : 3 + 3 * n]
    ax, ay, az = numbers[3 + 3 * n : 3 + 4 * n], numbers[3 + 4 * n : 3 + 5 * n], numbers[3 + 5 * n : 3 + 6 * n]
    bx, by, bz = numbers[3 + 6 * n : 3 + 7 * n], numbers[3 + 7 * n : 3 + 8 * n], numbers[3 + 8 * n : 3 + 9 * n]
    u, v, w = 0.0, 0.0, 0.0
    ux, uy, uz, vx, vy, vz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    X, Y, Z = x - numbers[0] * t, y - numbers[1] * t, z - numbers[2] * t
    for m in range(n):
        sine, cosine = _sine_and_cosine(kx[m] * X + ky[m] * Y + kz[m] * Z)
        u += ax[m] * cosine + bx[m] * sine
        v += ay[m] * cosine + by[m] * sine
        w += az[m] * cosine + bz[m] * sine
        du, dv, dw = bx[m] * cosine - ax[m] * sine, by[m] * cosine - ay[m] * sine, bz[m] * cosine - az[m] * sine
        ux, uy, uz = ux + du * kx[m], uy + du * ky[m], uz + du * kz[m]
        vx, vy, vz = vx + dv * kx[m], vy + dv * ky[m], vz + dv * kz[m]
        wx, wy, wz = wx + dw * kx[m], wy + dw * ky[m], wz + dw * kz[m]
    return (u, v, w), (ux, uy, uz, vx, vy, vz, wx, wy, wz)
