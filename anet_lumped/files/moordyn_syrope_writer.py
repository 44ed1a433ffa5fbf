"""Polyester ropes with working curves → the Syrope model of MoorDyn's input file; `moordyn_syrope` reads it."""

from dataclasses import replace
from typing import Any

from anet_lumped.checks import SceneError, quoted
from anet_lumped.scene import working_curves
from anet_lumped.scene.cable import Cable
from anet_lumped.scene.scene import Scene
from anet_lumped.scene.working_curves import WorkingCurve

from .moordyn_syrope import STIFFNESS_FROM

MOST_ROWS = 30  # of a curve that MoorDyn 2.7.2 reads, with that of zeros


def curve_of(cable: Cable) -> tuple[Any, WorkingCurve | None]:
    """What cables of one file of a curve share: the curve, and the working curve of whatever T_max.

    Raises
    ------
    SceneError : more rows than MoorDyn reads, or a slope that it would take for a share
    """
    working, curve = cable.working_curve, cable.tension_strain
    if working is None or curve is None:
        return curve, None
    if len(curve) >= MOST_ROWS:
        raise SceneError(
            f"An original curve must have fewer than {MOST_ROWS} rows to be written for MoorDyn, but that of cable "
            f"{quoted(cable.name)} has {len(curve)}."
        )
    if isinstance(working, working_curves.Linear) and working.EA is not None and working.EA < STIFFNESS_FROM:
        raise SceneError(
            f"The EA of a working curve must be at least {STIFFNESS_FROM:g} N to be written for MoorDyn, but that of cable "
            f"{quoted(cable.name)} is {working.EA}."
        )
    return curve, replace(working, T_max=0.0)  # type: ignore[type-var]  # a frozen dataclass, as all working curves are


def syrope_name(curve: str) -> str:
    """Name of the file of a Syrope model, by that of its original curve."""
    return curve.replace("_curve", "_syrope")


def syrope_text(working: WorkingCurve, curve: str) -> str:
    """Text of the file of a Syrope model, whose original curve is in the file named."""
    kind = {working_curves.Linear: "LINEAR", working_curves.Quadratic: "QUADRATIC"}.get(type(working), "EXP")
    permanent, EA = working.numbers
    k1, k2 = EA or permanent, getattr(working, "bend", 0.0)
    return f"{curve} OWC original curve\n{kind} WCType shape\n{k1!r} k1 first number\n{k2!r} k2 second number"


def syrope_rows(scene: Scene) -> list[str]:
    """Section of the largest tensions held, and of those at rest that the lines begin with; none without such ropes.

    Raises
    ------
    SceneError : no rest
    """
    polyester = [(number, cable) for number, cable in enumerate(scene.cables, start=1) if cable.working_curve is not None]
    if not polyester:
        return []
    from anet_lumped.statics.equilibrium import EquilibriumError, equilibrium

    try:
        rest = equilibrium(scene)
    except EquilibriumError as error:
        raise SceneError(f"A scene with polyester ropes must have a rest to be written for MoorDyn: {error}") from None
    rows = (f"{number} {cable.working_curve.T_max!r} {float(rest.tension(cable.name).mean())!r}" for number, cable in polyester)  # type: ignore[union-attr]
    return ["--------------------- SYROPE IC ---------------------", "Line(s) Tmax0 Tmean0", "(-) (N) (N)", *rows]
