"""Where a session starts, in the coordinates that it computes in."""

from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.model.build import build
from anet_lumped.results.run import State
from anet_lumped.statics.equilibrium import equilibrium
from anet_lumped.statics.starts import Start, start_state


def start_near(near: Any, start: Start) -> State:
    """The state that a ``start``, as `simulate` takes it, means for a scene that was moved near the origin, see `near_origin`."""
    origin = np.array(near.origin, float)
    if isinstance(start, str) and start == "equilibrium":
        return equilibrium(near.scene)
    if isinstance(start, State):
        start = replace(start, q=start.q - origin)
    elif isinstance(start, dict):
        start = {name: np.asarray(shape) - origin for name, shape in start.items()}
    return start_state(build(near.scene), start)
