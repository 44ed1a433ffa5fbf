"""A rest does not depend on what resists velocities: dampers, friction and drag of fluids at rest hold nothing that is at rest."""

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Scene, equilibrium, simulate, wind
from anet_lumped.effects import REGISTRY, AxialDamping, Gravity, Ground, ViscousDamping, Water, node_force

CURRENTS = {"across": (104.0, (0.0, 0.1, 0.0)), "loose": (120.0, (0.0, 0.02, 0.0)), "along": (140.0, (0.3, 0.1, 0.0))}


def mooring(length, current, friction=0.0, zeta=0.0, effects=()):
    """A line that lies partly on the ground, in a current."""
    cable = Cable(
        "anchor", "ship", length=length, mass_per_length=1.2, EA=1e6, zeta=zeta, segments=52, diameter=0.025, compression="damped"
    )
    surroundings = [Ground(height=-20.05, friction=friction), Water(level=5.0, current=wind.Uniform(current))]
    return Scene([Fixed("anchor", (0, 0, -20)), Fixed("ship", (90, 0, 0))], [cable], [Gravity(9.81), *surroundings, *effects])


@pytest.mark.each_once
@pytest.mark.parametrize("current", CURRENTS)
@pytest.mark.parametrize(
    "resists",
    [{"friction": 0.5}, {"friction": 2.0}, {"zeta": 1e6}, {"effects": [ViscousDamping(1e3)]}, {"effects": [AxialDamping(1e3)]}],
    ids=str,
)
def test_the_rest_is_that_without_it(current, resists):
    """To the last bit: the search leaves it out."""
    scene = mooring(*CURRENTS[current], **resists)
    rest = equilibrium(scene)
    assert rest.scene == scene and rest.stable and rest.residual < 1e-9
    np.testing.assert_array_equal(rest.q, equilibrium(mooring(*CURRENTS[current])).q)


def test_it_stays_where_it_is():
    """A rest that only creeps would go on without what holds it."""
    rest = equilibrium(mooring(*CURRENTS["across"], friction=0.5))
    run = simulate(mooring(*CURRENTS["across"]), 20.0, method="edmc", dt=0.05, start=rest)
    assert np.abs(run.q - rest.q).max() < 1e-6


@pytest.mark.slow
def test_a_law_of_ones_own_that_resists_velocities_does_not_pass_for_a_balance(monkeypatch):
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))

    @node_force
    def thick(t, q, v, c):
        return -c * v[0], -c * v[1], -c * v[2]

    scene = mooring(*CURRENTS["loose"], effects=[thick(1e3)])
    try:
        rest = equilibrium(scene)
    except RuntimeError as error:
        assert "imbalance" in str(error)
    else:
        np.testing.assert_allclose(rest.q, equilibrium(mooring(*CURRENTS["loose"])).q, atol=1e-3)
