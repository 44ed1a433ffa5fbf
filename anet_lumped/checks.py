"""Checks of what a user writes, made once, at the edge: what must hold, what was given, where."""

import difflib
import math
import operator
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from numbers import Real
from typing import Any

Vector = Sequence[float]  # three numbers; a tuple once it is checked


SMALLEST, LARGEST = 1e-100, 1e100  # sizes of numbers: beyond them, products of a few are no floats any more
LONGEST, SHOWN, NAMED, LISTED = 280, 120, 120, 12  # characters of a message, a value and a name; names in a message
EQUALLY_NEAR = 3  # names at most that a suggestion has


class InputError(ValueError):
    """An input that this package refuses. Its message, one line, says what must hold and what was given."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


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
    SceneError : `value` is no number, not finite, has the wrong sign, or is too large or too small to compute with
    """
    x = value if type(value) is float else number(value)  # without asking further: a net has a hundred thousand
    if (0.0 <= x <= LARGEST and sign != "positive") or SMALLEST <= x <= LARGEST:
        return x
    demand = f"{sign} and finite" if sign else "a finite number"
    if not math.isfinite(x) or (sign == "positive" and x <= 0) or (sign == "non-negative" and x < 0):
        raise SceneError(_sentence(argument, demand, unit, owner, value))
    if abs(x) > LARGEST or (sign == "positive" and x < SMALLEST):
        raise SceneError(_sentence(argument, f"{demand}, of a size from {SMALLEST:g} to {LARGEST:g}", unit, owner, value))
    return x


def number(value: Any) -> float:
    """Return a real number, or an array that holds one and has no dimensions, as a float.

    NaN for what is no real number, and for an integer or a fraction beyond all floats.
    """
    value = value.item() if getattr(value, "ndim", None) == 0 else value
    if not isinstance(value, Real) or isinstance(value, bool):
        return math.nan
    try:
        return float(value)
    except (OverflowError, TypeError):  # also of a time of NumPy, which claims to be an integer
        return math.nan


def check_count(argument: str, value: Any, owner: str) -> int:
    """Return `value` as an integer of at least 1, of 64 bits."""
    try:
        count = 0 if isinstance(value, bool) else operator.index(value)
    except TypeError:
        count = 0
    if not 1 <= count < 2**63:
        demand = "an integer of at least 1" + (" and below 2^63" if count > 1 else "")
        raise SceneError(_sentence(argument, demand, "", owner, value))
    return count


def check_index(argument: str, value: Any, count: int, what: str) -> int:
    """Return `value` as an integer by which one of `count` things is found, from the end where it is negative, as Python does.

    Raises
    ------
    InputError : `value` is no such integer
    """
    try:
        index = count if isinstance(value, bool) else operator.index(value)
    except TypeError:
        index = count
    if not -count <= index < count:
        raise InputError(
            f"Argument `{argument}` must be an integer from {-count} to {count - 1}, {what}, but it is {shown(value)}."
        )
    return index


def check_vector(argument: str, value: Any, unit: str, owner: str) -> Vector:
    """Return `value` as a tuple of three finite floats."""
    numbers = [number(x) for x in as_entries(value) or ()]
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise SceneError(_sentence(argument, "three finite numbers (x, y, z)", unit, owner, value))
    x, y, z = (check_number(argument, x, unit, owner) for x in numbers)
    return x, y, z


def check_direction(argument: str, value: Any, owner: str) -> Vector:
    """Return `value` as a tuple of three finite floats that are not all (next to) zero; its length means nothing."""
    direction = check_vector(argument, value, "", owner)
    if not any(abs(x) >= SMALLEST for x in direction):
        raise SceneError(f"Argument `{argument}` must not be zero, but {owner} has {argument}={direction}.")
    return direction


def as_entries(value: Any) -> tuple[Any, ...] | None:
    """Return what a sequence or another iterable holds, or None for text and what is no iterable."""
    try:
        return None if isinstance(value, str | bytes) else tuple(value)
    except TypeError:  # also of an array without dimensions
        return None


def check_flag(argument: str, value: Any, owner: str) -> bool:
    """Return `value`, which must be True or False."""
    if not isinstance(value, bool):
        raise SceneError(_sentence(argument, "True or False", "", owner, value))
    return value


def check_names(argument: str, value: Any, owner: str) -> tuple[str, ...] | None:
    """Return names as a tuple, or None for all."""
    if value is None:
        return None
    names = (None if isinstance(value, Mapping) else as_entries(value)) or ()
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
    entries = as_entries(value.items() if isinstance(value, Mapping) else value)
    entries = (None,) if entries is None else entries
    if not all(isinstance(pair, tuple | list) and len(pair) == 2 and isinstance(pair[0], str) for pair in entries):
        raise SceneError(_sentence(argument, f"a dict or pairs of {what}", "", owner, value))
    if not entries and not may_be_empty:
        raise SceneError(f"Argument `{argument}` must hold at least one pair of {what}, but {owner} has none.")
    twice = next((name for name, count in Counter(name for name, _ in entries).items() if count > 1), None)
    if twice is not None:
        raise SceneError(f"Argument `{argument}` must give each name once, but {owner} has {quoted(twice)} twice.")
    return tuple((name, entry) for name, entry in entries)


