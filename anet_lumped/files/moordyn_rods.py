"""The rods of a MoorDyn file, and lines that end at them: `R1A` is end A of rod 1.

A rod that is free is a `Body` of its own, one that is pinned is held at its end A, by a driven point "rod1.pin" if it is
"CoupledPinned"; a rod on a body that moves by itself is a `Rod` of that body, or, if it turns there ("Body1Pinned"), a `Body` whose
end A is pinned to that body. Its ends are "rod1.a" and "rod1.b". A rod that is fixed or coupled, by itself or on such a body, does
not move by itself: its ends are fixed or driven points, and no load on it is computed. Rods that no line ends at are left out, but
for those on bodies, and those that move in a file without lines. A rod without a length, NumSegs 0, has neither mass nor drag in
MoorDyn (Rod::setup), wherever its end B is given: it is a point at its end A, "rod1".

MoorDyn's rods have no drag and no added mass along them but at their end caps (MoorDyn2.cpp: readRodProps).
"""

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from anet_lumped.checks import Vector, one_line, quoted
from anet_lumped.prescribed import paths
from anet_lumped.scene.body import Body
from anet_lumped.scene.rod import Rod
from anet_lumped.scene.rod_body import rod_body
from anet_lumped.scene.scene import Driven, Fixed, Free

from .moordyn_attachments import Attachment, Hold, attachment
from .moordyn_bodies import Frame
from .moordyn_findings import Findings
from .moordyn_lines import end_of_rod
from .moordyn_points import OnMovingBody, Places, put_pin
from .moordyn_rows import WORD, Row, made

TYPE_COLUMNS = 7  # TypeName, Diam, Mass/m, Cd, Ca, CdEnd, CaEnd
COLUMNS = 11  # ID, RodType, Attachment, Xa, Ya, Za, Xb, Yb, Zb, NumSegs, RodOutputs
PINNED = re.compile(r"pin(ned)?\d*", re.IGNORECASE)  # by itself; a number behind it is passed over
LIGHT, WATER = 1e-6, 1000.0  # mass that a rod without one is given, over that of the water [kg/m3] in its volume
STAYS = "stays where it is, while the rod turns about it."
OF_TYPE = ((1, "Diam", "diameter"), (2, "Mass/m", "mass_per_length"), (3, "Cd", "Cdn"), (4, "Ca", "Can"))
OF_ENDS = ((5, "CdEnd", "Cd_end"), (6, "CaEnd", "Ca_end"))


class Rods(NamedTuple):
    """The rods of a file that move.

    Parameters
    ----------
    bodies : those that are a body of their own
    on_bodies : Rod on each body that moves by itself, by its number
    """

    bodies: list[Body]
    on_bodies: dict[int, list[Rod]]


def bodies_under(rods: list[Row]) -> set[int]:
    """Numbers of the bodies that rods are on."""
    found = {attachment(row.words[2]) for row in rods if len(row.words) > 2}
    return {each.number for each in found if each.hold is Hold.BODY}


def read_rods(rods: list[Row], types: list[Row], lines: list[Row], places: Places, findings: Findings) -> Rods:
    """Read the rods; their ends are put into ``places``, None of those that are refused.

    Parameters
    ----------
    rods, types, lines : list of Row
    places : Places
    findings : Findings
    """
    ends = {end for row in lines for word in row.words[2:6] if (end := end_of_rod(word))}
    by_name = {row.words[0]: row for row in types}
    found, numbers, used_types = Rods([], {}), set(), set()
    for row in rods:
        with findings.refusing():
            number = row.count(0, "the number of a rod")
            if number in numbers:
                raise row.error(f"a rod must come once, but {number} comes again.")
            numbers.add(number)
            own = [end for end in (f"R{number}A", f"R{number}B") if end in ends]
            places.points.update(dict.fromkeys(own))
            held = _hold(row)
            moves = not lines and (held.hold is Hold.FREE or held.pinned) and row.words[9:10] != ["0"]
            if not own and not moves and not (held.hold is Hold.BODY and held.number in places.attachments):
                findings.unused(f"rod {row.words[0]}", row.line, "rods that no line ends at")
                continue
            used_types.add(row.words[1])
            _read(number, row, held, by_name, own, (places, found))
    for row in types:
        if row.words[0] not in used_types:
            findings.unused(row.words[0], row.line, "types of rods that no line ends at")
    return found


def _hold(row: Row) -> Attachment:
    """What holds the rod of a row."""
    found = attachment(row.words[2]) if len(row.words) > 2 else Attachment(None, 0, False)
    if found.hold is None and row.words[2:3] and PINNED.fullmatch(row.words[2]):
        return Attachment(Hold.FIXED, 0, True)
    if found.hold is None:
        raise row.error("a rod must be Free, Pinned, Fixed, Coupled, CoupledPinned or on Body and a number.")
    return found


