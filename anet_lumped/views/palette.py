"""Colours that colour-blind readers tell apart (Okabe and Ito), and for each series of a figure its own colour, dashes and mark.

Source: M. Okabe, K. Ito, Color universal design, 2008.
"""

BLUE, SKY, GREEN, ORANGE = "#0072B2", "#56B4E9", "#009E73", "#E69F00"
VERMILION, PURPLE, BLACK, GREY = "#D55E00", "#CC79A7", "#000000", "#999999"
COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK, GREY)
DASHES = ("-", "--", "-.", ":")
MARKS = "osD^vP*X<>ph"


def look(number: int) -> dict:
    """Colour, dashes and mark of a series by its number: no two of the first twelve have the same mark, of the first eight the
    same colour."""
    return {
        "color": COLOURS[number % len(COLOURS)],
        "linestyle": DASHES[number % len(DASHES)],
        "marker": MARKS[number % len(MARKS)],
    }


def width(number: int, count: int) -> float:
    """Width of a curve by its number: the first of several are wide, so that they show beneath others that lie on them."""
    return 3.2 - 2.4 * number / (count - 1) if count > 1 else 1.4
