"""What a point of a body carries: a clump weight, a float, a sensor."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_number, check_pairs, nearest, quoted, shown

from .body_mass import Mass


@dataclass(frozen=True)
class Carried:
    """A small thing that is fixed to a point of a body, and moves with it.

    Its mass is one of the body, by Steiner's theorem. Air and water act on it there as on what a free point carries.

    Parameters
    ----------
    mass : float [kg]
    volume : float [m³], of a sphere
    CdA : float [m²], drag coefficient times area, the same in every direction
    Ca : float, added mass over that of the fluid in its volume
    """

    mass: float = 0.0
    volume: float = 0.0
    CdA: float = 0.0
    Ca: float = 0.0

    def __post_init__(self) -> None:
        for key, unit in (("mass", "kg"), ("volume", "m³"), ("CdA", "m²"), ("Ca", "")):
            checked = check_number(key, getattr(self, key), unit, "what a body carries", sign="non-negative")
            object.__setattr__(self, key, checked)

    def mass_at(self, arm: Vector) -> Mass:
        """`Mass` of it at an arm (3,) [m]."""
        return Mass(self.mass, np.array(arm, float), np.zeros((3, 3)))


def check_carried(carried: Any, attachments: list[str], owner: str) -> tuple[tuple[str, Carried], ...]:
    """Pairs of a point of a body, "" for its origin, and what it carries.

    Raises
    ------
    SceneError : no `Carried`, or no such attachment
    """
    pairs = check_pairs("carried", carried, "an attachment's name and what it carries", owner, may_be_empty=True)
    for name, thing in pairs:
        if not isinstance(thing, Carried):
            raise SceneError(f"Argument `carried` must hold Carried, but {owner} has {shown(thing)} at {quoted(str(name))}.")
        if name not in ("", *attachments):
            raise SceneError(
                f'Argument `carried` must name attachments, or "" for the origin, but {owner} has {shown(name)}'
                + (nearest(name, attachments) or ".")
            )
    return tuple(pairs)
