"""Thermal expansion: an eigenstrain alpha dT of whole cables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from anet_lumped.checks import check_number_by_name
from anet_lumped.prescribed.signals import Signal, check_number_or_signal

from .effect import STRAIN, Effect, LengthChange, names_left


@dataclass(frozen=True)
class Temperature(Effect):
    """A change of temperature, which changes the rest length of cables: L(t) = L0 (1 + alpha dT(t)).

    The stiffness EA/L0 of a segment does not change: T = EA (l/L0 - 1 - alpha dT), the law of thermoelasticity for small strains.
    The work of the expansion against the tension counts as work put in. Source: Timoshenko & Goodier, Theory of Elasticity (1970),
    13.

    Parameters
    ----------
    expansion : float or dict of str and float [1/K]
        Coefficient alpha of all cables, or of those named.
    change : float or Signal [K]
        Temperature above the one at which the lengths of the cables are given.
    """

    expansion: float | dict[str, float] | tuple[tuple[str, float], ...]
    change: float | Signal

    def check_parameters(self) -> None:
        expansion = check_number_by_name("expansion", self.expansion, "1/K", self._called)
        self._set(expansion=expansion, change=check_number_or_signal("change", self.change, "K", self._called))

    @property
    def signals(self) -> tuple[Signal, ...]:
        return (self.change,) if isinstance(self.change, Signal) else ()

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(expansion=1e-5, change=10.0)

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        if not isinstance(self.expansion, tuple):
            return self
        expansions = [(piece, alpha) for name, alpha in self.expansion for piece in names_left(name, pieces)]
        return Temperature(tuple(expansions), self.change) if expansions else None

    def length_changes(self, scene: Any) -> Sequence[LengthChange]:
        """The strain alpha dT of each cable.

        Raises
        ------
        SceneError : an unknown cable
        """
        names = [cable.name for cable in scene.cables]
        expansions = dict.fromkeys(names, self.expansion) if isinstance(self.expansion, float) else dict(self.expansion)
        return [LengthChange(scene.cable(name).name, STRAIN, alpha, self.change) for name, alpha in expansions.items()]
