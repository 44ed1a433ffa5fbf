"""Sums of waves: against regular ones, the equations of motion, spectra and variances, recordings, and what is refused."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.signal import welch
from slow import slow

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, simulate
from anet_lumped.effects import Gravity, Water
from anet_lumped.effects.flow.waves import Airy, Components, Jonswap, PiersonMoskowitz, Recorded
from anet_lumped.effects.flow.waves.kernel import pack, wave_at
from anet_lumped.files.scene_file import load_scene, save_scene

G, LEVEL = 9.81, 1.5
SEA = Components([(0.3, 0.8, 0.2, 0.4), (0.2, 1.3, -1.0, -0.7), (0.1, 2.0, 2.0, 2.5), (0.05, 0.0, 0.3, 0.0)], depth=8.0, ramp=4.0)


def at(waves, t, place):
    return wave_at(t, *map(float, place), pack(waves, G, LEVEL))


def flat(motion):
    return np.concatenate([np.ravel(part) for part in motion])


@pytest.mark.parametrize("depth", [6.0, math.inf])
@pytest.mark.parametrize("z", [-5.9, -1.0, 0.2, 3.0])
def test_a_wave_in_three_parts_is_the_wave(depth, z):
    """By the function of a sum and by that of a regular wave, in its ramp and after it."""
    whole = Airy(0.6, 4.0, (3.0, 4.0, 0.0), depth, phase=0.7, ramp=2.0)
    parts = [dataclasses.replace(whole, height=h) for h in (0.1, 0.2, 0.3)]
    for t in (0.6, 3.1):
        np.testing.assert_allclose(
            flat(at(parts, t, (1.0, -2.0, LEVEL + z))), flat(at(whole, t, (1.0, -2.0, LEVEL + z))), rtol=1e-12, atol=1e-14
        )


@pytest.mark.parametrize("z", [-7.0, -0.6, 0.1, 1.2])
def test_slopes(z):
    """Gradients of surface, velocity and acceleration, and the rate of the surface, by central differences."""
    place, t, h = np.array([0.7, -0.4, LEVEL + z]), 2.9, 1e-4
    surface, _, gradient, _, of_a = at(SEA, t, place)
    for x in range(3):
        step = h * np.eye(3)[x]
        after, before = at(SEA, t, place + step), at(SEA, t, place - step)
        slopes = [(np.array(a) - np.array(b)) / (2 * h) for a, b in zip(after, before, strict=True)]
        # h^2/6 of a third derivative, k^3 a omega^2 < 1, and eps/h of rounding
        np.testing.assert_allclose(slopes[1], gradient[x::3], rtol=0, atol=1e-8)
        np.testing.assert_allclose(slopes[3], of_a[x::3], rtol=0, atol=1e-8)
        if x < 2:
            assert slopes[0][0] == pytest.approx(surface[2 + x], abs=1e-8)
    assert (at(SEA, t + h, place)[0][0] - at(SEA, t - h, place)[0][0]) / (2 * h) == pytest.approx(surface[1], abs=1e-8)


def test_small_waves_obey_the_equations_of_motion():
    """Of an ideal fluid: no divergence, no curl, and the acceleration is the rate of the velocity; Wheeler's part is of order a."""
    small = Components([(1e-9 * a, *others) for a, *others in SEA.components[:3]], 8.0, 4.0)
    place, t, h = (1.0, 2.0, LEVEL - 0.7), 2.4, 1e-4
    _, velocity, gradient, acceleration, _ = at(small, t, place)
    size = np.linalg.norm(velocity)
    ux, uy, uz, vx, vy, vz, wx, wy, wz = gradient
    for zero in (ux + vy + wz, uz - wx, vz - wy, uy - vx):
        assert abs(zero) < 1e-8 * size  # the steepness k a
    rate = (np.array(at(small, t + h, place)[1]) - np.array(at(small, t - h, place)[1])) / (2 * h)
    np.testing.assert_allclose(acceleration, rate, rtol=0, atol=3e-8 * size)  # (h omega)^2/6


def test_surface_and_bottom():
    """At the surface the water rises as the surface does where it passes; at the bottom nothing goes up or down."""
    for t in (4.0, 5.3, 9.1):
        eta = at(SEA, t, (0.3, 0.2, 0.0))[0][0]
        assert at(SEA, t, (0.3, 0.2, LEVEL + eta))[1] == at(SEA, t, (0.3, 0.2, LEVEL + eta + 5.0))[1]
        _, velocity, _, acceleration, _ = at(SEA, t, (0.3, 0.2, LEVEL - 8.0))
        assert abs(velocity[2]) < 1e-15 and abs(acceleration[2]) < 1e-15
        surface, velocity, *_ = at(SEA, t, (0.3, 0.2, LEVEL + eta))
        assert velocity[2] == pytest.approx(surface[1], abs=1e-14)


