"""The options of a MoorDyn file: what its environment is, and what belongs to MoorDyn's own run.

Names count in any case, as in MoorDyn, which takes the last of an option that comes twice and passes over what it does not know
(MoorDyn2.cpp: readOptionsLine).
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

from anet_lumped.checks import nearest, one_line

from .moordyn_findings import Findings
from .moordyn_rows import WORD, Row, is_number, number_of

# What MoorDyn takes where a deck is silent; of the depth, that of the deepest point.
ENVIRONMENT = {
    "g": 9.80665, "rho": 1025.0, "WtrDpth": math.nan, "kBot": 3e6, "cBot": 3e5, "FrictionCoefficient": 0.0,
    "StatDynFricScale": 1.0, "FricDamp": 200.0,
}  # fmt: skip
HELD = ("g", "rho", "WtrDpth", "kBot", "cBot", "FrictionCoefficient", "SeafloorFile", "MU_KT", "MU_KA")  # by the scene
FRICTIONS = ("MU_KT", "MU_KA")  # of MoorDyn's Fortran version, across a line and along it, each 0 where a file is silent
FLOW = {"WaveKin": 7, "Currents": 5}  # the largest number of each, from 0 on
OWN_RUN = (
    "dtM", "CFL", "tScheme", "dtIC", "TmaxIC", "CdScaleIC", "threshIC", "dtOut", "writeLog", "WriteUnits",
    "UnifyCurrentGrid", "ICgenDynamic", "disableOutput", "disableOutTime", "inertialF", "inertialF_rampT",
    "OutSwitch", "Echo", "fileIC",
)  # fmt: skip
SEAFLOOR = "SeafloorFile"
OLD_NAMES = {
    "gravity": "g", "rhow": "rho", "wtrdnsty": "rho", "depth": "WtrDpth", "waterdepth": "WtrDpth", "kb": "kBot", "cb": "cBot",
    "dt": "dtM", "icdt": "dtIC", "ictmax": "TmaxIC", "icdfac": "CdScaleIC", "icthresh": "threshIC", "cv": "FricDamp",
    "mc": "StatDynFricScale", "gendynamicic": "ICgenDynamic", "icfile": "fileIC",
}  # fmt: skip
OPTIONS = {
    name.lower(): name for name in (*ENVIRONMENT, *FRICTIONS, *FLOW, SEAFLOOR, "dtWave", "waveKin_rampT", "WaterKin", *OWN_RUN)
} | OLD_NAMES
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


def read_options(rows: list[Row], findings: Findings) -> Options:
    """Read the options.

    Parameters
    ----------
    rows : list of Row
    findings : Findings
        Gathers what is refused and what no use is made of.
    """
    found = Options({}, {}, findings)
    for row in rows:
        with findings.refusing():
            _read(row, found)
    _join_frictions(found)
    return found


def _read(row: Row, found: Options) -> None:
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
    if name == "WtrDpth" and not is_number(word):  # of MoorDyn's Fortran version
        name = SEAFLOOR
    is_number_needed = name in (*ENVIRONMENT, *FRICTIONS)
    value = row.number(0, name) if is_number_needed else _value(word)
    if is_number_needed and isinstance(value, float) and value < 0.0 and name != "WtrDpth":  # whatever is held is deeper
        raise row.error(f"{name} must not be negative.")
    if name == "WaterKin":
        value = _water_file(word, row)
    if name in FLOW and not (isinstance(value, float) and value in range(FLOW[name] + 1)):
        raise row.error(f"{name} must be an integer from 0 to {FLOW[name]}.")
    if name in found.rows:
        findings.remark(
            f"{name} is given on lines {found.rows[name].line} and {row.line}; the last one counts, as in MoorDyn: {word}."
        )
    if name in OWN_RUN:
        findings.unused(name, row.line, "options of MoorDyn's own run")
    found.rows[name], found.values[name] = row, value


def _join_frictions(found: Options) -> None:
    """Put the frictions of the Fortran version into FrictionCoefficient where they are alike."""
    across, along = (found.values.get(name, 0.0) for name in FRICTIONS)
    if across != along and "FrictionCoefficient" not in found.rows:
        return
    if across and "FrictionCoefficient" not in found.rows:
        found.rows["FrictionCoefficient"], found.values["FrictionCoefficient"] = found.rows["MU_KT"], across
    for name in FRICTIONS:
        found.values.pop(name, None)


def _water_file(word: str, row: Row) -> str:
    """Name of the file of waves and currents of the Fortran version, "" for none: a flow from outside that nobody gives is none."""
    if word.lower() == FROM_OUTSIDE:
        row.findings.remark(
            f"Line {row.line}: WaterKin {word} is a flow that the program gives which calls MoorDyn. None is given: "
            "the water is still."
        )
    return "" if number_of(word) == 0.0 or word.lower() in (*NOTHING, FROM_OUTSIDE) else word


def _value(word: str) -> float | str:
    return number_of(word) if is_number(word) else word


def without_held(options: Options) -> Mapping[str, float | str]:
    """What the options say and a scene does not hold."""
    return {name: value for name, value in options.values.items() if name not in HELD}
