"""The numbers of a cable that creeps, checked."""

from typing import Any

from anet_lumped.checks import SceneError, check_number, shown

from .polyester import check_polyester
from .working_curves import WorkingCurve

WITHOUT_CREEP: dict[str, Any] = {
    "EA_dynamic": None, "BA_creep": None, "EA_dynamic_per_tension": 0.0, "working_curve": None,
}  # fmt: skip
"""Fields of a cable that does not creep."""


def check_creep(cable: Any, checked: dict[str, Any], owner: str) -> None:
    """Check `EA_dynamic`, `BA_creep`, `EA_dynamic_per_tension` and `working_curve`; write what they become into ``checked``.

    Raises
    ------
    SceneError : some of them without the others, a dynamic stiffness that is no larger than EA, no viscosity at all, or a cable
        that pushes or does not stretch, a tension-strain curve without a working curve or the other way round, or curves of
        polyester that do not go together
    """
    checked["EA_dynamic_per_tension"] = check_number(
        "EA_dynamic_per_tension", cable.EA_dynamic_per_tension, "", owner, sign="non-negative"
    )
    working = cable.working_curve
    if working is not None and not isinstance(working, WorkingCurve):
        raise SceneError(
            f"Argument `working_curve` must be one of anet_lumped.working_curves, but {owner} has working_curve={shown(working)}."
        )
    if working is not None and (cable.EA_dynamic is None or cable.tension_strain is None):
        missing = "`EA_dynamic`" if cable.EA_dynamic is None else "`tension_strain`"
        raise SceneError(
            f"A cable with a `working_curve` must have `tension_strain`, its original curve, and `EA_dynamic`, but {owner} has no "
            f"{missing}."
        )
    if cable.EA_dynamic is None:
        if cable.BA_creep is not None or checked["EA_dynamic_per_tension"]:
            raise SceneError(
                f"Arguments `BA_creep` and `EA_dynamic_per_tension` must come with `EA_dynamic`, but {owner} has none."
            )
        return
    checked["EA_dynamic"] = check_number("EA_dynamic", cable.EA_dynamic, "N", owner, sign="positive")
    if cable.BA_creep is None:
        raise SceneError(f"A cable with `EA_dynamic` must have `BA_creep`, the viscosity of its creep [N·s], but {owner} has none.")
    checked["BA_creep"] = check_number("BA_creep", cable.BA_creep, "N·s", owner, sign="non-negative")
    if working is not None:
        if not checked["BA_creep"]:
            raise SceneError(f"A cable with a `working_curve` must have a positive `BA_creep`, but {owner} has BA_creep=0.")
        fast = checked["EA_dynamic"], checked["EA_dynamic_per_tension"]
        check_polyester(checked["tension_strain"], working, fast, owner)
    elif cable.tension_strain is not None or not checked["EA"] < checked["EA_dynamic"]:
        given = "`tension_strain`" if cable.tension_strain is not None else f"EA={checked['EA']}"
        raise SceneError(
            "Argument `EA_dynamic` must be larger than the EA under a load held for long, and goes with no `tension_strain` "
            f"without a `working_curve`, but {owner} has EA_dynamic={checked['EA_dynamic']} and {given}."
        )
    if cable.compression != "none":
        raise SceneError(
            f'A cable with `EA_dynamic` only pulls, compression="none", but {owner} has compression={shown(cable.compression)}.'
        )
    if not checked["BA_creep"] and not checked.get("BA") and not checked["zeta"]:
        raise SceneError(f"A cable with `EA_dynamic` must have a viscosity, but {owner} has BA_creep=0 and no `BA` or `zeta`.")
