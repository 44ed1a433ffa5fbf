"""Polyester lines of a MoorDyn file, of the Syrope model: a working curve and an original curve in place of an `EA`.

`EA` is `SYROPE:file|EA_dynamic|EA_dynamic_per_tension`. The file has a value and a name on each line: OWC, the file of the original
curve, beside the deck; WCType, LINEAR, QUADRATIC or EXP; k1, the `permanent` share (of LINEAR, from 1 on, the EA [N]); k2, bend.
The section SYROPE IC has Tmax0 and Tmean0 of lines. Tmax0 is the `T_max` of the working curve; a run starts from a rest or from a
State of its own, which says the tensions, so that no use is made of Tmean0 (MoorDyn's documentation, "Syrope Model for Polyester
Lines").
"""

from typing import Any, NamedTuple

from anet_lumped.checks import InputError, one_line
from anet_lumped.regular_files import read_text
from anet_lumped.scene import working_curves
from anet_lumped.scene.working_curves import WorkingCurve

from .moordyn_findings import Findings
from .moordyn_rows import WORD, Row, is_number, made, number_of, unreadable

PREFIX, NAMES = "SYROPE:", ("OWC", "WCTYPE", "K1", "K2")
STIFFNESS_FROM = 1.0  # from here on k1 of LINEAR is no share but a stiffness [N]
COLUMNS = 3  # of SYROPE IC: line or lines, Tmax0, Tmean0


class SyropeFile(NamedTuple):
    """What the file of a Syrope model says: the name of the file of the original curve, and the working curve, for T_max=0."""

    original: str
    working: WorkingCurve


def is_syrope(word: str) -> bool:
    """Whether an `EA` names a Syrope model."""
    return word.upper().startswith(PREFIX)


def syrope_numbers(row: Row) -> tuple[str, list[float], list[float]]:
    """Name of the file in `EA`, the two numbers behind it, and the numbers of `BA/-zeta`."""
    file, *words = row.words[3][len(PREFIX) :].split("|")
    dampers = row.words[4].split("|")
    if len(words) != 2 or not all(map(is_number, words)) or not file:
        raise row.error("EA of a Syrope model must be SYROPE:file|EA_Dc|EA_D_Lm, a file and two numbers.")
    if len(dampers) != 2 or not all(map(is_number, dampers)) or min(map(number_of, dampers)) < 0.0:
        raise row.error("BA/-zeta of a Syrope model must be BA_s|BA_d, two numbers that are not negative.")
    return file, [number_of(word) for word in words], [number_of(word) for word in dampers]


def read_syrope_file(row: Row, path: Any) -> SyropeFile:
    """Read the file of a Syrope model, named in a row."""
    try:
        text = read_text(path, "It", errors="replace")
    except InputError as error:
        raise row.error(f"a Syrope model must name a readable file, but {unreadable(path, error)}") from None
    lines = [line.split() for line in text.splitlines() if line.strip()]
    found = {words[1].upper(): words[0] for words in lines if len(words) > 1 and words[1].upper() in NAMES}
    for name in NAMES:
        if name not in found:
            raise row.error(
                f"the file of a Syrope model must say OWC, WCType, k1 and k2, but {one_line(path.name, WORD)} lacks {name}."
            )
    kind, words = found["WCTYPE"].upper(), (found["K1"], found["K2"])
    if not all(map(is_number, words)):
        raise row.error(f"k1 and k2 of a Syrope model must be numbers, but are {one_line(' and '.join(words), WORD)}.")
    k1, k2 = map(number_of, words)
    if kind == "LINEAR":
        of_line = {"EA": k1} if k1 >= STIFFNESS_FROM else {"permanent": k1}
        return SyropeFile(found["OWC"], made(row, working_curves.Linear, **of_line))
    if kind not in ("QUADRATIC", "EXP"):
        raise row.error(f"WCType of a Syrope model must be LINEAR, QUADRATIC or EXP, but is {one_line(kind, WORD)}.")
    maker = working_curves.Quadratic if kind == "QUADRATIC" else working_curves.Exponential
    return SyropeFile(found["OWC"], made(row, maker, permanent=k1, bend=k2))


def read_largest_tensions(rows: list[Row], findings: Findings) -> dict[str, float]:
    """T_max [N] by the words that the section SYROPE IC has for lines."""
    found: dict[str, float] = {}
    for row in rows:
        with findings.refusing():
            if len(row.words) < COLUMNS:
                raise row.error(
                    f"a row of SYROPE IC must have {COLUMNS} columns (Line(s), Tmax0, Tmean0), but has {len(row.words)}."
                )
            T_max = row.number(1, "Tmax0")
            row.number(2, "Tmean0")
            for word in filter(None, row.words[0].split(",")):
                found[word] = T_max
            findings.unused("Tmean0", row.line, "mean tensions at the start, which statics find")
    return found
