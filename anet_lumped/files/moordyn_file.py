"""MoorDyn's input file → Scene: the decks of the mooring field run here as they stand.

What a deck says, and what it means here (MoorDyn v2's documentation, "Input Files"; its source, Line.cpp and MoorDyn2.cpp):

* line types: `Diam` (volume-equivalent) is the cable's diameter, `Mass/m` its mass_per_length, `EA` and `EI` its stiffness;
  an `EA` that is the name of a file is its tension_strain, rows of a strain and a tension below lines of names and units;
  `BA/-zeta` its BA [N·s], or its zeta where it is negative, because MoorDyn's c = zeta·L0·√(E·rho) times the area is
  zeta·L0·√(EA·mu); `Cd`, `Ca` are Cdn, Can, on d·L0 and on the displaced mass; `CdAx`, `CaAx` are Cdt, Cat, on π·d·L0 and on
  the displaced mass. A spring cannot push but its damper always acts: compression="damped";
* points: `Fixed`; `Free` with its mass, volume, CdA and Ca; `Coupled`, driven from outside in MoorDyn, stays where it is
  unless it is given a path;
* lines: their unstretched length (less than 0: a multiple of the distance between its ends) in equal segments;
* options: `g` is Gravity, `rho` is Water (none for 0), `WtrDpth`, `kBot`, `cBot` and `FrictionCoefficient` are Ground (none if
  `kBot` and `cBot` are 0), and an `EI` brings Bending. Values that are left out are MoorDyn's.

MoorDyn v1's columns and headings are read too. Anything else is an error that says where it stands: rods, bodies, failures,
controls, external loads, waves and currents, tables in place of other numbers, line lift (VIV).
"""

import math
import os
import pathlib
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from anet_lumped.checks import NAMED, InputError, SceneError, nearest, one_line, quoted, shown
from anet_lumped.prescribed.paths import Path
from anet_lumped.regular_files import read_text
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, Scene

from .moordyn_rows import DIGITS, WORD, Row, rows_by_section

POINTS = {
    "fixed": ("fixed", "fix", "anchor"),
    "coupled": ("coupled", "cpld", "vessel", "ves", "fairlead"),
    "free": ("free", "connect", "con", "point"),
}
WITHOUT_MEANING = ("rod types", "rods", "bodies", "failure", "control", "external loads")

# What MoorDyn takes where a deck is silent; of the depth, that of the deepest point.
ENVIRONMENT = {
    "g": 9.80665, "rho": 1025.0, "WtrDpth": math.nan, "kBot": 3e6, "cBot": 3e5, "FrictionCoefficient": 0.0,
    "StatDynFricScale": 1.0, "FricDamp": 200.0,
}  # fmt: skip
HELD = ("g", "rho", "WtrDpth", "kBot", "cBot", "FrictionCoefficient")  # by the scene
MUST_BE_ZERO = {
    "WaveKin": "waves are", "Currents": "currents are", "WaterKin": "waves and currents are",
    "SeafloorFile": "a bottom that is not flat is", "MU_KT": "friction that differs along and across a line is",
    "MU_KA": "friction that differs along and across a line is",
}  # fmt: skip
OWN_RUN = (
    "dtM", "CFL", "tScheme", "dtIC", "TmaxIC", "CdScaleIC", "threshIC", "dtOut", "writeLog", "WriteUnits", "dtWave",
    "waveKin_rampT", "UnifyCurrentGrid", "ICgenDynamic", "disableOutput", "disableOutTime", "inertialF", "inertialF_rampT",
    "OutSwitch",
)  # fmt: skip
OLD_NAMES = {
    "gravity": "g", "rhow": "rho", "wtrdnsty": "rho", "depth": "WtrDpth", "kb": "kBot", "cb": "cBot", "dt": "dtM",
    "icdt": "dtIC", "ictmax": "TmaxIC", "icdfac": "CdScaleIC", "icthresh": "threshIC", "cv": "FricDamp",
    "mc": "StatDynFricScale",
}  # fmt: skip
OPTIONS = {name.lower(): name for name in (*ENVIRONMENT, *MUST_BE_ZERO, *OWN_RUN)} | OLD_NAMES


@dataclass(frozen=True)
class Deck:
    """What a MoorDyn input file says.

    Parameters
    ----------
    scene : Scene
    options : dict of option to number or word
        What it says and the scene does not hold, under MoorDyn's names of today: `dtM` and `dtOut`, the steps of its integrator
        and of its output [s], `TmaxIC`, how long it may look for rest [s], `tScheme`, `FricDamp`, ...; only what is given.
    """

    scene: Scene
    options: dict[str, float | str] = field(default_factory=dict)


