"""Vibrations along cables that a method took, and how far across them nodes could be off without these.

Where light cables vibrate along themselves by a share of their tension, waves across them run at another speed: the shape that a
quick change of the tension leaves is not the one of its mean (Landau & Lifshitz, Mechanics, 1976, section 30). A run from which the
method took the vibration does not show that, nor does one with other steps from which it took it, too. How far nodes are off is
bounded by what the energy E that is missing could do: in the lowest swing across, A sin(pi s/L), a cable of the length L with the
tension T holds pi^2 T A^2/(4 L). Of weights that are struck or blown upon, errors are half of this A to all of it.
"""

import math
from typing import Any

import numpy as np

from integrators import schemes

CONSIDERABLE = 0.2  # of the mean tensions: vibrations that change the waves across a cable
SAID = 5e-3  # of the longest cable: what a run at a given step says of it


def lost_sway(run: Any) -> float:
    """Amplitude across cables that they could have with the energy which the method took of their vibrations [m].

    All cables alike, which have the same share of that energy. 0 where these vibrations were no considerable part of the tensions,
    and of a method that takes from other motions as well: only `edmc` books what it takes, of stretching alone.
    """
    cables = [cable for cable in run.scene.cables if not cable.inextensible]
    lost = run.energy_balance.by_method or 0.0
    if not cables or not lost > 0.0 or not schemes.scheme(run.method).books_its_losses:
        return 0.0
    mean = np.maximum(run.segment_tension, 0.0).mean(axis=0)
    tensions = [float(mean[run.model.segments(cable.name)].mean()) for cable in cables]
    stiffness_across = sum(tension / cable.length for tension, cable in zip(tensions, cables, strict=True))
    vibration = math.sqrt(2.0 * lost * sum(cable.EA_fast / cable.length for cable in cables))
    if stiffness_across <= 0.0 or vibration < CONSIDERABLE * sum(tensions):
        return 0.0
    return 2.0 / math.pi * math.sqrt(lost / stiffness_across)


def said_sway(run: Any) -> float:
    """`lost_sway`, 0 where that is less than `SAID` of the longest cable [m]."""
    sway = lost_sway(run)
    return sway if sway > SAID * run.scene.longest else 0.0
