"""The lines of a MoorDyn file: unstretched length (less than 0: a multiple of the distance between its ends), in equal segments.

A spring cannot push but its damper always acts: compression="damped". A viscoelastic line only pulls: compression="none".
"""

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from anet_lumped.checks import nearest, one_line, quoted
from anet_lumped.scene.scene import Cable

from .moordyn_findings import Findings
from .moordyn_points import Places
from .moordyn_rows import DIGITS, WORD, Row, made

NO_OUTPUT = ("-", "0", "none")
ROD_END = re.compile(r"r(?:od)?(\d{1,18})([ab])", re.IGNORECASE)
POINT_LETTERS = ("", "c", "con", "p", "point", "connect")


class Line(NamedTuple):
    """A line of a file that is in order.

    Parameters
    ----------
    number : its number
    cable : Cable
    ends : numbers of the points at both, "R1A" of the end A of rod 1
    row : where it stands
    outputs : its letters of output, "" for none
    """

    number: int
    cable: Cable
    ends: tuple[int | str, int | str]
    row: Row
    outputs: str


def end_of_rod(word: str) -> str | None:
    """Name of the end of a rod in `Places.points`, such as "R1A"; None if it is none."""
    end = ROD_END.fullmatch(word)
    return None if end is None else f"R{int(end[1])}{end[2].upper()}"


def type_of(row: Row) -> str:
    """Name of the type of a line, "" where the row is too short."""
    return row.words[1] if len(row.words) > 1 else ""


def read_lines(
    rows: list[Row],
    names: list[str],
    types: Mapping[str, tuple[Row, dict[str, Any]]],
    places: Places,
    held: Mapping[str, float],
    findings: Findings,
) -> list[Line]:
    """Read the lines, but for those whose type or whose points are refused.

    Parameters
    ----------
    rows : list of Row
    names : list of str
        Of all types in the file.
    types : dict
        Row and cable fields of those in order.
    places : Places
    held : dict of number of a line, as a word, to the largest tension that it has held [N]
    findings : Findings
    """
    found: list[Line] = []
    numbers: set[int] = set()
    for row in rows:
        with findings.refusing():
            line = _line(row, names, types, places, held)
            number = row.count(0, "the number of a line")
            if number in numbers or (line is not None and line.cable.name in [other.cable.name for other in found]):
                called = line.cable.name if line is not None else f"line{number}"
                raise row.error(f"a line must come once, but {one_line(called, WORD)} comes again.")
            numbers.add(number)
            if line is not None:
                found.append(line)
    return found


def _line(
    row: Row, names: list[str], types: Mapping[str, tuple[Row, dict[str, Any]]], places: Places, held: Mapping[str, float]
) -> Line | None:
    """Line of a row; None if its type or one of its points is refused."""
    if len(row.words) < 7:
        raise row.error(f"a line must have 7 columns (ID, type, A, B, UnstrLen, NumSegs, outputs), but has {len(row.words)}.")
    at_a, at_b, at_length, at_segments = _columns(row, places)
    kind = row.words[1]
    if kind not in names and names:
        hint = nearest(kind, names) or f"; known: {', '.join(names)}."
        raise row.error(f"a line must be of a type in LINE TYPES, but {quoted(kind)} is none{hint}")
    ends = _end(row, at_a, places), _end(row, at_b, places)
    length, segments = row.number(at_length, "UnstrLen"), row.count(at_segments, "NumSegs")
    outputs = "".join(word for word in row.words[6:] if word.lower() not in NO_OUTPUT)
    start, end = (places.points.get(number) for number in ends)
    if kind not in types or start is None or end is None:  # said already
        return None
    if length < 0.0:  # MoorDyn's Line::initialize
        times, length = -length, -length * math.dist(*(places.at[number] for number in ends))
        row.findings.remark(
            f"Line {row.line}: UnstrLen {-times:g} is {times:g} times the distance of both ends, {length:g} m, as by MoorDyn."
        )
    number = row.count(0, "the number of a line")
    type_row, fields = types[kind]
    law = _law(_worked(row, fields, held), length / segments)
    try:
        cable = Cable(start.name, end.name, name=row.name or f"line{number}", length=length, segments=segments, **law)
    except ValueError as error:  # which names an argument of the line, or one of its type
        raise (type_row if any(f"`{name}`" in str(error) for name in fields) else row).error(str(error)) from None
    if cable.creeps:
        row.findings.remark(
            f"Line {row.line}: {quoted(cable.name)} creeps and only pulls, where MoorDyn's slow damper acts on slack segments."
        )
    return Line(number, cable, ends, row, outputs)


