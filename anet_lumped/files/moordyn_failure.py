"""The failures of a MoorDyn file: lines that part from a point at a time or at a tension.

MoorDyn's Fortran version parts a line from the point at one of its ends, at a time or when the tension at this end exceeds a limit,
whichever comes first (its documentation, "Failure"). Here a line is cut at its last segment there, `CableCut`, half of which stays
with the point. And a cable breaks where its tension exceeds its `breaking_tension` first; while it hangs from its upper end both
are the same, but for a segment. Other failures are refused.
"""

from collections.abc import Mapping
from typing import NamedTuple

from anet_lumped.checks import one_line, quoted
from anet_lumped.scene.cable_cut import CableCut

from .moordyn_findings import Findings
from .moordyn_lines import POINT_LETTERS, Line, end_of_rod
from .moordyn_points import Places
from .moordyn_rows import DIGITS, WORD, Row

COLUMNS = 5  # FailureID, Point, Line(s), FailTime, FailTen


class Failures(NamedTuple):
    """How lines fail: breaking tension [N] of each line that has one, by its number, and the cuts at given times."""

    tensions: dict[int, float]
    cuts: tuple[CableCut, ...]


def read_failures(rows: list[Row], lines: list[Line], places: Places, findings: Findings) -> Failures:
    """Read how lines fail.

    Parameters
    ----------
    rows : list of Row
    lines : list of Line
        Those in order.
    places : Places
    findings : Findings
    """
    by_number = {line.number: line for line in lines}
    found: dict[int, float] = {}
    cuts: dict[tuple[str, int], CableCut] = {}
    for row in rows:
        with findings.refusing():
            if len(row.words) < COLUMNS:
                raise row.error(
                    f"a failure must have {COLUMNS} columns (FailureID, Point, Line(s), FailTime, FailTen), but has "
                    f"{len(row.words)}."
                )
            time, tension = row.number(3, "FailTime"), row.number(4, "FailTen")
            if time <= 0.0 and tension <= 0.0:
                findings.unused(f"failure {one_line(row.words[0], WORD)}", row.line, "failures at no time and no tension")
                continue
            point, line = _line_at(row, by_number, places)
            if line is None:
                continue
            if time > 0.0:
                segment = 0 if point == line.ends[0] else -1
                earlier = cuts.get((line.cable.name, segment))
                cuts[line.cable.name, segment] = CableCut(line.cable.name, min(time, earlier.t if earlier else time), segment)
                findings.remark(
                    f"Line {row.line}: {quoted(line.cable.name)} is cut in its segment at point {point} at {time:g} s, half of "
                    "which stays there; MoorDyn's C++ version does not do that."
                )
            if tension > 0.0:
                _check_upper(row, line, point, places)
                found[line.number] = min(tension, found.get(line.number, tension))
                findings.remark(
                    f"Line {row.line}: {quoted(line.cable.name)} breaks where its tension first exceeds {tension:g} N, which is at "
                    "its upper end while it hangs from there; MoorDyn's C++ version does not do that."
                )
    return Failures(found, tuple(cuts.values()))


def _line_at(row: Row, lines: Mapping[int, Line], places: Places) -> tuple[int | str, Line | None]:
    """Point and line of a failure, which must be one line that ends there; no line if it is refused already."""
    numbers = [word for word in row.words[2].split(",") if word]
    if len(numbers) != 1:
        raise row.error("lines that part from a point together are not supported; a failure must be of one line.")
    point = end_of_rod(row.words[1]) or _number(row.words[1], POINT_LETTERS)
    if point is None or point not in places.points:
        raise row.error(f"a failure must be at a point in POINTS, but {one_line(row.words[1], WORD)} is none.")
    number = _number(numbers[0], ("",))
    line = None if number is None else lines.get(number)
    if line is None:
        if row.findings.any_refused:  # of which the line may be one
            return point, None
        raise row.error(f"a failure must be of a line in LINES, but {one_line(numbers[0], WORD)} is none.")
    if point not in line.ends:
        raise row.error(f"a line must fail at one of its ends, but {quoted(line.cable.name)} does not end at point {point}.")
    return point, line


def _check_upper(row: Row, line: Line, point: int | str, places: Places) -> None:
    """A line that fails at a tension must part from its upper end."""
    other = line.ends[0] if point == line.ends[1] else line.ends[1]
    if places.at[point][2] < places.at[other][2]:
        raise row.error("a line that parts from its lower end is not supported; it breaks where its tension is largest.")


def _number(word: str, letters: tuple[str, ...]) -> int | None:
    """Number behind letters, or None."""
    digits = word.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz")
    good = digits.isascii() and digits.isdecimal() and len(digits) <= DIGITS and word[: len(word) - len(digits)].lower() in letters
    return int(digits) if good else None
