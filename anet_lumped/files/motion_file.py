"""Motions of a platform from a file of columns, or in words such as "surge=1sin0.1".

Files are those of MoorDyn's driver and of OpenFAST, or a CSV: a time and some of surge, sway, heave, roll, pitch and yaw, below
names such as `PtfmSurge`, in any order, beside whatever else. Units such as `(mm)` stand behind the names or in the line below
them; without one a time is in s and a length in m, and angles must have one, `(deg)` or `(rad)`. A file without names has seven
columns, the time and the six in this order, angles in rad (MoorDyn's documentation, "MoorDyn-F Driver Input File").
"""

import math
import os
import re
from collections.abc import Sequence
from os import PathLike

from anet_lumped.checks import NAMED, SceneError, one_line, quoted
from anet_lumped.prescribed import signals
from anet_lumped.prescribed.six_motions import ROTATIONS, TRANSLATIONS, SixMotions
from anet_lumped.regular_files import read_text
from anet_lumped.scene.platform import platform
from anet_lumped.scene.scene import Scene

NAMES = TRANSLATIONS + ROTATIONS
UNITS = {
    "time": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
    **{name: {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3} for name in TRANSLATIONS},
    **{name: {"rad": 1.0, "mrad": 1e-3, "deg": math.radians(1.0), "degrees": math.radians(1.0)} for name in ROTATIONS},
}
"""Sizes of the units in which a column may be given, in SI."""
NONE_GIVEN = ("", "-")
NUMBER = r"([0-9.]+(?:e[+-]?[0-9]+)?)"
WORDS = re.compile(
    rf"\s*([a-z]+)\s*=\s*(-?){NUMBER}\s*(m|deg|rad)?\s*(sin|cos)\s*{NUMBER}\s*(?:hz)?\s*(?:ramp\s*{NUMBER}\s*s?)?\s*"
)
LIKE = 'a file, or like "surge=1sin0.1" (1 m at 0.1 Hz) or "pitch=3degsin0.1"'


def motions_of(given: Sequence[str]) -> SixMotions:
    """Return the sum of motions, each in words or in a file.

    Parameters
    ----------
    given : sequence of str
        Such as "surge=1sin0.1", 1 m sin(2 pi 0.1 Hz t), "pitch=3degcos0.1ramp20", which grows from nothing in 20 s, or the path
        of a file.

    Raises
    ------
    SceneError : what is neither
    """
    found: dict[str, list[signals.Signal]] = {name: [] for name in NAMES}
    for text in given:
        words = WORDS.fullmatch(text.lower())
        if words is None and "=" in text and not os.path.lexists(text):
            raise SceneError(f"A motion must be {LIKE}, but it is {quoted(text)}.")
        if words is None:
            for name, signal in zip(NAMES, _columns(text), strict=True):
                found[name] += signal
        else:
            found[_named(words[1], text)].append(_swing(words, text))
    return SixMotions(**found)


def moved(scene: Scene, given: Sequence[str], t_end: float) -> Scene:
    """Return a scene on the platform that moves as `motions_of` says for t_end [s]; as it is if nothing is given."""
    return platform(scene, motions_of(given), t_end) if given else scene


def read_motions(path: str | PathLike[str]) -> SixMotions:
    """Read the motions of a platform from a file of columns; see the module.

    Parameters
    ----------
    path : str or pathlib.Path

    Raises
    ------
    SceneError : no such file, no such columns, angles without a unit
    """
    return SixMotions(**dict(zip(NAMES, _columns(path), strict=True)))


def _named(name: str, text: str) -> str:
    if name not in NAMES:
        raise SceneError(f"A motion must be one of {', '.join(NAMES)}, but {quoted(text)} is of {quoted(name)}.")
    return name


def _swing(words: re.Match[str], text: str) -> signals.Signal:
    """A sine or a cosine; a cosine starts away from rest."""
    name, sign, amount, unit, function, frequency, ramp = words.groups()
    turns = name in ROTATIONS
    if turns == (unit in (None, "m")):
        need = "deg or rad behind its amplitude, as in pitch=3degsin0.1" if turns else "an amplitude in m"
        raise SceneError(f"The motion {name} must have {need}, but it is {quoted(text)}.")
    try:
        size, hertz, rise = float(sign + amount), float(frequency), float(ramp or 0.0)
    except ValueError:  # such as 1.2.3
        raise SceneError(f"A motion must be {LIKE}, but it is {quoted(text)}.") from None
    phase = 0.5 * math.pi if function == "cos" else 0.0
    return signals.harmonic(0.0, math.radians(size) if unit == "deg" else size, hertz, phase, rise)


