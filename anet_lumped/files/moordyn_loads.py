"""Forces and dampers of a MoorDyn file on what moves freely, as `AppliedForces` and `Dashpots`.

The Fortran version has a section EXTERNAL LOADS (its documentation, "External Loads"): a constant force and dampers on a point, on
the end A of a rod or on the origin of a body, along the axes of the world, or of the body where `CSys` is L. Dampers of a rod are
two, across it and along it. The C++ version passes over that section. Version 1 has the columns FX, FY, FZ of a point, in N.
"""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from anet_lumped.checks import Vector
from anet_lumped.scene.body import Body
from anet_lumped.scene.point import Free

from .moordyn_attachments import Hold
from .moordyn_points import OnMovingBody, Places, steady_force
from .moordyn_rows import Row, made, number_of

OBJECT = re.compile(r"(body|rod|point|node|connection|connect|con)(\d{1,18})")
COLUMNS = 5  # ID, Object, Fext, Blin, Bquad; CSys may be left out
FIXED = "loads on what is held, or moved from outside"


class _Load(NamedTuple):
    """What a row exerts on a point, or on the origin or an attachment of a body.

    Parameters
    ----------
    row : where it stands
    name : of the point
    force : (3,) [N]
    force_in_body : whether that is along the axes of the body
    linear, quadratic : (3,) or (2,) coefficients of dampers [N s/m], [N s2/m2], empty without any
    dampers_in_body : whether those are along the axes of the body
    """

    row: Row
    name: str
    force: Vector
    force_in_body: bool = False
    linear: tuple[float, ...] = ()
    quadratic: tuple[float, ...] = ()
    dampers_in_body: bool = False


def read_loads(sections: Mapping[str, list[Row]], places: Places, bodies: list[Body], reached: set[int | str]) -> list[Any]:
    """The effects of all forces and dampers of a file; none if it has none.

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
    forces: dict[str, dict[str, list[float]]] = {}
    dampers: dict[str, dict[str, list[float]]] = {}
    for load in loads:
        in_body = "_in_body" if load.force_in_body else ""
        _add(forces, f"force{in_body}", load.name, load.force if any(load.force) else ())
        in_body = "_in_body" if load.dampers_in_body else ""
        _add(dampers, f"linear{in_body}", load.name, load.linear)
        _add(dampers, f"quadratic{in_body}", load.name, load.quadratic)
    from anet_lumped.effects import REGISTRY

    effects = []
    for kind, fields in (("applied_forces", forces), ("dashpots", dampers)):
        if fields:
            effects.append(made(loads[-1].row, REGISTRY[kind], **fields))
    return effects


def _add(sums: dict[str, dict[str, list[float]]], field: str, name: str, numbers: Sequence[float]) -> None:
    """Add numbers to those that a field has of a name; none of an empty sequence."""
    if numbers:
        of_field = sums.setdefault(field, {})
        of_field[name] = [a + b for a, b in zip(of_field.get(name, [0.0] * len(numbers)), numbers, strict=True)]


def _steady(row: Row, places: Places, reached: set[int | str]) -> _Load | None:
    """Of the columns FX, FY, FZ of a point."""
    force = steady_force(row)
    if not any(force):
        return None
    name = _of_point(row.count(0, "the number of a point"), row, places, reached)
    return None if name is None else _Load(row, name, force)


def _external(row: Row, places: Places, bodies: list[Body], rods: Mapping[str, str], reached: set[int | str]) -> _Load | None:
    """Of a row of EXTERNAL LOADS."""
    if len(row.words) < COLUMNS:
        raise row.error(f"an external load must have 6 columns (ID, Object, Fext, Blin, Bquad, CSys), but has {len(row.words)}.")
    parts = OBJECT.fullmatch(row.words[1].lower())
    if parts is None:
        raise row.error("an external load must be on Point, Rod or Body and a number.")
    kind, number = parts[1], int(parts[2])
    force = _numbers(row, 2, "an external force Fext", 3)
    linear, quadratic = (_numbers(row, column, what, 2 if kind == "rod" else 3) for column, what in ((3, "Blin"), (4, "Bquad")))
    if min((*linear, *quadratic), default=0.0) < 0.0:
        raise row.error("dampers Blin and Bquad must not be negative.")
    if not (force or linear or quadratic):
        row.findings.unused("0", row.line, "external loads")
        return None
    in_body = False
    system = row.words[5].upper() if len(row.words) > COLUMNS else "-"
    if kind == "body":
        name = _of_body(number, row, places)
        if name is not None and system not in ("G", "L"):
            raise row.error("the axes CSys of a load on a body must be G, of the world, or L, its own.")
        in_body = system == "L"
    else:
        name = _of_rod(rods.get(parts[2]), row, bodies) if kind == "rod" else _of_point(number, row, places, reached)
    if name is None:
        return None
    x, y, z = force or (0.0, 0.0, 0.0)
    return _Load(row, name, (x, y, z), in_body, linear, quadratic, in_body or kind == "rod")


def _numbers(row: Row, column: int, what: str, count: int) -> tuple[float, ...]:
    """Numbers in a column with | between them; none if all are 0, of which one will do."""
    words = row.words[column].split("|")
    numbers = tuple(number_of(word) for word in words)
    if not any(numbers):
        return ()
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise row.error(f"{what} must be {('two', 'three')[count - 2]} finite numbers with | between them.")
    return numbers


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
