"""Waves: dispersion, kinematics and Wheeler's stretching against the closed formulas, slopes by differences, what is refused."""

import math

import numpy as np
import pytest

from anet_lumped import SceneError
from anet_lumped.effects.flow.waves import Airy
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.waves.kernel import wave_at

G, LEVEL = 9.81, 1.5
EPS = np.finfo(float).eps
DEEP = Airy(2.0, 8.0, (3.0, 4.0, 0.0), phase=0.3)
SHALLOW = Airy(0.4, 5.0, (-1.0, 2.0, 0.0), depth=3.0, phase=-1.0, ramp=4.0)


def at(wave, t, place, g=G):
    return wave_at(t, *map(float, place), pack_waves(wave, g, LEVEL))


@pytest.mark.parametrize("depth", [1e-3, 0.5, 3.0, 40.0, 1e4, math.inf])
@pytest.mark.parametrize("period", [0.8, 5.0, 20.0])
def test_dispersion(depth, period):
    wave = Airy(0.0, period, depth=depth)
    k = wave.wave_number(G)
    # brentq stops at 1e-14 of k; k tanh(k depth) grows as k^2 at most
    assert k * math.tanh(min(k * depth, 50.0)) * G == pytest.approx((2 * math.pi / period) ** 2, rel=1e-12)


def test_dispersion_of_deep_and_of_shallow_water():
    """L = g T^2/2 pi, and L = T sqrt(g depth) but for (k depth)^2/6."""
    assert 2 * math.pi / Airy(0.0, 10.0).wave_number(G) == pytest.approx(G * 100.0 / (2 * math.pi), rel=1e-14)
    length = 2 * math.pi / Airy(0.0, 10.0, depth=0.01).wave_number(G)
    assert length == pytest.approx(10.0 * math.sqrt(G * 0.01), rel=(0.01 * 2 * math.pi / length) ** 2)


def formulas(wave, t, place):
    """Surface, velocity and acceleration from the textbook's cosh and sinh, Wheeler's stretched depth in them; no ramp."""
    k, omega, a, depth = wave.wave_number(G), 2 * math.pi / wave.period, wave.height / 2, min(wave.depth, 1e3)
    X = np.array(wave.direction)
    theta = k * np.dot(X, place) - omega * t + wave.phase
    eta = a * math.cos(theta)
    Z = min((place[2] - LEVEL - eta) * depth / (depth + eta), 0.0)
    if wave.depth == math.inf:
        C = S = math.exp(k * min(place[2] - LEVEL - eta, 0.0))
    else:
        C, S = math.cosh(k * (Z + depth)) / math.sinh(k * depth), math.sinh(k * (Z + depth)) / math.sinh(k * depth)
    up = np.array([0.0, 0.0, 1.0])
    velocity = a * omega * (C * math.cos(theta) * X + S * math.sin(theta) * up)
    acceleration = a * omega**2 * (C * math.sin(theta) * X - S * math.cos(theta) * up)
    return eta, velocity, acceleration


