"""Predicted limits against amplification matrices of whole chains, closed forms, and short nonlinear runs."""

import itertools
import subprocess
import sys
from dataclasses import dataclass

import numpy as np
import pytest
import scipy.integrate
from hypothesis import assume, given
from hypothesis import strategies as st
from tried import tried

from anet_lumped.effects import REGISTRY, ViscousDamping
from anet_lumped.motion.stability import (
    damping_limit,
    frequency_limit,
    hanging_stretch_floor,
    predict,
    step_limit,
    stretch_floor,
    top_mode,
    top_modes,
)
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from integrators import schemes

EXPLICIT, IMPLICIT = schemes.names(explicit=True), schemes.names(explicit=False)

# spectral radii come from an eigenvalue solver on up to 60 x 60 nonsymmetric matrices
STABLE = 1.0 + 1e-9
MU, LENGTH = 0.1, 1.0


def cable(segments=20, EA=1e4, zeta=0.0, **kwargs):
    return Cable("a", "b", length=LENGTH, mass_per_length=MU, EA=EA, zeta=zeta, segments=segments, **kwargs)


def chain_matrices(c, ends, rate=0.0):
    """M (diagonal), C and K of the straight chain of cable c between fixed ends or with its end loose."""
    n = c.segments
    B = np.eye(n, n + 1, 1) - np.eye(n, n + 1)
    M = np.full(n + 1, c.mass_per_length * c.L0)
    M[-1] /= 2.0
    B, M = (B[:, 1:-1], M[1:-1]) if ends == "fixed" else (B[:, 1:], M[1:])
    return M, c.dashpot * B.T @ B + rate * np.diag(M), c.stiffness * B.T @ B


def runge_kutta(tableau, Z):
    """R(Z) of a tableau of diffrax: y + b (I - A Z)^-1 Z y, all stages at once."""
    s, one = tableau.num_stages, np.eye(len(Z))
    A = np.zeros((s, s)) if tableau.a_diagonal is None else np.diag(tableau.a_diagonal)
    for i, row in enumerate(tableau.a_lower):
        A[i + 1, : i + 1] = row
    stages = np.linalg.solve(np.eye(s * len(Z)) - np.kron(A, Z), np.tile(one, (s, 1)))
    return one + np.kron(tableau.b_sol, Z) @ stages


def amplification(scheme, h, M, C, K):
    """One step of an explicit scheme, written from its equations, applied to every unit vector of its state."""
    n = len(M)

    def a(q, v):
        return -(K @ q + C @ v) / M[:, None]

    if scheme == "verlet":
        q, v, a0 = np.split(np.eye(3 * n), 3)
        q1 = q + h * v + h**2 / 2 * a0
        a1 = a(q1, v + h * a0)
        return np.vstack([q1, v + h / 2 * (a0 + a1), a1])
    if scheme == "Tsit5":
        tableau = pytest.importorskip("diffrax").Tsit5.tableau
        return runge_kutta(tableau, h * np.block([[np.zeros((n, n)), np.eye(n)], [-K / M[:, None], -C / M[:, None]]]))
    q, v = np.split(np.eye(2 * n), 2)
    if scheme == "symplectic_euler":
        v = v + h * a(q, v)
        return np.vstack([q + h * v, v])
    y = np.eye(2 * n)

    def f(y):
        q, v = np.split(y, 2)
        return np.vstack([v, a(q, v)])

    if scheme == "explicit_euler":
        return y + h * f(y)
    if scheme == "rk4":
        k1 = f(y)
        k2 = f(y + h / 2 * k1)
        k3 = f(y + h / 2 * k2)
        k4 = f(y + h * k3)
        return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    solver = getattr(scipy.integrate, scheme.upper())(  # dop853 is the pair that scipy calls DOP853
        lambda t, x: f(x.reshape(y.shape)).ravel(), 0.0, y.ravel(), h, first_step=h, rtol=1.0, atol=1e30
    )
    solver.step()
    assert solver.t == h  # one step, none rejected
    return solver.y.reshape(y.shape)


def radius(matrix):
    return np.abs(np.linalg.eigvals(matrix)).max()


