"""Pendulums of links, each with its own solution: simple ones of any amplitude, spherical, double, and turning chains."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.special import ellipj, ellipk

from anet_lumped import Cable, Fixed, Free, Scene, State, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model.build import build

G, L = 9.81, 0.8
RTOL = 1e-12  # of the motions below
# Order 8 at a tolerance of 1e-12 a step leaves some 1e-12 m a step, which phase errors add up over a few hundred steps.
CLOSE = 2e-9


def rod(at, mass=1.3, compression="linear", **kwargs):
    """A ball on one link of L, hung from the origin."""
    cable = Cable("o", "m", length=L, mass_per_length=0.2, EA=math.inf, segments=1, compression=compression, **kwargs)
    return Scene([Fixed("o", (0, 0, 0)), Free("m", mass=mass, at=at)], [cable], [Gravity(G)])


def thrown(scene, at, v):
    """A state with free points at places ``at`` and with velocities ``v``, both dicts by name."""
    model = build(scene)
    q, u = np.zeros((2, model.n, 3))
    for point in scene.points:
        q[model.node(point.name)] = at.get(point.name, (0, 0, 0))
        u[model.node(point.name)] = v.get(point.name, (0, 0, 0))
    return State(model, 0.0, q, u, np.zeros(model.n_segments))


def swing(t, amplitude):
    """Angle and its rate of a pendulum that begins at rest at its amplitude: sin(x/2) = k cd(omega t | k^2)."""
    k, omega = math.sin(amplitude / 2), math.sqrt(G / L)
    sn, cn, _, _ = ellipj(omega * t + ellipk(k * k), k * k)
    return 2.0 * np.arcsin(k * sn), 2.0 * omega * k * cn


@pytest.mark.each_once
@pytest.mark.parametrize("amplitude", [0.1, 1.5, 3.0, math.pi - 1e-3])
@pytest.mark.parametrize("method", ["links", "links5"])
def test_simple_pendulum(amplitude, method):
    """Two swings, almost upside down in the end; its link pushes there: T = m (L x'^2 + g cos x), with half of the link's mass."""
    start = (L * math.sin(amplitude), 0.0, -L * math.cos(amplitude))
    period = 4.0 * ellipk(math.sin(amplitude / 2) ** 2) * math.sqrt(L / G)
    options = dict(rtol=RTOL) if method == "links" else dict(dt=period / 20_000)
    run = simulate(rod(start), 2.0 * period, method=method, start="straight", save_every=period / 20, **options)
    x, rate = swing(run.t, amplitude)
    assert run.ok and run.method == method
    # where it stays upside down an error grows by exp(omega t) for as long: 1/1e-3 in each half of a swing
    grown = CLOSE * (1e3 if amplitude > 3.1 else 1.0)
    np.testing.assert_allclose(run.position("m"), np.stack([L * np.sin(x), 0.0 * x, -L * np.cos(x)], axis=1), atol=grown)
    np.testing.assert_allclose(run.tension("o-m")[:, 0], (1.3 + 0.08) * (L * rate**2 + G * np.cos(x)), atol=1e2 * grown)
    assert (run.tension("o-m").min() < 0.0) == (amplitude > math.pi / 2)


def test_over_the_top():
    """A pendulum that turns over and over: x/2 = am(v t/(2 L) | k^2) with k = 2 sqrt(g L)/v < 1, from the bottom."""
    v = 2.6 * math.sqrt(G * L)  # at 2 sqrt(g L) it comes to rest on top; its rope is taut there beyond sqrt(5 g L)
    scene = rod((0.0, 0.0, -L), compression="none")
    begin = thrown(scene, {"m": (0, 0, -L)}, {"m": (v, 0, 0)})
    run = simulate(scene, 3.0, method="links", rtol=RTOL, start=begin, save_every=0.1)
    sn, cn, _, phase = ellipj(v * run.t / (2 * L), 4 * G * L / v**2)
    x = 2.0 * phase
    np.testing.assert_allclose(run.position("m"), np.stack([L * np.sin(x), 0 * x, -L * np.cos(x)], axis=1), atol=CLOSE)
    assert run.events == () and run.tension("o-m").min() > 0.0 and x[-1] > 4 * math.pi and np.ptp(sn**2 + cn**2) < 1e-12


def test_spherical_pendulum():
    """Height and azimuth by quadrature over one nod: u = cos(polar angle) turns between two roots of a cubic.

    With e the energy and l the angular momentum by the mass L^2: u'^2 = 2 (e - g/L u)(1 - u^2) - l^2, azimuth' = l/(1 - u^2).
    """
    polar, speed = 2.0, 2.5
    at, v = (L * math.sin(polar), 0.0, L * math.cos(polar)), (0.0, speed, 0.0)
    e, l = 0.5 * (speed / L) ** 2 + G / L * math.cos(polar), speed / L * math.sin(polar)
    roots = np.sort(np.roots([2 * G / L, -2 * e, -2 * G / L, 2 * e - l * l]).real)
    low, high = roots[0], roots[1]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)

    def over_a_nod(weight):  # u = middle + half sin s takes the roots out: f = (u - low)(high - u) 2 g/L (third - u)
        return 2.0 * quad(
            lambda s: weight(middle + half * math.sin(s)) / math.sqrt(2 * G / L * (roots[2] - middle - half * math.sin(s))),
            -math.pi / 2, math.pi / 2, epsabs=1e-13, epsrel=1e-13,
        )[0]  # fmt: skip

    period, turn = over_a_nod(lambda u: 1.0), over_a_nod(lambda u: l / (1 - u * u))
    scene = rod(at)
    run = simulate(scene, 3 * period, method="links", rtol=RTOL, start=thrown(scene, {"m": at}, {"m": v}), save_every=period)
    r = run.position("m")
    np.testing.assert_allclose(r[:, 2], at[2], atol=CLOSE)  # it begins at a root, u' = 0
    azimuth, across = turn * np.arange(4), at[0]
    np.testing.assert_allclose(r[:, :2], across * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1), atol=CLOSE)
    spin = np.cross(r, run.velocity("m"))[:, 2]
    np.testing.assert_allclose(spin, spin[0], rtol=1e-10)


def lagrangian_chain(t, y, lengths, masses):
    """Plane chain of rods with masses at their ends, in the angles x from below: sum_j M_ij L_i L_j (x_j'' cos - ...) = weights."""
    n = len(lengths)
    x, u = y[:n], y[n:]
    carried = np.array([masses[i:].sum() for i in range(n)])
    M, right = np.zeros((n, n)), np.zeros(n)
    for i in range(n):
        right[i] = -carried[i] * G * lengths[i] * np.sin(x[i])
        for j in range(n):
            m = carried[max(i, j)] * lengths[i] * lengths[j]
            M[i, j] = m * np.cos(x[i] - x[j])
            right[i] -= m * np.sin(x[i] - x[j]) * u[j] ** 2
    return np.concatenate([u, np.linalg.solve(M, right)])


def double(angles, masses=(1.0, 0.6), lengths=(1.0, 0.7)):
    """Two links with balls at their ends; the threads weigh next to nothing, and what they do is added in `lagrangian_chain`."""
    at, places = np.zeros(3), {}
    for name, x, length in zip("mn", angles, lengths, strict=True):
        at = at + length * np.array([math.sin(x), 0.0, -math.cos(x)])
        places[name] = tuple(at)
    made = dict(mass_per_length=0.1, EA=math.inf, segments=1, compression="linear")
    points = [Fixed("o", (0, 0, 0)), *(Free(name, mass, at=places[name]) for name, mass in zip("mn", masses, strict=True))]
    cables = [Cable("o", "m", length=lengths[0], **made), Cable("m", "n", length=lengths[1], **made)]
    half = [0.05 * (lengths[0] + lengths[1]), 0.05 * lengths[1]]
    return Scene(points, cables, [Gravity(G)]), np.array(masses) + half, np.array(lengths)


@pytest.mark.parametrize("angles, t_end, growth", [((0.7, -0.4), 4.0, 1e1), ((2.8, 3.1), 2.5, 1e3)])
def test_double_pendulum(angles, t_end, growth):
    """Against the equations in angles by scipy; the second one goes over its top, where errors grow a thousandfold."""
    scene, masses, lengths = double(angles)
    run = simulate(scene, t_end, method="links", rtol=RTOL, start="straight", save_every=t_end / 10)
    begin = np.concatenate([angles, [0.0, 0.0]])
    known = solve_ivp(
        lagrangian_chain, (0, t_end), begin, method="DOP853", t_eval=run.t, rtol=1e-13, atol=1e-13, args=(lengths, masses)
    )
    x, y = known.y[:2]
    m = np.stack([lengths[0] * np.sin(x), 0 * x, -lengths[0] * np.cos(x)], axis=1)
    n = m + np.stack([lengths[1] * np.sin(y), 0 * y, -lengths[1] * np.cos(y)], axis=1)
    np.testing.assert_allclose(run.position("m"), m, atol=growth * CLOSE)
    np.testing.assert_allclose(run.position("n"), n, atol=growth * CLOSE)
    if growth > 1e2:
        assert np.abs(known.y[1]).max() > math.pi  # over the top indeed


@pytest.mark.parametrize("segments", [3, 8])
def test_chain_in_angles(segments):
    """A chain of equal links, held level and let go, to 0.6 s; T pulls and pushes."""
    cable = Cable("o", "e", length=1.0, mass_per_length=0.5, EA=math.inf, segments=segments, compression="linear")
    scene = Scene([Fixed("o", (0, 0, 0)), Free("e", at=(1, 0, 0))], [cable], [Gravity(G)])
    run = simulate(scene, 0.6, method="links", rtol=RTOL, start="straight", save_every=0.06)
    masses = np.full(segments, 0.5 / segments)
    masses[-1] /= 2
    begin = np.concatenate([np.full(segments, math.pi / 2), np.zeros(segments)])
    known = solve_ivp(
        lagrangian_chain, (0, 0.6), begin, method="DOP853", t_eval=run.t, rtol=1e-13, atol=1e-13,
        args=(np.full(segments, 1 / segments), masses),
    )  # fmt: skip
    x = known.y[:segments]
    tip = np.stack([np.sin(x).sum(axis=0), 0 * run.t, -np.cos(x).sum(axis=0)], axis=1) / segments
    np.testing.assert_allclose(run.position("e"), tip, atol=10 * CLOSE)  # the free end curls up


@pytest.mark.parametrize("segments", [1, 5, 40])
def test_turning_chain(segments):
    """A chain that turns about its end stays straight, with the lumped tension m omega^2 r summed outwards, for 10 turns.

    The sum is that of the nodes' masses at their radii; from a mu omega^2 (L^2 - s^2)/2 of the cable it differs by 1/(4 N^2) of the
    largest, in the middle of each link.
    """
    omega, mu = 7.0, 0.3
    cable = Cable("o", "e", length=1.0, mass_per_length=mu, EA=math.inf, segments=segments)
    scene = Scene([Fixed("o", (0, 0, 0)), Free("e", at=(1, 0, 0))], [cable], [])
    model = build(scene)
    r = np.arange(segments + 1) / segments
    q, v = np.zeros((2, model.n, 3))
    q[model.nodes("o-e"), 0], v[model.nodes("o-e"), 1] = r, omega * r
    begin = State(model, 0.0, q, v, np.zeros(segments))
    turns = 2 * math.pi / omega
    run = simulate(scene, 10 * turns, method="links", rtol=1e-11, start=begin, save_every=10 * turns / 13)
    masses = np.full(segments + 1, mu / segments)
    masses[[0, -1]] /= 2
    T = omega**2 * np.cumsum((masses * r)[:0:-1])[::-1]
    np.testing.assert_allclose(run.tension("o-e"), np.tile(T, (len(run.t), 1)), rtol=1e-7)
    middle = (np.arange(segments) + 0.5) / segments
    assert np.abs(T - 0.5 * mu * omega**2 * (1 - middle**2)).max() <= 0.5 * mu * omega**2 / (4 * segments**2) * (1 + 1e-9)
    angle = omega * run.t
    np.testing.assert_allclose(run.position("e"), np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1), atol=1e-7)
    assert run.events == ()


def test_order_of_a_pair_by_given_steps():
    """links5 on a pendulum: 2^5 nearer with half the step, in places and velocities, over four halvings."""
    amplitude = 2.0
    scene = rod((L * math.sin(amplitude), 0.0, -L * math.cos(amplitude)))
    steps, off = 40 * 2 ** np.arange(5), []
    x, rate = swing(np.array([2.0]), amplitude)
    at, v = L * np.array([np.sin(x[0]), 0, -np.cos(x[0])]), L * rate[0] * np.array([np.cos(x[0]), 0, np.sin(x[0])])
    for n in steps:
        run = simulate(replace(scene), 2.0, method="links5", dt=2.0 / n, start="straight", save_every=2.0)
        off.append([np.linalg.norm(run.position("m")[-1] - at), np.linalg.norm(run.velocity("m")[-1] - v)])
    slopes = np.diff(np.log2(off), axis=0)
    np.testing.assert_allclose(slopes[-2:], -5.0, atol=0.15)


def test_order_8_by_tolerances():
    """A tolerance a tenth as large takes 10^(1/8) as many steps; the error falls with it."""
    amplitude = 2.0
    scene, work, off = rod((L * math.sin(amplitude), 0.0, -L * math.cos(amplitude))), [], []
    x, _ = swing(np.array([8.0]), amplitude)
    tolerances = 10.0 ** -np.arange(5, 13)
    for tolerance in tolerances:
        run = simulate(scene, 8.0, method="links", atol=tolerance, start="straight", save_every=8.0)
        work.append(run.work.steps)
        off.append(np.linalg.norm(run.position("m")[-1] - L * np.array([np.sin(x[0]), 0, -np.cos(x[0])])))
    slope = np.polyfit(np.log10(tolerances), np.log10(work), 1)[0]
    assert slope == pytest.approx(-1 / 8, abs=0.02)  # 1/8.5 to 1/7: the error of a step is of order 8
    assert np.all(np.array(off) < 1e3 * tolerances) and off[-1] < 1e-5 * off[0]


# Angles [rad] of a double pendulum of two masses of 1 kg on arms of 1 m, g = 9.81 m/s2, both let go from 135 degrees: by Taylor
# series of order 44 at steps of 5 ms in numbers of 50 digits, which keep the energy to 1e-38.
CHAOS = {
    1.0: (0.13830824378447283788, -0.72043555195895423491),
    2.0: (-2.8281130351066204535, -1.7301237198512209776),
    4.0: (2.1385707120847075705, 2.1123747366693135082),
    6.0: (-3.3372043841733521569, -0.49392151363433624918),
    8.0: (-8.6770635111776179943, -2.1825390411955416469),
}


def test_chaos_is_followed():
    """Against numbers of 50 digits: ten roundings, which the motion multiplies by e^1.7 in a second, 10^6 times in eight."""
    scene, masses, lengths = double((2.356194490192345, 2.356194490192345), masses=(0.9, 0.95), lengths=(1.0, 1.0))
    assert masses == pytest.approx([1.0, 1.0], abs=1e-15) and lengths.tolist() == [1.0, 1.0]
    run = simulate(scene, 8.0, method="links", rtol=1e-14, start="straight", save_every=1.0)
    for t, (x, y) in CHAOS.items():
        m = np.array([math.sin(x), 0.0, -math.cos(x)])
        n = m + np.array([math.sin(y), 0.0, -math.cos(y)])
        k = int(np.argmin(np.abs(run.t - t)))
        off = max(np.abs(run.position("m")[k] - m).max(), np.abs(run.position("n")[k] - n).max())
        assert off < 2e-15 * math.exp(1.7 * t), (t, off)
