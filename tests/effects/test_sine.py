"""Sine, cosine and exponential function of `laws.sine` beside those of the C library."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped.effects.laws.sine import exponential, sine_and_cosine


@tried(500)
@given(st.floats(-1e6, 1e6))
def test_sine_and_cosine(x):
    """Two roundings of numbers up to 1, and what is left of the reduction: 1e-16 for a million radians."""
    sine, cosine = sine_and_cosine(x)
    assert abs(sine - math.sin(x)) < 4e-16 and abs(cosine - math.cos(x)) < 4e-16


@pytest.mark.parametrize("k", range(-9, 10))
@pytest.mark.parametrize("off", [-1e-9, 0.0, 1e-9])
def test_at_the_ends_of_quarters(k, off):
    """Where one polynomial takes over from another, and where one of both is zero."""
    x = 0.25 * k * math.pi + off
    assert sine_and_cosine(x) == pytest.approx((math.sin(x), math.cos(x)), rel=0.0, abs=4e-16)


@tried(500)
@given(st.floats(-40.0, 0.0))
def test_exponential(x):
    """64 times the rounding of the number that is squared six times, 1.1e-16."""
    assert exponential(x) == pytest.approx(math.exp(x), rel=1.5e-14)
