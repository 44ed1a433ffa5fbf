"""The search for a stable rest under loads that depend on the shape, from one start after another.

Each start is relaxed. Cables that push or bend can come to rest in a fold, which balances and is not stable. So some starts
are eased first: relaxed without pushing and bending, which on a flat ground is a convex problem. A rest that is found is judged.
Where a direction leads down, the cables leave along it and descend.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.tables import AXIAL_PUSH_SHARE

from .descent import descended
from .failure_reasons import bends_but_does_not_push, impossible
from .relaxation import QUICK, SLOW, Pace, net_at_rest, relaxed
from .stability import Curvature, curvature
from .starts import obstacles, raised

BALANCED = 1e-9  # of the load, that forces must balance to
ROUGH = 1e-3  # of the load, from which the exact tangent may find the balance
LEAVES = 6  # of a start: times that a rest which is not stable is left
NUDGE = 0.05  # of the shortest segment, by which it is left first


class Shape(NamedTuple):
    """Places of all nodes (n, 3) [m], and the tension of every segment that goes with them (n_segments,) [N]."""

    q: np.ndarray
    tension: np.ndarray


class Found(NamedTuple):
    """What a start has led to.

    Parameters
    ----------
    shape : Shape
    residual : float, largest force out of balance over the load
    down : Curvature or None, which directions lead down from it, if it balances
    asked_for : bool
        Whether it is the rest next to the guess of the user, and the surroundings make it unstable.
    """

    shape: Shape
    residual: float
    down: Curvature | None
    asked_for: bool = False

    @property
    def balanced(self) -> bool:
        """Whether it is a rest at all."""
        return self.residual <= BALANCED

    @property
    def stable(self) -> bool:
        """Whether it is a rest that no direction leads down from."""
        return self.down is not None and self.down.directions_down == 0


class _Attempt(NamedTuple):
    shape: Shape
    eased: bool = False
    pace: Pace = QUICK
    descends: bool = False
    of_user: bool = False

    @property
    def long(self) -> bool:
        """Whether it may take seconds."""
        return self.descends or self.pace is SLOW


def stable_rest(model: Model, net: Any, hanging: Shape, given: Shape | None, load: float) -> Found:
    """The first stable rest that a start leads to; else the best that was found.

    Parameters
    ----------
    model : Model
    net : Net
    hanging : Shape, that the dead loads alone give
    given : Shape or None, first guess of the user
    load : float [N]
        That tolerances are relative to.

    Returns
    -------
    Found
    """
    best, leaves = None, LEAVES
    for attempt in _attempts(model, net, hanging, given):
        if attempt.long and best is not None and impossible(model, best.shape.q):
            break
        found = _try(model, net, attempt, load, leaves)
        leaves = min(leaves, 1) if found.balanced else leaves
        if found.stable or found.asked_for:
            return found
        if best is None or (found.balanced, -found.residual) > (best.balanced, -best.residual):
            best = found
    assert best is not None
    return best


def _attempts(model: Model, net: Any, hanging: Shape, given: Shape | None) -> Iterator[_Attempt]:
    """Starts, the likeliest first; those that cannot differ from an earlier one are left out."""
    eases = bool((net.axial[:, AXIAL_PUSH_SHARE] > 0.0).any()) or any(effect.coupled_neighbours > 1 for effect in model.forces)
    if given is not None:
        yield _Attempt(given, of_user=True)
        if eases:
            yield _Attempt(given, eased=True)
    met = obstacles(model, net, hanging.q)
    if met.above is not None:
        yield _Attempt(_loose(model, met.above), eased=eases)
    if eases and not met.any_met:
        yield _Attempt(hanging)
    yield _Attempt(hanging, eased=eases)
    above = raised(model, hanging.q) if met.above is None else met.above
    yield _Attempt(_loose(model, above), eased=eases, pace=SLOW)
    yield _Attempt(hanging, descends=True)


def _loose(model, q):
    return Shape(q, np.zeros(model.n_segments))


def _try(model: Model, net: Any, attempt: _Attempt, load: float, leaves: int) -> Found:
    """Relax a start, and go on from rests that are not stable."""
    q, whole = attempt.shape.q.copy(), net_at_rest(model, net, load)
    whole.tension[:] = attempt.shape.tension
    if attempt.eased:
        eased = net_at_rest(model, net, load, eased=True)
        eased.tension[:] = attempt.shape.tension
        relaxed(model, eased, q, load, attempt.pace)
        whole.tension[:] = eased.tension
    if attempt.descends:
        whole.tension[:] = descended(model, net, q, load)[0]
    residual = _balanced(model, net, whole, q, load, attempt.pace)
    found = _judged(model, net, whole, q, residual, load)
    nudge = NUDGE * min(cable.L0 for cable in model.scene.cables)
    if attempt.of_user and found.balanced and not found.stable and found.shape.tension.min() >= -BALANCED * load:
        return found._replace(asked_for=True)
    lost = 0
    for _ in range(leaves):
        if found.stable or not found.balanced or lost == 2 or bends_but_does_not_push(model, found.shape.q):
            break
        beside = found.shape.q.copy()
        beside[: model.n_free] += nudge * found.down.direction
        whole.tension[:] = descended(model, net, beside, load)[0]
        residual = _balanced(model, net, whole, beside, load, attempt.pace)
        other = _judged(model, net, whole, beside, residual, load)
        if other.stable or (other.balanced and other.down.directions_down < found.down.directions_down):
            found = other
        lost = 0 if other.balanced else lost + 1
        nudge *= -2.0
    return found


def _balanced(model, net, whole, q, load, pace):
    """Relax a shape, in place; where pseudo-steps stay short of the balance, the exact tangent finds it. Returns the residual."""
    residual = relaxed(model, whole, q, load, pace)
    if BALANCED < residual < ROUGH:
        other = q.copy()
        tension, exact = descended(model, net, other, load, near=0.1 * BALANCED)
        if exact <= BALANCED:
            q[:], whole.tension[:], residual = other, tension, exact
    return residual


def _judged(model, net, whole, q, residual, load):
    shape = Shape(q.copy(), whole.tension.copy())
    return Found(shape, residual, curvature(model, net, q, shape.tension, load) if residual <= BALANCED else None)
