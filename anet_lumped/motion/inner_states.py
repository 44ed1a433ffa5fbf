"""What a step leaves to the next one beside places and velocities, of cables that creep and of cables that shed vortices.

Of segments that creep, in one array: slow stretches [m], and the largest tensions held for long [N]. Of nodes: see `State`.
"""

from typing import Any

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.net import Net
from anet_lumped.model.settled_creep import settled_creep
from anet_lumped.model.tables import CREPT_STRETCH, CREPT_T_MAX
from anet_lumped.results.run import Run
from anet_lumped.results.state import State

SHED = 4  # inner states of a node: phase, frequency, mean squares of velocity and acceleration across the flow


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


def shedding_at_start(model: Model, start: State) -> np.ndarray | None:
    """(n, 4) inner states that nodes start from; None if no cable sheds vortices.

    Nodes with none of their own have phases spread over a turn along their cable, and its Strouhal number as frequency.
    """
    if not model.sheds:
        return None
    shedding = np.zeros((model.n, SHED)) if start.shedding is None else start.shedding.copy()
    for cable in model.scene.cables:
        nodes = model.nodes(cable.name)[1:-1]
        new = nodes[shedding[nodes, 1] == 0.0]
        if cable.Cl and len(new):
            phases = 2.0 * np.pi * np.arange(1, cable.segments) / cable.segments
            shedding[new, 0], shedding[new, 1] = phases[shedding[nodes, 1] == 0.0], cable.St
    return shedding


def shedding_of_net(model: Model, net: Net) -> np.ndarray:
    """(n, 4) inner states of nodes that a march has reached."""
    return shedding_of_rows(model, net.effects.params[net.effects.inner])


def shedding_of_rows(model: Model, rows: np.ndarray) -> np.ndarray:
    """(..., n, 4) inner states of nodes, of rows (..., m) as they are observed."""
    shedding = np.zeros((*rows.shape[:-1], model.n, SHED))
    shedding[..., model.shedding_nodes, :] = rows.reshape(*rows.shape[:-1], -1, SHED)
    return shedding
