"""Platforms: paths of their points against the formula, rigidity, exact velocities; the polynomial through states."""

import math
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Free, Scene, SceneError, SixMotions, equilibrium, paths, signals, simulate
from anet_lumped.effects import Gravity
from anet_lumped.prescribed.path_kernel import evaluate
from anet_lumped.prescribed.six_motions import ROTATIONS, TRANSLATIONS, point_paths

AT, ORIGIN = (30.0, -12.0, -9.0), (1.0, 2.0, 0.5)
SWING = SixMotions(
    surge=signals.harmonic(0.2, 1.5, 0.1, 0.3),
    heave=(signals.harmonic(0.0, 0.5, 0.13), signals.line(0.0, 0.01, 5.0)),
    roll=signals.harmonic(0.0, 0.08, 0.11),
    pitch=signals.harmonic(0.0, 0.1, 0.09, 1.0),
    yaw=signals.harmonic(0.05, 0.2, 0.05),
)


def rotation(roll, pitch, yaw):
    """Rx(roll) Ry(pitch) Rz(yaw), as matrices."""
    (a, b, c), (d, e, f) = np.cos((roll, pitch, yaw)), np.sin((roll, pitch, yaw))
    about_x, about_y = [[1, 0, 0], [0, a, -d], [0, d, a]], [[b, 0, e], [0, 1, 0], [-e, 0, b]]
    return np.array(about_x) @ np.array(about_y) @ np.array([[c, -f, 0], [f, c, 0], [0, 0, 1]])


def point_path(motions, at, t_end, origin=(0.0, 0.0, 0.0)):
    return point_paths(motions, [at], t_end, origin)[0]


def place(motions, t, at=AT, origin=ORIGIN):
    """Where a point is, from the formula."""
    value = [sum(signal.at(t)[0] for signal in getattr(motions, name)) for name in TRANSLATIONS + ROTATIONS]
    return np.array(origin) + value[:3] + rotation(*value[3:]) @ np.subtract(at, origin)


@pytest.mark.parametrize("t", [0.0, 0.77, 3.21, 19.9])
def test_a_point_of_a_platform_moves_by_the_formula(t):
    """Between samples of a 64th of the shortest period the path is off by 2e-11 of arms and amplitudes of 40 m."""
    path = point_path(SWING, AT, 20.0, ORIGIN)
    q, v, a = path.at(t)
    assert np.allclose(q, place(SWING, t), atol=1e-9)
    h = 1e-3
    before, after = (place(SWING, t + x) for x in (-h, h)) if t else (place(SWING, t), place(SWING, t))
    if t:
        assert np.allclose(v, (after - before) / (2 * h), atol=1e-6)  # h^2/6 times a third derivative of 2 m/s3
        assert np.allclose(a, (after - 2 * place(SWING, t) + before) / h**2, atol=1e-5)


