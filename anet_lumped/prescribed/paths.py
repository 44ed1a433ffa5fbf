"""Prescribed motions of driven points: exact position, velocity and acceleration at any time.

A path is a piecewise polynomial in time plus, for `harmonic`, one sine with a smooth start. `Path.at` evaluates one
path in plain Python; `pack` lays several out as the flat arrays that `path_kernel.evaluate` reads in compiled code.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import LARGEST, SceneError, Vector, check_number, check_vector

from .smoothstep import ramped

DEGREE = 6  # the integral of the quintic smoothstep; a spline needs 3
SHORTEST_RAMP = 1e-6  # [s]; far below, the coefficients velocity/ramp⁵ overflow
LONGEST_RAMP = 1e12  # [s]; far above, ramp⁵ overflows


class Harmonic(NamedTuple):
    """One sine, S(t/ramp)·amplitude·sin(omega·t + phase), S the quintic smoothstep (S = 1 for ramp = 0)."""

    amplitude: Vector
    omega: float
    phase: float
    ramp: float


@dataclass(frozen=True, repr=False)
class Path:
    """A prescribed motion; make one with `line`, `samples`, `states`, `harmonic` or `external`.

    From breaks[k] to breaks[k + 1] (the last one without end) the position is Σ coefficients[k, i]·(t − breaks[k])^i,
    plus the harmonic if there is one. Before breaks[0] the polynomial part is held.

    Parameters
    ----------
    kind : "line", "samples", "states", "harmonic" or "external"
    parameters : pairs (name, value) of that function's arguments; they alone decide equality
    breaks : (k,) float64 [s]
    coefficients : (k, 7, 3) float64 [m/s^i]
    corners : (c,) float64 [s], times where the path is less smooth than C2, for integrators to land on
    sine : the harmonic or None
    """

    kind: str
    parameters: tuple[tuple[str, Any], ...]
    breaks: np.ndarray = field(compare=False)
    coefficients: np.ndarray = field(compare=False)
    corners: np.ndarray = field(compare=False)
    sine: Harmonic | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        return f"{self.kind}({', '.join(f'{name}={value!r}' for name, value in self.parameters)})"

    def at(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position [m], velocity [m/s] and acceleration [m/s²] at time `t` [s], each (3,).

        At a corner they are the limits from the right.
        """
        piece = max(int(np.searchsorted(self.breaks, t, side="right")) - 1, 0)
        tau = t - self.breaks[piece]
        c = self.coefficients[piece]
        if tau < 0.0:
            q, v, a = c[0].copy(), np.zeros(3), np.zeros(3)
        else:
            i = np.arange(DEGREE + 1)
            q = tau**i @ c
            v = (i[1:] * tau ** i[:-1]) @ c[1:]
            a = (i[2:] * i[1:-1] * tau ** i[:-2]) @ c[2:]
        if self.sine is not None:
            amplitude, omega, phase, ramp = self.sine
            e, de, dde = ramped(t, ramp)
            s, c = math.sin(omega * t + phase), math.cos(omega * t + phase)
            swing = np.array(amplitude)
            q += swing * (e * s)
            v += swing * (de * s + e * omega * c)
            a += swing * (dde * s + 2.0 * de * omega * c - e * omega**2 * s)
        return q, v, a


def seen_from(path: Path, origin: Vector) -> Path:
    """Return the same motion in coordinates whose origin lies at ``origin`` (3,) [m] of today's."""
    parameters: dict[str, Any] = dict(path.parameters)
    place = {"line": "start", "samples": "xyz", "states": "xyz", "harmonic": "center", "external": "start"}[path.kind]
    parameters[place] = (np.array(parameters[place]) - origin).tolist()
    return KINDS[path.kind](**parameters)


def line(start: Vector, velocity: Vector, ramp: float) -> Path:
    """Return a motion along a straight line, from rest at `start` to a constant velocity.

    v(t) = velocity·S(t/ramp), S(s) = 6s⁵ − 15s⁴ + 10s³; at rest before t = 0.

    Parameters
    ----------
    start : (3,) array_like [m], place up to t = 0
    velocity : (3,) array_like [m/s]
    ramp : float [s], time to reach the velocity; 0 for at once, a corner at t = 0

    Raises
    ------
    SceneError : a vector that is not three finite numbers, a negative ramp or one below a microsecond
    """
    start = check_vector("start", start, "m", "line")
    velocity = check_vector("velocity", velocity, "m/s", "line")
    ramp = _check_ramp(ramp, "line")
    parameters = (("start", start), ("velocity", velocity), ("ramp", ramp))
    q, v = np.array(start), np.array(velocity)
    steady = np.zeros((DEGREE + 1, 3))
    steady[0], steady[1] = q + 0.5 * ramp * v, v  # S has mean 1/2
    if ramp == 0.0:
        return Path("line", parameters, np.zeros(1), steady[None], np.zeros(1))
    rising = np.zeros((DEGREE + 1, 3))
    rising[0] = q
    for power, factor in ((4, 2.5), (5, -3.0), (6, 1.0)):
        rising[power] = factor * v / ramp ** (power - 1)
    return Path("line", parameters, np.array([0.0, ramp]), np.stack([rising, steady]), np.zeros(0))


