"""The area with which cables touch a ground: d L0/2 at either end of each segment.

Source: Hall & Goupee, Ocean Eng. 104 (2015) 590, eq. 16.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from anet_lumped.effects.laws.diameters import check_diameters

CONTACT = {"stiffness": ("Pa/m", "positive"), "damping": ("Pa·s/m", "non-negative"), "friction": ("", "non-negative")}
"""Units and signs of what all effects of contact have, for `Effect._check_numbers`."""
OF_GROUND = CONTACT | {"stiffness": ("Pa/m", "non-negative")}
"""Likewise of a ground, which may be one that only damps: a bottom of mud, in which all sinks until something else holds it."""
SLIP_SPEED = "m/s", "positive"


def sums_over_halves(model: Any, effect: str, columns: int, numbers: Callable[[Any, float], Sequence[float]]) -> np.ndarray:
    """Sum of numbers over the half segments that each node has.

    Parameters
    ----------
    model : Model
    effect : str
        Name of the class of effects that asks.
    columns : int
    numbers : callable (cable, area) -> (columns,) floats
        What half a segment of a cable, of an area [m2], adds to its node.

    Returns
    -------
    sums : (n, columns) float64

    Raises
    ------
    SceneError : a cable without a diameter
    """
    check_diameters(model.scene.cables, f"effect {effect}")
    rows = [numbers(cable, 0.5 * cable.diameter * cable.L0) for cable in model.scene.cables]
    stubs = [(model.node(point), numbers(cable, 0.5 * cable.diameter * cable.L0)) for point, cable in model.scene.stubs]
    sums = np.zeros((model.n, columns))
    for c, row in enumerate(rows):
        first, count = model.segment_run(c)
        for ends in model.ends[first : first + count].T:
            np.add.at(sums, ends, row)
    for node, row in stubs:
        sums[node] += row
    return sums


def half_stiffnesses(model: Any, effect: str, stiffness: float) -> np.ndarray:
    """Stiffness k d L0/2 of half of each segment, (segments,) [N/m], for ``stiffness`` k [Pa/m].

    Raises
    ------
    SceneError : a cable without a diameter
    """
    check_diameters(model.scene.cables, f"effect {effect}")
    return np.array([0.5 * stiffness * cable.diameter * cable.L0 for cable in model.scene.cables])[model.cable_of]


def frequencies(cables: Sequence[Any], stiffness: float) -> list[float]:
    """Circular frequency of the mass of each cable's segments on the springs under it, sqrt(k d/mu) [rad/s].

    ``stiffness`` k is a pressure per depth [Pa/m].
    """
    return [math.sqrt(stiffness * (cable.diameter or 0.0) / cable.mass_per_length) for cable in cables]
