"""The line types of a MoorDyn file: the cable fields that lines of one type share.

`Diam` (volume-equivalent) is the cable's diameter, `Mass/m` its mass_per_length, `EA` and `EI` its stiffness; an `EA` that is the
name of a file is its tension_strain, rows of a strain and a tension below lines of names and units, and an `EI` that is one is a
curve of the effect `MomentCurvature`, rows of a curvature and a moment. `BA/-zeta` is its BA [N·s], or
its zeta where it is negative, because MoorDyn's c = zeta·L0·√(E·rho) times the area is zeta·L0·√(EA·mu). `Cd`, `Ca` are Cdn, Can,
on d·L0 and on the displaced mass; `CdAx`, `CaAx` are Cdt, Cat, on π·d·L0 and on the displaced mass. Columns count by their place,
as in MoorDyn, whatever their names.

A viscoelastic line has its EA and its EA_dynamic in `EA`, between bars, and a third number may be EA_dynamic_per_tension;
`BA/-zeta` is its BA_creep (or, where it is negative, the zeta of that and of EA) and its BA. Of polyester see `moordyn_syrope`,
of `Cl`, `dF` and `cF` `moordyn_shedding`.
"""

import os
import pathlib
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from anet_lumped.checks import NAMED, InputError, one_line, quoted, shown
from anet_lumped.regular_files import read_text

from .moordyn_findings import Findings
from .moordyn_rows import WORD, Row, is_number, number_of, unreadable
from .moordyn_shedding import shedding_fields
from .moordyn_syrope import is_syrope, read_syrope_file, syrope_numbers

BAR, MOST_NUMBERS = "|", 3
HEADS = 3  # lines above the numbers of a curve, which MoorDyn passes over
SWAPPED = ("can", "cat", "cdn", "cdt")  # order of the first version, where MoorDyn reads Cd, Ca, CdAx, CaAx


class Tables(NamedTuple):
    """Where the tables are that a deck names.

    Parameters
    ----------
    folder : of the deck
    outside : whether they may be outside it
    """

    folder: str | pathlib.Path
    outside: bool

    def path(self, row: Row, name: str, what: str = "EA") -> pathlib.Path:
        """Path of a table by its name in a row, of what for messages."""
        path = pathlib.Path(self.folder) / name
        try:
            inside = pathlib.Path(os.path.realpath(path)).is_relative_to(os.path.realpath(self.folder))
        except ValueError:  # a character that no path may have
            raise row.error(f"{what} must be a number or the name of a file, but is {shown(name)}.") from None
        if not (inside or self.outside):
            raise row.error(
                f"a table must be in the folder of its deck, but {quoted(name)} leads out of it; "
                "read_moordyn(..., outside=True) allows that."
            )
        return path


def read_line_types(rows: list[Row], used: set[str], tables: Tables, findings: Findings) -> dict[str, tuple[Row, dict[str, Any]]]:
    """Row and cable fields of each line type that is in order, by name.

    Parameters
    ----------
    rows : list of Row
    used : set of str
        Names of the types that lines have; of others no use is made, whatever they say.
    tables : Tables
    findings : Findings
    """
    types: dict[str, tuple[Row, dict[str, Any]]] = {}
    last = {row.words[0]: row for row in rows}
    for row in rows:
        name = row.words[0]
        with findings.refusing():
            if row is not last[name]:
                findings.remark(
                    f"Line type {one_line(name, WORD)} is given on lines {row.line} and {last[name].line}; the last one counts, "
                    "as in MoorDyn."
                )
            elif name in used:
                types[name] = row, _type(row, tables)
            else:
                findings.unused(one_line(name, WORD), row.line, "line types that no line has")
    return types


def _type(row: Row, tables: Tables) -> dict[str, Any]:
    """Cable fields of a line type. All columns that are refused are gathered before the last of them is raised."""
    first = len(row.words) == 9 and "cdn" in row.columns  # v1: Diam Mass/m EA BA Can Cat Cdn Cdt
    if not (first or 10 <= len(row.words) <= 13):
        raise row.error(
            f"a line type must have 10 columns (name, Diam, Mass/m, EA, BA/-zeta, EI, Cd, Ca, CdAx, CaAx) and up to 3 more "
            f"(Cl, dF, cF), but has {len(row.words)}."
        )
    _check_laws(row, first)
    if not first and tuple(row.columns[6:10]) == SWAPPED:
        row.findings.remark(
            f"Line {row.line}: columns 7 to 10 are read as Cd, Ca, CdAx, CaAx, as MoorDyn does, though the file calls them "
            f"{', '.join(SWAPPED)}."
        )
    fields: dict[str, Any] = {"diameter": row.number(1, "Diam"), "mass_per_length": row.number(2, "Mass/m")}
    stretches = row.words[3]
    if is_syrope(stretches):
        fields |= _polyester(row, tables)
    elif BAR in stretches:
        fields |= _creep(row)
    else:
        damping = row.number(4, "BA/-zeta")
        curve = None if is_number(stretches) else _curve(row, tables.path(row, stretches))
        fields |= {"EA": row.number(3, "EA")} if curve is None else {"tension_strain": curve}
        fields |= {"zeta": -damping} if damping <= 0.0 else {"BA": damping}
    names = ("Can", "Cat", "Cdn", "Cdt") if first else ("EI", "Cdn", "Can", "Cdt", "Cat")
    columns = {name: column for column, name in enumerate(names, start=5)}
    if not first and not is_number(row.words[5]):
        del columns["EI"]
    return fields | {name: row.number(column, name) for name, column in columns.items()} | shedding_fields(row)


