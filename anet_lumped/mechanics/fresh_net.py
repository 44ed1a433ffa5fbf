"""The arrays of one run: those of a model, with scratch space of their own, and the kernels that the run needs."""

import numpy as np

from anet_lumped.mechanics.required_kernels import require
from anet_lumped.model import rest_lengths
from anet_lumped.model.net import Net
from anet_lumped.model.tables import KERNELS, SEGMENT_COLUMNS
from anet_lumped.prescribed.paths import pack
from anet_lumped.scene.scene import Driven


def fresh_net(model, force=True, newton=True):
    """The arrays that compiled code works on, with fresh scratch space: one a run.

    Parameters
    ----------
    model : Model
    force, newton : bool
        Whether forces at one time, and stages of an implicit method, are asked of it.

    Returns
    -------
    Net
    """
    n, segments = model.n, model.n_segments
    couples = model.coupled_neighbours
    heavier = any("inertia" in effect.kernels() for effect in model.forces)
    changing = len(model.lengths.cable) > 0  # then masses, laws and effects' numbers are the run's own
    effects = model.effects._replace(params=model.effects.params.copy()) if changing else model.effects
    net = Net(
        n_free=model.n_free,
        n_interior=model.n_interior,
        mass=model.mass.copy() if changing else model.mass,
        node_segments=np.bincount(model.ends.ravel(), minlength=n).astype(float),
        cable=model.cable,
        cable_groups=model.cable_groups,
        single_cables=model.single_cables,
        single_kinds=model.single_kinds,
        axial=model.axial.copy() if changing else model.axial,
        springs=model.springs,
        paths=pack([point.path for point in model.scene.points if isinstance(point, Driven)]),
        n_driven=model.n_driven,
        effects=effects,
        lengths=rest_lengths.of_a_run(model.lengths) if changing else model.lengths,
        points=model.symbolic._replace(block=np.zeros_like(model.symbolic.block)),
        segment=np.zeros((segments, SEGMENT_COLUMNS)),
        tension=np.zeros(segments),
        mean_tension=np.zeros(segments),
        linearised=np.array([-1.0, 1.0, 2.0, 1.0, 0.0]),
        law_force=np.zeros((n, 3)),
        predicted_force=np.zeros((n - model.n_interior, 3)),
        right_side=np.zeros((n, 3)),
        diagonal=np.zeros((model.n_free, 3, 3)),
        factor=np.zeros((segments, 16)),
        border=np.zeros((segments, 16)),
        far_factor=np.zeros((segments if couples > 1 else 0, 12)),
        border_work=np.zeros((6, 4, 4)),
        newton_step=np.zeros((n, 3)),
        middle_q=np.zeros((n, 3)),
        middle_v=np.zeros((n, 3)),
        near_blocks=np.zeros((segments if couples > 0 else 0, 2, 3, 3)),
        far_blocks=np.zeros((segments if couples > 1 else 0, 2, 3, 3)),
        added_mass=np.zeros((model.n_free if heavier else 0, 3, 3)),
        breaking_tension=model.breaking_tension,
        observed_tension=np.zeros(len(model.breaking_tension)),
        remembered=np.zeros(16 * len(model.breaking_tension) + 5),
        kernels=np.zeros(KERNELS, np.int64),
    ).addressed()
    require(net, model, force, newton)
    if changing:
        from anet_lumped.mechanics.changing_lengths import set_lengths  # compiled for those scenes alone

        set_lengths(net.address, 0.0, 0.0, 0.0)
    return net
