"""Winds and currents: the velocity of air or water as a function of time and place. The velocities of several winds add up."""

from .base import Wind
from .dryden import Dryden
from .gridded import Gridded
from .gust import Gust
from .profiles import Logarithmic, PowerLaw, Sampled, Uniform
from .recorded import Recorded

KINDS = {
    "uniform": Uniform,
    "power_law": PowerLaw,
    "logarithmic": Logarithmic,
    "gust": Gust,
    "dryden": Dryden,
    "recorded": Recorded,
    "sampled": Sampled,
    "gridded": Gridded,
}

__all__ = ["KINDS", "Dryden", "Gridded", "Gust", "Logarithmic", "PowerLaw", "Recorded", "Sampled", "Uniform", "Wind"]
