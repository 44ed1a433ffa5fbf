"""What points, bodies and rods of a MoorDyn file hang on, by the word in their column `Type` or `Attachment`.

The words are those of MoorDyn's C++ version (MoorDyn2.cpp: ReadInFile, readBody) and of its Fortran version, which knows turbines
too (MoorDyn.f90). A number behind a word that needs none is passed over, as MoorDyn does: `Coupled1`.
"""

import re
from enum import Enum
from typing import NamedTuple

from anet_lumped.checks import nearest

from .moordyn_rows import Row


class Hold(Enum):
    """Who moves something."""

    FIXED = "nobody"
    COUPLED = "the program that calls MoorDyn"
    FREE = "what pulls at it"
    BODY = "a body"
    TURBINE = "a turbine, of a program that calls MoorDyn"


WORDS = {
    Hold.FIXED: ("fixed", "fix", "anchor"),
    Hold.COUPLED: ("coupled", "cpld", "vessel", "ves", "fairlead"),
    Hold.FREE: ("free", "connect", "con", "point", "connection"),
    Hold.BODY: ("body",),
    Hold.TURBINE: ("turbine", "t"),
}
PINNED = ("pinned", "pin", "coupledpinned", "cpldpin", "vesselpinned", "vespin")  # may turn about a place
PARTS = re.compile(r"([a-z]*)(\d{0,18})([a-z]*)")


class Attachment(NamedTuple):
    """What holds something.

    Parameters
    ----------
    hold : Hold, or None of a word that is unknown
    number : of the body or of the turbine, 0 without one
    pinned : whether it may turn
    """

    hold: Hold | None
    number: int
    pinned: bool


def attachment(word: str) -> Attachment:
    """Return what a word says of what holds something."""
    parts = PARTS.fullmatch(word.lower())
    if parts is None:
        return Attachment(None, 0, False)
    letters, digits, more = parts.groups()
    pinned = letters in PINNED or more in PINNED
    if letters in PINNED:
        letters = letters.removesuffix("pinned").removesuffix("pin")
    hold = next((hold for hold, words in WORDS.items() if letters in words), None)
    number = int(digits) if digits else 0
    if more and not (hold is Hold.BODY and more in PINNED):
        hold = None
    if hold in (Hold.BODY, Hold.TURBINE) and not number:
        hold = None
    return Attachment(hold, number, pinned)


def hold_of_point(row: Row) -> Attachment:
    """What holds the point of a row.

    Raises
    ------
    SceneError : the type of no point
    """
    found = attachment(row.words[1])
    if found.hold is None or found.pinned:
        known = [word for words in WORDS.values() for word in words if len(word) > 1]
        hint = nearest(row.words[1].lower(), known) or "."
        raise row.error(f"the type of a point must be Fixed, Coupled, Free or Body and a number{hint}")
    return found
