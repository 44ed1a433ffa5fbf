"""Shapes of obstacles: solids whose surface holds up cables."""

from .base import Shape
from .box import Box
from .cylinder import Cylinder
from .sphere import Sphere

KINDS = {"sphere": Sphere, "cylinder": Cylinder, "box": Box}

__all__ = ["KINDS", "Box", "Cylinder", "Shape", "Sphere"]
