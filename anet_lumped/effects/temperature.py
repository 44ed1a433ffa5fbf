"""Thermal expansion: an eigenstrain alpha dT of whole cables."""

from dataclasses import dataclass

from anet_lumped.checks import SceneError, check_number
from anet_lumped.prescribed.signals import Signal

from .signatures import STRAIN, names_left


@dataclass(frozen=True)
class Temperature:
    """A change of temperature that lengthens cables at rest, L(t) = L0 (1 + alpha dT(t)).

    The stiffness EA/L0 of a segment stays: T = EA (l/L0 - 1 - alpha dT), the law of thermoelasticity for small strains. The
    work that this does on a cable in tension is put in, not stored. Source: Timoshenko & Goodier, Theory of Elasticity (1970), 13.

    Parameters
    ----------
    expansion : float or dict of str and float [1/K]
        Coefficient alpha of all cables, or of those named.
    change : float or Signal [K]
        What the temperature is above that at which lengths are given.
    """

    expansion: float | dict[str, float] | tuple[tuple[str, float], ...]
    change: float | Signal

    def __post_init__(self):
        if isinstance(self.expansion, dict | tuple):
            pairs = self.expansion.items() if isinstance(self.expansion, dict) else self.expansion
            where = 'effect Temperature of cable "{}"'
            of = tuple((name, check_number("expansion", alpha, "1/K", where.format(name))) for name, alpha in pairs)
        else:
            of = check_number("expansion", self.expansion, "1/K", "effect Temperature")
        object.__setattr__(self, "expansion", of)
        if not isinstance(self.change, Signal):
            if not isinstance(self.change, int | float):
                raise SceneError(
                    f"Argument `change` must be a number [K] or a signal of anet_lumped.signals, but effect Temperature has "
                    f"change={self.change!r}."
                )
            object.__setattr__(self, "change", check_number("change", self.change, "K", "effect Temperature"))

    @property
    def signals(self):
        """The prescribed functions of time in it."""
        return (self.change,) if isinstance(self.change, Signal) else ()

    def of_pieces(self, pieces, cables):
        """The same change of temperature where cables have broken, see `anet_lumped.model.remainder`."""
        if not isinstance(self.expansion, tuple):
            return self
        of = [(piece, alpha) for name, alpha in self.expansion for piece in names_left(name, pieces)]
        return Temperature(tuple(of), self.change) if of else None

    def lengths(self, scene):
        """What changes rest lengths: (cable, `STRAIN`, alpha, dT) for each cable.

        Raises
        ------
        SceneError : an unknown cable
        """
        pairs = self.expansion if isinstance(self.expansion, tuple) else [(cable.name, self.expansion) for cable in scene.cables]
        return [(scene.cable(name).name, STRAIN, alpha, self.change) for name, alpha in pairs]
