"""The quintic smoothstep: its ends, its derivatives, and that compiled code evaluates the same lines."""

import numpy as np
from numba import njit
from numpy.polynomial import Polynomial

from anet_lumped.prescribed.smoothstep_kernel import ramped, smoothstep


def test_it_is_the_polynomial_with_its_derivatives():
    S = Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])
    s = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(smoothstep(s), [S(s), S.deriv()(s), S.deriv(2)(s)], atol=1e-14)  # of terms up to 60


def test_a_ramp_sets_in_and_ends_without_a_jump():
    assert ramped(-1.0, 2.0) == ramped(0.0, 2.0) == (0.0, 0.0, 0.0)
    assert ramped(2.0, 2.0) == ramped(3.0, 2.0) == ramped(-1.0, 0.0) == (1.0, 0.0, 0.0)
    assert ramped(1.0, 2.0) == (0.5, 15.0 / 16.0, 0.0)  # halfway: the slope 15/8 over the ramp
    h = 1e-5
    for t in (0.1, 0.7, 1.5):
        value, rate, acceleration = ramped(t, 1.6)
        before, after = ramped(t - h, 1.6), ramped(t + h, 1.6)
        np.testing.assert_allclose(rate, (after[0] - before[0]) / (2 * h), rtol=1e-7)  # h^2, and rounding over h
        np.testing.assert_allclose(acceleration, (after[1] - before[1]) / (2 * h), rtol=1e-7)
        assert 0.0 < value < 1.0


def test_compiled_code_evaluates_the_same_lines():
    at = njit(lambda t, ramp: ramped(t, ramp))
    for t, ramp in ((-1.0, 2.0), (0.3, 2.0), (1.9, 2.0), (2.1, 2.0), (0.5, 0.0)):
        np.testing.assert_allclose(at(t, ramp), ramped(t, ramp), rtol=1e-15)
