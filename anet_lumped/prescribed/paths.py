"""Prescribed motions of driven points: exact position, velocity and acceleration at any time.

A path is a piecewise polynomial in time plus, for `harmonic`, one sine with a smooth start. `Path.at` evaluates one
path in plain Python; `pack` lays several out as the flat arrays that `path_kernel.evaluate` reads in compiled code.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import LARGEST, SceneError, Vector, check_count, check_direction, check_number, check_vector, shown
from anet_lumped.limits import ROWS, check_most

from .smoothstep import ramped

HELD_AFTER = 1e-9  # of the last interval of states, beyond rounding of the time: so long after the last one their path is held
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
    """A prescribed motion; make one with `line`, `samples`, `states`, `harmonic`, `circle`, `lift` or `external`.

    From breaks[k] to breaks[k + 1] (the last one without end) the position is Σ coefficients[k, i]·(t − breaks[k])^i,
    plus the harmonic if there is one. Before breaks[0] the polynomial part is held.

    Parameters
    ----------
    kind : "line", "samples", "states", "harmonic", "circle", "lift" or "external"
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

    @cached_property
    def start(self) -> Vector:
        """Position at t = 0 [m]."""
        return tuple(self.at(0.0)[0].tolist())

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
    for place in PLACES[path.kind]:
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


def samples(t: Sequence[float], xyz: Sequence[Vector], ends: Sequence[Vector] | None = None, periods: int | None = None) -> Path:
    """Return a smooth motion through sampled positions, from rest at the first to rest at the last.

    The cubic spline through the samples, clamped to zero velocity at both ends; held at the first sample before
    t[0] and at the last after t[-1]. Held means at rest, and of all cubic splines only the clamped one meets rest
    without a jump of velocity, a blow to the cable; its acceleration jumps, so both ends are corners. A recording that
    begins or ends in flight is therefore brought up to speed within its first interval and to rest within its last,
    and the disturbance shrinks by 0.27 from sample to sample: record from rest to rest, add samples that lead in
    and out, or give the velocities at the `ends`. The spline passes through every sample, noise included: smooth noisy
    positions first.

    Parameters
    ----------
    t : (k,) array_like [s], increasing, k ≥ 2
    xyz : (k, 3) array_like [m]
    ends : (2, 3) array_like or None [m/s], velocities at the first and the last sample, with which it then goes on; at rest if None
    periods : int or None, times that it is run through, as a periodic spline; it must end where it begins

    Raises
    ------
    SceneError : fewer than two samples, times that do not increase, shapes that do not fit, values not finite, a periodic motion
        that does not end where it begins
    """
    times, places = _check_samples("samples", "xyz", "m", t, xyz)
    parameters: tuple = (("t", tuple(times.tolist())), ("xyz", tuple(map(tuple, places.tolist()))))
    from scipy.interpolate import CubicSpline

    if periods is not None:
        periods = check_count("periods", periods, "samples")
        _check_closed(places, ends)
        spline = CubicSpline(times, np.vstack([places[:-1], places[:1]]), bc_type="periodic")
        parameters += (("periods", periods),)
        begins = (times[-1] - times[0]) * np.arange(periods + 1)
        times = np.append((times[:-1] + begins[:-1, None]).ravel(), times[0] + begins[-1])
        after = np.zeros(3)
    else:
        speeds = np.zeros((2, 3)) if ends is None else _check_ends(ends)
        spline = CubicSpline(times, places, bc_type=((1, speeds[0]), (1, speeds[1])))
        parameters += () if ends is None else (("ends", tuple(map(tuple, speeds.tolist()))),)
        after = speeds[1]
        periods = 1
    coefficients = np.zeros((len(times), DEGREE + 1, 3))
    coefficients[:-1, :4] = np.tile(np.moveaxis(spline.c[::-1], 0, 1), (periods, 1, 1))
    coefficients[-1, 0], coefficients[-1, 1] = places[-1], after
    return Path("samples", parameters, times.copy(), coefficients, times[[0, -1]])


def _check_ends(ends: Any) -> np.ndarray:
    try:
        speeds = np.asarray(ends, dtype=float)
    except (TypeError, ValueError, OverflowError):
        speeds = np.zeros(0)
    if speeds.shape != (2, 3) or not np.isfinite(speeds).all():
        raise SceneError(f"Argument `ends` of samples must be two velocities of three finite numbers [m/s], but is {shown(ends)}.")
    return speeds


