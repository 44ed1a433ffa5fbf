"""Cables that stretch, cannot push and have no tension-strain curve, in a step of `edmc`: their law as constants of compiled code.

Most cables are such. Where the compiler knows, it leaves out the terms and the branches of all other laws, which for a group of
four cables take a fifth of the time of a residual.
"""

from anet_lumped.compiled.jit import inlined
from anet_lumped.compiled.lanes import column, lane
from anet_lumped.effects.laws.axial import Spring
from anet_lumped.mechanics.segment_law import CableLaw, group_constant, spring_of
from anet_lumped.model.tables import (
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_CURVE,
    CABLE_CURVE_END,
)
from integrators.stage import LAW_BETWEEN, Stage

CANNOT_PUSH, ONE_WAY_DAMPER, STRETCHES = 0.0, 0.0, 0.0  # as in ``Net.axial``


@inlined
def are_plain(stage_law, net, c):
    """Whether the cables of a group are such, and a stage with this law is one of `edmc`."""
    has_curve = lane(column(net.cable, c, CABLE_CURVE), 0) < lane(column(net.cable, c, CABLE_CURVE_END), 0)
    pushes = group_constant(net, c, AXIAL_PUSH_SHARE) + group_constant(net, c, AXIAL_TWO_WAY_DAMPER)
    return stage_law == LAW_BETWEEN and not has_curve and pushes + group_constant(net, c, AXIAL_INEXTENSIBLE) == 0.0


@inlined
def plain_stage(stage):
    """The stage, of which the compiler knows the law."""
    return Stage(LAW_BETWEEN, stage.t, stage.W, stage.theta, stage.tau, stage.dissipation)


@inlined
def law_of(net, c):
    """The law of any cable, or group: its spring, 1 for a two-way damper or else 0, and 1 if it does not stretch or else 0."""
    return spring_of(net, c), group_constant(net, c, AXIAL_TWO_WAY_DAMPER), group_constant(net, c, AXIAL_INEXTENSIBLE)


@inlined
def plain_law_of(net, c):
    """`law_of` plain cables."""
    return plain_spring(net, c), ONE_WAY_DAMPER, STRETCHES


@inlined
def plain_spring(net, c):
    """`segment_law.spring_of` plain cables."""
    return Spring(column(net.axial, c, AXIAL_STIFFNESS), CANNOT_PUSH, column(net.axial, c, AXIAL_L0), net.springs, 0, 0)


@inlined
def plain_cable_law(net, c, law):
    """The `CableLaw` of plain cables, of which the compiler knows what they are."""
    return CableLaw(
        plain_spring(net, c), law.steepest_slope, law.L0_at_start, law.damper, ONE_WAY_DAMPER, STRETCHES, law.taut, law.step,
        law.least_damper_share,
    )  # fmt: skip
