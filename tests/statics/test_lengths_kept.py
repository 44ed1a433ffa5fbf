"""Cables that do not stretch: nets of them that reach have a rest, and those that do not are refused with the lengths."""

import math

import numpy as np
import pytest

from anet_lumped import Body, Cable, Fixed, Free, NoRestError, Scene, Session, SessionError, equilibrium, paths, simulate
from anet_lumped.effects import Gravity, Ground
from anet_lumped.scene.scene import Driven

G = 9.81


def three_legs(shortest, *effects):
    """A weight below two supports 2 m apart and one above it, each of which every two cables reach."""
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (2, 0, 0)), Fixed("c", (1, 0, 1)), Free("m", mass=0.2, at=(1, 0, -0.2))]
    like = dict(mass_per_length=0.1, EA=math.inf, segments=5, diameter=0.01)
    legs = [Cable("a", "m", length=1.05, **like), Cable("b", "m", length=1.05, **like), Cable("c", "m", length=shortest, **like)]
    return Scene(points, legs, [Gravity(G), *effects])


@pytest.mark.parametrize("effects", [(), (Ground(height=-3.0),)])
def test_three_cables_that_meet_in_no_point_are_refused(effects):
    """The point 0.32 m below the line of two supports is 1.32 m below the third: 0.5 m of cable bore 2e12 N, and "residual 0"."""
    words = "must keep their lengths, but in no shape of this net all of them do: cable .* is 1.05 m long, and 1.1"
    with pytest.raises(NoRestError, match=words):
        equilibrium(three_legs(0.5, *effects))
    with pytest.raises(NoRestError, match=words):
        simulate(three_legs(0.5, *effects), 0.1)


def test_three_cables_that_meet_keep_their_lengths():
    """Its longest cable of 0.9 m is straight and bears what the others do not: the balance of forces on the weight."""
    rest = equilibrium(three_legs(0.9))
    assert [rest.length(f"{name}-m") for name in "abc"] == pytest.approx([1.05, 1.05, 0.9], rel=1e-9)
    assert sum(rest.reaction(name)[2] for name in "abc") == pytest.approx((0.2 + 0.3) * G, rel=1e-9)


def test_a_body_between_two_cables_counts_with_its_width():
    """0.8 m, 0.2 m of a box and 0.8 m between supports 2 m apart: said with both numbers, and with 0.95 m it rests straight."""
    points, like = [Fixed("a", (0, 0, 0)), Fixed("c", (2, 0, 0))], dict(mass_per_length=0.1, EA=math.inf, segments=5)
    box = Body("box", mass=1.0, inertia=[0.01] * 3, at=(1, 0, -0.1), attachments={"l": (-0.1, 0, 0), "r": (0.1, 0, 0)})

    def scene(length):
        cables = [Cable("a", "box.l", length=length, **like), Cable("c", "box.r", length=length, **like)]
        return Scene(points, cables, [Gravity(G)], bodies=[box])

    words = 'cables "a-box.l", "c-box.r" and body "box" between them are 1.8 m long, and points "a" and "c" are 2 m apart'
    with pytest.raises(NoRestError, match=words):
        equilibrium(scene(0.8))
    rest = equilibrium(scene(0.95))
    assert np.hypot(*rest.reaction("a")[[0, 2]]) > 0.5 * G and rest.length("a-box.l") == pytest.approx(0.95, rel=1e-6)


def test_a_session_that_drives_an_end_too_far_says_so():
    points = [Fixed("a", (0, 0, 0)), Driven("b", paths.external((0.9, 0, 0)))]
    scene = Scene(points, [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=math.inf, segments=5)], [Gravity(G)])
    with Session(scene, dt=0.01) as session:
        for step in range(10):
            session.drive("b", (0.9 + 0.0099 * (step + 1), 0, 0), (0.99, 0, 0))
            session.step()
        session.drive("b", (1.01, 0, 0), (0.99, 0, 0))
        with pytest.raises(SessionError, match=r'cable "a-b" is 1 m long, and points "a" and "b" are 1.01 m apart at t=0.11 s'):
            session.step()