def _check_laws(row: Row, first: bool) -> None:
    """Refuse laws of stretching, damping and bending that are no number."""
    columns = ((3, "EA"), (4, "BA/-zeta")) if first else ((3, "EA"), (4, "BA/-zeta"), (5, "EI"))  # EA and EI may be tables
    refused = []
    for column, what in columns:
        word = one_line(row.words[column], WORD)
        if is_syrope(row.words[3]) and column < 5:
            continue  # `moordyn_syrope` looks at both
        if BAR in word:
            refused += _wrong_bars(what, word, BAR in row.words[3])
        elif what == "BA/-zeta" and not is_number(row.words[column]):
            refused.append(f"{what} must be a number; from {word}, a table in a file, MoorDyn finds no number for a line at rest")
    if refused:
        raise row.error("; ".join(refused) + ".")


def _wrong_bars(what: str, word: str, creeps: bool) -> list[str]:
    """Why numbers between bars are refused, in a list."""
    numbers, most = word.split(BAR), {"EA": MOST_NUMBERS, "BA/-zeta": 2}.get(what, 1)
    if len(numbers) > most or not all(map(is_number, numbers)):
        return [f"{what} must be {'a number' if most == 1 else f'up to {most} numbers between bars'}, but is {word}"]
    if not creeps:
        return [f"{what} must be one number where EA is, but is {word}"]
    return []


def _creep(row: Row) -> dict[str, Any]:
    """Cable fields of EA_s|EA_d or EA_s|EA_d|slope, and of BA_s|BA_d; a BA_creep below 0 is the opposite of a damping ratio."""
    stiffness, damping = ([number_of(word) for word in row.words[column].split(BAR)] for column in (3, 4))
    fields: dict[str, Any] = {"EA": stiffness[0], "EA_dynamic": stiffness[1], "BA_creep": damping[0]}
    fields["BA"] = damping[1] if len(damping) > 1 else 0.0
    return fields | ({"EA_dynamic_per_tension": stiffness[2]} if len(stiffness) > 2 else {})


def _polyester(row: Row, tables: Tables) -> dict[str, Any]:
    """Cable fields of a Syrope model."""
    file, (EA, per_tension), (BA_creep, BA) = syrope_numbers(row)
    said = read_syrope_file(row, tables.path(row, file))
    path = tables.path(row, said.original, "OWC")
    curve = _curve(row, path)
    lines = read_text(path, "It", errors="replace").splitlines()
    heads = next((i for i, line in enumerate(lines) if line.split() and is_number(line.split()[0])), HEADS)
    if heads < HEADS:
        row.findings.remark(
            f"Line {row.line}: {one_line(path.name, WORD)} has {heads} lines above its numbers, and all of these are read; MoorDyn "
            f"passes over the first {HEADS} lines."
        )
    if curve[:1] != ((0.0, 0.0),):
        raise row.error(
            f"an original curve must begin at the strain 0 and the tension 0, but that of {one_line(path.name, WORD)} does not."
        )
    return {
        "tension_strain": curve, "working_curve": said.working, "EA_dynamic": EA, "EA_dynamic_per_tension": per_tension,
        "BA_creep": BA_creep, "BA": BA,
    }  # fmt: skip


def moment_curves(
    lines: Iterable[tuple[str, str]], types: Mapping[str, tuple[Row, dict[str, Any]]], tables: Tables, findings: Findings
) -> tuple[dict[str, tuple[tuple[float, float], ...]], Row | None]:
    """Rows of a curvature [1/m] and a moment [N m] by the names of the cables of types whose EI is a table, and where one is.

    ``lines`` are the type and the name of each cable.
    """
    found, curves, at = {}, {}, None
    for kind, name in lines:
        row = types[kind][0]
        if curved(row):
            with findings.refusing():
                if kind not in curves:
                    curves[kind] = _curve(row, tables.path(row, row.words[5], "EI"), "EI", "a curvature and a moment")
                found[name], at = curves[kind], row
    return found, at


def curved(row: Row) -> bool:
    """Whether the EI of a line type is a table."""
    return len(row.words) > 9 and not is_number(row.words[5])


def _curve(
    row: Row, path: pathlib.Path, what: str = "EA", columns: str = "a strain and a tension"
) -> tuple[tuple[float, float], ...]:
    """Rows of two numbers of a file, below those that begin with no number."""
    try:
        text = read_text(path, "It", errors="replace")
    except InputError as error:
        raise row.error(f"{what} must be a number or the name of a readable file, but {unreadable(path, error)}") from None
    lines = [line.split() for line in text.splitlines() if line.strip()]
    first = next((i for i, words in enumerate(lines) if is_number(words[0])), len(lines))
    for words in lines[first:]:
        if len(words) < 2 or not all(map(is_number, words[:2])):
            given = quoted(" ".join(words))
            raise row.error(f"rows of {one_line(str(path), NAMED)} must be {columns}, but one is {given}.")
    return tuple((number_of(strain), number_of(tension)) for strain, tension, *_ in lines[first:])