def check_number_by_name(
    argument: str, value: Any, unit: str, owner: str, *, sign: str = ""
) -> float | tuple[tuple[str, float], ...]:
    """Return one number for all cables as a float, or numbers by the name of a cable as pairs; arguments as in `check_number`."""
    if not isinstance(value, Mapping | tuple | list):
        return check_number(argument, value, unit, owner, sign=sign)
    pairs = check_pairs(argument, value, "a cable's name and a number", owner)
    return tuple((name, check_number(argument, x, unit, f"{owner} of cable {quoted(name)}", sign=sign)) for name, x in pairs)


def check_name(value: Any, what: str) -> str:
    """Return the name `value` of a point or cable (`what`), which must be a string with something in it."""
    if not isinstance(value, str) or not value.strip():
        raise SceneError(f"The name of a {what} must be a non-empty string, but is {shown(value)}.")
    if not value.isascii() and any("\ud800" <= character <= "\udfff" for character in value):
        raise SceneError(f"The name of a {what} must be text that UTF-8 can hold, but is {quoted(value)}.")
    return value


def nearest(name: Any, known: Iterable[str], quote: str = '"') -> str:
    """Return ', did you mean "p0"?' for the known name nearest to `name`, or '' if none is near; `Ea` is `EA` and not `EI`.

    Names that are equally near are all named: `Cd` may be `Cdn` or `Cdt`. A cable may be named from its other end.
    """
    if not isinstance(name, str):
        return ""
    cutoff = 0.5 if len(name) <= 2 else 0.6  # "p1" and "p0" share half their letters
    in_lower_case = {other.lower(): other for other in known}
    # a name far longer than all known ones is near to none, and would take long to compare
    asked = name[:LONGEST].lower()
    turned = "-".join(reversed(asked.split("-", 1)))
    if turned != asked and turned in in_lower_case:
        return f", did you mean {quoted(in_lower_case[turned], quote)}?"
    near = difflib.get_close_matches(asked, in_lower_case, n=EQUALLY_NEAR, cutoff=cutoff)
    ratios = [difflib.SequenceMatcher(None, other, asked).ratio() for other in near]
    best = sorted(in_lower_case[other] for other, ratio in zip(near, ratios, strict=True) if ratio == ratios[0])
    return f", did you mean {' or '.join(quoted(other, quote) for other in best)}?" if best else ""


def look_up(what: str, name: Any, known: Mapping[str, Any]) -> Any:
    """Return the point or cable (`what`) of a scene called `name`, of the `known` ones."""
    if not isinstance(name, str) or name not in known:
        names = [quoted(other) for other in known]
        listed = f"; known: {', '.join(names[:LISTED])}{', ...' if len(names) > LISTED else ''}." if names else "."
        raise SceneError(f"The scene has no {what} {quoted(name)}" + (nearest(name, known) or listed))
    return known[name]


def quoted(name: Any, quote: str = '"') -> str:
    """Return a name for a message: in quotes, on one line, and not longer than one reads; what is no name is shown as it is."""
    return f"{quote}{one_line(name, NAMED)}{quote}" if isinstance(name, str) else shown(name)


def shown(value: Any) -> str:
    """Return the text of a value for a message, on one line and not longer than one reads."""
    try:
        text = str(value) if isinstance(value, Real) else repr(value)
    except (ValueError, RecursionError):  # more digits than Python writes, or deeper than it follows
        text = f"a value of type {type(value).__name__} that is too large to be shown"
    text = printable(" ".join(text.split()))
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def printable(text: str) -> str:
    """Return a text with line ends, escape and other control characters as \\n, \\x1b and the like."""
    return text if text.isprintable() else "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def one_line(text: str, most: int = LONGEST) -> str:
    """Return a text on one line of at most so many characters: its start, which says what is wrong, and its end, the advice."""
    text = printable(text if len(text) <= 4 * most else f"{text[: 2 * most]}{text[-2 * most :]}")
    end = 2 * most // 5
    return text if len(text) <= most else f"{text[: most - end - 5]} ... {text[-end:]}"


def _sentence(argument: str, demand: str, unit: str, owner: str, value: Any) -> str:
    return f"Argument `{argument}` must be {demand}{f' [{unit}]' if unit else ''}, but {owner} has {argument}={shown(value)}."
