"""The six motions of a platform, and the paths of the points that it carries.

A point that lies at p when the platform is at rest moves as

    q(t) = o + d(t) + R(t) (p - o) ,     R = Rx(roll) Ry(pitch) Rz(yaw) ,

with the origin o of the platform, its surge, sway and heave d, and the rotation that MoorDyn makes of its three angles (Misc.hpp:
EulerXYZ). Velocity and acceleration are the exact derivatives. A path takes all three at so many times that the path is exact to
some 1e-10 of the amplitude.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_number, check_vector, shown

from . import paths
from .paths import Path
from .signals import Signal

TRANSLATIONS, ROTATIONS = ("surge", "sway", "heave"), ("roll", "pitch", "yaw")
PER_PERIOD = 64  # samples of a swing: (2 pi/64)^6/46080 = 2e-11 of its amplitude
PER_SAMPLE = 4  # samples of a path between two of a recorded motion


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

    def at(self, t: float) -> np.ndarray:
        """Surge, sway, heave [m], roll, pitch, yaw [rad], their rates and their second derivatives, (3, 6)."""
        found = np.zeros((3, 6))
        for axis, each in enumerate(fields(self)):
            for signal in getattr(self, each.name):
                found[:, axis] += [float(x[0]) for x in signal.path.at(t)]
        return found

    def times(self, t_end: float) -> np.ndarray:
        """Times from 0 to t_end [s] at which a path needs the motion."""
        found, step = [np.array([0.0, t_end])], t_end
        for signal in self.signals:
            parameters = dict(signal.parameters)
            if signal.kind == "samples":
                t = np.array(parameters["t"])
                finer = np.interp(np.arange(PER_SAMPLE * (len(t) - 1) + 1) / PER_SAMPLE, np.arange(len(t)), t)
                found.append(finer[(finer > 0.0) & (finer < t_end)])
            elif signal.kind == "harmonic" and parameters["frequency"] > 0.0:
                step = min(step, 1.0 / (PER_PERIOD * parameters["frequency"]))
            if parameters.get("ramp"):
                step = min(step, parameters["ramp"] / PER_PERIOD)
        found.append(np.linspace(0.0, t_end, math.ceil(t_end / step - 1e-9) + 1))
        every = np.unique(np.concatenate(found))
        apart = np.diff(every, prepend=-math.inf) > 1e-9 * t_end  # times that differ by rounding are one
        apart[-1] = True
        return every[apart]


def point_path(motions: SixMotions, at: Vector, t_end: float, origin: Vector = (0.0, 0.0, 0.0)) -> Path:
    """Return the path of a point of the platform up to a time.

    Parameters
    ----------
    motions : SixMotions
    at : (3,) array_like [m]
        Where the point lies when the platform is at rest.
    t_end : float [s]
        After which the point is held.
    origin : (3,) array_like [m]
        About which the platform turns.
    """
    t_end = check_number("t_end", t_end, "s", "the motion of a platform", sign="positive")
    origin = check_vector("origin", origin, "m", "the motion of a platform")
    arm = np.subtract(check_vector("at", at, "m", "a point of a platform"), origin)
    times = motions.times(t_end)
    states = np.array([_state(motions.at(t), arm) for t in times.tolist()])
    states[:, 0] += origin
    place, velocity, acceleration = states.swapaxes(0, 1).tolist()
    return paths.states(times.tolist(), place, velocity, acceleration)


def _state(motion: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """d + R p, and its first two derivatives, (3, 3), for `SixMotions.at` and an arm p."""
    about = [_rotation(axis, *motion[:, 3 + axis].tolist()) for axis in range(3)]
    turned = np.array([arm, np.zeros(3), np.zeros(3)])
    for R, dR, ddR in reversed(about):
        turned = np.array([R @ turned[0], dR @ turned[0] + R @ turned[1], ddR @ turned[0] + 2.0 * dR @ turned[1] + R @ turned[2]])
    return turned + motion[:, :3]


def _rotation(axis: int, angle: float, rate: float, second: float) -> tuple[Any, Any, Any]:
    """Rotation about an axis, 0 to 2, and its first two derivatives in time, (3, 3) each."""
    y, z = (axis + 1) % 3, (axis + 2) % 3
    along, across = np.zeros((3, 3)), np.zeros((3, 3))
    along[axis, axis] = 1.0
    plane = np.eye(3) - along
    across[z, y], across[y, z] = 1.0, -1.0
    c, s = math.cos(angle), math.sin(angle)
    R, turned = along + c * plane + s * across, -s * plane + c * across
    return R, rate * turned, second * turned - rate * rate * (c * plane + s * across)
