"""The rows of a MoorDyn input file, by section, each with the line it stands on.

A section begins with a heading, a line that holds `---` and the section's name, and ends with the next; what stands before
the first is free text. A section holds a table, below two lines of column names and units, or options, one to a line. `!`,
`#` and `%` begin a remark. So MoorDyn reads its files (its documentation, "The V2 Input File", and source/MoorDyn2.cpp:
ReadInFile, findStartOfSection).

Its points and lines have numbers; here they have names. The remark `! name: "..."` (a JSON string) gives a row one.
"""

import json
import math
import re
from typing import NamedTuple

from anet_lumped.checks import SceneError, one_line, quoted, shown

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
    "options": ("OPTIONS",),
    "outputs": ("OUTPUT",),
}
WITHOUT_COLUMN_NAMES = ("options", "outputs")
ROW, WORD = 80, 40  # characters of a row, and of a word in it, in a message
DIGITS = 18  # of an integer of 64 bits
NAME = re.compile(r'!\s*name:\s*("(?:[^"\\]|\\.)*")\s*$')


class Row(NamedTuple):
    """A line of a section.

    Parameters
    ----------
    where : file and line, for messages
    text : the line without its remark
    words : its columns
    columns : names of the columns in lower case, as the file gives them
    name : what the row is called in a remark, or None
    """

    where: str
    text: str
    words: tuple[str, ...]
    columns: tuple[str, ...]
    name: str | None

    def error(self, why: str) -> SceneError:
        """SceneError that says where the row stands, what it says and why that does not do."""
        return SceneError(f'{self.where}, "{one_line(self.text, ROW)}": {why}')

    def number(self, column: int, what: str) -> float:
        """Number in a column; `what` it is, for messages."""
        word = self.words[column]
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.error(f"{what} must be a finite number, but is {one_line(word, WORD)}.")
        return value

    def count(self, column: int, what: str) -> int:  # type: ignore[override]  # no use is made of that of a tuple
        """Integer of at least 1 in a column."""
        word = self.words[column]
        if not word.isdecimal() or len(word) > DIGITS or int(word) < 1:
            raise self.error(f"{what} must be an integer of at least 1, but is {one_line(word, WORD)}.")
        return int(word)


def rows_by_section(text: str, source: str) -> dict[str, list[Row]]:
    """Split the text of an input file.

    Parameters
    ----------
    text : str
    source : str, where it comes from, for messages

    Returns
    -------
    dict of section to list of Row, in the order of the file

    Raises
    ------
    SceneError : a section that MoorDyn does not have, or that is there twice
    """
    found: dict[str, list[Row]] = {}
    section: str | None = None
    columns: tuple[str, ...] = ()
    above = 0
    for number, line in enumerate(text.splitlines(), start=1):
        where = f"{source}, line {number}"
        if "---" in line:
            heading = line.strip(" -\t")
            fits = [name for name, words in HEADINGS.items() if any(word in heading.upper() for word in words)]
            section = fits[0] if fits else (heading if found else None)
            if fits and section in found:
                raise SceneError(f"{where}: a section must come once, but {quoted(heading)} comes again.")
            if fits:
                found[fits[0]] = []
            columns, above = (), 2 if fits and section not in WITHOUT_COLUMN_NAMES else 0
            continue
        if section is None:
            continue
        if above:
            columns = tuple(line.lower().split()) if above == 2 else columns
            above -= 1
            continue
        remark = NAME.search(line)
        content = re.split("[!#%]", line, maxsplit=1)[0].strip()
        if not content:
            continue
        row = Row(where, content, tuple(content.split()), columns, None)
        if remark:
            row = row._replace(name=_name(row, remark[1]))
        if section not in HEADINGS:
            raise row.error(f"a section must be one of MoorDyn's, but its heading is {quoted(section)}.")
        found[section].append(row)
    return found


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
