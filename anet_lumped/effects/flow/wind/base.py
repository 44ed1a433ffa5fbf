"""The base class of all winds and currents."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_direction, shown


class Wind(ABC):
    """A velocity of air or water as a function of time and place. The velocities of a scene's winds add up.

    A wind is a frozen dataclass in a file of its own, with the two methods below, and a line in `KINDS` of this package.
    """

    same_at_each_height: ClassVar[bool] = False
    """Whether the velocity is the same at all places of one height."""

    @abstractmethod
    def numbers(self) -> np.ndarray:
        """Numbers that its compiled function reads, (k,) float64."""

    @property
    def sudden(self) -> tuple[tuple[float, float, float], ...]:
        """Times in which it may come and go: from, to, and the shortest time that takes [s]."""
        return ()

    def steady(self) -> "Wind | None":
        """The wind without its turbulence; None if nothing is left."""
        return self

    @abstractmethod
    def kernel(self) -> Callable:
        """Compiled function (t, x, y, z, numbers) -> velocity, gradient of this wind alone; `kernel.wind_at` describes both.

        It is decorated with `compiled.jit.on_demand`, and so compiled when a scene first has such a wind.
        """


UNIFORM_IN_PLACE = (0.0,) * 9
"""Gradient of a velocity that is the same everywhere [1/s]."""


def as_winds(value: Any) -> tuple[Wind, ...]:
    """Return the tuple of winds of an argument that may be None, one wind, or several."""
    if value is None:
        return ()
    return tuple(value) if isinstance(value, tuple | list) else (value,)


def steady(value: Any) -> Any:
    """Return the argument without the turbulence of its winds."""
    left = tuple(found for wind in as_winds(value) if (found := wind.steady()) is not None)
    return value if left == as_winds(value) else left or None


def same_at_each_height(value: Any) -> bool:
    """Whether none, one or several winds are the same at all places of one height."""
    return all(wind.same_at_each_height for wind in as_winds(value))


def check_winds(argument: str, value: Any, owner: str) -> Wind | tuple[Wind, ...] | None:
    """Return None, one wind or a tuple of several."""
    winds = as_winds(value)
    if not all(isinstance(wind, Wind) for wind in winds):
        raise SceneError(
            f"Argument `{argument}` must be winds of anet_lumped.wind or None, but {owner} has {argument}={shown(value)}."
        )
    return winds[0] if len(winds) == 1 else winds or None


def check_unit_direction(value: Vector, owner: str) -> Vector:
    """Return a direction as a vector of length 1."""
    direction = np.array(check_direction("direction", value, owner))
    x, y, z = (direction / np.linalg.norm(direction)).tolist()
    return x, y, z