def test_velocities_at_samples_are_exact():
    """Of d + Rz p: the rate of yaw times the arm, crosswise."""
    yaw = SixMotions(yaw=signals.harmonic(0.0, 0.3, 0.05))
    angle, rate = yaw.yaw[0].at(0.0)
    q, v, a = point_path(yaw, (10.0, 0.0, 3.0), 40.0).at(0.0)
    assert angle == 0.0 and rate == pytest.approx(0.3 * 0.1 * math.pi, rel=1e-15)
    np.testing.assert_allclose(q, (10.0, 0.0, 3.0), rtol=0, atol=0)
    np.testing.assert_allclose(v, (0.0, 10.0 * rate, 0.0), rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(a, (-10.0 * rate**2, 0.0, 0.0), rtol=1e-13, atol=1e-15)


def test_all_times_at_once_are_as_one_by_one():
    t = np.linspace(-1.0, 20.0, 47)
    motions = SixMotions(sway=signals.line(0.1, 0.2, 3.0), yaw=signals.harmonic(0.1, 0.2, 0.3, 0.4, 5.0))
    np.testing.assert_allclose(motions.at(t), [motions.at(float(x)) for x in t], rtol=1e-14, atol=1e-14)
    for axis, (signal,) in ((1, motions.sway), (5, motions.yaw)):
        one_by_one = [[float(x[0]) for x in signal.path.at(time)] for time in t]
        np.testing.assert_allclose(motions.at(t)[:, :, axis], one_by_one, rtol=1e-13, atol=1e-13)


def test_points_keep_their_distances():
    one, other = (point_path(SWING, at, 20.0, ORIGIN) for at in (AT, (-8.0, 4.0, 2.0)))
    apart = [np.linalg.norm(one.at(t)[0] - other.at(t)[0]) for t in np.linspace(0.0, 20.0, 173)]
    assert np.ptp(apart) < 1e-9  # as above


def test_a_recorded_motion_passes_through_its_samples():
    t = np.linspace(0.0, 6.0, 25)
    surge = np.sin(t) ** 2
    motions = SixMotions(surge=signals.samples(t, surge), pitch=signals.samples(t, 0.1 * surge))
    path = point_path(motions, AT, 6.0)
    for time in t[:-1]:
        assert np.allclose(path.at(time)[0], place(motions, time, origin=(0, 0, 0)), atol=1e-12)
    assert np.allclose(path.at(1.1)[0], place(motions, 1.1, origin=(0, 0, 0)), atol=1e-6)  # (0.25 s)^6/46080 of 40 m and some 1/s6


def test_what_moves_is_still_before_and_after():
    path = point_path(SWING, AT, 20.0, ORIGIN)
    assert np.array_equal(path.at(-1.0)[0], path.at(0.0)[0]) and not path.at(-1.0)[1].any()
    assert np.allclose(path.at(25.0)[0], place(SWING, 20.0), atol=1e-12) and not path.at(25.0)[1].any()
    assert path.corners.tolist() == [0.0, 20.0]


def test_states_are_of_order_six_and_smooth():
    """The error falls by 2^6 with half the interval."""

    def off(count):
        t = np.linspace(0.0, 4.0, count + 1)
        x = np.column_stack([np.sin(2.0 * t), np.exp(-t), 0.0 * t])
        v = np.column_stack([2.0 * np.cos(2.0 * t), -np.exp(-t), 0.0 * t])
        a = np.column_stack([-4.0 * np.sin(2.0 * t), np.exp(-t), 0.0 * t])
        path = paths.states(t, x, v, a)
        times = np.linspace(0.0, 3.99, 400)
        wrong = max(np.abs(path.at(s)[0] - (math.sin(2.0 * s), math.exp(-s), 0.0)).max() for s in times)
        before, after = path.at(t[3] - 1e-9), path.at(t[3])
        assert all(np.allclose(b, a, atol=1e-7) for b, a in zip(before, after, strict=True))  # 1e-9 s times a third derivative
        return wrong

    errors = [off(count) for count in (4, 8, 16, 32)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.allclose(orders, 6.0, atol=0.4), orders


@pytest.mark.parametrize("method", ["edmc", "verlet"])
def test_a_run_that_ends_with_the_states_ends_in_their_motion(method):
    """A weight that is lifted steadily: T = m g up to the last state, where a stop in a moment took 0.3 N, or all, of 5.3 N."""
    t, up = np.linspace(0.0, 0.2, 21), (0.0, 0.0, 0.5)
    path = paths.states(t, np.outer(t, up), [up] * 21, [(0.0, 0.0, 0.0)] * 21)
    rope = Cable("a", "b", length=2.0, mass_per_length=0.02, EA=1e5, segments=4, zeta=0.5)
    scene = Scene([Driven("a", path), Free("b", mass=0.5)], [rope], [Gravity(9.81)])
    rest = equilibrium(scene)
    run = simulate(scene, 0.2, method=method, dt=4e-5, start=replace(rest, v=np.tile(up, (len(rest.q), 1))), save_every=0.02)
    assert run.velocity("a")[-1] == pytest.approx(up, abs=1e-12)
    assert run.reaction("a")[:, 2] == pytest.approx(0.54 * 9.81, rel=1e-6)
    assert np.array_equal(path.at(0.3)[1], np.zeros(3)) and path.at(0.3)[0] == pytest.approx([0.0, 0.0, 0.1], abs=1e-15)


def test_compiled_code_reads_states():
    path = point_path(SWING, AT, 20.0, ORIGIN)
    q, v, a = np.zeros((3, 1, 3))
    evaluate(7.3, paths.pack([path]), q, v, a)
    for found, expected in zip((q, v, a), path.at(7.3), strict=True):
        np.testing.assert_allclose(found[0], expected, rtol=1e-12, atol=1e-12)


def test_states_seen_from_elsewhere():
    path = point_path(SWING, AT, 20.0, ORIGIN)
    moved = paths.seen_from(path, (5.0, 6.0, 7.0))
    assert np.allclose(moved.at(3.3)[0] + (5.0, 6.0, 7.0), path.at(3.3)[0], atol=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: SixMotions(surge=1.0),
            "`surge` of a platform's motions must be a signal of anet_lumped.signals, or several, but it",
        ),
        (lambda: SixMotions(pitch=[1.0]), "`pitch` of a platform's motions must be a signal"),
        (lambda: point_path(SWING, AT, -1.0), "`t_end` must be positive"),
        (lambda: point_path(SWING, AT, 1.0, (0, 0)), "`origin` must be three finite numbers"),
        (
            lambda: paths.states([0, 1], [[0, 0, 0]] * 2, [[0, 0, 0]], [[0, 0, 0]] * 2),
            r"`velocity` \[m/s\] of states must have shapes",
        ),
        (lambda: paths.states([0, 0], *[[[0, 0, 0]] * 2] * 3), "`t` \\[s\\] of states must increase"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(SceneError, match=message):
        make()


@pytest.mark.parametrize(
    ("t", "values", "message"),
    [
        ([0.0, 1.0], [0.0, 1.0, 2.0], "`t` and `values` of samples must be of one length, but are of 2 and 3"),
        ("ab", [0.0, 1.0], "Argument `t` of samples must be numbers, but could not convert string to float: 'a'"),
    ],
)
def test_samples_of_a_signal_are_told_by_its_own_arguments(t, values, message):
    with pytest.raises(SceneError, match=message):
        signals.samples(t, values)
