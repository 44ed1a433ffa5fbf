"""Payloads that change at given times."""

from dataclasses import dataclass, field
from typing import Any

from anet_lumped.checks import Vector, check_name, check_number, check_vector, quoted


@dataclass(frozen=True)
class PayloadChange:
    """The mass that a free point carries becomes another one: picked up, dropped, or swapped for it.

    What is dropped leaves with the velocity of its point, which keeps its own. What is picked up sticks to it: the node, of mass
    M with its half segments, and the body m go on together with (M V + m velocity)/(M + m), and M m/(M + m) |V - velocity|^2/2 is
    lost. Where a fluid is carried along, its added mass takes part: (M + m + A) v = (M + A) V + m velocity. What comes with a
    volume brings the fluid that it carries along at its velocity, what leaves takes its own at V.

    Parameters
    ----------
    point : name of a free point
    t : float [s], when, as in ``Run.t``; a run of which it is the very end leaves it to the next
    mass : float [kg], from then on, besides the half segments that end at the point
    velocity : (3,) array_like [m/s], of the body that is picked up, before; at rest unless given
    volume : float [m³] or None, of all that the point carries from then on; None: as before
    CdA : float [m²] or None, drag coefficient times area of all that the point carries from then on; None: as before
    """

    point: str
    t: float
    mass: float
    velocity: Vector = (0.0, 0.0, 0.0)
    volume: float | None = field(default=None, kw_only=True)
    CdA: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        check_name(self.point, "point")
        owner = f"the change of payload at point {quoted(self.point)}"
        object.__setattr__(self, "t", check_number("t", self.t, "s", owner, sign="non-negative"))
        object.__setattr__(self, "mass", check_number("mass", self.mass, "kg", owner, sign="non-negative"))
        object.__setattr__(self, "velocity", check_vector("velocity", self.velocity, "m/s", owner))
        for key, unit in (("volume", "m³"), ("CdA", "m²")):
            if (value := getattr(self, key)) is not None:
                object.__setattr__(self, key, check_number(key, value, unit, owner, sign="non-negative"))


def carried_from(change: Any) -> dict[str, float]:
    """Mass [kg], volume [m³] and CdA [m²] of a point, those of them that a change says, or the event that tells of it."""
    return {key: value for key in ("mass", "volume", "CdA") if (value := getattr(change, key)) is not None}
