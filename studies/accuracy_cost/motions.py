"""Motions that methods are timed on: a scene, where it starts, for how long, and the point whose position is judged."""

from dataclasses import dataclass, replace

import numpy as np

from anet_lumped import Scene, State, equilibrium, load_scene, simulate
from anet_lumped.checks import InputError
from anet_lumped.scene.scene import Driven, Fixed, Free

LOOSE_END, NET_END, SHOCK_END = 1.0, 4.0, 2.0  # [s]; the loose cable is chaotic from 1.2 s on
LOOSE_SAVE, NET_SAVE = 0.02, 0.04  # [s] between the positions that are compared
LOOSE_STEPS = (10e-3, 5e-3, 2.5e-3, 1.25e-3, 0.625e-3, 0.3125e-3, 0.15625e-3, 0.078125e-3)  # [s] of implicit schemes
NET_STEPS = (40e-3, 20e-3, 10e-3, 5e-3, 2.5e-3, 1.25e-3)  # [s]
SHOCK_STEPS = (20e-3, 10e-3, 5e-3, 2.5e-3, 1.25e-3, 0.625e-3)  # [s]
STOPPED_AT, STOPPED_STEP = 2.0, 1e-3  # [s]: when the carried net is stopped, and the step of generalised-alpha until then
STOPPED_RTOL = 1e-10  # of `links` until then, where cables do not stretch
LOAD = 0.5  # [kg] beside the bottle's 36 g, until it is dropped
REST = "equilibrium"
SHARED_LAW = "damped"  # compression where a cable slackens: the one law that we and most other engines have


@dataclass(frozen=True, eq=False)
class Motion:
    """One motion.

    Parameters
    ----------
    name : str, words
    scene : Scene
    start : State or "straight"
    recipe : str, how the start was made; with the scene it says all that the motion depends on
    t_end, save_every : float [s]
    point : name of the point whose position is judged
    steps : steps of implicit schemes [s], coarse to fine, that divide ``save_every``
    """

    name: str
    scene: Scene
    start: State | str
    recipe: str
    t_end: float
    save_every: float
    point: str
    steps: tuple[float, ...]

    @property
    def EA(self):
        """Axial stiffness of its cables [N]."""
        return self.scene.cables[0].EA

    @property
    def segments(self):
        """Segments of a cable."""
        return self.scene.cables[0].segments

    @property
    def nodes(self):
        """Nodes of the scene."""
        return sum(cable.segments - 1 for cable in self.scene.cables) + len(self.scene.points)

    @property
    def law(self):
        """Law of compression of its cables."""
        return self.scene.cables[0].compression

    def with_law(self, law):
        """The same motion of cables with another law of compression."""
        return replace(self, scene=_changed(self.scene, compression=law))

    @property
    def from_lengths(self):
        """Whether it starts from rest or from straight cables, so that cables of another axial stiffness start alike."""
        return self.recipe in (REST, "straight")

    def with_stiffness(self, EA):
        """The same motion of cables with another axial stiffness, from rest or from straight cables."""
        scene = _changed(self.scene, EA=EA)
        if not self.from_lengths:
            raise InputError(f"Only a motion from rest or from straight cables has another stiffness, but this is {self.recipe}.")
        return replace(self, scene=scene, start=equilibrium(scene) if self.recipe == REST else self.start)


def _changed(scene, **changes):
    return replace(scene, cables=tuple(replace(cable, **changes) for cable in scene.cables))


def fitting(step, save_every):
    """The largest step [s], not above the one given, that divides the time between two saves."""
    return save_every / np.ceil(save_every / step * (1 - 1e-9))


def loose(EA, segments=20, law=SHARED_LAW):
    """The cable held at one end and let go from the horizontal; it cracks like a whip at 0.55 s."""
    name = "loose cable" + ("" if law == SHARED_LAW else f", law {law}")
    scene = net("loose_cable", EA=EA, segments=segments, compression=law)
    return Motion(name, scene, "straight", "straight", LOOSE_END, LOOSE_SAVE, "tip", LOOSE_STEPS)


def carried(EA, segments=20, t_end=NET_END):
    """The net of four cables whose corners set off together; no segment of it slackens."""
    scene = net("net_carried", EA=EA, segments=segments)
    return Motion("carried net", scene, equilibrium(scene), REST, t_end, NET_SAVE, "p0", NET_STEPS)


def stopped(EA, segments=20):
    """The carried net at 0.2 m/s, whose corners stand still at once."""
    moving = net("net_carried", EA=EA, segments=segments, compression=SHARED_LAW)
    settings = {"method": "generalised_alpha", "dt": STOPPED_STEP} if np.isfinite(EA) else {"method": "links", "rtol": STOPPED_RTOL}
    last = simulate(moving, STOPPED_AT, save_every=STOPPED_AT, **settings).final
    points = [Fixed(p.name, p.path.at(STOPPED_AT)[0]) if isinstance(p, Driven) else p for p in moving.points]
    recipe = f"net_carried at {STOPPED_AT} s by {settings}"
    return Motion("net stopped", replace(moving, points=points), last, recipe, SHOCK_END, NET_SAVE, "p0", SHOCK_STEPS)


def dropped(EA, segments=20):
    """The net at rest with a load that is gone at the start."""
    scene = net("net_held", EA=EA, segments=segments, compression=SHARED_LAW)
    points = [replace(p, mass=p.mass + LOAD) if isinstance(p, Free) else p for p in scene.points]
    rest = equilibrium(replace(scene, points=points))
    return Motion("load dropped", scene, rest, f"equilibrium with {LOAD} kg more", SHOCK_END, NET_SAVE, "p0", SHOCK_STEPS)


def net(name, **changes):
    """A bundled scene with all its cables changed."""
    scene = load_scene(name)
    return replace(scene, cables=tuple(replace(cable, **changes) for cable in scene.cables))
