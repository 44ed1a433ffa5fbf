"""The physical effects a scene may ask for, besides the axial elasticity that every cable has."""

from .gravity import Gravity
from .viscous_damping import ViscousDamping

REGISTRY = {"gravity": Gravity, "viscous_damping": ViscousDamping}

__all__ = ["REGISTRY", "Gravity", "ViscousDamping"]
