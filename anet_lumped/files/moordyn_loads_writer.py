"""Forces, dampers and friction along and across cables → what MoorDyn's Fortran version has for them.

`AppliedForces` and `Dashpots` are rows of its section EXTERNAL LOADS, `CableFriction` and `CableFrictionMap` its options MU_KT and
MU_KA. The C++ version passes over all of them, which is said. Forces that change in time, torques and what acts elsewhere than on a
point or a body of the file are refused; a slip speed is lost.
"""

import warnings
from collections.abc import Mapping
from typing import Any

from anet_lumped.checks import SceneError, quoted
from anet_lumped.prescribed.paths import Path
from anet_lumped.scene.scene import Scene

from .moordyn_body_rows import numbers_of_bodies

FORTRAN = "MoorDyn's C++ version passes over {}, of which its Fortran version has them."
FIELDS = {"force": "a force", "linear": "a dashpot", "quadratic": "a dashpot"}
HEADS = (
    "--------------------- EXTERNAL LOADS ---------------------",
    "ID Object Fext Blin Bquad CSys",
    "(#) (name) (N) (Ns/m) (Ns^2/m^2) (-)",
)


def load_rows(scene: Scene, given: Mapping[str | None, Any], number: Mapping[str, Any]) -> list[str]:
    """Section EXTERNAL LOADS of the effects that are ``given`` by their names; none without forces and dashpots.

    Parameters
    ----------
    scene : Scene
    given : dict of name to effect
    number : dict of the name of a point to its number in the file, "R1A" of the end of a rod

    Raises
    ------
    SceneError : a force that changes in time, a torque, or what acts on no point or body of the file
    """
    forces, dashpots = given.get("applied_forces"), given.get("dashpots")
    found: dict[tuple[str, str], dict[str, str]] = {}  # columns by object and axes
    if forces is not None:
        for name, _ in forces.torque:
            raise SceneError(f"Loads must be forces to be written for MoorDyn, but there is a torque on {quoted(name)}.")
        of_bodies = {point.name for body in scene.bodies for point in body.points}
        for name, value in forces.force:
            turns = forces.axes == "body" and name in of_bodies
            _add(found, _object(name, scene, number, turns), "force", value, name)
        for name, value in forces.force_in_body:
            _add(found, _object(name, scene, number, True), "force", value, name)
    if dashpots is not None:
        for key in ("linear", "quadratic"):
            for name, value in getattr(dashpots, key):
                _add(found, _object(name, scene, number, False), key, value, name)
            for name, value in getattr(dashpots, f"{key}_in_body"):
                _add(found, _object(name, scene, number, True), key, value, name)
    if not found:
        return []
    warnings.warn(FORTRAN.format("EXTERNAL LOADS"), stacklevel=4)
    rows = (
        f"{row} {what} {columns.get('force', '0|0|0')} {columns.get('linear', '0')} {columns.get('quadratic', '0')} {axes}"
        for row, ((what, axes), columns) in enumerate(found.items(), start=1)
    )
    return [*HEADS, *rows]


def _object(name: str, scene: Scene, number: Mapping[str, Any], in_body: bool) -> tuple[str, str]:
    """What a load is on, and its axes."""
    bodies = numbers_of_bodies(scene)
    if name in bodies:
        return f"Body{bodies[name]}", "L" if in_body else "G"
    if in_body:
        raise SceneError(
            f"A load in the axes of a body must be on the origin of one of the file to be written for MoorDyn, but one is on "
            f"{quoted(name)}."
        )
    if not isinstance(number.get(name), int):
        raise SceneError(f"A load must be on a point or body of the file to be written for MoorDyn, but one is on {quoted(name)}.")
    return f"Point{number[name]}", "-"


def _add(found: dict[tuple[str, str], dict[str, str]], at: tuple[str, str], key: str, value: Any, name: str) -> None:
    """Put a vector or coefficients of a load into its column."""
    if isinstance(value, Path):
        raise SceneError(f"Forces must be constant to be written for MoorDyn, but that on {quoted(name)} is a path.")
    if len(value) != 3:
        raise SceneError(f"A dashpot must have three numbers to be written for MoorDyn, but that at {quoted(name)} has two.")
    found.setdefault(at, {})[key] = "|".join(repr(float(x)) for x in value)


def friction_options(given: Mapping[str | None, Any], ground: Any) -> dict[str, float]:
    """Options of the friction on a ground: FrictionCoefficient, or MU_KT and MU_KA of the friction along and across cables.

    Raises
    ------
    SceneError : friction on another ground than that of the scene
    """
    own = [given[name] for name in ("cable_friction", "cable_friction_map") if name in given]
    if not own:
        return {} if ground is None else {"FrictionCoefficient": ground.friction}
    called, fits = type(own[0]).__name__, {"cable_friction": "ground", "cable_friction_map": "ground_map"}
    at = ("x", "y", "heights", "stiffness") if "cable_friction_map" in given else ("height", "stiffness")
    alike = len(own) == 1 and all(ground is given.get(where) for name, where in fits.items() if name in given)
    alike = alike and ground is not None and all(getattr(own[0], key) == getattr(ground, key) for key in at) and not ground.friction
    if not alike:
        raise SceneError(
            f"{called} must be on the ground of the scene, which has no friction of its own, to be written for MoorDyn, but it is "
            "on another."
        )
    warnings.warn(FORTRAN.format("MU_KT and MU_KA"), stacklevel=4)
    return {"MU_KT": own[0].across, "MU_KA": own[0].along}
