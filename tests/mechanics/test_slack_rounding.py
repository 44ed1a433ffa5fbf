"""What rounding may leave in the forces on a slack cable does not grow with its stiffness."""

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, State, simulate
from anet_lumped.effects import Gravity


def falling(EA):
    """A weight that falls beside its support on a slack cable."""
    cable = Cable("a", "b", length=2.0, mass_per_length=0.1, EA=EA, segments=1)
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1.0, at=(0.6, 0.0, -0.2))], [cable], [Gravity(9.81)])


@pytest.mark.parametrize("EA", [1e7, 1e10, np.inf])
def test_a_slack_cable_moves_as_a_soft_one_to_the_last_bit(EA):
    soft, stiff = (
        simulate(scene, 0.3, method="edmc", dt=1e-4, save_every=0.01, start=State.of(scene, points={"b": (0.6, 0.0, -0.2)}))
        for scene in (falling(1e3), falling(EA))
    )  # fmt: skip
    assert soft.segment_tension.max() == stiff.segment_tension.max() == 0.0
    np.testing.assert_array_equal(stiff.q, soft.q)
    assert stiff.energy_balance.imbalance < 1e-7  # of 3000 steps, each to 1e-8 of the weight; 1.5e-6 with what it allowed before