def read_moordyn(path: str | pathlib.Path, coupled: dict[int, Path] | None = None, *, outside: bool = False) -> Deck:
    """Read a MoorDyn input file (v2, or v1).

    Point 3 is called "point3" and line 2 "line2", unless a remark `! name: "..."` on its row says otherwise.

    Parameters
    ----------
    path : str or pathlib.Path
    coupled : dict of point number to Path
        Motions of coupled points, from `paths.line`, `samples` or `harmonic`; those without one are Fixed.
    outside : bool
        Whether tables that the deck names may be outside its folder.

    Returns
    -------
    Deck

    Raises
    ------
    SceneError : no such file, or something in it that is wrong or has no counterpart here; names the file, the line and what
        it says
    """
    text = read_text(path, "A MoorDyn file", SceneError, errors="replace")
    path = pathlib.Path(path)
    return deck_from_text(text, one_line(path.name, NAMED), coupled, path.parent, outside=outside)


def deck_from_text(
    text: str,
    source: str = "deck",
    coupled: dict[int, Path] | None = None,
    folder: str | pathlib.Path = ".",
    *,
    outside: bool = False,
) -> Deck:
    """Return what the text of a MoorDyn input file says; as `read_moordyn`.

    `source` is its name for messages, `folder` where the tables are that it names.
    """
    sections = rows_by_section(text, source)
    for section in WITHOUT_MEANING:
        for row in sections.get(section, ()):
            raise row.error(f"{section.upper()} are not supported.")
    for section in ("line types", "points", "lines"):
        if not sections.get(section):
            raise SceneError(f"{source}: a MoorDyn file must have a section {section.upper()}, but this has none.")
    options = _options(sections.get("options", []))
    types = _types(sections["line types"], Tables(folder, outside))
    points, places = _points(sections["points"], coupled or {}, source)
    cables = [_cable(row, types, places) for row in sections["lines"]]
    _check_unique([(row, cable.name) for row, cable in zip(sections["lines"], cables, strict=True)], "line")
    effects = _effects(options, types, sections["lines"], places, source)
    try:
        scene = Scene(list(points.values()), cables, effects)
    except ValueError as error:
        raise SceneError(f"{source}: {error}") from None
    return Deck(scene, {name: value for name, (_, value) in options.items() if name not in HELD})


class Tables(NamedTuple):
    """Where the tables are that a deck names.

    Parameters
    ----------
    folder : of the deck
    outside : whether they may be outside it
    """

    folder: str | pathlib.Path
    outside: bool

    def path(self, row: Row, name: str) -> pathlib.Path:
        """Path of a table by its name in a row."""
        path = pathlib.Path(self.folder) / name
        try:
            inside = pathlib.Path(os.path.realpath(path)).is_relative_to(os.path.realpath(self.folder))
        except ValueError:  # a character that no path may have
            raise row.error(f"EA must be a number or the name of a file, but is {shown(name)}.") from None
        if not (inside or self.outside):
            raise row.error(
                f"a table must be in the folder of its deck, but {quoted(name)} leads out of it; "
                "read_moordyn(..., outside=True) allows that."
            )
        return path


def _options(rows: list[Row]) -> dict[str, tuple[Row, float | str]]:
    """Row and value of each option given, by its name of today."""
    found: dict[str, tuple[Row, float | str]] = {}
    for row in rows:
        if len(row.words) < 2:
            raise row.error("an option must be a value and a name.")
        word, key = row.words[:2]
        name = OPTIONS.get(key.lower())
        if name is None:
            raise row.error(f"unknown option {one_line(key, WORD)}" + (nearest(key.lower(), OPTIONS) or "."))
        if name in found:
            raise row.error(f"an option must be given once, but {name} is given before.")
        value = row.number(0, name) if name in ENVIRONMENT else _value(word)
        found[name] = row, value
        if name in MUST_BE_ZERO and value != 0.0:
            raise row.error(f"{MUST_BE_ZERO[name]} not supported; {name} must be 0.")
        if name in ENVIRONMENT and isinstance(value, float) and value < 0.0:
            raise row.error(f"{name} must not be negative.")
    return found


def _types(rows: list[Row], tables: Tables) -> dict[str, tuple[Row, dict[str, Any]]]:
    """Row and cable fields of each line type, by name."""
    _check_unique([(row, row.words[0]) for row in rows], "line type")
    return {row.words[0]: (row, _type(row, tables)) for row in rows}


