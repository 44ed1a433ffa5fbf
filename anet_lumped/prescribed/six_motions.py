"""The six motions of a platform, and the paths of the points that it carries.

A point that lies at p when the platform is at rest moves as

    q(t) = o + d(t) + R(t) (p - o) ,     R = Rx(roll) Ry(pitch) Rz(yaw) ,

with the origin o of the platform, its surge, sway and heave d, and the rotation that MoorDyn makes of its three angles (Misc.hpp:
EulerXYZ). Velocity and acceleration are the exact derivatives. A path takes all three at 64 times of a period, which leaves 2e-11
of the amplitude, or at the samples of a recording.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_number, check_vector, shown

from . import paths
from .paths import Path
from .signals import Signal
from .smoothstep import ramped

TRANSLATIONS, ROTATIONS = ("surge", "sway", "heave"), ("roll", "pitch", "yaw")
PER_PERIOD = 64  # samples of a swing: (2 pi/64)^6/46080 = 2e-11 of its amplitude


@dataclass(frozen=True)
class SixMotions:
    """Motions of a platform about its place at rest, from `anet_lumped.signals`; what is not given does not move.

    Parameters
    ----------
    surge, sway, heave : Signal or several, which add up [m]
    roll, pitch, yaw : Signal or several, which add up [rad]
    """

    surge: Sequence[Signal] | Signal = ()
    sway: Sequence[Signal] | Signal = ()
    heave: Sequence[Signal] | Signal = ()
    roll: Sequence[Signal] | Signal = ()
    pitch: Sequence[Signal] | Signal = ()
    yaw: Sequence[Signal] | Signal = ()

    def __post_init__(self) -> None:
        for each in fields(self):
            given = getattr(self, each.name)
            signals = (given,) if isinstance(given, Signal) else given
            if not isinstance(signals, Sequence) or not all(isinstance(signal, Signal) for signal in signals):
                raise SceneError(
                    f"Argument `{each.name}` of a platform's motions must be a signal of anet_lumped.signals, or several, but it "
                    f"is {shown(given)}."
                )
            object.__setattr__(self, each.name, tuple(signals))

    @property
    def signals(self) -> tuple[Signal, ...]:
        """All of them."""
        return tuple(signal for each in fields(self) for signal in getattr(self, each.name))

    def at(self, t: float | np.ndarray) -> np.ndarray:
        """Surge, sway, heave [m], roll, pitch, yaw [rad], their rates and second derivatives, (3, 6), or (k, 3, 6) at k times."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        found = np.zeros((len(times), 3, 6))
        for axis, each in enumerate(fields(self)):
            for signal in getattr(self, each.name):
                found[:, :, axis] += _values(signal.path, times)
        return found if np.ndim(t) else found[0]

    def times(self, t_end: float) -> np.ndarray:
        """Times from 0 to t_end [s] at which a path needs the motion."""
        found, step = [np.array([0.0, t_end])], t_end
        for signal in self.signals:
            parameters = dict(signal.parameters)
            if signal.kind == "samples":
                t = np.array(parameters["t"])
                found.append(t[(t > 0.0) & (t < t_end)])
            elif signal.kind == "harmonic" and parameters["frequency"] > 0.0:
                step = min(step, 1.0 / (PER_PERIOD * parameters["frequency"]))
            if parameters.get("ramp"):
                step = min(step, parameters["ramp"] / PER_PERIOD)
        found.append(np.linspace(0.0, t_end, math.ceil(t_end / step - 1e-9) + 1))
        every = np.unique(np.concatenate(found))
        apart = np.diff(every, prepend=-math.inf) > 1e-9 * t_end  # times that differ by rounding are one
        apart[-1] = True
        return every[apart]


