"""How much of a cable lies on the ground.

A segment lies on the ground whose two nodes the ground presses. Each node carries half of the segments beside it. Of the last one
that is pressed the ground carries a part, none to all: so what lies ends between half a segment before that node and half a segment
behind it, and is known to half a segment where it lifts off. A support is not pressed; what it holds lies where the node beside it
does. A segment that broke does not count.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, quoted
from anet_lumped.model import rest_lengths
from anet_lumped.model.model import Model

from .end_forces import Rows, effect_forces


def touchdown_lengths(model: Model, parts: Sequence[Rows], cable: str, holds: Any) -> np.ndarray:
    """Unstretched length of a cable that lies on the ground, (k,) [m].

    Parameters
    ----------
    model : Model of the whole scene
    parts : Rows between one event and the next, k of them in all
    cable : name
    holds : (k, segments) bool, whether each segment of the cable has not broken

    Raises
    ------
    InputError : no ground in the scene
    """
    scene = model.scene
    segments = scene.cable(cable).segments
    if not any(effect.is_ground for effect in scene.effects):
        raise InputError(f"A cable lies on the ground of its scene, but the scene of cable {quoted(cable)} has none.")
    nodes, found = np.asarray(model.nodes(cable)), []
    for now in parts:
        pressed = np.zeros((len(now.t), model.n), bool)
        pressed[:, now.left.node] = effect_forces(now.left.model, now, only_ground=True).any(axis=2)
        along = pressed[:, nodes]
        for end, beside in ((0, 1), (-1, -2)):
            if nodes[end] >= model.n_free and segments > 1:
                along[:, end] = along[:, beside]
        found.append(along[:, :-1] & along[:, 1:])
    times = np.concatenate([now.t for now in parts])
    lengths = rest_lengths.at_time(scene, times).get(cable, scene.cable(cable).length)
    return (np.concatenate(found) * holds).sum(axis=1) * lengths / segments
