"""The law of drag on a segment and on a point: closed forms, derivatives by JAX and by Taylor remainders, what it promises."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import Cable, Free
from anet_lumped.effects.laws import drag
from anet_lumped.effects.laws.axial import with_select

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)
jnp = jax.numpy

EPS = np.finfo(float).eps
NORMAL, ALONG = 0.37, 0.021  # [kg/m]
component = st.floats(-50.0, 50.0).map(lambda x: round(x * 2**20) / 2**20)
vector = st.tuples(component, component, component)
# Functions of the law with JAX's `where` in place of `select`; `vector_length` and `tangent_of` are called by name.
SIZE = with_select(drag.vector_length, jnp.where)
TANGENT = with_select(drag.tangent_of, jnp.where)
TANGENT.__globals__["vector_length"] = SIZE
SEGMENT = with_select(drag.segment_drag, jnp.where)
SEGMENT.__globals__["vector_length"] = SIZE
POINT = with_select(drag.point_drag, jnp.where)
POINT.__globals__["vector_length"] = SIZE


def traced(u, d, L0=0.1):
    """Force of half a segment (3,), by JAX."""
    tx, ty, tz, _ = TANGENT(*d, L0)
    return jnp.stack(SEGMENT(*u, tx, ty, tz, NORMAL, ALONG))


# JAX compiles each of these once, for all examples.
TRACED, OF_U, OF_D = jax.jit(traced), jax.jit(jax.jacobian(traced)), jax.jit(jax.jacobian(traced, 1))
POINT_OF_U = jax.jit(jax.jacobian(lambda u: jnp.stack(POINT(*u, NORMAL))))


def compiled(u, d, L0=0.1):
    tx, ty, tz, _ = drag.tangent_of(*d, L0)
    return np.array(drag.segment_drag(*u, tx, ty, tz, NORMAL, ALONG))


def slopes(u, d, L0=0.1):
    """df/du and df/dd (3, 3), by hand: what a node at a segment's end subtracts for c_v = -1 and for c_q = 1."""
    *t, per_l = drag.tangent_of(*d, L0)
    still, of_u, of_d, unused = (0.0,) * 9, np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    numbers = (tuple(map(float, u)), still, tuple(t), per_l, NORMAL, ALONG, 1.0)
    drag.subtract_segment_slopes(*numbers, 0.0, 1.0, of_u, unused)
    drag.subtract_segment_slopes(*numbers, 1.0, 0.0, of_d, unused)
    np.testing.assert_array_equal(unused, -of_d)  # the force depends on the difference of the two places
    return of_u, -of_d


def test_coefficients():
    """Half of rho/2 d Cdn L0 and of rho/2 pi d Cdt L0 on each node."""
    cable = Cable("a", "b", length=3.0, mass_per_length=1.0, EA=1.0, segments=6, diameter=0.02, Cdn=1.2, Cdt=0.03)
    normal, along = drag.segment_coefficients(1000.0, cable)
    assert normal == pytest.approx(0.5 * 1000 * 0.02 * 1.2 * 0.5 / 2, rel=4 * EPS)
    assert along == pytest.approx(0.5 * 1000 * math.pi * 0.02 * 0.03 * 0.5 / 2, rel=4 * EPS)
    assert drag.point_coefficient(1.2, Free("p", CdA=0.5)) == pytest.approx(0.3, rel=4 * EPS)


@pytest.mark.parametrize(("angle", "speed"), [(0.0, 3.0), (30.0, 2.0), (90.0, 5.0), (150.0, 2.0), (180.0, 1.0)])
def test_inclined(angle, speed):
    """At an angle phi to the flow: normal U^2 sin^2(phi) across, along U^2 cos(phi)|cos(phi)| along, in the flow's plane."""
    phi = math.radians(angle)
    d = 0.1 * np.array([math.cos(phi), 0.0, math.sin(phi)])
    f = compiled((speed, 0.0, 0.0), d)
    t, across = d / 0.1, np.array([math.sin(phi), 0.0, -math.cos(phi)])
    assert f @ across == pytest.approx(NORMAL * speed**2 * math.sin(phi) ** 2, abs=8 * EPS * speed**2)
    assert f @ t == pytest.approx(ALONG * speed**2 * math.cos(phi) * abs(math.cos(phi)), abs=8 * EPS * speed**2)
    assert f[1] == 0.0


@tried()
@given(u=vector, v=vector, d=vector)
def test_at_rest_the_fluid_only_takes_energy(u, v, d):
    """f.v = -(normal |v_n|^3 + along |v_t|^3); turning the segment end for end changes nothing, turning the flow its sign."""
    f = compiled(np.negative(v), d)
    t = np.array(drag.tangent_of(*d, 0.1)[:3])
    s = np.dot(v, t)
    across = np.linalg.norm(v - s * t)
    size = np.linalg.norm(v) ** 3
    assert -np.dot(f, v) == pytest.approx(NORMAL * across**3 + ALONG * abs(s) ** 3, abs=32 * EPS * size)
    np.testing.assert_array_equal(compiled(np.negative(v), np.negative(d)), f)
    np.testing.assert_array_equal(compiled(v, d), -f)
    point = np.array(drag.point_drag(*np.negative(v), NORMAL))
    assert -np.dot(point, v) == pytest.approx(NORMAL * size, abs=16 * EPS * size)


@tried(50)
@given(u=vector, d=vector)
def test_slopes_against_jax(u, d):
    """The same lines traced by JAX give the force and, differentiated, the slopes written by hand."""
    u, d = np.array(u), np.array(d)
    l = np.linalg.norm(d)
    speed = np.linalg.norm(u)
    np.testing.assert_allclose(TRACED(u, d), compiled(u, d), rtol=0, atol=32 * EPS * speed**2)
    of_u, of_d = slopes(u, d)
    np.testing.assert_allclose(OF_U(u, d), of_u, rtol=0, atol=64 * EPS * speed)
    if l >= drag.SHORTEST * 0.1:
        np.testing.assert_allclose(OF_D(u, d), of_d, rtol=0, atol=64 * EPS * speed**2 / l)
    point = np.zeros((3, 3))
    drag.subtract_point_slopes(tuple(u.tolist()), (0.0,) * 9, NORMAL, 0.0, 1.0, point)
    np.testing.assert_allclose(POINT_OF_U(u), point, rtol=0, atol=16 * EPS * speed)


def test_smooth_at_rest():
    """Force and slopes vanish with the velocity and are finite, for flow along the segment and for no length too."""
    for u in ((0.0, 0.0, 0.0), (0.0, 0.0, 2.0), (0.0, 0.0, 1e-160)):
        for d in ((0.0, 0.0, 0.1), (0.0, 0.0, 0.0)):
            of_u, of_d = slopes(u, d)
            assert np.isfinite(of_u).all() and np.isfinite(of_d).all()
            assert np.isfinite(OF_U(np.array(u), np.array(d))).all()
    assert np.abs(slopes((0.0, 0.0, 0.0), (0.0, 0.0, 0.1))).max() == 0.0


def test_taylor():
    """Remainders of second order in a step of velocity and of direction."""
    rng = np.random.default_rng(1)
    for _ in range(5):
        u, d, du, dd = rng.normal(size=(4, 3))
        of_u, of_d = slopes(u, d)
        steps = 2.0 ** -np.arange(6, 14)
        left = [np.linalg.norm(compiled(u + h * du, d + h * dd) - compiled(u, d) - h * (of_u @ du + of_d @ dd)) for h in steps]
        assert np.polyfit(np.log(steps), np.log(left), 1)[0] == pytest.approx(2.0, abs=0.1)
