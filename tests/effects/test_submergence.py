"""How much is under water: against volumes, quadrature and JAX, and the work of a step."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import quad
from tried import tried

from anet_lumped import Free
from anet_lumped.effects.laws import submergence
from anet_lumped.effects.laws.axial import with_select
from anet_lumped.effects.laws.submergence import (
    immersed,
    sphere_diameter,
    submerged_share,
    submerged_share_between,
    wetted,
    wetted_between,
)

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)
jnp = jax.numpy

EPS = np.finfo(float).eps
# heights in diameters, of multiples of 2^-20 so that no difference is lost in rounding
heights = st.floats(-8.0, 8.0).map(lambda x: round(x * 2**20) / 2**20) | st.floats(-0.6, 0.6)
D = 0.25  # [m]

# Functions of the law with JAX's `where` in place of `select`; `limited` and `submerged_share` are called by name.
CUT, SHARE, IMMERSED = (with_select(getattr(submergence, name), jnp.where) for name in ("limited", "submerged_share", "immersed"))
SHARE.__globals__["limited"] = IMMERSED.__globals__["limited"] = CUT
IMMERSED.__globals__["submerged_share"] = SHARE
# JAX compiles each of these once, for all examples.
SLOPES_OF_A_SHARE = jax.jit(jax.jacobian(lambda z: jnp.stack(SHARE(z, D))))
SLOPES_OF_THE_WEIGHTS = jax.jit(jax.jacobian(lambda z: jnp.stack(IMMERSED(z[0], z[1], D)[:3])))


@pytest.mark.parametrize("depth", [-0.1, 0.0, 0.2, 0.5, 0.9, 1.0, 1.5])
def test_share_of_a_sphere(depth):
    """Archimedes: the cap of height h of a sphere of radius R has the volume pi h^2 (R - h/3)."""
    R, h = 0.5 * D, min(max(depth, 0.0), 1.0) * D
    cap = math.pi * h * h * (R - h / 3.0)
    assert submerged_share(R - depth * D, D)[0] == pytest.approx(cap / (4.0 / 3.0 * math.pi * R**3), abs=4 * EPS)


def test_sphere():
    assert sphere_diameter(Free("p", volume=math.pi / 6.0 * 0.3**3)) == pytest.approx(0.3, rel=4 * EPS)
    assert sphere_diameter(Free("p", CdA=math.pi / 4.0 * 0.3**2)) == pytest.approx(0.3, rel=4 * EPS)


def test_share_is_near_that_of_a_level_cylinder():
    """What the module promises for cables: within 0.04."""
    x = np.linspace(0.0, 1.0, 201)
    angle = 2.0 * np.arccos(1.0 - 2.0 * x)
    off = [submerged_share((0.5 - depth) * D, D)[0] for depth in x] - (angle - np.sin(angle)) / (2.0 * math.pi)
    assert 0.035 < np.abs(off).max() < 0.04


@tried()
@given(z=heights)
def test_slopes_of_a_share(z):
    """H' = h and h' by JAX."""
    assume(abs(abs(z) - 0.5) > 1e-9)  # where JAX takes the slope of a cut to be 0
    h, slope, _ = submerged_share(z * D, D)
    of_h, _, of_H = SLOPES_OF_A_SHARE(z * D)
    assert float(of_H) == pytest.approx(h, abs=8 * EPS)
    assert float(of_h) == pytest.approx(slope, abs=32 * EPS / D)


@tried(200)
@given(z1=heights, z2=heights)
def test_weights_are_integrals(z1, z2):
    z1, z2 = z1 * D, z2 * D
    e, w1, w2, *_ = immersed(z1, z2, D)
    # where the segment enters and leaves the surface's layer the integrand is smooth to second order only
    edges = [(x - z1) / (z2 - z1) for x in (-0.5 * D, 0.5 * D)] if z1 != z2 else []
    breaks = [0.0, *sorted(min(max(s, 0.0), 1.0) for s in edges), 1.0]

    def integral(function):
        return sum(quad(function, a, b, epsabs=1e-14, epsrel=1e-13)[0] for a, b in itertools.pairwise(breaks))

    assert e == pytest.approx(integral(lambda s: submerged_share(z1 + s * (z2 - z1), D)[2]), abs=1e-13)
    assert w1 == pytest.approx(integral(lambda s: (1.0 - s) * submerged_share(z1 + s * (z2 - z1), D)[0]), abs=1e-13)
    assert w2 == pytest.approx(integral(lambda s: s * submerged_share(z1 + s * (z2 - z1), D)[0]), abs=1e-13)
    assert wetted(z1, z2, D) == pytest.approx(immersed(z1, z2, D), abs=4 * EPS * (1.0 + abs(z1) + abs(z2)))
    assert immersed(z2, z1, D)[1:3] == (w2, w1)


@tried(200)
@given(z1=heights, z2=heights)
def test_slopes_of_the_weights(z1, z2):
    """de/dz = w and dw/dz by JAX, which divides by the rise."""
    assume(abs(z1 - z2) > 1e-6 and min(abs(abs(z1) - 0.5), abs(abs(z2) - 0.5)) > 1e-9)
    _, *expected = immersed(z1 * D, z2 * D, D)
    weights, *slopes = np.array(SLOPES_OF_THE_WEIGHTS(np.array([z1, z2]) * D))
    # the edges of the layer cancel in the slopes, but for rounding over the rise
    np.testing.assert_allclose(weights, expected[:2], rtol=0, atol=1e-9)
    np.testing.assert_allclose(slopes, [expected[2:4], expected[3:5]], rtol=0, atol=1e-9 / D)


def test_an_inclined_segment_is_cut_by_the_surface():
    """The share of the whole is that of its length, and its centre the middle of the wet part: the layer is even about it."""
    z1, z2 = -0.9, 2.1
    _, w1, w2, *_ = immersed(z1, z2, 0.01)
    assert w1 + w2 == pytest.approx(0.3, rel=1e-12)
    assert w2 / (w1 + w2) == pytest.approx(0.15, rel=1e-4)  # but for the layer's width, (d/rise)^2 = 1e-5


@tried(300)
@given(a=st.tuples(heights, heights), b=st.tuples(heights, heights), near=st.sampled_from([1.0, 1e-2, 1e-5]))
def test_work_of_a_step(a, b, near):
    """g . (z_b - z_a) = e_b - e_a, however long the step; slopes by differences."""
    a = np.array(a) * D
    b = a + near * (np.array(b) * D - a)
    g1, g2, *slopes = wetted_between(*a, *b, D)
    work = g1 * (b - a)[0] + g2 * (b - a)[1]
    # a step of less than SMALL d has an error of the third order, |z_b - z_a|^3/d^2
    rounding = 8 * EPS * np.abs([*a, *b]).max()
    assert work == pytest.approx(wetted(*b, D)[0] - wetted(*a, D)[0], abs=rounding + (1e-4 * D) ** 3 / D**2)
    size = np.hypot(*(b - a))
    if size > 1e-2 * D and abs(b[0] - b[1]) > 1e-2 * D:
        h = 1e-5 * D
        moved = [np.array(wetted_between(*a, *(b + h * np.array(e)), D)[:2]) for e in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        found = [(moved[0] - moved[1]) / (2 * h), (moved[2] - moved[3]) / (2 * h)]
        # the third derivative is piecewise constant and at most some 100/d^3; h/size of it is rounding
        np.testing.assert_allclose(np.transpose(found).ravel(), slopes, rtol=0, atol=1e-6 / D + 100 * EPS / (h * size) * D)


@tried(300)
@given(a=heights, b=heights, near=st.sampled_from([1.0, 1e-2, 1e-5]))
def test_work_of_a_step_of_a_sphere(a, b, near):
    a, b = a * D, (a + near * (b - a)) * D
    g, slope = submerged_share_between(a, b, D)
    assert g * (b - a) == pytest.approx(
        submerged_share(b, D)[2] - submerged_share(a, D)[2], abs=8 * EPS * max(abs(a), abs(b)) + (1e-4 * D) ** 3 / D**2
    )
    if abs(b - a) > 1e-2 * D:
        h = 1e-5 * D
        assert (submerged_share_between(a, b + h, D)[0] - submerged_share_between(a, b - h, D)[0]) / (2 * h) == pytest.approx(
            slope, abs=1e-6 / D
        )