@pytest.mark.each_once
@pytest.mark.parametrize("ends", ["fixed", "loose"])
@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.6, 1.0, 3.0])
@pytest.mark.parametrize("scheme", EXPLICIT)
def test_limit_is_exact_for_the_whole_chain(scheme, zeta, ends):
    c = cable(segments=12, zeta=zeta)
    mode = top_mode(c, end_mass=np.inf if ends == "fixed" else MU * c.L0 / 2)
    matrices = chain_matrices(c, ends)
    h = step_limit(scheme, mode.omega, mode.zeta)
    if h == 0.0:
        assert scheme == "explicit_euler" and zeta == 0.0
        assert radius(amplification(scheme, 1e-3 / mode.omega, *matrices)) > 1.0
        return
    assert radius(amplification(scheme, 0.999 * h, *matrices)) <= STABLE
    assert radius(amplification(scheme, 1.001 * h, *matrices)) > STABLE


@pytest.mark.parametrize("scheme", EXPLICIT)
def test_limit_with_mass_proportional_damping(scheme):
    c, rate = cable(segments=12, zeta=0.02), 150.0
    mode = top_mode(c)
    h = step_limit(scheme, mode.omega, mode.zeta, rate)
    matrices = chain_matrices(c, "fixed", rate)
    assert radius(amplification(scheme, 0.999 * h, *matrices)) <= STABLE
    assert radius(amplification(scheme, 1.001 * h, *matrices)) > STABLE
    assert h != pytest.approx(step_limit(scheme, mode.omega, mode.zeta), rel=1e-4)


def implicit_amplification(scheme, x, zeta):
    """Amplification matrix of (q, h v) or (q, h v, h^2 a) on one mode at x = h omega."""
    Z, one = np.array([[0.0, 1.0], [-(x**2), -2.0 * zeta * x]]), np.eye(2)
    solve = np.linalg.solve
    if scheme == "backward_euler":
        return solve(one - Z, one)
    if scheme == "midpoint":
        return solve(one - Z / 2, one + Z / 2)
    if scheme == "sdirk2":
        g = 1.0 - np.sqrt(0.5)
        return solve((one - g * Z) @ (one - g * Z), one + (1 - 2 * g) * Z)
    if scheme == "tr_bdf2":
        g = 2.0 - np.sqrt(2.0)
        middle = solve(one - g / 2 * Z, one + g / 2 * Z)
        return solve(one - (1 - g) / (2 - g) * Z, (middle - (1 - g) ** 2 * one) / (g * (2 - g)))
    if scheme == "Radau":
        return solve(one - 3 / 5 * Z + 3 / 20 * Z @ Z - Z @ Z @ Z / 60, one + 2 / 5 * Z + Z @ Z / 20)
    if scheme.startswith("Kvaerno"):
        return runge_kutta(getattr(pytest.importorskip("diffrax"), scheme).tableau, Z)
    if scheme == "edmc":  # rho_inf = 0: numerical damper k/2 s^2/(1 + s^2), s = x/2
        K, D = x**2, 2.0 * zeta * x + x**2 / 2.0 * (x**2 / (4.0 + x**2))
        q = np.array([2.0 + D - K / 2, 2.0]) / (2.0 + D + K / 2)
        return np.vstack([q, 2.0 * (q - [1.0, 0.0]) - [0.0, 1.0]])
    rho = 0.8  # generalised-alpha: rows q, v, and M(a at 1 - alpha_m) + C(v at 1 - alpha_f) + K(q at 1 - alpha_f) = 0
    am, af = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma, beta = 0.5 - am + af, (1 - am + af) ** 2 / 4
    new = np.array([[1, 0, -beta], [0, 1, -gamma], [(1 - af) * x**2, (1 - af) * 2 * zeta * x, 1 - am]])
    old = np.array([[1, 1, 0.5 - beta], [0, 1, 1 - gamma], [-af * x**2, -af * 2 * zeta * x, -am]])
    return solve(new, old)


@pytest.mark.parametrize("scheme", [s for s in IMPLICIT if s not in ("BDF", "LSODA")])
def test_implicit_schemes_have_no_linear_limit(scheme):
    assert step_limit(scheme, 1e6, 0.05) == np.inf and damping_limit(scheme, 1e6, 1.0) == np.inf
    for x in np.geomspace(1e-2, 1e3, 26):
        for zeta in (0.0, 0.05, 1.0, 30.0):
            # a double eigenvalue splits by the root of round-off, which 1e6-sized entries magnify
            assert radius(implicit_amplification(scheme, x, zeta)) <= 1.0 + 1e-7


