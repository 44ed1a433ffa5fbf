"""Laws of controllers that are compiled: a flight calls them without Python, and Python calls them as any controller.

A law is a function of what is seen that Numba compiles,

    law(seen, given, numbers, told) ,

with the state of the flight, a `Seen`; the answer that is given to it, of a guide or of a position control, else an array without
rows; numbers of its own, which it may change; and the array that it writes:

    a guide       "goal"     told (3 m, 3): positions of the m quadrotors, then their velocities, then their accelerations
    a position    "force"    told (m, 3), forces in the axes of the world; given (3 m, 3): the goal of its guide, if it has one
    an attitude   "wrench"   told (m, 4), thrust and torque in the axes of the body; given (m, 3): the forces
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import float64, types
from numba.core.errors import NumbaError

from anet_lumped.checks import InputError, quoted, shown
from anet_lumped.compiled.addresses import address, callable_at
from anet_lumped.compiled.jit import njit
from anet_lumped.motion.readings import SIGHT
from integrators.compile_once import once

from .seen import Seen

_f1, _f2 = float64[::1], float64[:, ::1]
SEEN = types.NamedTuple((float64, *SIGHT.types), Seen)
LAW = types.void(SEEN, _f2, _f1, _f2)
as_compiled_law = callable_at(LAW)
GIVES = {"goal": (3, 3), "force": (1, 3), "wrench": (1, 4)}  # rows over the number of quadrotors, and columns
NOTHING = np.zeros((0, 3))


class Goal(NamedTuple):
    """Where m quadrotors shall be.

    Parameters
    ----------
    position, velocity, acceleration : (m, 3) float64 [m], [m/s], [m/s2]
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


class Wrench(NamedTuple):
    """What m quadrotors are told: thrust (m,) [N] along their z axes, and torque (m, 3) [N m] in their axes."""

    thrust: np.ndarray
    torque: np.ndarray


class CompiledLaw:
    """A compiled law with its numbers; called from Python, it gives a `Goal`, forces (m, 3) or a `Wrench`.

    Parameters
    ----------
    function : callable(seen, given, numbers, told), see the module
        In plain Python that Numba compiles, without exceptions.
    numbers : (k,) array_like
        At the start of a flight; what the function changes in them it finds again when it is called next.
    gives : "goal", "force" or "wrench"
    guide : CompiledLaw or None, whose goal is given to a law of forces
    quadrotors : int or None, for how many the numbers are; None: for any
    needs_given : bool, whether it makes no sense without what is given to it

    Raises
    ------
    InputError : something else than a function, or one that Numba does not compile; another word for what it gives
    """

    def __init__(
        self, function: Callable[..., None], numbers: Sequence[float] | np.ndarray = (), *, gives: str = "wrench",
        guide: "CompiledLaw | None" = None, quadrotors: int | None = None, needs_given: bool = False,
    ) -> None:  # fmt: skip
        if gives not in GIVES:
            raise InputError(f'Argument `gives` of a CompiledLaw must be "goal", "force" or "wrench", but it is {shown(gives)}.')
        if guide is not None and (gives != "force" or not isinstance(guide, CompiledLaw) or guide.gives != "goal"):
            raise InputError(
                f'The guide of a CompiledLaw must give a "goal", and the law a "force", but the guide is {shown(guide)}, and the '
                f"law gives a {quoted(gives)}."
            )
        self.function, self.quadrotors, self.needs_given = compiled(function), quadrotors, needs_given
        self.gives: str = gives
        self.guide: CompiledLaw | None = guide
        self.numbers = np.array(numbers, float).reshape(-1)
        self._first = self.numbers.copy()

    @property
    def address(self) -> int:
        """Address of the compiled function."""
        return address(self.function)

    def reset(self) -> None:
        """Go back to the numbers at the start."""
        self.numbers[:] = self._first
        if self.guide is not None:
            self.guide.reset()

    def check(self, count: int) -> None:
        """Refuse to fly another number of quadrotors than the numbers are for.

        Raises
        ------
        InputError
        """
        if self.quadrotors not in (None, count):
            raise InputError(f"A law must be for as many quadrotors as fly, {count}, but it is for {self.quadrotors}.")
        if self.guide is not None:
            self.guide.check(count)

    def told(self, seen: Seen, given: Any = None) -> np.ndarray:
        """What the function tells, as it writes it."""
        count, (rows, columns) = len(seen.position), GIVES[self.gives]
        self.check(count)
        told = np.zeros((rows * count, columns))
        if self.guide is not None:
            given = self.guide.told(seen)
        given = NOTHING if given is None else np.ascontiguousarray(given, float)
        expected = ({"force": 3, "wrench": 1}.get(self.gives, 0) * count, 3)
        if given.shape != expected and (self.needs_given or given.shape != NOTHING.shape):
            raise InputError(f"A law of a {quoted(self.gives)} must be given numbers {expected}, but it is given {given.shape}.")
        self.function(seen, given, self.numbers, told)
        return told

    def __call__(self, seen: Seen, given: np.ndarray | None = None) -> Any:
        """The answer: a `Goal`, forces (m, 3) [N] or a `Wrench`."""
        told = self.told(seen, given)
        if self.gives == "goal":
            return Goal(*told.reshape(3, -1, 3))
        return told if self.gives == "force" else Wrench(told[:, 0], told[:, 1:])


@once
def _compiled(function: Callable[..., None]) -> Any:
    return njit(LAW, error_model="numpy")(function)


def compiled(function: Any) -> Any:
    """A function compiled as a law.

    Raises
    ------
    InputError : no function, or Numba does not compile it
    """
    if LAW.args in getattr(function, "overloads", {}):
        return function
    plain = getattr(function, "py_func", function)
    if not callable(plain):
        raise InputError(f"A CompiledLaw needs a function (seen, given, numbers, told), but it is {shown(function)}.")
    try:
        return _compiled(plain)
    except (NumbaError, TypeError) as error:
        why = str(error).strip().splitlines()[-1].strip()
        raise InputError(
            "A CompiledLaw needs a function (seen, given, numbers, told) that Numba compiles, but "
            f"{quoted(plain.__name__)} is none: {why}"
        ) from error


def law_of(controller: Any) -> CompiledLaw | None:
    """The compiled law that does what a controller does when it is called, or None if it has none.

    A controller of a class of the library has it as ``law``; a class that has another ``__call__`` has none, unless it says so.
    """
    if isinstance(controller, CompiledLaw):
        return controller
    for owner in type(controller).__mro__:
        if "__call__" in vars(owner):
            return controller.law if "law" in vars(owner) else None
    return None
