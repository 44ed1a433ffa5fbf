"""Bodies of a MoorDyn file: those that others move, or nobody, and those that move by themselves.

A body that is fixed or coupled is a frame: its mass, its inertia and its drag are the business of who moves it. A body that is
free, or pinned, is a `Body` with the points and the rods on it. "CoupledPinned" is pinned at its origin to a driven point,
"body1.pin". All are turned as a platform is, see `six_motions`.

MoorDyn's body has its weight and its buoyancy at its centre of gravity, its drag and its added mass at its origin (Body.cpp).
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import Vector, quoted
from anet_lumped.prescribed.six_motions import carried
from anet_lumped.scene.body import Body
from anet_lumped.scene.carried import Carried
from anet_lumped.scene.rod import Rod

from .moordyn_attachments import Hold, attachment
from .moordyn_findings import Findings
from .moordyn_rows import Row, made, number_of

LIGHT = 1e-6  # [kg] of a body without a mass; over the mass times the square of its reach, the inertia of one without I
COLUMNS = 14  # ID, Attachment, X0, Y0, Z0, r0, p0, y0, Mass, CG, I, Volume, CdA, Ca


class Frame(NamedTuple):
    """A body: where it starts, and what moves it.

    Parameters
    ----------
    hold : Hold.FIXED, Hold.COUPLED, or Hold.FREE of one that moves by itself
    six : its place [m] and its three angles [rad]
    name : of the body in the scene
    pinned : whether it turns about its origin, whose place is prescribed
    coupled : whether others move that origin, or the body
    row : where it stands
    """

    hold: Hold
    six: tuple[float, ...]
    name: str
    pinned: bool
    coupled: bool
    row: Row

    @property
    def pin(self) -> str | None:
        """Name of the driven point to which it is pinned, None without one."""
        return f"{self.name}.pin" if self.pinned and self.coupled else None

    def place_of(self, point: Vector) -> Vector:
        """Place (3,) [m] of a point that is given in the axes of the body."""
        values = np.zeros((1, 3, 6))
        values[0, 0] = self.six
        x, y, z = carried(values, point)[0, 0].tolist()
        return x, y, z

    @property
    def rotation(self) -> Vector:
        """Rotation vector (3,) [rad] of its axes, R = Rx Ry Rz."""
        from scipy.spatial.transform import Rotation

        x, y, z = Rotation.from_euler("XYZ", self.six[3:]).as_rotvec().tolist()
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
                bodies[number] = _frame(number, row)
            else:
                findings.unused(f"body {number}", row.line, "bodies that hold no line")
    return bodies


def _frame(number: int, row: Row) -> Frame:
    if len(row.words) < COLUMNS:
        raise row.error(
            f"a body must have {COLUMNS} columns (ID, Attachment, X0, Y0, Z0, r0, p0, y0, Mass, CG, I, Volume, CdA, Ca), but has "
            f"{len(row.words)}."
        )
    found = attachment(row.words[1])
    hold = Hold.COUPLED if found.hold is Hold.TURBINE else found.hold
    pinned = found.pinned and (hold is Hold.COUPLED or row.words[1].lower() in ("pinned", "pin"))
    if hold not in (Hold.FIXED, Hold.COUPLED, Hold.FREE) and not pinned:
        raise row.error("a body must be Fixed, Coupled, CoupledPinned, Pinned or Free.")
    place = [row.number(2 + x, name) for x, name in enumerate(("X0", "Y0", "Z0"))]
    angles = [math.radians(row.number(5 + x, name)) for x, name in enumerate(("r0", "p0", "y0"))]
    assert hold is not None or pinned
    name = row.name or f"body{number}"
    return Frame(Hold.FREE if pinned or hold is None else hold, (*place, *angles), name, pinned, hold is Hold.COUPLED, row)


def moving_body(
    frame: Frame, attachments: list[tuple[str, Vector]], rods: list[Rod], carried: Mapping[str, dict[str, float]]
) -> Body:
    """The body of a frame that moves by itself.

    Parameters
    ----------
    frame : Frame
    attachments : list of name and (3,) place in its axes [m]
    rods : list of Rod
    carried : dict of name of an attachment to the fields of a `Carried`
    """
    row, name = frame.row, quoted(frame.name)
    mass, volume = row.number(8, "Mass"), row.number(11, "Volume")
    centre = _numbers(row, 9, "CG", (1, 3))
    centre = [0.0, 0.0, *centre] if len(centre) == 1 else centre
    inertia = _numbers(row, 10, "I", (1, 3))
    areas, Ca = _numbers(row, 12, "CdA", (1, 2, 3, 6)), _numbers(row, 13, "Ca", (1, 3))
    half = max(1, len(areas) // 2)
    along, turning = (areas[:half], areas[half:]) if len(areas) in (2, 6) else (areas, areas)  # one or three count for both
    if volume and any(Ca) and any(centre):
        row.findings.remark(
            f"Added mass of body {name} acts at its centre of gravity, as its buoyancy does; MoorDyn has it at the origin."
        )
    if frame.pinned:
        row.findings.remark(
            f"Body {name} turns about its origin, which is pinned to {quoted(frame.pin)}."
            if frame.pin
            else f"The origin of body {name} stays where it is, while the body turns about it; MoorDyn's C++ version lets it fall."
        )
    given: dict[str, Any] = {}
    has_parts = any(rod.mass_per_length for rod in rods) or any(fields["mass"] for fields in carried.values())
    if mass or not has_parts:
        given["mass"] = mass or LIGHT
    if any(inertia):
        given["inertia"] = _three(inertia)
    elif mass or not has_parts:
        given |= _light(row, name, mass, [np.subtract(place, centre) for _, place in attachments])
    return made(
        row, Body, frame.name, at=frame.six[:3], rotation=frame.rotation, attachments=attachments, rods=rods,
        carried={of: made(row, Carried, **fields) for of, fields in carried.items()},
        centre_of_mass=centre, centre_of_buoyancy=centre if volume else (0.0, 0.0, 0.0), volume=volume,
        CdA=_three(along), CdA_rotation=_three(turning), Ca=_three(Ca),
        pinned="" if frame.pinned else None, pinned_to=frame.pin, **given,
    )  # fmt: skip


def _light(row: Row, name: str, mass: float, arms: list[np.ndarray]) -> dict[str, Any]:
    """Inertia, and mass where there is none, of a body without: so little that what hangs on it counts alone."""
    reach = max((float(np.linalg.norm(arm)) for arm in arms), default=0.0) or 1.0
    mass_too = "" if mass else f" and a mass of {LIGHT:g} kg"
    moment = LIGHT * (mass or 1.0) * reach**2
    row.findings.remark(
        f"Line {row.line}: body {name} has no inertia I; it is given {moment:.3g} kg m2{mass_too}, and turns with what hangs on it."
    )
    return {"mass": mass or LIGHT, "inertia": (moment,) * 3}


def _three(numbers: list[float]) -> list[float]:
    """One number for each axis."""
    return numbers * 3 if len(numbers) == 1 else numbers


def _numbers(row: Row, column: int, what: str, counts: tuple[int, ...]) -> list[float]:
    """Numbers in a column, with | between them."""
    numbers = [number_of(word) for word in row.words[column].split("|")]
    if len(numbers) not in counts or not all(map(math.isfinite, numbers)):
        known = " or ".join(map(str, counts))
        raise row.error(f"{what} of a body must be {known} finite numbers with | between them.")
    return numbers
