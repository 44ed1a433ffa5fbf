"""Constant forces of a MoorDyn file on what moves freely, as `AppliedForces`.

The Fortran version has a section EXTERNAL LOADS (its documentation, "External Loads"): a force on a point, on the end A of a rod or
on the origin of a body, along the axes of the world, or of the body where `CSys` is L, with dampers, which have no counterpart
here. The C++ version passes over that section. Version 1 has the columns FX, FY, FZ of a point, in N.
"""

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from anet_lumped.checks import Vector
from anet_lumped.scene.body import Body
from anet_lumped.scene.point import Free

from .moordyn_attachments import Hold
from .moordyn_points import OnMovingBody, Places, steady_force
from .moordyn_rows import Row, number_of

OBJECT = re.compile(r"(body|rod|point|node|connection|connect|con)(\d{1,18})")
COLUMNS = 5  # ID, Object, Fext, Blin, Bquad; CSys may be left out
IN_WORLD, IN_BODY = "world", "body"
FIXED = "loads on what is held, or moved from outside"


class _Load(NamedTuple):
    """Force (3,) [N] of a row on a point, or the origin or an attachment of a body, in axes of the world or of the body."""

    row: Row
    name: str
    force: Vector
    axes: str


def read_loads(sections: Mapping[str, list[Row]], places: Places, bodies: list[Body], reached: set[int | str]) -> list[Any]:
    """The effect of all forces of a file, in a list that is empty if it has none.

    Parameters
    ----------
    sections : rows of each section
    places : Places
    bodies : list of Body, those that move by themselves, rods among them
    reached : set of numbers of the points at which lines end
    """
    rods = {row.words[0]: row.name or f"rod{row.words[0]}" for row in sections.get("rods", ())}
    found: list[_Load | None] = []
    for row in sections.get("points", ()):
        with row.findings.refusing():
            found.append(_steady(row, places, reached))
    for row in sections.get("external loads", ()):
        with row.findings.refusing():
            found.append(_external(row, places, bodies, rods, reached))
    loads = [load for load in found if load is not None]
    if not loads:
        return []
    known = {body.name for body in bodies}
    turning = {load.axes for load in loads if load.name in known}
    last = loads[-1].row
    with last.findings.refusing():
        if len(turning) > 1 or (IN_BODY in turning and any("." in load.name for load in loads)):
            raise last.error("forces on bodies and rods must all be along the axes of the world, or all on bodies along their own.")
        force: dict[str, list[float]] = {}
        for load in loads:
            force[load.name] = [a + b for a, b in zip(force.get(load.name, (0.0, 0.0, 0.0)), load.force, strict=True)]
        from anet_lumped.effects import REGISTRY

        return [REGISTRY["applied_forces"](force, axes=IN_BODY if IN_BODY in turning else IN_WORLD)]
    return []


def _steady(row: Row, places: Places, reached: set[int | str]) -> _Load | None:
    """Of the columns FX, FY, FZ of a point."""
    force = steady_force(row)
    if not any(force):
        return None
    name = _of_point(row.count(0, "the number of a point"), row, places, reached)
    return None if name is None else _Load(row, name, force, IN_WORLD)


def _external(row: Row, places: Places, bodies: list[Body], rods: Mapping[str, str], reached: set[int | str]) -> _Load | None:
    """Of a row of EXTERNAL LOADS."""
    if len(row.words) < COLUMNS:
        raise row.error(f"an external load must have 6 columns (ID, Object, Fext, Blin, Bquad, CSys), but has {len(row.words)}.")
    if any(number_of(word) != 0.0 for column in row.words[3:5] for word in column.split("|")):
        raise row.error("dampers from outside are not supported: Blin and Bquad must be 0.")
    force = [number_of(word) for word in row.words[2].split("|")]
    if not any(force):
        row.findings.unused("0", row.line, "external loads")
        return None
    if len(force) != 3 or not all(map(math.isfinite, force)):
        raise row.error("an external force Fext must be three finite numbers with | between them.")
    parts = OBJECT.fullmatch(row.words[1].lower())
    if parts is None:
        raise row.error("an external load must be on Point, Rod or Body and a number.")
    kind, number = parts[1], int(parts[2])
    system = row.words[5].upper() if len(row.words) > COLUMNS else "-"
    if kind == "body":
        name = _of_body(number, row, places)
        if name is not None and system not in ("G", "L"):
            raise row.error("the axes CSys of a load on a body must be G, of the world, or L, its own.")
        axes = IN_BODY if system == "L" else IN_WORLD
    else:
        name = _of_rod(rods.get(parts[2]), row, bodies) if kind == "rod" else _of_point(number, row, places, reached)
        axes = IN_WORLD
    return None if name is None else _Load(row, name, force, axes)


def _of_point(number: int, row: Row, places: Places, reached: set[int | str]) -> str | None:
    """Name of a point that moves freely, or None of one that does not, or that no line ends at."""
    if number not in places.points:
        raise row.error(f"a force must be on a point in POINTS, but point {number} is not there.")
    point = places.points[number]
    if isinstance(point, OnMovingBody):
        return point.name
    if isinstance(point, Free):
        return point.name if number in reached else None  # a point that is left out, which is said of it
    if point is not None:
        row.findings.unused(f"the force on point {number}", row.line, FIXED)
    return None


def _of_body(number: int, row: Row, places: Places) -> str | None:
    if number not in places.frames:
        raise row.error(f"a load must be on a body in BODIES, but body {number} is not there.")
    frame = places.frames[number]
    if frame is not None and frame.hold is not Hold.FREE:
        row.findings.unused(f"the load on body {number}", row.line, FIXED)
        return None
    return frame and frame.name


def _of_rod(name: str | None, row: Row, bodies: list[Body]) -> str:
    """Name of the body of a rod, whose origin is its end A."""
    if name not in {body.name for body in bodies}:
        raise row.error("a load on a rod must be on one that moves by itself.")
    assert name is not None
    return name
