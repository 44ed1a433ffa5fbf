"""The rows of a MoorDyn input file, by section, each with the line it stands on.

A section begins with a heading, a line that holds `---` and the section's name, and ends with the next; what stands before
the first is free text, and so are sections of other names. A section holds a table, below two lines of column names and units, or
options, one to a line. `!`, `#` and `%` begin a remark. So MoorDyn reads its files (its documentation, "The V2 Input File", and
source/MoorDyn2.cpp: ReadInFile, findStartOfSection). The first Fortran version has a line with the number of rows above the names
of columns: `3 NLines`. Exponents may be Fortran's: `6.0D8`.

Its points and lines have numbers; here they have names. The remark `! name: "..."` (a JSON string) gives a row one.
"""

import difflib
import json
import math
import pathlib
import re
from typing import Any, NamedTuple

from anet_lumped.checks import NAMED, InputError, SceneError, one_line, quoted, shown

from .moordyn_findings import Findings, RowError

HEADINGS = {  # section -> what its heading holds, by MoorDyn versions; the first section that fits counts
    "rod types": ("ROD DICTIONARY", "ROD TYPES"),
    "line types": ("LINE DICTIONARY", "LINE TYPES"),
    "rods": ("RODS", "ROD LIST", "ROD PROPERTIES"),
    "bodies": ("BODIES", "BODY LIST", "BODY PROPERTIES"),
    "points": ("POINTS", "POINT LIST", "POINT PROPERTIES", "CONNECTION", "NODE PROPERTIES"),
    "lines": ("LINES", "LINE LIST", "LINE PROPERTIES"),
    "failure": ("FAILURE",),
    "control": ("CONTROL",),
    "external loads": ("EXTERNAL LOADS",),
    "syrope ic": ("SYROPE",),
    "options": ("OPTIONS",),
    "outputs": ("OUTPUT",),
}
WITHOUT_COLUMN_NAMES = ("options", "outputs")
ALIKE = 0.75  # letters that a heading shares with MoorDyn's, from where on it is taken for a misspelt one
LONGEST_HEADING = 40  # characters of it that are compared
END = re.compile("NEED THIS LINE|^END\\b")
ROW, WORD = 80, 40  # characters of a row, and of a word in it, in a message
DIGITS = 18  # of an integer of 64 bits
COUNT = re.compile(r"\d{1,18}(\.0*)?")  # 20 or 20.0
ROW_COUNT = re.compile(r"\s*(\d{1,18})\s+N[A-Za-z]*(Types|Connects|Points|Nodes|Lines|Rods|Bodies)\b", re.IGNORECASE)
FORTRAN = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))[dDqQ]([+-]?\d+)")
UNITS = re.compile(r"\s*(\([^()\s]*\)\s*)+")  # a row of words in brackets
NAME = re.compile(r'!\s*name:\s*("(?:[^"\\]|\\.)*")\s*$')


class Row(NamedTuple):
    """A line of a section.

    Parameters
    ----------
    line : its number
    text : the line without its remark
    words : its columns
    columns : names of the columns in lower case, as the file gives them
    name : what the row is called in a remark, or None
    findings : what is to be said of the file
    """

    line: int
    text: str
    words: tuple[str, ...]
    columns: tuple[str, ...]
    name: str | None
    findings: Findings

    def error(self, why: str) -> SceneError:
        """SceneError that says where the row stands, what it says and why that does not do."""
        return RowError(self.findings.source, self.line, one_line(self.text, ROW), why)

    def number(self, column: int, what: str) -> float:
        """Number in a column; `what` it is, for messages."""
        word = self.words[column]
        value = number_of(word)
        if not math.isfinite(value):
            raise self.error(f"{what} must be a finite number, but is {one_line(word, WORD)}.")
        if FORTRAN.fullmatch(word):
            self.findings.remark(
                f"Line {self.line}: {what} {one_line(word, WORD)} is read as {value:g}; "
                "MoorDyn's C++ version stops reading at the D."
            )
        return value

    def count(self, column: int, what: str, least: int = 1) -> int:  # type: ignore[override]  # that of a tuple is not used
        """Integer of at least ``least`` in a column, which may be written 20.0."""
        word = self.words[column]
        if not word.isascii() or not COUNT.fullmatch(word) or int(word.partition(".")[0]) < least:
            raise self.error(f"{what} must be an integer of at least {least}, but is {one_line(word, WORD)}.")
        return int(word.partition(".")[0])


