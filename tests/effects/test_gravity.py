"""Uniform gravity."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from anet_lumped import SceneError
from anet_lumped.effects import Gravity


def test_gravity():
    gravity = Gravity(2.0, (0, 3, -4))
    np.testing.assert_allclose(gravity.uniform_acceleration, [0, 1.2, -1.6], rtol=1e-15)
    q = np.arange(6.0).reshape(2, 3)
    index, params = gravity.table(SimpleNamespace(mass=np.array([1.0, 3.0]), n_free=2))
    force, energy = gravity.kernels().values()
    f = np.ones((3, 3))
    assert force(0.0, q, q, index, params, f) == 0.0
    np.testing.assert_allclose(f, 1 + np.array([[0, 1.2, -1.6], [0, 3.6, -4.8], [0, 0, 0]]), rtol=1e-15)
    assert energy(0.0, q, index, params) == pytest.approx(-(1.2 - 3.2) - 3 * (4.8 - 8.0), rel=1e-15)
    np.testing.assert_array_equal(Gravity(0.0).uniform_acceleration, 0.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Gravity(-1.0), r"`g` must be non-negative and finite \[m/s2\], but effect Gravity has g=-1.0"),
        (lambda: Gravity(math.nan), "but effect Gravity has g=nan"),
        (lambda: Gravity(math.inf), "but effect Gravity has g=inf"),
        (lambda: Gravity("9.81"), r"`g` must be non-negative and finite \[m/s2\], but effect Gravity has g='9.81'"),
        (lambda: Gravity(9.81, (0, 0, 0)), r"`direction` must not be zero, but effect Gravity has direction=\(0.0, 0.0, 0.0\)"),
        (lambda: Gravity(9.81, (0, 1)), r"`direction` must be three finite numbers \(x, y, z\), but effect Gravity has"),
        (lambda: Gravity(9.81, (0, math.nan, 1)), "`direction` must be three finite numbers"),
    ],
)
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()
