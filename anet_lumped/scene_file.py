"""TOML ⇄ Scene.

A scene file holds the arguments of the Python classes under the same names::

    [effects.gravity]
    g = 9.81                                 # m/s²

    [[points]]
    name = "s0"
    kind = "fixed"                           # or "free", "driven"
    at = [0.0, 0.0, 0.0]                     # m

    [[points]]
    name = "s1"
    kind = "driven"
    path = {kind = "line", start = [1, 0, 0], velocity = [0.2, 0, 0], ramp = 1.0}

    [cable_defaults]                         # what all cables share, if anything
    EA = 1e4                                 # N

    [[cables]]
    start = "s0"
    end = "s1"
    length = 1.5                             # m
    mass_per_length = 0.1                    # kg/m
    segments = 20

Structure and types are checked by pydantic against the signatures of those classes, so no field is listed twice;
values are checked by the classes themselves.
"""

import dataclasses
import inspect
import pathlib
import re
import tomllib
from collections.abc import Callable
from functools import cache
from typing import Any

from anet_lumped.checks import SceneError, nearest
from anet_lumped.paths import KINDS, Path
from anet_lumped.scene import Cable, Driven, Fixed, Free, Scene

POINTS = {"fixed": Fixed, "driven": Driven, "free": Free}
SECTIONS = ("points", "cables", "cable_defaults", "effects")


def load_scene(path: str | pathlib.Path) -> Scene:
    """Read a scene from a TOML file.

    Raises
    ------
    SceneError : no such file, no valid TOML, or a scene that `scene_from_dict` refuses; names the file and the place
    """
    path = pathlib.Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise SceneError(f"A scene file must be readable, but {path}: {error.strerror}.") from None
    except UnicodeDecodeError as error:
        raise SceneError(f"A scene file must be UTF-8 text, but {path}: {error}.") from None
    try:
        entries = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"A scene file must be valid TOML, but {path}: {error}.") from None
    return scene_from_dict(entries, source=path.name)


def save_scene(scene: Scene, path: str | pathlib.Path) -> None:
    """Write a scene as a TOML file that `load_scene` reads back as an equal scene."""
    import tomli_w

    text = tomli_w.dumps(scene_to_dict(scene))
    # tomli_w gives each number of a vector a line of its own; strings hold no bare line ends, so only vectors match.
    text = re.sub(r"\[\n((?: +[-+.\de]+,\n)+) *\]", lambda found: f"[{' '.join(found[1].split())[:-1]}]", text)
    pathlib.Path(path).write_text(text, encoding="utf-8")


def scene_to_dict(scene: Scene) -> dict[str, Any]:
    """Return the scene as plain dicts, lists, strings and numbers, laid out as a scene file."""
    from anet_lumped.effects import REGISTRY

    names = {kind: name for name, kind in REGISTRY.items()}
    kinds = {kind: name for name, kind in POINTS.items()}
    cables = [_plain(cable) for cable in scene.cables]
    for cable in cables:
        if cable["name"] == f"{cable['start']}-{cable['end']}":
            del cable["name"]
    return {
        "effects": {names[type(effect)]: _plain(effect) for effect in scene.effects},
        "points": [{"name": point.name, "kind": kinds[type(point)]} | _plain(point) for point in scene.points],
        "cables": cables,
    }


def scene_from_dict(entries: dict[str, Any], source: str = "scene") -> Scene:
    """Return the scene that `entries`, laid out as a scene file, describe.

    Parameters
    ----------
    entries : what `scene_to_dict` returns or a scene file holds
    source : where it comes from, for messages

    Raises
    ------
    SceneError : an unknown or missing key, a value of the wrong type or one that Scene refuses; names the place
    """
    from anet_lumped.effects import REGISTRY

    _check_keys(entries, SECTIONS, source)
    shared = _table(entries.get("cable_defaults", {}), f"{source}, cable_defaults")
    _check_keys(
        shared, [key for key in inspect.signature(Cable).parameters if key not in ("start", "end", "name")],
        f"{source}, cable_defaults",
    )  # fmt: skip
    points = [_point(entry, place) for entry, place in _tables(entries, "points", source)]
    cables = [_make(Cable, shared | entry, place) for entry, place in _tables(entries, "cables", source)]
    effects = []
    for name, entry in _table(entries.get("effects", {}), f"{source}, effects").items():
        place = f"{source}, effects.{name}"
        effects.append(_make(_choose(name, REGISTRY, "effect", place), _table(entry, place), place))
    try:
        return Scene(points, cables, effects)
    except ValueError as error:
        raise SceneError(f"{source}: {error}") from None


