"""A rigid body, and the points that stand for it: see `body_mass` for its four masses."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from anet_lumped.checks import (
    SceneError,
    Vector,
    as_entries,
    check_name,
    check_number,
    check_pairs,
    check_vector,
    nearest,
    quoted,
    shown,
)
from anet_lumped.prescribed.paths import Path, line
from anet_lumped.prescribed.turning import matrix_of
from anet_lumped.prescribed.turning_path import TurningPath

from .body_mass import NEGLIGIBLE, Mass, check_inertia, four_masses, is_on_a_line, sum_of, tensor
from .carried import Carried, check_carried
from .point import Driven, Free
from .rod import Rod


@dataclass(frozen=True)
class OnBody(Free):
    """A point of a body: its origin, an attachment, one on each of its axes, or one of the masses that stand for it.

    Parameters
    ----------
    body : name of the body
    arm : (3,) tuple of float [m], from the origin of the body, in its axes
    """

    body: str = field(default="", kw_only=True)
    arm: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)


@dataclass(frozen=True)
class OnDrivenBody(Driven):
    """A point of a body whose motion is prescribed; ``body`` and ``arm`` as of `OnBody`."""

    body: str = field(default="", kw_only=True)
    arm: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)


@dataclass(frozen=True)
class Body:
    """A rigid body, to whose attachments cables are tied: a cable ends at "quad1.hook", or at the body's origin, "quad1".

    It moves freely, unless it is `pinned` or its motion is prescribed by `path` and `turning`. Lengths within the body are measured
    from its origin, along its own axes. What acts on a body whose motion is prescribed counts in the force that drives it,
    `Run.reaction`.

    A ball joint holds two bodies together where one is pinned to the other: ``pinned="root", pinned_to="platform.hinge"``.

    Parameters
    ----------
    name : name of the body, unique among bodies and points
    mass : float [kg]; not needed where the motion is prescribed
    inertia : (3,) or (3, 3) array_like [kg m2], principal moments along its axes, or the tensor, about its centre of mass; likewise
    at : (3,) array_like [m], where its origin starts; not needed with a `path`, nor with `pinned_to`, from which it follows
    rotation : (3,) array_like [rad], how its axes start: turned from those of the world about this vector, by its length
    attachments : dict of name to (3,) array_like [m]
    centre_of_mass : (3,) array_like [m]
    pinned : name of an attachment, or "" for the origin, that stays where it is while the body turns about it; None for a free body
    pinned_to : name of the point at which that attachment stays, where it is not a place of the world: "platform.hinge" of another
        body, or a driven or fixed point
    path : prescribed motion of the origin, made by a function of `anet_lumped.paths`
    turning : prescribed rotation [rad], made likewise: at each time the axes are those at the start, turned about this vector
    CdA : (3,) array_like [m2], drag coefficients times areas along its axes; the drag acts at the origin
    CdA_rotation : (3,) array_like [m5], by which turns about its axes are resisted: moments of density/2 CdA_rotation times the
        squares of its own angular velocities
    volume : float [m3], of a body that is small against the waves: under water as a sphere of this volume is
    centre_of_buoyancy : (3,) array_like [m], where buoyancy, and the inertia of the water, act
    Ca : (3,) array_like, added mass along its axes over that of the fluid in its volume
    hull : (3,) array_like [m] or None, edges along its axes of a box about the centre of buoyancy, in place of a `volume`: the
        part of the box under a level surface lifts it at the centre of that part
    contact_area : float [m2], of its attachments together, or of its origin if it has none, on a ground
    rods : sequence of Rod, parts of the body that add their mass, inertia and forces; `mass` may then be left out
    carried : dict of name to Carried, what sits at attachments, or, by the name "", at the origin, with a mass and forces of its
        own; `mass` may then be left out too

    Raises
    ------
    SceneError : a number that cannot be, such as an inertia above the sum of the other two
    """

    name: str
    mass: float | None = field(default=None, kw_only=True)
    inertia: Sequence[Any] | None = field(default=None, kw_only=True)
    at: Vector | None = field(default=None, kw_only=True)
    rotation: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    attachments: Mapping[str, Vector] | Sequence[tuple[str, Vector]] = field(default=(), kw_only=True)
    centre_of_mass: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    pinned: str | None = field(default=None, kw_only=True)
    pinned_to: str | None = field(default=None, kw_only=True)
    path: Path | None = field(default=None, kw_only=True)
    turning: Path | None = field(default=None, kw_only=True)
    CdA: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    CdA_rotation: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    volume: float = field(default=0.0, kw_only=True)
    centre_of_buoyancy: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    Ca: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    hull: Vector | None = field(default=None, kw_only=True)
    contact_area: float = field(default=0.0, kw_only=True)
    rods: Sequence[Rod] = field(default=(), kw_only=True)
    carried: Mapping[str, Carried] | Sequence[tuple[str, Carried]] = field(default=(), kw_only=True)

    def __post_init__(self) -> None:
        check_name(self.name, "body")
        owner = f"body {quoted(self.name)}"
        checked: dict[str, Any] = {}
        for key, unit in (("rotation", "rad"), ("centre_of_mass", "m")):
            checked[key] = check_vector(key, getattr(self, key), unit, owner)
        pairs = check_pairs("attachments", self.attachments, "an attachment's name and its place", owner, may_be_empty=True)
        checked["attachments"] = tuple(
            (check_name(name, "attachment"), check_vector("attachments", at, "m", f"{quoted(name)} of {owner}"))
            for name, at in pairs
        )
        for key in ("path", "turning"):
            if getattr(self, key) is not None and not isinstance(getattr(self, key), Path):
                raise SceneError(
                    f"Argument `{key}` must be made by a function of anet_lumped.paths, as paths.line, but "
                    f"{owner} has {key}={shown(getattr(self, key))}."
                )
        if self.path is not None and self.at is not None:
            raise SceneError(f"Only one of `at` and `path` may be given, but {owner} has both.")
        if self.pinned_to is not None:
            check_name(self.pinned_to, "point that a body is pinned to")
            if self.pinned is None:
                raise SceneError(
                    'Argument `pinned` must be given with `pinned_to`, as an attachment of the body or "" for its origin, but '
                    f"{owner} has pinned_to={shown(self.pinned_to)} alone."
                )
        if self.path is None and (self.pinned_to is None or self.at is not None):
            checked["at"] = check_vector("at", self.at, "m", owner)
        if self.is_driven and self.pinned is not None:
            raise SceneError(f"A body may be pinned or have a prescribed motion, but {owner} has both.")
        checked |= _check_fluid(self, owner)
        names = [name for name, _ in checked["attachments"]]
        checked["carried"] = check_carried(self.carried, names, owner)
        has_parts = any(rod.mass_per_length for rod in checked["rods"]) or any(thing.mass for _, thing in checked["carried"])
        needs_mass = not self.is_driven and not has_parts
        if needs_mass or self.mass is not None:
            checked["mass"] = check_number("mass", self.mass, "kg", owner, sign="positive")
        if needs_mass or self.inertia is not None or (self.mass is not None and not self.is_driven):
            checked["inertia"] = check_inertia(self.inertia, owner)
        if self.pinned is not None and self.pinned not in ("", *names):
            raise SceneError(
                f'Argument `pinned` must name an attachment, or be "" for the origin, but {owner} has pinned={shown(self.pinned)}'
                + (nearest(self.pinned, names) or ".")
            )
        for key, value in checked.items():
            object.__setattr__(self, key, value)
        if self.carried and self.inertia is None and not self.is_driven and is_on_a_line(self.whole):
            raise SceneError(f"Masses on one line have no inertia about it, so that {owner} must have an `inertia` of its own.")

    @property
    def is_driven(self) -> bool:
        """Whether its motion is prescribed."""
        return self.path is not None or self.turning is not None

    @property
    def is_jointed(self) -> bool:
        """Whether it is pinned to a point that may move, by a ball joint."""
        return self.pinned_to is not None

    @property
    def pivot(self) -> str | None:
        """Name of its point about which it turns, None of a free body."""
        return None if self.pinned is None else f"{self.name}.{self.pinned}" if self.pinned else self.name

    def origin_at_joint(self, joint: Vector) -> Vector:
        """Place of its origin [m] where the point about which it turns is at ``joint`` (3,) [m]."""
        arm = dict(self.places).get(self.pinned or "", (0.0, 0.0, 0.0))
        x, y, z = (np.array(joint) - matrix_of(self.rotation) @ arm).tolist()
        return x, y, z

    @property
    def motion(self) -> tuple[Path, Path | None]:
        """Prescribed motion of its origin, and rotation."""
        assert self.is_driven
        if self.path is not None:
            return self.path, self.turning
        assert self.at is not None
        return line(self.at, (0.0, 0.0, 0.0), 0.0), self.turning

    @cached_property
    def points(self) -> tuple[OnBody, ...] | tuple[OnDrivenBody, ...]:
        """Its points: the origin and the attachments.

        A body that is not driven has more: behind its origin one on each of its axes, at its radius of gyration, by which its axes
        are known whatever its inertia, and the four masses; at last its centre of buoyancy, unless that is the origin, and the
        nodes of its rods.
        """
        ends = [(self.name, (0.0, 0.0, 0.0)), *((f"{self.name}.{name}", arm) for name, arm in self.places)]
        if self.is_driven:
            return tuple(
                OnDrivenBody(name, TurningPath.of(*self.motion, self.rotation, arm), body=self.name, arm=arm) for name, arm in ends
            )
        assert self.at is not None
        d, total = self.gyration, self.whole.total
        on_axes = [(f"{self.name}[x]", (d, 0.0, 0.0)), (f"{self.name}[y]", (0.0, d, 0.0)), (f"{self.name}[z]", (0.0, 0.0, d))]
        ends[1:1] = on_axes
        if any(self.centre_of_buoyancy):
            ends.append((f"{self.name}[b]", self.centre_of_buoyancy))
        for rod in self.rods:
            ends += [(f"{self.name}[{rod.name}.{k}]", arm) for k, arm in enumerate(rod.nodes)]
        masses = four_masses(self.whole, [arm for _, arm in ends])
        named = [(*end, NEGLIGIBLE * total) for end in ends]
        named[4:4] = [(f"{self.name}[{k}]", arm, m) for k, (arm, m) in enumerate(masses, start=1)]
        R, origin = matrix_of(self.rotation), np.array(self.at)
        points = [OnBody(name, m, at=tuple((origin + R @ arm).tolist()), body=self.name, arm=arm) for name, arm, m in named]
        carried = {f"{self.name}.{name}" if name else self.name: thing for name, thing in dict(self.carried).items()}
        for k, point in enumerate(points if carried else ()):
            if (thing := carried.get(point.name)) is not None:
                points[k] = replace(point, CdA=thing.CdA, volume=thing.volume, Ca=thing.Ca)
        return tuple(points)

    @property
    def loaded_points(self) -> tuple[Free, ...]:
        """Those of its points that carry what air or water acts on; none of a body whose motion is prescribed."""
        if self.is_driven or not self.carried:
            return ()
        return tuple(point for point in self.points if isinstance(point, Free) and (point.volume > 0.0 or point.CdA > 0.0))

    @property
    def places(self) -> tuple[tuple[str, Vector], ...]:
        """Name and place of each attachment [m], from the origin, in its own axes."""
        return tuple(self.attachments)  # type: ignore[arg-type]  # pairs, once they are checked

    @cached_property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Which of its points, by their number, a force on one may depend on the other: its first four; neighbours on a rod."""
        if self.is_driven:
            return ()
        pairs = list(combinations(range(4), 2)) if self.has_drag or self.hull is not None else []
        first = len(self.points) - sum(rod.segments + 1 for rod in self.rods)
        for rod in self.rods:
            pairs += pairwise(range(first, first + rod.segments + 1))
            first += rod.segments + 1
        return tuple(pairs)

    @property
    def has_drag(self) -> bool:
        """Whether its motion or its rotation is resisted by a fluid, but for its rods."""
        return any((*self.CdA, *self.CdA_rotation))

    @property
    def displaced(self) -> float:
        """Volume of the hull, or `volume` [m3]."""
        return self.volume if self.hull is None else float(np.prod(self.hull))

    @cached_property
    def whole(self) -> Mass:
        """`Mass` of the body with its rods and what it carries."""
        own = [Mass(self.mass or 0.0, np.array(self.centre_of_mass, float), tensor(self.inertia))] if self.inertia else []
        arms, carried = {"": (0.0, 0.0, 0.0)} | dict(self.places), dict(self.carried)
        parts = [thing.mass_at(arms[name]) for name, thing in carried.items() if thing.mass > 0.0]
        return sum_of([*own, *(rod.mass for rod in self.rods if rod.mass_per_length > 0.0), *parts])

    @property
    def inertia_tensor(self) -> np.ndarray:
        """(3, 3) inertia of all of the body about their centre of mass [kg m2], in its own axes."""
        return self.whole.inertia

    @property
    def gyration(self) -> float:
        """Radius of gyration about the centre of mass [m]."""
        return self.whole.gyration

    @cached_property
    def radius(self) -> float:
        """Largest distance of an attachment from the centre of mass, or the radius of gyration if that is larger [m]."""
        distances = [float(np.linalg.norm(np.subtract(arm, self.whole.centre))) for _, arm in self.places]
        return max([self.gyration, *distances])

    @cached_property
    def least_masses(self) -> dict[str, float]:
        """Mass [kg] with which it resists a force on each of its points in the direction in which it resists least.

        1/m is the largest eigenvalue of I/m - [a] J^-1 [a], with the place a of the point from the centre of mass.
        """
        found, whole = {}, self.whole
        J = np.linalg.inv(whole.inertia)
        for point in self.points:
            x, y, z = np.subtract(point.arm, whole.centre)
            across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            found[point.name] = 1.0 / float(np.linalg.eigvalsh(np.eye(3) / whole.total - across @ J @ across)[-1])
        return found


