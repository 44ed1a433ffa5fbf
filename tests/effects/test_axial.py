"""The axial law of one segment: against slow twins, against JAX and its derivatives, and what it promises."""

from fractions import Fraction

import naive
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from slow import slow
from tried import tried

from anet_lumped import Cable
from anet_lumped.effects.laws import axial

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)

jnp = jax.numpy

EPS = np.finfo(float).eps
COMPRESSION = list(axial.SWITCHES)
# Physical ranges: 0.1 mm to 10 m of segment, EA of 1 N to 1e9 N on it, damping ratios up to 1e3 as dashpots.
LENGTHS = st.floats(1e-4, 10.0)
# Multiples of 2^-40, so that no subnormal number turns up and sums with 1 are exact.
STRETCHES = st.floats(-0.9, 3.0).map(lambda x: round(x * 2**40) / 2**40)  # of the rest length
RATES = st.floats(-100.0, 100.0).map(lambda x: round(x * 2**40) / 2**40)
STIFFNESS = st.floats(0.0, 9.0).map(lambda x: 10.0**x)
DAMPERS = st.one_of(st.just(0.0), st.floats(-6.0, 6.0).map(lambda x: 10.0**x))


def cable_of(compression, EA=1e3, BA=5.0, length=0.5):
    return Cable("a", "b", length=length, mass_per_length=0.1, EA=EA, BA=BA, segments=1, compression=compression)


def numbers(cable):
    """Spring, damper and its switch, as the compiled laws take them."""
    two_way_spring, two_way_damper = axial.SWITCHES[cable.compression]
    return axial.spring_without_curve(cable.stiffness, two_way_spring), cable.dashpot, two_way_damper


@pytest.mark.parametrize("compression", COMPRESSION)
@tried()
@given(L0=LENGTHS, strain=STRETCHES, rate=RATES, k=STIFFNESS, c=DAMPERS)
def test_tension(compression, L0, strain, rate, k, c):
    cable = cable_of(compression, EA=k * L0, BA=c * L0, length=L0)
    l = L0 * (1 + strain)
    T, spring = axial.tension_parts(l - L0, rate, *numbers(cable))
    size = abs(cable.stiffness * (l - L0)) + abs(cable.dashpot * rate)
    # a handful of rounded products; their sum may cancel
    assert T == pytest.approx(naive.tension(cable, l, rate), abs=8 * EPS * size)
    assert spring == pytest.approx(naive.tension(cable, l, 0.0), abs=8 * EPS * size)
    if compression == "none":
        assert T >= 0.0 and (T == 0.0 or l > L0)
    assert axial.tension_slopes(l - L0, rate, *numbers(cable))[0] == pytest.approx(T, abs=4 * EPS * size)  # fused or not


@pytest.mark.parametrize("compression", COMPRESSION)
@tried()
@given(strain=STRETCHES, rate=RATES, k=STIFFNESS, c=DAMPERS)
def test_slopes_by_differences(compression, strain, rate, k, c):
    """The law is linear in pieces: its slopes are its differences within a piece."""
    cable = cable_of(compression, EA=k, BA=c, length=1.0)
    law = numbers(cable)
    T, of_stretch, of_rate = axial.tension_slopes(strain, rate, *law)
    h, g = 0.25 * abs(strain), 0.25 * abs(rate)
    T_l, T_r = axial.tension_parts(strain + h, rate, *law)[0], axial.tension_parts(strain, rate + g, *law)[0]
    # within a piece: neither slack nor cut at zero changes on the way
    whole = k * strain + c * rate
    assume(compression != "none" or strain <= 0 or min(whole, whole + k * h) > 0 or max(whole, whole + k * h) < 0)
    assume(compression != "none" or strain <= 0 or (whole > 0) == (whole + c * g > 0))
    size = 1.25 * (abs(k * strain) + abs(c * rate))
    assert T_l - T == pytest.approx(of_stretch * h, abs=8 * EPS * size)
    assert T_r - T == pytest.approx(of_rate * g, abs=8 * EPS * size)