# closed forms ------------------------------------------------------------------------------------------------------


@tried(40)
@given(k=st.floats(1.0, 1e8), m=st.floats(1e-5, 1.0), share=st.floats(0.01, 0.99))
def test_dashpot_borders_of_the_thesis(k, m, share):
    omega = 2.0 * np.sqrt(k / m)

    def c_max(scheme, dt):
        return damping_limit(scheme, omega, dt) * 2.0 * k / omega

    dt = share * 2.0 / omega
    assert c_max("symplectic_euler", dt) == pytest.approx((m - k * dt**2) / (2.0 * dt), rel=1e-9)
    assert c_max("verlet", dt) == pytest.approx((m - k * dt**2) / (4.0 * dt), rel=1e-9)
    assert c_max("explicit_euler", dt) == pytest.approx(m / (2.0 * dt) + k * dt / 2.0, rel=1e-9)
    # the thesis page gives 0.696 and 2.785, four digits
    assert c_max("rk4", dt) == pytest.approx(0.696 * m / dt + k * dt / 2.785, rel=1e-3)
    c = 1.5 * k * dt  # underdamped here: the lower border k dt < c of explicit Euler
    assume(c < 0.99 * np.sqrt(k * m))
    assert step_limit("explicit_euler", omega, c / np.sqrt(k * m)) == pytest.approx(c / k, rel=1e-9)


@tried(40)
@given(
    scheme=st.sampled_from(sorted(EXPLICIT)),
    omega=st.floats(1e-2, 1e7),
    zeta=st.floats(1e-3, 1e3),
    rate=st.floats(0.0, 10.0),
)
def test_limits_invert_each_other_and_scale(scheme, omega, zeta, rate):
    h = step_limit(scheme, omega, zeta, rate)
    assert 0.0 < h < np.inf
    # only the damping ratio has no unit: time scales out
    assert step_limit(scheme, 10.0 * omega, zeta, 10.0 * rate) == pytest.approx(h / 10.0, rel=1e-9)
    if zeta > 1.0:  # below, a scheme may be stable again at a larger damping
        assert damping_limit(scheme, omega, h, rate) == pytest.approx(zeta, rel=1e-6)
    assert damping_limit(scheme, omega, h, rate) >= zeta * (1.0 - 1e-6)
    if rate / omega < 1e-3 and zeta < 10.0:  # a rate alone can forbid the step, whatever the frequency
        assert frequency_limit(scheme, h, zeta, rate) == pytest.approx(omega, rel=1e-6)


@pytest.mark.parametrize(
    ("scheme", "zeta", "expected"),
    [
        ("symplectic_euler", 0.0, 2.0),
        ("verlet", 0.0, 2.0),
        ("rk4", 0.0, np.sqrt(8.0)),
        ("rk4", 1.0, 2.785293563405282),  # Hairer and Wanner, IV.2
        ("RK45", 1.0, 3.3066),  # both figures of Hairer and Wanner, IV.2 for DOPRI5 have fewer digits
        ("explicit_euler", 0.3, 0.6),
        ("explicit_euler", 1.0, 2.0),
    ],
)
def test_stability_intervals(scheme, zeta, expected):
    assert step_limit(scheme, 1.0, zeta) == pytest.approx(expected, rel=1e-5)


@pytest.mark.each_once
@pytest.mark.parametrize("scheme", ["rk4", "dop853", "RK45", "DOP853", "Tsit5"])
@pytest.mark.parametrize("zeta", [0.0, 0.4, 1.7, *(pytest.param(z, marks=pytest.mark.slow) for z in (1e-3, 0.05, 0.9))])
def test_no_instability_below_the_limit(scheme, zeta):
    """The coarse scan along the ray must not step over a gap."""
    limit = step_limit(scheme, 1.0, zeta)
    one = np.ones(1), np.array([[2.0 * zeta]]), np.ones((1, 1))
    steps = np.linspace(limit / 400.0, limit * (1.0 - 1e-9), 400)
    assert max(radius(amplification(scheme, h, *one)) for h in steps) <= STABLE


