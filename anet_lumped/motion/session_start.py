"""Where a session starts, in the coordinates that it computes in."""

from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.results.state import State
from anet_lumped.statics.first_state import first_state
from anet_lumped.statics.starts import Start


def start_near(near: Any, start: Start) -> State:
    """The state that a ``start``, as `simulate` takes it, means for a scene that was moved near the origin, see `near_origin`."""
    origin = np.array(near.origin, float)
    if isinstance(start, State):
        start = replace(start, q=start.q - origin)
    elif isinstance(start, dict):
        start = {name: np.asarray(shape) - origin for name, shape in start.items()}
    return first_state(near.scene, start)
