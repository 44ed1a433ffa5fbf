"""What a user writes: points, cables, bodies and effects, checked when made and never changed afterwards."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar

from anet_lumped.checks import SceneError, Vector, as_entries, look_up, nearest, quoted, shown
from anet_lumped.effects.effect import Effect
from anet_lumped.prescribed.paths import Path
from anet_lumped.scene.cable_cut import CableCut
from anet_lumped.scene.happenings import Happening
from anet_lumped.scene.payload_change import PayloadChange
from anet_lumped.scene.release import Release, check_releases

from .body import Body, OnBody, OnDrivenBody
from .cable import COMPRESSION, Cable
from .joints import placed
from .point import Driven, Fixed, Free, Point
from .rod import Rod

if TYPE_CHECKING:
    import numpy as np

__all__ = [
    "COMPRESSION",
    "Body",
    "Cable",
    "Driven",
    "Fixed",
    "Free",
    "OnBody",
    "OnDrivenBody",
    "Point",
    "Rod",
    "Scene",
    "SceneError",
]


WHAT = {"points": "Fixed, Driven or Free points", "cables": "at least one Cable"}


@dataclass(frozen=True)
class Scene:
    """Points and bodies, the cables between them and the effects that act on them.

    Parameters
    ----------
    points : sequence of Fixed, Driven and Free
    cables : sequence of Cable; none where bodies, or free points with a place and a mass, move without
    effects : sequence of effects (package `anet_lumped.effects`), at most one of each type
    events : sequence of PayloadChange, CableCut and Release, what happens in a run
    bodies : sequence of Body; cables end at their attachments, "quad1.hook"

    Raises
    ------
    SceneError : names that are not unique or not known, nothing that moves, a free point that no cable reaches in a scene with
        cables, an effect given twice, a payload that is not at a free point or changes twice at a time, a cut of a segment that
        there is not, or that is cut twice, a release of a point that cannot be held
    """

    points: Sequence[Point]  # each of the five is kept as a tuple
    cables: Sequence[Cable]
    effects: Sequence[Effect] = ()
    events: Sequence[Happening] = ()
    bodies: Sequence[Body] = ()

    whole: ClassVar[bool] = True  # as its user wrote it: every free point holds a cable, and there is one
    stubs: ClassVar[tuple[tuple[str, Cable], ...]] = ()  # of what is left of a scene, see `remainder`
    limits: ClassVar[tuple[tuple[str, int, float], ...]] = ()  # likewise

    def __post_init__(self) -> None:
        for argument, kinds in (("points", Point), ("cables", Cable)):
            entries = _as_tuple(argument, getattr(self, argument))
            wrong = [entry for entry in entries if not isinstance(entry, kinds)]
            if wrong:
                given = f"{argument}[{entries.index(wrong[0])}] is {shown(wrong[0])}"
                raise SceneError(f"Argument `{argument}` of a scene must hold {WHAT[argument]}, but {given}.")
            object.__setattr__(self, argument, entries)
        object.__setattr__(self, "effects", _as_tuple("effects", self.effects))
        object.__setattr__(self, "events", _as_tuple("events", self.events))
        object.__setattr__(self, "bodies", _as_tuple("bodies", self.bodies))
        for body in self.bodies:
            if not isinstance(body, Body):
                raise SceneError(f"Argument `bodies` of a scene must hold Body, but holds {shown(body)}.")
        object.__setattr__(self, "bodies", placed(self.bodies, self.points))
        if self.whole:
            self._check_parts()
        self._check_names()
        self._check_effects()
        self._check_events()

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.points, self.cables, self.effects, self.events, self.bodies))

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "_hash"}  # of words: another one in each process

    @cached_property
    def longest(self) -> float:
        """Length of its longest cable [m], which errors are compared with.

        Without cables it is the diameter of the largest body that moves freely. Points alone have no length, and neither the
        distance between them nor their depth says how well their motion is to be known: it is 1 m then.
        """
        if self.cables:
            return max(cable.length for cable in self.cables)
        return 2.0 * max((body.radius for body in self.bodies if not body.is_driven), default=0.5)

    @cached_property
    def reach(self) -> float:
        """The largest coordinate of its supports, or the lengths of all its cables [m]; 1 m at least."""
        return max(1.0, *(abs(x) for at in self.supports for x in at), sum(cable.length for cable in self.cables))

    def __repr__(self) -> str:
        segments = sum(cable.segments for cable in self.cables)
        effects = ", ".join(type(effect).__name__ for effect in self.effects) or "no effects"
        bodies = f"{len(self.bodies)} bodies, " if self.bodies else ""
        return f"<Scene of {len(self.points)} points, {bodies}{len(self.cables)} cables of {segments} segments, {effects}>"

    def _check_parts(self) -> None:
        """There is something that moves: cables, bodies, or points on their own."""
        if not (self.points or self.bodies):
            raise SceneError(f"Argument `points` of a scene must hold {WHAT['points']}, but is empty.")
        if self.cables:
            return
        alone = [point for point in self.free_points if point.mass > 0.0 and point.at is not None]
        if not (self.bodies or alone):
            raise SceneError(
                f"Argument `cables` of a scene must hold {WHAT['cables']}, but is empty; without any, only bodies move, and free "
                "points with a mass and a place."
            )
        for point in self.free_points:
            if point not in alone:
                raise SceneError(
                    f"A free point without cables must have a mass and a place, but {quoted(point.name)} has mass={point.mass:g} "
                    f"and at={shown(point.at)}."
                )

    def _check_names(self) -> None:
        names = set()
        for point in self.all_points:
            if point.name in names:
                raise SceneError(f"Names of points must be unique, but two points are named {quoted(point.name)}.")
            names.add(point.name)
        cables = {}
        for cable in self.cables:
            if cable.name in cables:
                raise SceneError(
                    f"Names of cables must be unique, but two cables are named {quoted(cable.name)}; "
                    "give cables that join the same points a `name` each."
                )
            cables[cable.name] = cable
            for end in ("start", "end"):
                point = getattr(cable, end)
                if point not in names:
                    raise SceneError(
                        f"Argument `{end}` must name a point of the scene, but cable {quoted(cable.name)} has "
                        f"{end}={quoted(point)}" + (nearest(point, names) or ".")
                    )
        reached = {name for cable in self.cables for name in (cable.start, cable.end)}
        reached |= {event.holder for event in self.events if isinstance(event, Release)}
        for point in self.points:
            if self.whole and self.cables and isinstance(point, Free) and point.name not in reached:
                raise SceneError(f"A free point must hold at least one cable, but no cable ends at {quoted(point.name)}.")

    def _check_effects(self) -> None:
        if not self.effects:
            return
        from anet_lumped.effects import REGISTRY

        seen = set()
        for effect in self.effects:
            if not isinstance(effect, Effect) or (REGISTRY.name_of(effect) is None and not effect.from_outside):
                if isinstance(effect, type) and issubclass(effect, Effect):
                    name = effect.__name__
                    raise SceneError(
                        f"Argument `effects` of a scene must hold effects, such as {name}(...), but holds the class {name}."
                    )
                known = [str(REGISTRY.classes[name]) for name in REGISTRY.library]  # those of a user's own may be many
                raise SceneError(
                    f"Argument `effects` of a scene must hold effects ({', '.join(known)}), but holds "
                    + shown(effect)
                    + ('; register its class: REGISTRY["its_name"] = Class.' if isinstance(effect, Effect) else ".")
                )
            if type(effect) in seen:
                raise SceneError(f"A scene may have one effect of a type, but {type(effect).__name__} is given twice.")
            seen.add(type(effect))

    def _check_events(self) -> None:
        for event in self.events:
            if not isinstance(event, Happening):
                known = "PayloadChange, CableCut or Release"
                raise SceneError(f"Argument `events` of a scene must hold {known}, but holds {shown(event)}.")
        cut: set[tuple[str, int]] = set()
        for event in self.cable_cuts:
            count = self.cable(event.cable).segments
            if not -count <= event.segment < count:
                raise SceneError(
                    f"A cut must be of a segment of its cable, but {quoted(event.cable)} has {count}, and {event.segment} is cut."
                )
            if (event.cable, event.segment % count) in cut:
                raise SceneError(f"A segment may be cut once, but segment {event.segment} of cable {quoted(event.cable)} is twice.")
            cut.add((event.cable, event.segment % count))
        seen = set()
        for event in self.payload_changes:
            if not isinstance(self.point(event.point), Free) or isinstance(self.point(event.point), OnBody):
                raise SceneError(
                    f"A payload must be at a free point, but one is to change at {quoted(event.point)}, which is none."
                )
            if (event.point, event.t) in seen:
                raise SceneError(
                    f"A payload may change once at a time, but that of {quoted(event.point)} does twice at {event.t:g} s."
                )
            seen.add((event.point, event.t))
        check_releases(self)

    @property
    def payload_changes(self) -> tuple[PayloadChange, ...]:
        """The payloads that change at given times."""
        return tuple(event for event in self.events if isinstance(event, PayloadChange))

    @property
    def cable_cuts(self) -> tuple[CableCut, ...]:
        """The cables that are cut at given times."""
        return tuple(event for event in self.events if isinstance(event, CableCut))

    @property
    def releases(self) -> tuple[Release, ...]:
        """The points that are held at others until they are let go."""
        return tuple(event for event in self.events if isinstance(event, Release))

    @property
    def event_times(self) -> tuple[float, ...]:
        """Times of what happens at given times [s]."""
        return tuple(event.t for event in self.events if event.t is not None)

    @cached_property
    def _points(self) -> dict[str, Point]:
        return {point.name: point for point in self.all_points}

    @cached_property
    def _bodies(self) -> dict[str, Body]:
        return {body.name: body for body in self.bodies}

    @cached_property
    def _cables(self) -> dict[str, Cable]:
        return {cable.name: cable for cable in self.cables}

    @cached_property
    def cable_numbers(self) -> dict[str, int]:
        """Position of each cable in `cables`, by its name."""
        return {cable.name: c for c, cable in enumerate(self.cables)}

    @cached_property
    def all_points(self) -> tuple[Point, ...]:
        """The points, and those of the bodies."""
        return (*self.points, *(point for body in self.bodies for point in body.points))

    def body(self, name: str) -> Body:
        """Return the body called `name`."""
        return look_up("body", name, self._bodies)

    def point(self, name: str) -> Point:
        """Return the point called `name`."""
        return look_up("point", name, self._points)

    def cable(self, name: str) -> Cable:
        """Return the cable called `name`."""
        return look_up("cable", name, self._cables)

    @property
    def free_points(self) -> tuple[Free, ...]:
        """The free points, in the order of `points`."""
        return tuple(point for point in self.points if isinstance(point, Free))

    @property
    def loaded_points(self) -> tuple[Free, ...]:
        """The free points, and the points of bodies, that carry what air or water acts on."""
        own = [point for point in self.free_points if point.volume > 0.0 or point.CdA > 0.0]
        return (*own, *(point for body in self.bodies for point in body.loaded_points))

    @property
    def supports(self) -> list[Vector]:
        """Positions of the fixed points, and of the driven ones at t = 0 [m]."""
        fixed = [point.at for point in self.points if isinstance(point, Fixed)]
        return fixed + [point.path.start for point in self.all_points if isinstance(point, Driven)]

    @property
    def motions(self) -> tuple[Path, ...]:
        """Prescribed functions of time: paths of driven points and bodies, and those of effects."""
        driven = [point.path for point in self.points if isinstance(point, Driven)]
        driven += [path for body in self.bodies for path in (body.path, body.turning) if path is not None]
        return (*driven, *(signal.path for effect in self.effects for signal in effect.signals))

    @property
    def gravity(self) -> "np.ndarray":
        """Acceleration that effects give to every moving node alike, (3,) float64 [m/s²]: that of Gravity, zero without one."""
        import numpy as np

        total = np.zeros(3)
        for effect in self.effects:
            total += effect.uniform_acceleration
        return total


def _as_tuple(argument: str, value: Any) -> tuple:
    entries = None if isinstance(value, Mapping) else as_entries(value)
    if entries is None:
        raise SceneError(f"Argument `{argument}` of a scene must be a sequence, but is {shown(value)}.")
    return entries


def check_scene(value: Any) -> None:
    """Refuse what is no Scene."""
    if not isinstance(value, Scene):
        hint = "; load_scene(...) reads one from a file." if isinstance(value, str | PathLike) else "."
        raise SceneError(f"A scene must be a Scene, but it is {shown(value)}{hint}")
