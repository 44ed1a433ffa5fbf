"""Cables that are cut at given times."""

from dataclasses import dataclass

from anet_lumped.checks import SceneError, check_name, check_number, quoted, shown

MOST = 10**9  # segments that no cable has


@dataclass(frozen=True)
class CableCut:
    """A segment of a cable fails at a time: a rope that is cut, a line that is lost.

    What follows is what follows where a cable breaks: half of the mass of the segment stays with either node, what is left of
    the cable goes on as cables with loose ends, and the energy that the segment held is lost.

    Parameters
    ----------
    cable : name of the cable
    t : float [s], when, as in ``Run.t``; a run of which it is the very end leaves it to the next
    segment : int, which of its segments, from 0 at its start; -1 is the last one, at its end
    """

    cable: str
    t: float
    segment: int = 0

    def __post_init__(self) -> None:
        check_name(self.cable, "cable")
        owner = f"the cut of cable {quoted(self.cable)}"
        object.__setattr__(self, "t", check_number("t", self.t, "s", owner, sign="non-negative"))
        if isinstance(self.segment, bool) or not isinstance(self.segment, int) or abs(self.segment) > MOST:
            raise SceneError(
                f"Argument `segment` must be a whole number up to {MOST:g}, but {owner} has segment={shown(self.segment)}."
            )
