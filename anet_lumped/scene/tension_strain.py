"""Tension-strain curves of cables: straight from (0, 0) to the first point, from each to the next, and on beyond the last."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from anet_lumped.checks import SceneError, check_number, shown

Curve = tuple[tuple[float, float], ...]


def check_curve(value: Any, owner: str) -> Curve:
    """Return a tension-strain curve as pairs of floats (eps, T [N]), without the (0, 0) that it may begin with.

    Raises
    ------
    SceneError : no pairs of numbers, pairs that do not grow, or a slope that no float holds
    """
    try:
        curve = tuple(
            (check_number("tension_strain", eps, "", owner), check_number("tension_strain", T, "N", owner)) for eps, T in value
        )
    except (TypeError, ValueError):
        raise SceneError(
            f"Argument `tension_strain` must be pairs of a finite strain and tension [N], but {owner} has {shown(value)}."
        ) from None
    curve = curve[1:] if curve[:1] == ((0.0, 0.0),) else curve
    both = list(zip(*((0.0, 0.0), *curve), strict=True))
    if not curve or any(after <= before for of in both for before, after in pairwise(of)):
        raise SceneError(
            "Strains and tensions of `tension_strain` must grow from (0, 0) on, and there must be some, but "
            f"{owner} has {shown(value)}."
        )
    for slope in slopes(curve):
        check_number("slope of tension_strain", slope, "N", owner, sign="positive")
    return curve


def slopes(curve: Sequence[tuple[float, float]]) -> list[float]:
    """Slope of each piece of a curve [N]."""
    before = ((0.0, 0.0), *curve[:-1])
    return [(T - T_before) / (eps - eps_before) for (eps, T), (eps_before, T_before) in zip(curve, before, strict=True)]
