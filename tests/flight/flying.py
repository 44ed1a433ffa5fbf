"""Scenes of flights for tests."""

from dataclasses import replace

import numpy as np

from anet_lumped import Cable, Fixed, Free, Scene
from anet_lumped.effects import Gravity
from anet_lumped.flight.quadrotor import THESIS_QUADROTOR, quadrotor

AGILE = replace(THESIS_QUADROTOR, lag=0.0, drag=(0.0, 0.0, 0.0))


def alone(of=AGILE, **changes):
    """A quadrotor in free flight, beside a cable that hangs far away."""
    cable = Cable("top", "end", length=1.0, mass_per_length=0.1, EA=100.0, segments=2)
    points = [Fixed("top", (10, 0, 0)), Free("end", mass=0.1)]
    return Scene(points, [cable], [Gravity(9.81)], bodies=[quadrotor("quad", (0, 0, 0), of, **changes)])


def mixed(of, thrusts):
    """Force along z [N] and torque [N m] of thrusts of the rotors (4,), from where each stands and how it turns."""
    force, torque = 0.0, np.zeros(3)
    for r, T in enumerate(thrusts):
        angle = np.radians(45.0 + 90.0 * r)
        place = of.arm * np.array([np.cos(angle), np.sin(angle), 0.0])
        force += T
        torque += np.cross(place, (0.0, 0.0, T)) + np.array([0.0, 0.0, (-1) ** r * of.torque_ratio * T])
    return force, torque
