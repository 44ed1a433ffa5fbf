"""Vortices that the lines of a MoorDyn file shed, its vortex-induced vibration: `Cl`, `dF` and `cF` of a line type.

They are a cable's Cl, St_range and St; where a file is silent, MoorDyn takes 0, 0.08 and 0.18. Its mean squares are those of 500
steps dtM, so that its lines vibrate otherwise with another step; here they are those of ten periods of the vortices, or with
``like_moordyn`` of 500 dtM (MoorDyn's documentation, "Line Types"; its source Line.cpp).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from anet_lumped.checks import one_line
from anet_lumped.scene.scene import Cable

from .moordyn_findings import Findings
from .moordyn_lines import Line
from .moordyn_options import Options
from .moordyn_rows import WORD, Row

WINDOW_STEPS = 500  # dtM in which MoorDyn's mean squares forget
FIRST = 10  # column of Cl; dF and cF follow
DEFAULTS: Mapping[str, float] = {"Cl": 0.0, "St_range": 0.08, "St": 0.18}
COLUMNS = ("Cl", "dF", "cF")


def shedding_fields(row: Row) -> dict[str, Any]:
    """Cable fields of the last three columns of a line type, as far as it has them; none where Cl is 0."""
    given = {
        name: row.number(FIRST + k, column)
        for k, (name, column) in enumerate(zip(DEFAULTS, COLUMNS, strict=True))
        if len(row.words) > FIRST + k
    }
    if not given.get("Cl"):
        return {}
    called = row.columns[FIRST] if len(row.columns) > FIRST else "cl"
    if called != "cl":
        row.findings.remark(
            f"Line {row.line}: column {FIRST + 1} is read as Cl, as MoorDyn does, though the file calls it "
            f"{one_line(called, WORD)}."
        )
    return dict(DEFAULTS) | given


def with_windows(lines: list[Line], options: Options, findings: Findings, like_moordyn: bool) -> list[Line]:
    """The lines, of which those that shed vortices have the window of their mean squares."""
    shedding = [line.cable.name for line in lines if line.cable.Cl]
    if not shedding:
        return lines
    dtM = options.values.get("dtM")
    if not (like_moordyn and isinstance(dtM, float) and dtM > 0.0):
        findings.remark(
            f"Vortices shake {', '.join(shedding)}. Vibrations are known by their mean squares over 10 periods of the vortices, "
            f"where MoorDyn takes {WINDOW_STEPS} dtM"
            + ("; read_moordyn(..., like_moordyn=True) takes them." if not like_moordyn else ", and the file gives no dtM.")
        )
        return lines
    return [
        line._replace(cable=replace(line.cable, shedding_window=WINDOW_STEPS * dtM)) if line.cable.Cl else line for line in lines
    ]


def shedding_columns(cables: Sequence[Cable], cable: Cable) -> tuple[float, ...]:
    """Columns Cl, dF and cF of a cable; none where no cable of the scene sheds vortices."""
    if not any(one.Cl for one in cables):
        return ()
    return cable.Cl, cable.St_range, cable.St
