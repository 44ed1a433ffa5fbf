"""The net that several files of tests march, and a state to march it from."""

import numpy as np
from systems import MU

from anet_lumped import (
    Cable,
    Driven,
    Fixed,
    Free,
    Scene,
    State,
)
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths


def small_net(turn=None, shift=(0.0, 0.0, 0.0), order=None, flipped=(), compression="none", zeta=0.2):
    """A net with a junction, a loose end, a parallel pair and a driven corner, turned, shifted, reordered, reversed."""
    R, shift = np.eye(3) if turn is None else turn, np.array(shift)

    def at(*x):
        return tuple(R @ x + shift)

    points = [
        Fixed("a", at(0, 0, 0)),
        Driven("b", paths.harmonic(at(0.8, 0, 0.1), tuple(R @ (0, 0.05, 0.1)), 2.0, ramp=0.2)),
        Free("x", mass=0.02, at=at(0.4, 0.1, -0.2)),
        Free("y", at=at(0.5, 0.6, -0.3)),
    ]
    links = [("a", "x", 4, None), ("x", "b", 3, None), ("x", "y", 3, None), ("x", "b", 2, "second")]
    cables = [
        Cable(
            *((q, p) if (name or f"{p}-{q}") in flipped else (p, q)), length=0.5, mass_per_length=MU, EA=200.0, zeta=zeta,
            segments=n, name=name or f"{p}-{q}", compression=compression,
        )
        for p, q, n, name in links
    ]  # fmt: skip
    if order is not None:
        rng = np.random.default_rng(order)
        points, cables = ([items[i] for i in rng.permutation(len(items))] for items in (points, cables))
    return Scene(points, cables, [Gravity(9.81, tuple(R @ (0, 0.1, -1))), ViscousDamping(0.3)])


def state(scene, q, v=None):
    model = build(scene)
    return State(model, 0.0, q, np.zeros_like(q) if v is None else v, np.zeros(model.n_segments))
