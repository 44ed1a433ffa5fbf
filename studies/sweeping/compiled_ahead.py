"""Has most of what Numba compiles for scenes compiled by two processes at once, before anything else needs it.

Each compiles what the other hardly has any function of. What is on the disk already they only load.
"""

from collections.abc import Callable, Sequence
from importlib import import_module

from studies.sweeping.side_processes import SideProcesses

EFFECTS_OF_STUDIES = ("air", "axial_damping", "bending", "gravity", "ground", "load", "moordyn_bottom", "push", "viscous_damping")


def compile_effects() -> None:
    """Import all effects, sessions and the controllers of flights, whose functions are compiled as they are imported."""
    from anet_lumped import effects
    from anet_lumped.effects import fluid_on_bodies, vortex_shedding
    from anet_lumped.flight import laws, pilot_kernel
    from anet_lumped.motion import session

    _ = list(effects.REGISTRY.values()), fluid_on_bodies, vortex_shedding, laws, pilot_kernel, session


def compile_effects_of_studies() -> None:
    """Import what first looks of studies import of these, which leaves out what takes a third of the time of all effects."""
    from anet_lumped.effects.flow import moving_water, still_water
    from anet_lumped.flight import laws, pilot_kernel

    _ = [import_module(f"anet_lumped.effects.{name}") for name in EFFECTS_OF_STUDIES], moving_water, still_water, laws, pilot_kernel


def compile_motions() -> None:
    """Have a net of four cables at once and of a cable alone come to rest, and move by an implicit and an explicit method."""
    from anet_lumped import Cable, Driven, Fixed, Free, Scene, paths, simulate
    from anet_lumped.effects import Gravity
    from anet_lumped.mechanics import changing_lengths
    from anet_lumped.motion import other_packages, scipy_methods
    from anet_lumped.statics import catenary_net

    _ = changing_lengths, other_packages, scipy_methods, catenary_net
    held = [Driven("s0", paths.line((-1, 0, 0), (0.1, 0, 0), 1.0)), *(Fixed(f"s{i}", (0.5, i - 2, 0)) for i in (1, 2, 3))]
    cables = [Cable(f"s{i}", "p", length=1.5, mass_per_length=0.1, EA=1e3, segments=4) for i in range(4)]
    net = Scene([*held, Free("p")], [*cables, Cable("s1", "s3", length=3.0, mass_per_length=0.1, EA=1e3, segments=4)], [Gravity()])
    for method in ("edmc", "verlet"):
        simulate(net, 0.01, method=method, dt=1e-3)


def compile_ahead(halves: Sequence[Callable[[], None]] = (compile_effects, compile_motions)) -> None:
    """Call functions of modules, each in a process of its own, and wait for all; what one of them fails at, others will say."""
    with SideProcesses() as processes:
        for half in halves:
            processes.start(half.__name__, half)
        for _ in halves:
            processes.next_result()