@pytest.mark.parametrize("compression", ["damped", *slow(*(law for law in COMPRESSION if law != "damped"))])
def test_laws_in_jax(compression):
    """The same lines, traced: values equal but for products fused with sums, and JAX's derivatives are the slopes."""
    parts, slopes, energy = (
        axial.with_select(law, jnp.where) for law in (axial.tension_parts, axial.tension_slopes, axial.elastic_energy)
    )
    cable = cable_of(compression)
    law, k, c = numbers(cable), cable.stiffness, cable.dashpot

    @jax.jit
    @jax.vmap
    def traced(x, r):
        T, (of_stretch, of_rate) = jax.value_and_grad(lambda x, r: parts(x, r, *law)[0], (0, 1))(x, r)
        return T, of_stretch, of_rate, jax.grad(lambda x: energy(x, law[0]))(x), jnp.stack(slopes(x, r, *law))

    @settings(deadline=None, max_examples=20)
    @given(st.lists(st.tuples(STRETCHES, RATES), min_size=16, max_size=16))
    def check(states):
        x, r = np.array(states).T
        compiled = np.array([axial.tension_slopes(*state, *law) for state in states])
        size = np.abs(k * x) + np.abs(c * r)
        cut = np.abs(k * x + c * r) <= 8 * EPS * size  # where fusing decides on which side of the cut
        T, of_stretch, of_rate, spring, by_hand = traced(x, r)
        np.testing.assert_allclose(T, compiled[:, 0], rtol=0, atol=8 * EPS * size.max())
        np.testing.assert_array_equal(np.where(cut, 0, of_stretch), np.where(cut, 0, compiled[:, 1]))
        np.testing.assert_array_equal(np.where(cut, 0, of_rate), np.where(cut, 0, compiled[:, 2]))
        np.testing.assert_allclose(by_hand[~cut], compiled[~cut], rtol=0, atol=8 * EPS * size.max())
        elastic = np.array([axial.tension_parts(a, 0.0, *law)[1] for a in x])
        np.testing.assert_allclose(spring, elastic, rtol=4 * EPS)

    check()
    assert {part.dtype for part in traced(np.zeros(1), np.zeros(1))} == {np.dtype(np.float64)}


@pytest.mark.parametrize("compression", COMPRESSION)
@tried(300)
@given(
    a=STRETCHES, b=st.one_of(STRETCHES, st.just(0.0)), near=st.booleans(), k=STIFFNESS, c=DAMPERS, rho=st.floats(0.0, 1.0)
)  # fmt: skip
def test_tension_between(compression, a, b, near, k, c, rho):
    """Against exact arithmetic, near coincidence and across slackness; what it dissipates is not negative."""
    if near:
        b = a + 1e-13 * b
    cable = cable_of(compression, EA=k, BA=c, length=1.0)
    l_a, l_b = 1.0 + a, 1.0 + b
    x_a, x_b, h, alpha = l_a - 1.0, l_b - 1.0, 0.01, 0.5 * (1 - rho) / (1 + rho)  # the differences are exact
    (spring, c, two_damper), k = numbers(cable), cable.stiffness
    T, slope, secant = axial.tension_between(x_a, x_b, spring, c / h, alpha * k, two_damper)
    T_exact, secant_exact = naive.tension_between(cable, l_a, l_b, h, alpha)
    size = (k + c / h) * (abs(x_a) + abs(x_b))
    assert secant == pytest.approx(secant_exact, rel=8 * EPS)  # no cancellation, however small the change
    assert T == pytest.approx(T_exact, abs=16 * EPS * size)
    # (T - secant)(l_b - l_a) is a damper times a square, or what is left of it when T is cut at zero: exact but for signs
    assert (T - secant) * (x_b - x_a) >= -4 * EPS * size * abs(x_b - x_a)
    if compression == "none":
        assert T >= 0.0
    assert 0.0 <= slope <= (k + c / h) * (1 + 8 * EPS)


@pytest.mark.parametrize("compression", COMPRESSION)
@tried()
@given(a=STRETCHES, b=STRETCHES, k=STIFFNESS, c=DAMPERS)
def test_slope_between(compression, a, b, k, c):
    """The slope of `tension_between` in l_b, by a central difference in exact arithmetic."""
    cable, h = cable_of(compression, EA=k, BA=c, length=1.0), 0.01
    (spring, c, two_damper), k = numbers(cable), cable.stiffness
    step = Fraction(1, 2**40)
    l_a, l_b = 1 + Fraction(a), 1 + Fraction(b)
    assume(abs(b) > 1e-6 and abs(b - a) > 1e-3)  # away from the kink, and from where the secant's curvature is large
    T, slope, _ = axial.tension_between(a, b, spring, c / h, 0.5 * k, two_damper)
    assume(T == 0.0 or abs(T) > 1e-6 * (k + c / h))  # away from the cut
    low, high = (naive.tension_between(cable, l_a, l_b + s, h, 0.5)[0] for s in (-step, step))
    # T is rounded at eps T in each of two values 2^-39 apart; its third derivative in l_b is below k/(b - a)^3
    size = (k + c / h) * (abs(a) + abs(b))
    assert (high - low) / float(2 * step) == pytest.approx(slope, abs=4 * EPS * size * 2**39 + 1e-12 * k / abs(b - a) ** 3)
