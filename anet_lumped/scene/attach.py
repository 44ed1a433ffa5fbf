"""Clump weights, floats and whatever else sits on a cable between its ends: points at arc lengths, between pieces of the cable."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

from anet_lumped.checks import SceneError, check_number, quoted, shown
from anet_lumped.effects.effect import PAID_OUT

from .cable import Cable
from .point import Free
from .scene import Scene, check_scene

NEAREST = 1e-6  # of a cable's length: what is nearer to its end, or to another point, is refused


def attach(scene: Scene, cable: str, points: Mapping[float, Free]) -> Scene:
    """Scene with points on a cable, which becomes pieces between them.

    The pieces of a cable "a-b" are "a-b[1]", "a-b[2]" and so on, from its start. They have its segments, shared by their lengths,
    each at least one. Effects that name the cable act on its pieces.

    Parameters
    ----------
    scene : Scene
    cable : name of the cable
    points : dict of float [m] to Free
        What sits at an unstretched length from the cable's start: its mass, volume, CdA and Ca.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError : no such cable, a length beyond the cable or next to another one, what is no free point; a cable that bends, since a
        point passes no bending moment, or whose length is paid out, since the pieces would have to share it
    """
    check_scene(scene)
    own = scene.cable(cable)
    if not isinstance(points, Mapping) or not points or not all(isinstance(point, Free) for point in points.values()):
        raise SceneError(
            f"What is attached to cable {quoted(cable)} must be a dict of lengths to Free points, but is {shown(points)}."
        )
    lengths = sorted(check_number("points", s, "m", f"what is attached to cable {quoted(cable)}") for s in points)
    marks = [0.0, *lengths, own.length]
    for before, after in pairwise(marks):
        if after - before < NEAREST * own.length:
            raise SceneError(
                f"Points on a cable must be apart, between its ends, but cable {quoted(cable)} of {own.length:g} m would have "
                f"a piece from {before:g} m to {after:g} m."
            )
    _check(scene, own)
    by_length = {float(s): point for s, point in points.items()}
    taken = {point.name for point in scene.all_points}
    for point in by_length.values():
        if point.name in taken:
            raise SceneError(
                f"Names of points must be unique, but one attached to cable {quoted(cable)} is {quoted(point.name)}, too."
            )
    names = [own.start, *(by_length[s].name for s in lengths), own.end]
    pieces = [
        replace(
            own, start=start, end=end, length=after - before, name=f"{cable}[{k}]",
            segments=max(1, round(own.segments * (after - before) / own.length)),
        )
        for k, ((start, end), (before, after)) in enumerate(zip(pairwise(names), pairwise(marks), strict=True), start=1)
    ]  # fmt: skip
    cables = [piece for one in scene.cables for piece in (pieces if one.name == cable else [one])]
    effects = [effect.after_break({cable: pieces}, cables) for effect in scene.effects]
    new = [by_length[s] for s in lengths]
    return replace(scene, points=(*scene.points, *new), cables=cables, effects=[effect for effect in effects if effect is not None])


def _check(scene: Scene, cable: Cable) -> None:
    """What cannot go on across a point."""
    from anet_lumped.effects import REGISTRY
    from anet_lumped.effects.bending import Bending

    if cable.EI > 0.0 and any(isinstance(effect, Bending) for effect in scene.effects):
        raise SceneError(f"A point on a cable passes no bending moment, but cable {quoted(cable.name)} bends with EI={cable.EI:g}.")
    curved: list[Any] = [effect for effect in scene.effects if REGISTRY.name_of(effect) == "moment_curvature"]
    if any(cable.name in dict(effect.curves) for effect in curved):
        raise SceneError(f"A point on a cable passes no bending moment, but cable {quoted(cable.name)} has a curve of moments.")
    for effect in scene.effects:
        for change in effect.length_changes(scene):
            if change.cable == cable.name and change.quantity == PAID_OUT:
                raise SceneError(f"A cable with points on it cannot be paid out, but cable {quoted(cable.name)} is.")
