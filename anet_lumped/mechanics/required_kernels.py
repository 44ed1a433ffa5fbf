"""Which of the kernels in `optional` a run needs, and their addresses."""

from anet_lumped.compiled.addresses import address_of
from anet_lumped.mechanics.optional import SIGNATURES
from anet_lumped.model import tables


def require(net, model, force=False, newton=False, links=False, observed=False):
    """Write the addresses of the kernels that a run needs to ``net.kernels``; compile those that have not been compiled.

    Parameters
    ----------
    net : Net
    model : Model
    force, newton : bool
        Whether the run needs forces at one time, and whether it needs the stages of an implicit method.
    links : bool
        Whether its forces are those of links, cables that do not stretch.
    observed : bool
        Whether tensions and energies of its states are asked for.
    """
    groups, singles = len(net.cable_groups) > 0, len(net.single_cables) > 0
    if model.n_driven < model.n:
        from anet_lumped.mechanics import drive

        _write(net, "DRIVE", "drive", drive.drive)
    if len(net.points.fronts.front):
        from anet_lumped.mechanics.linear import fronts

        _write(net, "SOLVE_FRONTS", "solve_fronts", fronts.solve_fronts)
    if len(net.lengths.cable):
        from anet_lumped.mechanics import changing_lengths

        for name in ("set_lengths", "power_of_lengths", "work_of_lengths", "energy_of_paid_out"):
            _write(net, name.upper(), name, getattr(changing_lengths, name))
    if observed and not links:
        from anet_lumped.mechanics import observe

        one = observe.observe_of_creeping if len(net.creep) else observe.observe_of_singles
        _write_both(net, "observe", one if singles else None, observe.observe_of_groups if groups else None)
    if force and not links:
        from anet_lumped.mechanics import force as forces

        others = len(net.trails.other_cables) > 0
        _write_both(net, "force", forces.force_of_singles if others else None, forces.force_of_groups if groups else None)
        if len(net.trails.run):
            from anet_lumped.mechanics import trail_force

            _write(net, "FORCE_TRAILS", "force", trail_force.force_of_trails)
    if newton:
        from anet_lumped.mechanics import newton_step, residual, settle

        for name, module in (("residual", residual), ("finish", newton_step), ("settle", settle)):
            one, four = (getattr(module, f"{name}_of_{kind}") for kind in ("singles", "groups"))
            if len(net.creep) and name != "finish":
                one = getattr(creep_kernels(), f"{name}_of_creeping")
            _write_both(net, name, one if singles else None, four if groups else None)
        if (net.effects.address[:, tables.SLOT_SETTLE] != 0).any():
            _write(net, "SETTLE_EFFECTS", "settle_effects", settle.settle_effects)
        if len(net.creep):
            _write(net, "RELINEARISE_CREEP", "relinearise_creep", creep_kernels().relinearise_creep)
        require_elimination(net, model.coupled_neighbours, stiffened=_stiffen_nodes(net))
    if model.has_bodies:
        _require_bodies(net, force, newton, links)


def _stiffen_nodes(net):
    """Whether effects add to the inertia of nodes: by the derivative of their forces, or by added mass."""
    return len(net.added_mass) > 0 or (net.effects.address[:, [tables.SLOT_TANGENT, tables.SLOT_WHOLE_STEP]] != 0).any()


def require_elimination(net, reach, stiffened=True):
    """`require` for the elimination.

    Parameters
    ----------
    net : Net
    reach : int
        How many segments apart nodes are at most that effects join.
    stiffened : bool
        Whether effects add to the inertia of nodes, so that ``net.diagonal`` holds more than that.
    """
    from anet_lumped.mechanics.linear import bordered, chain

    eliminating = substituting = {"groups": chain, "singles": chain, "bordered": bordered}
    if reach == 1:
        from anet_lumped.mechanics.linear import coupled_near

        eliminating = dict.fromkeys(eliminating, coupled_near)
    elif reach == 2:
        from anet_lumped.mechanics.linear import coupled_far

        eliminating = substituting = dict.fromkeys(eliminating, coupled_far)
    net.kernels[tables.KERNEL_ELIMINATE_GROUPS_OF_INERTIA] = 0
    short, first_held = net.single_kinds
    kinds = {"groups": len(net.cable_groups) > 0, "singles": len(net.single_cables) > first_held, "bordered": first_held > short}
    for kind, present in kinds.items():
        if present:
            name = f"eliminate_{kind}_of_inertia" if kind == "groups" and not stiffened else f"eliminate_{kind}"
            _write(net, name.upper(), "eliminate", getattr(eliminating[kind], name))
        if present or (kind == "singles" and short):
            _write(net, f"SUBSTITUTE_{kind.upper()}", "substitute", getattr(substituting[kind], f"substitute_{kind}"))


def creep_kernels():
    """Module of the kernels of cables that creep, compiled for scenes that have some."""
    from anet_lumped.mechanics import creep_kernels as kernels

    return kernels


def _require_bodies(net, force, newton, links):
    """`require` for the kernels of rigid bodies."""
    from anet_lumped.mechanics.bodies import free_motion, reduction, settling, stage

    modules = {}
    if force:
        modules["force"] = free_motion
    if newton:
        modules |= {"place": stage, "balance": stage, "turn": settling, "stiffen": settling}
        modules |= dict.fromkeys(("reduce", "spread", "finish"), reduction)
    if links:
        from anet_lumped.mechanics.links import bodies

        modules |= {"force": free_motion, "stiffen": settling}
        modules |= dict.fromkeys(("mobility", "meet", "pull", "shape"), bodies)
    for name, module in modules.items():
        _write(net, f"{name.upper()}_BODIES", f"{name}_bodies", getattr(module, f"{name}_bodies"))
    if len(net.bodies.joint):
        from anet_lumped.mechanics.bodies import joints

        if force:
            _write(net, "FORCE_BODIES", "force_bodies", joints.force_jointed)
        if newton:
            _write(net, "SETTLE_JOINTS", "settle_joints", joints.settle_joints)


def _write_both(net, name, of_singles, of_groups):
    for kind, function in (("SINGLES", of_singles), ("GROUPS", of_groups)):
        if function is not None:
            _write(net, f"{name.upper()}_{kind}", name, function)


def _write(net, slot, signature, function):
    net.kernels[getattr(tables, f"KERNEL_{slot}")] = address_of(function, SIGNATURES[signature])
