"""Prescribed motions: exact values and derivatives, in plain Python and in compiled code."""

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped.checks import InputError
from anet_lumped.model.rest_lengths import places
from anet_lumped.prescribed.path_kernel import TABLE, evaluate
from anet_lumped.prescribed.paths import circle, harmonic, lift, line, pack, samples, seen_from

LINE = line((1.0, 2.0, 3.0), (0.2, -0.1, 0.4), 1.5)
JERKED = line((1.0, 2.0, 3.0), (0.2, -0.1, 0.4), 0.0)
RECORDED = samples([0.5, 1.0, 2.0, 2.25, 4.0], [(0, 0, 0), (0.1, 0.3, 0), (0.4, 0.2, 1), (0.4, 0, 1.1), (1, 1, 1)])
SWING = harmonic((0.0, 0.0, 1.0), (0.3, 0.0, 0.1), 0.7, phase=0.4, ramp=2.0)
ENDLESS = harmonic((0.0, 0.0, 1.0), (0.3, 0.0, 0.1), 0.7)
FLOWN = samples([0.5, 1.0, 2.0], [(0, 0, 0), (0.1, 0.3, 0), (0.4, 0.2, 1)], ends=[(1, 0, 0), (0, 2, 0)])
TURNED = samples([0.5, 1.0, 1.5, 2.5], [(0, 0, 0), (0.1, 0.3, 0), (0.4, 0.2, 1), (0, 0, 0)], periods=2)
CIRCLE = circle((1.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0, 0, 2.0), 2.0, 1.5, ramp=0.8)
AT_ONCE = circle((1.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0, 0, 2.0), 2.0, 1.5)
LIFT = lift((1.0, 0.0, 0.0), (0, 0, 2.0), 1.5, hold=0.5)
PATHS = [LINE, JERKED, RECORDED, SWING, ENDLESS, FLOWN, TURNED, CIRCLE, AT_ONCE, LIFT]


def compiled(paths, t):
    q, v, a = (np.full((len(paths), 3), np.nan) for _ in range(3))
    evaluate(t, pack(paths), q, v, a)
    return q, v, a


@tried()
@given(st.floats(-10.0, 100.0) | st.sampled_from([0.0, 0.5, 1.0, 1.5, 2.0, 2.25, 4.0]))
def test_compiled_equals_plain(t):
    plain = np.array([path.at(t) for path in PATHS]).swapaxes(0, 1)
    # Both sum the same few terms, of size up to 2π·0.7·100 rad in the sine's argument: round-off of 1e-13.
    np.testing.assert_allclose(compiled(PATHS, t), plain, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.kind)
def test_places_at_many_times(path):
    times = np.linspace(-1.0, 9.0, 41)
    # the same few terms, summed in another order
    np.testing.assert_allclose(places(path, times), [path.at(t)[0] for t in times], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("paths", [[], [LINE], [RECORDED, RECORDED], [SWING], PATHS], ids=len)
def test_one_compiled_type_for_all(paths):
    assert numba.typeof(pack(paths)) == TABLE
    assert np.isfinite(compiled(paths, 0.7)).all()


@pytest.mark.parametrize("path", [LINE, RECORDED, SWING, ENDLESS, FLOWN, LIFT], ids=lambda path: path.kind)
@pytest.mark.parametrize("t", [0.6, 1.3])
def test_velocity_and_acceleration_are_the_derivatives(path, t):
    h = 0.02 * 0.5 ** np.arange(5)
    q, v, a = path.at(t)
    for value, slope, which in ((q, v, 0), (v, a, 1)):
        remainder = [np.linalg.norm(path.at(t + step)[which] - value - step * slope) for step in h]
        order = np.polyfit(np.log(h), np.log(remainder), 1)[0]
        assert order == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.kind)
def test_smooth_but_at_corners(path):
    times = np.unique(np.concatenate([path.breaks, path.corners, [0.0] if path is ENDLESS else [0.0, 1.5, 2.0]]))
    step = 1e-9
    for t in times:
        before, after = np.array(path.at(t - step)), np.array(path.at(t + step))
        # Nothing here changes faster than 1e2 a second, so 2e-9 s change a smooth motion by less than 1e-6.
        smooth = np.abs(after - before).max() < 1e-6
        assert smooth == (not np.isclose(t, path.corners, rtol=0.0, atol=step).any())  # states are held from next to a corner on


def test_corners():
    assert LINE.corners.tolist() == SWING.corners.tolist() == ENDLESS.corners.tolist() == []
    assert JERKED.corners.tolist() == [0.0]
    assert RECORDED.corners.tolist() == [0.5, 4.0]


def test_line_from_rest_to_velocity():
    start, velocity = np.array([1.0, 2.0, 3.0]), np.array([0.2, -0.1, 0.4])
    np.testing.assert_array_equal(LINE.at(-1.0), [start, np.zeros(3), np.zeros(3)])
    s = 0.3
    np.testing.assert_allclose(LINE.at(1.5 * s)[1], velocity * (6 * s**5 - 15 * s**4 + 10 * s**3), rtol=1e-14)
    # The ramp costs half its time; three operations, so a few units of round-off.
    np.testing.assert_allclose(LINE.at(7.0)[0], start + velocity * (7.0 - 0.75), rtol=1e-15)
    np.testing.assert_array_equal(LINE.at(7.0)[1:], [velocity, np.zeros(3)])
    np.testing.assert_array_equal(JERKED.at(0.0)[1], velocity)
    np.testing.assert_array_equal(JERKED.at(-1e-12)[1], np.zeros(3))


