"""Waves whose elevation was recorded at one place."""

import math
from dataclasses import dataclass, field

import numpy as np

from anet_lumped.checks import NAMED, SceneError, Vector, check_number, number, one_line, shown
from anet_lumped.effects.flow.recording import read_recording

from .base import AMPLITUDE, FREQUENCY, Wave, check_depth_and_ramp, check_level_direction
from .components import Components, moved

UNEVEN = 1e-3  # difference between two steps of a recording, over a step, that is taken for rounding


@dataclass(frozen=True)
class Recorded(Wave):
    """The waves that have a recorded elevation at the origin, by its Fourier series; all go the same way.

    The elevation is that of the file at each of its times, if no component is left out, and repeats after its last sample.

    Parameters
    ----------
    file : str, path of a CSV file with the columns t [s] and elevation [m] under a line with these names, in equal steps; a
        relative one starts where the program does
    direction : (3,) array_like, level; where the waves go; any length but zero
    highest : float [Hz], above which components are left out, such as noise; inf: all are taken
    depth : float [m], of the water below the still surface; inf for deep water
    ramp : float [s], over which the waves grow from nothing by the quintic smoothstep; 0: they are there at t = 0
    """

    file: str
    direction: Vector = (1.0, 0.0, 0.0)
    highest: float = math.inf
    depth: float = math.inf
    ramp: float = 0.0
    components: np.ndarray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        owner = "wave Recorded"
        if not isinstance(self.file, str):
            raise SceneError(f"Argument `file` must be the path of a file, a string, but {owner} has file={shown(self.file)}.")
        object.__setattr__(self, "direction", check_level_direction(self.direction, owner))
        if number(self.highest) != math.inf:
            object.__setattr__(self, "highest", check_number("highest", self.highest, "Hz", owner, sign="positive"))
        check_depth_and_ramp(self, owner)
        table = read_recording(self.file, ("t", "elevation"), "A recorded elevation")
        steps = np.diff(table[:, 0])
        if np.ptp(steps) > UNEVEN * steps.mean():
            raise SceneError(
                f"A recorded elevation must have equal steps, but in {one_line(self.file, NAMED)} they are from {steps.min():g} s "
                f"to {steps.max():g} s."
            )
        object.__setattr__(self, "components", fourier_series(table[0, 0], steps.mean(), table[:, 1], self.highest))

    def seen_from(self, origin: Vector, g: float) -> Components:
        """The same waves about another origin, see `Wave`."""
        return moved(self, origin, g)

    def rows(self, g: float) -> np.ndarray:
        """Regular waves, see `Wave`."""
        along = np.broadcast_to(self.direction[:2], (len(self.components), 2))
        return np.hstack([self.components, along])

    @property
    def highest_frequency(self) -> float:
        """Highest circular frequency of a component [rad/s]."""
        return float(self.components[:, FREQUENCY].max())

    @property
    def usual_period(self) -> float:
        """Period of the highest component [s]; infinite if nothing moves."""
        moving = self.components[self.components[:, FREQUENCY] > 0.0]
        return 2.0 * math.pi / float(moving[np.argmax(moving[:, AMPLITUDE]), FREQUENCY]) if len(moving) else math.inf


def fourier_series(start: float, step: float, samples: np.ndarray, highest: float) -> np.ndarray:
    """Amplitude [m], circular frequency [rad/s] and phase [rad], (n, 3), of sum a cos(phase - omega t) through samples (k,) [m].

    Parameters
    ----------
    start, step : float [s], time of the first sample, and between two
    samples : (k,) float64 [m]
    highest : float [Hz], above which components are left out
    """
    k = len(samples)
    c = 2.0 * np.fft.rfft(samples) / k
    c[0] *= 0.5
    if k % 2 == 0:
        c[-1] *= 0.5
    frequency = np.fft.rfftfreq(k, step)
    taken = (frequency <= highest) & (np.abs(c) > 0.0)
    taken[0] = True  # a recording of nothing is a sum of nothing
    omega = 2.0 * math.pi * frequency[taken]
    return np.column_stack([np.abs(c[taken]), omega, omega * start - np.angle(c[taken])])