def _columns(path: str | PathLike[str]) -> list[list[signals.Signal]]:
    """Signals of surge, sway, heave, roll, pitch and yaw of a file, none where it has no such column."""
    text = read_text(path, "A file of motions", SceneError, errors="replace")
    source = one_line(os.path.basename(os.fspath(path)), NAMED)
    contents = (line.strip(" \t,;#!") for line in text.splitlines())
    lines = [re.split(r"[\s,;]+", content) for content in contents if content]
    first = next((i for i, words in enumerate(lines) if len(words) > 1 and all(map(_is_number, words))), None)
    if first is None:
        raise SceneError(f"A file of motions must have rows of numbers, a time and motions, but {source} has none.")
    width = len(lines[first])
    for number, words in enumerate(lines[first:], 1):
        if len(words) != width or not all(map(_is_number, words)):
            raise SceneError(
                f"Rows of a file of motions must be {width} numbers each, as the first is, but row {number} of {source} is "
                f"{quoted(one_line(' '.join(words), NAMED))}."
            )
    rows = [[float(word) for word in words] for words in lines[first:]]
    places = _places(lines[:first], width, source)
    column, size = places["time"]
    time = [size * row[column] for row in rows]
    found: list[list[signals.Signal]] = []
    for name in NAMES:
        if name not in places:
            found.append([])
            continue
        column, size = places[name]
        found.append([signals.samples(time, [size * row[column] for row in rows])])
    return found


def _places(above: list[list[str]], width: int, source: str) -> dict[str, tuple[int, float]]:
    """Column of the time and of each motion, and its unit in SI."""
    names = next((words for words in reversed(above) if any(_motion(word) for word in words)), None)
    if names is None:
        if width != 1 + len(NAMES):
            raise SceneError(
                f"A file of motions must have names above its columns, or {1 + len(NAMES)} columns, the time and "
                f"{', '.join(NAMES)}, but {source} has {width} without names."
            )
        return {name: (column, 1.0) for column, name in enumerate(("time", *NAMES))}
    units = above[above.index(names) + 1] if above.index(names) + 1 < len(above) else []
    names = re.sub(r"\s+(?=[(\[])", "", " ".join(names)).split()  # units stand apart behind the names
    if len(names) != width:
        raise SceneError(f"A file of motions must have a name above each of {width} columns, but {source} has {len(names)} names.")
    found: dict[str, tuple[int, float]] = {}
    for column, word in enumerate(names):
        name = "time" if re.match(r"time|t\b", word.lower()) else _motion(word)
        if name is None or name in found:
            continue
        found[name] = column, _size(name, word, units[column] if len(units) == width else "", source)
    if "time" not in found:
        raise SceneError(f"A file of motions must have a column of times, but the names of {source} have none.")
    return found


def _size(name: str, word: str, below: str, source: str) -> float:
    """Size in SI of the unit of a column: what stands behind its name in ``word``, or in the line ``below`` the names."""
    behind = re.search(r"[(\[_](.*)", word.lower().strip("\"'").removeprefix("platform_"))
    unit = behind[1].strip("()[]_ ") if behind else ""
    unit = below.lower().strip("()[]_ ") if unit in NONE_GIVEN else unit
    if unit in NONE_GIVEN and name in ROTATIONS:
        raise SceneError(f"Angles of a file of motions must have a unit, (deg) or (rad), but {source} has {quoted(word)}.")
    if unit not in NONE_GIVEN and unit not in UNITS[name]:
        raise SceneError(
            f"The unit of {name} in a file of motions must be one of {', '.join(UNITS[name])}, but {source} has {quoted(unit)}."
        )
    return 1.0 if unit in NONE_GIVEN else UNITS[name][unit]


def _motion(word: str) -> str | None:
    """Motion that a column's name is of: surge, PtfmSurge(m), but neither PtfmRVxi nor PtfmSurgeVel."""
    letters = re.match(r"(?:ptfm|platform_?)?([a-z]+)", word.lower().strip("\"'"))
    return letters[1] if letters and letters[1] in NAMES else None


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
