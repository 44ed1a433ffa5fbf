"""How figures draw a scheme: its label, a colour of its family, a mark of its own, a line; the same in all figures.

Nothing is listed here by a scheme's name: a scheme's place in its family gives its colour, its place among all schemes its mark.
"""

from typing import NamedTuple

from integrators import schemes
from integrators.schemes.record import Family

PALETTES = {  # colours of a family, taken again from the first one where it has more schemes
    Family.SYMPLECTIC: ("0.5", "k"),
    Family.EXPLICIT_RUNGE_KUTTA: ("0.75", "C7", "slateblue", "C6", "C8", "navy"),
    Family.ENERGY_MOMENTUM: ("C0", "deepskyblue"),
    Family.DIAGONALLY_IMPLICIT: ("C2", "C3", "C1", "C4", "darkgoldenrod", "firebrick"),
    Family.COLLOCATION: ("C9",),
    Family.ALPHA: ("C5",),
    Family.MULTISTEP: ("tan", "olive"),
}
MARKS = "><v^8osDpPX1234+xdhH*|_"
EXPLICIT_LINE, IMPLICIT_LINE = "--", "-"


class Style(NamedTuple):
    """Label, colour, mark and line of a scheme, as matplotlib takes them."""

    label: str
    color: str
    marker: str
    line: str

    def of_line(self):
        """Keyword arguments of a line with marks."""
        return {"label": self.label, "color": self.color, "marker": self.marker, "ls": self.line}


def style(name: str) -> Style:
    """The style of a scheme."""
    scheme, known = schemes.scheme(name), schemes.names()
    relatives, palette = schemes.names(family=scheme.family), PALETTES[scheme.family]
    color, marker = palette[relatives.index(name) % len(palette)], MARKS[known.index(name) % len(MARKS)]
    return Style(scheme.label, color, marker, EXPLICIT_LINE if scheme.explicit else IMPLICIT_LINE)
