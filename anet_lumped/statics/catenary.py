"""The shape of a cable at rest under its own weight: the inextensible and the elastic catenary, in closed form.

Along the unstretched arc length s the horizontal tension H is constant and the vertical one grows with the weight:
V(s) = V1 + mu g s, T = sqrt(H^2 + V^2). Over a piece [0, s], with V_m = (V1 + V)/2 and T_m = (T1 + T)/2, the shape is

    x(s) = s H (kappa/T_m + 1/EA),  z(s) = s V_m (1/T_m + 1/EA),  kappa = artanh(y)/y,  y = mu g s/(2 T_m):

This is Irvine's elastic catenary in a form in which no nearly equal numbers are subtracted, whether the cable is a bowstring, a
hairpin or weightless. The shape follows explicitly from the end force. The end force follows from the end points as the root of one
monotone function (`_half_angle`).
"""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from anet_lumped.checks import LARGEST, SMALLEST, InputError, as_entries, number, shown


@dataclass(frozen=True, eq=False)
class Catenary:
    """A cable at rest between two ends; made by `catenary` or `Catenary.from_end_force`.

    Attributes
    ----------
    p1, p2 : (2,) or (3,) float64 [m]
        Where the cable starts and ends; the last coordinate points up.
    length : float [m]
        Unstretched length.
    EA : float [N]
        Axial stiffness, inf for an inextensible cable.
    weight_per_length : float [N/m]
        mu g.
    H, V1 : float [N]
        Tension vector at p1: its horizontal part, towards p2 and never negative, and its vertical part, up.
    direction : (1,) or (2,) float64
        Horizontal unit vector from p1 towards p2; the first axis if the cable hangs in one vertical line.
    """

    p1: np.ndarray
    p2: np.ndarray
    length: float
    EA: float
    weight_per_length: float
    H: float
    V1: float
    direction: np.ndarray

    @classmethod
    def from_end_force(
        cls,
        p1: ArrayLike,
        force: ArrayLike,
        length: float,
        *,
        EA: float | None = None,
        mass_per_length: float = 1.0,
        gravity: float = 9.81,
    ) -> "Catenary":
        """The cable that starts at p1 and pulls there with a given force: explicit, no equation to solve.

        Parameters
        ----------
        p1 : (2,) or (3,) [m]
        force : (2,) or (3,) [N]
            The cable's pull on p1, which is its tension vector there; zero for a loose lower end.
        length, EA, mass_per_length, gravity
            As for `catenary`.

        Raises
        ------
        InputError
            For a wrong argument, and for a cable with neither weight nor end force.

        Source
        ------
        Irvine, Cable Structures, MIT Press 1981, section 1.3.
        """
        p1, force = _vectors(p1=p1, force=force)
        EA, weight_per_length = _material(length, EA, mass_per_length, gravity)
        if weight_per_length == 0 and not force.any():
            raise InputError("A cable with neither weight nor end force has no shape: give a force or a gravity.")
        H = math.hypot(*force[:-1])
        half_made = cls(p1, p1, float(length), EA, weight_per_length, H, float(force[-1]), _direction(force, H))
        return replace(half_made, p2=half_made._place(half_made.length))

    def _piece(self, s: Any) -> tuple[Any, Any, Any]:
        """V_m, T_m and kappa of the piece [0, s]; s may lie beyond the ends."""
        V = self.V1 + self.weight_per_length * s
        T_m = (math.hypot(self.H, self.V1) + np.hypot(self.H, V)) / 2
        T_m = np.maximum(T_m, 1e-300)  # a loose end has no tension, but its piece no extent either
        y = self.weight_per_length * s / (2 * T_m)
        # artanh(y) is half of arsinh(V/H) - arsinh(V1/H); artanh is exact on taut pieces, the difference on folded ones.
        H = np.maximum(np.maximum(self.H, 1e-200 * T_m), 1e-300)
        folded = (np.arcsinh(V / H) - np.arcsinh(self.V1 / H)) / 2
        angle = np.where(np.abs(y) < 0.5, np.arctanh(np.clip(y, -0.5, 0.5)), folded)
        kappa = np.divide(angle, y, out=np.ones_like(angle), where=y != 0)
        return self.V1 + self.weight_per_length * s / 2, T_m, kappa

    def _plane(self, s: Any) -> tuple[np.ndarray, np.ndarray]:
        """Horizontal and vertical distance from p1."""
        V_m, T_m, kappa = self._piece(s)
        return s * self.H * (kappa / T_m + 1 / self.EA), s * V_m * (1 / T_m + 1 / self.EA)

    def _place(self, s: Any) -> np.ndarray:
        x, z = self._plane(s)
        return self.p1 + np.concatenate([np.multiply.outer(x, self.direction), np.expand_dims(z, -1)], axis=-1)

    def _on_cable(self, s: ArrayLike) -> np.ndarray:
        s = np.asarray(s, dtype=float)
        slop = 1e-12 * self.length  # sums of segment lengths may overshoot by round-off
        outside = ~((s >= -slop) & (s <= self.length + slop))
        if outside.any():
            raise InputError(f"Arc length must lie between 0 and the length {self.length:g} m, got {s[outside][0]:g}.")
        return s

    def point(self, s: ArrayLike) -> np.ndarray:
        """Place of the cable at unstretched arc length s from p1.

        Parameters
        ----------
        s : (...) [m]

        Returns
        -------
        (..., 2) or (..., 3) float64 [m]

        Raises
        ------
        InputError
            If an s lies off the cable.
        """
        return self._place(self._on_cable(s))

    def tension(self, s: ArrayLike) -> np.ndarray:
        """Tension T at unstretched arc length s from p1, (...) float64 [N]; s and errors as for `point`."""
        return np.hypot(self.H, self.V1 + self.weight_per_length * self._on_cable(s))

    @property
    def end_forces(self) -> np.ndarray:
        """Pull of the cable on p1 and on p2, (2, 2) or (2, 3) [N]; they add up to its weight."""
        V2 = self.V1 + self.weight_per_length * self.length
        return np.array([[*self.H * self.direction, self.V1], [*-self.H * self.direction, -V2]])

    @property
    def a(self) -> float:
        """Catenary parameter H/(mu g) [m]: 0 for a hairpin, inf without gravity."""
        return self.H / self.weight_per_length if self.weight_per_length else math.inf

    @property
    def _level(self) -> float:
        """Arc length at which the curve, prolonged if need be, is level."""
        return -self.V1 / self.weight_per_length if self.weight_per_length else -math.copysign(math.inf, self.V1)

    @property
    def x0(self) -> float:
        """Where the curve, prolonged if need be, is level [m]: in 2-D the coordinate x, in 3-D the distance from p1
        towards p2; nan without gravity. An inextensible cable follows z = a cosh((x - x0)/a) + b."""
        x = self._plane(self._level)[0] if self.weight_per_length else math.nan
        return float(self.p1[0] + self.direction[0] * x if len(self.p1) == 2 else x)

    @property
    def b(self) -> float:
        """Height of the level point (see `x0`) less a [m]; nan without gravity."""
        return float(self.p1[-1] + self._plane(self._level)[1] - self.a) if self.weight_per_length else math.nan

    @property
    def lowest(self) -> np.ndarray:
        """Lowest point of the cable, (2,) or (3,) [m]: an end if the cable is nowhere level."""
        return self._place(min(max(self._level, 0.0), self.length))

    @property
    def stretched_length(self) -> float:
        """Length under load [m]: L + (1/EA) times the integral of T, which is (L/2)(T_m + (V_m^2 + kappa H^2)/T_m)."""
        V_m, T_m, kappa = self._piece(self.length)
        return float(self.length * (1 + (T_m + (V_m**2 + kappa * self.H**2) / T_m) / (2 * self.EA)))

    @property
    def sag(self) -> float:
        """Largest vertical distance of the cable below its chord [m]; below its lower end if the chord is vertical."""
        d, h = self._plane(self.length)
        if self.weight_per_length == 0 or d == 0:
            return float(min(self.p1[-1], self.p2[-1]) - self.lowest[-1])
        parallel = (self.H * (h / d) - self.V1) / self.weight_per_length  # there the cable runs as the chord does
        x, z = self._plane(min(max(parallel, 0.0), self.length))
        return float(x * (h / d) - z)


