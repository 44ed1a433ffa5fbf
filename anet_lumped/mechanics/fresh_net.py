"""The arrays of one run: the arrays of its model, scratch space of its own, and the kernels that the run needs."""

import numpy as np

from anet_lumped.compiled.lanes import WIDTH
from anet_lumped.mechanics.required_kernels import require
from anet_lumped.model import rest_lengths
from anet_lumped.model.net import NO_LINKS, NO_TRAILS, Carried, Net
from anet_lumped.model.tables import (
    BORDER_COLUMNS,
    BORDER_UNKNOWNS,
    CABLE_SEGMENTS,
    CREEP_COLUMNS,
    CREPT_COLUMNS,
    FACTOR_COLUMNS,
    FAR_FACTOR_COLUMNS,
    KERNELS,
    LINEARISED_BEGINNING,
    LINEARISED_COLUMNS,
    LINEARISED_FIRST_STEP,
    LINEARISED_LAW,
    LINEARISED_LEAST_DAMPER,
    LINEARISED_NO_LAW,
    LINEARISED_TAU,
    SEGMENT_COLUMNS,
)
from anet_lumped.model.trails import with_numbers
from anet_lumped.prescribed.paths import PathTable
from anet_lumped.prescribed.turning import matrix_of


def fresh_net(model, force=True, newton=True, links=False, observed=None, crept=None, shedding=None):
    """Make the arrays that compiled code works on, with fresh scratch space. Each run needs its own.

    Parameters
    ----------
    model : Model
    force, newton : bool
        Whether the run needs forces at one time, and whether it needs the stages of an implicit method.
    links : bool
        Whether its forces are those of links, cables that do not stretch.
    observed : bool or None
        Whether tensions and energies of its states are asked for; None where they are if the run needs forces or stages.
    crept : (2, n_segments) float64 or None
        Slow stretch of each segment at the start [m] and the largest tension that it has held [N], for a motion of cables that
        creep. None is for statics, and for scenes without.
    shedding : (n, 4) float64 or None
        Inner states of the nodes whose cables shed vortices, see `State`, for a motion of such a scene; else None.

    Returns
    -------
    Net
    """
    n, segments = model.n, model.n_segments
    couples, creeps = model.coupled_neighbours, crept is not None and model.creeps
    has_added_mass = any("inertia" in effect.kernels() for effect in model.forces)
    changing = len(model.lengths.cable) > 0  # rest lengths change: then masses and laws belong to the run
    axial = model.axial_of_fast_parts if creeps else model.axial.copy() if changing else model.axial
    effects = model.effects._replace(params=model.effects.params.copy())
    if shedding is not None and model.sheds:
        effects.params[effects.inner] = shedding[model.shedding_nodes].ravel()
    net = Net(
        n_free=model.n_free,
        n_interior=model.n_interior,
        mass=model.mass.copy() if changing else model.mass,
        node_segments=model.node_segments,
        cable=model.cable_of_fast_parts if creeps else model.cable,
        cable_groups=model.cable_groups,
        single_cables=model.single_cables,
        single_kinds=model.single_kinds,
        trails=with_numbers(*model.trails, axial) if force and not links else NO_TRAILS,
        axial=axial,
        springs=model.springs,
        creep=model.creep if creeps else np.zeros((0, CREEP_COLUMNS)),
        crept=np.column_stack([crept[0], np.zeros(segments), crept[1]]) if creeps else np.zeros((0, CREPT_COLUMNS)),
        paths=PathTable(*(numbers.copy() for numbers in model.path_table)),
        n_driven=model.n_driven,
        carried=_carried(model.scene, len(model.path_table.first) - 1),
        effects=effects,
        lengths=rest_lengths.of_a_run(model.lengths) if changing else model.lengths,
        points=model.symbolic.of_a_run(),
        bodies=model.bodies.of_a_run(),
        joints=model.joints.of_a_run(),
        segment=np.zeros((segments, SEGMENT_COLUMNS)),
        tension=np.zeros(segments),
        mean_tension=np.zeros(segments),
        linearised=nothing_linearised(),
        law_force=np.zeros((n, 3)),
        predicted_force=np.zeros((n - model.n_interior, 3)),
        right_side=np.zeros((n, 3)),
        diagonal=np.zeros((model.n_free, 3, 3)),
        factor=np.zeros((segments + _lanes_of_groups(model), FACTOR_COLUMNS)),
        border=np.zeros((segments, BORDER_COLUMNS)),
        far_factor=np.zeros((segments if couples > 1 else 0, FAR_FACTOR_COLUMNS)),
        border_work=np.zeros((6, BORDER_UNKNOWNS, BORDER_UNKNOWNS)),
        newton_step=np.zeros((n, 3)),
        middle_q=np.zeros((n, 3)),
        middle_v=np.zeros((n, 3)),
        near_blocks=np.zeros((model.near_rows if couples > 0 else 0, 2, 3, 3)),
        far_blocks=np.zeros((segments if couples > 1 else 0, 2, 3, 3)),
        added_mass=np.zeros((model.n_free if has_added_mass else 0, 3, 3)),
        breaking_tension=model.breaking_tension,
        observed_tension=np.zeros(len(model.breaking_tension)),
        remembered=np.zeros(
            (SEGMENT_COLUMNS + 2 + CREPT_COLUMNS * creeps) * len(model.breaking_tension) + LINEARISED_COLUMNS + len(effects.inner)
        ),
        links=model.links.of_a_run() if links else NO_LINKS,
        kernels=np.zeros(KERNELS, np.int64),
    ).addressed()
    require(net, model, force, newton, links, force or newton if observed is None else observed)
    if changing:
        from anet_lumped.mechanics.changing_lengths import set_lengths  # compiled for those scenes alone

        set_lengths(net.address, 0.0, 0.0, 0.0)
    return net


def _carried(scene, paths):
    """`Carried` of a scene whose paths are ``paths`` in number."""
    driven = [body for body in scene.bodies if body.is_driven]
    arms = [matrix_of(body.rotation) @ point.arm for body in driven for point in body.points]
    return Carried(
        body=np.array([b for b, body in enumerate(driven) for _ in body.points], np.int64),
        arm=np.array(arms, float).reshape(-1, 3),
        values=np.zeros((3, paths if driven else 0, 3)),
    )


def _lanes_of_groups(model):
    """Rows of ``Net.factor`` for the cables that are taken by fours, which stand behind those of the segments: `linear.chain`."""
    return WIDTH * int(model.cable[model.cable_groups[:, 0], CABLE_SEGMENTS].sum())


def nothing_linearised():
    """``Net.linearised`` before the first stage of a run."""
    linearised = np.zeros(LINEARISED_COLUMNS)
    linearised[LINEARISED_LAW], linearised[LINEARISED_TAU] = LINEARISED_NO_LAW, 1.0
    linearised[LINEARISED_BEGINNING], linearised[LINEARISED_LEAST_DAMPER] = LINEARISED_FIRST_STEP, 1.0
    return linearised
