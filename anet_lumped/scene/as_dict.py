"""Scene ⇄ plain dicts, lists, strings and numbers, laid out as a scene file.

Structure and types are checked by pydantic against the signatures of the classes, so no field is listed twice; values are checked
by the classes themselves.
"""

import dataclasses
import inspect
from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, Literal, get_args, get_origin

from anet_lumped.checks import NAMED, SceneError, Vector, check_number, nearest, one_line, quoted, shown
from anet_lumped.effects import shapes
from anet_lumped.effects.flow import waves, wind
from anet_lumped.effects.flow.waves import Wave
from anet_lumped.effects.flow.wind import Wind
from anet_lumped.effects.shapes import Shape
from anet_lumped.prescribed import paths, signals
from anet_lumped.prescribed.paths import Path
from anet_lumped.prescribed.signals import Signal
from anet_lumped.scene import nets, working_curves
from anet_lumped.scene.attach import attach
from anet_lumped.scene.carried import Carried
from anet_lumped.scene.happenings import KINDS as EVENTS
from anet_lumped.scene.happenings import Happening
from anet_lumped.scene.rod import Rod
from anet_lumped.scene.scene import Body, Cable, Driven, Fixed, Free, Scene, check_scene
from anet_lumped.scene.working_curves import WorkingCurve

POINTS = {"fixed": Fixed, "driven": Driven, "free": Free}


# What is written as a table with a `kind` inside another.
PARTS: dict[Any, tuple[str, Mapping[str, Callable]]] = {
    Path: ("path", paths.KINDS), Signal: ("signal", signals.KINDS), Wind: ("wind", wind.KINDS), Wave: ("wave", waves.KINDS),
    Shape: ("shape", shapes.KINDS), WorkingCurve: ("working curve", working_curves.KINDS),
}  # fmt: skip


OWN = " An effect of your own is known in Python, once its module is imported, and not on the command line."
DEEPEST = 32  # tables and arrays within each other; a wind that is sampled has 7
NAMED_ENTRIES = {"points": "point", "bodies": "body", "cables": "cable", "rods": "rod"}
SECTIONS = ("points", "bodies", "cables", "cable_defaults", "nets", "attach", "effects", "events")
NETS: dict[str, Callable] = {"grid": nets.grid, "cone": nets.cone}
OF_POINTS = ("length",)  # what the places of a net's points say of its cables
OF_NETTING = ("rope", "mass_per_length", "EA", "diameter", "Cdn", "Cdt")  # what a netting does


def scene_to_dict(scene: Scene) -> dict[str, Any]:
    """Return the scene as plain dicts, lists, strings and numbers, laid out as a scene file."""
    from anet_lumped.effects import REGISTRY

    check_scene(scene)
    kinds, kind_of = ({kind: name for name, kind in known.items()} for known in (POINTS, EVENTS))
    cables = [_plain(cable) for cable in scene.cables]
    for cable in cables:
        if cable["name"] == f"{cable['start']}-{cable['end']}":
            del cable["name"]
        if "tension_strain" in cable:
            del cable["EA"]  # its steepest slope
    whole = {
        "effects": {REGISTRY.name_of(effect): _plain(effect) for effect in scene.effects},
        "points": [{"name": point.name, "kind": kinds[type(point)]} | _plain(point) for point in scene.points],
        "cables": cables,
        "bodies": [_of_body(body) for body in scene.bodies],
        "events": [{"kind": kind_of[type(event)]} | _plain(event) for event in scene.events],
    }
    return {section: entries for section, entries in whole.items() if entries or section in ("effects", "points", "cables")}


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

    _check_depth(_table(entries, source), source)
    _check_keys(entries, SECTIONS, source)
    shared = _table(entries.get("cable_defaults", {}), f"{source}, cable_defaults")
    _check_keys(
        shared, ["rope", *(key for key in inspect.signature(Cable).parameters if key not in ("start", "end", "name"))],
        f"{source}, cable_defaults",
    )  # fmt: skip
    bodies = [_body(entry, place) for entry, place in _tables(entries, "bodies", source)] if "bodies" in entries else ()
    woven = [_net(entry, place, shared) for entry, place in _tables(entries, "nets", source)] if "nets" in entries else ()
    points, cables = [], [cable for net in woven for cable in net.cables]
    if not (bodies or woven) or entries.get("points", []) != []:
        points = [_point(entry, place) for entry, place in _tables(entries, "points", source)]
    own = {point.name for point in points}
    points += [point for net in woven for point in net.points if point.name not in own]
    alone = bodies or any(isinstance(point, Free) and point.mass > 0.0 for point in points)  # what moves without cables
    if not (woven or alone) or entries.get("cables", []) != []:
        cables += [_make(Cable, _of_rope(shared | entry, place), place) for entry, place in _tables(entries, "cables", source)]
    effects = []
    for name, entry in _table(entries.get("effects", {}), f"{source}, effects").items():
        place = f"{source}, effects.{one_line(name, NAMED)}"
        effects.append(_make(_choose(name, REGISTRY, "effect", place, OWN), _table(entry, place), place))
    events = [_event(entry, place) for entry, place in _tables(entries, "events", source)] if "events" in entries else ()
    attached = _attached(entries, source) if "attach" in entries else {}
    try:
        if not attached:
            return Scene(points, cables, effects, events, bodies)
        scene = Scene(points, cables, effects, bodies=bodies)
        for cable, places in attached.items():
            scene = attach(scene, cable, places)
        return dataclasses.replace(scene, events=events)  # which may happen to what is attached
    except ValueError as error:
        raise SceneError(f"{source}: {error}") from None