def catenary(
    p1: ArrayLike,
    p2: ArrayLike,
    length: float,
    *,
    EA: float | None = None,
    mass_per_length: float = 1.0,
    gravity: float = 9.81,
) -> Catenary:
    """The cable of a given length at rest between two points: inextensible, or elastic if EA is given.

    Parameters
    ----------
    p1, p2 : (2,) or (3,) [m]
        Ends, (x, z) or (x, y, z); gravity acts against the last axis.
    length : float [m]
        Unstretched length.
    EA : float, optional [N]
        Axial stiffness; without it the cable does not stretch.
    mass_per_length : float [kg/m]
    gravity : float [m/s^2]
        Not negative. At zero only a stretched elastic cable has a shape: the straight line.

    Returns
    -------
    Catenary

    Raises
    ------
    InputError
        If an inextensible cable is not longer than its chord, if a cable without gravity is not shorter than its
        chord, or for a wrong argument.

    Source
    ------
    Irvine, Cable Structures, MIT Press 1981, section 1.3; the reduction to one unknown is in `_half_angle`.
    """
    p1, p2 = _vectors(p1=p1, p2=p2)
    EA, weight_per_length = _material(length, EA, mass_per_length, gravity)
    length = float(length)
    span = p2 - p1
    d, h, chord = math.hypot(*span[:-1]), float(span[-1]), math.hypot(*span)
    # in exact arithmetic, because the shape of a nearly taut cable follows from this small difference alone
    square = sum((Fraction(q) - Fraction(p)) ** 2 for p, q in zip(p1.tolist(), p2.tolist(), strict=True))
    excess = float(square / Fraction(length) ** 2 - 1) / (chord / length + 1)  # chord/length - 1

    if math.isinf(EA) and excess >= 0:
        raise InputError(
            f"An inextensible cable must be longer than its chord: the length is {_shortest(length)} m, "
            f"the chord {_shortest(chord)} m; give EA to let it stretch."
        )
    if weight_per_length == 0:
        if excess <= 0:
            raise InputError(
                f"Without gravity only a stretched cable has a shape: the chord {_shortest(chord)} m must exceed "
                f"the length {_shortest(length)} m."
            )
        H, V1 = EA * excess * d / chord, EA * excess * h / chord
        return Catenary(p1, p2, length, EA, 0.0, H, V1, _direction(span, d))

    weight = weight_per_length * length
    e = weight / EA
    if d <= 1e-100 * length:  # vertical: folded into a hairpin, or all of it stretched
        d, rise = 0.0, abs(h) / length
        H, V_m = 0.0, math.copysign(max(rise / (2 + e), excess / e if e else 0.0), h) * weight
    else:
        try:
            u = _half_angle(d / length, h / length, chord / length, excess, e)
        except (ArithmeticError, ValueError):
            raise InputError(
                "A catenary must be of numbers that can be computed with, but "
                f"its chord is {chord / length:.3g} times its length, and its weight {e:.3g} times EA."
            ) from None
        H, V_m = weight * (d / length) / (2 * u + e), weight * (h / length) / (2 * math.tanh(u) + e)
    return Catenary(p1, p2, length, EA, weight_per_length, H, V_m - weight / 2, _direction(span, d))


