"""Cables that do not stretch and are held at three points or more meet, or what is too short is named."""

import math

import numpy as np
import pytest

from anet_lumped import Body, Cable, Driven, Fixed, Free, Scene, Session, SessionError, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model.meeting import too_far_to_meet

LIKE = dict(mass_per_length=0.05, EA=math.inf, segments=3)


def corners(count):
    """Corners of a polygon on the unit circle."""
    return [(math.cos(2.0 * math.pi * k / count), math.sin(2.0 * math.pi * k / count), 0.0) for k in range(count)]


def star(count, length):
    """Cables of one length from the corners of a polygon to one point: they meet if it is 1 m."""
    points = [Fixed(f"s{k}", at) for k, at in enumerate(corners(count))]
    legs = [Cable(f"s{k}", "p0", length=length, **LIKE) for k in range(count)]
    return Scene([*points, Free("p0", mass=0.5)], legs, [Gravity(9.81)])


@pytest.mark.parametrize("count", [3, 5])
@pytest.mark.parametrize("short", [1e-1, 1e-4, 1e-7, -1e-7, -1e-1])
def test_a_star_meets_in_its_centre(count, short):
    words = too_far_to_meet(star(count, 1.0 - short), 0.0)
    assert (words is None) == (short < 0.0)
    if words is not None:
        assert float(words.split("they meet where it is ")[1].split()[0]) == pytest.approx(1.0, abs=1e-8)
        assert all(f'"s{k}-p0"' in words for k in range(3))


def test_what_is_too_short_alone_is_named():
    """Three of four legs are too short together; the fourth reaches anything."""
    scene = star(3, 0.9)
    points = [*scene.points, Fixed("far", (3.0, 0.0, 0.0))]
    words = too_far_to_meet(Scene(points, [*scene.cables, Cable("far", "p0", length=9.0, **LIKE)], scene.effects), 0.0)
    assert "far-p0" not in words


def test_a_body_between_them_counts_with_its_width():
    """Three legs of 0.85 m end on a circle of 0.1 or 0.2 m around the middle of a body: 0.95 m is too short, 1.05 m is not."""
    for width, meets in ((0.1, False), (0.2, True)):
        ends = {f"h{k}": tuple(width * np.array(at)) for k, at in enumerate(corners(3))}
        body = Body("plate", mass=1.0, inertia=[0.01] * 3, at=(0.0, 0.0, 0.0), attachments=ends)
        points = [Fixed(f"s{k}", at) for k, at in enumerate(corners(3))]
        legs = [Cable(f"s{k}", f"plate.h{k}", length=0.85, **LIKE) for k in range(3)]
        assert (too_far_to_meet(Scene(points, legs, [Gravity(9.81)], bodies=[body]), 0.0) is None) == meets


@pytest.mark.parametrize("method", [None, "links"])
def test_a_run_stops_where_three_supports_are_driven_apart(method):
    """From 1 m at 0.5 m/s, reached over 0.1 s, to 1.3 m: 0.65 s. Each two supports are near enough to each other then."""
    points = [Driven(f"s{k}", paths.line(at, 0.5 * np.array(at), 0.1)) for k, at in enumerate(corners(3))]
    legs = [Cable(f"s{k}", "p0", length=1.3, **LIKE) for k in range(3)]
    scene = Scene([*points, Free("p0", mass=0.5)], legs, [Gravity(9.81)])
    run = simulate(scene, 1.0, method=method, dt=2e-3)
    assert run.status == "unconverged" and run.t[-1] == pytest.approx(0.65, abs=5e-3)
    assert 'must be long enough to meet, but cables "s0-p0", "s1-p0", "s2-p0" are not' in run.message
    assert "is 1.3 m long, and lengthened alike they meet where it is 1.3" in run.message


def test_a_session_says_so():
    points = [Driven(f"s{k}", paths.external(at)) for k, at in enumerate(corners(3))]
    scene = Scene([*points, Free("p0", mass=0.5)], [Cable(f"s{k}", "p0", length=1.01, **LIKE) for k in range(3)], [Gravity(9.81)])
    with Session(scene, dt=0.01) as session:
        for k, at in enumerate(corners(3)):
            session.drive(f"s{k}", 1.02 * np.array(at), 2.0 * np.array(at))
        with pytest.raises(SessionError, match=r"is 1.01 m long, and lengthened alike they meet where it is 1.02 m"):
            session.step()


@pytest.mark.parametrize("length", [1.0, 5.0, 20.0])
def test_a_cable_that_reaches_anything_is_none_that_is_too_short(length):
    """It hangs on one support, and the search may go to where it is of no length at all."""
    points = [Fixed("a", (0.0, 0.0, 0.0)), Fixed("far", (10.0, 0.0, 0.0)), Free("m", mass=1.0)]
    assert too_far_to_meet(Scene(points, [Cable("a", "m", length=length, **LIKE)], [Gravity(9.81)]), 0.0) is None