def test_what_is_deep_or_constant_moves_nothing():
    lifted = Components([(0.4, 0.0, 0.0, 0.0)], 8.0)
    surface, velocity, *_ = at(lifted, 1.0, (0, 0, 0))
    assert surface[0] == 0.4 and velocity == (0.0, 0.0, 0.0) and not lifted.highest_frequency
    _, velocity, _, acceleration, _ = at(dataclasses.replace(SEA, depth=math.inf), 6.0, (0, 0, -1e4))
    assert (*velocity, *acceleration) == (0.0,) * 6


def test_seen_from_elsewhere():
    origin = (30.0, -7.0, 0.0)
    for sea in (SEA, Jonswap(1.0, 6.0, 3, (1, 1, 0), components=5, depth=20.0)):
        there = sea.seen_from(origin, G)
        for t, place in ((4.5, (1.0, 2.0, 0.3)), (7.0, (-3.0, 0.0, 2.0))):
            moved = np.array(place) + origin
            np.testing.assert_allclose(flat(at(there, t, place)), flat(at(sea, t, moved)), rtol=0, atol=1e-13)


def test_spectra_peak_at_the_period_that_is_given():
    """S(w_p) = 5/16 Hs^2/w_p exp(-5/4) by Pierson and Moskowitz, and elsewhere it goes as w^-5 exp(-5/4 (w/w_p)^-4)."""
    peak, w = 2.0 * np.pi / 9.0, np.linspace(0.2, 3.0, 20_001)
    for sea in (PiersonMoskowitz(3.0, 9.0, 4), Jonswap(3.0, 9.0, 4)):
        assert w[np.argmax(sea.spectrum(w))] == pytest.approx(peak, abs=2e-4)
    found = PiersonMoskowitz(3.0, 9.0, 4).spectrum(np.array([peak, 2.0 * peak]))
    assert found[0] == pytest.approx(5.0 / 16.0 * 9.0 / peak * np.exp(-1.25), rel=1e-12)
    assert found[1] / found[0] == pytest.approx(2.0**-5 * np.exp(1.25 * (1.0 - 2.0**-4)), rel=1e-12)


@pytest.mark.parametrize("sea", [Jonswap(3.0, 9.0, 4, components=400), *slow(PiersonMoskowitz(3.0, 9.0, 4, components=400))])
def test_variance_and_spectrum(sea):
    """Four standard deviations are the height, and the spectrum of a long series is the one asked for."""
    t = np.arange(0.0, 20000.0, 0.5)
    a, omega, phase = sea.rows(G)[:, :3].T
    assert np.sum(a**2) / 2.0 == pytest.approx((3.0 / 4.0) ** 2, rel=1e-14)
    eta = sum(
        np.real(a[m : m + 40] @ np.exp(1j * (phase[m : m + 40, None] - omega[m : m + 40, None] * t))) for m in range(0, 400, 40)
    )
    assert 4.0 * eta.std() == pytest.approx(3.0, rel=0.01)  # of 400 waves whose mean product is some 1/(length times band)
    series = [wave_at(x, 0.0, 0.0, -3.0, pack(sea, G, 0.0))[0][0] for x in t[:20]]
    np.testing.assert_allclose(series, eta[:20], rtol=0, atol=1e-11)
    f, found = welch(eta, 2.0, nperseg=2048)
    within = (f > 0.6 / 9.0) & (f < 3.0 / 9.0)
    whole = np.linspace(1e-3, 40.0, 400000) * 2.0 * math.pi / 9.0
    scale = (3.0 / 4.0) ** 2 / np.trapezoid(sea.spectrum(whole), whole)
    expected = 2.0 * math.pi * scale * sea.spectrum(2.0 * math.pi * f[within])
    # energy below f, so that single samples of the spectrum count little: 0.5 % lie beyond the highest band, the rest is chance
    below = [np.cumsum(found[within]) * f[1], np.cumsum(expected) * f[1]]
    np.testing.assert_allclose(below[0], below[1], rtol=0, atol=0.02 * (3.0 / 4.0) ** 2)


