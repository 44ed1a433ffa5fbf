"""Units of what may be varied in a scene, from the docstrings of what has the fields."""

import inspect
import re
from functools import lru_cache
from typing import Any

from .scene import Scene

FIELD = re.compile(r"^ *(?P<names>\w+(?:, \w+)*) : [^\[\n]*\[(?P<unit>[^\]]+)\]", re.MULTILINE)
OF_SETTINGS = {"t_end": "s", "dt": "s"}


def unit_of_field(scene: Scene, name: str) -> str:
    """The unit of what has a name in a sweep of a scene, as `p0.mass`; "" where it has none or none is known."""
    if name in OF_SETTINGS:
        return OF_SETTINGS[name]
    owner, path = _owner(scene, name)
    parts = [part for part in path.split(".") if part not in (*"xyz", "") and not part.isdigit()]
    things = [] if owner is None else [owner, *(one for value in vars(owner).values() for one in _several(value))]
    units = [_units(thing).get(part, "") for part in reversed(parts) for thing in things]
    return next(filter(None, units), "")


def _several(value: Any) -> list[Any]:
    """Winds, waves and shapes of an effect, rods of a body."""
    return [one for one in (value if isinstance(value, tuple | list) else (value,)) if hasattr(one, "__dataclass_fields__")]


def _owner(scene: Scene, name: str) -> tuple[Any, str]:
    """The part of a scene that has a field, and the field's path in it."""
    from anet_lumped.effects import REGISTRY

    for part in (*scene.cables, *scene.points, *scene.bodies):
        if name.startswith(f"{part.name}."):
            return part, name.removeprefix(f"{part.name}.")
    label, _, path = name.partition(".")
    for effect in scene.effects:
        if REGISTRY.name_of(effect) == label and path:
            return effect, path
    for part in (*scene.cables, *scene.points, *scene.bodies):
        if label in _units(part):
            return part, name
    return None, name


def _units(thing: Any) -> dict[str, str]:
    kind: Any = type(thing)
    return _units_of_kind(kind)


@lru_cache(maxsize=64)
def _units_of_kind(kind: Any) -> dict[str, str]:
    """Units of the fields of a class, by their names."""
    found: dict[str, str] = {}
    for entry in FIELD.finditer(inspect.getdoc(kind) or ""):
        found |= dict.fromkeys(entry["names"].split(", "), entry["unit"])
    return found
