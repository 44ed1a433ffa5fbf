"""The failures of a MoorDyn file: lines that part from a point at a time or at a tension.

MoorDyn's Fortran version parts lines from the point at one of their ends, at a time or when the tension of one of them at this end
exceeds a limit, whichever comes first (its documentation, "Failure"). Lines of one failure stay joined, at a new point without mass
(MoorDyn::detachLines). Here they end at a free point that is held until then, `Release`. A line with an EI that is clamped where it
fails is cut in its last segment there, `CableCut`, which takes the clamp away.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from anet_lumped.checks import one_line, quoted
from anet_lumped.scene.cable_cut import CableCut
from anet_lumped.scene.release import Release
from anet_lumped.scene.scene import Free

from .moordyn_findings import Findings
from .moordyn_line_types import curved
from .moordyn_lines import POINT_LETTERS, Line, end_of_rod, type_of
from .moordyn_points import Places
from .moordyn_rows import DIGITS, WORD, Row, made

COLUMNS = 5  # FailureID, Point, Line(s), FailTime, FailTen


class Failures(NamedTuple):
    """How lines fail: all lines, of which those that fail end at ``points`` that are held, and what happens."""

    lines: list[Line]
    points: list[Free]
    events: list[CableCut | Release]


class _Failure(NamedTuple):
    """Lines that part from a point together: where the file says so, the point, the lines, when [s] and at what tension [N]."""

    row: Row
    point: int | str
    lines: tuple[Line, ...]
    t: float | None
    tension: float | None


def read_failures(
    rows: list[Row], lines: list[Line], places: Places, types: Mapping[str, tuple[Row, dict[str, Any]]], findings: Findings
) -> Failures:
    """Read how lines fail.

    Parameters
    ----------
    rows : list of Row
    lines : list of Line
        Those in order.
    places : Places
    types : dict
        Row and cable fields of each line type.
    findings : Findings
    """
    by_number = {line.number: line for line in lines}
    found: dict[tuple[int | str, frozenset[int]], _Failure] = {}
    for row in rows:
        with findings.refusing():
            failure = _read(row, by_number, places)
            if failure is None:
                continue
            key = failure.point, frozenset(line.number for line in failure.lines)
            for (point, numbers), other in found.items():
                if point == failure.point and numbers & key[1] and numbers != key[1]:
                    raise row.error(f"a line must fail once at an end, but one does in line {other.row.line} with others.")
            earlier = found.get(key, failure)
            t, tension = _first(earlier.t, failure.t), _first(earlier.tension, failure.tension)
            found[key] = earlier._replace(t=t, tension=tension)
    failures = Failures(list(lines), [], [])
    for failure in found.values():
        with findings.refusing():
            _part(failures, failure, places, types)
    return failures


def _read(row: Row, lines: Mapping[int, Line], places: Places) -> _Failure | None:
    """The failure of a row; None if it is none, or if one of its lines is refused already."""
    if len(row.words) < COLUMNS:
        raise row.error(
            f"a failure must have {COLUMNS} columns (FailureID, Point, Line(s), FailTime, FailTen), but has {len(row.words)}."
        )
    time, tension = row.number(3, "FailTime"), row.number(4, "FailTen")
    if time <= 0.0 and tension <= 0.0:
        row.findings.unused(f"failure {one_line(row.words[0], WORD)}", row.line, "failures at no time and no tension")
        return None
    point = end_of_rod(row.words[1]) or _number(row.words[1], POINT_LETTERS)
    if point is None or point not in places.points:
        raise row.error(f"a failure must be at a point in POINTS, but {one_line(row.words[1], WORD)} is none.")
    found = []
    for word in dict.fromkeys(word for word in row.words[2].split(",") if word):
        number = _number(word, ("",))
        line = None if number is None else lines.get(number)
        if line is None and row.findings.any_refused:  # of which the line may be one
            return None
        if line is None:
            raise row.error(f"a failure must be of a line in LINES, but {one_line(word, WORD)} is none.")
        if point not in line.ends:
            raise row.error(f"a line must fail at one of its ends, but {quoted(line.cable.name)} does not end at point {point}.")
        found.append(line)
    if not found:
        raise row.error("a failure must be of lines, but its third column names none.")
    return _Failure(row, point, tuple(found), time if time > 0.0 else None, tension if tension > 0.0 else None)


def _first(one: float | None, other: float | None) -> float | None:
    """The lesser of two numbers, of those that there are."""
    return min((x for x in (one, other) if x is not None), default=None)


def _part(found: Failures, failure: _Failure, places: Places, types: Mapping[str, tuple[Row, dict[str, Any]]]) -> None:
    """Let the lines of a failure end at a point that is held; or cut a line that is clamped there."""
    row, number = failure.row, failure.point
    holder, numbers = places.points[number], {line.number for line in failure.lines}
    assert holder is not None
    names = ", ".join(quoted(line.cable.name) for line in failure.lines)
    when = [f"at {failure.t:g} s"] if failure.t is not None else []
    when += [f"where the tension of one exceeds {failure.tension:g} N there"] if failure.tension is not None else []
    other = "; MoorDyn's C++ version does not do that."
    bends = [line for line in failure.lines if line.cable.EI or curved(types[type_of(line.row)][0])]
    if number in places.leaves and bends:
        if len(failure.lines) > 1 or failure.tension is not None:
            raise row.error("a line that is clamped where it fails must fail alone and at a time.")
        cable, at = bends[0].cable, 0 if number == bends[0].ends[0] else -1
        found.events.append(made(row, CableCut, cable.name, failure.t or 0.0, at))
        row.findings.remark(
            f"Line {row.line}: {names} is cut in its segment at point {number} {when[0]}, half of which stays there{other}"
        )
        return
    others = (line.cable for line in found.lines if line.number not in numbers)
    if isinstance(holder, Free) and not holder.mass and not any(holder.name in (cable.start, cable.end) for cable in others):
        raise row.error(f"a free point that lets go of all its lines must have a mass, but point {number} has none.")
    taken = {point.name for point in (*places.points.values(), *found.points) if point is not None}
    name = next(n for k in range(1, len(taken) + 2) if (n := f"{holder.name}.parted{k}") not in taken)
    if row.name and row.name not in taken:
        name = row.name
    x, y, z = places.at[number]
    found.points.append(Free(name, at=(x, y, z)))
    found.events.append(made(row, Release, name, holder.name, failure.t, failure.tension))
    for k, line in enumerate(found.lines):
        if line.number in numbers:
            cable = line.cable
            cable = replace(cable, start=name) if number == line.ends[0] else replace(cable, end=name)
            found.lines[k] = line._replace(cable=cable)
    part = "part together" if len(failure.lines) > 1 else "parts"
    row.findings.remark(f"Line {row.line}: {names} {part} from point {number} {' or '.join(when)}{other}")


def _number(word: str, letters: tuple[str, ...]) -> int | None:
    """Number behind letters, or None."""
    digits = word.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz")
    good = digits.isascii() and digits.isdecimal() and len(digits) <= DIGITS and word[: len(word) - len(digits)].lower() in letters
    return int(digits) if good else None