def test_explicit_euler_does_nothing_for_swings():
    assert step_limit("explicit_euler", 10.0) == 0.0
    assert step_limit("explicit_euler", 10.0, rate=2.0) == pytest.approx(0.02, rel=1e-12)
    assert frequency_limit("explicit_euler", 0.02, rate=2.0) == pytest.approx(10.0, rel=1e-9)
    assert hanging_stretch_floor("explicit_euler", 0.01, 1.0, 20) == np.inf


def test_no_damping_is_stable_beyond_the_region():
    assert damping_limit("symplectic_euler", 3.0, 1.0) == -np.inf
    assert damping_limit("explicit_euler", 3.0, 1.0) == -np.inf
    assert damping_limit("rk4", 3.0, 1.0) == -np.inf
    # RK4 is taller (2.95) than its real interval is long (2.785): only light damping is stable between
    zeta = damping_limit("rk4", 2.9, 1.0)
    assert step_limit("rk4", 1.0, zeta) == pytest.approx(2.9, rel=1e-9) and zeta < 0.3
    assert step_limit("rk4", 1.0, 1.01 * zeta) < 2.9


def test_borders_are_drawn_over_arrays():
    zeta = np.geomspace(1e-3, 1e2, 7)
    omega = np.geomspace(1e2, 1e5, 5)[:, None]
    for scheme in schemes.names():
        border = step_limit(scheme, omega, zeta)
        assert border.shape == (5, 7)
        assert border[2, 3] == step_limit(scheme, omega[2, 0], zeta[3])
        assert damping_limit(scheme, omega, np.geomspace(1e-6, 1e-3, 7)).shape == (5, 7)
        assert stretch_floor(scheme, np.full(7, 1e-3), omega, 0.01, zeta, 1.0).shape == (5, 7)
        assert isinstance(step_limit(scheme, 1.0, 0.1), float) and isinstance(damping_limit(scheme, 1.0, 0.1), float)


# stretch floor -----------------------------------------------------------------------------------------------------


def test_stretch_floor_of_the_thesis():
    assert hanging_stretch_floor("rk4", 0.01, 1.0, 20) == pytest.approx(0.0981, rel=1e-9)  # 9.8 %
    assert hanging_stretch_floor("symplectic_euler", 0.01, 1.0, 20) == pytest.approx(0.1962, rel=1e-9)
    ratio = hanging_stretch_floor("rk4", 0.01, 1.0, 20) / hanging_stretch_floor("rk4", 0.01, 1.0, 5)
    assert ratio == pytest.approx(16.0, rel=1e-9)  # the price of refining fourfold
    assert hanging_stretch_floor("edmc", 0.01, 1.0, 20) == 0.0


@tried(30)
@given(
    scheme=st.sampled_from(["symplectic_euler", "verlet", "rk4", "RK45", "DOP853"]),
    segments=st.integers(2, 40),
    EA=st.floats(1.0, 1e6),
    tension=st.floats(0.1, 100.0),
    zeta=st.floats(0.0, 2.0),
    dt=st.floats(1e-5, 1e-1),
)
def test_stiffness_at_the_floor_is_just_stable(scheme, segments, EA, tension, zeta, dt):
    mode = top_mode(cable(segments, EA, zeta))
    eps = stretch_floor(scheme, dt, mode.omega, tension / EA, mode.zeta)
    softened = top_mode(cable(segments, tension / eps, zeta))
    assert step_limit(scheme, softened.omega, softened.zeta) == pytest.approx(dt, rel=1e-8)


# modes -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("segments", [1, 2, 3, 20, 500])
def test_top_mode_in_closed_form(segments):
    c = cable(segments, zeta=0.3)
    held, loose = top_mode(c), top_mode(c, end_mass=MU * c.L0 / 2)
    assert held.omega == pytest.approx(c.omega_max * np.sin((segments - 1) * np.pi / (2 * segments)), rel=1e-12)
    assert loose.omega == pytest.approx(c.omega_max * np.sin((2 * segments - 1) * np.pi / (4 * segments)), rel=1e-12)
    assert loose.zeta == pytest.approx(0.3 * loose.omega / c.omega_max, rel=1e-12)


def net(mass=0.036, EA=(1e4,) * 4, segments=(20,) * 4, effects=()):
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    points = [*(Fixed(f"s{i}", at) for i, at in enumerate(corners)), Free("p0", mass=mass), Free("tip", mass=mass / 3)]
    arms = [Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.1, EA=EA[i], zeta=0.05, segments=segments[i]) for i in range(4)]
    tail = Cable("p0", "tip", length=0.5, mass_per_length=0.05, EA=EA[0], segments=segments[0])
    return Scene(points=points, cables=[*arms, tail], effects=effects)


