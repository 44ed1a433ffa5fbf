"""Bodies of a scene → rows of MoorDyn's input file.

A body that moves freely is `Free`, one that is pinned at its origin `CoupledPinned`, whose origin the calling program holds, and
one whose motion is prescribed `Coupled`. Its attachments are points of type `Body1`, called as in the body; one called "" is its
origin. Its rods are rods on it. Refused is what MoorDyn's body does not have: a hull, contact with the bottom, moments of inertia
that are not along its axes, buoyancy elsewhere than at the centre of mass, and a pin elsewhere than at the origin.

One `CdA` and one `CdA_rotation` are written as `2|0`. Of three or six numbers MoorDyn 2.7.2 passes over the first.
"""

from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, quoted
from anet_lumped.prescribed.turning import turned_by
from anet_lumped.scene.body import Body
from anet_lumped.scene.body_mass import tensor
from anet_lumped.scene.rod import Rod
from anet_lumped.scene.scene import Scene

from .moordyn_rows import named


def body_points(scene: Scene) -> dict[str, str]:
    """Columns of a point but for its number, for each attachment, and for each origin at which a cable ends, by name."""
    ends = {end for cable in scene.cables for end in (cable.start, cable.end)}
    found = {}
    for i, body in enumerate(scene.bodies, start=1):
        if body.name in ends:
            found[body.name] = f"Body{i} 0.0 0.0 0.0 0 0 0 0{named('')}"
        for name, (x, y, z) in body.places:
            found[f"{body.name}.{name}"] = f"Body{i} {x!r} {y!r} {z!r} 0 0 0 0{named(name)}"
    return found


def body_rows(scene: Scene) -> list[str]:
    """Lines of the sections BODIES, ROD TYPES and RODS; none without bodies."""
    if not scene.bodies:
        return []
    rods = [(i, rod, _rod_type(rod, body)) for i, body in enumerate(scene.bodies, start=1) for rod in body.rods]
    types = {row: f"rod{number}" for number, row in enumerate(dict.fromkeys(row for _, _, row in rods), start=1)}
    of_rods = [
        "--------------------- ROD TYPES ---------------------",
        "TypeName Diam Mass/m Cd Ca CdEnd CaEnd",
        "(name) (m) (kg/m) (-) (-) (-) (-)",
        *(f"{name} {row}" for row, name in types.items()),
        "--------------------- RODS ---------------------",
        "ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs RodOutputs",
        "(#) (name) (#/key) (m) (m) (m) (m) (m) (m) (-) (-)",
        *(
            f"{number} {types[row]} Body{i} {' '.join(map(repr, (*rod.start, *rod.end)))} {rod.segments} -{named(rod.name)}"
            for number, (i, rod, row) in enumerate(rods, start=1)
        ),
    ]
    return [
        *(of_rods if rods else ()),
        "--------------------- BODIES ---------------------",
        "ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca",
        "(#) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)",
        *(f"{i} {_body(body)}{named(body.name)}" for i, body in enumerate(scene.bodies, start=1)),
    ]


def _body(body: Body) -> str:
    """Columns of a body, but for its number."""
    from scipy.spatial.transform import Rotation

    at, rotation, kind = body.at, body.rotation, "Free" if body.pinned is None else "CoupledPinned"
    if body.is_driven:
        path, turning = body.motion
        at, kind = tuple(path.at(0.0)[0].tolist()), "Coupled"
        rotation = rotation if turning is None else turned_by(turning.at(0.0)[0], rotation)
    else:
        _check(body)
    angles = Rotation.from_rotvec(rotation).as_euler("XYZ", degrees=True).tolist()
    columns: list[Any] = [kind, *(repr(float(x)) for x in (*at, *angles))]  # type: ignore[misc]  # a body has a place or a path
    if body.is_driven:
        return " ".join([*columns, "0 0 0 0 0 0"])
    moments = np.zeros(3) if body.inertia is None else np.diag(tensor(body.inertia))
    columns += [repr(body.mass or 0.0), _joined(body.centre_of_mass), _joined(moments), repr(body.volume)]
    along, about = body.CdA, body.CdA_rotation
    areas = (along[0], about[0]) if len(set(along)) == len(set(about)) == 1 else (*along, *about)
    return " ".join([*columns, _joined(areas), _joined(body.Ca)])


def _rod_type(rod: Rod, body: Body) -> str:
    """Columns of the type of a rod, but for its name."""
    if rod.Cdt or rod.Cat:
        raise SceneError(
            f"A rod must have Cdt=0 and Cat=0 to be written for MoorDyn, but {quoted(rod.name)} of body {quoted(body.name)} has "
            f"Cdt={rod.Cdt} and Cat={rod.Cat}."
        )
    return " ".join(map(repr, (rod.diameter, rod.mass_per_length, rod.Cdn, rod.Can, rod.Cd_end, rod.Ca_end)))


def _joined(numbers: Any) -> str:
    return "|".join(repr(float(x)) for x in numbers)


def _check(body: Body) -> None:
    """Refuse a body that moves otherwise than a body of MoorDyn."""
    arm: Vector = dict(body.places).get(body.pinned or "", (0.0, 0.0, 0.0))
    inertia = np.zeros((3, 3)) if body.inertia is None else tensor(body.inertia)
    is_diagonal = np.array_equal(inertia, np.diag(np.diag(inertia)))
    reasons = (
        ("be pinned at its origin", any(arm), f"is pinned at {quoted(body.pinned or '')}, {arm} m"),
        ("have no `hull`", body.hull is not None, f"has hull={body.hull}"),
        ("have no `contact_area`", body.contact_area > 0.0, f"has contact_area={body.contact_area}"),
        (
            "have moments of inertia along its axes",
            not is_diagonal,
            f"has inertia={body.inertia}",
        ),
        (
            "have its centre of buoyancy at its centre of mass",
            body.volume > 0.0 and body.centre_of_buoyancy != body.centre_of_mass,
            f"has centre_of_buoyancy={body.centre_of_buoyancy} and centre_of_mass={body.centre_of_mass}",
        ),
    )
    for must, breaks, given in reasons:
        if breaks:
            raise SceneError(f"A body must {must} to be written for MoorDyn, but body {quoted(body.name)} {given}.")
