"""How far cables that creep have crept once their lengths have been held for long, and the largest tension that they have held."""

import numpy as np

from anet_lumped.model.tables import AXIAL_L0, CREEP_FAST, CREEP_PER_TENSION, CREEP_STATIC
from anet_lumped.scene.polyester import static_curve


def settled_creep(model, q):
    """Slow stretch of each segment where both its springs carry the static tension T.

    It is T/k - T/k_d, with T = k (l - L0), or that of `effects.laws.working_curve` for a polyester rope.

    Parameters
    ----------
    model : Model
    q : (n, 3) float64 [m]

    Returns
    -------
    crept : (n_segments,) float64 [m]
        Zero for slack segments, and for cables that do not creep.
    T_max : (n_segments,) float64 [N]
        Largest tension held, of polyester ropes; else zero.
    """
    a, b = model.ends.T
    length, law = np.linalg.norm(q[b] - q[a], axis=1), model.creep[model.cable_of]
    stretch = np.maximum(length - model.axial[model.cable_of, AXIAL_L0], 0.0)
    T = law[:, CREEP_STATIC] * stretch
    creeps = law[:, CREEP_STATIC] > 0.0
    fast_stiffness = np.where(creeps, law[:, CREEP_FAST] + law[:, CREEP_PER_TENSION] * T, 1.0)
    crept, T_max = np.where(creeps, stretch - T / fast_stiffness, 0.0), np.zeros(len(stretch))
    for cable in model.scene.cables:
        if cable.working_curve is not None:
            own = model.segments(cable.name)
            crept[own], T_max[own] = _of_polyester(cable, length[own])
    return crept, T_max


def _of_polyester(cable, length):
    """`settled_creep` of a polyester rope, of the lengths of its segments [m]."""
    kept, curve = static_curve(cable.tension_strain, cable.working_curve)
    strains, tensions = np.array([(0.0, 0.0), *curve]).T
    strain = np.maximum(length / cable.L0 - 1.0 - kept, 0.0) / (1.0 + kept)
    last = (tensions[-1] - tensions[-2]) / (strains[-1] - strains[-2])
    T = np.interp(strain, strains, tensions) + last * np.maximum(strain - strains[-1], 0.0)
    _, fast, per_tension, _ = cable.creep
    of_fast = np.log1p(per_tension * T / fast) / per_tension if per_tension else T / fast
    return cable.L0 * (kept + (1.0 + kept) * strain) - of_fast, np.maximum(T, cable.working_curve.T_max)
