"""Bodies that are pinned to other bodies, or to points: where they start, and which of them comes first."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, nearest, quoted

from .body import Body
from .point import Driven, Fixed, Point

OPEN = 1e-9  # of the largest coordinate, or of a metre: two places that are nearer are the same


def parents_first(bodies: Sequence[Body]) -> list[Body]:
    """The bodies, each behind the body to which it is pinned.

    Raises
    ------
    SceneError : bodies that are pinned to one another in a circle
    """
    owner = {name: body for body in bodies for name in _names(body)}
    found: list[Body] = []
    for body in bodies:
        chain: list[Body] = []
        link: Body | None = body
        while link is not None and link not in found:
            if any(link is other for other in chain):
                circle = ", ".join(quoted(other.name) for other in chain)
                raise SceneError(f"Bodies must not be pinned to one another in a circle, but {circle} are.")
            chain.append(link)
            link = None if link.pinned_to is None else owner.get(link.pinned_to)
        found += reversed(chain)
    return found


def placed(bodies: Sequence[Body], points: Sequence[Point]) -> tuple[Body, ...]:
    """The bodies, those that are pinned to a point where that makes them start.

    Raises
    ------
    SceneError : a body that is pinned to no fixed or driven point and to no other body, or that is said to start elsewhere
    """
    if not any(body.is_jointed for body in bodies):
        return tuple(bodies)
    places: dict[str, Any] = {point.name: point.at for point in points if isinstance(point, Fixed)}
    places |= {point.name: point.path.at(0.0)[0] for point in points if isinstance(point, Driven)}
    known = {*places, *(name for body in bodies for name in _names(body))}
    found: dict[str, Body] = {}
    for body in parents_first(bodies):
        if body.pinned_to is not None:
            own = _names(body)
            if body.pinned_to not in known or body.pinned_to in own:
                raise SceneError(
                    "Argument `pinned_to` must name a fixed or driven point, or the origin or an attachment of another body, but "
                    f"body {quoted(body.name)} has pinned_to={quoted(body.pinned_to)}"
                    + (nearest(body.pinned_to, known - own) or ".")
                )
            at = body.origin_at_joint(places[body.pinned_to])
            off = float(np.abs(np.subtract(at, at if body.at is None else body.at)).max())
            if off > OPEN * max(1.0, *(abs(x) for x in at)):
                raise SceneError(
                    f"A body starts where the point that it is pinned to makes it, so that `at` is left out, but body "
                    f"{quoted(body.name)} has at={body.at} where pinned_to={quoted(body.pinned_to)} makes it {at}."
                )
            body = replace(body, at=at)
        found[body.name] = body
        places |= {point.name: point.path.at(0.0)[0] if isinstance(point, Driven) else point.at for point in body.points}
    return tuple(found[body.name] for body in bodies)


def joined_to(bodies: Sequence[Body], name: str) -> list[Body]:
    """The body called ``name`` and all that move freely and that joints tie to it, each behind that to which it is pinned."""
    free = [body for body in parents_first(bodies) if not body.is_driven]
    owner = {name: body.name for body in free for name in _names(body)}
    joints = [(body.name, owner[body.pinned_to]) for body in free if body.pinned_to is not None and body.pinned_to in owner]
    found = {name}
    for _ in free:
        found |= {one for pair in joints for one in pair if found & set(pair)}
    return [body for body in free if body.name in found]


def _names(body: Body) -> set[str]:
    """Names of the points of a body that may be pinned to."""
    return {body.name, *(f"{body.name}.{name}" for name, _ in body.places)}
