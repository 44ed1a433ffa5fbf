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


def laid(seed, EA):
    """A cable from an anchor on the ground, or from a little above the ground, to a fairlead; a third or more of it lies."""
    draw = np.random.default_rng(seed)
    length, slack, segments = draw.uniform(50.0, 500.0), draw.uniform(0.02, 0.3), int(draw.integers(20, 101))
    chord, up = length / (1.0 + slack), 0.0 if seed % 2 else 0.05 * length * slack
    h = chord * draw.uniform(0.1, 0.3)
    points = [Fixed("anchor", (0, 0, up)), Fixed("fairlead", (math.sqrt(chord**2 - h**2), 0, up + h))]
    cable = Cable("anchor", "fairlead", length=length, mass_per_length=0.2, EA=EA, segments=segments, diameter=0.02)
    return Scene(points, [cable], [Gravity(G), Ground()])


@pytest.mark.parametrize("seed", [0, 2, 3, 5, 8, 9])
def test_a_cable_that_lies_on_the_ground_keeps_its_length(seed):
    """Against a cable of EA = 1e9 N, whose strains of 1e-6 change the tensions by no more than 1e-5."""
    rest, like = equilibrium(laid(seed, math.inf)), equilibrium(laid(seed, 1e9))
    cable, shape, tension = rest.scene.cables[0], rest.shape("anchor-fairlead"), rest.tension("anchor-fairlead")
    lengths = np.linalg.norm(np.diff(shape, axis=0), axis=1)
    lies = shape[:, 2] <= 0.0
    assert rest.residual < 1e-11 and lies[1:].any()
    assert lengths[tension > 0.0] == pytest.approx(cable.L0, rel=1e-12)
    assert (lengths <= cable.L0 * (1.0 + 1e-12)).all()
    assert tension == pytest.approx(like.tension("anchor-fairlead"), abs=1e-5 * tension.max())


def test_a_cable_on_the_ground_has_the_tension_of_the_catenary():
    """The part that hangs from (0, 0) is z = a (cosh(x/a) - 1) with a = H/w, and the part that lies has the tension H.

    A fairlead at a height h with a hanging length s has a = (s^2 - h^2)/2h, and is a asinh(s/a) beyond the touchdown. The error of
    200 segments is of the square of their length over a, (1.25/105)^2.
    """
    s, h, lying, w = 150.0, 75.0, 100.0, 0.2 * G
    a = (s * s - h * h) / (2.0 * h)
    points = [Fixed("anchor", (0, 0, 0)), Fixed("fairlead", (lying + a * math.asinh(s / a), 0, h))]
    cable = Cable("anchor", "fairlead", length=s + lying, mass_per_length=0.2, EA=math.inf, segments=200, diameter=0.02)
    tension = equilibrium(Scene(points, [cable], [Gravity(G), Ground(stiffness=3e8)])).tension("anchor-fairlead")
    assert tension[0] == pytest.approx(w * a, rel=3e-4)
    assert tension[-1] == pytest.approx(w * (a + h), rel=1e-2)
