"""The length of cables on the ground: that of the catenary that leaves a level ground, and of what the ground carries."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, State, equilibrium, simulate
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity, Ground, GroundMap, LineChange
from anet_lumped.prescribed import signals

G, MU, N = 9.81, 1.0, 40
A, HEIGHT, LYING = 20.0, 10.0, 25.0  # m: horizontal tension over weight, of the fairlead, and of chain on the ground
HANGING = math.sqrt(HEIGHT**2 + 2 * A * HEIGHT)
LENGTH, REACH = LYING + HANGING, LYING + A * math.acosh(1 + HEIGHT / A)
LEVEL = {"x": (-10.0, 200.0), "y": (-5.0, 5.0), "heights": ((0.0, 0.0), (0.0, 0.0))}


def mooring(*effects, anchor=0.0):
    cable = Cable("anchor", "fairlead", length=LENGTH, mass_per_length=MU, EA=1e7, segments=N, diameter=0.02, zeta=0.5)
    points = [Fixed("anchor", (0.0, 0.0, anchor)), Fixed("fairlead", (REACH, 0.0, HEIGHT))]
    return Scene(points, [cable], [Gravity(G), *effects])


@pytest.fixture(scope="module")
def rest():
    return equilibrium(mooring(Ground(stiffness=1e6)))


def test_it_is_what_the_catenary_leaves_on_the_ground(rest):
    assert rest.touchdown_length("anchor-fairlead") == pytest.approx(LYING, abs=0.5 * LENGTH / N)
    assert rest.reaction("ground")[2] == pytest.approx(MU * G * LYING, abs=0.5 * MU * G * LENGTH / N)  # it carries what lies


def test_it_is_known_to_half_a_segment_wherever_it_ends():
    """The fairlead is moved in parts of a segment, two in all: what lies is told too short as well as too long, by half a one."""
    of_segment, off = LENGTH / N, []
    for part in np.arange(0.1, 2.0, 0.2):
        lying = LYING + part * of_segment
        cable = Cable("anchor", "fairlead", length=lying + HANGING, mass_per_length=MU, EA=1e7, segments=N, diameter=0.02)
        points = [Fixed("anchor", (0.0, 0.0, 0.0)), Fixed("fairlead", (lying + REACH - LYING, 0.0, HEIGHT))]
        state = equilibrium(Scene(points, [cable], [Gravity(G), Ground(stiffness=1e6)]))
        off.append((state.touchdown_length("anchor-fairlead") - lying) / cable.L0)
    assert -0.55 < min(off) < -0.3 and 0.3 < max(off) < 0.55  # of a segment; the catenary of 40 is off by a few hundredths


def test_a_level_map_is_a_level_ground(rest):
    other = equilibrium(mooring(GroundMap(**LEVEL, stiffness=1e6)))
    assert other.touchdown_length("anchor-fairlead") == rest.touchdown_length("anchor-fairlead")
    assert other.reaction("ground") == pytest.approx(rest.reaction("ground"), rel=1e-6)  # what the tolerance of statics leaves


def test_a_run_has_one_for_each_saved_time_of_the_length_paid_out(rest):
    scene = mooring(Ground(stiffness=1e6), LineChange(paid_out={"anchor-fairlead": signals.line(0.0, 1.0, 0.0)}))
    run = simulate(scene, 0.02, method="edmc", dt=0.01, start=rest)
    lying = run.touchdown_length("anchor-fairlead")
    segments = lying / (LENGTH + run.t) * N
    assert len(lying) == len(run.t) and segments == pytest.approx(segments.round(), abs=1e-9)
    assert lying[0] == rest.touchdown_length("anchor-fairlead") < lying[-1]  # as many segments, each longer


def test_without_a_ground_it_is_refused():
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("b")], [Cable("a", "b", length=1.0, mass_per_length=1.0, EA=1e4, segments=4)], [Gravity(G)]
    )
    with pytest.raises(InputError, match='A cable lies on the ground of its scene, but the scene of cable "a-b" has none'):
        equilibrium(scene).touchdown_length("a-b")


def test_a_cable_that_lies_from_support_to_support_lies_with_all_of_its_length():
    cable = Cable("a", "b", length=4.0, mass_per_length=MU, EA=1e7, segments=4, diameter=0.02)
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (4, 0, 0))], [cable], [Gravity(G), Ground()])
    pressed = [(x, 0.0, 0.0 if x in (0, 4) else -1e-4) for x in range(5)]
    lifted = [(x, 0.0, 0.5 if x == 2 else z) for x, _, z in pressed]
    found = [State.of(scene, shapes={"a-b": shape}).touchdown_length("a-b") for shape in (pressed, lifted)]
    assert found == [4.0, 2.0]  # the segments beside the node that is lifted are gone
