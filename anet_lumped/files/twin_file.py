"""A scene as its twin of rigid links, for other engines: a model of MuJoCo or a world of SDFormat, by the ending of the file."""

from importlib import import_module
from pathlib import Path
from typing import Any

from anet_lumped.scene.scene import Scene

ENDINGS = {".xml": "mjcf", ".sdf": "sdf"}
STEP = 0.002  # [s] of the engine, if none is given


def save_twin(scene: Scene, path: Path, dt: float | None = None, **choices: Any) -> None:
    """Write a file; the ending of ``path`` says which, and `save_mjcf` and `save_sdf` what the ``choices`` are."""
    name = ENDINGS[path.suffix.lower()]
    getattr(import_module(f"anet_lumped.files.{name}_writer"), f"save_{name}")(
        scene, path, dt=STEP if dt is None else dt, **choices
    )