def test_factor_of_jonswap():
    """(1 - 0.287 ln gamma) keeps the variance, for 1 < gamma < 7 (DNV-RP-C205, 3.5.5.3)."""
    omega = np.linspace(0.05, 40.0, 400000)
    for gamma in (1.0, 3.3, 6.0):
        whole = np.trapezoid(Jonswap(2.0, 6.0, 0, gamma=gamma).spectrum(omega), omega)
        assert (1.0 - 0.287 * math.log(gamma)) * whole == pytest.approx(0.25, rel=0.01)  # the factor is a fit


def test_directions():
    """cos^n has the mean square of its sine 1/(n + 2), about the direction; without spreading all go one way."""
    for n in (2.0, 10.0):
        sea = Jonswap(1.0, 6.0, 5, (0.6, 0.8, 0.0), spreading=n, components=2000)
        along = sea.rows(G)[:, 3:] @ [0.6, 0.8]
        across = sea.rows(G)[:, 3:] @ [-0.8, 0.6]
        assert along.min() >= 0.0 and abs(across.mean()) < 1e-3  # stratified: 1/2000 and less
        assert np.mean(across**2) == pytest.approx(1.0 / (n + 2.0), abs=1e-3)
    np.testing.assert_allclose(Jonswap(1.0, 6.0, 5, (0, -3, 0)).rows(G)[:, 3:], [[0.0, -1.0]] * 100, rtol=0, atol=1e-15)


def test_the_seed_says_which_sea():
    rows = [Jonswap(1.0, 6.0, seed).rows(G) for seed in (1, 1, 2)]
    assert (rows[0] == rows[1]).all() and not (rows[0][:, 2] == rows[2][:, 2]).any()


@pytest.mark.parametrize("count", [241, *slow(240)])
def test_a_recorded_elevation_comes_back(tmp_path, count):
    t = 5.0 + 0.25 * np.arange(count)
    eta = 0.1 + 0.3 * np.cos(0.7 * t) + 0.2 * np.sin(1.9 * t) + 0.01 * np.random.default_rng(0).normal(size=count)
    file = tmp_path / "gauge.csv"
    file.write_text("t,elevation\n" + "\n".join(f"{a!r},{b!r}" for a, b in zip(t.tolist(), eta.tolist(), strict=True)))
    sea = Recorded(str(file), depth=30.0)
    found = [at(sea, x, (0, 0, 0))[0][0] for x in t]
    np.testing.assert_allclose(found, eta, rtol=0, atol=1e-12)  # rounding of the series
    cut = Recorded(str(file), (0, 1, 0), highest=0.2, depth=30.0)
    assert cut.highest_frequency <= 0.4 * math.pi < sea.highest_frequency == pytest.approx(4.0 * math.pi, rel=0.01)
    assert cut.usual_period == pytest.approx(2.0 * math.pi / 0.7, rel=0.1)  # the nearest of the series
    slow = [at(cut, x, (0, 0, 0))[0][0] for x in t[40:-40]]
    np.testing.assert_allclose(slow, (0.1 + 0.3 * np.cos(0.7 * t))[40:-40], rtol=0, atol=0.1)  # leakage of an open series


def hung(**water):
    cable = Cable("a", "b", length=6.5, segments=6, mass_per_length=0.3, EA=1e4, zeta=0.1, diameter=0.02, Can=1.0)
    ends = [Fixed("a", (0, 0, -5)), Free("b", 0.2, at=(3.0, 0.0, -0.3), volume=1e-3, CdA=0.01, Ca=0.5)]
    return Scene(ends, [cable], [Gravity(G), Water(**water)])


def test_a_float_in_two_waves_of_half_the_height():
    whole, half = Airy(0.4, 3.0, (1, 0.5, 0), depth=6.0), Airy(0.2, 3.0, (1, 0.5, 0), depth=6.0)
    runs = [
        simulate(hung(**water), 1.0, method="edmc", dt=0.02, start="straight")
        for water in ({"wave": whole}, {"waves": [half, half]})
    ]
    np.testing.assert_allclose(runs[1].position("b"), runs[0].position("b"), rtol=0, atol=1e-9)  # what Newton's method leaves


def test_the_shortest_wave_sets_the_step():
    assert Water(waves=SEA).time_scales == (1.0,)
    assert Water(waves=[Airy(0.1, math.pi), Airy(0.1, 8.0)]).time_scales == (1.0,)
    assert Water(waves=Jonswap(1.0, 8.0 * math.pi, 1)).time_scales == pytest.approx((2.0,))
    assert Water(waves=Components([(0.4, 0.0, 0.0, 0.0)])).time_scales == ()