def samples(t: Sequence[float], xyz: Sequence[Vector]) -> Path:
    """Return a smooth motion through sampled positions, from rest at the first to rest at the last.

    The cubic spline through the samples, clamped to zero velocity at both ends; held at the first sample before
    t[0] and at the last after t[-1]. Held means at rest, and of all cubic splines only the clamped one meets rest
    without a jump of velocity, a blow to the cable; its acceleration jumps, so both ends are corners. A recording that
    begins or ends in flight is therefore brought up to speed within its first interval and to rest within its last,
    and the disturbance shrinks by 0.27 from sample to sample: record from rest to rest or add samples that lead in
    and out. The spline passes through every sample, noise included: smooth noisy positions first.

    Parameters
    ----------
    t : (k,) array_like [s], increasing, k ≥ 2
    xyz : (k, 3) array_like [m]

    Raises
    ------
    SceneError : fewer than two samples, times that do not increase, shapes that do not fit, values not finite
    """
    times, places = _check_samples("samples", "xyz", "m", t, xyz)
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(times, places, bc_type="clamped")
    coefficients = np.zeros((len(times), DEGREE + 1, 3))
    coefficients[:-1, :4] = np.moveaxis(spline.c[::-1], 0, 1)
    coefficients[-1, 0] = places[-1]
    parameters = (("t", tuple(times.tolist())), ("xyz", tuple(map(tuple, places.tolist()))))
    return Path("samples", parameters, times.copy(), coefficients, times[[0, -1]])


def states(t: Sequence[float], xyz: Sequence[Vector], velocity: Sequence[Vector], acceleration: Sequence[Vector]) -> Path:
    """Return a smooth motion through places at given velocities and accelerations, as another motion has them at these times.

    From sample to sample the polynomial of degree 5 that has all three at both ends: twice continuously differentiable, and off by
    h^6/46080 times the sixth derivative at intervals h. Held at the first place before t[0] and at the last after t[-1].

    Parameters
    ----------
    t : (k,) array_like [s], increasing, k >= 2
    xyz, velocity, acceleration : (k, 3) array_like [m], [m/s], [m/s2]

    Raises
    ------
    SceneError : as `samples`
    """
    times, q = _check_samples("states", "xyz", "m", t, xyz)
    _, v = _check_samples("states", "velocity", "m/s", t, velocity)
    _, a = _check_samples("states", "acceleration", "m/s²", t, acceleration)
    h = np.diff(times)[:, None]
    way = q[1:] - q[:-1] - h * v[:-1] - 0.5 * h**2 * a[:-1]  # beyond the Taylor polynomial of the start, and its two slopes
    slope, bend = h * (v[1:] - v[:-1] - h * a[:-1]), h**2 * (a[1:] - a[:-1])
    coefficients = np.zeros((len(times), DEGREE + 1, 3))
    coefficients[:-1, :3] = np.stack([q[:-1], v[:-1], 0.5 * a[:-1]], axis=1)
    for power, (of_way, of_slope, of_bend) in enumerate(((10.0, -4.0, 0.5), (-15.0, 7.0, -1.0), (6.0, -3.0, 0.5)), start=3):
        coefficients[:-1, power] = (of_way * way + of_slope * slope + of_bend * bend) / h**power
    coefficients[-1, 0] = q[-1]
    arrays = (("xyz", q), ("velocity", v), ("acceleration", a))
    parameters = (("t", tuple(times.tolist())), *((name, tuple(map(tuple, rows.tolist()))) for name, rows in arrays))
    return Path("states", parameters, times.copy(), coefficients, times[[0, -1]])


def harmonic(center: Vector, amplitude: Vector, frequency: float, phase: float = 0.0, ramp: float = 0.0) -> Path:
    """Return a harmonic motion, q(t) = center + S(t/ramp)·amplitude·sin(2π·frequency·t + phase).

    S(s) = 6s⁵ − 15s⁴ + 10s³ between 0 and 1: at rest in the centre before t = 0, full swing from t = ramp on. With
    ramp = 0 the full swing lasts for ever, before t = 0 as well.

    Parameters
    ----------
    center : (3,) array_like [m]
    amplitude : (3,) array_like [m]
    frequency : float [Hz]
    phase : float [rad]
    ramp : float [s]

    Raises
    ------
    SceneError : a vector that is not three finite numbers, a negative frequency, a negative ramp or one below a
        microsecond
    """
    center = check_vector("center", center, "m", "harmonic")
    amplitude = check_vector("amplitude", amplitude, "m", "harmonic")
    frequency = check_number("frequency", frequency, "Hz", "harmonic", sign="non-negative")
    phase = check_number("phase", phase, "rad", "harmonic")
    ramp = _check_ramp(ramp, "harmonic")
    parameters = (
        ("center", center), ("amplitude", amplitude), ("frequency", frequency), ("phase", phase), ("ramp", ramp)
    )  # fmt: skip
    coefficients = np.zeros((1, DEGREE + 1, 3))
    coefficients[0, 0] = center
    sine = Harmonic(amplitude, 2.0 * math.pi * frequency, phase, ramp)
    return Path("harmonic", parameters, np.zeros(1), coefficients, np.zeros(0), sine)


