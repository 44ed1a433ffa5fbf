"""The sag of a cable: how far its nodes are below its chord."""

from typing import Any

import numpy as np


def below_chord(points: np.ndarray, start: np.ndarray, end: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Distance of points below the straight line through a cable's ends, along gravity; its largest value is the sag.

    Parameters
    ----------
    points : (m, 3) float64 [m]
    start, end : (3,) float64 [m]
    up : (3,) float64
        Unit vector against gravity.

    Returns
    -------
    (m,) float64 [m]
        Below the lower end if one end is straight above the other.
    """
    chord, offset = end - start, points - start
    rise = chord @ up
    level = chord - rise * up
    span = level @ level
    if span <= (1e-12 * np.abs(points).max(initial=0.0)) ** 2:
        return min(rise, 0.0) - offset @ up
    return offset @ level / span * rise - offset @ up


def sag(state: Any, cable: str) -> float:
    """Largest distance of a cable's nodes below its chord, along gravity [m]; NaN where nothing weighs.

    Parameters
    ----------
    state : State
    cable : name
    """
    gravity = state.scene.gravity
    weight = np.linalg.norm(gravity)
    if not weight:
        return float("nan")
    if state.scene.cable(cable).segments == 1:  # it is its chord
        return 0.0
    shape = state.shape(cable)
    return float(below_chord(shape, shape[0], shape[-1], -gravity / weight).max())
