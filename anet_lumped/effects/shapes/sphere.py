"""A sphere."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anet_lumped.checks import Vector, check_number, check_vector

from .base import Shape, Solid


@dataclass(frozen=True)
class Sphere(Shape):
    """A ball.

    Parameters
    ----------
    at : (3,) array_like [m], its centre
    radius : float [m]
    """

    at: Vector
    radius: float

    called: ClassVar[str] = "shape Sphere"

    def __post_init__(self) -> None:
        self._set(at=check_vector("at", self.at, "m", self.called))
        self._set(radius=check_number("radius", self.radius, "m", self.called, sign="positive"))

    @property
    def half_width(self) -> float:
        return self.radius

    def solid(self) -> Solid:
        """All that is nearer to the centre than the radius."""
        return Solid(np.eye(3), 3, (0.0, math.inf, math.inf), self.radius)
