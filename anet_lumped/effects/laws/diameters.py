"""Whether all cables have the diameter on which areas and drag depend."""

from collections.abc import Sequence
from typing import Any

from anet_lumped.checks import SceneError, quoted


def check_diameters(cables: Sequence[Any], effect: str) -> None:
    """Refuse cables without a diameter for the sake of ``effect``, which is named "effect Water" or as its user named it.

    Raises
    ------
    SceneError : a cable without a diameter
    """
    without = next((cable.name for cable in cables if cable.diameter is None), None)
    if without is not None:
        raise SceneError(f"The {effect} needs the `diameter` [m] of every cable, but cable {quoted(without)} has none.")