def highest_frequency(scene, rng):
    """Exact top frequency in 3-D, axial and transverse, with segments in random directions and strains up to 50 %."""
    index = {point.name: i for i, point in enumerate(scene.points)}
    mass = [getattr(point, "mass", np.inf) for point in scene.points]
    elements = []
    for c in scene.cables:
        inner = range(len(mass), len(mass) + c.segments - 1)
        mass += [0.0] * len(inner)
        nodes = [index[c.start], *inner, index[c.end]]
        for i, j in itertools.pairwise(nodes):
            n, strain = rng.normal(size=3), rng.uniform(0.0, 0.5)
            P = np.outer(n, n) / (n @ n)
            elements.append((i, j, c.stiffness * (P + strain / (1.0 + strain) * (np.eye(3) - P))))
            mass[i] += c.mass_per_length * c.L0 / 2
            mass[j] += c.mass_per_length * c.L0 / 2
    root = 1.0 / np.sqrt(mass)  # 0 for what is held
    A = np.zeros((len(mass), 3, len(mass), 3))
    for i, j, K in elements:
        for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            A[p, :, q, :] += sign * root[p] * root[q] * K
    return np.sqrt(np.linalg.eigvalsh(A.reshape(3 * len(mass), -1))[-1])


@tried(40)
@given(
    mass=st.floats(0.0, 10.0),
    EA=st.tuples(*[st.floats(1.0, 1e6)] * 4),
    segments=st.tuples(*[st.integers(1, 8)] * 4),
    seed=st.integers(0, 2**31),
)
def test_no_mode_of_a_net_is_faster_than_its_bound(mass, EA, segments, seed):
    scene = net(mass, EA, segments)
    bound = max(mode.omega for mode in top_modes(scene).values())
    assert highest_frequency(scene, np.random.default_rng(seed)) <= bound * (1.0 + 1e-9)


def test_bound_of_the_held_net_is_tight():
    held = Scene(net().points[:5], net().cables[:4])
    N, omega = 20, held.cables[0].omega_max
    # motion of one straight cable with p0 at rest is that of a cable held at both ends, and a mode by symmetry
    exact = omega * np.sin((N - 1) * np.pi / (2 * N))
    assert exact <= max(mode.omega for mode in top_modes(held).values()) < 1.001 * omega


# scenes ------------------------------------------------------------------------------------------------------------


def test_prediction_names_the_limiting_cable():
    prediction = predict(net(EA=(1e4, 1e4, 1e6, 1e4)))
    assert list(prediction.modes) == ["s0-p0", "s1-p0", "s2-p0", "s3-p0", "p0-tip"]
    assert list(prediction.limits) == [*EXPLICIT, *IMPLICIT]
    limit, mode = prediction.limits["symplectic_euler"], prediction.modes["s2-p0"]
    assert limit.cable == "s2-p0"
    assert limit.step == limit.axial == step_limit("symplectic_euler", mode.omega, mode.zeta) < limit.swing
    assert prediction.limits["edmc"].step == np.inf and prediction.limits["edmc"].cable == ""
    floor = prediction.stretch_floor("rk4", 0.01, "s2-p0", 2e-6)
    assert floor == stretch_floor("rk4", 0.01, mode.omega, 2e-6, mode.zeta)


def test_warning_holds_both_numbers():
    prediction = predict(net())
    step = prediction.limits["rk4"].step
    assert prediction.warning("rk4", step) == "" == prediction.warning("edmc", 10.0)
    text = prediction.warning("rk4", 0.01)
    assert "dt=0.01 s" in text and f"{step:.3g} s" in text and prediction.limits["rk4"].cable in text
    assert "stable at no step" in prediction.warning("explicit_euler", 1e-9)


@dataclass(frozen=True)
class Treacle(ViscousDamping):
    """Damping by another name."""


