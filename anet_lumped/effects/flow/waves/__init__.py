"""Waves: the elevation, velocity and acceleration of water as functions of time and place. Several waves add up."""

from .airy import Airy
from .base import Wave
from .components import Components
from .irregular import Jonswap, PiersonMoskowitz
from .recorded import Recorded

KINDS = {
    "airy": Airy,
    "jonswap": Jonswap,
    "pierson_moskowitz": PiersonMoskowitz,
    "components": Components,
    "recorded": Recorded,
}

__all__ = ["KINDS", "Airy", "Components", "Jonswap", "PiersonMoskowitz", "Recorded", "Wave"]