def number_of(word: str) -> float:
    """Value of a word, NaN if it is no number; 6.0D8 is Fortran's 6.0e8."""
    try:
        return float(FORTRAN.sub(r"\1e\2", word) if FORTRAN.fullmatch(word) else word)
    except ValueError:
        return math.nan


def made(row: Row, maker: Any, *arguments: Any, **fields: Any) -> Any:
    """Call `maker`; what it refuses is said with the row."""
    try:
        return maker(*arguments, **fields)
    except ValueError as error:
        raise row.error(str(error)) from None


def unreadable(path: pathlib.Path, error: InputError) -> str:
    """A file that a row names, and why it cannot be read; ``error`` is that of `read_text` for what is called "It"."""
    why = str(error)
    why = why.rpartition(": ")[2] if why.startswith("It must be readable") else why
    return f"{one_line(path.name, NAMED)}: {why}"


def is_number(word: str) -> bool:
    """Whether a word is a finite number."""
    return math.isfinite(number_of(word))


def rows_by_section(text: str, findings: Findings) -> dict[str, list[Row]]:
    """Split the text of an input file.

    Parameters
    ----------
    text : str
    findings : Findings
        Gathers a section that has the name of no section but nearly so, and what no use is made of: of sections that come again.

    Returns
    -------
    dict of section to list of Row, in the order of the file
    """
    found: dict[str, list[Row]] = {}
    section: str | None = None
    columns: tuple[str, ...] = ()
    above = 0
    for number, line in enumerate(text.splitlines(), start=1):
        if "---" in line:
            section = _section(" ".join(line.strip(" -\t").split()), number, found, findings)
            columns, above = (), 2 if section is not None and section not in WITHOUT_COLUMN_NAMES else 0
            continue
        if section is None:
            continue
        if above:
            if above == 2 and ROW_COUNT.match(line):  # of the first Fortran version
                continue
            columns = columns or (() if UNITS.fullmatch(line) else tuple(line.lower().split()))
            above -= 1
            continue
        remark = NAME.search(line)
        content = re.split("[!#%]", line, maxsplit=1)[0].strip()
        if not content or (section == "outputs" and content.split()[0].upper() == "END"):
            continue
        if UNITS.fullmatch(line) and section not in WITHOUT_COLUMN_NAMES:  # below an empty line, which counts as one of the two
            continue
        words = tuple(content.split())
        row = Row(number, " ".join(words), words, columns, None, findings)
        if remark:
            with findings.refusing():
                row = row._replace(name=_name(row, remark[1]))
        found[section].append(row)
    return found


def _section(heading: str, line: int, found: dict[str, list[Row]], findings: Findings) -> str | None:
    """Section that a heading begins, put into ``found``; None for free text."""
    asked = heading.upper()
    section = next((name for name, words in HEADINGS.items() if any(word in asked for word in words)), None)
    where = f"{findings.source}, line {line}"
    with findings.refusing():
        if section in found:
            findings.unused(f"the section {quoted(heading)}", line, "sections that come again, as by MoorDyn")
            return None
        if section is None and heading:
            names = [word for words in HEADINGS.values() for word in words]
            near = difflib.get_close_matches(asked[:LONGEST_HEADING], names, 1, ALIKE)
            if near:
                raise SceneError(
                    f"{where}: a section must be one of MoorDyn's, but its heading is {quoted(heading)}, "
                    f"did you mean {quoted(near[0])}?"
                )
            if found and not END.search(asked):
                findings.unused(f"the section {quoted(heading)}", line, "text between the sections")
        if section is not None:
            found[section] = []
            return section
    return None


def _name(row: Row, text: str) -> str:
    """What a remark calls a row."""
    try:
        return json.loads(text)
    except ValueError:
        raise row.error(f"a name must be a string as in JSON, where a backslash is written twice, but is {shown(text)}.") from None


def named(name: str) -> str:
    """Remark that gives a row its name."""
    quoted = json.dumps(name, ensure_ascii=not name.isprintable())
    return "  ! name: " + (quoted.replace("-", "\\u002d") if "---" in name else quoted)
