"""The search for a stable rest under loads that depend on the shape, from one start after another.

Each start is relaxed, see `relaxation`. Cables that push or bend can come to rest in a fold, whose forces balance although it is
not stable. So some starts are eased first: they are relaxed without pushing and bending, which on a flat ground is a convex
problem. `stability` judges each rest that is found. Where the energy falls along a direction, the cables are moved along it, and
descend.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.tables import AXIAL_INEXTENSIBLE, AXIAL_PUSH_SHARE

from .caught import is_caught
from .descent import descended
from .failure_reasons import bends_but_does_not_push, impossible
from .held_bodies import keep_shapes
from .relaxation import QUICK, SLOW, STEPS, UNHINDERED, Pace, net_at_rest, relaxed
from .soft_contacts import DEPTHS, solids, with_soft_solids
from .stability import EPS, Curvature, curvature, of_effects
from .starts import obstacles, raised
from .stiff_cables import SOFT, SOFTER, are_stiff, at_rest_as_stiff, softened

BALANCED = 1e-9  # of the load: largest out-of-balance force of a rest
ROUNDED, MOST_ROUNDED = 4.0 * EPS, 1e-6  # of the coordinates: rounding of a place; and of the load: the most that its force counts
ROUGH = 1e-3  # of the load: from a smaller out-of-balance force the exact tangent may find the balance
LEAVES, FEW_LEAVES = 6, 2  # how often the search from one start leaves a rest that is not stable; and that of a large net
LARGE = 300  # free points, from which on a net is large: an attempt may take half a minute
VAST = 2000  # free points, from which on an attempt may take minutes: long ones are left out, which found none of the nets tried
ASIDE = 1e-4  # of the longest cable: how far aside nodes are from which cables that bend or push are let down
LAID_STEPS = 3000  # pseudo-steps in which cables are let down onto solids: none of them goes through one
NUDGE = 0.05  # of the shortest segment, or of a body without cables: displacement with which it leaves the first time


class Shape(NamedTuple):
    """Positions of all nodes (n, 3) [m], and the tension of every segment at these positions (n_segments,) [N]."""

    q: np.ndarray
    tension: np.ndarray


class Found(NamedTuple):
    """The shape that the search from a start ended in, and what is known of it.

    Parameters
    ----------
    shape : Shape
    residual : float, largest out-of-balance force over the load
    down : Curvature of the shape; None if its forces do not balance
    tolerance : float, residual up to which the forces count as balanced
    asked_for : bool
        Whether this is the rest next to the guess of the user, and the surroundings make it unstable.
    caught : bool, whether the forces balance because nodes are caught between contacts, see `caught`
    """

    shape: Shape
    residual: float
    down: Curvature | None
    tolerance: float = BALANCED
    asked_for: bool = False
    caught: bool = False

    @property
    def balanced(self) -> bool:
        """Whether the forces balance."""
        return self.residual <= self.tolerance

    @property
    def stable(self) -> bool:
        """Whether the forces balance, and the energy falls along no direction."""
        return self.down is not None and self.down.directions_down == 0 and not self.caught

    @property
    def ends_search(self) -> bool:
        """Whether no other start is tried."""
        return self.stable or self.asked_for


class _Attempt(NamedTuple):
    """A start and how the search goes on from it.

    First eased, at which pace, by a descent first, whether a user gave it, and whether it is let down onto solids.
    """

    shape: Shape
    eased: bool = False
    pace: Pace = QUICK
    descends: bool = False
    of_user: bool = False
    laid: bool = False

    @property
    def long(self) -> bool:
        """Whether the attempt may take seconds."""
        return self.descends or self.pace is SLOW


def stable_rest(model: Model, net: Any, hanging: Shape, given: Shape | None, load: float, calm: Shape | None = None) -> Found:
    """The first stable rest that a start leads to; if none does, the shape whose forces balance best.

    Cables that do not stretch begin from the rest of `softened` ones. So do stiff ones, whose own search has found no rest.

    Parameters
    ----------
    model : Model
    net : Net
    hanging : Shape under the dead loads alone
    given : Shape or None, first guess of the user
    load : float [N]
        Load that tolerances are relative to.
    calm : Shape or None, rest without turbulence and waves

    Returns
    -------
    Found
    """
    starts = hanging, given, load, calm
    rigid, stiff = bool((net.axial[:, AXIAL_INEXTENSIBLE] > 0.0).any()), bool(are_stiff(net, load).any())
    if stiff and rigid:
        for EA in (SOFT, SOFTER) if solids(model) else (SOFT,):
            found = _by_softer_cables(model, net, EA, *starts)
            if found.ends_search:
                return found
    found = _search(model, net, *starts)
    if stiff and not (rigid or found.ends_search):
        other = _by_softer_cables(model, net, SOFT, *starts)
        found = other if other.stable else found
    return found


def _by_softer_cables(model, net, EA, hanging, given, load, calm):
    """`Found` next to the rest of `softened` cables, of an EA over the load."""
    found = _search(model, softened(net, load, EA), hanging, given, load, calm)
    if not found.residual < ROUGH or found.caught:
        return found
    q, tension = found.shape.q.copy(), found.shape.tension.copy()
    residual = at_rest_as_stiff(model, net, q, tension, load)
    exact = _judged(model, net, Shape(q, tension), residual, load)
    return exact._replace(asked_for=found.asked_for and exact.balanced)


def _search(model, net, hanging, given, load, calm):
    """`stable_rest` of cables as they are in the net."""
    points = model.n_free - model.n_interior
    large, vast = points >= LARGE, points >= VAST
    best, leaves = None, FEW_LEAVES if large else LEAVES
    for attempt in _attempts(model, net, hanging, given, calm):
        if attempt.long and best is not None and (vast or (large and best.balanced) or impossible(model, best.shape.q)):
            break
        found = _try(model, net, attempt, load, leaves)
        leaves = min(leaves, 1) if found.balanced else leaves
        if found.ends_search:
            return found
        if best is None or _rank(found) > _rank(best):
            best = found
    assert best is not None
    return best


def _rank(found):
    """The larger, the nearer to a rest."""
    return found.balanced and not found.caught, found.balanced, -found.residual


def _attempts(model: Model, net: Any, hanging: Shape, given: Shape | None, calm: Shape | None) -> Iterator[_Attempt]:
    """Attempts, the most promising first. An attempt that cannot differ from an earlier one is left out."""
    eases = bool((net.axial[:, AXIAL_PUSH_SHARE] > 0.0).any()) or any(effect.coupled_neighbours > 1 for effect in model.forces)
    if given is not None:
        yield _Attempt(given, of_user=True)
        if eases:
            yield _Attempt(given, eased=True)
    if calm is not None:
        yield _Attempt(calm)
    met = obstacles(model, net, hanging.q)
    if met.above is not None:
        laid = bool(solids(model))
        yield _Attempt(_loose(model, _aside(model, met.above) if laid and eases else met.above), eased=eases, laid=laid)
    if eases and not met.any_met:
        yield _Attempt(hanging)
    yield _Attempt(hanging, eased=eases, pace=QUICK if eases or met.any_met else UNHINDERED)
    above = raised(model, hanging.q) if met.above is None else met.above
    yield _Attempt(_loose(model, above), eased=eases, pace=SLOW)
    yield _Attempt(hanging, descends=True)


def _aside(model, q):
    """A shape with its nodes a little aside, each elsewhere: laid down in a plane, what bends or pushes rests in folds there."""
    q = q.copy()
    q[: model.n_free] += ASIDE * model.scene.longest * np.random.default_rng(1).normal(size=(model.n_free, 3))
    keep_shapes(model, q)
    return q


def _loose(model, q):
    """`Shape` without tensions."""
    return Shape(q, np.zeros(model.n_segments))


def _try(model: Model, net: Any, attempt: _Attempt, load: float, leaves: int) -> Found:
    """Relax a start, and go on from rests that are not stable."""
    q, whole = attempt.shape.q.copy(), net_at_rest(model, net, load)
    whole.tension[:] = attempt.shape.tension
    for easier, eased, steps in _easier(model, net, attempt, load):
        first = net_at_rest(model, easier, load, eased=eased)
        first.tension[:] = whole.tension
        relaxed(model, first, q, load, attempt.pace, steps)
        whole.tension[:] = first.tension
    if attempt.descends:
        whole.tension[:] = descended(model, net, q, load)[0]
    residual = _balanced(model, net, whole, q, load, attempt.pace)
    found = _judged(model, net, Shape(q, whole.tension), residual, load)
    nudge = NUDGE * min((cable.L0 for cable in model.scene.cables), default=model.scene.longest)
    pulls = found.shape.tension.min(initial=0.0) >= -BALANCED * load
    if attempt.of_user and found.balanced and pulls and not (found.stable or found.caught):
        return found._replace(asked_for=True)
    lost = 0
    for _ in range(leaves):
        if found.stable or found.caught or not found.balanced or lost == 2 or bends_but_does_not_push(model, found.shape.q):
            break
        softer = [easier for easier, eased, _ in _easier(model, net, attempt, load) if not eased]
        other = _beside(model, net, whole, found, nudge, load, attempt.pace, softer)
        if other.stable or (other.balanced and other.down.directions_down < found.down.directions_down):
            found = other
        lost = 0 if other.balanced else lost + 1
        nudge *= -2.0
    return found


def _easier(model, net, attempt, load):
    """Easier problems that are solved one after another before that of an attempt: a net, whether it is eased, and pseudo-steps."""
    if attempt.laid:
        for eased in (True, False) if attempt.eased else (False,):
            for share in DEPTHS:
                yield with_soft_solids(model, net, load, share), eased, LAID_STEPS
    elif attempt.eased:
        yield net, True, STEPS


def _beside(model, net, whole, found, nudge, load, pace, softer):
    """`Found` from beside a rest that is not stable: by pseudo-steps, or after a descent if these find no stable one.

    Where cables were let down onto solids, they descend on the softest of these, and are let down from there: ``softer`` nets.
    """
    beside = found.shape.q.copy()
    beside[: model.n_free] += nudge * found.down.direction
    keep_shapes(model, beside)
    q = beside.copy()
    whole.tension[:] = found.shape.tension
    residual = relaxed(model, whole, q, load, pace)
    other = _judged(model, net, Shape(q, whole.tension), residual, load)
    if other.stable:
        return other
    whole.tension[:] = descended(model, softer[0] if softer else net, beside, load)[0]
    for one in softer:
        first = net_at_rest(model, one, load)
        first.tension[:] = whole.tension
        relaxed(model, first, beside, load, pace, LAID_STEPS)
        whole.tension[:] = first.tension
    residual = _balanced(model, net, whole, beside, load, pace)
    return _judged(model, net, Shape(beside, whole.tension), residual, load)


def _balanced(model, net, whole, q, load, pace):
    """Relax a shape, in place; use the exact tangent if pseudo-steps come near the balance and not to it. Returns the residual."""
    residual = relaxed(model, whole, q, load, pace)
    if BALANCED < residual < ROUGH:
        other, tension = q.copy(), whole.tension.copy()
        if model.has_bodies:
            exact = at_rest_as_stiff(model, net, other, tension, load)
        else:
            tension, exact = descended(model, net, other, load, near=0.1 * BALANCED)
        if exact < residual:
            q[:], whole.tension[:], residual = other, tension, exact
    return residual


def _judged(model, net, shape, residual, load):
    """`Found` of a `Shape`, with copies of its arrays."""
    q, tension = shape.q.copy(), shape.tension.copy()
    tolerance = BALANCED if residual <= BALANCED else _rounded(model, net, q, load)
    if not residual <= tolerance:
        return Found(Shape(q, tension), residual, None, tolerance)
    down = curvature(model, net, q, tension, load)
    return Found(Shape(q, tension), residual, down, tolerance, caught=is_caught(model, net, q, load))


def _rounded(model, net, q, load):
    """`BALANCED`, or more where contacts are so stiff that rounding of a place leaves more of the load in their forces."""
    stiffest = float(np.abs(of_effects(model, net, q)[2]).max(initial=0.0))
    return max(BALANCED, min(MOST_ROUNDED, ROUNDED * float(np.abs(q).max()) * stiffest / load))
