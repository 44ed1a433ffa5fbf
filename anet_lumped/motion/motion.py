"""A motion that is marched, once or several times: where it starts from, for how long, and what is saved."""

from collections.abc import Callable
from typing import Any, NamedTuple

from anet_lumped.results.run import Run
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene
from integrators import schemes
from integrators.schemes.record import Origin, Scheme

from .choice import Choice
from .legs import Settings, march_legs


class Motion(NamedTuple):
    """See the module.

    Parameters
    ----------
    scene : Scene
    begin : State, that it starts from
    duration : float [s]
    save_every : float or None [s]
    settings : Settings
    """

    scene: Scene
    begin: State
    duration: float
    save_every: float | None
    settings: Settings

    def march(self, choice: Choice) -> Run:
        """Run by a method and step, through all events."""
        march = _march_of(schemes.scheme(choice.method))
        return march_legs(march, self.scene, choice, self.begin, self.begin.t + self.duration, self.save_every, self.settings)


def _march_of(scheme: Scheme) -> Callable[..., Any]:
    """What marches a leg with a scheme; JAX is imported, and computes in float64 from then on, for the solvers of diffrax."""
    if scheme.origin is Origin.OWN:
        from .own_methods import march
    elif scheme.origin is Origin.SCIPY:
        from .scipy_methods import march
    else:
        try:
            from .jax.diffrax_methods import march
        except ModuleNotFoundError as missing:
            raise ModuleNotFoundError(
                f'Method "{scheme.name}" needs the packages jax and diffrax, but there is no {missing.name}; '
                'pip install "anet-lumped[diffrax]" brings them.'
            ) from missing
    return march
