"""Cables that are paid out or reeled in."""

from dataclasses import dataclass

from anet_lumped.checks import SceneError
from anet_lumped.prescribed.signals import Signal

from .signatures import PAID_OUT


@dataclass(frozen=True)
class LineChange:
    """A length paid out as a function of time, L(t) = L0 + p(t); p falls where a cable is reeled in.

    All segments of a cable share the change, so that material moves along the cable from segment to segment: its momentum
    against the nodes is left out, which holds while p' is slow beside the motion. Mass per length, EA and BA, or the damping ratio
    where that was given, stay those of the material, and masses, weights and drag follow the length. Mass that comes or goes has
    the velocity of its node, so that M(t) dv/dt = f(t). What the winch gives counts as work: -T p' less the strain energy that
    leaves with the material, and the kinetic and potential energy of the mass.

    Parameters
    ----------
    paid_out : dict or pairs of str and Signal [m]
        Cables, and what is paid out of each besides its `length`.
    """

    paid_out: dict[str, Signal] | tuple[tuple[str, Signal], ...]

    def __post_init__(self):
        pairs = tuple(self.paid_out.items() if isinstance(self.paid_out, dict) else self.paid_out)
        if not pairs:
            raise SceneError("Argument `paid_out` of LineChange must name at least one cable, but it is empty.")
        for name, signal in pairs:
            if not isinstance(signal, Signal):
                raise SceneError(
                    f'Argument `paid_out` must hold signals of anet_lumped.signals [m], but for cable "{name}" LineChange has '
                    f"{signal!r}."
                )
        object.__setattr__(self, "paid_out", pairs)

    @property
    def signals(self):
        """The prescribed functions of time in it."""
        return tuple(signal for _, signal in self.paid_out)

    def lengths(self, scene):
        """What changes rest lengths: (cable, `PAID_OUT`, 1, length) for each cable named.

        Raises
        ------
        SceneError : an unknown cable, or one that may break: what is left on the winch would be unknown
        """
        for name, _ in self.paid_out:
            if scene.cable(name).breaking_tension is not None:
                raise SceneError(
                    f'A cable that is paid out must have no `breaking_tension`, but cable "{name}" of LineChange has '
                    f"breaking_tension={scene.cable(name).breaking_tension} N."
                )
        return [(scene.cable(name).name, PAID_OUT, 1.0, signal) for name, signal in self.paid_out]
