"""Arguments and options that several commands of the program share."""

import tempfile
from pathlib import Path
from typing import Annotated

import typer

from studies.quantities import metres, newton_metre_seconds, seconds, vector_in_metres

Scene = Annotated[
    str, typer.Argument(metavar="SCENE", help="A TOML or MoorDyn file (.txt, .dat), or a scene that comes with this by name.")
]


def folder(out):
    """The folder for results, made and tried before anything is computed for it."""
    if out is not None:
        try:
            out.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=out):
                pass
        except OSError as error:
            raise typer.BadParameter(f"must be a folder that can be written, but {out}: {error.strerror}.") from None
    return out


Out = Annotated[Path | None, typer.Option(help="Folder for the results.", callback=folder)]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables (SI units).")]
Audit = Annotated[bool, typer.Option("--audit", help="Run again with half the step, and estimate the error.")]
Whole = Annotated[bool, typer.Option("--all", help="Print long tables in full.")]
TIME = {"parser": seconds, "metavar": "TIME"}
LENGTH = {"parser": metres, "metavar": "LENGTH"}
PLACE = {"parser": vector_in_metres, "metavar": "X,Y,Z"}
DAMPER = {"parser": newton_metre_seconds, "metavar": "DAMPER"}
Method = Annotated[str | None, typer.Option(help="verlet, edmc, ...; chosen for you if not given.")]
Step = Annotated[float | None, typer.Option(help="Step, as in 10ms or 0.01 (s); chosen for you if not given.", **TIME)]
Start = Annotated[str, typer.Option(help="equilibrium, calm (a rest without turbulence and waves) or straight.")]
At = Annotated[str | None, typer.Option(help="The free point whose position counts; all if not given.")]
Tension = Annotated[str | None, typer.Option(metavar="CABLE", help="The cable whose tension counts instead.")]
Changes = Annotated[
    list[str],
    typer.Option("--set", metavar="NAME=VALUE", help="Change the scene first: p0.mass=0.05, diameter=2mm, a.length=sag:1cm."),
]
Move = Annotated[
    list[str],
    typer.Option(
        "--move", metavar="MOTION", help="Move the platform: surge=1sin0.1ramp20 (m, Hz; grows in 20 s), pitch=3degsin0.1, six.csv."
    ),
]
Quick = Annotated[bool, typer.Option("--quick", help="A first look: the same from less work.")]
Full = Annotated[
    bool, typer.Option("--full", help="All of every study, the long ones too, which takes about a quarter of an hour.")
]
