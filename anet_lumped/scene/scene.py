"""What a user writes: points, cables and effects, checked when made and never changed afterwards."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar, Literal, get_args

from anet_lumped.checks import (
    SceneError,
    Vector,
    as_entries,
    check_count,
    check_name,
    check_number,
    check_vector,
    look_up,
    nearest,
    number,
    quoted,
    shown,
)
from anet_lumped.effects.effect import Effect
from anet_lumped.prescribed.paths import Path
from anet_lumped.scene.payload_change import PayloadChange

from .tension_strain import check_curve, slopes

if TYPE_CHECKING:
    import numpy as np

__all__ = ["COMPRESSION", "Cable", "Driven", "Fixed", "Free", "Point", "Scene", "SceneError"]

Compression = Literal["none", "damped", "linear"]
COMPRESSION: tuple[str, ...] = get_args(Compression)


@dataclass(frozen=True)
class Fixed:
    """A point that never moves.

    Parameters
    ----------
    name : name of the point, unique in its scene
    at : (3,) array_like [m], its place
    """

    name: str
    at: Vector

    def __post_init__(self) -> None:
        check_name(self.name, "point")
        object.__setattr__(self, "at", check_vector("at", self.at, "m", f"fixed point {quoted(self.name)}"))


@dataclass(frozen=True)
class Driven:
    """A point whose motion is prescribed.

    Parameters
    ----------
    name : name of the point, unique in its scene
    path : its motion, made by `paths.line`, `paths.samples` or `paths.harmonic`
    """

    name: str
    path: Path

    def __post_init__(self) -> None:
        check_name(self.name, "point")
        if not isinstance(self.path, Path):
            raise SceneError(
                f"Argument `path` must be made by paths.line, paths.samples or paths.harmonic, "
                f"but driven point {quoted(self.name)} has path={shown(self.path)}."
            )


@dataclass(frozen=True)
class Free:
    """A point moved by its cables alone: a junction, a payload, a loose end.

    Parameters
    ----------
    name : name of the point, unique in its scene
    mass : float [kg], carried besides the half segments that end here
    at : (3,) array_like [m] or None, where it starts; found from its cables if None
    CdA : float [m²], drag coefficient times area of what it carries
    volume : float [m³], of what it carries
    Ca : float, added mass of what it carries over that of the fluid in its volume
    """

    name: str
    mass: float = 0.0
    at: Vector | None = None
    CdA: float = field(default=0.0, kw_only=True)
    volume: float = field(default=0.0, kw_only=True)
    Ca: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        check_name(self.name, "point")
        owner = f"free point {quoted(self.name)}"
        for key, unit in (("mass", "kg"), ("CdA", "m²"), ("volume", "m³"), ("Ca", "")):
            object.__setattr__(self, key, check_number(key, getattr(self, key), unit, owner, sign="non-negative"))
        if self.at is not None:
            object.__setattr__(self, "at", check_vector("at", self.at, "m", owner))


Point = Fixed | Driven | Free


@dataclass(frozen=True)
class Cable:
    """A chain of equal segments between two points, with tension T = EA·eps + BA·(dl/dt)/L0 in each.

    Parameters
    ----------
    start, end : names of the points that it joins
    length : float [m], unstretched
    mass_per_length : float [kg/m]
    EA : float [N], axial stiffness; inf for a cable that does not stretch; with a curve its steepest slope, and left out
    segments : number of segments
    zeta : damping ratio of one segment, BA = zeta·L0·√(EA·mu)
    BA : float [N·s] or None, axial viscosity, in place of `zeta`
    compression : what a segment shorter than L0 does: "none" (carries nothing), "damped" (the damper acts, the
        spring does not), "linear" (spring and damper push as they pull)
    EA_compression : float [N], up to EA, axial stiffness of a segment shorter than L0, for compression="damped": 0, as if it were
        not given, is that law; EA is "linear"
    name : "start-end" if None
    diameter : float [m] or None, that air and water act on
    Cdn, Cdt : drag coefficients across and along the cable, on d·L0 and on π·d·L0
    Can, Cat : added-mass coefficients across and along the cable
    EI : float [N·m²], bending stiffness; acts where the scene has the effect `Bending`
    breaking_tension : float [N] or None, at which a segment fails; None for never
    tension_strain : sequence of (eps, T [N]) or None, the elastic tension over the strain in place of EA·eps: straight from (0, 0)
        to the first, from each to the next, and on beyond the last; both must grow
    """

    start: str
    end: str
    length: float = field(kw_only=True)
    mass_per_length: float = field(kw_only=True)
    EA: float = field(default=None, kw_only=True)  # type: ignore[assignment]  # a curve may stand for it
    segments: int = field(kw_only=True)
    zeta: float = field(default=0.0, kw_only=True)
    BA: float | None = field(default=None, kw_only=True)
    compression: Compression = field(default="none", kw_only=True)
    name: str = field(default=None, kw_only=True)  # type: ignore[assignment]  # its ends name it
    diameter: float | None = field(default=None, kw_only=True)
    Cdn: float = field(default=1.2, kw_only=True)
    Cdt: float = field(default=0.01, kw_only=True)
    Can: float = field(default=1.0, kw_only=True)
    Cat: float = field(default=0.0, kw_only=True)
    EI: float = field(default=0.0, kw_only=True)
    breaking_tension: float | None = field(default=None, kw_only=True)
    EA_compression: float = field(default=0.0, kw_only=True)
    tension_strain: Sequence[tuple[float, float]] | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        for point in (self.start, self.end):
            check_name(point, "point")
        name = f"{self.start}-{self.end}" if self.name is None else check_name(self.name, "cable")
        owner = f"cable {quoted(name)}"
        checked: dict[str, Any] = {
            "name": name,
            "length": check_number("length", self.length, "m", owner, sign="positive"),
            "mass_per_length": check_number("mass_per_length", self.mass_per_length, "kg/m", owner, sign="positive"),
            "segments": check_count("segments", self.segments, owner),
            "zeta": check_number("zeta", self.zeta, "", owner, sign="non-negative"),
        }
        if self.diameter is not None:
            checked["diameter"] = check_number("diameter", self.diameter, "m", owner, sign="positive")
        for key, unit in (("Cdn", ""), ("Cdt", ""), ("Can", ""), ("Cat", ""), ("EI", "N·m²"), ("EA_compression", "N")):
            checked[key] = check_number(key, getattr(self, key), unit, owner, sign="non-negative")
        if self.breaking_tension is not None:
            checked["breaking_tension"] = check_number("breaking_tension", self.breaking_tension, "N", owner, sign="positive")
        if self.BA is not None:
            checked["BA"] = check_number("BA", self.BA, "N·s", owner, sign="non-negative")
        if self.tension_strain is not None:
            checked["tension_strain"] = check_curve(self.tension_strain, owner)
            checked["EA"] = max(slopes(checked["tension_strain"]))
            if self.EA is not None and number(self.EA) != checked["EA"]:
                raise SceneError(f"Only one of `EA` and `tension_strain` may be given, but {owner} has both.")
        elif self.EA is None:
            raise SceneError(f"A cable must have `EA` or `tension_strain`, but {owner} has neither.")
        else:
            checked["EA"] = math.inf if number(self.EA) == math.inf else check_number("EA", self.EA, "N", owner, sign="positive")
        for key, value in checked.items():
            object.__setattr__(self, key, value)
        if self.start == self.end:
            raise SceneError(f"A cable must join two different points, but {owner} runs from {quoted(self.start)} to itself.")
        if self.zeta and self.BA is not None:
            raise SceneError(f"Only one of `zeta` and `BA` may be given, but {owner} has zeta={self.zeta} and BA={self.BA}.")
        if not isinstance(self.compression, str) or self.compression not in COMPRESSION:
            raise SceneError(
                'Argument `compression` must be "none", "damped" or "linear", but '
                f"{owner} has compression={shown(self.compression)}" + (nearest(self.compression, COMPRESSION) or ".")
            )

        if self.EA_compression and (self.compression != "damped" or self.EA_compression > self.EA_first or self.inextensible):
            raise SceneError(
                'Argument `EA_compression` must not exceed a finite EA and needs compression="damped", but '
                f"{owner} has EA_compression={self.EA_compression}, EA={self.EA_first} and compression={shown(self.compression)}."
            )

    @property
    def inextensible(self) -> bool:
        """Whether it does not stretch, EA = inf."""
        return math.isinf(self.EA)

    @property
    def EA_first(self) -> float:
        """Axial stiffness at L0 [N]: EA, or the first slope of the curve."""
        return self.EA if self.tension_strain is None else slopes(self.tension_strain)[0]

    @property
    def springs(self) -> tuple[tuple[float, float], ...]:
        """Springs in parallel that make the curve; none without one.

        The first one acts from the strain 0 on with a share of EA, each further one from its strain on with a share of the first.
        """
        if self.tension_strain is None:
            return ()
        of_pieces, knots = slopes(self.tension_strain), self.tension_strain[:-1]
        steps = (after - before for before, after in pairwise(of_pieces))
        further = ((strain, step / of_pieces[0]) for (strain, _), step in zip(knots, steps, strict=True))
        return (0.0, of_pieces[0] / self.EA), *further

    def strain(self, T: float) -> float:
        """Strain that a tension T >= 0 [N] holds, by the elastic law."""
        if self.tension_strain is None:
            return T / self.EA
        at, below, strain = 0.0, 0.0, 0.0
        for (eps, above), slope in zip(self.tension_strain, slopes(self.tension_strain), strict=True):
            if T > below or at == 0.0:
                strain = at + (T - below) / slope
            at, below = eps, above
        return strain

    @property
    def L0(self) -> float:
        """Unstretched length of one segment [m]."""
        return self.length / self.segments

    @property
    def stiffness(self) -> float:
        """Spring of one segment, k = EA/L0 [N/m]."""
        return self.EA / self.L0

    @property
    def dashpot(self) -> float:
        """Damper of one segment, c = BA/L0 [N·s/m]."""
        return self.axial_viscosity / self.L0

    @property
    def axial_viscosity(self) -> float:
        """Axial viscosity, BA as given or zeta·L0·√(EA·mu) [N·s]."""
        if self.inextensible:
            return 0.0
        if self.BA is not None:
            return self.BA
        return self.zeta * self.L0 * math.sqrt(self.EA * self.mass_per_length)

    @property
    def damping_ratio(self) -> float:
        """Damping ratio of one segment, zeta as given or BA/(L0·√(EA·mu))."""
        if self.BA is None or self.inextensible:
            return self.zeta
        return self.BA / (self.L0 * math.sqrt(self.EA * self.mass_per_length))

    @property
    def omega_max(self) -> float:
        """Bound of the axial frequencies of the lumped chain, (2/L0)·√(EA/mu) [rad/s]."""
        return 2.0 / self.L0 * math.sqrt(self.EA / self.mass_per_length)


@dataclass(frozen=True)
class Scene:
    """Points, the cables between them and the effects that act on them.

    Parameters
    ----------
    points : sequence of Fixed, Driven and Free
    cables : sequence of Cable
    effects : sequence of effects (package `anet_lumped.effects`), at most one of each type
    events : sequence of PayloadChange, what happens at given times of a run

    Raises
    ------
    SceneError : names that are not unique or not known, a free point that no cable reaches, an effect given twice, a payload that
        is not at a free point or changes twice at a time
    """

    points: Sequence[Point]  # each of the four is kept as a tuple
    cables: Sequence[Cable]
    effects: Sequence[Effect] = ()
    events: Sequence[PayloadChange] = ()

    whole: ClassVar[bool] = True  # as its user wrote it: every free point holds a cable, and there is one
    stubs: ClassVar[tuple[tuple[str, Cable], ...]] = ()  # of what is left of a scene, see `remainder`

    def __post_init__(self) -> None:
        for argument, kinds in (("points", Point), ("cables", Cable)):
            entries = _as_tuple(argument, getattr(self, argument))
            wrong = [entry for entry in entries if not isinstance(entry, kinds)]
            if wrong or (self.whole and not entries):
                what = "Fixed, Driven or Free points" if argument == "points" else "at least one Cable"
                given = f"{argument}[{entries.index(wrong[0])}] is {shown(wrong[0])}" if wrong else "is empty"
                raise SceneError(f"Argument `{argument}` of a scene must hold {what}, but {given}.")
            object.__setattr__(self, argument, entries)
        object.__setattr__(self, "effects", _as_tuple("effects", self.effects))
        object.__setattr__(self, "events", _as_tuple("events", self.events))
        self._check_names()
        self._check_effects()
        self._check_events()

    def __repr__(self) -> str:
        segments = sum(cable.segments for cable in self.cables)
        effects = ", ".join(type(effect).__name__ for effect in self.effects) or "no effects"
        return f"<Scene of {len(self.points)} points, {len(self.cables)} cables of {segments} segments, {effects}>"

    def _check_names(self) -> None:
        names = set()
        for point in self.points:
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
        for point in self.points:
            if self.whole and isinstance(point, Free) and point.name not in reached:
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
                raise SceneError(
                    f"Argument `effects` of a scene must hold effects ({', '.join(REGISTRY.class_names)}), but holds "
                    + shown(effect)
                    + ('; register its class: REGISTRY["its_name"] = Class.' if isinstance(effect, Effect) else ".")
                )
            if type(effect) in seen:
                raise SceneError(f"A scene may have one effect of a type, but {type(effect).__name__} is given twice.")
            seen.add(type(effect))

    def _check_events(self) -> None:
        seen = set()
        for event in self.events:
            if not isinstance(event, PayloadChange):
                raise SceneError(f"Argument `events` of a scene must hold PayloadChange, but holds {shown(event)}.")
            if not isinstance(self.point(event.point), Free):
                raise SceneError(
                    f"A payload must be at a free point, but one is to change at {quoted(event.point)}, which is none."
                )
            if (event.point, event.t) in seen:
                raise SceneError(
                    f"A payload may change once at a time, but that of {quoted(event.point)} does twice at {event.t:g} s."
                )
            seen.add((event.point, event.t))

    @cached_property
    def _points(self) -> dict[str, Point]:
        return {point.name: point for point in self.points}

    @cached_property
    def _cables(self) -> dict[str, Cable]:
        return {cable.name: cable for cable in self.cables}

    @cached_property
    def cable_numbers(self) -> dict[str, int]:
        """Position of each cable in `cables`, by its name."""
        return {cable.name: c for c, cable in enumerate(self.cables)}

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
    def supports(self) -> list[Vector]:
        """Positions of the fixed points, and of the driven ones at t = 0 [m]."""
        fixed = [point.at for point in self.points if isinstance(point, Fixed)]
        return fixed + [tuple(point.path.at(0.0)[0].tolist()) for point in self.points if isinstance(point, Driven)]

    @property
    def motions(self) -> tuple[Path, ...]:
        """Prescribed functions of time: paths of driven points, and those of effects."""
        driven = [point.path for point in self.points if isinstance(point, Driven)]
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
