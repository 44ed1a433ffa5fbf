"""The numbers of a cable that sheds vortices in water, checked; `effects.vortex_shedding` is what they do."""

from typing import Any

from anet_lumped.checks import SceneError, check_number


def check_shedding(cable: Any, checked: dict[str, Any], owner: str) -> None:
    """Check `Cl`, `St`, `St_range` and `shedding_window`; write what they become into ``checked``.

    Raises
    ------
    SceneError : a number of the wrong sign, or a range that reaches down to no shedding
    """
    checked["Cl"] = check_number("Cl", cable.Cl, "", owner, sign="non-negative")
    checked["St"] = check_number("St", cable.St, "", owner, sign="positive")
    checked["St_range"] = check_number("St_range", cable.St_range, "", owner, sign="non-negative")
    if checked["St_range"] >= checked["St"]:
        raise SceneError(
            f"Argument `St_range` must be less than `St`, but {owner} has St_range={checked['St_range']} and St={checked['St']}."
        )
    if cable.shedding_window is not None:
        checked["shedding_window"] = check_number("shedding_window", cable.shedding_window, "s", owner, sign="positive")
