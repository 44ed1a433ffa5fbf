"""Runs that are looked at."""

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity

SAVE = 0.01  # [s]


def breaking(name="b"):
    """A payload that falls into a hanging cable, which breaks; 31 states of 11 nodes."""
    cable = Cable("a", name, length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=10, breaking_tension=15.0, name="rope")
    scene = Scene([Fixed("a", (0, 0, 2)), Free(name, mass=1.0, at=(0, 0, 1))], [cable], [Gravity()])
    return simulate(scene, 0.3, start="straight", method="edmc", dt=1e-3, save_every=SAVE)