def _columns(row: Row, places: Places) -> tuple[int, int, int, int]:
    """Columns of both ends, of UnstrLen and of NumSegs: as MoorDyn v2 has them, or as v1, UnstrLen and NumSegs first.

    The names of the columns say which, unless only the other order has the names of two ends.
    """
    v1, v2 = (4, 5, 2, 3), (2, 3, 4, 5)
    named, other = (v1, v2) if len(row.columns) > 2 and row.columns[2].startswith("unstr") else (v2, v1)

    def ends_at(columns: tuple[int, ...]) -> bool:
        return all(_is_end(word, places) for word in row.words[columns[0] : columns[1] + 1])

    if ends_at(other) and not ends_at(named):
        order = "UnstrLen, NumSegs, A, B" if other is v1 else "A, B, UnstrLen, NumSegs"
        row.findings.remark(f"Line {row.line}: columns 3 to 6 are read as {order}, though the file calls them otherwise.")
        return other
    return named


def _is_end(word: str, places: Places) -> bool:
    """Whether a word is a point of the file or the end of a rod in it."""
    letters = word.rstrip("0123456789")
    number = word[len(letters) :]
    if letters.lower() in POINT_LETTERS and number and len(number) <= DIGITS:
        return int(number) in places.points
    return end_of_rod(word) in places.points


def _law(fields: Mapping[str, Any], L0: float) -> dict[str, Any]:
    """Cable fields of a line of a type, in segments of ``L0`` [m]: MoorDyn's Line::initialize."""
    if "BA_creep" not in fields:
        return {"compression": "damped"} | dict(fields)
    slow = fields["BA_creep"]
    return dict(fields) | {"BA_creep": slow if slow >= 0.0 else -slow * L0 * math.sqrt(fields["EA"] * fields["mass_per_length"])}


def _worked(row: Row, fields: Mapping[str, Any], held: Mapping[str, float]) -> Mapping[str, Any]:
    """Cable fields with the largest tension that a polyester line has held."""
    if "working_curve" not in fields:
        if row.words[0] in held:
            row.findings.remark(f"Line {row.line}: line {row.words[0]} is in SYROPE IC, but is no Syrope line.")
        return fields
    if row.words[0] not in held:
        raise row.error("a Syrope line must have its Tmax0 in a section SYROPE IC, but that has no such line.")
    curve = made(row, replace, fields["working_curve"], T_max=held[row.words[0]])
    return dict(fields) | {"working_curve": curve}


def _end(row: Row, column: int, places: Places) -> int | str:
    """Number of the point at an end of a line: 3, P3, Point3, C3 or Con3; "R1A" of R1A or Rod1A."""
    word = row.words[column]
    letters = word.rstrip("0123456789")
    number = word[len(letters) :]
    if letters.lower() in POINT_LETTERS and number:
        if len(number) <= DIGITS and (int(number) in places.points or places.without_number or not places.points):
            return int(number)
        known = ", ".join(str(point) for point in places.points if isinstance(point, int))
        raise row.error(f"a line must end at a point in POINTS, but point {one_line(word, WORD)} is not there; known: {known}.")
    if end := end_of_rod(word):
        if end in places.points:
            return end
        raise row.error(f"a line must end at a rod in RODS, but {one_line(word, WORD)} is none.")
    raise row.error(f"a line must end at the number of a point, but {one_line(word, WORD)} is none.")
