"""The points of a MoorDyn file.

`Fixed` is Fixed; `Free` is Free with its mass, volume, CdA and Ca; `Coupled`, which the calling program moves in MoorDyn, is driven
from outside: it stays where it is unless it is given a path, a platform that carries it, or a session. A point on a body that is
fixed or coupled is what its body is; on a body that moves by itself it is an attachment.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from anet_lumped.checks import SceneError, Vector, shown
from anet_lumped.prescribed import paths
from anet_lumped.prescribed.paths import Path
from anet_lumped.scene.scene import Driven, Fixed, Free, Point

from .moordyn_attachments import Attachment, Hold, hold_of_point
from .moordyn_bodies import Frame, read_bodies
from .moordyn_findings import Findings
from .moordyn_rows import Row, made

CdA_WITHOUT_FORCE, CdA_WITH_FORCE = 7, 10  # columns
WITH_FORCE = 12  # columns of a row that has FX, FY, FZ


class OnMovingBody(NamedTuple):
    """A point on a body that moves by itself.

    Parameters
    ----------
    name : of the body and the attachment, such as "body1.point4"; of the body alone for its origin
    """

    name: str


class Places(NamedTuple):
    """The points of a file, by number, and the ends of rods at which lines end, by a word such as "R1A".

    Parameters
    ----------
    points : Point, or None of one that is refused
    at : (3,) [m], where it starts
    without_number : lines of the rows whose number cannot be read
    frames : bodies by number, None of one that is refused
    attachments : name and place in its axes (3,) [m] of the attachments of each body that moves by itself, by its number
    carried : fields of what attachments of each such body carry, by the attachment's name
    leaves : direction (3,) in which a line leaves the end of a rod in line with the rod, by a word such as "R1A"
    smooth : ends of rods without a length, at which MoorDyn joins lines without a kink
    """

    points: dict[int | str, Point | OnMovingBody | None]
    at: dict[int | str, Vector]
    without_number: list[int]
    frames: dict[int, Frame | None]
    attachments: dict[int, list[tuple[str, Vector]]]
    carried: dict[int, dict[str, dict[str, float]]]
    leaves: dict[int | str, Vector]
    smooth: set[int | str]


def read_points(rows: list[Row], bodies: list[Row], carrying: set[int], coupled: Mapping[int, Path], findings: Findings) -> Places:
    """Read points and the bodies that carry them.

    Parameters
    ----------
    rows, bodies : list of Row
    carrying : set of int
        Numbers of the bodies that carry something else.
    coupled : dict of point number to Path
        Motions that are given.
    findings : Findings
    """
    held: dict[int, Attachment] = {}
    found = Places({}, {}, [], {}, {}, {}, {}, set())
    good: list[tuple[int, Row]] = []
    for row in rows:
        with findings.refusing():
            found.without_number.append(row.line)
            number = row.count(0, "the number of a point")
            found.without_number.pop()
            if number in found.points:
                raise row.error(f"a point must come once, but {number} comes again.")
            found.points[number] = None
            _check_columns(row)
            held[number] = hold_of_point(row)
            good.append((number, row))
    used = {each.number for each in held.values() if each.hold is Hold.BODY}
    found.frames.update(read_bodies(bodies, used | carrying, findings))
    found.attachments.update({number: [] for number, frame in found.frames.items() if frame and frame.hold is Hold.FREE})
    _check_coupled(coupled, held, found.frames, findings)
    for frame in filter(None, found.frames.values()):
        if frame.pin:
            put_pin(found, frame.pin, frame.six[:3], frame.row)
    for number, row in good:
        with findings.refusing():
            _read(number, row, held[number], coupled.get(number), found)
    return found


def put_pin(places: Places, name: str, at: Sequence[float], row: Row) -> str:
    """Put the driven point into ``places`` to which a body or a rod of a row is pinned; returns its name."""
    x, y, z = at
    places.points[name], places.at[name] = Driven(name, made(row, paths.external, (x, y, z))), (x, y, z)
    return name


def _read(number: int, row: Row, held: Attachment, path: Path | None, found: Places) -> None:
    """Read the point of a row into ``found``."""
    x, y, z = (row.number(2 + x, "XYZ"[x]) for x in range(3))
    hold = held.hold
    if hold is Hold.BODY:
        if held.number not in found.frames:
            raise row.error(f"a point must be on a body in BODIES, but body {held.number} is not there.")
        frame = found.frames[held.number]
        if frame is None:  # said of the body
            return
        if frame.hold is Hold.FREE:
            _attach(number, row, held.number, frame, found)
            return
        hold = frame.hold
        x, y, z = frame.place_of((x, y, z))
    elif hold is Hold.TURBINE:
        row.findings.remark(
            f"Line {row.line}: point {number} is on turbine {held.number}; it is coupled, and starts where the row has it."
        )
    name = row.name or f"point{number}"
    if hold is Hold.FREE:
        found.points[number] = made(row, Free, name, at=(x, y, z), **_load(row))
    elif hold is Hold.FIXED:
        found.points[number] = made(row, Fixed, name, (x, y, z))
    else:
        found.points[number] = made(row, Driven, name, path or made(row, paths.external, (x, y, z)))
        if path is not None:
            x, y, z = path.at(0.0)[0].tolist()
    found.at[number] = x, y, z


def _attach(number: int, row: Row, body: int, frame: Frame, found: Places) -> None:
    """Read the point of a row on a body that moves by itself into ``found``; a row with the name "" is the origin of the body."""
    x, y, z = (row.number(2 + x, "XYZ"[x]) for x in range(3))
    load = _load(row)
    if any(load[key] for key in ("mass", "volume", "CdA")):
        found.carried.setdefault(body, {})["" if row.name == "" else row.name or f"point{number}"] = load
    if row.name == "":
        if x or y or z:
            raise row.error('a point on a body must have a name, or be at the origin of the body, but is called "".')
        found.points[number] = OnMovingBody(frame.name)
    else:
        name = row.name or f"point{number}"
        found.attachments[body].append((name, (x, y, z)))
        found.points[number] = OnMovingBody(f"{frame.name}.{name}")
    found.at[number] = frame.place_of((x, y, z))


def _load(row: Row) -> dict[str, float]:
    """What a point carries."""
    first = CdA_WITH_FORCE if _has_force(row) else CdA_WITHOUT_FORCE
    columns = ((5, "M", "mass"), (6, "V", "volume"), (first, "CdA", "CdA"), (first + 1, "CA", "Ca"))
    return {key: row.number(column, what) for column, what, key in columns}


def _check_columns(row: Row) -> None:
    """Refuse rows that are too short; columns behind the last one are passed over, as MoorDyn does."""
    if len(row.words) < CdA_WITHOUT_FORCE + 2:
        raise row.error(
            "a point must have 9 columns (ID, type, X, Y, Z, M, V, CdA, CA), or 12 with FX, FY, FZ before CdA, but has "
            f"{len(row.words)}."
        )
    beyond = row.words[(CdA_WITH_FORCE if _has_force(row) else CdA_WITHOUT_FORCE) + 2 :]
    if beyond:
        row.findings.unused(" ".join(beyond), row.line, "columns of points behind CA")


def steady_force(row: Row) -> Vector:
    """FX, FY, FZ of a point (3,) [N], as version 1 has them, or zeros."""
    if not _has_force(row):
        return 0.0, 0.0, 0.0
    x, y, z = (row.number(CdA_WITHOUT_FORCE + axis, name) for axis, name in enumerate(("FX", "FY", "FZ")))
    return x, y, z


def _has_force(row: Row) -> bool:
    """Whether a row has FX, FY, FZ: where it is that long, unless the file has other names for as many columns."""
    other = len(row.columns) >= WITH_FORCE and row.columns[CdA_WITHOUT_FORCE].startswith("cda")
    return len(row.words) >= WITH_FORCE and not other


def _check_coupled(
    coupled: Mapping[int, Path], held: Mapping[int, Attachment], frames: Mapping[int, Frame | None], findings: Findings
) -> None:
    """Refuse a motion of a point that is not coupled."""

    def is_coupled(each: Attachment) -> bool:
        frame = frames.get(each.number) if each.hold is Hold.BODY else None
        return each.hold in (Hold.COUPLED, Hold.TURBINE) or (frame is not None and frame.hold is Hold.COUPLED)

    able = [number for number, each in held.items() if is_coupled(each)]
    for number in coupled:
        if number not in able:
            given = ", ".join(map(str, able)) or "none"
            raise SceneError(
                f"Argument `coupled` must name coupled points of {findings.source} ({given}), but names {shown(number)}."
            )
