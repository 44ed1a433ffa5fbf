"""Effects that a command adds to the scene that it is given: --effect air.wind.speed=10."""

import inspect
import tomllib
from typing import Annotated

import typer

Added = Annotated[
    list[str],
    typer.Option(
        "--effect", metavar="NAME.KEY=VALUE", help="Add an effect, or what one lacks, as in air.wind.speed=10; again for more."
    ),
]


def with_effects(scene, texts):
    """The scene with effects added.

    Parameters
    ----------
    scene : Scene
    texts : iterable of str
        NAME for an effect as it is by default, or NAME.KEY=VALUE; of one effect as many as it has keys. An effect that the scene
        has takes keys that it lacks, such as the waves of its water. A value is one of TOML, or a word. A table within, such as a
        wind, needs no `kind` where its keys leave but one; of a wind the keys `speed` and `direction` alone make one that is the
        same everywhere.

    Raises
    ------
    InputError : an effect or a key that the scene has, a key that is given twice or has no value
    SceneError : what a scene file would be refused for
    """
    from anet_lumped.checks import InputError
    from anet_lumped.effects import REGISTRY
    from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

    if not texts:
        return scene
    entries = scene_to_dict(scene)
    added = {}
    for text in texts:
        path, is_set, value = text.partition("=")
        name, *keys = path.strip().split(".")
        if bool(keys) != bool(is_set) or not all(keys) or (is_set and not value.strip()):
            raise InputError(f'An effect must be NAME or NAME.KEY=VALUE, as in air.wind.speed=10, but "{text:.80}" was given.')
        if name in entries["effects"] and (not keys or keys[0] in entries["effects"][name]):
            what = ".".join([name, *keys[:1]])
            raise InputError(f'The scene must not have what --effect adds, but it has "{what}"; --set changes it.')
        table = added.setdefault(name, {})
        for key in keys[:-1]:
            table = table.setdefault(key, {}) if isinstance(table, dict) else None
        if keys and (not isinstance(table, dict) or keys[-1] in table):
            raise InputError(f"A key of an effect must be given once, but {path.strip():.80} is given again.")
        if keys:
            table[keys[-1]] = _value(value.strip())
    for name, table in added.items():
        if name in REGISTRY:
            _add_kinds(REGISTRY[name], name, table)
        added[name] = entries["effects"].get(name, {}) | table
    return scene_from_dict(entries | {"effects": entries["effects"] | added})


def _value(text):
    """Number, list or truth as TOML writes them, else the word itself."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _add_kinds(maker, place, table):
    """Put the `kind` into tables that lack it, where their keys tell it."""
    from anet_lumped.checks import InputError
    from anet_lumped.scene.as_dict import kinds_of

    for key, value in table.items():
        kinds = kinds_of(maker, key) if isinstance(value, dict) and "kind" not in value else None
        if not kinds:
            continue
        if "uniform" in kinds and "speed" in value and value.keys() <= {"speed", "direction"}:
            table[key] = _uniform(f"{place}.{key}", **value)
            continue
        fitting = [name for name, kind in kinds.items() if _fits(kind, value)]
        fitting = [name for name in fitting if inspect.signature(kinds[name]).parameters.keys() == value.keys()] or fitting
        if len(fitting) != 1:
            known = ", ".join(fitting or kinds)
            raise InputError(f"The kind of {place}.{key} must be given, as in --effect {place}.{key}.kind=KIND; one of {known}.")
        value["kind"] = fitting[0]


def _fits(maker, given):
    """Whether these keys are arguments of a class, and all that it needs."""
    arguments = inspect.signature(maker).parameters
    needed = {name for name, argument in arguments.items() if argument.default is argument.empty}
    return needed <= given.keys() <= arguments.keys()


def _uniform(place, speed, direction=(1.0, 0.0, 0.0)):
    from anet_lumped.checks import check_direction, check_number

    x, y, z = check_direction("direction", direction, place)
    per_length = check_number("speed", speed, "m/s", place) / (x * x + y * y + z * z) ** 0.5
    return {"kind": "uniform", "velocity": [per_length * x, per_length * y, per_length * z]}