def _check_closed(places: np.ndarray, ends: Any) -> None:
    """A periodic motion must end where it begins, and needs no velocities at its ends."""
    if ends is not None:
        raise SceneError("Only one of `ends` and `periods` of samples may be given, but both are.")
    miss = float(np.abs(places[-1] - places[0]).max())
    if miss > 1e-9 * float(np.ptp(places, axis=0).max()):
        raise SceneError(f"Periodic samples must end where they begin, but the last is {miss:.3g} m from the first.")


def states(t: Sequence[float], xyz: Sequence[Vector], velocity: Sequence[Vector], acceleration: Sequence[Vector]) -> Path:
    """Return a smooth motion through places at given velocities and accelerations, as another motion has them at these times.

    From sample to sample the polynomial of degree 5 that has all three at both ends: twice continuously differentiable, and off by
    h^6/46080 times the sixth derivative at intervals h. Held at the first place before t[0] and at the last after t[-1], where it
    still has the last velocity: a run that ends there ends in that motion, and not with the blow of its stop.

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
    breaks = times.copy()
    breaks[-1] += HELD_AFTER * (times[-1] - times[-2])
    arrays = (("xyz", q), ("velocity", v), ("acceleration", a))
    parameters = (("t", tuple(times.tolist())), *((name, tuple(map(tuple, rows.tolist()))) for name, rows in arrays))
    return Path("states", parameters, breaks, coefficients, times[[0, -1]])


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


def circle(start: Vector, center: Vector, axis: Vector, period: float, turns: float, ramp: float = 0.0) -> Path:
    """Return a motion along a circle, from rest at `start` around `center` and to rest again after so many `turns`.

    The angle has the rate S(t/ramp)·2π/period, S(s) = 6s⁵ − 15s⁴ + 10s³, and slows down likewise. Between 64 places a turn, and 32
    or more in each ramp, the polynomials of `states`: off by (2π/64)⁶/46080 = 2e-11 of the radius.

    Parameters
    ----------
    start : (3,) array_like [m], place up to t = 0
    center : (3,) array_like [m], a place on the axis
    axis : (3,) array_like, about which it turns by the right hand; its length must not be zero
    period : float [s], of a turn at full speed
    turns : float, up to where it stops
    ramp : float [s], time to reach full speed, and to stop from it; 0 for at once

    Raises
    ------
    SceneError : what is no vector or number, a start on the axis, a ramp that leaves no time at full speed
    """
    start, center = check_vector("start", start, "m", "circle"), check_vector("center", center, "m", "circle")
    axis = check_direction("axis", axis, "circle")
    period = check_number("period", period, "s", "circle", sign="positive")
    turns = check_number("turns", turns, "", "circle", sign="positive")
    ramp = _check_ramp(ramp, "circle")
    normal, arm = np.array(axis) / np.linalg.norm(axis), np.subtract(start, center)
    radius = arm - (arm @ normal) * normal
    if not np.linalg.norm(radius) > 1e-9 * np.linalg.norm(arm):
        raise SceneError(f"A circle must start away from its axis, but it has start={start} and center={center}.")
    if ramp > turns * period:
        raise SceneError(
            f"A circle of {turns:g} turns in {period:g} s each may have a ramp of {turns * period:g} s at most, but has {ramp:g} s."
        )
    check_most(ROWS, 128.0 * turns, f"A circle of {turns:g} turns")
    steady, rate = turns * period - ramp, 2.0 * math.pi / period
    pieces = max(1, math.ceil(64 * steady / period))
    times = np.linspace(ramp, ramp + steady, pieces + 1) if steady > 0.0 else np.array([ramp])
    if ramp > 0.0:
        rising = np.linspace(0.0, ramp, max(32, math.ceil(128 * ramp / period)) + 1)
        times = np.concatenate([rising[:-1], times, (2.0 * ramp + steady - rising[::-1])[1:]])
    angles = np.array([_angle(t, rate, ramp, steady) for t in times.tolist()])
    across, (theta, speed, gain) = np.cross(normal, radius), angles.T[:, :, None]
    outward, ahead = np.cos(theta) * radius + np.sin(theta) * across, np.cos(theta) * across - np.sin(theta) * radius
    q, v, a = np.array(start) - radius + outward, speed * ahead, gain * ahead - speed**2 * outward
    path = states(tuple(times.tolist()), tuple(map(tuple, q)), tuple(map(tuple, v)), tuple(map(tuple, a)))
    coefficients = path.coefficients
    coefficients[0, 0] = start
    parameters = (("start", start), ("center", center), ("axis", axis), ("period", period), ("turns", turns), ("ramp", ramp))
    corners = path.corners if ramp == 0.0 else np.zeros(0)
    return Path("circle", parameters, path.breaks, coefficients, corners)


def _angle(t: float, rate: float, ramp: float, steady: float) -> tuple[float, float, float]:
    """Angle [rad], its rate and the change of that, on a circle from rest to rest."""
    whole = rate * (ramp + steady)
    if t > ramp + 0.5 * steady and ramp > 0.0:  # as it began, backwards
        angle, speed, gain = _angle(2.0 * ramp + steady - t, rate, ramp, steady)
        return whole - angle, speed, -gain
    if t >= ramp:
        return rate * (t - 0.5 * ramp), rate, 0.0
    s = t / ramp
    share, slope = s**3 * (6.0 * s * s - 15.0 * s + 10.0), 30.0 * (s * (1.0 - s)) ** 2
    return rate * ramp * s**4 * (s * s - 3.0 * s + 2.5), rate * share, rate * slope / ramp


def lift(start: Vector, by: Vector, duration: float, hold: float | None = None) -> Path:
    """Return a motion from rest at `start` to rest at start + by, and back again after a while if `hold` is given.

    q(t) = start + by·S(t/duration), S(s) = 6s⁵ − 15s⁴ + 10s³.

    Parameters
    ----------
    start : (3,) array_like [m], place up to t = 0
    by : (3,) array_like [m], how far, such as (0, 0, 2) to lift
    duration : float [s], of the way, and of the way back
    hold : float or None [s], time to wait before the way back; None to stay

    Raises
    ------
    SceneError : what is no vector or number, a duration below a microsecond
    """
    start, by = check_vector("start", start, "m", "lift"), check_vector("by", by, "m", "lift")
    duration = check_number("duration", duration, "s", "lift", sign="positive")
    _check_ramp(duration, "lift", "duration")
    parameters: tuple = (("start", start), ("by", by), ("duration", duration))
    up, rest = np.zeros((DEGREE + 1, 3)), np.zeros((DEGREE + 1, 3))
    up[0], rest[0] = start, np.add(start, by)
    for power, factor in ((3, 10.0), (4, -15.0), (5, 6.0)):
        up[power] = factor * np.array(by) / duration**power
    if hold is None:
        return Path("lift", parameters, np.array([0.0, duration]), np.stack([up, rest]), np.zeros(0))
    hold = check_number("hold", hold, "s", "lift", sign="non-negative")
    down, still = -up, np.zeros((DEGREE + 1, 3))
    down[0], still[0] = rest[0], start
    breaks = np.array([0.0, duration, duration + hold, 2.0 * duration + hold])
    pieces = np.stack([up, rest, down, still])
    if hold == 0.0:
        breaks, pieces = breaks[[0, 2, 3]], pieces[[0, 2, 3]]
    return Path("lift", (*parameters, ("hold", hold)), breaks, pieces, np.zeros(0))


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
    "line": line, "samples": samples, "states": states, "harmonic": harmonic, "circle": circle, "lift": lift, "external": external
}  # fmt: skip
PLACES = {
    "line": ("start",), "samples": ("xyz",), "states": ("xyz",), "harmonic": ("center",), "circle": ("start", "center"),
    "lift": ("start",), "external": ("start",),
}  # fmt: skip
"""Which parameters of a path are places."""


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


def _check_ramp(ramp: Any, owner: str, name: str = "ramp") -> float:
    ramp = check_number(name, ramp, "s", owner, sign="non-negative")
    if ramp and not SHORTEST_RAMP <= ramp <= LONGEST_RAMP:
        raise SceneError(
            f"Argument `{name}` must be zero or at least {SHORTEST_RAMP} s and up to {LONGEST_RAMP:g}, but {owner} has "
            f"{name}={ramp}."
        )
    return ramp
