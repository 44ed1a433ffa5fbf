"""The laws of one element: against slow twins, against JAX and its derivatives, and what they promise."""

import math
from fractions import Fraction
from types import SimpleNamespace

import naive
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from systems import mesh, nets, scatter

import anet_lumped.effects
from anet_lumped import Cable, Fixed, Free, Scene
from anet_lumped.effects import REGISTRY, Gravity, ViscousDamping
from anet_lumped.effects.laws import axial
from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.results.run import segment_tensions

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)

NO_BLOCKS = (np.zeros((0, 2, 3, 3)), np.zeros((0, 2, 3, 3)))  # near and far, of a net in which no effect joins nodes
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
    return axial.one_spring(cable.stiffness, two_way_spring), cable.dashpot, two_way_damper


@pytest.mark.parametrize("compression", COMPRESSION)
@settings(deadline=None)
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
@settings(deadline=None)
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


@pytest.mark.parametrize("compression", COMPRESSION)
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

    @settings(deadline=None, max_examples=50)
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
@settings(deadline=None, max_examples=300)
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
@settings(deadline=None)
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


@pytest.mark.parametrize("compression", COMPRESSION)
def test_forces_energies_and_tensions_of_nets(compression):
    """The kernels of a net against its slow twin, and internal forces that sum to zero with no net torque."""
    effects = [Gravity(3.0, (1, -2, 2)), ViscousDamping(0.7)]
    for name, scene in {**nets(compression=compression, effects=effects), "mesh": mesh(3, 4, 3)}.items():
        model, rng = build(scene), np.random.default_rng(len(name))
        compiled, net = system(model), fresh_net(model)
        np.testing.assert_allclose(model.mass, naive.masses(model), rtol=1e-15)
        q, v = scatter(model, rng), rng.normal(size=(model.n, 3))
        f, power, energy = np.full((model.n, 3), np.nan), np.full(3, np.nan), np.zeros(3)
        compiled.force(0.0, q, v, net.address, f, power)
        compiled.energy(0.0, q, v, net.address, energy)
        expected, by_dampers, by_effects, put_in = naive.force(model, q, v)
        prescribed_moves = model.n_driven < model.n
        # sums of a few dozen rounded forces of up to 1e4 N
        np.testing.assert_allclose(f, expected, atol=1e-10, err_msg=name)
        assert power[:2] == pytest.approx([by_dampers, by_effects], rel=1e-12)
        assert power[2] == (pytest.approx(put_in, rel=1e-12) if prescribed_moves else 0.0)
        np.testing.assert_allclose(energy[:3], naive.energies(model, q, v), rtol=1e-12)
        inner = f - naive.external(model, q, v)
        np.testing.assert_allclose(inner.sum(axis=0), 0.0, atol=1e-10)
        np.testing.assert_allclose(np.cross(q, inner).sum(axis=0), 0.0, atol=1e-10)
        T, at = segment_tensions(model, q, v), iter(naive.tensions(model, q, v))
        for cable in scene.cables:
            expected = [next(at) for _ in range(cable.segments)]
            np.testing.assert_allclose(T[model.segments(cable.name)], expected, rtol=1e-10, atol=1e-10)


def test_force_is_the_slope_of_the_energy():
    """-dE/dq of a net without dampers, by central differences."""
    for compression in COMPRESSION:
        model = build(nets(compression=compression, zeta=0.0)["wheel"])
        compiled, net, rng = system(model), fresh_net(model), np.random.default_rng(3)
        q, v = scatter(model, rng), np.zeros((model.n, 3))
        f, power, d = np.zeros((model.n, 3)), np.zeros(3), rng.normal(size=(model.n, 3))

        def energy(x):
            out = np.zeros(3)
            compiled.energy(0.0, q + x * d, v, net.address, out)  # noqa: B023
            return out[1] + out[2]

        compiled.force(0.0, q, v, net.address, f, power)
        h = 1e-5  # m; energies of 1e3 J leave 1e-13/h = 1e-8, a cubic remainder of k h^2 = 1e-6 of the slope
        assert -(energy(h) - energy(-h)) / (2 * h) == pytest.approx(np.sum(f * d), rel=1e-5)


def test_an_effect_not_asked_for_has_no_entry():
    scene = nets()["junction"]
    for effects, n in (((), 0), ((Gravity(),), 1), ((ViscousDamping(1.0), Gravity()), 2)):
        table = build(Scene(scene.points, scene.cables, effects)).effects
        assert table.address.shape == (n, 5) and len(table.index_at) == len(table.params_at) == n + 1


def test_effects_are_found_by_name_and_not_imported_before():
    assert {REGISTRY["gravity"], REGISTRY["viscous_damping"]} == {Gravity, ViscousDamping} <= set(REGISTRY.values())
    assert REGISTRY.name_of(Gravity()) == "gravity" and REGISTRY.name_of(object()) is None
    known = [REGISTRY.classes[name] for name in REGISTRY.library]
    assert {kind if isinstance(kind, str) else kind.__name__ for kind in known} < set(anet_lumped.effects.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'Gravitas'"):
        anet_lumped.effects.Gravitas  # noqa: B018


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
        (lambda: Gravity(-1.0), r"`g` must be non-negative and finite \[m/s2\], but effect Gravity has g=-1.0"),
        (lambda: Gravity(math.nan), "but effect Gravity has g=nan"),
        (lambda: Gravity(math.inf), "but effect Gravity has g=inf"),
        (lambda: Gravity("9.81"), r"`g` must be non-negative and finite \[m/s2\], but effect Gravity has g='9.81'"),
        (lambda: Gravity(9.81, (0, 0, 0)), r"`direction` must not be zero, but effect Gravity has direction=\(0.0, 0.0, 0.0\)"),
        (lambda: Gravity(9.81, (0, 1)), r"`direction` must be three finite numbers \(x, y, z\), but effect Gravity has"),
        (lambda: Gravity(9.81, (0, math.nan, 1)), "`direction` must be three finite numbers"),
        (lambda: ViscousDamping(-0.1), r"`rate` must be non-negative and finite \[1/s\], but effect ViscousDamping has rate=-0.1"),
        (lambda: ViscousDamping(math.inf), "but effect ViscousDamping has rate=inf"),
        (lambda: Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable_of("none")], [Gravity(), Gravity()]), "given twice"),
    ],
)
def test_messages(make, message):
    with pytest.raises(ValueError, match=message):
        make()