@pytest.mark.parametrize("wave", [DEEP, Airy(0.4, 5.0, (-1.0, 2.0, 0.0), depth=3.0, phase=-1.0)], ids=["deep", "shallow"])
@pytest.mark.parametrize("z", [-2.9, -1.0, 0.0, 0.15, 0.9])
def test_kinematics(wave, z):
    for t, x in ((0.0, 0.0), (1.3, 2.0), (6.1, -7.5)):
        surface, velocity, _, acceleration, _ = at(wave, t, (x, 1.0, LEVEL + z))
        eta, u, a = formulas(wave, t, np.array([x, 1.0, LEVEL + z]))
        assert surface[0] == pytest.approx(eta, rel=1e-13, abs=1e-13)
        np.testing.assert_allclose(velocity, u, rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(acceleration, a, rtol=1e-12, atol=1e-13)


def test_wheeler():
    """The instantaneous surface moves as the theory says of the still one; at the bottom nothing goes up or down."""
    for t in np.linspace(0.0, 8.0, 9):
        (eta, rate, _, _), _, _, _, _ = at(DEEP, t, (0, 0, 0))
        _, velocity, _, acceleration, _ = at(DEEP, t, (0, 0, LEVEL + eta))
        theta, omega = 0.3 - 2 * math.pi / 8.0 * t, 2 * math.pi / 8.0
        assert velocity[2] == pytest.approx(rate, abs=1e-14) and velocity[2] == pytest.approx(omega * math.sin(theta), abs=1e-13)
        assert math.hypot(*velocity[:2]) == pytest.approx(omega * abs(math.cos(theta)), abs=1e-13)
        assert acceleration[2] == pytest.approx(-(omega**2) * math.cos(theta), abs=1e-13)
        _, velocity, _, acceleration, _ = at(SHALLOW, t, (0, 0, LEVEL - 3.0))
        assert abs(velocity[2]) < 1e-15 and abs(acceleration[2]) < 1e-15


def test_deep_water_is_still_and_has_no_overflow():
    """exp(k Z) underflows at a depth of 1e6 m."""
    _, velocity, gradient, acceleration, _ = at(DEEP, 1.0, (0, 0, -1e6))
    assert (*velocity, *gradient, *acceleration) == pytest.approx([0.0] * 15, abs=0.0)


@pytest.mark.parametrize("wave", [DEEP, SHALLOW], ids=["deep", "shallow"])
@pytest.mark.parametrize("z", [-2.0, -0.6, 0.1, 1.2])
def test_slopes(wave, z):
    """Gradients of surface, velocity and acceleration, and the rate of the surface, by central differences."""
    place, t, h = np.array([0.7, -0.4, LEVEL + z]), 2.9, 1e-4
    surface, _, gradient, _, of_a = at(wave, t, place)
    for x in range(3):
        step = h * np.eye(3)[x]
        after, before = at(wave, t, place + step), at(wave, t, place - step)
        slopes = [(np.array(a) - np.array(b)) / (2 * h) for a, b in zip(after, before, strict=True)]
        # h^2/6 of a third derivative, k^3 a omega < 1, and eps/h of rounding
        np.testing.assert_allclose(slopes[1], gradient[x::3], rtol=0, atol=1e-8)
        np.testing.assert_allclose(slopes[3], of_a[x::3], rtol=0, atol=1e-8)
        if x < 2:
            assert slopes[0][0] == pytest.approx(surface[2 + x], abs=1e-8)
    assert (at(wave, t + h, place)[0][0] - at(wave, t - h, place)[0][0]) / (2 * h) == pytest.approx(surface[1], abs=1e-8)


@pytest.mark.parametrize("depth", [2.0, math.inf])
def test_a_small_wave_obeys_the_equations_of_motion(depth):
    """Of an ideal fluid: no divergence, no curl, and the acceleration is the rate of the velocity; Wheeler's part is of order a."""
    wave, place, t, h = Airy(1e-9, 3.0, (0.6, 0.8, 0.0), depth), (1.0, 2.0, LEVEL - 0.7), 0.4, 1e-4
    _, velocity, gradient, acceleration, _ = at(wave, t, place)
    size = np.linalg.norm(velocity)
    ux, uy, uz, vx, vy, vz, wx, wy, wz = gradient
    for zero in (ux + vy + wz, uz - wx, vz - wy, uy - vx):
        assert abs(zero) < 1e-8 * size  # the steepness k a
    rate = (np.array(at(wave, t + h, place)[1]) - np.array(at(wave, t - h, place)[1])) / (2 * h)
    np.testing.assert_allclose(acceleration, rate, rtol=0, atol=3e-8 * size)  # (h omega)^2/6


def test_ramp():
    """Nothing at t = 0, half of it half way, all of it after; the acceleration is the rate of the velocity on the way."""
    wave, whole = Airy(1e-9, 3.0, ramp=4.0), Airy(1e-9, 3.0)
    place, h = (0.3, 0.0, LEVEL - 0.5), 1e-5
    assert at(wave, 0.0, place)[1] == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(at(wave, 2.0, place)[1], 0.5 * np.array(at(whole, 2.0, place)[1]), rtol=1e-8)  # Wheeler, again
    assert at(wave, 4.5, place) == at(whole, 4.5, place)
    rate = (np.array(at(wave, 1.1 + h, place)[1]) - np.array(at(wave, 1.1 - h, place)[1])) / (2 * h)
    np.testing.assert_allclose(at(wave, 1.1, place)[3], rate, rtol=1e-7)


def test_no_wave():
    surface, *rest = wave_at(1.0, 2.0, 3.0, 4.0, np.zeros(0))
    assert not any(surface) and not any(x for part in rest for x in part)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Airy(-1.0, 8.0), r"`height` must be non-negative and finite \[m\], but wave Airy has height=-1.0"),
        (lambda: Airy(1.0, 0.0), r"`period` must be positive and finite \[s\], but wave Airy has period=0.0"),
        (lambda: Airy(1.0, 8.0, (0, 0, 0)), r"`direction` must not be zero, but wave Airy has direction=\(0"),
        (lambda: Airy(1.0, 8.0, (1, 0, 1)), "`direction` must be level, but wave Airy"),
        (lambda: Airy(1.0, 8.0, depth=-1.0), r"`depth` must be positive and finite \[m\], but wave Airy has depth=-1.0"),
        (lambda: Airy(1.0, 8.0, ramp=-1.0), r"`ramp` must be non-negative and finite \[s\], but wave Airy has ramp=-1.0"),
        (lambda: Airy(1.0, 8.0, phase=math.nan), r"`phase` must be a finite number \[rad\], but wave Airy has phase=nan"),
        (lambda: Airy(1.0, 8.0).numbers(0.0, 0.0), "A wave needs gravity, but wave Airy has g=0.0 m/s2"),
        (lambda: Airy(3.6, 4.0).numbers(G, 0.0), "`height` must be below 3.547 m, where a wave of this period breaks, but"),
        (lambda: Airy(1.0, 9.0, depth=1.0).numbers(G, 0.0), "`height` must be below 0.87"),
    ],
)
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()
