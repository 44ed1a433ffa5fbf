"""A rest whose cables are stretched by more than any material stands."""

import warnings

import numpy as np

from anet_lumped.checks import quoted
from anet_lumped.model import rest_lengths
from anet_lumped.results.state import State

MEANT = 2.0  # largest strain that may be meant: a rubber cord tears at 5, and its law is straight up to about 1


def warn_of_strain(rest: State, stacklevel: int) -> None:
    """Warn of the cable that is stretched most, if its strain is more than `MEANT`.

    Parameters
    ----------
    rest : State
    stacklevel : int, as `warnings.warn` takes it, counted from the caller
    """
    model, scene = rest.model, rest.scene
    lengths = rest_lengths.at_time(scene, 0.0)
    L0 = np.array([lengths.get(cable.name, cable.length) / cable.segments for cable in scene.cables])[model.cable_of]
    strain = np.linalg.norm(rest.q[model.ends[:, 1]] - rest.q[model.ends[:, 0]], axis=1) / L0 - 1.0
    if not strain.max(initial=0.0) > MEANT:
        return
    s = int(np.argmax(strain))
    cable = scene.cables[model.cable_of[s]]
    warnings.warn(
        f"A cable at rest should stretch by no more than {MEANT:.0%}, but cable {quoted(cable.name)} stretches by {strain[s]:.3g} "
        f"of its length: its EA is {cable.EA:g} N, and its tension {rest.segment_tension[s]:.3g} N; check EA and the loads.",
        stacklevel=stacklevel + 1,
    )
