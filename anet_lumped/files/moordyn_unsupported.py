"""Sections of a MoorDyn file that have no counterpart here: refused where they would change the answer, passed over where not."""

import re

from .moordyn_findings import Findings
from .moordyn_rows import Row, number_of

ROD_END = re.compile(r"r(?:od)?(\d{1,18})[ab]", re.IGNORECASE)


def check_unsupported(sections: dict[str, list[Row]], findings: Findings) -> None:
    """Refuse rods that lines end at, external loads and the Syrope model; say what else is passed over."""
    ends = {int(end[1]) for row in sections.get("lines", ()) for word in row.words[2:6] if (end := ROD_END.fullmatch(word))}
    for row in sections.get("rods", ()):
        with findings.refusing():
            if row.count(0, "the number of a rod") in ends:
                raise row.error("rods that lines end at are not supported.")
            findings.unused(f"rod {row.words[0]}", row.line, "rods that no line ends at")
    for row in sections.get("rod types", ()):
        if not ends:
            findings.unused(row.words[0], row.line, "types of rods that no line ends at")
    for row in sections.get("external loads", ()):
        with findings.refusing():
            if any(number_of(word) != 0.0 for column in row.words[2:5] for word in column.split("|")):
                raise row.error("external loads are not supported; they must be 0.")
            findings.unused("0", row.line, "external loads")
    for row in sections.get("control", ()):
        findings.unused(f"channel {row.words[0]}", row.line, "control channels, for which there is no controller")
    for row in sections.get("syrope ic", ()):
        with findings.refusing():
            raise row.error("the Syrope model of polyester is not supported.")
