"""Elastic cables and cable nets as lumped masses."""

from anet_lumped.checks import InputError
from anet_lumped.effects.flow import waves, wind
from anet_lumped.files.moordyn_file import read_moordyn
from anet_lumped.files.moordyn_writer import save_moordyn
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.motion.simulate import RunError, RunInterrupt, simulate
from anet_lumped.prescribed import paths, signals
from anet_lumped.results.run import Run, State, load_run
from anet_lumped.scene.payload_change import PayloadChange
from anet_lumped.scene.ropes import rope
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, Scene, SceneError
from anet_lumped.statics.catenary import catenary
from anet_lumped.statics.equilibrium import EquilibriumError, equilibrium

__all__ = [
    "Cable",
    "Driven",
    "EquilibriumError",
    "Fixed",
    "Free",
    "InputError",
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
    "paths",
    "read_moordyn",
    "rope",
    "save_moordyn",
    "save_scene",
    "signals",
    "simulate",
    "waves",
    "wind",
]
