"""Checks of what a user writes, made once, at the edge: what must hold, what was given, where."""

import difflib
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral, Real
from typing import Any

Vector = Sequence[float]  # three numbers; a tuple once it is checked


SHOWN, LISTED = 160, 12  # characters of a value, and names, in a message


class InputError(ValueError):
    """An input that this package refuses. Its message says what must hold and what was given."""


class SceneError(InputError):
    """A scene, or a part of one, that cannot be what its author meant."""


def check_number(argument: str, value: Any, unit: str, owner: str, *, sign: str = "") -> float:
    """Return `value` as a finite float.

    Parameters
    ----------
    argument : name of the argument, for the message
    value : what the user gave
    unit : its unit, for the message; "" if it has none
    owner : who has it, for the message: 'cable "s0-p0"'
    sign : "" (any), "positive" or "non-negative"

    Raises
    ------
    SceneError : `value` is no number, not finite, or has the wrong sign
    """
    real = isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    if not real or (sign == "positive" and value <= 0) or (sign == "non-negative" and value < 0):
        demand = f"{sign} and finite" if sign else "a finite number"
        raise SceneError(_sentence(argument, demand, unit, owner, value))
    return float(value)


def check_count(argument: str, value: Any, owner: str) -> int:
    """Return `value` as an integer of at least 1."""
    if not isinstance(value, Integral) or isinstance(value, bool) or value < 1:
        raise SceneError(_sentence(argument, "an integer of at least 1", "", owner, value))
    return int(value)


def check_vector(argument: str, value: Any, unit: str, owner: str) -> Vector:
    """Return `value` as a tuple of three finite floats."""
    entries = tuple(value) if isinstance(value, Iterable) and not isinstance(value, str | bytes) else ()
    good = all(isinstance(x, Real) and not isinstance(x, bool) and math.isfinite(x) for x in entries)
    if len(entries) != 3 or not good:
        raise SceneError(_sentence(argument, "three finite numbers (x, y, z)", unit, owner, value))
    return float(entries[0]), float(entries[1]), float(entries[2])


def check_direction(argument: str, value: Any, owner: str) -> Vector:
    """Return `value` as a tuple of three finite floats that are not all zero; its length means nothing."""
    direction = check_vector(argument, value, "", owner)
    if not any(direction):
        raise SceneError(f"Argument `{argument}` must not be zero, but {owner} has {argument}={direction}.")
    return direction


def check_flag(argument: str, value: Any, owner: str) -> bool:
    """Return `value`, which must be True or False."""
    if not isinstance(value, bool):
        raise SceneError(_sentence(argument, "True or False", "", owner, value))
    return value


def check_names(argument: str, value: Any, owner: str) -> tuple[str, ...] | None:
    """Return names as a tuple, or None for all."""
    if value is None:
        return None
    names = tuple(value) if isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping) else ()
    if not names or not all(isinstance(name, str) and name.strip() for name in names):
        raise SceneError(_sentence(argument, "a sequence of names, or None for all", "", owner, value))
    return names


def check_pairs(argument: str, value: Any, what: str, owner: str, *, may_be_empty: bool = False) -> tuple[tuple[str, Any], ...]:
    """Return a dict from names, or a sequence of pairs, as a tuple of pairs of a name and whatever belongs to it.

    Parameters
    ----------
    argument, value, owner : as in `check_number`
    what : the pair, for the message: "a cable's name and a signal"
    may_be_empty : whether no pair at all will do

    Raises
    ------
    SceneError : no pairs, a name that is no string, or one that comes twice
    """
    pairs = value.items() if isinstance(value, Mapping) else value
    entries = tuple(pairs) if isinstance(pairs, Iterable) and not isinstance(pairs, str | bytes) else (None,)
    if not all(isinstance(pair, tuple | list) and len(pair) == 2 and isinstance(pair[0], str) for pair in entries):
        raise SceneError(_sentence(argument, f"a dict or pairs of {what}", "", owner, value))
    if not entries and not may_be_empty:
        raise SceneError(f"Argument `{argument}` must hold at least one pair of {what}, but {owner} has none.")
    twice = next((name for name, count in Counter(name for name, _ in entries).items() if count > 1), None)
    if twice is not None:
        raise SceneError(f'Argument `{argument}` must give each name once, but {owner} has "{twice}" twice.')
    return tuple((name, entry) for name, entry in entries)


def check_number_by_name(
    argument: str, value: Any, unit: str, owner: str, *, sign: str = ""
) -> float | tuple[tuple[str, float], ...]:
    """Return one number for all cables as a float, or numbers by the name of a cable as pairs; arguments as in `check_number`."""
    if not isinstance(value, Mapping | tuple | list):
        return check_number(argument, value, unit, owner, sign=sign)
    pairs = check_pairs(argument, value, "a cable's name and a number", owner)
    return tuple((name, check_number(argument, x, unit, f'{owner} of cable "{name}"', sign=sign)) for name, x in pairs)


def check_name(value: Any, what: str) -> str:
    """Return the name `value` of a point or cable (`what`), which must be a string with something in it."""
    if not isinstance(value, str) or not value.strip():
        raise SceneError(f"The name of a {what} must be a non-empty string, but is {value!r}.")
    return value


def nearest(name: Any, known: Iterable[str], quote: str = '"') -> str:
    """Return ', did you mean "p0"?' for the known name nearest to `name`, or '' if none is near; `Ea` is `EA` and not `EI`."""
    if not isinstance(name, str):
        return ""
    cutoff = 0.5 if len(name) <= 2 else 0.6  # "p1" and "p0" share half their letters
    in_lower_case = {other.lower(): other for other in known}
    near = difflib.get_close_matches(name.lower(), in_lower_case, n=1, cutoff=cutoff)
    return f", did you mean {quote}{in_lower_case[near[0]]}{quote}?" if near else ""


def look_up(what: str, name: Any, known: Mapping[str, Any]) -> Any:
    """Return the point or cable (`what`) of a scene called `name`, of the `known` ones."""
    if not isinstance(name, str) or name not in known:
        names = [f'"{other}"' for other in known]
        listed = f"; known: {', '.join(names[:LISTED])}{', ...' if len(names) > LISTED else ''}." if names else "."
        given = f'"{name}"' if isinstance(name, str) else shown(name)
        raise SceneError(f"The scene has no {what} {given}" + (nearest(name, known) or listed))
    return known[name]


def shown(value: Any) -> str:
    """Return the text of a value for a message, on one line and not longer than one reads."""
    text = " ".join(repr(value).split())
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def _sentence(argument: str, demand: str, unit: str, owner: str, value: Any) -> str:
    given = str(value) if isinstance(value, Real) else shown(value)
    return f"Argument `{argument}` must be {demand}{f' [{unit}]' if unit else ''}, but {owner} has {argument}={given}."
