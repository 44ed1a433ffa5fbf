"""Units of a sweep's columns: of measures from their records, of inputs from the docstrings of what has them."""

import inspect
import re

from anet_lumped.effects import REGISTRY
from studies.sweeping.measures import MEASURES

FIELD = re.compile(r"^ *(?P<names>\w+(?:, \w+)*) : [^\[\n]*\[(?P<unit>[^\]]+)\]", re.MULTILINE)
OF_SETTINGS = {"t_end": "s", "dt": "s"}


def unit_of(scene, column: str) -> str:
    """The unit of a column of a sweep of a scene, "" where it has none or none is known."""
    name = column.partition(":")[0]
    if name in MEASURES:
        return MEASURES[name].unit.replace("-", "")
    if column in OF_SETTINGS:
        return OF_SETTINGS[column]
    owner, path = _owner(scene, column)
    parts = [part for part in path.split(".") if part not in (*"xyz", "") and not part.isdigit()]
    things = [] if owner is None else [owner]
    things += [one for value in vars(owner).values() for one in _several(value)] if things else []
    units = [_units(thing).get(part, "") for part in reversed(parts) for thing in things]
    return next(filter(None, units), "")


def _several(value):
    """Winds, waves and shapes of an effect, rods of a body."""
    return [one for one in (value if isinstance(value, tuple | list) else (value,)) if hasattr(one, "__dataclass_fields__")]


def with_units(scene, columns) -> dict[str, str]:
    """For each column its name with its unit in brackets."""
    units = {column: unit_of(scene, column) for column in columns}
    return {column: f"{column} [{unit}]" if unit else column for column, unit in units.items()}


def _owner(scene, column):
    """The part of a scene that has a field, and the field's path in it."""
    for part in (*scene.cables, *scene.points, *scene.bodies):
        if column.startswith(f"{part.name}."):
            return part, column.removeprefix(f"{part.name}.")
    label, _, path = column.partition(".")
    for effect in scene.effects:
        if REGISTRY.name_of(effect) == label and path:
            return effect, path
    for part in (*scene.cables, *scene.points, *scene.bodies):
        if label in _units(part):
            return part, column
    return None, column


def _units(thing) -> dict[str, str]:
    found = {}
    for entry in FIELD.finditer(inspect.getdoc(type(thing)) or ""):
        found |= dict.fromkeys(entry["names"].split(", "), entry["unit"])
    return found
