"""What happens at once in a run: payloads that change at given times, which a user writes, and all that did happen."""

from dataclasses import dataclass

from anet_lumped.checks import Vector, check_name, check_number, check_vector

PAYLOAD, BREAK = "payload changed", "broke"


@dataclass(frozen=True)
class PayloadChange:
    """The mass that a free point carries becomes another one: picked up, dropped, or swapped for it.

    What is dropped leaves with the velocity of its point, which keeps its own. What is picked up sticks to it: the node, of mass
    M with its half segments, and the body m go on together with (M V + m velocity)/(M + m), and M m/(M + m) |V - velocity|^2/2 is
    lost. Where a fluid is carried along, its added mass takes part: (M + m + A) v = (M + A) V + m velocity.

    Parameters
    ----------
    point : name of a free point
    t : float [s], when, as in ``Run.t``; a run of which it is the very end leaves it to the next
    mass : float [kg], from then on, besides the half segments that end at the point
    velocity : (3,) array_like [m/s], of the body that is picked up, before; at rest unless given
    """

    point: str
    t: float
    mass: float
    velocity: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self):
        check_name(self.point, "point")
        owner = f'the change of payload at point "{self.point}"'
        object.__setattr__(self, "t", check_number("t", self.t, "s", owner, sign="non-negative"))
        object.__setattr__(self, "mass", check_number("mass", self.mass, "kg", owner, sign="non-negative"))
        object.__setattr__(self, "velocity", check_vector("velocity", self.velocity, "m/s", owner))


KINDS = {"payload_change": PayloadChange}


@dataclass(frozen=True)
class Event:
    """What happened in a run at a time.

    Parameters
    ----------
    t : float [s]
    kind : "payload changed" or "broke"
    where : name of the point, or of the cable
    lost : float [J], energy that it dissipated
    mass : float or None [kg], of the payload from then on
    segment : int or None, that broke, counted from the cable's start as in ``Run.tension``
    tension : float or None [N], of that segment
    """

    t: float
    kind: str
    where: str
    lost: float
    mass: float | None = None
    segment: int | None = None
    tension: float | None = None

    def __str__(self):
        if self.kind == BREAK:
            return f't={self.t:.6g} s: segment {self.segment} of cable "{self.where}" broke at {self.tension:.4g} N'
        return f't={self.t:.6g} s: the payload at point "{self.where}" became {self.mass:.4g} kg'


def broken(events):
    """Segments that events broke: a dict of each cable's name to a tuple of them, increasing."""
    found = {}
    for event in events:
        if event.kind == BREAK:
            found[event.where] = tuple(sorted((*found.get(event.where, ()), event.segment)))
    return found
