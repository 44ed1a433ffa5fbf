"""What tests of several files need compiled, for `compile_ahead`: both workers would otherwise compile it at the same time."""

import math


def compile_effects_of_tests() -> None:
    """Import all effects; then links and what judges runs, which the other half would come to last."""
    from anet_lumped.mechanics.links import motion, project
    from anet_lumped.results import amplification, tension_error
    from studies.sweeping.compiled_ahead import compile_effects

    compile_effects()
    _ = motion, project, amplification, tension_error


def compile_motions_of_tests() -> None:
    """Motions, as a report has them compiled; then water, methods with an error of their own, and links, also at a body."""
    from anet_lumped import Body, Cable, Fixed, Free, Scene, simulate
    from anet_lumped.effects import Gravity
    from anet_lumped.effects.flow import moving_water, still_water
    from studies.sweeping.compiled_ahead import compile_motions

    compile_motions()
    _ = moving_water, still_water
    points = [Fixed("top", (0, 0, 0)), Free("end", mass=0.3)]
    made = dict(length=1.0, mass_per_length=0.1, segments=4, compression="linear")
    simulate(Scene(points, [Cable("top", "end", EA=1e3, **made)], [Gravity()]), 0.01, method="dop853", rtol=1e-6)
    box = Body("box", mass=1.0, inertia=(0.1, 0.2, 0.3), attachments={"hook": (0, 0, 0.1)}, at=(0, 0, -1.1))
    for beneath, bodies in ((points, []), (points[:1], [box])):
        cable = Cable("top", "box.hook" if bodies else "end", EA=math.inf, **made)
        simulate(Scene(beneath, [cable], [Gravity()], bodies=bodies), 0.01, method="links", rtol=1e-6)
