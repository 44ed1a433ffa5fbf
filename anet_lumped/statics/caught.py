"""Nodes that obstacles press against what else holds them up: a cable caught between a pipe and the bed under it.

Where a solid and the ground overlap, or are nearer to each other than a node sinks in, both press a node between them, each against
the other. Their forces balance, and the energy of such a rest may fall along no direction. But a cable that is laid down does not
get there, and the forces are those of the depths of the solids, not of its weight.
"""

from typing import Any

import numpy as np

from anet_lumped.model.model import Model

from .forces_at_rest import force_of_effects
from .soft_contacts import solids

MOST = 1.0  # of the load: forces with which contacts may press against each other, of all nodes together


def is_caught(model: Model, net: Any, q: np.ndarray, load: float) -> bool:
    """Whether obstacles press nodes against other contacts by more than the load [N] in a shape q (n, 3) [m]."""
    obstacles = solids(model)
    if not obstacles:
        return False
    others = [
        e for e, effect in enumerate(model.forces) if e not in obstacles and not effect.dead_load and effect.coupled_neighbours == 0
    ]
    pressed, rest = (force_of_effects(model, net, q, some)[: model.n_free] for some in (obstacles, others))
    against = [np.linalg.norm(f, axis=1) for f in (pressed, rest, pressed + rest)]
    return bool((against[0] + against[1] - against[2]).sum() > MOST * load)


def where_caught(model: Model, net: Any, q: np.ndarray) -> str:
    """A clause: where obstacles press hardest, and by how much."""
    force = np.linalg.norm(force_of_effects(model, net, q, solids(model))[: model.n_free], axis=1)
    i = int(np.argmax(force))
    return f"{model.where(i)} at ({', '.join(f'{x:.4g}' for x in q[i])}), which is pressed by {force[i]:.3g} N from either side"
