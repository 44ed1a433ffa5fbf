"""Blows of cables that do not stretch, whose tension has no value.

A cable of fixed length that catches a weight changes its velocity at once. The impulse of that is known and no time that it takes:
an implicit step shows it over its own length, and more as steps get shorter; `links` gives it between two steps and shows none of
it. A cable of the stiffness k = EA/L that catches a mass m with the velocity v pulls with some v sqrt(k m).

Events tell velocities that jump with what is driven; else the energy shows blows, which events and `edmc` book: of cables that do
not stretch its damper takes nothing else. Over the energy in play of 500 random motions it was 2e-7 at most in those whose cables
went slack and were not caught, 4e-5 and more in those that were caught, and 2e-5 at most, of roundings and of Newton's tolerance,
in those that stayed taut.
"""

from typing import Any

import numpy as np

from .events import BLOW, SLACK, TAUT
from .peaks import largest_so_far

CONSIDERABLE = 1e-5  # of the energy in play: what blows of cables that went slack take
OF_TAUT = 1e-4  # the same of cables that neither saved states nor events show to be slack


def has_rigid_blows(run: Any) -> bool:
    """Whether cables that do not stretch were caught in a run.

    Where others stretch the method takes their vibrations as well. There it is a blow if it has taken something, and the largest
    tension of a cable that does not stretch is the first after a saved state in which that was slack.
    """
    cables = run.scene.cables
    if not any(cable.inextensible for cable in cables):
        return False
    events = [event for event in run.events if event.t >= run.t[0]]  # those before it are of the run that it goes on from
    kinds = {event.kind for event in events}
    if BLOW in kinds:
        return True
    taken = sum(event.lost for event in events if event.kind == TAUT) + (run.energy_balance.by_method or 0.0)
    if not taken > CONSIDERABLE * run.energy_balance.in_play:
        return False
    if not all(cable.inextensible for cable in cables):
        return _peaks_after_slack(run)
    goes_slack = bool(kinds & {SLACK, TAUT}) or bool((run.segment_tension[1:] <= 0.0).any())
    return goes_slack or taken > OF_TAUT * run.energy_balance.in_play


def _peaks_after_slack(run: Any) -> bool:
    """Whether a cable that does not stretch has its largest tension right after a saved state in which it was slack."""
    noticed = 0.0 if run.largest_tension is None else run.largest_tension
    largest = largest_so_far(run.model, run.segment_tension, noticed)
    for c, cable in enumerate(run.scene.cables):
        row = int(np.argmax(largest[:, c]))  # the first one of those that have it
        if cable.inextensible and row > 0 and (run.tension(cable.name)[row - 1] <= 0.0).any():
            return True
    return False
