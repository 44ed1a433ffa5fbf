"""The numbers of a cable that creeps, checked."""

from typing import Any

from anet_lumped.checks import SceneError, check_number, shown

WITHOUT_CREEP: dict[str, Any] = {"EA_dynamic": None, "BA_creep": None, "EA_dynamic_per_tension": 0.0}
"""Fields of a cable that does not creep."""


def check_creep(cable: Any, checked: dict[str, Any], owner: str) -> None:
    """Check `EA_dynamic`, `BA_creep` and `EA_dynamic_per_tension` of a cable; write what they become into ``checked``.

    Raises
    ------
    SceneError : some of them without the others, a dynamic stiffness that is no larger than EA, no viscosity at all, or a cable
        that pushes, does not stretch or has a tension-strain curve
    """
    checked["EA_dynamic_per_tension"] = check_number(
        "EA_dynamic_per_tension", cable.EA_dynamic_per_tension, "", owner, sign="non-negative"
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
    if cable.tension_strain is not None or not checked["EA"] < checked["EA_dynamic"]:
        given = "`tension_strain`" if cable.tension_strain is not None else f"EA={checked['EA']}"
        raise SceneError(
            "Argument `EA_dynamic` must be larger than the EA under a load held for long, and goes with no `tension_strain`, but "
            f"{owner} has EA_dynamic={checked['EA_dynamic']} and {given}."
        )
    if cable.compression != "none":
        raise SceneError(
            f'A cable with `EA_dynamic` only pulls, compression="none", but {owner} has compression={shown(cable.compression)}.'
        )
    if not checked["BA_creep"] and not checked.get("BA") and not checked["zeta"]:
        raise SceneError(f"A cable with `EA_dynamic` must have a viscosity, but {owner} has BA_creep=0 and no `BA` or `zeta`.")
