"""The sparse Jacobian: Taylor remainders, a slow twin in JAX, its pattern; the axial law's slopes against JAX."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from slow import slow

from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.effects.laws.axial import SWITCHES, spring_without_curve, tension_parts, tension_slopes, with_select
from anet_lumped.mechanics import force, prescribe
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.jacobian import sparse_jacobian
from anet_lumped.model.build import build
from anet_lumped.motion.simulate import straight
from anet_lumped.prescribed.paths import harmonic
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, Scene

jax.config.update("jax_enable_x64", True)

LAWS = ("none", "damped", "linear")
RATE = 0.3  # [1/s] of the viscous damping


def scene(compression, length):
    """Two junctions joined by a cable and by two single segments; fixed and driven supports; a loose end.

    Every cable is ``length`` times as long as the straight way between its points.
    """
    at = {"a": (-1, 0, 0.2), "b": (1, 0.1, 0), "p": (-0.4, 0.1, -0.3), "r": (0.4, -0.1, -0.3), "end": (0.5, 0.4, -0.8)}
    points = [
        Fixed("a", at["a"]),
        Driven("b", harmonic(at["b"], (0.02, 0.0, 0.05), 2.0, phase=0.4)),
        Free("p", mass=0.2, at=at["p"]),
        Free("r", at=at["r"]),
        Free("end", at=at["end"]),
    ]
    joined = [("a", "p", 3), ("p", "r", 4), ("p", "r", 1), ("r", "p", 1), ("r", "b", 3), ("end", "r", 2), ("a", "b", 5)]
    cables = [
        Cable(
            start, end, length=length * float(np.linalg.norm(np.subtract(at[start], at[end]))), EA=200.0 + 40.0 * i,
            mass_per_length=0.1 + 0.02 * i, segments=n, zeta=0.1 * i, compression=compression, name=f"cable {i}",
        )
        for i, (start, end, n) in enumerate(joined)
    ]  # fmt: skip
    return Scene(points, cables, [Gravity(9.81), ViscousDamping(RATE)])


def state(model, net, seed, scatter):
    """Places around the straight shape and velocities at t = 0.3 s."""
    rng = np.random.default_rng(seed)
    q = straight(model) + scatter * rng.standard_normal((model.n, 3))
    v = 0.3 * rng.standard_normal((model.n, 3))
    q[model.n_free :], v[model.n_free :] = straight(model)[model.n_free :], 0.0
    prescribe.prescribe(0.3, net.address, q, v)
    return q, v


def pieces(model, q, v):
    """Stretch of every segment, and the tension that its law would have without its cuts where the spring acts."""
    a, b = model.ends.T
    L0, k, c = model.axial[model.cable_of, :3].T
    d, u = q[b] - q[a], v[b] - v[a]
    l = np.linalg.norm(d, axis=1)
    return l - L0, k * (l - L0) + c * np.sum(d * u, axis=1) / l


def rates(model, net, q, v):
    """dy/dt of y = (q, v) of the moving nodes."""
    f, power, n = np.empty_like(q), np.empty(2), model.n_free
    force.force(0.3, q, v, net.address, f, power)
    return np.concatenate([v[:n].ravel(), (f[:n] / model.mass[:n, None]).ravel()])


# Rest lengths relative to the straight shape, and how far nodes are off it: all taut, all slack, some of each.
STATES = {"taut": (0.8, 0.01), "slack": (1.3, 0.01), "mixed": (1.0, 0.06)}


@pytest.mark.each_once
@pytest.mark.parametrize("name", STATES)
@pytest.mark.parametrize("compression", LAWS)
def test_taylor_remainder_is_of_second_order(compression, name):
    length, scatter = STATES[name]
    model = build(scene(compression, length))
    net, n = fresh_net(model), model.n_free
    q, v = state(model, net, 3, scatter)
    stretch, T = pieces(model, q, v)
    assert {"taut": (stretch > 0).all(), "slack": (stretch < 0).all(), "mixed": 4 < (stretch > 0).sum() < 14}[name]
    J, f = sparse_jacobian(model, net)(0.3, q, v), rates(model, net, q, v)
    w = np.random.default_rng(4).standard_normal((2, n, 3))
    remainders = []
    # above round-off (1e-16 k/m = 1e-10 m/s2 against 1e-6) and below the distance to the nearest kink of a law
    sizes = 10.0 ** -np.linspace(4.0, 6.0, 5)
    for size in sizes:
        q_, v_ = q.copy(), v.copy()
        q_[:n] += size * w[0]
        v_[:n] += size * w[1]
        stretch_, T_ = pieces(model, q_, v_)
        assert (np.sign(stretch_) == np.sign(stretch)).all()
        assert (np.sign(T_[stretch > 0]) == np.sign(T[stretch > 0])).all()
        remainders.append(np.linalg.norm(rates(model, net, q_, v_) - f - size * (J @ w.ravel())))
    if name == "slack" and compression == "none":
        # nothing but gravity and the linear drag acts: no remainder but round-off of sums of about 10 m/s2
        assert max(remainders) < 1e-12
    else:
        slope = np.polyfit(np.log(sizes), np.log(remainders), 1)[0]
        assert slope == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("compression", ["damped", *slow(*(law for law in LAWS if law != "damped"))])
def test_equals_jax_on_a_net_written_from_the_equation(compression):
    model = build(scene(compression, 1.0))
    net, n = fresh_net(model), model.n_free
    q, v = state(model, net, 3, 0.06)
    a, b = model.ends.T
    L0, k, c, two_spring, two_damper, *_ = model.axial[model.cable_of].T
    law = with_select(tension_parts, jnp.where)
    m = model.mass[:n, None]

    def twin(y):
        x, u = (jnp.asarray(fixed).at[:n].set(part.reshape(n, 3)) for fixed, part in ((q, y[: 3 * n]), (v, y[3 * n :])))
        d = x[b] - x[a]
        l = jnp.linalg.norm(d, axis=1)
        T, _ = law(l - L0, jnp.sum(d * (u[b] - u[a]), axis=1) / l, spring_without_curve(k, two_spring), c, two_damper)
        pull = (T / l)[:, None] * d
        f = jnp.zeros_like(x).at[a].add(pull).at[b].add(-pull)[:n]
        return jnp.concatenate([u[:n].ravel(), (f / m + jnp.array([0.0, 0.0, -9.81]) - RATE * u[:n]).ravel()])

    y = np.concatenate([q[:n].ravel(), v[:n].ravel()])
    # entries go up to k/m = 1e5 1/s2; both are sums of a few products
    traced, slope = jax.jit(lambda y: (twin(y), jax.jacfwd(twin)(y)))(y)
    np.testing.assert_allclose(rates(model, net, q, v), traced, rtol=0, atol=1e-10)
    J = sparse_jacobian(model, net)(0.3, q, v)
    np.testing.assert_allclose(J.toarray(), slope, rtol=0, atol=1e-9)


def test_pattern_is_fixed_and_no_larger_than_the_net():
    model = build(scene("none", 1.0))
    jacobian = sparse_jacobian(model, fresh_net(model))
    q, v = state(model, fresh_net(model), 3, 0.06)
    one, other = jacobian(0.3, q, v), jacobian(0.3, 0.5 * q, v)
    assert (one.indices == other.indices).all() and (one.indptr == other.indptr).all()
    assert one.has_canonical_format
    assert (one.data != other.data).any(), "values of an earlier call must not change with a later one"
    # a block of its own for every moving node, two for every pair of moving nodes with a segment between them
    n = model.n_free
    pairs = {tuple(sorted(pair)) for pair in model.ends.tolist() if max(pair) < n}
    assert len(pairs) < sum(max(pair) < n for pair in model.ends.tolist()), "one pair is joined twice in this scene"
    assert one.nnz == 2 * 9 * (n + 2 * len(pairs)) + 3 * n


@pytest.mark.parametrize("compression", LAWS)
def test_slopes_of_the_axial_law_are_those_of_jax(compression):
    law = with_select(tension_parts, jnp.where)
    two_spring, two_damper = SWITCHES[compression]
    made = spring_without_curve(2e3, two_spring), 3.0, two_damper

    def of(i):
        return jax.jit(jax.vmap(jax.grad(lambda s, r: law(s, r, *made)[0], i)))

    stretch, rate = (x.ravel() for x in np.meshgrid(np.linspace(-0.1, 0.1, 8), np.linspace(-80.0, 80.0, 8)))
    pairs = zip(stretch, rate, strict=True)
    T, of_stretch, of_rate = np.transpose([tension_slopes(s, r, *made) for s, r in pairs])
    assert {"none": 0 < (T == 0).sum() < 64, "damped": (T < 0).any(), "linear": (T < 0).any()}[compression]
    # the same few products; the largest is 440 N
    np.testing.assert_allclose(T, law(stretch, rate, *made)[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(of_stretch, of(0)(stretch, rate), rtol=0, atol=1e-12)
    np.testing.assert_allclose(of_rate, of(1)(stretch, rate), rtol=0, atol=1e-12)
