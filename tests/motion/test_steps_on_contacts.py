"""Contacts whose springs and dampers allow far shorter explicit steps than the cables do."""

import math

import pytest

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity, Ground, GroundMap

K, C, D, MU = 1e5, 2e3, 0.02, 0.5  # of the ground [Pa/m], [Pa s/m]; diameter [m], mass [kg/m]


def swung(*effects):
    """A weight on a soft cable that swings down onto the ground, 2.5 m below its end."""
    cable = Cable("a", "b", length=20.0, mass_per_length=MU, EA=1e3, segments=10, zeta=0.05, diameter=D)
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=5.0, at=(-20.0, 0.0, 0.0))], [cable], [Gravity(), *effects])


@pytest.mark.parametrize(
    "ground", [Ground(height=-2.5), GroundMap([-30.0, 30.0], [-30.0, 30.0], [[-2.5, -2.5], [-2.5, -2.5]])], ids=["flat", "map"]
)
def test_the_default_does_not_diverge_at_touchdown(ground):
    """Verlet's steps of 20 ms, half of what the cable allows, diverged on dampers that allow a tenth of a millisecond."""
    free, run = (simulate(swung(*more), 2.0, start="straight") for more in ([], [ground]))
    assert free.method == "verlet" and run.method == "edmc" and run.ok
    assert f"an explicit step may be unstable by the forces of {type(ground).__name__}" in run.reason


def test_frequency_and_damping_of_a_contact():
    """sqrt(k d/mu) and c d/mu of a cable; steeper slopes press on more."""
    flat, steep = (
        Ground(stiffness=K, damping=C),
        GroundMap([0.0, 1.0], [0.0, 1.0], [[0.0, 0.0], [1.0, 1.0]], stiffness=K, damping=C),
    )
    scene = swung()
    assert flat.highest_frequency(scene) == pytest.approx(math.sqrt(K * D / MU), rel=1e-12)
    assert flat.highest_damping_rate(scene) == pytest.approx(C * D / MU, rel=1e-12)
    assert steep.highest_damping_rate(scene) == pytest.approx(2.0 * C * D / MU, rel=1e-12)
    assert Gravity().highest_damping_rate(scene) == 0.0
