"""How much longer cables are than at rest: over the length that is paid out at a time, and of the segments that hold."""

from typing import Any

import numpy as np

from anet_lumped.model.rest_lengths import at_time


def stretch(run: Any, cable: str) -> np.ndarray:
    """Stretched length of a cable over its length at rest, less 1, at each saved time, (k,); 0 where all of it broke.

    A winch and a temperature change the length at rest; what they do is no stretch.

    Parameters
    ----------
    run : Run
    cable : str, name
    """
    rest = run.rest_lengths.get(cable, run.scene.cable(cable).length) * run.holds(cable).mean(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(rest > 0.0, run.length(cable) / rest - 1.0, 0.0)


def stretch_of_state(state: Any, cable: str) -> float:
    """The same of a State."""
    whole, held = state.scene.cable(cable), state.holds(cable).mean()
    rest = at_time(state.scene, state.t).get(cable, whole.length) * held
    return state.length(cable) / rest - 1.0 if rest > 0.0 else 0.0