def _curve(row: Row, path: pathlib.Path) -> tuple[tuple[float, float], ...]:
    """Rows (strain, tension [N]) of a file, below those that begin with no number."""
    try:
        text = read_text(path, "It", errors="replace")
    except InputError as error:
        raise row.error(f"EA must be a number or the name of a readable file, but {one_line(path.name, WORD)}: {error}") from None
    lines = [line.split() for line in text.splitlines() if line.strip()]
    first = next((i for i, words in enumerate(lines) if _is_number(words[0])), len(lines))
    for words in lines[first:]:
        if len(words) < 2 or not all(map(_is_number, words[:2])):
            given = quoted(" ".join(words))
            raise row.error(f"rows of {one_line(str(path), NAMED)} must be a strain and a tension, but one is {given}.")
    return tuple((float(strain), float(tension)) for strain, tension, *_ in lines[first:])


def _type(row: Row, tables: Tables) -> dict[str, Any]:
    first = len(row.words) == 9 and "cdn" in row.columns  # v1: Diam Mass/m EA BA Can Cat Cdn Cdt
    if not (first or 10 <= len(row.words) <= 13):
        raise row.error(
            f"a line type must have 10 columns (name, Diam, Mass/m, EA, BA/-zeta, EI, Cd, Ca, CdAx, CaAx) and up to 3 more "
            f"(Cl, dF, cF), but has {len(row.words)}."
        )
    for column, what in ((3, "EA"), (4, "BA/-zeta")) if first else ((3, "EA"), (4, "BA/-zeta"), (5, "EI")):
        if "|" in row.words[column]:
            raise row.error(
                f"{what} must be one number; {one_line(row.words[column], WORD)}, a viscoelastic line, is not supported."
            )
        if what != "EA" and not _is_number(row.words[column]):
            raise row.error(f"{what} must be a number; {one_line(row.words[column], WORD)}, a table in a file, is not supported.")
    if len(row.words) > 10 and row.number(10, "Cl") != 0.0:
        raise row.error("vortex-induced vibration is not supported; Cl must be 0.")
    damping = row.number(4, "BA/-zeta")
    fields: dict[str, Any] = {"diameter": row.number(1, "Diam"), "mass_per_length": row.number(2, "Mass/m")}
    stretches = row.words[3]
    fields |= {"EA": row.number(3, "EA")} if _is_number(stretches) else {"tension_strain": _curve(row, tables.path(row, stretches))}
    fields |= {"zeta": -damping} if damping <= 0.0 else {"BA": damping}
    names = ("Can", "Cat", "Cdn", "Cdt") if first else ("EI", "Cdn", "Can", "Cdt", "Cat")
    return fields | {name: row.number(column, name) for column, name in enumerate(names, start=5)}


def _points(rows: list[Row], coupled: dict[int, Path], source: str) -> tuple[dict[int, Any], dict[int, tuple]]:
    """Points, and the name and the start of each, by number."""
    numbers = [row.count(0, "the number of a point") for row in rows]
    _check_unique(list(zip(rows, numbers, strict=True)), "point")
    kinds = dict(zip(numbers, map(_kind, rows), strict=True))
    for number in coupled:
        if kinds.get(number) != "coupled":
            given = ", ".join(str(each) for each, kind in kinds.items() if kind == "coupled") or "none"
            raise SceneError(f"Argument `coupled` must name coupled points of {source} ({given}), but names {shown(number)}.")
    points, places = {}, {}
    for row, number in zip(rows, numbers, strict=True):
        name, at = row.name or f"point{number}", tuple(row.number(2 + x, "XYZ"[x]) for x in range(3))
        columns = ((5, "M", "mass"), (6, "V", "volume"), (-2, "CdA", "CdA"), (-1, "CA", "Ca"))
        load = {key: row.number(column, what) for column, what, key in columns}
        if kinds[number] == "free":
            points[number] = _made(row, Free, name, at=at, **load)
        elif number in coupled:
            points[number] = _made(row, Driven, name, coupled[number])
            at = tuple(coupled[number].at(0.0)[0].tolist())
        else:
            points[number] = _made(row, Fixed, name, at)
        places[number] = name, at
    _check_unique([(row, points[number].name) for row, number in zip(rows, numbers, strict=True)], "point")
    return points, places


def _kind(row: Row) -> str:
    """Whether a point is fixed, coupled or free, once its row is found to be in order."""
    if len(row.words) not in (9, 12):
        raise row.error(
            "a point must have 9 columns (ID, type, X, Y, Z, M, V, CdA, CA), or 12 with FX, FY, FZ before CdA, but has "
            f"{len(row.words)}."
        )
    if len(row.words) == 12 and any(row.number(column, "a steady force") for column in (7, 8, 9)):
        raise row.error("a steady force on a point (FX, FY, FZ) is not supported; it must be 0.")
    word = row.words[1].lower()
    if word.startswith(("body", "turbine")):
        raise row.error(f"points on a body are not supported; point {row.words[0]} is on {one_line(row.words[1], WORD)}.")
    for kind, words in POINTS.items():
        if word in words:
            return kind
    hint = nearest(word, sum(POINTS.values(), ())) or "."
    raise row.error(f"the type of a point must be Fixed, Coupled or Free{hint}")


