"""The options of a MoorDyn file: what its environment is, and what belongs to MoorDyn's own run.

Names count in any case, as in MoorDyn, which takes the last of an option that comes twice and passes over what it does not know
(MoorDyn2.cpp: readOptionsLine). What would change the answer and cannot be had here is refused: flow from a file of the Fortran
version, a bottom that is not flat, friction that differs along and across a line.
"""

import math
import os
import pathlib
import re
from collections.abc import Mapping
from typing import NamedTuple

from anet_lumped.checks import InputError, nearest, one_line
from anet_lumped.regular_files import read_text

from .moordyn_findings import Findings
from .moordyn_rows import WORD, Row, is_number, number_of

# What MoorDyn takes where a deck is silent; of the depth, that of the deepest point.
ENVIRONMENT = {
    "g": 9.80665, "rho": 1025.0, "WtrDpth": math.nan, "kBot": 3e6, "cBot": 3e5, "FrictionCoefficient": 0.0,
    "StatDynFricScale": 1.0, "FricDamp": 200.0,
}  # fmt: skip
HELD = ("g", "rho", "WtrDpth", "kBot", "cBot", "FrictionCoefficient")  # by the scene
MUST_BE_ZERO = {
    "WaterKin": "waves and currents by a file of the Fortran version are",
    "SeafloorFile": "a bottom that is not flat is", "MU_KT": "friction that differs along and across a line is",
    "MU_KA": "friction that differs along and across a line is",
}  # fmt: skip
FLOW = {"WaveKin": 7, "Currents": 5}  # the largest number of each, from 0 on
OWN_RUN = (
    "dtM", "CFL", "tScheme", "dtIC", "TmaxIC", "CdScaleIC", "threshIC", "dtOut", "writeLog", "WriteUnits",
    "waveKin_rampT", "UnifyCurrentGrid", "ICgenDynamic", "disableOutput", "disableOutTime", "inertialF", "inertialF_rampT",
    "OutSwitch", "Echo", "fileIC",
)  # fmt: skip
OLD_NAMES = {
    "gravity": "g", "rhow": "rho", "wtrdnsty": "rho", "depth": "WtrDpth", "waterdepth": "WtrDpth", "kb": "kBot", "cb": "cBot",
    "dt": "dtM", "icdt": "dtIC", "ictmax": "TmaxIC", "icdfac": "CdScaleIC", "icthresh": "threshIC", "cv": "FricDamp",
    "mc": "StatDynFricScale", "gendynamicic": "ICgenDynamic", "icfile": "fileIC",
}  # fmt: skip
OPTIONS = {name.lower(): name for name in (*ENVIRONMENT, *MUST_BE_ZERO, *FLOW, "dtWave", *OWN_RUN)} | OLD_NAMES
NOTHING = ("", "-", "none", "null", "false", "f", "no", "unused")  # in place of the name of a file
FROM_OUTSIDE = "seastate"  # in place of the name of a file: flow that the program gives which calls MoorDyn


class Options(NamedTuple):
    """What the options say.

    Parameters
    ----------
    rows : row of each option that is given, by its name of today
    values : number or word of each
    findings : what is to be said of the file
    """

    rows: dict[str, Row]
    values: dict[str, float | str]
    findings: Findings

    def value(self, name: str) -> float:
        """Number of an option of the environment, as given or as MoorDyn takes it."""
        return float(self.values.get(name, ENVIRONMENT[name]))

    def row(self, *names: str) -> Row:
        """Where the first of the options is given; for messages, a row of its own if none is."""
        rows = [self.rows[name] for name in names if name in self.rows]
        return rows[0] if rows else Row(0, f"{names[0]}={ENVIRONMENT[names[0]]:g}, MoorDyn's default", (), (), None, self.findings)


def read_options(rows: list[Row], folder: str | pathlib.Path, findings: Findings) -> Options:
    """Read the options.

    Parameters
    ----------
    rows : list of Row
    folder : str or pathlib.Path
        Where a file of waves and currents is, if there is one.
    findings : Findings
        Gathers what is refused and what no use is made of.
    """
    found = Options({}, {}, findings)
    for row in rows:
        with findings.refusing():
            _read(row, found, folder)
    return found


def _read(row: Row, found: Options, folder: str | pathlib.Path) -> None:
    """Read one row into ``found``."""
    findings = found.findings
    if len(row.words) < 2:
        findings.unused(one_line(row.text, WORD), row.line, "options that are not a value and a name")
        return
    word, key = row.words[0].strip("\"'"), row.words[1]
    name = OPTIONS.get(key.lower())
    if name is None:
        if word.lower() in OPTIONS and is_number(key):
            raise row.error("the value of an option must come before its name.")
        findings.unused(
            one_line(key, WORD) + nearest(key.lower(), OPTIONS).rstrip("?"), row.line, "options that MoorDyn does not have"
        )
        return
    value = row.number(0, name) if name in ENVIRONMENT else _value(word)
    if name in ENVIRONMENT and isinstance(value, float) and value < 0.0:
        raise row.error(f"{name} must not be negative.")
    if name in MUST_BE_ZERO and not _is_nothing(name, word, row, folder):
        raise row.error(f"{MUST_BE_ZERO[name]} not supported; {name} must be 0.")
    if name in FLOW and not (isinstance(value, float) and value in range(FLOW[name] + 1)):
        raise row.error(f"{name} must be an integer from 0 to {FLOW[name]}.")
    if name in found.rows:
        findings.remark(
            f"{name} is given on lines {found.rows[name].line} and {row.line}; the last one counts, as in MoorDyn: {word}."
        )
    if name in OWN_RUN:
        findings.unused(name, row.line, "options of MoorDyn's own run")
    found.rows[name], found.values[name] = row, value


def _is_nothing(name: str, word: str, row: Row, folder: str | pathlib.Path) -> bool:
    """Whether an option asks for no waves, no currents and no such bottom; a flow from outside that nobody gives is none."""
    if number_of(word) == 0.0 or (name in ("WaterKin", "SeafloorFile") and word.lower() in NOTHING):
        return True
    if name == "WaterKin" and word.lower() == FROM_OUTSIDE:
        row.findings.remark(
            f"Line {row.line}: {name} {word} is a flow that the program gives which calls MoorDyn. None is given: "
            "the water is still."
        )
        return True
    if name != "WaterKin":
        return False
    path = pathlib.Path(folder) / word
    try:
        exists = os.path.lexists(path)
    except ValueError:  # a character that no path may have
        exists = False
    if not exists:
        row.findings.remark(
            f"Line {row.line}: WaterKin names a file that is not there, {one_line(word, WORD)}; MoorDyn's C++ version never "
            "reads one. The water is still."
        )
        return True
    return _without_flow(path)


def _without_flow(path: pathlib.Path) -> bool:
    """Whether a file of waves and currents, of MoorDyn's Fortran version, says that there are none."""
    try:
        text = read_text(path, "It", errors="replace")
    except InputError:
        return False
    modes = re.findall(r"^\s*(\S+)\s+(?:WaveKinMod|CurrentMod)\b", text, re.IGNORECASE | re.MULTILINE)
    return bool(modes) and all(number_of(mode) == 0.0 for mode in modes)


def _value(word: str) -> float | str:
    return number_of(word) if is_number(word) else word


def without_held(options: Options) -> Mapping[str, float | str]:
    """What the options say and a scene does not hold."""
    return {name: value for name, value in options.values.items() if name not in HELD}
