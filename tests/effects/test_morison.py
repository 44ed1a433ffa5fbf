"""Morison's law on a segment and a sphere: closed forms, added mass, and slopes by JAX."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped.effects.laws import drag, morison
from anet_lumped.effects.laws.axial import with_select

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)
jnp = jax.numpy

EPS = np.finfo(float).eps
NORMAL, ALONG, MASS, CAN, CAT = 0.37, 0.021, 2.5, 1.1, 0.3  # [kg/m], [kg/m], [kg], 1, 1
component = st.floats(-20.0, 20.0).map(lambda x: round(x * 2**20) / 2**20)
vector = st.tuples(component, component, component)
# Functions of the law with JAX's `where` in place of `select`; what they call is called by name.
SIZE, TANGENT, DRAG, FORCE = (
    with_select(law, jnp.where) for law in (drag.vector_length, drag.tangent_of, drag.segment_drag, morison.segment_force)
)
TANGENT.__globals__["vector_length"] = DRAG.__globals__["vector_length"] = SIZE
FORCE.__globals__["segment_drag"] = DRAG
L0 = 0.3  # [m]


def traced(here, there, a, of_a, d, side):
    """Force on the end of a segment that is `here`, whose water's acceleration is `a` where that end is at d."""
    t = TANGENT(*(side * (here - there)), L0)[:3]
    return jnp.stack(FORCE((0.0, 0.0, 0.0), tuple(a + of_a @ (here - d)), t, 0.0, 0.0, MASS, CAN, CAT))


TRACED_SLOPES = jax.jit(jax.jacobian(traced, (0, 1)))  # JAX compiles it once, for all examples


def compiled(u, a, t):
    return np.array(morison.segment_force(tuple(map(float, u)), tuple(map(float, a)), t, NORMAL, ALONG, MASS, CAN, CAT))


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0, 150.0])
def test_inclined_to_the_acceleration(angle):
    """M (1 + Can) a sin(phi) across and M (1 + Cat) a cos(phi) along, on top of the drag."""
    phi = math.radians(angle)
    t, across = (math.cos(phi), 0.0, math.sin(phi)), np.array([math.sin(phi), 0.0, -math.cos(phi)])
    f = compiled((0, 0, 0), (3.0, 0.0, 0.0), t)
    assert f @ across == pytest.approx(MASS * (1 + CAN) * 3.0 * math.sin(phi), abs=16 * EPS)
    assert f @ t == pytest.approx(MASS * (1 + CAT) * 3.0 * math.cos(phi), abs=16 * EPS)
    u = (1.0, -2.0, 0.5)
    np.testing.assert_allclose(compiled(u, (3.0, 0.0, 0.0), t) - f, drag.segment_drag(*u, *t, NORMAL, ALONG), rtol=0, atol=64 * EPS)


def test_added_mass():
    """Can M across and Cat M along; a body that moves as the water does feels what the water in its place would."""
    t = (0.6, 0.0, 0.8)
    A = np.zeros((3, 3))
    morison.add_mass(MASS, CAN, CAT, t, A)
    np.testing.assert_allclose(A @ t, MASS * CAT * np.array(t), rtol=0, atol=8 * EPS)
    for across in ((0.0, 1.0, 0.0), (0.8, 0.0, -0.6)):
        np.testing.assert_allclose(A @ across, MASS * CAN * np.array(across), rtol=0, atol=8 * EPS)
    a = np.array([1.0, 2.0, -3.0])
    np.testing.assert_allclose(compiled((0, 0, 0), a, t) - A @ a, MASS * a, rtol=0, atol=64 * EPS)
    f = morison.point_force((0.0, 0.0, 0.0), tuple(a), 3.0, MASS, 0.5)
    np.testing.assert_allclose(f, 1.5 * MASS * a, rtol=4 * EPS)


@tried(50)
@given(a=vector, d=vector.filter(lambda d: np.linalg.norm(d) > 0.1), slopes=st.tuples(vector, vector, vector))
def test_slopes_against_jax(a, d, slopes):
    """Of both ends of a segment in their places, where the water's acceleration changes with the place."""
    of_a = np.array(slopes)
    for side in (-1.0, 1.0):
        here, there = np.array(d), np.zeros(3)
        *t, per_l = drag.tangent_of(*(side * here), L0)
        own, other = np.zeros((3, 3)), np.zeros((3, 3))
        gradient = tuple(of_a.ravel())
        morison.subtract_inertia_slopes(tuple(map(float, a)), gradient, tuple(t), per_l, MASS, CAN, CAT, side, 1.0, own, other)
        expected = TRACED_SLOPES(here, there, np.array(a), of_a, here, side)
        size = MASS * (np.linalg.norm(a) * per_l + np.abs(of_a).max()) + 1.0
        np.testing.assert_allclose(-own, expected[0], rtol=0, atol=64 * EPS * size)
        np.testing.assert_allclose(-other, expected[1], rtol=0, atol=64 * EPS * size)
