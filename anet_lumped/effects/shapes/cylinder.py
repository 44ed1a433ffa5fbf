"""A cylinder: a pulley, a drum, a bollard, a pipe."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_direction, check_number, check_vector

from .base import Shape, Solid


@dataclass(frozen=True)
class Cylinder(Shape):
    """A cylinder, without ends or with rounded ones.

    Parameters
    ----------
    at : (3,) array_like [m], its centre, or any place on its axis if it has no ends
    radius : float [m]
    axis : (3,) array_like, direction of its axis; any length but zero
    length : float [m] or None, from end to end; None for a cylinder without ends
    edge : float [m] or None, radius of the edges at its ends; None for a tenth of half of its smallest width
    """

    at: Vector
    radius: float
    axis: Vector = (0.0, 1.0, 0.0)
    length: float | None = None
    edge: float | None = None

    called: ClassVar[str] = "shape Cylinder"

    def __post_init__(self) -> None:
        self._set(at=check_vector("at", self.at, "m", self.called))
        self._set(radius=check_number("radius", self.radius, "m", self.called, sign="positive"))
        self._set(axis=check_direction("axis", self.axis, self.called))
        if self.length is not None:
            self._set(length=check_number("length", self.length, "m", self.called, sign="positive"))
            self._check_edge(self.edge)
        elif self.edge is not None:
            raise SceneError(f"A cylinder must have a `length` [m] to have edges, but {self.called} has edge={self.edge} and none.")

    @property
    def half_width(self) -> float:
        return self.radius if self.length is None else min(self.radius, 0.5 * self.length)

    def solid(self) -> Solid:
        """All that is nearer to the axis than the radius; or than the edge to a cylinder that is smaller by it."""
        axis = np.array(self.axis) / np.linalg.norm(self.axis)
        across = np.linalg.svd(axis[None])[2][1]  # any direction across the axis
        rows = np.array([across, np.cross(axis, across), axis])
        if self.length is None or self.edge is None:
            return Solid(rows, 2, (0.0, math.inf, math.inf), self.radius)
        return Solid(rows, 2, (self.radius - self.edge, 0.5 * self.length - self.edge, math.inf), self.edge)