def test_swings_decide_for_explicit_euler(monkeypatch):
    damped = [Cable("s", "tip", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.5, segments=20)]
    points = [Fixed("s", (0, 0, 0)), Free("tip")]
    still = predict(Scene(points, damped)).limits["explicit_euler"]
    assert still.axial > 0.0 and still.swing == still.step == 0.0
    monkeypatch.setitem(REGISTRY.classes, "treacle", Treacle)
    scene = Scene(points, damped, [Treacle(3.0)])
    limit = predict(scene, strain=0.01).limits["explicit_euler"]
    omega = predict(scene).modes["s-tip"].omega
    assert predict(scene).rate == 3.0
    assert limit.swing == limit.step == pytest.approx(3.0 * 1.01 / (0.01 * omega**2), rel=1e-9)


def test_a_scene_without_movable_nodes_has_no_limit():
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable(segments=1)])
    assert predict(scene).limits["rk4"].step == np.inf


@pytest.mark.each_once
@pytest.mark.parametrize("scheme", ["symplectic_euler", "verlet", "rk4"])
@pytest.mark.parametrize("zeta", [0.05, 2.0])
def test_nonlinear_hanging_chain_is_stable_to_within_ten_percent(scheme, zeta):
    """Disturbed by 1e-6 of a segment in 3-D, it stays near at 0.9 of the limit and leaves at 1.1."""
    c = cable(zeta=zeta)
    n, m, k, d = c.segments, np.full(c.segments, MU * c.L0), c.stiffness, c.dashpot
    m[-1] /= 2.0
    tension = 9.81 * np.cumsum(m[::-1])[::-1]
    rest = np.zeros((n, 3))
    rest[:, 2] = -np.cumsum(c.L0 + tension / k)
    kick = 1e-6 * c.L0 * np.random.default_rng(0).normal(size=(n, 3))

    def a(q, v):
        p, w = np.diff(q, axis=0, prepend=0.0), np.diff(v, axis=0, prepend=0.0)
        length = np.sqrt((p * p).sum(1))
        T = k * (length - c.L0) + d * (p * w).sum(1) / length
        f = (T / length)[:, None] * p
        return (np.diff(f, axis=0, append=0.0)) / m[:, None] - [0.0, 0.0, 9.81]

    def displacement(h, steps=600):
        q, v = rest + kick, np.zeros((n, 3))
        a0 = a(q, v)
        for _ in range(steps):
            if scheme == "symplectic_euler":
                v = v + h * a(q, v)
                q = q + h * v
            elif scheme == "verlet":
                q = q + h * v + h**2 / 2 * a0
                a1 = a(q, v + h * a0)
                v, a0 = v + h / 2 * (a0 + a1), a1
            else:
                k1 = a(q, v)
                k2 = a(q + h / 2 * v, v + h / 2 * k1)
                k3 = a(q + h / 2 * v + h**2 / 4 * k1, v + h / 2 * k2)
                k4 = a(q + h * v + h**2 / 2 * k2, v + h * k3)
                q, v = q + h * v + h**2 / 6 * (k1 + k2 + k3), v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            if not np.isfinite(q).all() or np.abs(q - rest).max() > 0.1 * c.L0:
                return np.inf
        return np.abs(q - rest).max()

    mode = top_mode(c, end_mass=MU * c.L0 / 2)
    h = step_limit(scheme, mode.omega, mode.zeta)
    assert displacement(0.9 * h) < 100.0 * np.abs(kick).max()  # swings of the free end add kicks up
    assert displacement(1.1 * h) == np.inf


# edges -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: step_limit("rk5", 1.0), 'must name a scheme, but is "rk5", did you mean "RK45"'),
        (lambda: step_limit("leap", 1.0), "must name a scheme"),
        (lambda: step_limit("rk4", -1.0), "Argument `omega` must not be negative or NaN, but is -1.0"),
        (lambda: damping_limit("rk4", 1.0, np.nan), "Argument `dt` must not be negative or NaN"),
        (lambda: frequency_limit("rk4", 1.0, zeta=-2.0), "Argument `zeta` must not be negative or NaN"),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_prediction_loads_no_compiled_code():
    """The package's own `__init__` is left out, so that this says what stability.py itself imports."""
    code = (
        "import importlib.util as u, sys, types; p = types.ModuleType('anet_lumped'); "
        f"p.__path__ = {[str(path) for path in __import__('anet_lumped').__path__]!r}; sys.modules['anet_lumped'] = p; "
        "import anet_lumped.motion.stability as s; s.damping_limit('DOP853', 1.0, 0.1); assert 'numba' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
