"""Cables that push and have nothing to keep them straight: how much their buckling multiplies the error of a place.

A force T along a segment of the length l holds its ends across it with the stiffness T/l. Where the segments at a node push, the
sum of these is negative, and a small displacement x across them obeys

    m x'' = -sum(T/l) x ,    x = x_0 exp(integral of sqrt(-sum(T/l)/m) dt) ,

as if the neighbours stood still; in truth they give way, and x grows faster. So does every difference of two runs. Chains of
springs that push (compression="linear") do this where they are thrown together.

Source: dynamic stability of columns, Bazant & Cedolin, Stability of Structures, 1991, chapter 3.
"""

from typing import Any

import numpy as np

TURNS = 4.0  # times its size, to which buckling must have brought an error for the run to say so
SHORTEST = 1e-3  # of the rest length: a shorter segment pushes its ends aside as one of this length does
BENDS = 2  # neighbours that an effect couples which keeps a cable straight


def first_buckled(run: Any) -> float | None:
    """First saved time at which buckling has multiplied an error by `TURNS` [s]; None: never.

    None for a scene with an effect that bends, which keeps what pushes straight up to a load of its own.
    """
    model, n_free = run.model, run.model.n_free
    if not (run.segment_tension < 0.0).any() or any(effect.coupled_neighbours >= BENDS for effect in run.scene.effects):
        return None
    stiffness = np.zeros((len(run.t), model.n))
    for cable in run.scene.cables:
        nodes = model.nodes(cable.name)
        lengths = np.linalg.norm(np.diff(run.q[:, nodes], axis=1), axis=2)
        per_length = run.tension(cable.name) / np.maximum(lengths, SHORTEST * cable.L0)
        stiffness[:, nodes[:-1]] += per_length
        stiffness[:, nodes[1:]] += per_length
    mass = model.mass[:n_free]
    rate = np.sqrt(np.maximum(-stiffness[:, :n_free], 0.0) / np.where(mass > 0.0, mass, np.inf))
    grown = np.cumsum(np.minimum(rate[1:], rate[:-1]) * np.diff(run.t)[:, None], axis=0).max(axis=1, initial=0.0)
    buckled = np.flatnonzero(grown > np.log(TURNS))
    return float(run.t[1 + buckled[0]]) if len(buckled) else None
