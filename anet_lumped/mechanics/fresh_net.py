"""The arrays of one run: those of a model, with scratch space of their own."""

import numpy as np

from anet_lumped.mechanics.set_lengths import set_lengths
from anet_lumped.model import rest_lengths
from anet_lumped.model.net import Net
from anet_lumped.model.tables import SEGMENT_COLUMNS
from anet_lumped.prescribed.paths import pack
from anet_lumped.scene.scene import Driven


def fresh_net(model):
    """The arrays that compiled code works on, with fresh scratch space: one a run."""
    n, segments = model.n, model.n_segments
    couples = max((effect.coupled_neighbours for effect in model.forces), default=0)
    heavier = any("inertia" in effect.kernels() for effect in model.forces)
    changing = len(model.lengths.cable) > 0  # then masses, laws and effects' numbers are the run's own
    effects = model.effects._replace(params=model.effects.params.copy()) if changing else model.effects
    net = Net(
        n_free=model.n_free,
        n_interior=model.n_interior,
        mass=model.mass.copy() if changing else model.mass,
        degree=np.bincount(model.ends.ravel(), minlength=n).astype(float),
        cable=model.cable,
        group=model.group,
        alone=model.alone,
        axial=model.axial.copy() if changing else model.axial,
        springs=model.springs,
        paths=pack([point.path for point in model.scene.points if isinstance(point, Driven)]),
        n_driven=model.n_driven,
        effects=effects,
        lengths=rest_lengths.of_a_run(model.lengths) if changing else model.lengths,
        points=model.symbolic._replace(block=np.zeros_like(model.symbolic.block)),
        segment=np.zeros((segments, SEGMENT_COLUMNS)),
        tension=np.zeros(segments),
        mean=np.zeros(segments),
        linearised=np.array([-1.0, 1.0, 2.0, 1.0, 0.0]),
        pull=np.zeros((n, 3)),
        kept=np.zeros((n - model.n_interior, 3)),
        right=np.zeros((n, 3)),
        diagonal=np.zeros((model.n_free, 3, 3)),
        factor=np.zeros((segments, 16)),
        border=np.zeros((segments, 16)),
        further=np.zeros((segments if couples > 1 else 0, 12)),
        carried=np.zeros((6, 4, 4)),
        step=np.zeros((n, 3)),
        middle_q=np.zeros((n, 3)),
        middle_v=np.zeros((n, 3)),
        near=np.zeros((segments if couples > 0 else 0, 2, 3, 3)),
        far=np.zeros((segments if couples > 1 else 0, 2, 3, 3)),
        added=np.zeros((model.n_free if heavier else 0, 3, 3)),
        strength=model.strength,
        observed=np.zeros(len(model.strength)),
        remembered=np.zeros(16 * len(model.strength) + 5),
        solver=_solver(couples) if couples else 0,
    ).placed()
    if changing:
        set_lengths(net.place, 0.0, 0.0, 0.0)
    return net


def _solver(couples):
    from anet_lumped.mechanics.linear.coupled import solver  # on demand: what it compiles is not asked for by most nets

    return solver(couples)
