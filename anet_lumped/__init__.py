"""Elastic cables and cable nets as lumped masses."""

from .catenary import catenary
from .equilibrium import EquilibriumError, equilibrium
from .run import Run, State, load_run
from .scene import Cable, Driven, Fixed, Free, Scene, SceneError
from .scene_file import load_scene, save_scene
from .simulate import RunError, RunInterrupt, simulate

__all__ = [
    "Cable",
    "Driven",
    "EquilibriumError",
    "Fixed",
    "Free",
    "Run",
    "RunError",
    "RunInterrupt",
    "Scene",
    "SceneError",
    "State",
    "catenary",
    "equilibrium",
    "load_run",
    "load_scene",
    "save_scene",
    "simulate",
]
