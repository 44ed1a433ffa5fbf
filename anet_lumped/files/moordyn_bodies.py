"""Bodies of a MoorDyn file that others move, or nobody: places and orientations of the points that they carry.

Such a body is a frame: its mass, its inertia and its drag are the business of who moves it. It is turned as a platform is, see
`six_motions`. Bodies that move freely are refused where a point or a rod is on them.
"""

import math
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import Vector
from anet_lumped.prescribed.six_motions import carried

from .moordyn_attachments import Hold, attachment
from .moordyn_findings import Findings
from .moordyn_rows import Row

COLUMNS = 14  # ID, Attachment, X0, Y0, Z0, r0, p0, y0, Mass, CG, I, Volume, CdA, Ca


class Frame(NamedTuple):
    """A body that does not move by itself.

    Parameters
    ----------
    hold : Hold.FIXED or Hold.COUPLED
    six : its place [m] and its three angles [rad]
    """

    hold: Hold
    six: tuple[float, ...]

    def place_of(self, point: Vector) -> Vector:
        """Place (3,) [m] of a point that is given in the axes of the body."""
        values = np.zeros((1, 3, 6))
        values[0, 0] = self.six
        x, y, z = carried(values, point)[0, 0].tolist()
        return x, y, z


def read_bodies(rows: list[Row], used: set[int], findings: Findings) -> dict[int, Frame | None]:
    """Frame of each body, None of one that is refused or that nothing is on, by number.

    Parameters
    ----------
    rows : list of Row
    used : set of int
        Numbers of the bodies that points or rods are on.
    findings : Findings
    """
    bodies: dict[int, Frame | None] = {}
    for row in rows:
        with findings.refusing():
            number = row.count(0, "the number of a body")
            if number in bodies:
                raise row.error(f"a body must come once, but {number} comes again.")
            bodies[number] = None
            if number in used:
                bodies[number] = _frame(row)
            else:
                findings.unused(f"body {number}", row.line, "bodies that hold no line")
    return bodies


def _frame(row: Row) -> Frame:
    if len(row.words) < COLUMNS:
        raise row.error(
            f"a body must have {COLUMNS} columns (ID, Attachment, X0, Y0, Z0, r0, p0, y0, Mass, CG, I, Volume, CdA, Ca), but has "
            f"{len(row.words)}."
        )
    found = attachment(row.words[1])
    hold = Hold.COUPLED if found.hold is Hold.TURBINE else found.hold
    if hold not in (Hold.FIXED, Hold.COUPLED) or found.pinned:
        raise row.error("a body that moves by itself is not supported; it must be Fixed or Coupled.")
    place = [row.number(2 + x, name) for x, name in enumerate(("X0", "Y0", "Z0"))]
    angles = [math.radians(row.number(5 + x, name)) for x, name in enumerate(("r0", "p0", "y0"))]
    return Frame(hold, (*place, *angles))
