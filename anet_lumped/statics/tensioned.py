"""The length of a cable for a sag, an end tension or a lowest height that is wanted at rest.

A longer cable sags more and hangs lower. Its end tension falls with its length from that of a bowstring to a least one, and rises
from there with its weight; of the two lengths that have a tension, the shorter one is meant. The length is bracketed by steps that
grow, and found there by Brent's method; each look is an `equilibrium`.
Source: Brent, Algorithms for Minimization without Derivatives (1973), chapter 4.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

from anet_lumped.checks import InputError, check_number, quoted
from anet_lumped.results.sag import sag as sag_of
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene, check_scene

from .equilibrium import rest_on_the_way
from .equilibrium_error import EquilibriumError, NoRestError

FIRST_STEP, GROWTH = 1e-3, 2.0  # of a length: the first step of the search, and by how much each next one is longer
LONGEST, SHORTEST = 1e3, 1e-3  # of the scene's own length: how far it is searched
TIGHT = 100.0  # what a cable counts as that does not reach, in logarithms of a tension or in lengths
SETTLED = 1e-6  # of the tension: how near its least value is looked for


def tensioned(
    scene: Scene, cable: str, *, sag: float | None = None, end_tension: float | None = None, lowest: float | None = None,
    at: str | None = None,
) -> Scene:  # fmt: skip
    """Scene with the length of a cable for which its rest is as wanted.

    Exactly one of `sag`, `end_tension` and `lowest` is to be given.

    Parameters
    ----------
    scene : Scene
    cable : name of the cable whose length is looked for; its `length` in the scene is where the search begins
    sag : float [m], largest distance of its nodes below its chord, along gravity
    end_tension : float [N], `State.end_tension` at the point `at`
    lowest : float [m], z of its lowest node
    at : name of the point where the tension is wanted, an end of the cable; its `end` if None

    Returns
    -------
    Scene

    Raises
    ------
    InputError : not one thing wanted, a number that cannot be, a point where the cable does not end
    EquilibriumError : no length has it, with what comes nearest; no rest
    """
    check_scene(scene)
    own, owner = scene.cable(cable), f"`tensioned` for cable {quoted(cable)}"
    wanted = {name: value for name, value in (("sag", sag), ("end_tension", end_tension), ("lowest", lowest)) if value is not None}
    if len(wanted) != 1:
        raise InputError(
            f"Exactly one of `sag`, `end_tension` and `lowest` must be wanted of cable {quoted(cable)}, but "
            f"{' and '.join(wanted) or 'none'} is given."
        )
    ((what, value),) = wanted.items()
    unit, sign = ("N", "positive") if what == "end_tension" else ("m", "positive" if what == "sag" else "")
    value = check_number(what, value, unit, owner, sign=sign)
    point = own.end if at is None else at
    if point not in (own.start, own.end) or (at is not None and what != "end_tension"):
        raise InputError(
            f"Argument `at` is the end of cable {quoted(cable)} at which its tension is wanted, {quoted(own.start)} or "
            f"{quoted(own.end)}, but it is {quoted(point)} for {what}."
        )
    if what == "sag" and not scene.gravity.any():
        raise InputError(f"A sag is measured along gravity, but the scene of cable {quoted(cable)} has none.")

    measures: dict[str, Callable[[State], float]] = {
        "sag": lambda state: value - sag_of(state, cable),
        "end_tension": lambda state: math.log(max(state.end_tension(cable, point), 1e-300) / value),
        "lowest": lambda state: float(state.shape(cable)[:, 2].min()) - value,
    }

    def with_length(length: float) -> Scene:
        cables = [replace(one, length=length) if one.name == cable else one for one in scene.cables]
        return replace(scene, cables=cables)

    def tightness(length: float) -> float:
        """Positive where the cable is too short, and zero where it is as wanted."""
        try:
            return measures[what](rest_on_the_way(with_length(length)))
        except NoRestError:
            if own.inextensible and length < own.length:
                return TIGHT  # it does not reach
            raise

    search = _Search(tightness, own.length, what == "end_tension")
    return with_length(search.root(lambda reached: _not_found(cable, what, value, reached)))


class _Look(NamedTuple):
    """A length that was tried [m], and the value of the function there: positive where the cable is too short."""

    length: float
    value: float


class _Search:
    """Search for the length at which a function is zero that is positive for short cables.

    Parameters
    ----------
    tightness : function of the length [m]
    length : float [m], where it begins
    turns : bool, whether the function rises again for long cables
    """

    def __init__(self, tightness: Callable[[float], float], length: float, turns: bool) -> None:
        self.tightness, self.length, self.turns = tightness, length, turns

    def root(self, not_found: Callable[[_Look], Exception]) -> float:
        """The root [m]; raises what ``not_found`` makes of the look that comes nearest."""
        from scipy.optimize import brentq

        here = _Look(self.length, self.tightness(self.length))
        if here.value > 0.0:
            loose = self._loose(here, not_found)
            tight = here if here.length < loose.length else self._walk(loose, -1.0, lambda value: value > 0.0, not_found)[1]
        else:
            loose, tight = self._walk(here, -1.0, lambda value: value > 0.0, not_found)
        if loose.value == 0.0:
            return loose.length
        return float(brentq(self.tightness, tight.length, loose.length, xtol=1e-13 * loose.length, rtol=1e-14))

    def _loose(self, here: _Look, not_found: Any) -> _Look:
        """A length at which the function is not positive, found from one where it is.

        Longer cables are looser. But a tension rises again with the weight of a long cable: then the walk goes to the side where it
        falls, and if it only reaches the least tension, that is sought within the last three looks.
        """
        if not self.turns:
            return self._walk(here, 1.0, lambda value: value <= 0.0, not_found)[1]
        from scipy.optimize import minimize_scalar

        longer = self.tightness(here.length * (1.0 + SETTLED))
        side = 1.0 if longer <= here.value else -1.0
        seen = [here]
        while seen[-1].value > 0.0 and (len(seen) < 2 or seen[-1].value <= seen[-2].value):
            seen.append(self._step(seen[-1], side, len(seen), not_found))
        if seen[-1].value <= 0.0:
            return seen[-1]
        low, high = sorted((seen[-1].length, seen[max(len(seen) - 3, 0)].length))
        least = minimize_scalar(self.tightness, bounds=(low, high), method="bounded", options={"xatol": SETTLED * low})
        if least.fun > 0.0:
            raise not_found(_Look(float(least.x), float(least.fun)))
        return _Look(float(least.x), float(least.fun))

    def _walk(self, here: _Look, side: float, enough: Callable[[float], bool], not_found: Any) -> tuple[_Look, _Look]:
        """The last two looks of a walk to longer (``side`` 1) or shorter (-1) cables, up to where the function is as wanted."""
        before, k = here, 1
        while True:
            after = self._step(before, side, k, not_found)
            if enough(after.value):
                return before, after
            before, k = after, k + 1

    def _step(self, before: _Look, side: float, k: int, not_found: Any) -> _Look:
        """The look after ``before``, the ``k``-th of a walk to longer (``side`` 1) or shorter (-1) cables."""
        change = FIRST_STEP * GROWTH ** (k - 1)
        length = before.length * (1.0 + change) if side > 0.0 else before.length / (1.0 + change)
        if not SHORTEST * self.length < length < LONGEST * self.length:
            raise not_found(before)
        return _Look(length, self.tightness(length))


def _not_found(cable: str, what: str, value: float, reached: _Look) -> EquilibriumError:
    """What to say where no length has what is wanted."""
    length, off = reached
    nearest = {"sag": value - off, "end_tension": value * math.exp(min(off, TIGHT)), "lowest": value + off}[what]
    unit = "N" if what == "end_tension" else "m"
    return EquilibriumError(
        f"No length of cable {quoted(cable)} has {what}={value:g} {unit} at rest: the nearest found is {nearest:.6g} {unit}, "
        f"with {length:.6g} m."
    )