def _read(number: int, row: Row, held: Attachment, types: Mapping[str, Row], own: list[str], into: tuple[Places, Rods]) -> None:
    """Read the rod of a row into places and rods, with those of its ends at which lines end."""
    places, found = into
    if len(row.words) < COLUMNS:
        raise row.error(
            f"a rod must have {COLUMNS} columns (ID, RodType, Attachment, Xa, Ya, Za, Xb, Yb, Zb, NumSegs, RodOutputs), but has "
            f"{len(row.words)}."
        )
    if row.words[1] not in types:
        raise row.error(f"a rod must be of a type in ROD TYPES, but {quoted(row.words[1])} is none.")
    a, b = ((row.number(first, "Xa"), row.number(first + 1, "Ya"), row.number(first + 2, "Za")) for first in (3, 6))
    segments, name = row.count(9, "NumSegs", least=0), row.name or f"rod{number}"
    if not segments:
        _put_point(row, name, held, a, own, places)
        return
    hold = held.hold
    at: dict[str, Vector] = {"A": a, "B": b}
    pin = None
    if hold is Hold.BODY:
        frame = _frame_of(row, held.number, places)
        if frame is None:
            return
        at = {end: frame.place_of(place) for end, place in at.items()}
        if held.pinned and frame.hold is not Hold.FIXED:
            pin = _hinge(row, name, held.number, frame, a, (places, at["A"]))
        elif frame.hold is Hold.FREE:
            found.on_bodies.setdefault(held.number, []).append(made(row, Rod, name, a, b, segments=segments, **_of(types, row)))
            for end in own:
                ends_name = f"{name}.{end[-1].lower()}"
                places.attachments[held.number].append((ends_name, a if end[-1] == "A" else b))
                _put(places, end, OnMovingBody(f"{frame.name}.{ends_name}"), at)
            return
        hold = frame.hold
    elif held.pinned and hold is Hold.COUPLED:
        pin = put_pin(places, f"{name}.pin", a, row)
    if hold is Hold.FREE or held.pinned:
        if held.pinned:
            held_there = f"is pinned to {quoted(pin)}, and the rod turns about it." if pin else STAYS
            row.findings.remark(f"End A of rod {quoted(name)} {held_there}")
        of_rod = _of(types, row)
        _own_body(row, name, at, own, into, segments=segments, pinned="a" if held.pinned else None, pinned_to=pin, **of_rod)
        return
    row.findings.remark(f"Rod {quoted(name)} does not move by itself: lines are held at its ends, and no load on it is computed.")
    for end in own:
        end_name, place = f"{name}.{end[-1].lower()}", at[end[-1]]
        point = Fixed(end_name, place) if hold is Hold.FIXED else Driven(end_name, made(row, paths.external, place))
        _put(places, end, point, at)


def _frame_of(row: Row, number: int, places: Places) -> Frame | None:
    """The body that a rod is on; None for one that is refused itself."""
    if number not in places.frames:
        raise row.error(f"a rod must be on a body in BODIES, but body {number} is not there.")
    return places.frames[number]


def _put_point(row: Row, name: str, held: Attachment, at: Vector, own: list[str], places: Places) -> None:
    """Put a rod without a length into places: one point, at which the lines of both its ends are joined."""
    hold = held.hold
    point: Fixed | Driven | Free | OnMovingBody
    if hold is Hold.BODY:
        frame = _frame_of(row, held.number, places)
        if frame is None:
            return
        if frame.hold is Hold.FREE:
            places.attachments[held.number].append((name, at))
        hold, on_body, at = frame.hold, OnMovingBody(f"{frame.name}.{name}"), frame.place_of(at)
        point = on_body
    if hold is Hold.FIXED:
        point = Fixed(name, at)
    elif hold in (Hold.COUPLED, Hold.TURBINE):
        point = Driven(name, made(row, paths.external, at))
    elif held.hold is not Hold.BODY:
        point = Free(name, at=at)
    for end in own:
        places.points[end], places.at[end] = point, at
        places.smooth.add(end)


def _own_body(row: Row, name: str, at: Mapping[str, Vector], own: list[str], into: tuple[Places, Rods], **fields: Any) -> None:
    """Put a rod that is a body of its own into rods, and its ends at which lines end into places."""
    into[1].bodies.append(made(row, rod_body, name, at["A"], at["B"], **fields))
    for end in own:
        _put(into[0], end, OnMovingBody(f"{name}.{end[-1].lower()}"), at)


def _hinge(row: Row, rod: str, number: int, frame: Frame, place: Vector, into: tuple[Places, Vector]) -> str:
    """Name of the point of a body at which a rod turns: that of a point there, or one of its own.

    ``place`` is in the axes of the body, the place in ``into`` in those of the world.
    """
    places, at = into
    if frame.hold is Hold.FREE:
        attachments = places.attachments[number]
        name = next((name for name, other in attachments if other == place), None)
        if name is None and place == (0.0, 0.0, 0.0):
            return frame.name
        if name is None:
            name = rod
            attachments.append((name, place))
        return f"{frame.name}.{name}"
    return put_pin(places, f"{rod}.pin", at, row)


def _put(places: Places, end: str, point: Fixed | Driven | OnMovingBody, at: Mapping[str, Vector]) -> None:
    places.points[end], places.at[end] = point, at[end[-1]]
    here, there = at[end[-1]], at["B" if end[-1] == "A" else "A"]
    if math.dist(here, there) > 0.0:
        places.leaves[end] = (here[0] - there[0], here[1] - there[1], here[2] - there[2])


def _of(types: Mapping[str, Row], rod: Row) -> dict[str, Any]:
    """Fields of a Rod from its type."""
    row = types[rod.words[1]]
    if len(row.words) < TYPE_COLUMNS:
        raise row.error(
            f"a type of rods must have {TYPE_COLUMNS} columns (TypeName, Diam, Mass/m, Cd, Ca, CdEnd, CaEnd), but has "
            f"{len(row.words)}."
        )
    if beyond := row.words[TYPE_COLUMNS:]:
        row.findings.unused(one_line(" ".join(beyond), WORD), row.line, "columns of types of rods behind CaEnd")
    fields = {field: row.number(column, what) for column, what, field in (*OF_TYPE, *OF_ENDS)} | {"Cdt": 0.0, "Cat": 0.0}
    if fields["mass_per_length"] == 0.0 and attachment(rod.words[2]).hold is not Hold.BODY:
        fields["mass_per_length"] = LIGHT * WATER * 0.25 * math.pi * fields["diameter"] ** 2
        row.findings.remark(
            f"Line {row.line}: a rod of no mass that moves by itself is given {LIGHT:g} of that of the water in its volume."
        )
    return fields
