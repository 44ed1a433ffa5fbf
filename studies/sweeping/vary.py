"""What a sweep varies: names of a scene's fields and of a run's settings, the values each takes, and their product."""

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping

from anet_lumped.checks import InputError, nearest, shown
from anet_lumped.limits import ROWS, check_most
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict
from anet_lumped.scene.scene import Scene

SETTINGS = ("t_end", "method", "dt", "start", "rtol", "atol", "rho_inf")
NOT_VARIED = ("name", "kind", "start", "end")  # of points, cables and events: what they are, and not a number of them
NUMBERED = re.compile(r"(?P<list>.+)\.(?P<index>[0-9]{1,9})")  # an entry of a list, `ground_map.heights.2.0`


class VaryError(InputError):
    """A name that nothing in the scene has, or values that cannot be read."""


def parse_vary(texts: Iterable[str]) -> dict[str, str]:
    """Name -> specification, from ["EA=1e2:1e6:9log", "EA~lognormal(1e4,0.2)", ...]."""
    vary = {}
    for text in texts:
        name, _, spec = map(str.strip, re.sub("[=~]", "=", text, count=1).partition("="))
        if not (name and spec):
            raise VaryError(f'What is varied must be NAME=SPEC, as in EA=1e2:1e6:9log, but "{text}" was given.')
        if name in vary:
            raise VaryError(f"A name must be varied once, but `{name}` is given {vary[name]} and {spec}.")
        vary[name] = spec
    return vary


def parse_values(spec: str, whole: bool = False) -> list:
    """Values of a specification: "a:b:n" (evenly spaced), "a:b:nlog" (evenly in the logarithm) or "a,b,c".

    `whole` rounds those of a range, which a list never needs; values that coincide then are given once.
    """
    if ":" not in spec:
        return list(dict.fromkeys(_number(word.strip()) for word in spec.split(",")))
    try:
        first, last, count = spec.split(":")
        log = count.endswith("log")
        a, b, n = float(first), float(last), int(count.removesuffix("log"))
        if n < 1 or not math.isfinite((b / a if a > 0 and b > 0 else math.nan) if log else b - a):
            raise ValueError
    except ValueError:
        raise VaryError(
            "A range must be a:b:n or a:b:nlog, with n at least 1, finite ends and, for log, positive ones, as in 1e2:1e6:9log, "
            f'but "{spec}" was given.'
        ) from None
    check_most(ROWS, n, f"The range {spec:.40}")
    share = [i / max(n - 1, 1) for i in range(n)]
    values = [a * (b / a) ** s if log else a + (b - a) * s for s in share]
    # 12 digits: 100.0 rather than 100.00000000000001, so that a row is found again by its inputs
    values = [round(value) if whole else float(f"{value:.12g}") for value in values]
    return list(dict.fromkeys(values))


def read_values(scene: Scene, vary: dict[str, str | Iterable]) -> dict[str, list]:
    """The values that each name takes.

    Parameters
    ----------
    scene : Scene
    vary : name -> specification ("1e2:1e6:9log") or values; a name is a setting of the run (`dt`), a field of every
        part that has it (`EA`: all cables), of one part by name (`s0-p0.EA`, `p0.mass`, `gravity.g`), a coordinate
        (`p0.at.z`), or an entry of a list, counted from 0 (`air.wind.1.seed`, `s0.path.xyz.2.0`, `events.0.mass`)

    Raises
    ------
    VaryError : an unknown name (with the nearest known one) or a specification that cannot be read
    """
    whole = whole_inputs(scene, vary)
    return {
        name: parse_values(spec, whole[name]) if isinstance(spec, str) else listed_values(name, spec) for name, spec in vary.items()
    }


def whole_inputs(scene: Scene, vary: Mapping) -> dict[str, bool]:
    """Of each name that varies, whether its values are whole numbers.

    Raises
    ------
    VaryError : an unknown name (with the nearest known one)
    """
    if not isinstance(vary, Mapping):
        raise VaryError(f"What is varied must be a dict from names to values, but it is {shown(vary)}.")
    fields = _fields(scene_to_dict(scene))
    whole = {}
    for name in vary:
        found = _found(fields, name)
        if not found and name not in SETTINGS:
            raise VaryError(f"Nothing called `{name}` can be varied here{_hint(name, fields, scene)}")
        whole[name] = bool(found) and all(type(container[key]) is int for container, key in found)
    return whole


def grid(values: dict[str, list]) -> Iterator[dict]:
    """Every combination of the values, a dict of inputs each, one after the other; the last name varies fastest.

    Raises
    ------
    InputError : they are more than `limits.ROWS`
    """
    check_most(ROWS, math.prod(map(len, values.values())), f"The grid of {', '.join(values)}")
    return (dict(zip(values, point, strict=True)) for point in itertools.product(*values.values()))


