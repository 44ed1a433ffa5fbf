"""How figures draw a scheme: its label, a colour of its family, a mark of its own, a line; the same in all figures.

Nothing is listed here by a scheme's name: a scheme's number in its family gives its colour, its number among all schemes its mark.
Readers who see no colours tell schemes by their marks.
"""

from typing import NamedTuple

from anet_lumped.views.palette import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from integrators import schemes
from integrators.schemes.record import Family

PALETTES = {  # colours of a family, of one hue; taken again from the first one where the family has more schemes
    Family.SYMPLECTIC: (GREY, BLACK),
    Family.EXPLICIT_RUNGE_KUTTA: (PURPLE, "#882255", "#AA4499", "#661100", "#DDA0C8", "#5A2A6E"),
    Family.ENERGY_MOMENTUM: (BLUE, SKY),
    Family.DIAGONALLY_IMPLICIT: (ORANGE, VERMILION, "#994F00", "#DDAA33", "#5D3A00", "#BB5566"),
    Family.COLLOCATION: ("#117733",),
    Family.ALPHA: (GREEN,),
    Family.MULTISTEP: ("#999933", "#666600"),
    Family.CONSTRAINED: ("#CC3311", "#EE7733"),
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
    scheme, known = schemes.scheme(name), list(schemes.MODULES)
    relatives, palette = [other for other in known if schemes.scheme(other).family is scheme.family], PALETTES[scheme.family]
    color, marker = palette[relatives.index(name) % len(palette)], MARKS[known.index(name) % len(MARKS)]
    return Style(scheme.label, color, marker, EXPLICIT_LINE if scheme.explicit else IMPLICIT_LINE)
