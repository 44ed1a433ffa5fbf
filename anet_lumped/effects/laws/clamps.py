"""What clamps hold: the cable that leaves a fixed or driven point in a given direction, and the node after that point."""

from collections.abc import Collection
from typing import Any

from anet_lumped.checks import SceneError, quoted


def clamped_cable(model: Any, point: str, bent: Collection[str], what: str, owner: str) -> Any:
    """The cable that a clamp holds, of those with names in ``bent``, which have ``what``.

    Raises
    ------
    SceneError : a clamp at a free point, or not at the end of one such cable
    """
    if model.node(point) < model.n_free and model.scene.whole:  # else a cable alone, whose ends carry nothing
        raise SceneError(f"A clamp must be at a fixed or driven point, but {owner} clamps free point {quoted(point)}.")
    held = [cable for cable in model.scene.cables if point in (cable.start, cable.end) and cable.name in bent]
    if len(held) != 1:
        raise SceneError(f"A clamp must hold one cable that has {what}, but {len(held)} of them end at point {quoted(point)}.")
    return held[0]


def node_after(model: Any, point: str, cable: Any) -> int:
    """The node next to a point at an end of a cable."""
    node, (first, count) = model.node(point), model.segment_run(model.scene.cable_numbers[cable.name])
    s = first if model.ends[first, 0] == node else first + count - 1
    return int(model.ends[s, 1 - int(model.ends[s, 1] == node)])
