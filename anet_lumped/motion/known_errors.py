"""Errors that a run is to keep, and what is known of those it has, by what it tells of itself and beside other runs."""

import math
from typing import NamedTuple

import numpy as np

from anet_lumped.results.amplification import is_hardly_seen
from anet_lumped.results.buckling import first_buckled
from anet_lumped.results.distances import distances
from anet_lumped.results.free_flight import goes_loose, loose
from anet_lumped.results.run import Run
from integrators import schemes

from .first_step import thrown

ERROR_OF_LENGTH = 1e-3  # of the longest cable, and
ERROR_OF_MOTION = 0.05  # of the largest way that a node goes: errors of places that the default keeps
SMALLEST_ERROR = 1e-6  # of the longest cable: a motion that is smaller than its error is at rest
TENSION_ERROR = 0.02  # of the largest tension: what the default keeps
AMPLIFIED = 4.0  # times the error that a run tells of itself: from there on the motion has multiplied it
LEAST_OF_TOLD = 0.05  # of the error that a run tells of itself, which is left of it by a comparison


class Wanted(NamedTuple):
    """Errors to keep.

    Parameters
    ----------
    error : float or None [m], of places; None for the default's, see the module
    tension_error : float, of the largest tension, over it
    """

    error: float | None
    tension_error: float

    def of_places(self, run: Run) -> float:
        """Error of places to keep in a run [m]."""
        if self.error is not None:
            return self.error
        length = run.scene.longest
        way = float(np.abs(run.q - run.q[0]).max())
        return max(min(ERROR_OF_LENGTH * length, ERROR_OF_MOTION * way), SMALLEST_ERROR * length)


class Known(NamedTuple):
    """What is known of the errors of a run.

    Parameters
    ----------
    error : float [m], of places
    tension_error : float, of the largest tension, over it
    of_told : float, the error of places over that which the run tells of itself: more than one where the motion multiplies errors
    since : float [s], from when on they are multiplied; infinite if they are not
    apart : float [m], what its places and those of a coarser run differ by; infinite without one
    until : float [s], from when on these differ by so much that the error which is left of it is not kept; infinite if they do not
    """

    error: float
    tension_error: float
    of_told: float = 1.0
    since: float = math.inf
    apart: float = math.inf
    until: float = math.inf


def is_kept(run: Run, known: Known, wanted: Wanted) -> bool:
    return known.error <= wanted.of_places(run) and known.tension_error <= wanted.tension_error


def alone(run: Run) -> Known:
    """Errors of a run as it tells them by itself; where its first step throws nodes off, all of their way may be wrong."""
    error = run.error_estimate or 0.0
    if thrown(run) is not None:
        error = max(error, float(np.abs(run.q - run.q[0]).max()))
    return Known(error, run.tension_error)


def compared(run: Run, coarser: Run, wanted: Wanted, apart_before: float) -> Known:
    """Errors of a run, as it tells them and as a coarser one before it shows them.

    Where two runs are hardly nearer to each other than the two before them, which were ``apart_before`` [m], nothing says that the
    next will be: what a run differs by from its predecessor is then its error, else what is left of a geometric series. The error
    of the largest tension is what the run tells, times what the largest tensions differ by over what the coarser run told, if that
    is more: two runs from which the method took the same vibration agree.
    """
    own, theirs, by_node = distances(run, coarser)
    apart = np.maximum.accumulate(by_node.max(axis=1))
    told, last = np.maximum(coarser.error[theirs], 1e-300), float(apart[-1])
    ratio = min(last / apart_before, 0.5) if apart_before > 0.0 else 0.0
    own_told = max(run.error_estimate or 0.0, 1e-300)
    least = 1.0 if _collides(run) else LEAST_OF_TOLD
    error = max(own_told * max(last / float(told[-1]), least), last * ratio / (1.0 - ratio))
    of_told = error / own_told
    allowed = wanted.of_places(run)
    since = _first(run.t[own], apart > np.maximum(AMPLIFIED * told, allowed)) if of_told > AMPLIFIED else math.inf
    until = _first(run.t[own], apart * error > allowed * last)
    peak, peak_of_coarser = run.peak_tension(), coarser.peak_tension()
    changed = abs(peak - peak_of_coarser) / max(peak, peak_of_coarser, 1e-300)
    tension_error = run.tension_error * max(changed / max(coarser.tension_error, 1e-300), 1.0)
    return Known(error, min(tension_error, 1.0), of_told, since, last, until)


def beside(run: Run, coarser: Run, known: Known, wanted: Wanted) -> Known:
    """What is known of the errors of a run beside a coarser one, no less than the run tells by itself."""
    seen = compared(run, coarser, wanted, known.apart if known.apart < math.inf else 0.0)
    more = max(seen.tension_error, known.tension_error)
    if seen.error <= known.error:
        return known._replace(apart=seen.apart, tension_error=more)
    return seen._replace(tension_error=more)


def at_least(error: float, known: Known, run: Run) -> Known:
    """What is known of a run with an error of places that is no less than ``error`` [m]."""
    return known if error <= known.error else known._replace(error=error, of_told=error / max(run.error_estimate or 0.0, 1e-300))


def _first(t: np.ndarray, found: np.ndarray) -> float:
    """First of some times [s] at which something was found; infinite if it never was."""
    return float(t[np.argmax(found)]) if found.any() else math.inf


def left_of(run: Run, coarser: Run) -> float:
    """Error of a run that falls with the order of its method from that of a coarser one [m]."""
    scheme = schemes.scheme(run.method)
    order = scheme.error_order or scheme.order or 1
    return float(distances(run, coarser).apart.max()) / ((coarser.dt / run.dt) ** order - 1.0)


def is_caught_and_corrected(run: Run, known: Known, wanted: Wanted) -> bool:
    """Whether a run keeps an error of places that it tells to be larger, or that grows, as a coarser one says, and nodes fly in it.

    When a node is caught, a coarse step moves the time of that by much of itself: what the coarse run told may be many times too
    large, or its places near to those of the finer one by chance.
    """
    tells_more = (run.error_estimate or 0.0) > wanted.of_places(run)
    return (tells_more or known.of_told > AMPLIFIED) and run.segment_tension.min(initial=1.0) <= 0.0 and bool(loose(run).any())


def may_multiply(run: Run) -> bool:
    """Whether a motion goes loose or buckles, or may do so unseen, so that the errors which a run tells may be multiplied.

    A body whose cables go slack tumbles until they catch it.
    """
    known = goes_loose(run) or first_buckled(run) is not None or (run.model.has_bodies and _goes_slack(run))
    return known or is_hardly_seen(run)


def _goes_slack(run: Run) -> bool:
    """Whether a segment holds nothing at a saved time after the start."""
    return bool((run.segment_tension[1:] <= 0.0).any())


def _collides(run: Run) -> bool:
    """Whether cables that do not stretch go slack: they are taut again at a blow, whose time no step resolves."""
    return any(cable.inextensible for cable in run.scene.cables) and _goes_slack(run)
