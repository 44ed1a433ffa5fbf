"""A sum of regular waves, each given by its numbers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from anet_lumped.checks import LARGEST, SceneError, Vector, as_entries, number, shown

from .base import AMPLITUDE, FREQUENCY, Wave, check_depth_and_ramp, wave_number


@dataclass(frozen=True)
class Components(Wave):
    """A sum of regular waves: eta = sum_m a_m cos(k_m s_m - omega_m t + phase_m), s_m along the direction of each.

    Parameters
    ----------
    components : rows (a, omega, phase, heading): amplitude [m], circular frequency [rad/s], phase [rad] and the angle [rad] from x
        towards y in which it goes. A frequency of 0 is a constant elevation a cos(phase).
    depth : float [m], of the water below the still surface; inf for deep water
    ramp : float [s], over which the waves grow from nothing by the quintic smoothstep; 0: they are there at t = 0

    Source
    ------
    DNV-RP-C205 (2010), 3.3.2.
    """

    components: Sequence[tuple[float, float, float, float]]
    depth: float = math.inf
    ramp: float = 0.0

    def __post_init__(self) -> None:
        owner = "wave Components"
        check_depth_and_ramp(self, owner)
        entries = as_entries(self.components)
        if not entries:
            raise SceneError(
                "Argument `components` must be at least one row (a, omega, phase, heading), but "
                f"{owner} has {shown(self.components)}."
            )
        rows = [_row(entry, i, owner) for i, entry in enumerate(entries)]
        object.__setattr__(self, "components", tuple(rows))

    def rows(self, g: float) -> np.ndarray:
        """Regular waves, see `Wave`."""
        table = np.array(self.components)
        return np.column_stack([table[:, :3], np.cos(table[:, 3]), np.sin(table[:, 3])])

    @property
    def highest_frequency(self) -> float:
        """Highest circular frequency of a component that has a height [rad/s]."""
        return max((omega for a, omega, _, _ in self.components if a != 0.0), default=0.0)

    @property
    def usual_period(self) -> float:
        """Period of the highest component [s]; infinite if nothing moves."""
        table = np.array(self.components)
        omega = table[np.argmax(np.abs(table[:, AMPLITUDE]) * (table[:, FREQUENCY] > 0.0)), FREQUENCY]
        return 2.0 * math.pi / omega if omega > 0.0 else math.inf

    def seen_from(self, origin: Vector, g: float) -> "Components":
        """The same waves about another origin, see `Wave`."""
        return moved(self, origin, g)


def moved(wave: Wave, origin: Vector, g: float) -> Components:
    """The regular waves of a wave in coordinates whose origin lies at ``origin`` (3,) [m] of today's, for gravity g [m/s2]."""
    rows = []
    for a, omega, phase, dx, dy in wave.rows(g).tolist():
        along = wave_number(omega, wave.depth, g) * (dx * origin[0] + dy * origin[1])
        rows.append((a, omega, math.remainder(along + phase, 2.0 * math.pi), math.atan2(dy, dx)))
    return Components(tuple(rows), wave.depth, wave.ramp)


def _row(entry: object, i: int, owner: str) -> tuple[float, float, float, float]:
    values = tuple(number(value) for value in as_entries(entry) or ())
    if len(values) != 4 or not all(abs(value) <= LARGEST for value in values) or values[FREQUENCY] < 0.0:
        raise SceneError(
            f"Argument `components[{i}]` must be four finite numbers (a, omega, phase, heading) with omega not negative, but "
            f"{owner} has {shown(entry)}."
        )
    return values