def _half_angle(d: float, h: float, c: float, excess: float, e: float) -> float:
    """Half of the change u of arsinh(V/H) along the cable, from the chord (d, h) of length c = 1 + excess.

    Lengths are in units of the cable's, forces in units of its weight; e is weight/EA. The two end conditions give
    H = d/(2u + e) and V_m = h/(2 tanh u + e); that the ends differ by the weight then reads

        (2 d sinh(u)/(2u + e))^2 + (2 h tanh(u)/(2 tanh u + e))^2 = 1,

    whose left side grows with u from 0 (from c^2 < 1 if e = 0) to infinity. So there is always one root. Each term is taken
    relative to the straight line of the same chord, so that the small difference of a bowstring is not lost to rounding.
    """
    from scipy.optimize import brentq  # late: it takes longer to import than everything else here together

    def mismatch(log_ratio: float) -> float:
        u = low * math.exp(log_ratio)
        t = math.tanh(u)
        across = (2 * c * _sinh_less_argument(u) + 2 * excess * u - e) / (2 * u + e)
        along = (2 * excess * t - e) / (2 * t + e)
        gap = (d / c) ** 2 * across * (across + 2) + (h / c) ** 2 * along * (along + 2)
        return math.log1p(max(gap, -1 + 1e-15))  # the logarithm makes the hairpin's exponential nearly linear

    # sinh(u)/u <= exp(u^2/6) bounds the inextensible root, 2 c sinh(u) >= e the elastic one; 0.9 is for round-off.
    low = 0.9 * max(math.asinh(e / (2 * c)), math.sqrt(3 * math.log1p(max(-excess * (1 + c), 0.0) / d**2)))
    high = 2 * math.log(max((1 + e) / d, 1.0)) + 2
    return low * math.exp(brentq(mismatch, 0.0, math.log(high / low), xtol=1e-16, rtol=1e-15))