def _point(entry: dict[str, Any], place: str) -> Fixed | Driven | Free:
    kind, entry = _take_kind(entry, POINTS, "point", place)
    if kind is Driven and "path" in entry:
        place_of_path = f"{place}.path"
        maker, arguments = _take_kind(_table(entry["path"], place_of_path), KINDS, "path", place_of_path)
        entry["path"] = _make(maker, arguments, place_of_path)
    return _make(kind, entry, place)


def _make(maker: Callable, entry: dict[str, Any], place: str) -> Any:
    """Call `maker` with the entries of a table, once pydantic has found them to fit its signature."""
    from pydantic import ValidationError

    entry = {key: _tuples(value) for key, value in entry.items()}
    _check_keys(entry, inspect.signature(maker).parameters, place)
    try:
        _schema(maker).model_validate(entry)
        return maker(**entry)
    except ValidationError as error:
        first = error.errors()[0]
        key = str(first["loc"][0]) + "".join(f"[{index}]" for index in first["loc"][1:])
        if first["type"] == "missing":
            raise SceneError(f"{place}: key `{key}` is missing.") from None
        raise SceneError(
            f"{place}: key `{key}` has the wrong type: {first['msg']}, but it is {first['input']!r}."
        ) from None
    except ValueError as error:
        raise SceneError(f"{place}: {error}") from None


@cache
def _schema(maker: Callable) -> Any:
    """Return the pydantic model of the keyword arguments of `maker`."""
    from pydantic import ConfigDict, create_model

    arguments = inspect.signature(maker, eval_str=True).parameters.values()
    fields: dict[str, Any] = {
        argument.name: (argument.annotation, ... if argument.default is argument.empty else argument.default)
        for argument in arguments
    }
    return create_model(
        maker.__name__, __config__=ConfigDict(strict=True, extra="forbid", arbitrary_types_allowed=True), **fields
    )


def _take_kind(entry: dict[str, Any], kinds: dict[str, Callable], what: str, place: str) -> tuple[Callable, dict]:
    if "kind" not in entry:
        raise SceneError(f"{place}: key `kind` is missing; a {what} is one of {_list(kinds)}.")
    kind = _choose(entry["kind"], kinds, what, place)
    return kind, {key: value for key, value in entry.items() if key != "kind"}


def _choose(name: Any, known: dict[str, Callable], what: str, place: str) -> Callable:
    if not isinstance(name, str) or name not in known:
        hint = nearest(str(name), known) or f"; known: {_list(known)}."
        raise SceneError(f"{place}: unknown {what} {name!r}{hint}")
    return known[name]


def _check_keys(entry: dict[str, Any], known: Any, place: str) -> None:
    for key in entry:
        if key not in known:
            hint = nearest(key, known, quote="`") or f"; known: {', '.join(f'`{name}`' for name in known)}."
            raise SceneError(f"{place}: unknown key `{key}`{hint}")


def _table(value: Any, place: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise SceneError(f"{place}: must be a table of keys and values, but is {value!r}.")
    return value


def _tables(entries: dict[str, Any], section: str, source: str) -> list[tuple[dict[str, Any], str]]:
    """Return each table of an array of tables, with its place for messages."""
    found = entries.get(section)
    if not isinstance(found, list) or not found:
        given = "is missing" if found is None else f"is {found!r}"
        raise SceneError(f"{source}: `{section}` must be an array of at least one table, [[{section}]], but {given}.")
    places = [f"{source}, {section}[{i}]" for i in range(len(found))]
    return [(_table(entry, place), place) for entry, place in zip(found, places, strict=True)]


def _plain(thing: Any) -> dict[str, Any]:
    """Return the fields of a point, cable or effect that are not None, as lists, strings and numbers."""
    fields = {field.name: getattr(thing, field.name) for field in dataclasses.fields(thing)}
    for name, value in fields.items():
        if isinstance(value, Path):
            fields[name] = {"kind": value.kind} | dict(value.parameters)
    return _lists({name: value for name, value in fields.items() if value is not None})


def _lists(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _lists(entry) for key, entry in value.items()}
    return [_lists(entry) for entry in value] if isinstance(value, tuple) else value


def _tuples(value: Any) -> Any:
    return tuple(_tuples(entry) for entry in value) if isinstance(value, list) else value


def _list(names: Any) -> str:
    return ", ".join(f'"{name}"' for name in names)
