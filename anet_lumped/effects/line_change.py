"""Cables that are paid out or reeled in."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from anet_lumped.checks import SceneError, check_pairs, quoted, shown
from anet_lumped.prescribed import signals
from anet_lumped.prescribed.signals import Signal

from .effect import PAID_OUT, Effect, LengthChange


@dataclass(frozen=True)
class LineChange(Effect):
    """A length p(t) paid out, L(t) = L0 + p(t); p falls while a cable is reeled in.

    All segments of a cable share the change, so that material moves along the cable from segment to segment. The momentum of that
    motion is left out, which holds while dp/dt is slow against the motion of the cable. Mass per length, EA and BA (or the damping
    ratio if that was given) stay those of the material; masses, weights and drag follow the length. Mass that is paid out or reeled
    in has the velocity of its node, so that M(t) dv/dt = f(t). What the winch gives counts as work put in: -T dp/dt, the strain
    energy of the material that leaves or comes, and the kinetic and potential energy of its mass.

    Parameters
    ----------
    paid_out : dict or pairs of str and Signal [m]
        The length paid out of each cable named, added to its `length`.
    """

    paid_out: dict[str, Signal] | tuple[tuple[str, Signal], ...]

    def check_parameters(self) -> None:
        pairs = check_pairs("paid_out", self.paid_out, "a cable's name and a signal", self._called)
        for name, signal in pairs:
            if not isinstance(signal, Signal):
                raise SceneError(
                    f"Argument `paid_out` must hold signals of anet_lumped.signals [m], but {self._called} has for cable "
                    f"{quoted(name)} paid_out={shown(signal)}."
                )
        self._set(paid_out=pairs)

    @property
    def signals(self) -> tuple[Signal, ...]:
        return tuple(dict(self.paid_out).values())

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls({scene.cables[0].name: signals.line(0.0, 0.01, 0.0)})

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> Effect | None:
        """Cables that it pays out do not break; what is left is of those that there are."""
        there = {cable.name for cable in cables}
        left = tuple((name, signal) for name, signal in dict(self.paid_out).items() if name in there)
        return LineChange(left) if left else None

    def length_changes(self, scene: Any) -> Sequence[LengthChange]:
        """The length paid out of each cable named.

        Raises
        ------
        SceneError : an unknown cable, or one that may break, since the length on the winch would then be unknown
        """
        for name in dict(self.paid_out):
            if scene.cable(name).breaking_tension is not None:
                raise SceneError(
                    f"A cable that is paid out must have no `breaking_tension`, but cable {quoted(name)} of LineChange has "
                    f"breaking_tension={scene.cable(name).breaking_tension} N."
                )
        return [LengthChange(scene.cable(name).name, PAID_OUT, 1.0, signal) for name, signal in dict(self.paid_out).items()]