def external(start: Vector) -> Path:
    """Return the motion of a point that a `Session` drives from outside, step by step; at rest at `start` until it does.

    Parameters
    ----------
    start : (3,) array_like [m]

    Raises
    ------
    SceneError : not three finite numbers
    """
    start = check_vector("start", start, "m", "external")
    coefficients = np.zeros((2, DEGREE + 1, 3))  # the piece of a step, and its end
    coefficients[:, 0] = start
    return Path("external", (("start", start),), np.zeros(2), coefficients, np.zeros(0))


KINDS: dict[str, Callable[..., Path]] = {
    "line": line, "samples": samples, "states": states, "harmonic": harmonic, "external": external
}  # fmt: skip


class PathTable(NamedTuple):
    """Several paths as flat arrays, of the same types whatever the paths; the pieces of path p are first[p] to
    first[p + 1] − 1, harmonic h belongs to path harmonic_path[h]."""

    first: np.ndarray  # (n_paths + 1,) int64
    breaks: np.ndarray  # (n_pieces,) float64 [s]
    coefficients: np.ndarray  # (n_pieces, 7, 3) float64 [m/s^i]
    harmonic_path: np.ndarray  # (n_harmonics,) int64
    amplitude: np.ndarray  # (n_harmonics, 3) float64 [m]
    wave: np.ndarray  # (n_harmonics, 3) float64: omega [rad/s], phase [rad], ramp [s]


def pack(paths: Sequence[Path]) -> PathTable:
    """Return the paths as the flat arrays that `path_kernel.evaluate` reads; none is fine."""
    counts = [len(path.breaks) for path in paths]
    waving = [(p, path.sine) for p, path in enumerate(paths) if path.sine is not None]
    return PathTable(
        first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        breaks=np.concatenate([np.zeros(0), *(path.breaks for path in paths)]),
        coefficients=np.concatenate([np.zeros((0, DEGREE + 1, 3)), *(path.coefficients for path in paths)]),
        harmonic_path=np.array([p for p, _ in waving], dtype=np.int64),
        amplitude=np.array([sine.amplitude for _, sine in waving], dtype=float).reshape(-1, 3),
        wave=np.array([sine[1:] for _, sine in waving], dtype=float).reshape(-1, 3),
    )


def _check_samples(owner: str, name: str, unit: str, t: Any, xyz: Any) -> tuple[np.ndarray, np.ndarray]:
    """Times (k,) that increase and finite vectors (k, 3) at them, k at least 2."""
    try:
        times, places = np.asarray(t, dtype=float), np.asarray(xyz, dtype=float)
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(f"Arguments `t` and `{name}` of {owner} must be arrays of numbers, but {error}.") from None
    if times.ndim != 1 or len(times) < 2 or places.shape != (len(times), 3):
        raise SceneError(
            f"Arguments `t` [s] and `{name}` [{unit}] of {owner} must have shapes (k,) and (k, 3) with k at least 2, "
            f"but have {times.shape} and {places.shape}."
        )
    usable = (np.abs(times) <= LARGEST) & (np.abs(places) <= LARGEST).all(axis=1)
    if not usable.all():
        row = int(np.argmin(usable))
        what = f"of a size up to {LARGEST:g}" if np.isfinite(times[row]) and np.isfinite(places[row]).all() else "finite"
        raise SceneError(
            f"Arguments `t` [s] and `{name}` [{unit}] of {owner} must be {what}, "
            f"but sample {row} has t={times[row]}, {name}={tuple(places[row].tolist())}."
        )
    if not (np.diff(times) > 0.0).all():
        row = int(np.argmin(np.diff(times) > 0.0))
        raise SceneError(
            f"Argument `t` [s] of {owner} must increase, but t[{row}]={times[row]} is followed by t[{row + 1}]={times[row + 1]}."
        )
    return times, places


def _check_ramp(ramp: Any, owner: str) -> float:
    ramp = check_number("ramp", ramp, "s", owner, sign="non-negative")
    if ramp and not SHORTEST_RAMP <= ramp <= LONGEST_RAMP:
        raise SceneError(
            f"Argument `ramp` must be zero or at least {SHORTEST_RAMP} s and up to {LONGEST_RAMP:g}, but {owner} has ramp={ramp}."
        )
    return ramp
