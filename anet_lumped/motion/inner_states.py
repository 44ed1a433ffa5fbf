"""What segments of cables that creep remember, in one array: slow stretches [m], and the largest tensions held for long [N]."""

from typing import Any

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.net import Net
from anet_lumped.model.settled_creep import settled_creep
from anet_lumped.model.tables import CREPT_STRETCH, CREPT_T_MAX
from anet_lumped.results.run import Run
from anet_lumped.results.state import State


def inner_of(result: Run | State) -> np.ndarray | None:
    """The inner states of a Run (2, k, n_segments), or of a State (2, n_segments); None where there are none."""
    if result.crept is None:
        return None
    return np.stack([result.crept, np.zeros_like(result.crept) if result.T_max is None else result.T_max])


def inner_of_net(net: Net) -> np.ndarray:
    """(2, n_segments) inner states that a march has reached."""
    return net.crept[:, [CREPT_STRETCH, CREPT_T_MAX]].T


def inner_at_start(model: Model, start: State) -> np.ndarray | None:
    """(2, n_segments) inner states that a run starts from, by themselves those of lengths held for long; None if nothing creeps."""
    if not model.creeps:
        return None
    given = inner_of(start)
    return np.stack(settled_creep(model, start.q)) if given is None else given


def split_inner(model: Model, inner: np.ndarray | None) -> dict[str, Any]:
    """Fields `crept` and `T_max` of a Run or a State with inner states, (2, ..., n_segments)."""
    works = any(cable.working_curve is not None for cable in model.scene.cables)
    return {"crept": None if inner is None else inner[0], "T_max": inner[1] if inner is not None and works else None}
