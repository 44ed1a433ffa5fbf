"""Cables that push and have nothing to keep them straight: how much their buckling multiplies the error of a place.

A force T along a segment of the length l holds its ends across it with the stiffness T/l. Where the segments at a node push, the
sum of these is negative, and a small displacement x across them obeys

    m x'' = -sum(T/l) x ,    x = x_0 exp(integral of sqrt(-sum(T/l)/m) dt) ,

as if the neighbours stood still; in truth they give way, and x grows faster. So does every difference of two runs. Chains of
springs that push (compression="linear") do this where they are thrown together.

A bending stiffness EI keeps a cable straight up to its load. Pushed by P = -T, a wave of the number k along it grows at the rate of

    mu rate^2 = P k^2 - EI k^4 ,

which is largest at k^2 = P/(2 EI). The longest wave is two cables long, k = pi/L, so that nothing grows below Euler's load
EI (pi/L)^2; the shortest has k^2 = 2/l^2, where neighbours stand still, and without EI this is the rate above.

Source: dynamic stability of columns, Bazant & Cedolin, Stability of Structures, 1991, chapters 1 and 3.
"""

from typing import Any

import numpy as np

TURNS = 2.0  # times its size, to which buckling must have brought an error for the run to say so; neighbours give way: it is more
SHORTEST = 1e-3  # of the rest length: a shorter segment pushes its ends aside as one of this length does
BENDS = 2  # neighbours that an effect couples which keeps a cable straight
NO_STIFFNESS = 1e-100  # [N m2] of bending, by which a force can be divided


def first_buckled(run: Any) -> float | None:
    """First saved time at which buckling has multiplied an error by `TURNS` [s]; None: never."""
    buckled = np.flatnonzero(buckling_exponents(run) > np.log(TURNS))
    return float(run.t[buckled[0]]) if len(buckled) else None


def buckling_exponents(run: Any) -> np.ndarray:
    """Integral of the rate at which buckling multiplies an error, the largest of all nodes, up to each saved time (k,).

    An effect that bends is taken to do so by the `EI` of the cables.
    """
    model, n_free = run.model, run.model.n_free
    pushes = run.segment_tension < 0.0
    if not pushes.any():
        return np.zeros(len(run.t))
    pushed = pushes.any(axis=1)
    pushed[1:-1] &= pushed[:-2] | pushed[2:]  # what pushes at one saved time alone multiplies nothing
    rows = np.flatnonzero(pushed)
    if len(rows) < 2:
        return np.zeros(len(run.t))
    bends = any(effect.coupled_neighbours >= BENDS for effect in run.scene.effects)
    stiffness = np.zeros((len(rows), model.n))
    for cable in run.scene.cables:
        nodes = model.nodes(cable.name)
        lengths = np.maximum(np.linalg.norm(np.diff(run.q[rows[:, None], nodes], axis=1), axis=2), SHORTEST * cable.L0)
        across = _across(run.tension(cable.name)[rows], lengths, cable.length, cable.EI if bends else 0.0)
        stiffness[:, nodes[:-1]] += across
        stiffness[:, nodes[1:]] += across
    mass = model.mass[:n_free]
    rate = np.sqrt(np.maximum(-stiffness[:, :n_free], 0.0) / np.where(mass > 0.0, mass, np.inf))
    in_a_row = np.diff(rows) == 1
    steps = np.where(in_a_row, np.diff(run.t)[rows[:-1]], 0.0)
    grown = np.cumsum(np.minimum(rate[1:], rate[:-1]) * steps[:, None], axis=0).max(axis=1, initial=0.0)
    exponents = np.zeros(len(run.t))
    exponents[rows[1:]] = grown
    return np.maximum.accumulate(exponents)


def _across(tension: np.ndarray, lengths: np.ndarray, whole: float, EI: float) -> np.ndarray:
    """Stiffness across a segment at each of its ends [N/m], negative where it pushes beyond what bending holds; of their shape.

    Parameters
    ----------
    tension, lengths : (k, segments) float64 [N], [m]
    whole : float [m], length of the cable
    EI : float [N m2]
    """
    square = np.minimum(np.maximum(-tension / (2.0 * max(EI, NO_STIFFNESS)), (np.pi / whole) ** 2), 2.0 / lengths**2)
    return np.where(tension < 0.0, np.minimum(0.5 * lengths * square * (tension + EI * square), 0.0), tension / lengths)