def test_samples_reached_and_held():
    places = [xyz for _, xyz in [*zip(*(dict(RECORDED.parameters)[key] for key in ("t", "xyz")), strict=True)]]
    for t, place in zip(RECORDED.breaks, places, strict=True):
        np.testing.assert_allclose(RECORDED.at(t)[0], place, atol=1e-15)
    for t, place in ((-3.0, places[0]), (5.0, places[-1])):
        np.testing.assert_array_equal(RECORDED.at(t), [place, np.zeros(3), np.zeros(3)])
    np.testing.assert_allclose([RECORDED.at(0.5)[1], RECORDED.at(4.0 - 1e-12)[1]], np.zeros((2, 3)), atol=1e-10)


def test_samples_of_a_cubic_from_rest_to_rest_return_it():
    t = np.array([0.0, 0.3, 0.4, 0.9, 1.0])
    s = np.array([0.1, 0.35, 0.77])
    path = samples(t, np.outer(t**2 * (3 - 2 * t), [1.0, 2.0, -3.0]))
    expected = np.outer(s**2 * (3 - 2 * s), [1.0, 2.0, -3.0])
    # A clamped spline reproduces a cubic; 1e-14 is the round-off of a 5 x 5 solve of condition 10.
    np.testing.assert_allclose([path.at(x)[0] for x in s], expected, atol=1e-14)


def test_a_recording_in_flight_has_the_velocities_at_its_ends():
    """A cubic with its own slopes comes back, and goes straight on behind its end."""
    t, cube = np.array([0.0, 0.4, 1.0]), np.array([1.0, -2.0, 0.5])
    path = samples(t, np.outer(t**3, cube), ends=[np.zeros(3), 3.0 * cube])
    np.testing.assert_allclose(path.at(0.7)[0], 0.7**3 * cube, atol=1e-14)
    np.testing.assert_allclose(path.at(3.0)[:2], [cube + 2.0 * 3.0 * cube, 3.0 * cube], atol=1e-14)


def test_periodic_samples_run_through_their_motion_again():
    """A sine by 32 samples a period: the periodic spline is off by (2 pi/32)^4/384 = 4e-6, at the seam as elsewhere."""
    t = np.linspace(0.0, 2.0, 33)
    path = samples(t, np.outer(np.sin(np.pi * t), [1.0, 0.0, 0.0]), periods=3)
    for x in (0.03, 1.97, 2.03, 4.01, 5.5):
        assert path.at(x)[0][0] == pytest.approx(np.sin(np.pi * x), abs=5e-6)
        assert path.at(x)[1][0] == pytest.approx(np.pi * np.cos(np.pi * x), abs=5e-4)
    np.testing.assert_array_equal(path.at(7.0)[1], np.zeros(3))


@pytest.mark.parametrize("t", [0.0, 0.3, 0.8, 1.234, 2.2, 3.5, 3.8])
def test_a_circle_keeps_its_radius_and_its_speed(t):
    """Full speed pi/s from 0.8 s to 3.0 s; at rest at 3.8 s after a turn and a half. The polynomials leave 2e-11."""
    q, v, a = CIRCLE.at(t)
    assert np.hypot(*q[:2]) == pytest.approx(1.0, abs=1e-10) and q[2] == pytest.approx(1.0)
    assert v @ [*q[:2], 0.0] == pytest.approx(0.0, abs=1e-8)
    if 0.8 <= t < 3.0:
        angle = np.pi * (t - 0.4)
        assert q[:2] == pytest.approx([np.cos(angle), np.sin(angle)], abs=1e-10)
        assert a[:2] == pytest.approx(-(np.pi**2) * q[:2], abs=1e-5)
    if t == 3.8:
        assert q == pytest.approx([-1.0, 0.0, 1.0], abs=1e-10) and v == pytest.approx(np.zeros(3), abs=1e-12)


def test_a_circle_at_once():
    assert AT_ONCE.at(0.0)[1] == pytest.approx([0, np.pi, 0]) and AT_ONCE.corners == pytest.approx([0.0, 3.0])
    assert AT_ONCE.at(1.0)[0] == pytest.approx([-1, 0, 1], abs=1e-10)