def apply(scene: Scene, inputs: dict) -> tuple[Scene, dict]:
    """The scene with these inputs, and the settings of the run among them.

    Raises
    ------
    VaryError : an unknown name
    SceneError : a value that the scene refuses
    """
    settings = {name: value for name, value in inputs.items() if name in SETTINGS}
    entries = scene_to_dict(scene)
    fields = _fields(entries)
    touched = set()
    for name in inputs:
        if name in settings:
            continue
        found = _found(fields, name)
        if not found:
            raise VaryError(f"Nothing called `{name}` can be varied here{_hint(name, fields, scene)}")
        for container, key in found:
            container[key] = inputs[name]
            touched.add((id(container), key))
    if len(settings) == len(inputs):
        return scene, settings
    for cable in entries["cables"]:  # zeta and BA exclude each other
        varied = [key for key in ("zeta", "BA") if (id(cable), key) in touched]
        if varied == ["BA"]:
            del cable["zeta"]
        elif varied == ["zeta"] or cable["BA"] is None:
            del cable["BA"]
        if cable["diameter"] is None:
            del cable["diameter"]
    return scene_from_dict(entries), settings


def _fields(entries):
    """Name -> (container, key) of every value that has this name, in a scene laid out as a scene file."""
    fields = {}
    for cable in entries["cables"]:
        cable.setdefault("BA", None)
        cable.setdefault("diameter", None)
    parts = [(cable.get("name", f"{cable['start']}-{cable['end']}"), cable) for cable in entries["cables"]]
    parts += [(point["name"], point) for section in ("points", "bodies") for point in entries.get(section, ())]
    parts += list(entries["effects"].items())
    for label, part in parts:
        for path, container, key in _values_below(part):
            for name in (path, f"{label}.{path}"):
                if name not in SETTINGS:
                    fields.setdefault(name, []).append((container, key))
    for i, event in enumerate(entries.get("events", ())):  # never by the field alone: `mass` is that of points
        for path, container, key in _values_below(event):
            fields[f"events.{i}.{path}"] = [(container, key)]
    return fields


def _values_below(part, above=""):
    """Name, container and key of each value of a table, and of those within it."""
    for key in part:
        if key not in (NOT_VARIED if not above else ("name", "kind")):
            yield from _values_of(part, key, above + key)


def _values_of(container, key, name):
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


def _are_all(value, condition):
    return isinstance(value, list) and bool(value) and all(map(condition, value))


def _found(fields, name):
    """Container and key of each value that has a name: a field, or an entry of a list that is one."""
    indices = []
    while name not in fields:
        numbered = NUMBERED.fullmatch(name)
        if not numbered:
            return []
        name = numbered["list"]
        indices.insert(0, int(numbered["index"]))
    found = fields[name]
    for i in indices:
        lists = [container[key] for container, key in found]
        if not all(isinstance(value, list) and i < len(value) for value in lists):
            return []
        found = [(value, i) for value in lists]
    return found


def _hint(name, fields, scene):
    numbered = NUMBERED.fullmatch(name)
    lists = [container[key] for container, key in (_found(fields, numbered["list"]) if numbered else ())]
    if lists and all(isinstance(value, list) for value in lists):
        return f": `{numbered['list']}` has {min(map(len, lists))} entries, counted from 0."
    label, _, key = re.sub(r"\.[xyz]$", "", name).rpartition(".")
    for part in (*scene.points, *scene.bodies, *scene.cables):
        if label in ("", part.name) and getattr(part, key, "") is None:
            return f": `{part.name}` has no `{key}` in this scene, and must be given one first."
    known = [*SETTINGS, *fields]
    parts = [other for other in fields if "." not in other]
    return nearest(name, known, quote="`") or (
        f"; known are {', '.join([*SETTINGS, *parts])}, and each field by its part's name, as in `{list(fields)[1]}`."
    )


def listed_values(name: str, values: Iterable) -> list:
    """The values, however they come, as a list that is not too long."""
    if not isinstance(values, Iterable):
        raise VaryError(f"The values of `{name}` must be a specification or a list, but they are {shown(values)}.")
    listed = []
    for value in values:
        listed.append(value)
        check_most(ROWS, len(listed), f"The values of `{name}`")
    return listed


def _number(word):
    for kind in (int, float):
        try:
            value = kind(word)
            beyond = math.isnan(value) or (math.isinf(value) and "inf" not in word.lower())
        except ValueError:
            continue
        except OverflowError:
            beyond = True
        if beyond:
            raise VaryError(f"A number must be one that a float can hold, but it is {word}.")
        return value
    return word
