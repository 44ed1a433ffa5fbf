"""What is left of a scene when payloads have changed and segments have broken: a scene of its own, on the same nodes.

A cable without one of its segments is two cables, whose ends there are free points. The segment has no force any more; either half
of it stays with its node as a stub without length, with its mass, volume, drag across and contact. A point that is held at another
is that node, until it is released. All that a scene can have, its remainder can, so that no compiled code has to know of events.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from anet_lumped.model.build import build
from anet_lumped.model.model import Model
from anet_lumped.scene.payload_change import carried_from
from anet_lumped.scene.release import together
from anet_lumped.scene.scene import Cable, Free, Point, Scene

SCATTER = 1e-3
"""By how much more of its breaking tension what is left of a cable takes, each time that it breaks: among equals one fails,
while the others are still under the same tension, which waves of unloading take some time to leave."""


@dataclass(frozen=True)
class Pieces(Scene):
    """A scene in which a free point may have lost its last cable.

    Parameters
    ----------
    stubs : pairs of a point's name and the Cable of which half a segment stays there
    limits : names of cables, the segment of each, 0 or -1, and the tension [N] at which what ends there is released
    """

    stubs: tuple[tuple[str, Cable], ...] = ()
    limits: tuple[tuple[str, int, float], ...] = ()

    whole: ClassVar[bool] = False

    @cached_property
    def all_points(self) -> tuple[Point, ...]:
        """Its points, and those of its bodies with the stubs that stay at them."""
        at_point = {}
        for name, cable in self.stubs:
            at_point.setdefault(name, []).append(cable)
        of_bodies = [_with_stubs(point, at_point.get(point.name)) for body in self.bodies for point in body.points]
        return (*self.points, *of_bodies)


@dataclass(frozen=True, eq=False)
class Remainder:
    """What is left of a scene.

    Parameters
    ----------
    model : Model
    node : (n,) int64, of the whole scene's model, that each of its nodes is
    segment : (n_segments,) int64, likewise
    held : dict of the name of each point that is held to that of its holder
    """

    model: Model
    node: np.ndarray
    segment: np.ndarray
    held: Mapping[str, str] = field(default_factory=dict)

    def follow(self, whole: Model, rows: np.ndarray) -> np.ndarray:
        """Let points that are held be where their holders are, in rows (..., n, 3) of the whole scene's nodes; returns them."""
        for name, holder in self.held.items():
            rows[..., whole.node_of[name], :] = rows[..., whole.node_of[holder], :]
        return rows