def test_scene_file(tmp_path):
    (tmp_path / "gauge.csv").write_text("t,elevation\n0,0\n1,0.1\n2,0\n")
    kinds = [
        SEA,
        Jonswap(1.0, 6.0, 3, gamma=2.0, spreading=4.0),
        PiersonMoskowitz(1.0, 6.0, 3),
        Recorded(str(tmp_path / "gauge.csv")),
    ]
    for waves in (*kinds, [Airy(0.5, 6.0), kinds[1]]):
        scene = hung(waves=waves)
        save_scene(scene, tmp_path / "scene.toml")
        assert load_scene(tmp_path / "scene.toml") == scene


def text(tmp_path, content):
    (tmp_path / "gauge.csv").write_text(content)
    return str(tmp_path / "gauge.csv")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda _: Components([]),
         r"`components` must be at least one row \(a, omega, phase, heading\), but wave Components has \[\]"),
        (lambda _: Components([(1.0, -1.0, 0.0, 0.0)]),
         r"`components\[0\]` must be four finite numbers .* not negative, but wave Comp"),
        (lambda _: Components([(1.0, 1.0, 0.0, 0.0), (1.0, 1.0)]), r"`components\[1\]` must be four finite numbers"),
        (lambda _: Jonswap(1.0, 6.0, -1), "`seed` must be an integer of at least 0, but wave Jonswap has seed=-1"),
        (lambda _: Jonswap(1.0, 6.0, 1, gamma=0.5), "`gamma` must be at least 1, but wave Jonswap has gamma=0.5"),
        (lambda _: Jonswap(1.0, 6.0, 1, spreading=0.0),
         "`spreading` must be positive and finite, but wave Jonswap has spreading=0.0"),
        (lambda _: PiersonMoskowitz(1.0, 6.0, 1, components=0), "`components` must be an integer of at least 1, but wave Pierson"),
        (lambda _: pack(PiersonMoskowitz(9.0, 6.0, 1), G, 0.0),
         "`height` must be below 7.981 m, where a wave of this period breaks, but"),
        (lambda _: pack(SEA, 0.0, 0.0), "A wave needs gravity, but wave Components has g=0.0 m/s2"),
        (lambda _: pack(Components([(1.0, 3.0, 0.0, 0.0)]), G, 0.0),
         r"A wave of a period of 2\.094 s must be lower than 0\.9725 m, where it breaks, but wave Components has one of 2 m"),
        (lambda _: pack(Components([(1.0, 0.0, 0.0, 0.0)], 0.5), G, 0.0),
         "elevation must be less than the depth of 0.5 m, but wave Comp"),
        (lambda _: pack(Jonswap(0.1, 6.0, 1, components=5001), G, 0.0), "At most 5000 regular waves may add up, but .* are 5001"),
        (lambda _: Recorded(3), "`file` must be the path of a file, a string, but wave Recorded has file=3"),
        (lambda _: Recorded("nowhere.csv"), "A recorded elevation must be readable, but nowhere.csv: No such file"),
        (lambda to: Recorded(text(to, "t,eta\n0,1\n")), 'A recorded elevation must begin with the line "t,elevation", but'),
        (lambda to: Recorded(text(to, "t,elevation\n0,1\n1,2\n3,1\n")),
         "must have equal steps, but in .* they are from 1 s to 2 s"),
        (lambda to: Recorded(text(to, "t,elevation\n0,1\n0,2\n")), "The times of a recorded elevation must increase, but in"),
        (lambda to: Recorded(text(to, "t,elevation\n0,1\n")),
         r"must hold at least two lines of two finite numbers \(t, elevation\)"),
        (lambda _: Water(waves=[Airy(1.0, 8.0), 3.0]), "`waves` must be waves of anet_lumped.waves or None, but effect Water has"),
        (lambda _: Water(waves=[Airy(1.0, 8.0), Airy(1.0, 8.0, depth=9.0)]),
         r"one `depth` \[m\], but effect Water has waves of depth=9.0 and inf"),
        (lambda _: Water(waves=[Airy(1.0, 8.0), Airy(1.0, 8.0, ramp=9.0)]),
         r"one `ramp` \[s\], but effect Water has waves of ramp=0.0 and 9.0"),
        (lambda _: Water(wave=Airy(1.0, 8.0), waves=Airy(1.0, 8.0)),
         "One of the arguments `wave` and `waves` must be None, but effect"),
    ],
)  # fmt: skip
def test_messages(tmp_path, make, message):
    with pytest.raises(SceneError, match=message):
        make(tmp_path)