def test_lifted_held_and_lowered():
    for t, z in ((-1.0, 0.0), (0.75, 1.0), (1.7, 2.0), (2.75, 1.0), (3.6, 0.0)):
        np.testing.assert_allclose(LIFT.at(t)[0], [1.0, 0.0, z], atol=1e-14)
    assert LIFT.at(0.75)[1][2] == pytest.approx(2.0 * 1.875 / 1.5) == -LIFT.at(2.75)[1][2]
    assert lift((0, 0, 0), (0, 0, 1), 1.0).at(9.0)[0][2] == 1.0
    assert lift((0, 0, 0), (0, 0, 1), 1.0, hold=0.0).at(1.5)[0][2] == pytest.approx(0.5)


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.kind)
def test_seen_from_another_origin(path):
    moved = seen_from(path, (1.0, -2.0, 3.0))
    for t in (0.0, 0.7, 2.1):
        np.testing.assert_allclose(moved.at(t)[0] + (1.0, -2.0, 3.0), path.at(t)[0], atol=1e-12)


def test_harmonic_after_its_ramp():
    t, omega = 3.3, 2 * np.pi * 0.7
    q, v, a = SWING.at(t)
    amplitude = np.array([0.3, 0.0, 0.1])
    np.testing.assert_allclose(q, np.array([0, 0, 1]) + amplitude * np.sin(omega * t + 0.4), rtol=1e-14)
    np.testing.assert_allclose(v, amplitude * omega * np.cos(omega * t + 0.4), rtol=1e-14)
    np.testing.assert_allclose(a, -amplitude * omega**2 * np.sin(omega * t + 0.4), rtol=1e-14)
    np.testing.assert_array_equal(SWING.at(-0.1), [[0, 0, 1], [0, 0, 0], [0, 0, 0]])
    assert ENDLESS.at(0.0)[1] == pytest.approx(amplitude * omega)


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.kind)
def test_equal_by_its_parameters(path):
    again = eval(repr(path))  # its repr is the call that makes it
    assert again == path and hash(again) == hash(path)
    assert all(path != other for other in PATHS if other is not path)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: line((0, 0), (1, 0, 0), 1.0), r"`start` must be three finite numbers .* \[m\], but line has start="),
        (lambda: line((0, 0, 0), (1, 0, np.inf), 1.0), r"`velocity` must be three finite numbers .* \[m/s\]"),
        (lambda: line((0, 0, 0), (1, 0, 0), -1.0), r"`ramp` must be non-negative and finite \[s\].*ramp=-1.0"),
        (lambda: line((0, 0, 0), (1, 0, 0), 1e-7), r"`ramp` must be zero or at least 1e-06 s.*ramp=1e-07"),
        (lambda: harmonic((0, 0, 0), (1, 0, 0), -2.0), r"`frequency` must be non-negative and finite \[Hz\].*=-2.0"),
        (lambda: harmonic((0, 0, 0), (1, 0, 0), 2.0, phase="x"), r"`phase` must be a finite number \[rad\].*phase='x'"),
        (lambda: samples([0.0], [(0, 0, 0)]), r"shapes \(k,\) and \(k, 3\) with k at least 2, but have \(1,\)"),
        (lambda: samples([0, 1], np.zeros((2, 3)), ends=[0, 1]), r"`ends` of samples must be two velocities of three .* \[0, 1\]"),
        (lambda: samples([0, 1], np.zeros((2, 3)), ends="no"), r"`ends` of samples must be two velocities of three .* 'no'"),
        (lambda: samples([0, 1], np.eye(2, 3), periods=2), r"Periodic samples must end where they begin, but the last is 1 m"),
        (lambda: samples([0, 1], np.eye(2, 3), periods=0), r"Argument `periods` must be an integer of at least 1, but samples has"),
        (lambda: samples([0, 1], np.eye(2, 3), np.eye(2, 3), 2), r"Only one of `ends` and `periods` of samples may be given"),
        (lambda: circle((0, 0, 1), (0, 0, 0), (0, 0, 1), 1.0, 1.0), r"A circle must start away from its axis, but it has start="),
        (lambda: circle((1, 0, 1), (0, 0, 0), (0, 0, 1), 1.0, 1.0, 2.0), r"may have a ramp of 1 s at most, but has 2 s"),
        (lambda: circle((1, 0, 1), (0, 0, 0), (0, 0, 0), 1.0, 1.0), r"Argument `axis` must .* circle has axis="),
        (
            lambda: circle((1, 0, 1), (0, 0, 0), (0, 0, 1), 1.0, 1e9),
            r"A circle of 1e\+09 turns would take 1.28e\+11 rows, but must",
        ),
        (lambda: lift((1, 0, 1), (0, 0, 1), 0.0), r"Argument `duration` must be positive and finite \[s\], but lift has"),
        (lambda: lift((1, 0, 1), (0, 0, 1), 1e-9), r"but lift has duration=1e-09"),
        (lambda: samples([0, 1], [(0, 0), (1, 1)]), r"but have \(2,\) and \(2, 2\)"),
        (lambda: samples([0, 1], ["a", "b"]), r"must be arrays of numbers, but could not convert"),
        (lambda: samples([0, 1, 1], np.zeros((3, 3))), r"must increase, but t\[1\]=1.0 is followed by t\[2\]=1.0"),
        (lambda: samples([0, 1], [(0, 0, 0), (0, np.nan, 0)]), r"be finite, but sample 1 has t=1.0, xyz=\(0.0, nan"),
    ],
)
def test_messages(make, message):
    with pytest.raises(InputError, match=message):
        make()