def _check_fluid(body: Body, owner: str) -> dict[str, Any]:
    """What air, water and ground act on, checked."""
    checked: dict[str, Any] = {"centre_of_buoyancy": check_vector("centre_of_buoyancy", body.centre_of_buoyancy, "m", owner)}
    for key, unit in (("CdA", "m2"), ("CdA_rotation", "m5"), ("Ca", "")):
        checked[key] = check_vector(key, getattr(body, key), unit, owner)
        if min(checked[key]) < 0.0:
            raise SceneError(f"Argument `{key}` must not be negative along any axis, but {owner} has {key}={checked[key]}.")
    for key, unit in (("volume", "m3"), ("contact_area", "m2")):
        checked[key] = check_number(key, getattr(body, key), unit, owner, sign="non-negative")
    if body.hull is not None:
        checked["hull"] = check_vector("hull", body.hull, "m", owner)
        if min(checked["hull"]) <= 0.0:
            raise SceneError(f"Edges of a `hull` must be positive [m], but {owner} has hull={checked['hull']}.")
        if checked["volume"] > 0.0:
            raise SceneError(f"Only one of `volume` and `hull` may be given, but {owner} has both.")
    rods = None if isinstance(body.rods, Mapping) else as_entries(body.rods)
    if rods is None or not all(isinstance(rod, Rod) for rod in rods):
        raise SceneError(f"Argument `rods` must be a sequence of Rod, but {owner} has rods={shown(body.rods)}.")
    names = [rod.name for rod in rods]
    if len(set(names)) < len(names):
        raise SceneError(f"Names of rods must be unique in their body, but {owner} has {', '.join(map(quoted, names))}.")
    return checked | {"rods": rods}
