"""Elastic cables and cable nets as lumped masses.

What Numba has not compiled on this machine yet is compiled when it is first needed; one line on stderr says so, unless the variable
ANET_LUMPED_QUIET of the environment is set.
"""

import multiprocessing
import os
import sys
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

from anet_lumped.environment import check_environment
from integrators.compiling import NOTICE
from integrators.ctrl_c import ctrl_c_later

with ctrl_c_later():  # once their import is interrupted, a process cannot import NumPy or Numba again
    check_environment()
    import numba  # noqa: F401

if multiprocessing.parent_process() is None and "ANET_LUMPED_QUIET" not in os.environ:
    NOTICE.prepare(
        "anet_lumped compiles what this machine has not compiled yet, for up to about a minute, longer on a busy machine; "
        "later runs do without.",
        lambda line: print(line, file=sys.stderr, flush=True),
        only_cached=True,
    )
    NOTICE.listen()

from anet_lumped.checks import InputError
from anet_lumped.effects import shapes
from anet_lumped.effects.flow import waves, wind
from anet_lumped.files.moordyn_file import read_moordyn
from anet_lumped.files.moordyn_writer import save_moordyn
from anet_lumped.files.motion_file import read_motions
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.motion.simulate import RunError, RunInterrupt, simulate
from anet_lumped.motion.simulate_many import RunsInterrupt, simulate_many
from anet_lumped.motion.winch import winched
from anet_lumped.prescribed import paths, signals
from anet_lumped.prescribed.six_motions import SixMotions
from anet_lumped.results.loading import load_run
from anet_lumped.results.run import Run
from anet_lumped.results.state import State
from anet_lumped.scene import nets, working_curves
from anet_lumped.scene.attach import attach
from anet_lumped.scene.cable_cut import CableCut
from anet_lumped.scene.carried import Carried
from anet_lumped.scene.payload_change import PayloadChange
from anet_lumped.scene.platform import platform
from anet_lumped.scene.release import Release
from anet_lumped.scene.rod_body import rod_body
from anet_lumped.scene.ropes import rope
from anet_lumped.scene.scene import Body, Cable, Driven, Fixed, Free, Rod, Scene, SceneError
from anet_lumped.statics.catenary import catenary
from anet_lumped.statics.equilibrium import EquilibriumError, NoRestError, equilibrium
from anet_lumped.statics.tensioned import tensioned

if TYPE_CHECKING:
    from anet_lumped.motion.session import Session, SessionError

try:
    __version__ = version("anet-lumped")
except PackageNotFoundError:  # the source beside no installation
    __version__ = "unknown"

__all__ = [
    "Body",
    "Cable",
    "CableCut",
    "Carried",
    "Driven",
    "EquilibriumError",
    "Fixed",
    "Free",
    "InputError",
    "NoRestError",
    "PayloadChange",
    "Release",
    "Rod",
    "Run",
    "RunError",
    "RunInterrupt",
    "RunsInterrupt",
    "Scene",
    "SceneError",
    "Session",
    "SessionError",
    "SixMotions",
    "State",
    "attach",
    "catenary",
    "equilibrium",
    "load_run",
    "load_scene",
    "nets",
    "paths",
    "platform",
    "read_moordyn",
    "read_motions",
    "rod_body",
    "rope",
    "save_moordyn",
    "save_scene",
    "shapes",
    "signals",
    "simulate",
    "simulate_many",
    "tensioned",
    "waves",
    "winched",
    "wind",
    "working_curves",
]


def __getattr__(name: str) -> Any:
    """Sessions are imported when they are asked for: programs without one need not compile what they call."""
    if name in ("Session", "SessionError"):
        from anet_lumped.motion import session

        return getattr(session, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, "effects", *(name for name in globals() if name.startswith("__"))])
