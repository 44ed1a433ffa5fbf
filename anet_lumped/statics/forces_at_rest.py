"""Forces on the nodes of a shape at rest: of effects, and of all that acts."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from anet_lumped.model.model import Model


def force_of_effects(model: Model, net: Any, q: np.ndarray, effects: Iterable[int] | None = None) -> np.ndarray:
    """Force of effects on every node at rest (n, 3) [N]; ``effects`` are their numbers in the model, None all that act at rest."""
    f, v = np.zeros(q.shape), np.zeros(q.shape)
    if effects is None:
        effects = (e for e, effect in enumerate(model.forces) if not effect.no_force_at_rest)
    for e in effects:
        model.forces[e].kernels()["force"](0.0, q, v, *net.effects.numbers(e), f)
    return f


def node_forces(model: Model, net: Any, q: np.ndarray, tension: np.ndarray) -> np.ndarray:
    """Force of effects and of tensions (n_segments,) [N] on every node at rest (n, 3) [N]."""
    f = force_of_effects(model, net, q)
    a, b = model.ends.T
    d = q[b] - q[a]
    pull = tension[:, None] * d / np.maximum(np.linalg.norm(d, axis=1), 1e-300)[:, None]
    np.add.at(f, a, pull)
    np.add.at(f, b, -pull)
    return f
