"""Damping by the surroundings."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from anet_lumped import SceneError
from anet_lumped.effects import ViscousDamping

NO_BLOCKS = (np.zeros((0, 2, 3, 3)), np.zeros((0, 2, 3, 3)))  # near and far, of a net in which no effect joins nodes


def test_viscous_damping():
    damping = ViscousDamping(0.5)
    index, params = damping.table(SimpleNamespace(mass=np.array([1.0, 3.0]), n_free=2))
    force, tangent, energy = damping.kernels().values()
    v, f, D = np.array([[1.0, 2, 3], [-1, 0, 1]]), np.zeros((2, 3)), np.zeros((2, 3, 3))
    assert force(0.0, v, v, index, params, f) == pytest.approx(0.5 * 14 + 1.5 * 2)
    np.testing.assert_allclose(f, [[-0.5, -1, -1.5], [1.5, 0, -1.5]])
    tangent(0.0, v, v, index, params, 7.0, 100.0, D, *NO_BLOCKS)
    np.testing.assert_allclose(D, [50 * np.eye(3), 150 * np.eye(3)])
    assert energy(0.0, v, index, params) == 0.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ViscousDamping(-0.1), r"`rate` must be non-negative and finite \[1/s\], but effect ViscousDamping has rate=-0.1"),
        (lambda: ViscousDamping(math.inf), "but effect ViscousDamping has rate=inf"),
    ],
)
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()