def _sinh_less_argument(u: float) -> float:
    """sinh(u) - u, by its series where the difference would cancel."""
    if u > 1:
        return math.sinh(u) - u
    total = term = u**3 / 6
    for divisor in (20, 42, 72, 110, 156, 210, 272):
        term *= u * u / divisor
        total += term
    return total


def _direction(vector: np.ndarray, horizontal_length: float) -> np.ndarray:
    """Unit vector of the horizontal part; the first axis for a vertical vector."""
    if horizontal_length:
        return vector[:-1] / horizontal_length
    return np.eye(len(vector) - 1)[0]


def _shortest(x: float) -> str:
    """All digits that a float has, and no more: "0.9", "5", where two are as good as equal."""
    return repr(x).removesuffix(".0")


def _vectors(**named: ArrayLike) -> list[np.ndarray]:
    vectors = [np.array([number(x) for x in as_entries(value) or ()]) for value in named.values()]
    for name, vector in zip(named, vectors, strict=True):
        if vector.shape not in {(2,), (3,)} or not np.isfinite(vector).all():
            raise InputError(f"{name} must hold two or three finite numbers, got {shown(named[name])}.")
        if (np.abs(vector) > LARGEST).any():
            raise InputError(f"{name} must hold numbers of a size up to {LARGEST:g}, got {shown(named[name])}.")
    if len({len(vector) for vector in vectors}) > 1:
        given = " and ".join(f"{len(vector)} for {name}" for name, vector in zip(named, vectors, strict=True))
        raise InputError(f"{' and '.join(named)} must have the same number of coordinates, got {given}.")
    return vectors


def _material(length: float, EA: float | None, mass_per_length: float, gravity: float) -> tuple[float, float]:
    """EA [N], inf for None, and mu g [N/m]."""
    for name, value in (("length", length), ("EA", 1.0 if EA is None else EA), ("mass_per_length", mass_per_length)):
        if not 0 < number(value) < math.inf:
            raise InputError(f"{name} must be positive and finite, got {shown(value)}.")
        if not SMALLEST <= number(value) <= LARGEST:
            raise InputError(f"{name} must be of a size from {SMALLEST:g} to {LARGEST:g}, got {shown(value)}.")
    if not 0 <= number(gravity) <= LARGEST:
        raise InputError(f"gravity must be finite and not negative, got {shown(gravity)}.")
    return (math.inf if EA is None else float(EA)), float(mass_per_length) * float(gravity)
