"""Solids in which cables sink deeper: a cable that is let down onto stiff ones meets each with another node, and Newton's method
takes one off for each that it puts on. So it is let down onto soft ones first.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.model.model import Model

DEPTHS = (2e-3, 2e-5)  # of half the smallest width, how deep a segment sinks in under its share of the load: one rest after another


def solids(model: Model) -> list[int]:
    """Numbers of the effects of a model that are solids."""
    return [e for e, effect in enumerate(model.forces) if np.isfinite(effect.narrowest)]


def with_soft_solids(model: Model, net: Any, load: float, share: float) -> Any:
    """The net with solids, none stiffer than that a node sinks in by a ``share`` of their width under a node's load [N].

    Parameters
    ----------
    model : Model
    net : Net
    load : float [N]
    share : float, see `DEPTHS`
    """
    areas = [cable.diameter * cable.L0 for cable in model.scene.cables if cable.diameter]
    if not areas:
        return net
    params = net.effects.params.copy()
    for e in solids(model):
        effect = model.forces[e]
        stiffness = load / (model.n_free * min(areas) * share * effect.narrowest)
        if stiffness < effect.stiffness:  # type: ignore[attr-defined]
            _, numbers = replace(effect, stiffness=stiffness).table(model)  # type: ignore[call-arg]
            params[net.effects.params_at[e] : net.effects.params_at[e + 1]] = numbers
    return net._replace(effects=net.effects._replace(params=params))
