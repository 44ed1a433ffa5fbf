"""The base class of all shapes of obstacles."""

from abc import ABC, abstractmethod
from typing import Any, ClassVar, NamedTuple

import numpy as np

from anet_lumped.checks import SceneError, Vector, as_entries, check_number, shown

EDGE = 0.1  # of the smallest half width: radius of the edges of a shape that does not say it


class Solid(NamedTuple):
    """A core with all that is nearer to it than ``rounding``; `effects.laws.solid` is the law.

    Parameters
    ----------
    rows : (3, 3) float64, axes of the shape, each a row
    merged : int
        How many of the axes, from the first on, one coordinate measures the distance from: 3 of a sphere, 2 of a cylinder, 1.
    core : (3,) float, half widths of the core along its coordinates [m]; infinite where there is no such coordinate
    rounding : float [m]
    """

    rows: np.ndarray
    merged: int
    core: Vector
    rounding: float


class Shape(ABC):
    """A solid that cables do not enter: a frozen dataclass in a file of its own, and a line in `KINDS` of this package."""

    called: ClassVar[str] = "shape"
    """What messages call it."""

    at: Vector

    @abstractmethod
    def solid(self) -> Solid:
        """The solid about `at`, as compiled functions read it."""

    @property
    @abstractmethod
    def half_width(self) -> float:
        """Half of its smallest width [m]. A segment that is longer may go through it with both ends outside."""

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _check_edge(self, edge: Any) -> None:
        """Check the radius of the edges, or make it that of a shape that does not say it."""
        radius = EDGE * self.half_width if edge is None else check_number("edge", edge, "m", self.called, sign="positive")
        if radius > self.half_width:
            raise SceneError(
                f"Argument `edge` must be no more than half of the smallest width, {self.half_width:g} m, but {self.called} "
                f"has edge={radius:g}."
            )
        self._set(edge=radius)


def check_shapes(argument: str, value: Any, owner: str) -> tuple[Shape, ...]:
    """Return one shape or several as a tuple of at least one."""
    shapes = (value,) if isinstance(value, Shape) else as_entries(value) or ()
    if not shapes or not all(isinstance(shape, Shape) for shape in shapes):
        raise SceneError(
            f"Argument `{argument}` must be one or more shapes of anet_lumped.shapes, but {owner} has {argument}={shown(value)}."
        )
    return shapes
