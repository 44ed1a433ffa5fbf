"""A scene with other numbers: its fields by name, and copies of it in which some of them have other values."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, replace
from functools import lru_cache
from itertools import permutations
from threading import Lock
from typing import Any, NamedTuple

from anet_lumped.checks import InputError, nearest, shown
from anet_lumped.scene.as_dict import part_from_dict, scene_to_dict
from anet_lumped.scene.scene import Cable, Scene

SETTINGS = ("t_end", "method", "dt", "start", "rtol", "atol", "rho_inf")  # of a run, which may be varied beside fields of the scene
NOT_VARIED = ("name", "kind", "start", "end")  # of points, cables and events: what they are, and not a number of them
NUMBERED = re.compile(r"(?P<list>.+)\.(?P<index>[0-9]{1,9})")  # an entry of a list, `ground_map.heights.2.0`


class VaryError(InputError):
    """A name that nothing in the scene has, or values that cannot be read."""


class Field(NamedTuple):
    """A value in a scene that is laid out as a scene file.

    Parameters
    ----------
    container, key : table or list that holds it, and where in it
    section, entry : the part of the scene that it belongs to, `entries[section][entry]`
    """

    container: Any
    key: Any
    section: str
    entry: Any

    @property
    def value(self) -> Any:
        return self.container[self.key]


class Varied:
    """Copies of a scene with other values of some fields. Only the parts that hold them are made anew.

    A field of two names has the value of that which fewer fields have: of `EA` and `s0-p0.EA` the latter.

    Parameters
    ----------
    scene : Scene
    names : of the fields that vary; names of `SETTINGS` are those of a run

    Raises
    ------
    VaryError : an unknown name (with the nearest known one), or two of the same number
    """

    def __init__(self, scene: Scene, names: Iterable[str]) -> None:
        self.scene, self.names, self.writing = scene, tuple(names), Lock()
        self.entries = scene_to_dict(scene)
        known = known_fields(self.entries)
        self.found = {name: found(known, name) for name in self.names if name not in SETTINGS}
        for name, of_name in self.found.items():
            if not of_name:
                raise VaryError(f"Nothing called `{name}` can be varied here{hint(name, known, scene)}")
        self.found = dict(sorted(self.found.items(), key=lambda item: -len(item[1])))
        for one, other in permutations(self.found, 2):
            _check_apart(one, self.found[one], other, self.found[other])
        touched: dict[tuple[str, Any], list[tuple[str, Field]]] = {}
        for name, of_name in self.found.items():
            for field in of_name:
                touched.setdefault((field.section, field.entry), []).append((name, field))
        self.touched, self.alike = touched, {}
        first: dict[Any, tuple[str, Any]] = {}
        for (section, entry), held in touched.items():
            if section == "cables":  # those that differ in their names and ends alone stay so, if the same fields vary
                numbers = {name: value for name, value in vars(scene.cables[entry]).items() if name not in NOT_VARIED}
                varying = tuple((name, field.key) for name, field in held if field.container is self.entries[section][entry])
                key = (*numbers.values(), varying, len(held))
                if key in first:
                    self.alike[section, entry] = first[key]
                elif len(varying) == len(held):
                    first[key] = section, entry

    def with_values(self, values: Mapping[str, Any]) -> Scene:
        """The scene with these values of all the fields that vary.

        Raises
        ------
        SceneError : a value that the scene refuses
        """
        if not self.touched:
            return self.scene
        with self.writing:
            for name, of_name in self.found.items():
                for field in of_name:
                    field.container[field.key] = values[name]
            return self._scene(values)

    def _scene(self, values: Mapping[str, Any]) -> Scene:
        """`with_values` once they are in the tables."""
        scene, made = self.scene, dict[Any, Any]()
        parts = {section: list(getattr(scene, section)) for section in {section for section, _ in self.touched}}
        for (section, entry), held in self.touched.items():
            number = list(self.entries["effects"]).index(entry) if section == "effects" else entry
            part, like = parts[section][number], self.alike.get((section, entry))
            if like in made:
                parts[section][number] = _renamed(made[like], part)
            else:
                parts[section][number] = made[section, entry] = self._part(part, section, entry, held, values)
        return _like(scene, parts)

    def _part(self, part: Any, section: str, entry: Any, held: list[tuple[str, Field]], values: Mapping[str, Any]) -> Any:
        """A part with other values: a copy where they are fields of its own, read from its table where they are within one."""
        table = self.entries[section][entry]
        changes = {field.key: values[name] for name, field in held}
        excluded = None
        if section == "cables":  # zeta and BA exclude each other
            given = [key for key in ("zeta", "BA") if key in changes]
            excluded = "BA" if given == ["zeta"] else "zeta" if given == ["BA"] else None
        if all(field.container is table for _, field in held):
            kind: Any = type(part)
            plain = not any(isinstance(value, list | dict | str) for value in changes.values())
            if plain and changes.keys() <= _arguments(kind):
                return replace(part, **changes, **({} if excluded is None else {excluded: None if excluded == "BA" else 0.0}))
        return part_from_dict(section, entry, {key: value for key, value in table.items() if value is not None and key != excluded})


def _like(scene: Scene, parts: dict[str, list[Any]]) -> Scene:
    """A scene with other parts of the same kinds, names and ends, of which a Scene asks no more.

    Scenes in which it does are checked anew: bodies stand at points, payloads change at some, and cuts ask for segments.
    """
    others = parts.keys() - {"cables"}
    if scene.cable_cuts or scene.releases or (others and (scene.events or scene.bodies)) or not others <= {"points", "effects"}:
        return replace(scene, **parts)
    made = object.__new__(Scene)
    shared = ("cable_numbers",) if "points" in parts else ("cable_numbers", "all_points", "_points", "_bodies")
    vars(made).update({name: getattr(scene, name) for name in (*_arguments(Scene), *shared)})
    vars(made).update((section, tuple(of_section)) for section, of_section in parts.items())
    return made


@lru_cache
def _arguments(kind: Any) -> frozenset[str]:
    """Names of the fields that a dataclass is made of."""
    return frozenset(field.name for field in fields(kind) if field.init)


def _renamed(made: Cable, other: Cable) -> Cable:
    """A cable like one that was made, and so checked, with the name and the ends of another one."""
    cable = object.__new__(Cable)
    vars(cable).update(vars(made), name=other.name, start=other.start, end=other.end)
    return cable


def known_fields(entries: dict[str, Any]) -> dict[str, list[Field]]:
    """Every value of a scene that is laid out as a scene file, by each name that it has.

    A name is a field of every part that has it (`EA`: all cables), of one part by its name (`s0-p0.EA`, `p0.mass`, `gravity.g`), a
    coordinate (`p0.at.z`), or within a table (`air.wind.1.seed`, `s0.path.xyz.2.0`, `events.0.mass`).
    """
    known: dict[str, list[Field]] = {}
    for cable in entries["cables"]:
        cable.setdefault("BA", None)
        cable.setdefault("diameter", None)
    parts = [
        (cable.get("name", f"{cable['start']}-{cable['end']}"), cable, "cables", i) for i, cable in enumerate(entries["cables"])
    ]
    for section in ("points", "bodies"):
        parts += [(point["name"], point, section, i) for i, point in enumerate(entries.get(section, ()))]
    parts += [(label, part, "effects", label) for label, part in entries["effects"].items()]
    for label, part, section, entry in parts:
        for path, container, key in _values_below(part):
            for name in (path, f"{label}.{path}"):
                if name not in SETTINGS:
                    known.setdefault(name, []).append(Field(container, key, section, entry))
    for i, event in enumerate(entries.get("events", ())):  # never by the field alone: `mass` is that of points
        for path, container, key in _values_below(event):
            known[f"events.{i}.{path}"] = [Field(container, key, "events", i)]
    return known


def _check_apart(one: str, fields: list[Field], other: str, of_other: list[Field]) -> None:
    """Two names must not be of the same number, nor one within the other."""
    if [(id(field.container), field.key) for field in fields] == [(id(field.container), field.key) for field in of_other]:
        raise VaryError(f"What varies must be given once, but `{one}` and `{other}` are the same in this scene.")
    if any(_is_within(inner.container, field.value) for field in fields for inner in of_other):
        raise VaryError(f"What varies must be given once, but `{other}` is a part of `{one}`, which varies too.")


def _is_within(container: Any, value: Any) -> bool:
    """Whether a table or list is another one, or a part of it."""
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return container is value or any(_is_within(container, part) for part in parts if isinstance(part, dict | list))


def found(known: Mapping[str, list[Field]], name: str) -> list[Field]:
    """The values that have a name, as fields or as entries of lists that are fields; none where nothing has it."""
    if not isinstance(name, str):
        raise VaryError(f"What varies must be named by a text, but the name is {shown(name)}.")
    indices: list[int] = []
    while name not in known:
        numbered = NUMBERED.fullmatch(name)
        if not numbered:
            return []
        name = numbered["list"]
        indices.insert(0, int(numbered["index"]))
    of_name = known[name]
    for i in indices:
        if not all(isinstance(field.value, list) and i < len(field.value) for field in of_name):
            return []
        of_name = [field._replace(container=field.value, key=i) for field in of_name]
    return of_name


def hint(name: str, known: Mapping[str, list[Field]], scene: Scene) -> str:
    """The end of a sentence about a name that nothing has: what is known."""
    numbered = NUMBERED.fullmatch(name)
    lists = [field.value for field in (found(known, numbered["list"]) if numbered else ())]
    if numbered and lists and all(isinstance(value, list) for value in lists):
        return f": `{numbered['list']}` has {min(map(len, lists))} entries, counted from 0."
    label, _, key = re.sub(r"\.[xyz]$", "", name).rpartition(".")
    for part in (*scene.points, *scene.bodies, *scene.cables):
        if label in ("", part.name) and getattr(part, key, "") is None:
            return f": `{part.name}` has no `{key}` in this scene, and must be given one first."
    parts = [other for other in known if "." not in other]
    return nearest(name, [*SETTINGS, *known], quote="`") or (
        f"; known are {', '.join([*SETTINGS, *parts])}, and each field by its part's name, as in `{list(known)[1]}`."
    )


def _values_below(part: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Name, container and key of each value of a table, and of those within it."""
    for key in part:
        if key not in (NOT_VARIED if not above else ("name", "kind")):
            yield from _values_of(part, key, above + key)


def _values_of(container: Any, key: Any, name: str) -> Iterator[tuple[str, Any, Any]]:
    value = container[key]
    if isinstance(value, dict):
        yield from _values_below(value, f"{name}.")
    elif _are_all(value, lambda entry: isinstance(entry, dict)):
        for i, entry in enumerate(value):  # the rods of a body; several winds or waves
            yield from _values_below(entry, f"{name}.{entry.get('name', i)}.")
    elif _are_all(value, lambda entry: isinstance(entry, list) and len(entry) == 2 and isinstance(entry[0], str)):
        for entry in value:  # forces by the names of points; lengths paid out by those of cables
            yield from _values_of(entry, 1, f"{name}.{entry[0]}")
    else:
        yield name, container, key
    if isinstance(value, list) and len(value) == 3 and not isinstance(value[0], dict | list):
        yield from ((f"{name}.{axis}", value, i) for i, axis in enumerate("xyz"))


def _are_all(value: Any, condition: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(map(condition, value))
