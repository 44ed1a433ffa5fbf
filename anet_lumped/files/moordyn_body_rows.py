"""Bodies of a scene → rows of MoorDyn's input file.

A body that moves freely is `Free`, one that is pinned at its origin `CoupledPinned`, whose origin the calling program holds or
moves, and one whose motion is prescribed `Coupled`. A driven point is not written where all that it holds is such a body. The
attachments of a body are points of type `Body1`, called as in the body; one called "" is its origin. Its rods are rods on it. A rod
that is pinned to another body is a rod of type `Body1Pinned`. Refused is what MoorDyn's body does not have: a hull, contact with
the bottom, moments of inertia that are not along its axes, buoyancy elsewhere than at the centre of mass, and a pin elsewhere than
at the origin.

One `CdA` and one `CdA_rotation` are written as `2|0`. Of three or six numbers MoorDyn 2.7.2 passes over the first.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, quoted
from anet_lumped.prescribed.turning import matrix_of, turned_by
from anet_lumped.scene.body import Body
from anet_lumped.scene.body_mass import tensor
from anet_lumped.scene.rod import Rod
from anet_lumped.scene.scene import Driven, Scene

from .moordyn_rows import named


def body_points(scene: Scene) -> dict[str, str]:
    """Columns of a point but for its number, for each attachment, and for each origin at which a cable ends, by name."""
    ends = {end for cable in scene.cables for end in (cable.start, cable.end)}
    found = {}
    for i, body in enumerate(_written(scene), start=1):
        if body.name in ends or "" in dict(body.carried):
            found[body.name] = f"Body{i} 0.0 0.0 0.0 {_carried(body, '')}{named('')}"
        for name, (x, y, z) in body.places:
            found[f"{body.name}.{name}"] = f"Body{i} {x!r} {y!r} {z!r} {_carried(body, name)}{named(name)}"
    return found


def _carried(body: Body, name: str) -> str:
    """Columns M, V, CdA and CA of a point of a body."""
    thing = dict(body.carried).get(name)
    return "0 0 0 0" if thing is None else f"{thing.mass!r} {thing.volume!r} {thing.CdA!r} {thing.Ca!r}"


def rod_ends(scene: Scene) -> dict[str, str]:
    """What a line calls the ends of rods that are pinned to bodies, "R2B", by the names of their points."""
    first = sum(len(body.rods) for body in _written(scene)) + 1
    ends = (f"{body.name}.{end}" for body in _pinned_rods(scene) for end in "ab")
    return {name: f"R{first + k // 2}{'AB'[k % 2]}" for k, name in enumerate(ends)}


def pins(scene: Scene) -> set[str]:
    """Names of the driven points at which bodies of the file turn and no cable ends."""
    return {body.pinned_to for body in _written(scene) if body.pinned_to} - {
        end for cable in scene.cables for end in (cable.start, cable.end)
    }


def _written(scene: Scene) -> list[Body]:
    """The bodies that are bodies of the file."""
    driven = {point.name for point in scene.points if isinstance(point, Driven)}
    return [body for body in scene.bodies if not body.is_jointed or body.pinned_to in driven]


def numbers_of_bodies(scene: Scene) -> dict[str, int]:
    """Numbers in the file of the bodies, by their names."""
    return {body.name: i for i, body in enumerate(_written(scene), start=1)}


def _pinned_rods(scene: Scene) -> list[Body]:
    """The bodies that are rods of the file, pinned to bodies."""
    written = _written(scene)
    return [body for body in scene.bodies if body not in written]


def body_rows(scene: Scene) -> list[str]:
    """Lines of the sections BODIES, ROD TYPES and RODS; none without bodies."""
    if not scene.bodies:
        return []
    bodies = _written(scene)
    rods = [
        (f"Body{i}", (*rod.start, *rod.end), rod, _rod_type(rod, body))
        for i, body in enumerate(bodies, start=1) for rod in body.rods
    ]  # fmt: skip
    rods += [_pinned_rod(scene, body, bodies) for body in _pinned_rods(scene)]
    types = {row: f"rod{number}" for number, row in enumerate(dict.fromkeys(row for *_, row in rods), start=1)}
    of_rods = [
        "--------------------- ROD TYPES ---------------------",
        "TypeName Diam Mass/m Cd Ca CdEnd CaEnd",
        "(name) (m) (kg/m) (-) (-) (-) (-)",
        *(f"{name} {row}" for row, name in types.items()),
        "--------------------- RODS ---------------------",
        "ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs RodOutputs",
        "(#) (name) (#/key) (m) (m) (m) (m) (m) (m) (-) (-)",
        *(
            f"{number} {types[row]} {hold} {' '.join(map(repr, ends))} {rod.segments} -{named(rod.name)}"
            for number, (hold, ends, rod, row) in enumerate(rods, start=1)
        ),
    ]
    return [
        *(of_rods if rods else ()),
        "--------------------- BODIES ---------------------",
        "ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca",
        "(#) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)",
        *(f"{i} {_body(body)}{named(body.name)}" for i, body in enumerate(bodies, start=1)),
    ]


def _pinned_rod(scene: Scene, body: Body, bodies: list[Body]) -> tuple[str, tuple[float, ...], Rod, str]:
    """What holds a rod that is pinned to a body, its ends in the axes of that body, the rod with the name of its body, its type."""
    other = next((one for one in bodies if body.pinned_to in {point.name for point in one.points}), None)
    rod = body.rods[0] if len(body.rods) == 1 else None
    is_plain = (
        rod is not None
        and body.mass is None
        and not body.carried
        and not any(body.CdA)
        and not body.displaced
        and not body.contact_area
    )
    if other is None or rod is None or not is_plain or {("a", rod.start), ("b", rod.end)} != set(body.places) or body.pinned != "a":
        raise SceneError(
            'What is pinned to another point must be one rod, as `rod_body` makes it, pinned at its end "a" to a body that is '
            f"pinned to none, to be written for MoorDyn, but body {quoted(body.name)} is otherwise."
        )
    place = np.array(next(point.arm for point in other.points if point.name == body.pinned_to))
    along = _axes(other).T @ _axes(body) @ np.subtract(rod.end, rod.start)
    ends = (*place.tolist(), *(place + along).tolist())
    return f"Body{bodies.index(other) + 1}Pinned", ends, replace(rod, name=body.name), _rod_type(rod, body)


def _axes(body: Body) -> np.ndarray:
    """Rotation matrix (3, 3) with which a body starts."""
    turning = body.motion[1] if body.is_driven else None
    return matrix_of(body.rotation if turning is None else turned_by(turning.at(0.0)[0], body.rotation))


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
