"""Compiled passes over saved states, beside their slow twin over whole arrays."""

import numpy as np
import place_twin
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, load_scene, simulate
from anet_lumped.effects import Gravity, Ground, ViscousDamping
from anet_lumped.results.amplification import amplification
from anet_lumped.results.free_flight import first_loose, flight_errors, loose
from anet_lumped.results.node_pass import RESOLVED
from studies.catalogue.random_motions import random_motion


def chain(segments=8, at=(0.9, 0.0, -0.2), compression="none", effects=(), zeta=0.05):
    cable = Cable(
        "a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=zeta, segments=segments, compression=compression, diameter=0.01
    )
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.5, at=at)], [cable], [Gravity(9.81), *effects])


def moved(scene, t_end, dt, method="edmc", every=1, start="straight", **more):
    return simulate(scene, t_end, method=method, dt=dt, save_every=every * dt, start=start, **more)


def chain_that_whips():
    motion = random_motion(135)
    return moved(motion.scene, motion.t_end, motion.t_end / 200, start=motion.start)


def net_that_pumps():
    motion = random_motion(1, 11)
    return moved(motion.scene, motion.t_end, motion.t_end / 580, start=motion.start)


RUNS = {
    "a swing": lambda: moved(chain(at=(0.7, 0.0, -0.7)), 2.0, 2e-3),
    "a fall that goes loose": lambda: moved(chain(), 1.0, 1e-3),
    "one segment": lambda: moved(chain(1), 1.0, 2e-3),
    "a chain that pushes": lambda: moved(chain(compression="linear"), 0.5, 1e-3),
    "a chain that pushes and whips": chain_that_whips,
    "a chain that pushes and rings": lambda: moved(chain(compression="linear"), 0.6, 2e-3, rho_inf=1.0),
    "in something that slows it": lambda: moved(chain(effects=(ViscousDamping(0.5),)), 1.0, 2e-3),
    "on a ground": lambda: moved(chain(at=(0.9, 0.0, -0.1), effects=(Ground(-0.5, stiffness=1e3),)), 1.0, 1e-3),
    "a net that is carried": lambda: moved(load_scene("net_carried"), 2.0, 8e-3, start="equilibrium"),
    "a net that pumps": net_that_pumps,
    "a method that books nothing": lambda: moved(chain(zeta=0.5), 0.2, 2e-5, "verlet", every=20),
    "three states": lambda: moved(chain(), 0.1, 1e-3, every=50),
}


@pytest.mark.parametrize("kind", RUNS)
def test_errors_of_places_are_those_of_the_twin(kind):
    """To round-off, which motions that multiply errors multiply too; sums run in another order."""
    run = RUNS[kind]()
    assert run.error[-1] > 0.0
    np.testing.assert_allclose(run.error, place_twin.place_errors(run), rtol=1e-9, atol=1e-15)
    flies = place_twin.loose(run)
    assert (loose(run) == flies).all()
    np.testing.assert_allclose(flight_errors(run), place_twin.flight_errors(run, flies), rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(amplification(run), place_twin.amplification(run, flies), rtol=1e-9, atol=1e-12)
    row = place_twin.first_loose_row(run, flies)
    assert first_loose(run) == (None if row is None else run.t[row])


def test_what_the_kinds_are():
    assert amplification(RUNS["a net that pumps"]())[-1] > 1.0
    assert flight_errors(RUNS["a fall that goes loose"]())[-1] > 0.0
    assert (RUNS["on a ground"]().position("b")[:, 2] < -0.495).any()
    assert (RUNS["a chain that pushes"]().segment_tension < 0.0).any()
    whips, rings = RUNS["a chain that pushes and whips"](), RUNS["a chain that pushes and rings"]()
    assert amplification(whips)[-1] > 0.3 and amplification(rings)[-1] > 0.3
    assert place_twin.bends(whips.segment_tension) < RESOLVED < place_twin.bends(rings.segment_tension)
