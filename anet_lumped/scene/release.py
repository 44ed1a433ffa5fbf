"""Cables that are held together at a point until it lets go of them: shackles, weak links, fairleads that fail.

Cables that part from a point together end at a free point of their own, which is held at the other one: as long as it is, both are
one node. Let go, it moves by itself from where it was, with the velocity that it had, and what ends there stays joined. So MoorDyn
detaches lines from a point (its sources, MoorDyn::detachLines).
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

from anet_lumped.checks import SceneError, check_name, check_number, quoted

from .body import OnBody
from .point import Free


@dataclass(frozen=True)
class Release:
    """A free point is held at another point, until a time or until a cable that ends there pulls too hard.

    Parameters
    ----------
    point : name of the free point, where the cables end that part from the other one together
    holder : name of the point that holds it: fixed, driven, free or of a body
    t : float [s] or None, when it is let go at the latest, as in ``Run.t``; None for never
    tension : float [N] or None
        At which the segment of a cable that ends at the point makes it part; None for never.
    """

    point: str
    holder: str
    t: float | None = None
    tension: float | None = None

    def __post_init__(self) -> None:
        check_name(self.point, "point")
        check_name(self.holder, "point")
        owner = f"the release of point {quoted(self.point)}"
        if self.t is None and self.tension is None:
            raise SceneError(f"A release must have a time `t` or a `tension`, but {owner} has neither.")
        if self.t is not None:
            object.__setattr__(self, "t", check_number("t", self.t, "s", owner, sign="non-negative"))
        if self.tension is not None:
            object.__setattr__(self, "tension", check_number("tension", self.tension, "N", owner, sign="positive"))


def check_releases(scene: Any) -> None:
    """Refuse releases of what cannot be held.

    Raises
    ------
    SceneError : names the point
    """
    holders: dict[str, str] = {}
    for event in scene.releases:
        name, point, holder = quoted(event.point), scene.point(event.point), scene.point(event.holder)
        if not isinstance(point, Free) or isinstance(point, OnBody):
            raise SceneError(f"A point that is held must be free, but {name} of a release is not.")
        if event.point in holders:
            raise SceneError(f"A point may be held by one other, but {name} is by two.")
        holders[event.point] = event.holder
        if isinstance(holder, OnBody) and (point.mass or point.volume or point.CdA):
            raise SceneError(f"A point that a body holds must carry nothing, but {name} does.")
        if any(change.point == event.point for change in scene.payload_changes):
            raise SceneError(f"A payload must be at a point that is not held, but one is to change at {name}.")
    for name, held_by in holders.items():
        if held_by in holders:
            raise SceneError(f"A point must be held by one that is not held itself, but {quoted(name)} is by {quoted(held_by)}.")
        keeps = any(held_by in (cable.start, cable.end) for cable in scene.cables)
        at = scene.point(held_by)
        if isinstance(at, Free) and not isinstance(at, OnBody) and not (keeps or at.mass):
            raise SceneError(f"A free point that lets go of all its cables must have a mass, but {quoted(held_by)} has none.")
    for cable in scene.cables:
        if holders.get(cable.start, cable.start) == holders.get(cable.end, cable.end):
            raise SceneError(f"A cable must join two points, but both ends of {quoted(cable.name)} are held at one.")


def together(points: list, cables: list, held: dict[str, str]) -> tuple[list, list]:
    """Points and cables where points are held at others, and are no points of their own.

    Parameters
    ----------
    points : list of Point
    cables : list of Cable
    held : dict of the name of each point that is held to that of its holder

    Returns
    -------
    points : list of Point, those that hold with what is carried by those that they hold
    cables : list of Cable, which end at them
    """
    if not held:
        return points, cables
    by_name = {point.name: point for point in points}
    carried: dict[str, list[Any]] = {}
    for name, holder in held.items():
        carried.setdefault(holder, []).append(by_name[name])
    points = [_with(point, carried.get(point.name, ())) for point in points if point.name not in held]
    cables = [
        replace(one, start=held.get(one.start, one.start), end=held.get(one.end, one.end))
        if one.start in held or one.end in held
        else one
        for one in cables
    ]
    return points, cables


def _with(point: Any, others: Collection[Any]) -> Any:
    """A free point that carries what others carry besides; another point as it is."""
    if not isinstance(point, Free) or not any(other.mass or other.volume or other.CdA for other in others):
        return point
    all_of_them = (point, *others)
    volume = sum(one.volume for one in all_of_them)
    moved = sum(one.Ca * one.volume for one in all_of_them)
    return replace(
        point,
        mass=sum(one.mass for one in all_of_them), CdA=sum(one.CdA for one in all_of_them), volume=volume,
        Ca=moved / volume if volume else point.Ca,
    )  # fmt: skip
