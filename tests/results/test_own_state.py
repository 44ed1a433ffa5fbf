"""States of a user's own, by names: resampled by arc length, in either direction."""

import numpy as np
import pytest
from hanging import cable, held_net

from anet_lumped import Cable, Driven, Fixed, Free, Scene, State, equilibrium, paths, simulate
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity

ANGLE = np.linspace(0.0, np.pi, 1001)
HALF_CIRCLE = np.column_stack([-np.cos(ANGLE), np.zeros(1001), -np.sin(ANGLE)])


def rope(segments=6, length=np.pi):
    return Scene([Fixed("a", (-1, 0, 0)), Fixed("b", (1, 0, 0))], [cable("a", "b", length, EA=1e3, segments=segments)], [Gravity()])


def test_a_fine_curve_is_resampled_by_arc_length():
    """A half circle: nodes at equal angles, to what the chords of 1000 pieces are off, 4e-7 of the radius."""
    state = State.of(rope(), {"a-b": HALF_CIRCLE})
    angles = np.linspace(0.0, np.pi, 7)
    assert state.shape("a-b") == pytest.approx(np.column_stack([-np.cos(angles), 0 * angles, -np.sin(angles)]), abs=2e-6)
    chord = 2.0 * np.sin(np.pi / 12)
    assert state.tension("a-b") == pytest.approx(0.0) and state.length("a-b") == pytest.approx(6 * chord, rel=1e-5)
    taut = State.of(rope(length=3.0), {"a-b": HALF_CIRCLE})
    assert taut.tension("a-b") == pytest.approx(1e3 * (chord / 0.5 - 1.0), rel=1e-4)


def test_a_shape_may_be_given_from_the_other_end_with_its_velocities():
    along = np.column_stack([np.zeros(1001), np.linspace(0.0, 1.0, 1001), np.zeros(1001)])
    ahead = State.of(rope(), {"a-b": HALF_CIRCLE}, {"a-b": along})
    back = State.of(rope(), {"a-b": HALF_CIRCLE[::-1]}, {"a-b": along[::-1]})
    assert back.q == pytest.approx(ahead.q, abs=1e-12) and back.v == pytest.approx(ahead.v, abs=1e-12)
    assert ahead.v[ahead.model.nodes("a-b")][:, 1] == pytest.approx(
        [0, 1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6, 0], abs=1e-5
    )  # ends are held


def test_a_place_for_each_node_is_kept_and_a_run_starts_there():
    scene = held_net()
    rest = equilibrium(scene)
    own = State.of(scene, {name: rest.shape(name) for name in ("s0-p0", "s1-p0", "s2-p0", "s3-p0")})
    assert (own.q == rest.q).all()
    run = simulate(scene, 0.1, start=own, method="edmc", dt=0.01)
    assert abs(run.position("p0") - rest.position("p0")).max() < 1e-6  # it stays at rest


def test_points_and_whole_cables_have_places_and_velocities():
    points = [Driven("hand", paths.line((0, 0, 0), (1, 0, 0), 0.0)), Free("end")]
    scene = Scene(points, [cable("hand", "end", segments=4)], [Gravity()])
    state = State.of(scene, points={"end": (2, 0, -1)}, velocities={"hand-end": (0, 3, 0), "end": (0, 0, 5)}, t=2.0)
    assert state.t == 2.0 and state.shape("hand-end") == pytest.approx(np.linspace((2, 0, 0), (2, 0, -1), 5))
    assert state.v[state.model.nodes("hand-end")] == pytest.approx(np.array([(1, 0, 0), *[(0, 3, 0)] * 3, (0, 0, 5)]))


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"shapes": [1]}, r"Argument `shapes` must be a dict by names, but it is \[1\]"),
        ({"shapes": {"a-c": HALF_CIRCLE}}, r'Argument `shapes` must name a cable, but "a-c" is none'),
        ({"points": {"a": (0, 0, 0)}}, r'Argument `points` must name a free point, but "a" is none'),
        ({"shapes": {"a-b": [(0, 0, 0)]}}, r'The shape of cable "a-b" must be an array \(k, 3\) with k at least 2'),
        ({"shapes": {"a-b": [(0, 0, 0), (1, np.nan, 0)]}}, r'The shape of cable "a-b" must be finite, but row 1 is'),
        ({"shapes": {"a-b": HALF_CIRCLE + 0.1}}, r'shape must end where its cable does, but that of cable "a-b" ends 0.173 m from'),
        ({"velocities": {"a-b": HALF_CIRCLE}}, r'cable "a-b" must have a shape with a place for each row, .* has 1001 rows'),
        ({"shapes": {"a-b": HALF_CIRCLE}, "velocities": {"a-b": HALF_CIRCLE[:5]}}, r"must have 1001 rows, .* but it has 5 rows"),
        ({"t": "now"}, r"Argument `t` must be"),
    ],
)
def test_what_makes_no_state_is_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        State.of(rope(), **arguments)


def test_cables_that_meet_have_one_place_and_one_velocity():
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("p"), Free("q", at=(2, 0, 0))],
        [Cable(*ends, length=1.0, mass_per_length=0.1, EA=1e3, segments=4) for ends in (("a", "p"), ("p", "q"))],
    )
    with pytest.raises(InputError, match=r'needs the place of every point, but point "p" has no `at`, and neither'):
        State.of(scene)
    at = {"p": (1, 0, 0)}
    with pytest.raises(InputError, match=r'at point "p" cables "a-p" and "p-q" have \(0.0, 0.0, 1.0\) and \(0.0, 0.0, 2.0\) m/s'):
        State.of(scene, points=at, velocities={"a-p": (0, 0, 1), "p-q": (0, 0, 2)})
    both = State.of(scene, points=at, velocities={"a-p": (0, 0, 1), "p-q": (0, 0, 2), "p": (0, 0, 1.5)})
    assert both.velocity("p")[2] == 1.5
    with pytest.raises(InputError, match=r'The velocity of point "p" must be three numbers \[m/s\], but it is 1.0'):
        State.of(scene, points=at, velocities={"p": 1.0})


def test_a_point_is_not_moved_as_a_body_is():
    state = State.of(rope(), {"a-b": HALF_CIRCLE})
    with pytest.raises(InputError, match=r'must be a body, but "a" is a point; State.of\(scene, .* takes the places of points'):
        state.moved("a", at=(0.0, 0.0, 1.0))