def _attached(entries: dict[str, Any], source: str) -> dict[str, dict[float, Free]]:
    """The points of the section `attach`, by the cable that they sit on and their place along it."""
    by_cable: dict[str, dict[float, Free]] = {}
    for entry, place in _tables(entries, "attach", source):
        own = {key: value for key, value in entry.items() if key in ("cable", "length")}
        cable, length = _make(_place_on_cable, own, place)
        points = by_cable.setdefault(cable, {})
        if length in points:
            raise SceneError(f"{place}: points on a cable must be apart, but there is one at {length:g} m of it already.")
        points[length] = _make(Free, {key: value for key, value in entry.items() if key not in own}, place)
    return by_cable


def _place_on_cable(cable: str, length: float) -> tuple[str, float]:
    return cable, check_number("length", length, "m", f"what is attached to cable {quoted(cable)}")


def made_from_tables(section: str, maker: Callable, entries: dict[str, Any], source: str) -> list[tuple[Any, str]]:
    """What `maker` makes of each table of a section, and the place of that table for messages.

    Raises
    ------
    SceneError : no array of tables, an unknown or missing key, a value of the wrong type; names the place
    """
    return [(_make(maker, entry, place), place) for entry, place in _tables(entries, section, source)]


def part_from_dict(section: str, name: Any, entry: dict[str, Any], source: str = "scene") -> Any:
    """Return the point, body, cable, effect or event that an entry of a section of a scene file describes.

    Parameters
    ----------
    section : "points", "bodies", "cables", "effects" or "events"
    name : of an effect; of others their number in the section
    entry : its table
    source : where it comes from, for messages

    Raises
    ------
    SceneError : as of `scene_from_dict`
    """
    from anet_lumped.effects import REGISTRY

    called = f"effects.{name}" if section == "effects" else _called(section, [entry])[0].replace("[0]", f"[{name}]")
    place = f"{source}, {called}"
    if section == "effects":
        return _make(_choose(name, REGISTRY, "effect", place, OWN), entry, place)
    if section == "cables":
        return _make(Cable, entry, place)
    return {"points": _point, "bodies": _body, "events": _event}[section](entry, place)


def _point(entry: dict[str, Any], place: str) -> Fixed | Driven | Free:
    kind, entry = _take_kind(entry, POINTS, "point", place)
    return _make(kind, entry, place)


def _net(entry: dict[str, Any], place: str, shared: dict[str, Any]) -> nets.NetParts:
    """Points and cables of a net that a table describes; ``shared`` is what all cables of the file have in common."""
    kind, entry = _take_kind(entry, NETS, "net", place)
    shared = {key: value for key, value in shared.items() if key not in OF_POINTS}
    twine = shared
    if "netting" in entry:
        within = f"{place}.netting"
        entry = entry | {"netting": _make(nets.Netting, _table(entry["netting"], within), within)}
        twine = {key: value for key, value in shared.items() if key not in OF_NETTING}
    for part, common in (("cable", twine), ("border", shared)):
        if part in entry or (part == "cable" and common):
            within = f"{place}.{part}"
            entry = entry | {part: _of_rope(common | _table(entry.get(part, {}), within), within)}
    return _make(kind, entry, place)


def _body(entry: dict[str, Any], place: str) -> Body:
    if "rods" in entry:
        rods = [_make(Rod, rod, of) for rod, of in _tables(entry, "rods", place)]
        entry = entry | {"rods": rods}
    if "carried" in entry:
        within = f"{place}.carried"
        carried = {
            name: _make(Carried, _table(thing, f"{within}.{one_line(name, NAMED)}"), f"{within}.{one_line(name, NAMED)}")
            for name, thing in _table(entry["carried"], within).items()
        }
        entry = entry | {"carried": carried}
    return _make(Body, entry, place)


