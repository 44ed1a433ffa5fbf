"""Elastic cables and cable nets as lumped masses."""

from .catenary import catenary
from .equilibrium import EquilibriumError, equilibrium
from .events import PayloadChange
from .moordyn_file import read_moordyn
from .moordyn_writer import save_moordyn
from .ropes import rope
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
    "PayloadChange",
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
    "read_moordyn",
    "rope",
    "save_moordyn",
    "save_scene",
    "simulate",
]
