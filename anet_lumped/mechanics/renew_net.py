"""The arrays of a run taken for another run: those of a scene that differs in its numbers alone."""

import math

import numpy as np

from anet_lumped.mechanics.fresh_net import fresh_net, nothing_linearised
from anet_lumped.model.trails import with_numbers

SCRATCH = (
    "segment", "tension", "mean_tension", "law_force", "predicted_force", "right_side", "diagonal", "factor", "border",
    "far_factor", "border_work", "newton_step", "middle_q", "middle_v", "near_blocks", "far_blocks", "added_mass",
)  # fmt: skip
LINE = 8  # numbers in a cache line, at which each array begins
BEFORE_THE_FIRST_STAGE = nothing_linearised()
SCRATCH_OF_BODIES = ("arm_end", "arm_mean", "slowing", "state")


def renewable_net(model, **needs):
    """A `fresh_net` whose numbers are its own, so that it can be taken for other scenes with `renew`.

    Parameters
    ----------
    model : Model, that `can_be_renewed`
    needs : bool, `force`, `newton` and `links` of `fresh_net`
    """
    net = fresh_net(model, **needs)
    effects = net.effects._replace(index=net.effects.index.copy())
    own = {name: getattr(net, name).copy() for name in ("mass", "axial", "springs")}
    return net._replace(**own, **_in_one_block(net), effects=effects).addressed()


def _in_one_block(net):
    """Arrays for the scratch space of a net, one behind the other in one array of zeros, which `renew` clears at once."""
    sizes = [-(-getattr(net, name).size // LINE) * LINE for name in SCRATCH]
    block, begins = np.zeros(sum(sizes)), np.cumsum([0, *sizes])
    shapes = {name: getattr(net, name).shape for name in SCRATCH}
    return {
        name: block[begin : begin + math.prod(shape)].reshape(shape)
        for (name, shape), begin in zip(shapes.items(), begins[:-1].tolist(), strict=True)
    }


def can_be_renewed(model):
    """Whether a net of a model can be taken for others: no cable breaks, creeps, sheds vortices or changes its length in time."""
    return not (len(model.breaking_tension) or model.creeps or model.sheds or len(model.lengths.cable))


def renew(net, model):
    """Write the numbers of a model to a net of another one and clear its scratch space, as if it were fresh.

    Parameters
    ----------
    net : Net, from `renewable_net`; overwritten
    model : Model, that `can_be_renewed`

    Returns
    -------
    bool
        Whether that was possible: the arrays of both are of the same shapes, and the same functions are called. If not, some of the
        numbers may be written.
    """
    pairs = [
        (net.mass, model.mass), (net.axial, model.axial), (net.springs, model.springs),
        (net.effects.index, model.effects.index), (net.effects.params, model.effects.params),
        *zip(net.paths, model.path_table, strict=True),
    ]  # fmt: skip
    same = (
        (net.cable, model.cable), (net.cable_groups, model.cable_groups), (net.single_cables, model.single_cables),
        (net.effects.address, model.effects.address), (net.effects.params_at, model.effects.params_at),
        (net.bodies.arm, model.bodies.arm),
    )  # fmt: skip
    if len(net.trails.run):
        pairs.append((net.trails.number, with_numbers(*model.trails, model.axial).number))
    if net.effects.linear_in_node_state != model.effects.linear_in_node_state:
        return False
    for ours, theirs in same:
        if ours is not theirs and (ours.shape != theirs.shape or ours.tobytes() != theirs.tobytes()):  # faster than `array_equal`
            return False
    for ours, theirs in pairs:
        if ours.shape != theirs.shape:
            return False
        ours[...] = theirs
    net.segment.base.fill(0.0)  # the block of all in `SCRATCH`
    for name in SCRATCH_OF_BODIES:
        getattr(net.bodies, name).fill(0.0)
    net.points.block.fill(0.0)
    net.carried.values.fill(0.0)
    net.linearised[:] = BEFORE_THE_FIRST_STAGE
    return True
