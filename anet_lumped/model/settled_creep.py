"""How far cables that creep have crept once their lengths have been held for long."""

import numpy as np

from anet_lumped.model.tables import AXIAL_L0, CREEP_FAST, CREEP_PER_TENSION, CREEP_STATIC


def settled_creep(model, q):
    """Slow stretch of each segment where both its springs carry the static tension T = k (l - L0), T/k - T/k_d.

    Parameters
    ----------
    model : Model
    q : (n, 3) float64 [m]

    Returns
    -------
    crept : (n_segments,) float64 [m]
        Zero for slack segments, and for cables that do not creep.
    """
    a, b = model.ends.T
    stretch = np.maximum(np.linalg.norm(q[b] - q[a], axis=1) - model.axial[model.cable_of, AXIAL_L0], 0.0)
    law = model.creep[model.cable_of]
    T = law[:, CREEP_STATIC] * stretch
    creeps = law[:, CREEP_STATIC] > 0.0
    fast_stiffness = np.where(creeps, law[:, CREEP_FAST] + law[:, CREEP_PER_TENSION] * T, 1.0)
    return np.where(creeps, stretch - T / fast_stiffness, 0.0)