def remainder(whole, payloads, broken, released=()):
    """What is left of a scene.

    Parameters
    ----------
    whole : Model of the scene
    payloads : dict of point name to dict, mass [kg], volume [m³] and CdA [m²] of points where they are not the scene's any more
    broken : dict of cable name to increasing tuple of int, its segments that have failed, from its start
    released : names of the points that are held no more

    Returns
    -------
    Remainder
    """
    all_segments = np.arange(whole.n_segments)
    if not (payloads or broken or whole.scene.events):
        return Remainder(whole, np.arange(whole.n), all_segments)
    scene, stubs, loose, cables, pieces, nodes, segments = whole.scene, [], {}, [], {}, {}, {}
    held = held_points(scene, released)
    carried = [replace(p, **payloads.get(p.name, {})) if isinstance(p, Free) else p for p in scene.points]
    points, whole_cables = together(carried, list(scene.cables), held)
    for cable in whole_cables:
        own = all_segments[whole.segments(cable.name)]
        failed = broken.get(cable.name, ())
        if not failed:
            cables.append(cable)
            nodes[cable.name], segments[cable.name] = whole.nodes(cable.name), own
            continue
        names = [cable.start, *(f"{cable.name}[{k}]" for k in range(1, cable.segments)), cable.end]
        for k in (end for s in failed for end in (s, s + 1)):
            stubs.append((names[k], cable))
            if 0 < k < cable.segments:
                loose[names[k]] = whole.nodes(cable.name)[k]
        pieces[cable.name] = []
        for first, last in zip((0, *(s + 1 for s in failed)), (*failed, cable.segments), strict=True):
            if first < last:
                piece = replace(
                    cable, name=f"{cable.name}[{first}:{last}]", start=names[first], end=names[last],
                    length=cable.L0 * (last - first), segments=last - first,
                    breaking_tension=cable.breaking_tension and cable.breaking_tension * (1.0 + SCATTER * len(failed)),
                )  # fmt: skip
                pieces[cable.name].append(piece)
                nodes[piece.name], segments[piece.name] = whole.nodes(cable.name)[first : last + 1], own[first:last]
        cables += pieces[cable.name]
    stubs_at = {}
    for name, cable in stubs:
        stubs_at.setdefault(name, []).append(cable)
    points = [_with_stubs(point, stubs_at.get(point.name)) for point in (*points, *map(Free, loose))]
    effects = [effect.after_break(pieces, cables) if pieces else effect for effect in scene.effects]
    parts = points, cables, [effect for effect in effects if effect is not None]
    bodies, limits = scene.bodies, _limits(scene, held, broken)
    cut = pieces or scene.releases
    model = build(Pieces(*parts, bodies=bodies, stubs=tuple(stubs), limits=limits) if cut else Scene(*parts, bodies=bodies))
    node, segment = np.empty(model.n, np.int64), np.empty(model.n_segments, np.int64)
    for cable in cables:
        node[model.nodes(cable.name)] = nodes[cable.name]
        segment[model.segments(cable.name)] = segments[cable.name]
    for name, number in model.node_of.items():
        node[number] = loose[name] if name in loose else whole.node_of[name]
    return Remainder(model, node, segment, held)


def held_points(scene: Scene, released: Collection[str] = ()) -> dict[str, str]:
    """Names of the points that are held and of their holders, but for those that are released."""
    return {event.point: event.holder for event in scene.releases if event.point not in released}


def _limits(scene, held, broken):
    """`Pieces.limits` of the cables that end at points which are held, as far as their segments there hold."""
    tension = {event.point: event.tension for event in scene.releases if event.point in held and event.tension is not None}
    limits = []
    for cable in scene.cables:
        failed, last = broken.get(cable.name, ()), cable.segments - 1
        for end, segment, number in ((cable.start, 0, 0), (cable.end, -1, last)):
            if end in tension and number not in failed:
                first = 0 if number == 0 else max((s + 1 for s in failed), default=0)
                beyond = cable.segments if number else min(failed, default=cable.segments)
                limits.append((f"{cable.name}[{first}:{beyond}]" if failed else cable.name, segment, tension[end]))
    return tuple(limits)


def _with_stubs(point, own):
    """A free point with the halves of segments that stay with it, each given by its cable; any other point as it is."""
    if not own or not isinstance(point, Free):
        return point
    halves = [0.5 * cable.L0 for cable in own]
    widths = [cable.diameter or 0.0 for cable in own]
    volumes = [0.25 * math.pi * d * d * half for d, half in zip(widths, halves, strict=True)]
    volume = point.volume + sum(volumes)
    moved = point.Ca * point.volume + sum(cable.Can * v for cable, v in zip(own, volumes, strict=True))
    return replace(
        point,
        mass=point.mass + sum(cable.mass_per_length * half for cable, half in zip(own, halves, strict=True)),
        CdA=point.CdA + sum(cable.Cdn * d * half for cable, d, half in zip(own, widths, halves, strict=True)),
        volume=volume,
        Ca=moved / volume if volume else point.Ca,
    )


def lightest(scene):
    """The scene with the least payload that each point ever carries: no frequency of what is left of it is above its own.

    Of volumes it is the least too, and of CdA the largest, which damps most.
    """
    if not scene.events:
        return scene
    points = []
    for point in scene.points:
        for change in (event for event in scene.payload_changes if event.point == point.name):
            said = carried_from(change)
            of_change = {key: (max if key == "CdA" else min)(value, getattr(point, key)) for key, value in said.items()}
            point = replace(point, **of_change)
        points.append(point)
    return replace(scene, points=points, events=scene.releases)
