"""Kernels of scenes with cables that creep: residual, Newton step and account of a step of `edmc`; compiled for those alone."""

from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.effects.laws.creep import creep_of_step
from anet_lumped.mechanics.creeping_law import creep_of, creeping_cable_law, fast_spring
from anet_lumped.mechanics.newton_step import NEARLY_EQUAL
from anet_lumped.mechanics.optional import CableAccount, CableBalance
from anet_lumped.mechanics.plain_cables import law_of
from anet_lumped.mechanics.residual import EPS, cable_residual, joined
from anet_lumped.mechanics.segment_law import cable_law, reduced_slope, tension_law
from anet_lumped.mechanics.settle import cable_settle, sum_of_accounts
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import (
    AXIAL_L0,
    CABLE_END,
    CABLE_FIRST_NODE,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    CREEP_STATIC,
    CREPT_CHANGE,
    CREPT_STRETCH,
    SEGMENT_GEOMETRIC,
    SEGMENT_GRADIENT,
    SEGMENT_NUMERICAL_DAMPER,
    SEGMENT_STIFFNESS,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
)


@on_demand
def residual_of_creeping(stage, net_address, base, q, step, largest_coordinate):
    """`residual.cable_residual` of the cables that are in no group, some of which creep."""
    net, balance = view_net(net_address), CableBalance(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for c in net.single_cables:
        if net.creep[c, CREEP_STATIC] > 0.0:
            creep = creep_of(net, c, net.cable[c, CABLE_FIRST_SEGMENT])
            law = creeping_cable_law(stage, net, c, creep, step)
            own = cable_residual(stage, net, (c, 1), base, q, law, creep, largest_coordinate)
        else:
            own = cable_residual(stage, net, (c, 1), base, q, cable_law(stage, net, c, step), None, largest_coordinate)
        balance = joined(balance, own)
    return balance


@on_demand
def settle_of_creeping(stage, net_address, base, q, v):
    """`settle.cable_settle` of the cables that are in no group, some of which creep, summed."""
    net, account = view_net(net_address), CableAccount(0.0, 0.0, 0.0, 0.0, 0.0)
    for c in net.single_cables:
        if net.creep[c, CREEP_STATIC] > 0.0:
            own = cable_settle(stage, net, (c, 1), law_of(net, c), base, q, v, creep_of(net, c, net.cable[c, CABLE_FIRST_SEGMENT]))
        else:
            own = cable_settle(stage, net, (c, 1), law_of(net, c), base, q, v, None)
        account = sum_of_accounts(account, own)
    return account


@inlined
def _relinearise_cable(stage, net, c):
    """`newton_step._relinearise_cable` of a cable that creeps."""
    first, count, node = net.cable[c, CABLE_FIRST_SEGMENT], net.cable[c, CABLE_SEGMENTS], net.cable[c, CABLE_FIRST_NODE]
    L0, step, start, changed = net.axial[c, AXIAL_L0], net.newton_step, net.cable[c, CABLE_START], False
    x0, y0, z0 = step[start, 0], step[start, 1], step[start, 2]
    for j in range(count):
        i, s = node + j if j < count - 1 else net.cable[c, CABLE_END], first + j
        row, crept, T_linear, creep = net.segment[s], net.crept[s], net.tension[s], creep_of(net, c, s)
        gx, gy, gz = row[SEGMENT_GRADIENT], row[SEGMENT_GRADIENT + 1], row[SEGMENT_GRADIENT + 2]
        x1, y1, z1 = step[i, 0], step[i, 1], step[i, 2]
        more = gx * (x1 - x0) + gy * (y1 - y0) + gz * (z1 - z0)
        x0, y0, z0 = x1, y1, z1
        before, numerical = row[SEGMENT_STRETCH_BEFORE], row[SEGMENT_NUMERICAL_DAMPER]
        lengthening = row[SEGMENT_STRETCH] - before + crept[CREPT_CHANGE] + more
        found = creep_of_step(
            before, lengthening, crept[CREPT_STRETCH], stage.tau, stage.dissipation, numerical, net.springs, creep
        )
        before = before - found.offset
        stretch = before + lengthening - found.change
        if (T_linear > 0.0) if stretch > 0.0 else row[SEGMENT_TENSION] == 0.0:
            continue  # taut and stays taut, or slack and stays slack
        spring = fast_spring(net, found.fast_stiffness, L0)
        T, fast, _ = tension_law(stage, max(stretch, -L0), before, spring, creep.fast_damper, 0.0, numerical)
        slope = found.slope * fast / (found.slope + fast - found.softening)
        if abs(T - T_linear) > NEARLY_EQUAL * (abs(T) + abs(T_linear)) + 64.0 * EPS * creep.fast_stiffness:
            row[SEGMENT_STIFFNESS] = reduced_slope(stage, slope, row[SEGMENT_GEOMETRIC])
            row[SEGMENT_TENSION] = T - slope * more
            changed = True
    return changed


@on_demand
def relinearise_creep(stage, net_address):
    """Linearise anew each segment that creeps and that the Newton step turns slack or taut; 1 if there is one, else 0."""
    net, changed = view_net(net_address), False
    for c in range(net.cable.shape[0]):
        if net.creep[c, CREEP_STATIC] > 0.0:
            changed = _relinearise_cable(stage, net, c) or changed
    return 1 if changed else 0