def _cable(row: Row, types: dict, places: dict) -> Cable:
    if len(row.words) != 7:
        raise row.error(f"a line must have 7 columns (ID, type, A, B, UnstrLen, NumSegs, outputs), but has {len(row.words)}.")
    first = len(row.columns) > 2 and row.columns[2].startswith("unstr")  # v1: ID type UnstrLen NumSegs A B outputs
    at_a, at_b, at_length, at_segments = (4, 5, 2, 3) if first else (2, 3, 4, 5)
    kind = row.words[1]
    if kind not in types:
        hint = nearest(kind, types) or f"; known: {', '.join(types)}."
        raise row.error(f"a line must be of a type in LINE TYPES, but {quoted(kind)} is none{hint}")
    ends = [_end(row, column, places) for column in (at_a, at_b)]
    length = row.number(at_length, "UnstrLen")
    if length < 0.0:  # MoorDyn's Line::initialize
        length = -length * math.dist(*(places[end][1] for end in ends))
    return _made(
        row, Cable, *(places[end][0] for end in ends), name=row.name or f"line{row.count(0, 'the number of a line')}",
        length=length, segments=row.count(at_segments, "NumSegs"), compression="damped", **types[kind][1],
    )  # fmt: skip


def _end(row: Row, column: int, places: dict) -> int:
    """Number of the point at an end of a line: 3, P3, Point3, C3 or Con3."""
    word = row.words[column]
    letters = word.rstrip("0123456789")
    number = word[len(letters) :]
    if letters.lower() in ("", "c", "con", "p", "point") and number:
        if len(number) <= DIGITS and int(number) in places:
            return int(number)
        known = ", ".join(map(str, places))
        raise row.error(f"a line must end at a point in POINTS, but point {one_line(word, WORD)} is not there; known: {known}.")
    if word.lower().startswith("r"):
        raise row.error(f"lines that end at a rod are not supported, but {one_line(word, WORD)} is one.")
    raise row.error(f"a line must end at the number of a point, but {one_line(word, WORD)} is none.")


def _effects(options: dict, types: dict, lines: list[Row], places: dict, source: str) -> list[Any]:
    """Gravity, water, bottom and bending, as far as the deck has them."""

    def value(name: str) -> Any:
        return options[name][1] if name in options else ENVIRONMENT[name]

    def said(*names: str) -> Row:
        """Where and how the deck asks for it, for messages."""
        rows = [options[name][0] for name in names if name in options]
        first = f"{names[0]}={ENVIRONMENT[names[0]]:g}"
        return rows[0] if rows else Row(f"{source}, OPTIONS", f"{first}, MoorDyn's default", (), (), None)

    effects = [_effect("gravity", said("g"), g=value("g"))] if value("g") else []
    if value("rho"):
        effects.append(_effect("water", said("rho"), density=value("rho")))
    if value("kBot") or value("cBot"):
        depth = options["WtrDpth"][1] if "WtrDpth" in options else max(0.0, *(-at[2] for _, at in places.values()))
        friction = value("FrictionCoefficient")
        if friction and value("StatDynFricScale") != 1.0:
            raise said("StatDynFricScale").error("static friction that differs from dynamic is not supported; it must be 1.")
        bottom = {"height": -depth, "stiffness": value("kBot"), "damping": value("cBot"), "friction": friction}
        effects.append(_effect("ground", said("kBot", "cBot"), **bottom))
    stiff = [types[row.words[1]] for row in lines if types[row.words[1]][1].get("EI")]
    if stiff:
        effects.append(_effect("bending", stiff[0][0]))
    return effects


def _effect(name: str, row: Row, **arguments: float) -> Any:
    from anet_lumped.effects import REGISTRY

    return _made(row, REGISTRY[name], **arguments)


def _made(row: Row, maker: Any, *arguments: Any, **fields: Any) -> Any:
    """Call `maker`; what it refuses is said with the row."""
    try:
        return maker(*arguments, **fields)
    except ValueError as error:
        raise row.error(str(error)) from None


def _check_unique(rows: list[tuple[Row, Any]], what: str) -> None:
    seen = set()
    for row, name in rows:
        if name in seen:
            raise row.error(f"a {what} must come once, but {one_line(str(name), WORD)} comes again.")
        seen.add(name)


def _value(word: str) -> float | str:
    return float(word) if _is_number(word) else word


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
