"""What happens at once in a run: payloads that change at given times, which a user writes, and all that did happen."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from anet_lumped.checks import quoted

PAYLOAD, BREAK, RELEASE = "payload changed", "broke", "released"
# Of cables that do not stretch: where `links` leaves them to `edmc` and takes them back, and velocities that must jump at once.
SLACK, TAUT, BLOW = "went slack", "was taut again", "blow"


@dataclass(frozen=True)
class Event:
    """What happened in a run at a time.

    Parameters
    ----------
    t : float [s]
    kind : "payload changed", "broke", "released", "went slack", "was taut again" or "blow"
    where : name of the point, or of the cable; "" where all cables are taut again, and of a blow
    lost : float [J], energy that it dissipated
    mass : float or None [kg], of the payload from then on
    segment : int or None, that broke, counted from the cable's start as in ``Run.tension``
    tension : float or None [N], of that segment; of the one that made a point part
    volume, CdA : float or None [m³], [m²], of the payload from then on; None: as before
    """

    t: float
    kind: str
    where: str
    lost: float
    mass: float | None = None
    segment: int | None = None
    tension: float | None = None
    volume: float | None = None
    CdA: float | None = None

    def __str__(self) -> str:
        if self.kind == BREAK:
            return f"t={self.t:.6g} s: segment {self.segment} of cable {quoted(self.where)} broke at {self.tension:.4g} N"
        if self.kind == RELEASE:
            why = "" if self.tension is None else f" at {self.tension:.4g} N"
            return f"t={self.t:.6g} s: point {quoted(self.where)} was released{why}"
        if self.kind == SLACK:
            return f"t={self.t:.6g} s: cable {quoted(self.where)} went slack"
        if self.kind == TAUT:
            return f"t={self.t:.6g} s: all cables were taut again"
        if self.kind == BLOW:
            return f"t={self.t:.6g} s: cables that do not stretch made velocities jump"
        volume = "" if self.volume is None else f" of {self.volume:.4g} m³"
        return f"t={self.t:.6g} s: the payload at point {quoted(self.where)} became {self.mass:.4g} kg{volume}"


def broken(events: Iterable[Event]) -> dict[str, tuple[int, ...]]:
    """Segments that events broke: a dict of each cable's name to a tuple of them, increasing."""
    found: dict[str, tuple[int, ...]] = {}
    for event in events:
        if event.kind == BREAK and event.segment is not None:
            found[event.where] = tuple(sorted((*found.get(event.where, ()), event.segment)))
    return found


def broken_at(scene: Any, events: Iterable[Event], t: float) -> dict[str, tuple[int, ...]]:
    """`broken` by a time [s]: by events, and by the cuts of the scene that are due by then, whether events say so or not."""
    found = broken(events)
    for cut in scene.cable_cuts:
        if cut.t <= t:
            segment = cut.segment % scene.cable(cut.cable).segments
            found[cut.cable] = tuple(sorted({*found.get(cut.cable, ()), segment}))
    return found


def released(events: Iterable[Event]) -> frozenset[str]:
    """Names of the points that events released."""
    return frozenset(event.where for event in events if event.kind == RELEASE)
