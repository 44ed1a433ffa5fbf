"""Points that cables join: fixed, driven and free ones."""

from dataclasses import dataclass, field

from anet_lumped.checks import SceneError, Vector, check_name, check_number, check_vector, quoted, shown
from anet_lumped.prescribed.paths import Path


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
    path : its motion, made by a function of `anet_lumped.paths`
    """

    name: str
    path: Path

    def __post_init__(self) -> None:
        check_name(self.name, "point")
        if not isinstance(self.path, Path):
            raise SceneError(
                f"Argument `path` must be made by a function of anet_lumped.paths, as paths.line, "
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
