"""Sections of a MoorDyn file that have no counterpart here: refused where they would change the answer, passed over where not."""

from .moordyn_findings import Findings
from .moordyn_rows import Row, number_of


def check_unsupported(sections: dict[str, list[Row]], findings: Findings) -> None:
    """Refuse external loads; say what else is passed over."""
    for row in sections.get("external loads", ()):
        with findings.refusing():
            if any(number_of(word) != 0.0 for column in row.words[2:5] for word in column.split("|")):
                raise row.error("external loads are not supported; they must be 0.")
            findings.unused("0", row.line, "external loads")
    for row in sections.get("control", ()):
        findings.unused(f"channel {row.words[0]}", row.line, "control channels, for which there is no controller")