def _of_body(body: Body) -> dict[str, Any]:
    """`_plain` of a body, with its attachments by name and its rods as tables."""
    plain = _plain(body) | {"attachments": dict(body.attachments), "rods": [_plain(rod) for rod in body.rods]}
    plain["carried"] = {name: _plain(thing) for name, thing in dict(body.carried).items()}
    left_out = ({"at"} if body.is_jointed else set()) | {key for key in ("rods", "carried") if not plain[key]}
    return {key: value for key, value in plain.items() if key not in left_out}


def _event(entry: dict[str, Any], place: str) -> Happening:
    kind, entry = _take_kind(entry, EVENTS, "event", place)
    return _make(kind, entry, place)


def _of_rope(entry: dict[str, Any], place: str) -> dict[str, Any]:
    """Return the entries of a cable with its rope, if it has one, replaced by what that says."""
    if "rope" not in entry:
        return entry
    from anet_lumped.scene.ropes import rope

    if "diameter" not in entry:
        raise SceneError(f"{place}: key `diameter` is missing; a rope needs its nominal diameter [m].")
    try:
        said = rope(entry["rope"], entry["diameter"])
    except ValueError as error:
        raise SceneError(f"{place}: {error}") from None
    return said | {key: value for key, value in entry.items() if key not in ("rope", "diameter")}


def _parts(maker: Callable, key: str, value: Any, place: str) -> Any:
    """Return the value of an argument of `maker`, with what it holds as tables, itself or within, made of those."""
    part = None if value is None else _part_of(maker, key)
    if part is None:
        return value
    what, kinds = PARTS[part]
    annotation = _arguments(maker)[key].annotation
    if _mentions(annotation, Vector):
        return _vectors_or(what, kinds, value, f"{place}.{key}")
    return _made(what, kinds, value, f"{place}.{key}", may_be_number=_mentions(annotation, float))


def _vectors_or(what: str, kinds: Mapping[str, Callable], value: Any, place: str) -> Any:
    """Return vectors by name, or pairs of a name and a vector, where a table stands for what its `kind` says."""
    named = value.items() if isinstance(value, dict) else value
    if not isinstance(value, dict | list) or not all(isinstance(pair, list | tuple) and len(pair) == 2 for pair in named):
        return value
    return {
        name: _part(what, kinds, entry, f"{place}.{one_line(str(name), NAMED)}") if isinstance(entry, dict) else entry
        for name, entry in named
    }


def kinds_of(maker: Callable, key: str) -> Mapping[str, Callable] | None:
    """Classes by the `kind` of the table that an argument of `maker` may be given by; None if it takes no such table."""
    part = _part_of(maker, key) if key in _arguments(maker) else None
    return None if part is None else PARTS[part][1]


@cache
def _part_of(maker: Callable, key: str) -> type | None:
    """The key of `PARTS` that the type of an argument of `maker` holds, or None."""
    annotation = _arguments(maker)[key].annotation
    return next((part for part in PARTS if _mentions(annotation, part)), None)


def _mentions(annotation: Any, part: type) -> bool:
    """Whether a type holds another, at any depth."""
    return part is annotation or any(_mentions(inner, part) for inner in get_args(annotation))


def _made(what: str, kinds: Mapping[str, Callable], value: Any, place: str, may_be_number: bool = False) -> Any:
    if isinstance(value, list):
        return [_made(what, kinds, entry, f"{place}[{i}]", isinstance(entry, str)) for i, entry in enumerate(value)]
    if isinstance(value, dict) and value and all(isinstance(entry, dict) for entry in value.values()):
        return {name: _part(what, kinds, entry, f"{place}.{one_line(name, NAMED)}") for name, entry in value.items()}
    return value if may_be_number and not isinstance(value, dict) else _part(what, kinds, value, place)


def _part(what: str, kinds: Mapping[str, Callable], value: Any, place: str) -> Any:
    maker, arguments = _take_kind(_table(value, place), kinds, what, place)
    return _make(maker, arguments, place)


def _make(maker: Callable, entry: dict[str, Any], place: str) -> Any:
    """Call `maker` with the entries of a table, once pydantic has found them to fit its signature."""
    from pydantic import ValidationError

    _check_keys(entry, _arguments(maker), place)
    entry = {key: _tuples(_parts(maker, key, value, place)) for key, value in entry.items()}
    try:
        _schema(maker).model_validate(entry)
        return maker(**entry)
    except ValidationError as error:
        first = error.errors()[0]
        key = str(first["loc"][0]) + "".join(f"[{index}]" for index in first["loc"][1:] if isinstance(index, int))
        if first["type"] == "missing":
            raise SceneError(f"{place}: key `{key}` is missing.") from None
        raise SceneError(f"{place}: key `{key}` has the wrong type: {first['msg']}, but it is {shown(first['input'])}.") from None
    except ValueError as error:
        raise SceneError(f"{place}: {error}") from None


@cache
def _arguments(maker: Callable) -> Any:
    return inspect.signature(maker, eval_str=True).parameters


