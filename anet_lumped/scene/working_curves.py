"""Working curves of polyester ropes: what a cable follows below the largest tension T_max that it has held for long.

`effects.laws.working_curve` is the law. A curve leads from no tension at the strain eps_0 to T_max at eps_max, where the cable's
`tension_strain`, its original curve, has T_max; with xi = (eps - eps_0)/(eps_max - eps_0), T = T_max g(xi):

    linear        g = xi
    quadratic     g = xi (1 - bend + bend xi)
    exponential   g = (exp(bend xi) - 1)/(exp(bend) - 1)
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from anet_lumped.checks import SceneError, check_number, shown

Rows = tuple[tuple[float, float], ...]
PIECES = 29  # straight ones that stand for a curved shape, as in MoorDyn
LARGEST_BEND = 100.0  # of an exponential shape: beyond it all but the last piece would be flat


class WorkingCurve(ABC):
    """The shape of working curves, and the largest tension that the cable has held for long: a frozen dataclass in `KINDS`."""

    called: ClassVar[str] = "working curve"
    """What messages call it."""

    T_max: float

    @property
    @abstractmethod
    def shape(self) -> Rows:
        """Rows (xi, g) of the shape, behind (0, 0)."""

    @property
    @abstractmethod
    def numbers(self) -> tuple[float, float]:
        """eps_0/eps_max, and EA [N] of a curve that has it in place of that, else 0."""

    def first_strain(self, eps_max: float, T_max: float) -> float:
        """eps_0, of the working curve that leads to T_max at eps_max."""
        permanent, EA = self.numbers
        return eps_max - T_max / EA if EA else permanent * eps_max

    def _check(self, **shares: Any) -> None:
        """Check `T_max`, and numbers from 0 to 1 by their names."""
        checked = {"T_max": check_number("T_max", self.T_max, "N", self.called, sign="non-negative")}
        for name, value in shares.items():
            checked[name] = check_number(name, value, "", self.called, sign="non-negative")
            if checked[name] > 1.0 or (name == "permanent" and checked[name] == 1.0):
                raise SceneError(
                    f"Argument `{name}` must be {'less than' if name == 'permanent' else 'up to'} 1, but {self.called} has "
                    f"{name}={checked[name]}."
                )
        for name, value in checked.items():
            object.__setattr__(self, name, value)


def _sampled(g: Callable[[float], float]) -> Rows:
    return (*((k / PIECES, g(k / PIECES)) for k in range(1, PIECES)), (1.0, 1.0))


@dataclass(frozen=True)
class Linear(WorkingCurve):
    """Straight working curves.

    Parameters
    ----------
    permanent : float or None, eps_0/eps_max, the share of the largest strain that stays without tension
    EA : float [N] or None, the slope of all working curves, in its place
    T_max : float [N], largest tension held so far
    """

    permanent: float | None = None
    EA: float | None = None
    T_max: float = 0.0

    def __post_init__(self) -> None:
        if (self.permanent is None) == (self.EA is None):
            raise SceneError(
                f"A linear working curve must have one of `permanent` and `EA`, but has permanent={shown(self.permanent)} and "
                f"EA={shown(self.EA)}."
            )
        self._check(**({} if self.permanent is None else {"permanent": self.permanent}))
        if self.EA is not None:
            object.__setattr__(self, "EA", check_number("EA", self.EA, "N", self.called, sign="positive"))

    @property
    def shape(self) -> Rows:
        return ((1.0, 1.0),)

    @property
    def numbers(self) -> tuple[float, float]:
        return self.permanent or 0.0, self.EA or 0.0


@dataclass(frozen=True)
class Quadratic(WorkingCurve):
    """Working curves that stiffen as a parabola.

    Parameters
    ----------
    permanent : float, eps_0/eps_max, the share of the largest strain that stays without tension
    bend : float, from 0 (straight) to 1 (a parabola that begins flat)
    T_max : float [N], largest tension held so far
    """

    permanent: float
    bend: float
    T_max: float = 0.0

    def __post_init__(self) -> None:
        self._check(permanent=self.permanent, bend=self.bend)

    @property
    def numbers(self) -> tuple[float, float]:
        return self.permanent, 0.0

    @property
    def shape(self) -> Rows:
        return _sampled(lambda xi: xi * (1.0 - self.bend + self.bend * xi))


@dataclass(frozen=True)
class Exponential(WorkingCurve):
    """Working curves that stiffen exponentially.

    Parameters
    ----------
    permanent : float, eps_0/eps_max, the share of the largest strain that stays without tension
    bend : float, positive
    T_max : float [N], largest tension held so far
    """

    permanent: float
    bend: float
    T_max: float = 0.0

    def __post_init__(self) -> None:
        self._check(permanent=self.permanent)
        bend = check_number("bend", self.bend, "", self.called, sign="positive")
        if bend > LARGEST_BEND:
            raise SceneError(f"Argument `bend` must be up to {LARGEST_BEND:g}, but {self.called} has bend={bend}.")
        object.__setattr__(self, "bend", bend)

    @property
    def numbers(self) -> tuple[float, float]:
        return self.permanent, 0.0

    @property
    def shape(self) -> Rows:
        return _sampled(lambda xi: math.expm1(self.bend * xi) / math.expm1(self.bend))


KINDS: dict[str, type[WorkingCurve]] = {"linear": Linear, "quadratic": Quadratic, "exponential": Exponential}
