"""A box: a table, a deck, a ramp, a wall."""

from dataclasses import dataclass
from typing import ClassVar

from anet_lumped.checks import SceneError, Vector, check_vector
from anet_lumped.prescribed.turning import matrix_of

from .base import Shape, Solid


@dataclass(frozen=True)
class Box(Shape):
    """A box with rounded edges and corners.

    Parameters
    ----------
    at : (3,) array_like [m], its centre
    size : (3,) array_like [m], its widths along its own axes
    rotation : (3,) array_like [rad]
        How its axes lie: turned from those of the world about this vector, by its length.
    edge : float [m] or None, radius of edges and corners; None for a tenth of half of its smallest width
    """

    at: Vector
    size: Vector
    rotation: Vector = (0.0, 0.0, 0.0)
    edge: float | None = None

    called: ClassVar[str] = "shape Box"

    def __post_init__(self) -> None:
        for key, unit in (("at", "m"), ("size", "m"), ("rotation", "rad")):
            self._set(**{key: check_vector(key, getattr(self, key), unit, self.called)})
        if min(self.size) <= 0.0:
            raise SceneError(f"Argument `size` must be three positive widths [m], but {self.called} has size={self.size}.")
        self._check_edge(self.edge)

    @property
    def half_width(self) -> float:
        return 0.5 * min(self.size)

    def solid(self) -> Solid:
        """All that is nearer than the edge to a box that is smaller by it."""
        edge = self.edge or 0.0
        x, y, z = (0.5 * width - edge for width in self.size)
        return Solid(matrix_of(self.rotation).T, 1, (x, y, z), edge)