@cache
def _schema(maker: Callable) -> Any:
    """Return the pydantic model of the keyword arguments of `maker`."""
    from pydantic import ConfigDict, create_model

    fields: dict[str, Any] = {
        argument.name: (_type(argument), ... if argument.default is argument.empty else argument.default)
        for argument in _arguments(maker).values()
    }
    return create_model(maker.__name__, __config__=ConfigDict(strict=True, extra="forbid", arbitrary_types_allowed=True), **fields)


def _type(argument: inspect.Parameter) -> Any:
    """The type that a table must give: any string for words to choose from, as the class itself says which there are."""
    return str if get_origin(argument.annotation) is Literal else argument.annotation


def _take_kind(entry: dict[str, Any], kinds: Mapping[str, Callable], what: str, place: str) -> tuple[Callable, dict]:
    if "kind" not in entry:
        raise SceneError(f"{place}: key `kind` is missing; a {what} is one of {_list(kinds)}.")
    kind = _choose(entry["kind"], kinds, f"kind of {what}", place)
    return kind, {key: value for key, value in entry.items() if key != "kind"}


def _choose(name: Any, known: Mapping[str, Callable], what: str, place: str, hint: str = "") -> Callable:
    if not isinstance(name, str) or name not in known:
        near = nearest(name, known) or f"; known: {_list(known)}.{hint}"
        raise SceneError(f"{place}: unknown {what} {shown(name)}{near}")
    return known[name]


def _check_keys(entry: dict[str, Any], known: Any, place: str) -> None:
    for key in entry:
        if key not in known:
            hint = nearest(key, known, quote="`") or f"; known: {', '.join(f'`{name}`' for name in known)}."
            raise SceneError(f"{place}: unknown key {quoted(key, '`')}{hint}")


def _check_depth(entries: Any, source: str) -> None:
    """Refuse what nests so deep that whatever follows it, to its end, would exceed Python's depth of calls."""
    level = [entries]
    for _ in range(DEEPEST + 1):
        inner = [value.values() if isinstance(value, dict) else value for value in level]
        level = [value for values in inner for value in values if isinstance(value, dict | list | tuple)]
        if not level:
            return
    raise SceneError(f"{source}: tables and arrays must not nest deeper than {DEEPEST}, but some do.")


def _table(value: Any, place: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise SceneError(f"{place}: must be a table of keys and values, but is {shown(value)}.")
    return value


def _tables(entries: dict[str, Any], section: str, source: str) -> list[tuple[dict[str, Any], str]]:
    """Return each table of an array of tables, with its place for messages."""
    found = entries.get(section)
    if not isinstance(found, list) or not found:
        given = "is missing" if found is None else f"is {shown(found)}"
        raise SceneError(f"{source}: `{section}` must be an array of at least one table, [[{section}]], but {given}.")
    places = [f"{source}, {called}" for called in _called(section, found)]
    return [(_table(entry, place), place) for entry, place in zip(found, places, strict=True)]


def _called(section: str, entries: list[Any]) -> list[str]:
    """What messages call the entries of a section: by the names that only one has, `point "bottle"`, else by their numbers."""
    names = [_name(entry) if section in NAMED_ENTRIES and isinstance(entry, dict) else None for entry in entries]
    times = Counter(names)
    return [
        f"{NAMED_ENTRIES[section]} {quoted(name)}" if name and times[name] == 1 else f"{section}[{i}]"
        for i, name in enumerate(names)
    ]


def _name(entry: dict[str, Any]) -> str | None:
    """The name of an entry, or that which a cable has by its ends."""
    name, ends = entry.get("name"), (entry.get("start"), entry.get("end"))
    if name is None and all(isinstance(end, str) for end in ends):
        return f"{ends[0]}-{ends[1]}"
    return name if isinstance(name, str) else None


def _plain(thing: Any) -> dict[str, Any]:
    """Return the arguments of a point, cable, effect, wind or wave that are not None, as lists, strings and numbers."""
    fields = {field.name: getattr(thing, field.name) for field in dataclasses.fields(thing) if field.init}
    return _lists({name: value for name, value in fields.items() if value is not None})


def _lists(value: Any) -> Any:
    if isinstance(value, Path | Signal):
        return {"kind": value.kind} | _lists(dict(value.parameters))
    if isinstance(value, Wind | Wave | Shape | WorkingCurve):
        names = {kind: name for _, kinds in PARTS.values() for name, kind in kinds.items()}
        return {"kind": names[type(value)]} | _plain(value)
    if isinstance(value, dict):
        return {key: _lists(entry) for key, entry in value.items()}
    return [_lists(entry) for entry in value] if isinstance(value, tuple) else value


def _tuples(value: Any) -> Any:
    return tuple(_tuples(entry) for entry in value) if isinstance(value, list) else value


def _list(names: Any) -> str:
    return ", ".join(quoted(name) for name in names)