def point_paths(motions: SixMotions, places: Sequence[Vector], t_end: float, origin: Vector = (0.0, 0.0, 0.0)) -> list[Path]:
    """Return the paths of points of the platform up to a time.

    Parameters
    ----------
    motions : SixMotions
    places : sequence of (3,) array_like [m]
        Where the points lie when the platform is at rest.
    t_end : float [s]
        After which the points are held.
    origin : (3,) array_like [m]
        About which the platform turns.
    """
    t_end = check_number("t_end", t_end, "s", "the motion of a platform", sign="positive")
    origin = check_vector("origin", origin, "m", "the motion of a platform")
    times = motions.times(t_end)
    values = motions.at(times)
    found = []
    for at in places:
        states = carried(values, np.subtract(check_vector("at", at, "m", "a point of a platform"), origin))
        states[:, 0] += origin
        place, velocity, acceleration = states.swapaxes(0, 1).tolist()
        found.append(paths.states(times.tolist(), place, velocity, acceleration))
    return found


def _values(path: Path, t: np.ndarray) -> np.ndarray:
    """First coordinate of a path at times (k,), its rate and its second derivative, (k, 3)."""
    piece = np.maximum(np.searchsorted(path.breaks, t, side="right") - 1, 0)
    tau = t - path.breaks[piece]
    c = path.coefficients[piece, :, 0]
    moving = tau >= 0.0
    powers = np.where(moving, tau, 0.0)[:, None] ** np.arange(c.shape[1])
    i = np.arange(c.shape[1])
    x = (c * powers).sum(axis=1)
    v = (i[1:] * c[:, 1:] * powers[:, :-1]).sum(axis=1)
    a = (i[2:] * i[1:-1] * c[:, 2:] * powers[:, :-2]).sum(axis=1)
    found = np.column_stack([x, np.where(moving, v, 0.0), np.where(moving, a, 0.0)])
    if path.sine is not None:
        amplitude, omega, phase, ramp = path.sine
        e, de, dde = np.array([ramped(time, ramp) for time in t.tolist()]).T
        sine, cosine = np.sin(omega * t + phase), np.cos(omega * t + phase)
        rate = de * sine + e * omega * cosine
        found += amplitude[0] * np.column_stack([e * sine, rate, dde * sine + 2.0 * de * omega * cosine - e * omega**2 * sine])
    return found


def carried(values: np.ndarray, arm: Vector | np.ndarray) -> np.ndarray:
    """Return places d + R p, velocities and accelerations of a point of a platform, about its origin.

    Parameters
    ----------
    values : (k, 3, 6) float64
        Of `SixMotions.at` at k times.
    arm : (3,) array_like [m]
        The point p when the platform is at rest.

    Returns
    -------
    (k, 3, 3) float64 [m], [m/s], [m/s2]
    """
    turned = np.zeros((len(values), 3, 3))
    turned[:, 0] = arm
    for axis in (2, 1, 0):
        turned = _turned(turned, axis, *values[:, :, 3 + axis].T)
    return turned + values[:, :, :3]


def _turned(states: np.ndarray, axis: int, angle: np.ndarray, rate: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Places, velocities and accelerations (k, 3, 3) turned about an axis, 0 to 2, by angles with their derivatives (k,)."""
    y, z = (axis + 1) % 3, (axis + 2) % 3
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    rate, second = rate[:, None], second[:, None]
    found = states.copy()  # R times each of the three; what follows is in the plane across the axis
    found[:, :, y], found[:, :, z] = c * states[:, :, y] - s * states[:, :, z], s * states[:, :, y] + c * states[:, :, z]
    spin, slip = found[:, :1, [z, y]] * (-1.0, 1.0), found[:, :1, [y, z]]  # dR/dphi and -d2R/dphi2 of the place
    found[:, 2, [y, z]] += 2.0 * rate * found[:, 1, [z, y]] * (-1.0, 1.0) + second * spin[:, 0] - rate**2 * slip[:, 0]
    found[:, 1, [y, z]] += rate * spin[:, 0]
    return found
